"""The command that the package installs: its exit status, its streams, and Ctrl-C."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import asperity
from conftest import COMMAND, SCENARIOS

SCRIPT, MODULE = [str(COMMAND)], [sys.executable, "-m", "asperity"]


@pytest.mark.parametrize("line", [SCRIPT, MODULE], ids=["script", "module"])
def test_the_script_and_the_module_are_the_command(line: list[str], tmp_path: Path) -> None:
    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        called = [*line, *map(str, arguments)]
        return subprocess.run(called, cwd=tmp_path, capture_output=True, text=True, check=False)

    version = run("--version")
    assert (version.returncode, version.stdout) == (0, f"asperity {asperity.__version__}\n")
    wrong = run("simulat", "rig.json")
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert "'simulate'" in wrong.stderr and "Usage: asperity [OPTIONS]" in wrong.stderr
    absent = run("check", "absent.json")
    assert absent.returncode == 2 and "absent.json" in absent.stderr
    answer = run("check", SCENARIOS / "nouira2020-modified.json", "--json")
    assert answer.returncode == 0 and json.loads(answer.stdout)


@pytest.mark.skipif(os.name == "nt", reason="signals are sent to a process")
def test_ctrl_c_stops_a_study_which_is_continued(tmp_path: Path) -> None:
    """The first Ctrl-C ends the command between chunks, as it does without Python."""
    peaks = {"kind": "uniform", "lower": 5, "upper": 30}
    study = {
        "schema": "asperity/study/1",
        "scenario": str(SCENARIOS / "nouira2020-power.json"),
        "inputs": [{"pointer": "/excitation/peak_n", "distribution": peaks}],
        "design": {"kind": "sobol", "rows": 64},
        "chunk_rows": 1,
    }
    (tmp_path / "study.json").write_text(json.dumps(study), encoding="utf-8")
    line = [*SCRIPT, "study", "study.json", "--out", "runs", "--quiet"]
    with subprocess.Popen(line, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        while not list((tmp_path / "runs").glob("chunks/*.csv")):
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert process.returncode == 130
    assert "--resume" in errors and "Traceback" not in errors
    assert list((tmp_path / "runs").glob("chunks/*.csv"))


@pytest.mark.skipif(os.name == "nt", reason="signals are sent to a process")
def test_ctrl_c_ends_a_simulation(tmp_path: Path) -> None:
    """A command without steps ends at once, without words of Python."""
    hour = ["--set", "/duration_s=3600", "--set", "/output_rate_hz=1000", "--out", str(tmp_path / "out")]
    line = [*SCRIPT, "-v", "simulate", str(SCENARIOS / "nouira2020-power.json"), *hour]
    with subprocess.Popen(line, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        # The first line of the log: the scenario has been read.
        assert process.stderr.readline()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert process.returncode == -signal.SIGINT
    assert "Traceback" not in errors
