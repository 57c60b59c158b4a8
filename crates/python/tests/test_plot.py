"""Figures on axes of matplotlib: what is drawn, on which axes, with which titles."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import asperity
from conftest import SCENARIOS
from hammer import RATE, decay, record

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("Agg")

#: The module, whose axes are of any type.
plot: Any = asperity.plot

RIG = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_({"/method": "modal"})


@pytest.fixture(autouse=True)
def closed() -> Iterator[None]:
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture(scope="module")
def run() -> asperity.Simulation:
    return RIG.simulate()


@pytest.fixture(scope="module")
def hits() -> asperity.Analysis:
    return asperity.analyse(list(record()), sample_rate_hz=RATE, units=["N", "m/s^2"])


def titles(ax: Any) -> tuple[str, str]:
    return ax.get_xlabel(), ax.get_ylabel()


def test_a_function_is_drawn_by_its_parts(run: asperity.Simulation) -> None:
    assert run.frf is not None
    ax = plot.frf(run)
    assert titles(ax) == ("Frequency (Hz)", "Receptance (m/N)") and ax.get_yscale() == "log"
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), run.frf["magnitude_m_per_n"][1:])
    marked = [run.summary["static"]["natural_frequency_hz"]]
    marked += [run.summary[peak]["frequency_hz"] for peak in ("fundamental", "second_harmonic")]
    assert sorted(line.get_xdata()[0] for line in ax.lines[1:]) == sorted(marked)
    # A second call draws on the same axes and leaves them as they are otherwise.
    before = ax.get_xlim(), len(ax.lines)
    assert plot.frf(run, ax, color="tab:red", label="again") is ax
    assert (ax.get_xlim(), len(ax.lines)) == (before[0], before[1] + 1)
    assert ax.lines[-1].get_color() == "tab:red"
    decibels = plot.frf(run, scale="db").lines[0].get_ydata()
    np.testing.assert_allclose(decibels, 20 * np.log10(run.frf["magnitude_m_per_n"][1:]))
    phase = plot.frf(run, part="phase").lines[0].get_ydata()
    assert np.nanmax(np.abs(np.diff(phase))) <= 180 and np.isnan(phase).any()
    with pytest.raises(ValueError, match="part is 'phases'; accepted: 'magnitude'"):
        plot.frf(run, part="phases")
    with pytest.raises(ValueError, match="no coherence over frequency"):
        plot.frf(run, part="coherence")
    with pytest.raises(TypeError, match="accepted: Simulation, Analysis"):
        plot.frf(1.0)


def test_functions_of_other_results(hits: asperity.Analysis) -> None:
    mobility = asperity.analyse(
        list(record()), sample_rate_hz=RATE, units=["N", "m/s^2"], form="mobility"
    )
    assert titles(plot.frf(hits))[1] == "Mean receptance (m/N)"
    assert titles(plot.frf(mobility))[1] == "Mean mobility (m/(N s))"
    assert titles(plot.frf(hits, part="coherence"))[1] == "Coherence"
    uniform = {"kind": "uniform", "lower": 9, "upper": 30}
    study = RIG.study(
        {
            "inputs": [{"pointer": "/excitation/peak_n", "distribution": uniform}],
            "design": {"kind": "sobol", "rows": 8},
            "frf": {"start_hz": 700, "stop_hz": 1000, "count": 5},
        }
    )
    ax = plot.frf(study)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["95 %", "50 %", "median"]
    assert study.frf is not None
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), study.frf["median_m_per_n"])
    base = RIG.with_({"/excitation": {"kind": "base_motion", "acceleration": {
        "kind": "half_sine", "peak_m_per_s2": 5, "duration_s": 1e-3}}}).simulate()
    ax = plot.frf(base)
    assert titles(ax)[1] == "Relative displacement per base acceleration (s²)"


def test_a_history_ends_where_the_motion_has_decayed(run: asperity.Simulation) -> None:
    ax = plot.history(run)
    assert titles(ax) == ("Time (ms)", "Displacement (µm)")
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), 1e6 * run.history["displacement_m"])
    assert 15 < ax.get_xlim()[1] < 40 < 1e3 * run.history["time_s"][-1]
    ax = plot.history(run, column="pressure_pa")
    assert titles(ax)[1] == "Contact pressure (MPa)"
    assert [line.get_label() for line in ax.lines] == ["guide-sample", "sample-disc"]
    ax = plot.history(run, column="sample-disc:closure_m")
    assert titles(ax)[1] == "Closure, sample-disc (µm)" and len(ax.lines) == 1
    with pytest.raises(KeyError, match="no column 'velocity'"):
        plot.history(run, column="velocity")


def test_laws() -> None:
    ax = plot.law(RIG)
    assert titles(ax) == ("Contact pressure (MPa)", "Contact stiffness (Pa/m)")
    names = [line.get_label() for line in ax.lines]
    assert names == list(asperity.laws(RIG)) == [line.get_label() for line in plot.law(asperity.laws(RIG)).lines]
    one = asperity.Law({"kind": "constant", "stiffness_pa_per_m": 2e12})
    ax = plot.law(one, pressure_pa=(1e5, 3e5), color="black")
    np.testing.assert_allclose(ax.get_xlim(), (0.1, 0.3))
    assert set(ax.lines[0].get_ydata()) == {2e12}
    with pytest.raises(asperity.ScenarioError):
        plot.law({"bodies": []})


def test_steady_responses_show_their_stability() -> None:
    found = RIG.steady([0.2, 2], 700, 1000, harmonics=5, backbone=True, time_sweep="up", time_sweep_points=3)
    ax = plot.backbone(found)
    assert titles(ax) == ("Frequency (Hz)", "Amplitude u$_{1}$ (µm)")
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    expected = ["0.2 N", "2 N", "fold", "end of the branch", "phase resonance", "damped mode"]
    expected.append("time integration, up")
    assert labels == expected
    # Beside the branch that covers the range, its other part with a fold: stable, then unstable from the fold on.
    ends = [[part["end"] for part in found.summary[key]] for key in ("levels", "other_parts")]
    assert ends == [["reached", "reached"], ["returned"]]
    branch = found.points["branch"] == 3
    assert set(found.special_points["branch"]) == {3}
    parts = [line for line in ax.lines if line.get_color() == ax.get_legend().get_lines()[1].get_color()]
    whole, stable, unstable = parts[:3]
    assert whole.get_linestyle() == "-"
    assert len(whole.get_xdata()) == np.count_nonzero(found.points["branch"] == 2)
    assert (stable.get_linestyle(), unstable.get_linestyle()) == ("-", "--")
    assert len(unstable.get_xdata()) == np.count_nonzero(found.points["stable"][branch] == 0)
    assert stable.get_xdata()[-1] == unstable.get_xdata()[0]


def test_backbones_and_features_of_hits(hits: asperity.Analysis) -> None:
    ax = plot.backbone(hits)
    assert titles(ax) == ("Amplitude (m)", "Frequency (Hz)") and len(ax.lines) == 4
    assert titles(plot.backbone(hits, quantity="damping"))[1] == "Damping ratio (%)"
    free = asperity.decay(decay(), sample_rate_hz=8000.0, units=["m/s^2"])
    assert len(plot.backbone(free).lines) == 1
    ax = plot.features(hits)
    assert titles(ax) == ("Peak force (N)", "Fundamental f$_{1}$ (Hz)")
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), hits.hits["force_peak_n"])
    assert titles(plot.features(hits, feature="fundamental.damping_ratio"))[1] == "Damping ratio (%)"
    with pytest.raises(KeyError, match="no feature 'frequency' of hits; accepted: fundamental"):
        plot.features(hits, feature="frequency")


def test_features_of_a_sweep_are_lines() -> None:
    vary: dict[str, Any] = {"/interfaces/0/law": ["modified", "pl"], "/excitation/peak_n": [20, 9, 32]}
    ax = plot.features(RIG.sweep(vary), feature="harmonic_ratio")
    assert titles(ax) == ("Peak force (N)", "Ratio A$_{2}$/A$_{1}$")
    assert [line.get_label() for line in ax.lines] == ["modified", "pl"]
    assert ax.lines[0].get_xdata().tolist() == [9, 20, 32]
    with pytest.raises(KeyError, match="no column '/peak'"):
        plot.features(RIG.sweep(vary), force="/peak")


def test_matplotlib_is_imported_when_a_figure_is_drawn() -> None:
    text = "import sys, asperity; assert 'matplotlib' not in sys.modules; asperity.plot.frf"
    subprocess.run([sys.executable, "-c", text], check=True)
