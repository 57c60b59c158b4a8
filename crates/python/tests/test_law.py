"""Contact laws: equal to the command, over arrays of any shape, from functions."""

from __future__ import annotations

import copy
import json
import math
import pickle
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS, assert_same_columns

RIG = SCENARIOS / "nouira2020-modified.json"
POWER = {"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}
EXPONENTIAL = {"kind": "exponential", "length_m": 2e-7}


def test_tables_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    document = json.loads(RIG.read_text(encoding="utf-8"))
    document["laws"]["never-separates"] = EXPONENTIAL
    document["laws"]["layered"] = {
        "kind": "in_series",
        "law": "pl",
        "stiffness_pa_per_m": 5e12,
    }
    path = tmp_path / "rig.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    answer = command("law", path, "--out", out)
    found = asperity.tabulate(path)
    assert list(found) == answer["laws"] == list(asperity.laws(path))
    for name, table in found.items():
        assert_same_columns(table, out / f"law-{name}.csv")
    assert found.figure is not None
    assert found.figure.svg() == (out / "law.svg").read_text(encoding="utf-8")
    for name, law in asperity.laws(path).items():
        table = found[name]
        pressure = table["pressure_pa"]
        np.testing.assert_array_equal(law.stiffness(pressure), table["stiffness_pa_per_m"])
        np.testing.assert_array_equal(law.closure(pressure), table["closure_m"])
        np.testing.assert_array_equal(law.energy(table["closure_m"]), table["energy_j_per_m2"])
        # The law alone is the law of the scenario.
        alone = asperity.Law(law.to_dict(), reference_pa=law.reference_pa or None)
        np.testing.assert_array_equal(alone.closure(pressure), table["closure_m"])
    with pytest.raises(KeyError, match="modified"):
        found["none"]


def test_fits_equal_those_of_the_command(
    command: Callable[..., dict[str, Any]], tmp_path: Path
) -> None:
    pressure, stiffness = [0.14e6, 0.35e6, 0.57e6, 1e6], [1.15e12, 1.75e12, 1.63e12, 2.46e12]
    table = tmp_path / "table.csv"
    rows = [f"{p!r},{k!r}" for p, k in zip(pressure, stiffness, strict=True)]
    table.write_text("\n".join(["pressure_pa,stiffness_pa_per_m", *rows]), encoding="utf-8")
    fit = command("law", RIG, "--fit", table, "--out", tmp_path / "out")["fit"]
    found = asperity.fit_power(np.array(pressure), stiffness)
    assert found.coefficient == fit["coefficient"]
    assert found.exponent == fit["exponent"]
    assert found.residual_log_rms == fit["residual_log_rms"]
    assert found.standard_error_log_coefficient == fit["standard_error_log_coefficient"]
    assert found.standard_error_exponent == fit["standard_error_exponent"]
    assert found.law.stiffness(1e6) == pytest.approx(found.coefficient * 1e6**found.exponent)
    assert asperity.fit_power(pressure[:2], stiffness[:2]).standard_error_exponent is None


@pytest.mark.parametrize(
    ("pressure", "stiffness", "words"),
    [
        ([1.0], [1.0], "points"),
        ([1.0, 2.0], [1.0], "equal lengths"),
        ([1.0, -2.0], [1.0, 1.0], "pressure"),
        ([1.0, np.nan], [1.0, 1.0], "pressure"),
        ([1.0, 1.0], [1.0, 1.0], "spread"),
        ([[1.0, 2.0]], [1.0, 1.0], "one dimension"),
        (["a", "b"], [1.0, 1.0], "real numbers"),
    ],
)
def test_points_that_make_no_fit_are_errors(pressure: Any, stiffness: Any, words: str) -> None:
    with pytest.raises((TypeError, ValueError), match=words):
        asperity.fit_power(pressure, stiffness)


def test_arrays_of_any_shape_strides_type_and_order() -> None:
    law = asperity.Law(POWER)
    pressure = np.linspace(0.0, 1e6, 24).reshape(2, 3, 4)
    expected = np.array([law.stiffness(float(p)) for p in pressure.ravel()]).reshape(2, 3, 4)
    np.testing.assert_allclose(expected, 1.81e10 * pressure**0.35, rtol=1e-14)
    for values in (
        pressure,
        pressure.copy(order="F"),
        pressure.astype(">f8"),
        np.repeat(pressure, 2, axis=1)[:, ::2],
        pressure.tolist(),
        np.broadcast_to(pressure, (2, 3, 4)),
    ):
        found = law.stiffness(values)
        assert found.shape == (2, 3, 4)
        assert found.dtype == np.float64
        np.testing.assert_array_equal(found, expected)
    backwards = pressure[::-1, :, ::-2]
    np.testing.assert_array_equal(law.stiffness(backwards), expected[::-1, :, ::-2])
    frozen = pressure.copy()
    frozen.flags.writeable = False
    np.testing.assert_array_equal(law.stiffness(frozen), expected)
    assert isinstance(law.stiffness(1e6), float)
    assert isinstance(law.stiffness(np.float32(1e6)), float)
    assert law.stiffness(10**6) == law.stiffness(1e6)
    assert law.stiffness(np.zeros((0, 3))).shape == (0, 3)
    assert law.stiffness([]).shape == (0,)
    unaligned = np.frombuffer(b"\0" + np.arange(5.0).tobytes(), dtype=np.uint8)[1:].view(np.float64)
    np.testing.assert_array_equal(law.stiffness(unaligned), law.stiffness(np.arange(5.0)))
    assert np.isnan(law.stiffness(np.nan)) or law.stiffness(np.nan) == 0.0
    masked = law.closure(np.ma.array([1e6, 2e6], mask=[False, True]))
    assert np.isfinite(masked[0]) and np.isnan(masked[1])


@pytest.mark.parametrize(
    "values", [None, "1e6", b"1", 1j, [1, [2, 3]], {}, object(), np.array(["1"]), [None], True]
)
def test_values_that_are_not_numbers_are_errors(values: Any) -> None:
    law = asperity.Law(POWER)
    for method in (law.stiffness, law.closure, law.pressure, law.energy, law.stiffness_slope):
        with pytest.raises((TypeError, ValueError), match="pressure|closure"):
            method(values)


def test_closures_pressures_and_energies_agree() -> None:
    pressure = np.geomspace(1e3, 1e7, 50)
    for spec in (POWER, EXPONENTIAL, {"kind": "hyperbolic", "stiffness_pa_per_m": 1e11, "closure_limit_m": 1e-5}):
        law = asperity.Law(spec, reference_pa=1e5)
        closure = law.closure(pressure)
        np.testing.assert_allclose(law.pressure(closure), pressure, rtol=1e-10)
        # dE/dd = p and dp/dd = K by central differences of 1e-4 of the closure's own scale.
        step = 1e-4 * pressure / law.stiffness(pressure)
        slope = (law.energy(closure + step) - law.energy(closure - step)) / (2 * step)
        np.testing.assert_allclose(slope, pressure, rtol=1e-6)
        slope = (law.pressure(closure + step) - law.pressure(closure - step)) / (2 * step)
        np.testing.assert_allclose(slope, law.stiffness(pressure), rtol=1e-6)


def test_a_law_states_its_domain() -> None:
    law = asperity.Law(POWER)
    assert (law.kind, law.closure_lost_m, law.closure_limit_m) == ("power", 0.0, math.inf)
    assert law.reference_pa == 0.0 and law.measured_range_pa is None
    assert asperity.Law(EXPONENTIAL, reference_pa=2e5).closure_lost_m is None
    table = asperity.Law({"kind": "table", "points": [[1e5, 1e12], [1e6, 2e12]]})
    assert table.measured_range_pa == (1e5, 1e6)
    assert repr(law) == "<asperity.Law of the kind power>"


def test_laws_are_compared_copied_and_pickled() -> None:
    law = asperity.Law(EXPONENTIAL, reference_pa=2e5)
    assert law == asperity.Law(law) == asperity.Law(json.dumps(EXPONENTIAL), reference_pa=2e5)
    assert law != asperity.Law(EXPONENTIAL, reference_pa=3e5)
    assert law != asperity.Law(POWER)
    assert law != 3
    for other in (copy.deepcopy(law), pickle.loads(pickle.dumps(law))):
        assert other == law
        assert other.closure(3e5) == law.closure(3e5)


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        ({"kind": "power", "coefficient": 1e10}, "exponent"),
        ({"kind": "power", "coefficient": 1e10, "exponent": 0.3, "m": 1}, "m"),
        ({"kind": "power", "coefficient": -1e10, "exponent": 0.3}, "coefficient"),
        ({"kind": "spring"}, "spring"),
        ({"kind": "table", "points": [[1e5, 1e12]]}, "points"),
        ({"kind": "table", "points": [[1e5, 1e12], [1e4, 1e12]]}, "pressure"),
        ({"kind": "in_series", "law": "pl", "stiffness_pa_per_m": 1e12}, "in place"),
        (EXPONENTIAL, "reference_pa"),
        ({}, "kind"),
        ("{", "line"),
    ],
)
def test_laws_that_cannot_be_built_are_errors(spec: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        asperity.Law(spec)


def test_other_types_are_errors() -> None:
    for source in (None, 3, [1], b"{}", np.zeros(2)):
        with pytest.raises(TypeError, match="accepted"):
            asperity.Law(source)  # type: ignore[arg-type]
    for reference in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="reference_pa"):
            asperity.Law(POWER, reference_pa=reference)


def test_threads_that_call_at_once_get_the_same_numbers() -> None:
    law = asperity.Law({"kind": "in_series", "law": POWER, "stiffness_pa_per_m": 5e12})
    closure = np.linspace(0.0, 1e-6, 20_000)
    expected = law.pressure(closure)
    found: list[Any] = []
    threads = [
        threading.Thread(target=lambda: found.append(law.pressure(closure))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for other in found:
        np.testing.assert_array_equal(other, expected)
    assert len(found) == 4


def test_a_law_stands_wherever_a_scenario_has_one() -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal", "/duration_s": 0.12})
    law = asperity.laws(scenario)["pl"]
    expected = asperity.simulate(scenario.with_({"/interfaces/0/law": "pl", "/interfaces/1/law": "pl"}))
    for changes in (
        {"/laws/mine": law, "/interfaces/0/law": "mine", "/interfaces/1/law": "mine"},
        {"/interfaces/0/law": law, "/interfaces/1/law": law},
    ):
        found = asperity.simulate(scenario.with_(changes))
        np.testing.assert_array_equal(
            found.history["displacement_m"], expected.history["displacement_m"]
        )
    swept = asperity.sweep(scenario, {"/laws/modified": [law, law.to_dict()]})
    np.testing.assert_array_equal(*swept["fundamental.frequency_hz"].reshape(2, 1))


def test_a_stiffness_in_python_is_the_law_to_its_tolerance() -> None:
    calls = 0

    def stiffness(pressure: float) -> float:
        nonlocal calls
        calls += 1
        return 1.81e10 * math.pow(pressure, 0.35)

    law = asperity.law_from_stiffness(stiffness, (1.0, 1e8), tolerance=1e-6)
    assert law.kind == "table" and calls < 12_000
    pressure = np.geomspace(1.0, 1e8, 9_973)
    exact = asperity.Law(POWER)
    np.testing.assert_allclose(law.stiffness(pressure), exact.stiffness(pressure), rtol=2e-6)
    np.testing.assert_allclose(
        np.diff(law.closure(pressure)), np.diff(exact.closure(pressure)), rtol=3e-6
    )


@pytest.mark.filterwarnings("ignore::asperity.AsperityWarning")
def test_a_response_with_a_law_in_python_is_that_of_the_law() -> None:
    scenario = asperity.Scenario(RIG).with_({"/method": "modal", "/duration_s": 0.02})
    expected = asperity.simulate(scenario.with_({"/laws/modified": asperity.laws(scenario)["pl"]}))
    law = asperity.law_from_stiffness(lambda p: 1.81e10 * p**0.35, (1.0, 1e7))
    found = asperity.simulate(scenario.with_({"/laws/modified": law}))
    first = [run.summary["fundamental"]["frequency_hz"] for run in (found, expected)]
    assert first[0] == pytest.approx(first[1], rel=1e-5)
    peak = np.max(np.abs(expected.history["displacement_m"]))
    difference = found.history["displacement_m"] - expected.history["displacement_m"]
    assert np.max(np.abs(difference)) < 1e-3 * peak


def test_two_functions_of_the_closure_are_a_law() -> None:
    def pressure(closure: float) -> float:
        return 1e11 * closure + 5e17 * closure**2

    def stiffness(closure: float) -> float:
        return 1e11 + 1e18 * closure

    law = asperity.law_from_pressure(pressure, stiffness, (0.0, 2e-6))
    closure = np.linspace(0.0, 2e-6, 1001)
    # A stiffness off by 1e-6 is a closure off by 1e-6, and a pressure by K d / p <= 2 times that.
    np.testing.assert_allclose(law.pressure(closure), pressure(closure), rtol=2.5e-6)  # type: ignore[arg-type]
    np.testing.assert_allclose(law.stiffness(law.pressure(closure)), stiffness(closure), rtol=3e-6)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("stiffness", "words"),
    [
        (lambda p: math.nan, "nan at a pressure of"),
        (lambda p: -1e12, "positive"),
        (lambda p: 0.0, "positive"),
        (lambda p: math.inf, "finite"),
        (lambda p: "stiff", "expected a number"),
        (lambda p: None, "expected a number"),
        (lambda p: 1e12 if p < 1e5 else 2e12, "changes too fast near"),
        (lambda p: np.array([1e12, 2e12]), "expected a number"),
    ],
)
def test_functions_that_are_no_stiffness_are_errors(
    stiffness: Callable[[float], float], words: str
) -> None:
    with pytest.raises((TypeError, ValueError), match=words):
        asperity.law_from_stiffness(stiffness, (1e3, 1e7))


def test_the_exception_of_a_function_is_passed_on() -> None:
    def broken(pressure: float) -> float:
        raise LookupError(f"no stiffness at {pressure}")

    with pytest.raises(LookupError, match="no stiffness at"):
        asperity.law_from_stiffness(broken, (1e3, 1e7))
    with pytest.raises(ZeroDivisionError):
        asperity.law_from_pressure(lambda d: 1 / 0, lambda d: 1.0, (0.0, 1e-6))
    with pytest.raises(TypeError):
        asperity.law_from_stiffness(3, (1e3, 1e7))  # type: ignore[arg-type]


def test_functions_of_the_closure_that_disagree_are_errors() -> None:
    with pytest.raises(ValueError, match="not the derivative"):
        asperity.law_from_pressure(lambda d: 1e12 * d, lambda d: 2e12, (0.0, 1e-6))
    with pytest.raises(ValueError, match="does not increase"):
        asperity.law_from_pressure(lambda d: 1e6 - 1e11 * d, lambda d: 1e11, (0.0, 1e-6))
    with pytest.raises(ValueError, match="zero or more"):
        asperity.law_from_pressure(lambda d: 1e12 * d, lambda d: 1e12, (-1e-6, 1e-6))


@pytest.mark.parametrize("pressures", [(1.0, 1.0), (2.0, 1.0), (-1.0, 1.0), (0.0, math.inf), (1.0,), 3, "ab"])
def test_ranges_that_are_none_are_errors(pressures: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="pressures_pa"):
        asperity.law_from_stiffness(lambda p: 1e12, pressures)
    with pytest.raises(ValueError, match="tolerance"):
        asperity.law_from_stiffness(lambda p: 1e12, (0.0, 1e6), tolerance=0.0)


def test_figures_are_saved_in_three_formats(tmp_path: Path) -> None:
    figure = asperity.tabulate(RIG).figure
    assert figure is not None
    for ending, start in ((".svg", b"<svg"), (".pdf", b"%PDF"), (".PNG", b"\x89PNG")):
        path = tmp_path / f"law{ending}"
        figure.save(path)
        assert start in path.read_bytes()[:200]
    assert figure.png() == (tmp_path / "law.PNG").read_bytes()
    with pytest.raises(ValueError, match="svg, .pdf or .png"):
        figure.save(tmp_path / "law.jpg")
    with pytest.raises(OSError):
        figure.save(tmp_path / "none" / "law.svg")
    assert figure._repr_svg_() == figure.svg()


def test_a_series_gives_a_series() -> None:
    law = asperity.Law({"kind": "power", "coefficient": 1.81e10, "exponent": 0.35})
    pressures = [1e5, 2e5]
    pandas = pytest.importorskip("pandas")
    found = law.stiffness(pandas.Series(pressures, index=["a", "b"], name="pressure_pa"))
    assert (found.name, found.index.tolist()) == ("stiffness_pa_per_m", ["a", "b"])
    np.testing.assert_array_equal(found, law.stiffness(pressures))
    assert isinstance(law.stiffness(pandas.Index(pressures)), np.ndarray)
    polars = pytest.importorskip("polars")
    column = law.closure(polars.Series("pressure_pa", pressures))
    assert isinstance(column, polars.Series) and column.name == "closure_m"
    np.testing.assert_array_equal(column.to_numpy(), law.closure(pressures))
    xarray = pytest.importorskip("xarray")
    array = law.stiffness(xarray.DataArray(pressures, coords={"time_s": [0.0, 1.0]}, dims=["time_s"]))
    assert array.dims == ("time_s",) and array.name == "stiffness_pa_per_m"
