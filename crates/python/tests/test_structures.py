"""Structures of matrices: two masses on a spring, the lower one on a rough patch of two cells."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import ROOT

MASSES = (2.0, 1.0)
SPRING = 4e6
AREA = 1e-4
LAW = {"kind": "power", "coefficient": 2e10, "exponent": 0.4}
GRAVITY = 9.81


def document(folder: Path) -> dict[str, Any]:
    stiffness = SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrices = asperity.write_matrices(folder, stiffness, np.diag(MASSES), [[1, 3], [2, 3]])
    cells = "cell,area_m2,node,direction,weight\n"
    cells += "".join(f"{cell},{AREA / 2},2,3,-1\n" for cell in (0, 1))
    (folder / "cells.csv").write_text(cells)

    def at(node: int, sign: int) -> dict[str, Any]:
        return {"body": "chain", "node": node, "direction": [0, 0, sign]}

    return {
        "schema": "asperity/scenario/1",
        "bodies": [{"name": "chain", "matrices": matrices, "reduction": {"modes": 2}}],
        "gravity_m_per_s2": [0, 0, -GRAVITY],
        "interfaces": [{"name": "patch", "law": LAW, "body": "chain", "cells": "cells.csv"}],
        "damping": {"kind": "mass_proportional", "rate_per_s": 60},
        "excitation": {"kind": "haversine", "peak_n": 5, "duration_s": 1e-3, "at": at(1, -1)},
        "sensors": [{"name": "top", "at": at(1, -1), "kind": "displacement"}],
        "duration_s": 0.15,
    }


def frequencies() -> list[float]:
    """Both natural frequencies in closed form."""
    pressure = sum(MASSES) * GRAVITY / AREA
    contact = AREA * LAW["coefficient"] * pressure ** LAW["exponent"]  # type: ignore[operator]
    upper, lower = MASSES
    mean = 0.5 * (SPRING / upper + (SPRING + contact) / lower)
    root = math.sqrt(mean**2 - SPRING * contact / (upper * lower))
    return [math.sqrt(square) / (2 * math.pi) for square in (mean - root, mean + root)]


def test_modes_are_those_of_the_closed_form(tmp_path: Path) -> None:
    scenario = asperity.Scenario(document(tmp_path), folder=tmp_path)
    found = scenario.modes(2)
    assert found.table["frequency_hz"] == pytest.approx(frequencies(), rel=1e-9)
    assert not found.shapes.keys()
    assert found.figure is None
    assert "frequency_hz" in found._repr_html_()


def test_a_hit_has_its_cells(tmp_path: Path) -> None:
    scenario = asperity.Scenario(document(tmp_path), folder=tmp_path)
    found = scenario.simulate()
    assert found.cells is not None
    assert found.cells["pressure_at_rest_pa"] == pytest.approx(3 * GRAVITY / AREA, rel=1e-9)
    assert found.summary["cells"][0]["cells"] == 2
    assert found.summary["fundamental"]["frequency_hz"] == pytest.approx(frequencies()[0], rel=0.02)
    assert "top:displacement_m" in found.history
    # Both cells have one pressure, so that none is the highest; there is no mesh.
    assert found.cells_history is None and found.cells_history_figure is None
    assert found.motions == {}
    assert found == copy.deepcopy(found)


def test_meshes_and_cells_are_recorded(tmp_path: Path) -> None:
    content = document(tmp_path)
    (tmp_path / "chain.inp").write_text("*NODE\n1,0,0,0.2\n2,0,0,0.1\n")
    content["bodies"][0]["mesh"] = "chain.inp"
    content["output"] = {"instants_s": [1e-3, 2e-3], "cells": {"patch": ["1"]}}
    found = asperity.Scenario(content, folder=tmp_path).simulate()
    motion = found.motions["chain"]
    assert motion.node.tolist() == [1, 2]
    assert motion.place_m.tolist() == [[0, 0, 0.2], [0, 0, 0.1]]
    assert motion.displacement_m.shape == (2, 2, 3)
    assert motion.figure is None
    samples = np.searchsorted(found.history["time_s"], motion.time_s - 1e-9)
    top = found.history["top:displacement_m"][samples]
    assert -motion.displacement_m[:, 0, 2] == pytest.approx(top, rel=1e-9)
    assert found.cells_history is not None and found.cells_history_figure is not None
    closure = found.cells_history["patch:1:closure_m"]
    foot = motion.displacement_m[:, 1, 2]
    assert closure[samples] - closure[0] == pytest.approx(-foot, rel=1e-6)
    content["output"]["cells"] = {"patch": ["7"]}
    with pytest.raises(ValueError, match='"patch" has no cell "7"'):
        asperity.Scenario(content, folder=tmp_path).simulate()


def test_steady_responses_have_cells(tmp_path: Path) -> None:
    scenario = asperity.Scenario(document(tmp_path), folder=tmp_path)
    first = frequencies()[0]
    found = scenario.steady(0.02, 0.9 * first, 1.1 * first, verify=True)
    assert found.peaks["peak_frequency_hz"][0] == pytest.approx(first, rel=5e-3)
    assert found.cells is not None and found.cells["cell"].tolist() == ["0", "1"]
    assert found.summary["levels"][0]["verify"]["relative_difference"] < 1e-3


def test_rows_of_a_sweep_and_a_study(tmp_path: Path) -> None:
    scenario = asperity.Scenario(document(tmp_path), folder=tmp_path)
    swept = scenario.sweep({"/excitation/peak_n": [2.0, 8.0]})
    soft = swept["fundamental.frequency_hz"]
    assert soft[1] < soft[0]
    study = {
        "inputs": [{"pointer": "/excitation/peak_n",
                    "distribution": {"kind": "uniform", "lower": 2, "upper": 8}}],
        "design": {"kind": "sobol", "rows": 4},
    }
    drawn = scenario.study(study)
    found = np.asarray(drawn["fundamental.frequency_hz"])
    assert np.all((found > 0.999 * soft[1]) & (found < 1.001 * soft[0]))


def test_sparse_and_full_matrices_are_the_same(tmp_path: Path) -> None:
    sparse = pytest.importorskip("scipy.sparse")
    full = document(tmp_path)
    stiffness = SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrices = asperity.write_matrices(
        tmp_path / "more", sparse.coo_array(stiffness), sparse.dia_array(np.diag(MASSES)),
        [[1, 3], [2, 3]], name="chain",
    )
    other = copy.deepcopy(full)
    other["bodies"][0]["matrices"] = matrices
    both = [asperity.modes(asperity.Scenario(one, folder=tmp_path), 2) for one in (full, other)]
    assert np.array_equal(both[0].table["frequency_hz"], both[1].table["frequency_hz"])


def test_matrices_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    unit = np.eye(2)
    with pytest.raises(ValueError, match="dof has a row of two integers"):
        asperity.write_matrices(tmp_path, unit, unit, np.array([[1.5, 3], [2, 3]]))
    with pytest.raises(ValueError, match=r"mass has the shape \(3, 3\)"):
        asperity.write_matrices(tmp_path, unit, np.eye(3), [[1, 3], [2, 3]])
    with pytest.raises(TypeError, match="stiffness"):
        asperity.write_matrices(tmp_path, 1j * unit, unit, [[1, 3], [2, 3]])
    asperity.write_matrices(tmp_path, unit, unit, [[1, 3], [2, 3]])
    with pytest.raises(FileExistsError, match="overwrite"):
        asperity.write_matrices(tmp_path, unit, unit, [[1, 3], [2, 3]])


def test_laws_of_structures_are_those_of_bars(tmp_path: Path) -> None:
    named = document(tmp_path)
    named["laws"] = {"rough": LAW}
    named["interfaces"][0]["law"] = "rough"
    scenario = asperity.Scenario(named, folder=tmp_path)
    law = asperity.laws(scenario)["rough"]
    assert law.stiffness(1e5) == asperity.Law(LAW).stiffness(1e5)
    table = asperity.tabulate(scenario)["rough"]
    assert np.array_equal(table["stiffness_pa_per_m"], law.stiffness(table["pressure_pa"]))


def test_a_saved_structure_finds_its_files(tmp_path: Path) -> None:
    lap = asperity.Scenario(ROOT / "fixtures" / "structures" / "lap-joint" / "lap.json")
    lap.save(tmp_path / "lap.json")
    found = asperity.Scenario(tmp_path / "lap.json").to_dict()
    names = [found["bodies"][0]["mesh"], *(found["bodies"][0]["matrices"][key] for key in ("stiffness", "mass"))]
    assert all((tmp_path / name).is_file() for name in names), names


def test_a_law_is_identified_on_a_structure(tmp_path: Path) -> None:
    """Hits under two weights: coefficient and exponent are found again."""
    named = document(tmp_path)
    named["laws"] = {"rough": LAW}
    named["interfaces"][0]["law"] = "rough"
    scenario = asperity.Scenario(named, folder=tmp_path)

    def hits(gravity: float) -> dict[str, Any]:
        weight = {"/gravity_m_per_s2/2": -gravity}
        listed = []
        for peak in (2.0, 10.0):
            summary = scenario.with_({**weight, "/excitation/peak_n": peak}).simulate().summary
            value = summary["fundamental"]["frequency_hz"]
            number = {"value": value, "standard_deviation": 1e-4 * value}
            listed.append(
                {"force_peak_n": peak, "features": {"fundamental.frequency_hz": number}}
            )
        return {"kind": "hits", "name": f"{gravity} m/s2", "set": weight, "hits": listed}

    problem = {
        "unknowns": [
            {"kind": "scalar", "pointer": "/laws/rough/coefficient", "bounds": [2e9, 2e11]},
            {"kind": "scalar", "pointer": "/laws/rough/exponent", "bounds": [0.1, 0.9]},
        ],
        "data": [hits(GRAVITY), hits(3 * GRAVITY)],
        "starts": 1,
        "draws": 100,
    }
    found = scenario.identify(problem, fast=True)
    for estimate, true in zip(found.estimates, (LAW["coefficient"], LAW["exponent"]), strict=True):
        assert estimate["value"] == pytest.approx(true, rel=2e-2)
    band = found.law_band
    law = LAW["coefficient"] * band["pressure_pa"] ** LAW["exponent"]
    informed = band["informed"]
    assert informed.any()
    assert np.all((band["lower_pa_per_m"] < law)[informed] & (law < band["upper_pa_per_m"])[informed])
