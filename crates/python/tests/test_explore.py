"""The live page: its requests in a notebook, and served."""

import json
import os
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

import pytest

import asperity
import hammer
from asperity import _asperity
from asperity._explore import Requests, _data_file

ROOT = Path(__file__).parents[3]
BLOCK = ROOT / "crates" / "simulation" / "examples" / "block.json"


class Sent:
    """The messages to a frame."""

    def __init__(self, page: _asperity.LivePage) -> None:
        self.messages: list[dict[str, Any]] = []
        self.requests = Requests(page, self.messages.append)
        self.count = 0

    def ask(self, place: str, body: object) -> list[Any]:
        """The status of the answer to a request, and its lines."""
        self.count += 1
        message = {"frame": "f", "id": self.count, "place": place, "body": json.dumps(body)}
        thread = self.requests.take(message)
        assert thread is not None
        thread.join()
        own = [one for one in self.messages if one["id"] == self.count]
        assert all(one["frame"] == "f" for one in own)
        assert own[-1].get("end") is True
        status, *lines = own[:-1]
        return [status["status"], *(json.loads(one["line"]) for one in lines)]


def computed(changes: list[Any], part: str = "hit", views: tuple[str, ...] = ("frf",)) -> dict[str, Any]:
    places = [{"view": view, "width": 600} for view in views]
    return {"tab": "t", "part": part, "views": places, "changes": changes}


def test_a_frame_is_answered_as_by_the_command() -> None:
    page = _asperity.LivePage(BLOCK, None, None)
    sent = Sent(page)
    changes = [["/excitation/peak_n", 7.5]]
    status, described = sent.ask("state", {"changes": changes})
    assert status == 200
    assert described["faults"] == []
    status, *lines = sent.ask("compute", computed(changes))
    assert status == 200
    assert lines[-1]["answer"] == "done"
    run = asperity.Scenario(BLOCK).with_({"/excitation/peak_n": 7.5}).simulate()
    words = next(line["text"] for line in lines if line["answer"] == "words")
    assert f"{run.summary['fundamental']['frequency_hz']:.1f}" in words
    assert page.scenario().to_dict()["excitation"]["peak_n"] == 7.5
    assert page.scenario() == asperity.Scenario(BLOCK).with_({"/excitation/peak_n": 7.5})


def test_a_state_with_faults_leaves_the_scenario() -> None:
    page = _asperity.LivePage(BLOCK, None, None)
    _, described = Sent(page).ask("state", {"changes": [["/duration_s", -1]]})
    assert described["faults"]
    assert page.scenario() == asperity.Scenario(BLOCK)


@pytest.mark.parametrize(
    ("place", "body", "status"),
    [("nowhere", {}, 404), ("compute", {"tab": "t"}, 400), ("state", {"changes": [["/a", 1]] * 501}, 400)],
)
def test_what_is_not_understood_is_refused(place: str, body: object, status: int) -> None:
    found, answer = Sent(_asperity.LivePage(BLOCK, None, None)).ask(place, body)
    assert found == status
    assert answer["error"]


def test_a_stopped_request_ends_without_its_pictures() -> None:
    sent = Sent(_asperity.LivePage(BLOCK, None, None))
    changes = [["/duration_s", 7], ["/method", {"kind": "finite_difference", "cell_m": 1e-4}]]
    message = {"frame": "f", "id": 9, "place": "compute", "body": json.dumps(computed(changes))}
    thread = sent.requests.take(message)
    assert thread is not None
    sent.requests.take({"frame": "f", "id": 9, "stop": True})
    thread.join()
    assert not any("picture" in one.get("line", "") for one in sent.messages)
    assert sent.messages[-1] == {"frame": "f", "id": 9, "end": True}


def test_messages_of_others_are_left_alone() -> None:
    requests = Requests(_asperity.LivePage(BLOCK, None, None), print)
    for message in (None, "state", {"id": 1}, {"frame": 1, "id": 1, "place": "state", "body": ""}):
        assert requests.take(message) is None


def test_data_of_other_kinds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="list"):
        asperity.explore(BLOCK, [1.0])  # type: ignore[arg-type]
    with pytest.raises(OSError, match="missing"):
        asperity.explore(BLOCK, tmp_path / "missing.json")
    with pytest.raises(asperity.ScenarioError):
        asperity.explore({"schema": "asperity/scenario/1"})
    assert _data_file(None) == (None, None)


def test_an_analysis_is_shown_beside(tmp_path: Path) -> None:
    force, acceleration = hammer.record()
    channels = (("hammer [N]", force), ("top [m/s^2]", acceleration))
    found = asperity.analyse(hammer.write(tmp_path / "hits.npz", *channels), band_hz=(50, 200))
    path, folder = _data_file(found)
    assert path is not None
    assert folder is not None
    out = tmp_path / "out"
    page = _asperity.LivePage(BLOCK, path, out, temporary=True)
    sent = Sent(page)
    _, described = sent.ask("state", {"changes": []})
    assert len(described["hits"]) == found.hits.rows
    # The record is there: each hit has its measured force.
    assert all(hit["pulse"] for hit in described["hits"])
    # The problem has the analysis beside it, which is there once the page has ended.
    _, kept = sent.ask("keep", {"changes": [], "problem": True})
    assert kept["written"] == ["scenario.json", "analysis.json", "problem.json"]
    folder.cleanup()
    problem = json.loads((out / "problem.json").read_text(encoding="utf-8"))
    assert problem["data"][0]["file"] == "analysis.json"
    assert json.loads((out / "analysis.json").read_text(encoding="utf-8")) == found.report
    again = _asperity.LivePage(BLOCK, out / problem["data"][0]["file"], None)
    _, described = Sent(again).ask("state", {"changes": []})
    assert len(described["hits"]) == found.hits.rows


def test_a_widget_holds_the_page() -> None:
    pytest.importorskip("anywidget")
    from asperity._explore import Explorer

    explorer = Explorer(_asperity.LivePage(BLOCK, None, None), None)
    assert "asperityPost" in explorer.widget.page
    assert "http" not in explorer.widget.page.replace("http://www.w3.org/2000/svg", "")
    assert explorer.scenario == asperity.Scenario(BLOCK)
    explorer.close()


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_the_served_page_gives_the_scenario_as_it_was_left() -> None:
    program = (
        "import asperity, sys\n"
        "left = asperity.explore(sys.argv[1], browser=False)\n"
        "print(left.to_dict()['excitation']['peak_n'])\n"
    )
    command = [sys.executable, "-c", program, str(BLOCK)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as served:
        assert served.stdout is not None
        url = served.stdout.readline().strip()
        host = url.split("/")[2]
        body = json.dumps({"changes": [["/excitation/peak_n", 4.25]]}).encode()
        request = urllib.request.Request(f"{url}state", body, {"Origin": f"http://{host}"})
        with urllib.request.urlopen(request) as answer:
            assert json.load(answer)["faults"] == []
        os.kill(served.pid, signal.SIGINT)
        assert served.stdout.read().strip() == "4.25"
        assert served.wait() == 0
