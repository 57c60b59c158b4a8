"""The programs of the book's pages about Python, and the notebooks."""

from __future__ import annotations

import ast
import importlib.util
import json
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import COMMAND, ROOT, SCENARIOS

BOOK = ROOT / "docs" / "src"
OVERVIEW = BOOK / "how-to" / "use-python.md"
MEASURED = BOOK / "how-to" / "identify-in-python.md"
PAGES = sorted((BOOK / "python").glob("*.md"))

#: The page with pictures, which its program writes; it has no original without Python.
GALLERY = BOOK / "python" / "gallery.md"

#: Fixtures that the pages use.
FIXTURES = ("problems", "reference/measure", "scenarios")

#: A page's program, each block with the number of its first line.
Blocks = list[tuple[int, str]]


def blocks_of(page: Path) -> Blocks:
    """The blocks of Python on a page."""
    text = page.read_text(encoding="utf-8")
    found = re.finditer(r"^```python\n(.*?)^```$", text, re.M | re.S)
    return [(text.count("\n", 0, block.start(1)), block.group(1)) for block in found]


def imported(block: str) -> set[str]:
    """The packages that a block imports."""
    found = set()
    for node in ast.walk(ast.parse(block)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            found.add(node.module.partition(".")[0])
    return found


def run(page: Path, blocks: Blocks, names: dict[str, Any] | None = None) -> list[str]:
    """Runs the blocks in their order as one program, with the names given and its own; returns the
    packages that are missing here, whose blocks are left out."""
    names = {} if names is None else names
    names["__name__"] = page.stem
    missing = []
    for lines, block in blocks:
        absent = [name for name in imported(block) if importlib.util.find_spec(name) is None]
        missing += absent
        if not absent:
            # Empty lines before the block: a traceback has the lines of the page.
            exec(compile("\n" * lines + block, str(page), "exec"), names)
    return sorted(set(missing))


def test_the_overview_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    blocks = blocks_of(OVERVIEW)
    assert len(blocks) > 5
    monkeypatch.chdir(Path(SCENARIOS))
    assert run(OVERVIEW, blocks) == []
    assert "/excitation/peak" in capsys.readouterr().out


@pytest.mark.filterwarnings("ignore::asperity.AsperityWarning", "ignore::asperity.NoticeWarning")
def test_the_page_of_measured_hits_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rate = 25600.0
    rig = asperity.Scenario(Path(SCENARIOS) / "nouira2020-modified.json").with_({
        "/method": "modal",
        "/duration_s": 0.1,
        "/output_rate_hz": rate,
    })
    rig.save("rig.json")
    noise = np.random.default_rng(1).standard_normal((7, 2, int(1.3 * rate)))
    hits = noise * np.array([[1e-3], [2e-3]])
    for hit, peak in zip(hits, (6, 10, 14, 18, 22, 26, 30), strict=True):
        history = rig.with_({"/excitation/peak_n": peak}).simulate().history
        for channel, column in zip(hit, ("force_n", "acceleration_m_per_s2"), strict=True):
            channel[256 : 256 + history.rows] += history[column]
    force, acceleration = hits.swapaxes(0, 1).reshape(2, -1)
    asperity.write("hits.uff", [
        {"name": "hammer", "data": force, "unit_str": "N", "fs": rate},
        {"name": "top", "data": acceleration, "unit_str": "m/s^2", "fs": rate},
    ])
    given = {"hits": hits, "force": force, "acceleration": acceleration}
    assert run(MEASURED, blocks_of(MEASURED), given) == []
    band = given["band"]
    assert given["identified"].report["judgement"]["use"] != "no"
    # The law inside the band where the data inform it.
    law = asperity.laws(rig)["modified"]
    informed = band["informed"]
    truth = law.stiffness(band["pressure_pa"][informed])
    inside = (band["lower_pa_per_m"][informed] <= truth) & (truth <= band["upper_pa_per_m"][informed])
    assert inside.mean() > 0.9


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = blocks_of(page)
    assert blocks
    # Pages that call the command find that of the package.
    monkeypatch.setenv("PATH", os.pathsep.join([str(COMMAND.parent), os.environ["PATH"]]))
    # A page starts at the root of a checkout: here a copy, so that the files it writes stay in it.
    for folder in FIXTURES:
        shutil.copytree(ROOT / "fixtures" / folder, tmp_path / "fixtures" / folder)
    monkeypatch.chdir(tmp_path)
    missing = run(page, blocks)
    pictures = re.findall(r"^!\[[^\]]+\]\((\S+)\)$", page.read_text(encoding="utf-8"), re.M)
    assert not pictures or page == GALLERY
    for picture in pictures:
        assert (page.parent / picture).exists(), picture
        assert missing or (tmp_path / picture).exists(), picture
    if missing:
        pytest.skip(f"all blocks ran but those that import {', '.join(missing)}")


@pytest.mark.parametrize("page", [page for page in PAGES if page != GALLERY], ids=lambda page: page.stem)
def test_a_page_and_its_original_lead_to_each_other(page: Path) -> None:
    originals = [BOOK / folder / page.name for folder in ("tutorial", "how-to")]
    (original,) = (path for path in originals if path.exists())
    assert f"../{original.parent.name}/{page.name}" in page.read_text(encoding="utf-8")
    assert f"../python/{page.name}" in original.read_text(encoding="utf-8")


def test_notebooks_are_kept_without_outputs() -> None:
    notebooks = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
    assert notebooks
    for path in notebooks:
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            assert not cell.get("outputs"), path.name
            assert cell.get("execution_count") is None, path.name
