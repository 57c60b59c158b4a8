"""Analyses of hits and decays: equal to the command, from files, arrays and SEP005 channels."""

from __future__ import annotations

import importlib.util
import json
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
import hammer
from conftest import SCENARIOS, read_csv
from test_signal import receptance

Command = Callable[..., dict[str, Any]]


def assert_same_table(table: asperity.Table, path: Path) -> None:
    """The columns of `table` are those of the file, to the last bit."""
    written = read_csv(path)
    assert list(table) == list(written)
    for name, column in table.items():
        if column.dtype.kind == "U":
            # A column of empty fields reads as numbers without a value.
            texts = ["" if text != text else str(text) for text in written[name]]
            assert column.tolist() == texts, name
        else:
            finite = np.where(np.isfinite(column), column, np.nan)
            np.testing.assert_array_equal(finite, written[name], err_msg=name, strict=False)


def assert_same_numbers(table: Mapping[str, Any], other: Mapping[str, Any]) -> None:
    """Two tables have the same columns, but for the names of files."""
    assert list(table) == list(other)
    for name, column in table.items():
        if name != "file":
            np.testing.assert_array_equal(column, other[name], err_msg=name)


@pytest.fixture(scope="module")
def signals() -> tuple[Any, Any]:
    return hammer.record()


@pytest.fixture
def file(signals: tuple[Any, Any], tmp_path: Path) -> Path:
    force, acceleration = signals
    return hammer.write(
        tmp_path / "test.npz", ("hammer [N]", force), ("top [m/s^2]", acceleration)
    )


OPTIONS: list[tuple[dict[str, Any], list[str]]] = [
    ({}, []),
    (
        {"estimator": "hv", "form": "mobility", "band_hz": (80, 120), "hits": 3},
        ["--estimator", "hv", "--form", "mobility", "--band", "80:120", "--hits", "3"],
    ),
    (
        {"window": "force+exponential:0.2", "level_n": 5, "length_s": 0.9, "keep_all": True},
        ["--window", "force+exponential:0.2", "--level", "5", "--length", "0.9", "--keep-all"],
    ),
    (
        {"names": ["f", "a"], "units": ["lbf", "g"], "force": "f", "response": 2},
        ["--names", "f,a", "--units", "lbf,g", "--force", "f", "--response", "#2"],
    ),
]


@pytest.mark.parametrize(("options", "line"), OPTIONS)
def test_an_analysis_equals_that_of_the_command(
    options: dict[str, Any], line: list[str], file: Path, command: Command, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    answer = command("analyse", file, "--out", out, "--frfs", "npz", *line)
    found = asperity.analyse(file, frfs=True, **options)
    assert found.report == answer
    assert len(found.responses) == 1
    assert_same_table(found.hits, out / "hits.csv")
    assert_same_table(found.frf, out / "frf.csv")
    assert_same_table(found.backbone, out / "backbone.csv")
    assert_same_table(found.modes, out / "modes.csv")
    with np.load(out / "frfs.npz") as written:
        columns = {name.split(" [")[0]: written[name] for name in written.files}
    np.testing.assert_array_equal(found.frfs["frequency_hz"], columns.pop("frequency"))
    assert list(found.frfs) == ["frequency_hz", *columns]
    for name, values in columns.items():
        assert found.frfs[name].dtype == np.complex128
        np.testing.assert_array_equal(found.frfs[name], values, err_msg=name)


def test_several_responses_and_a_rig_equal_the_command(
    signals: tuple[Any, Any], command: Command, tmp_path: Path
) -> None:
    force, acceleration = signals
    volts = acceleration / 9.80665 * 0.1
    rig = tmp_path / "rig.json"
    rig.write_text(
        '{"schema": "asperity/rig/1", "band_hz": [80, 120], "responses": ["top", "side"],'
        ' "channels": [{}, {"unit": "V", "sensitivity": "100mV/g"}]}',
        encoding="utf-8",
    )
    file = hammer.write(
        tmp_path / "test.npz",
        ("hammer [N]", force),
        ("top", volts),
        ("side [m/s^2]", 0.5 * acceleration),
    )
    out = tmp_path / "out"
    answer = command("analyse", file, "--rig", rig, "--out", out)
    found = asperity.analyse(file, rig=rig)
    assert found.report == answer
    assert [response.name for response in found.responses] == ["top", "side"]
    assert_same_table(found.responses[1].hits, out / "hits_side.csv")
    assert_same_table(found.modes, out / "modes.csv")
    # The same settings as a dict, but for the name of their file.
    settings = {
        "schema": "asperity/rig/1",
        "responses": ["top", "side"],
        "channels": [{}, {"unit": "V", "sensitivity": "100mV/g"}],
    }
    other = asperity.analyse(file, rig=settings, band_hz=(80, 120))
    assert_same_numbers(other.hits, found.hits)
    assert "rig" in found.report["provenance"] and "rig" not in other.report["provenance"]


def test_arrays_and_channels_give_the_numbers_of_the_file(
    signals: tuple[Any, Any], file: Path
) -> None:
    force, acceleration = signals
    of_file = asperity.analyse(file, frfs=True)
    units = ["N", "m/s^2"]
    together = np.stack([force, acceleration])
    channels = hammer.sep005(("hammer", "N", force), ("top", "m/s²", acceleration))
    times = [
        {**channel, "time": (np.arange(len(force)) / hammer.RATE).tolist(), "fs": None}
        for channel in channels
    ]
    rate = hammer.RATE
    for found in (
        asperity.analyse(together, sample_rate_hz=rate, units=units, frfs=True),
        asperity.analyse(together.T, sample_rate_hz=rate, units=units, frfs=True),
        asperity.analyse([force, acceleration], sample_rate_hz=rate, units=units, frfs=True),
        asperity.analyse(channels, frfs=True),
        asperity.analyse(times, frfs=True),
        asperity.analyse(asperity.read(file)[0], frfs=True),
    ):
        for name in ("hits", "frf", "backbone", "modes", "frfs"):
            table, expected = getattr(found, name), getattr(of_file, name)
            if name == "modes":
                assert table["damping_ratio"].tolist() == expected["damping_ratio"].tolist()
            else:
                assert_same_numbers(table, expected)
        assert found.report["settings"] == of_file.report["settings"]
        assert found.report["levels"] == of_file.report["levels"]
        source = found.report["provenance"]["files"][0]
        assert (source["file"], source["format"]) == ("arrays", "memory")
        assert len(source["sha256"]) == 64


def test_records_in_arrays_equal_one_file_each(
    signals: tuple[Any, Any], tmp_path: Path
) -> None:
    force, acceleration = (signal.reshape(4, -1) for signal in signals)
    files = [
        hammer.write(
            tmp_path / f"hit_{n}.npz", ("hammer [N]", force[n]), ("top [m/s^2]", acceleration[n])
        )
        for n in range(4)
    ]
    of_files = asperity.analyse(files)
    assert_same_numbers(asperity.analyse(tmp_path).hits, of_files.hits)
    assert_same_numbers(asperity.analyse(str(tmp_path / "hit_*.npz")).hits, of_files.hits)
    in_memory = asperity.analyse(
        np.stack([force, acceleration], axis=1),
        sample_rate_hz=hammer.RATE,
        units=["N", "m/s^2"],
    )
    records = asperity.analyse(
        [hammer.sep005(("f", "N", force[n]), ("a", "m/s^2", acceleration[n])) for n in range(4)]
    )
    for found in (in_memory, records):
        assert found.hits["record"].tolist() == [1, 2, 3, 4]
        for name in ("force_peak_n", "frequency_hz", "damping_ratio", "magnitude_m_per_n"):
            np.testing.assert_array_equal(found.hits[name], of_files.hits[name])
    # Each hit is that of the oscillator.
    np.testing.assert_allclose(in_memory.hits["frequency_hz"], hammer.NATURAL_HZ, rtol=2e-3)
    np.testing.assert_allclose(in_memory.hits["damping_ratio"], hammer.RATIO, rtol=0.1)
    assert in_memory.hits["averaged"].dtype == np.bool_
    assert in_memory.hits["averaged"].all()


def test_a_bad_hit_has_its_verdict(signals: tuple[Any, Any]) -> None:
    force, acceleration = (signal.copy() for signal in signals)
    acceleration[5300:5350] = acceleration[5300]
    found = asperity.analyse(
        [force, acceleration], sample_rate_hz=hammer.RATE, units=["N", "m/s^2"]
    )
    assert found.hits["averaged"].tolist() == [True, False, True, True]
    assert "dropout" in found.hits["verdicts"][1]
    assert np.isnan(found.hits["frequency_hz"][1])
    assert found.conclusions and isinstance(found.notices, list)


def test_a_decay_equals_that_of_the_command(command: Command, tmp_path: Path) -> None:
    acceleration = hammer.decay()
    file = hammer.write(tmp_path / "blow.npz", ("top [m/s^2]", acceleration), rate=8000.0)
    out = tmp_path / "out"
    answer = command("decay", file, "--out", out)
    found = asperity.decay(file)
    assert found.report == answer
    assert_same_table(found.decays, out / "decays.csv")
    assert_same_table(found.backbone, out / "backbone.csv")
    in_memory = asperity.decay(acceleration, sample_rate_hz=8000, units=["m/s^2"], names=["top"])
    assert_same_numbers(in_memory.decays, found.decays)
    assert_same_numbers(in_memory.backbone, found.backbone)
    assert found.decays["damping_ratio"][0] == pytest.approx(0.01, rel=1e-3)
    banded = asperity.decay(file, bands_hz=[(150, 250)])
    assert banded.report["settings"] == {"bands_hz": [[150.0, 250.0]], "band_given": True}
    assert isinstance(found.conclusions, list) and isinstance(found.notices, list)


def test_channels_are_those_of_sep005(signals: tuple[Any, Any], file: Path) -> None:
    model = pytest.importorskip("sdypy_sep005").Sep005Data
    (channels,) = asperity.read(file)
    force, acceleration = signals
    assert [channel["name"] for channel in channels] == ["hammer", "top"]
    assert [channel["quantity"] for channel in channels] == ["f", "a"]
    np.testing.assert_array_equal(channels[1]["data"], acceleration)
    history = asperity.Table({"time_s": 0.5 + np.arange(5) / 1000, "displacement_m": np.arange(5)})
    for channel in [*channels, *asperity.to_sep005(history)]:
        model.model_validate(channel)
    (displacement,) = asperity.to_sep005(history)
    assert (displacement["name"], displacement["unit_str"]) == ("displacement", "m")
    assert displacement["fs"] == 1000.0 and displacement["time"][0] == 0.5


@pytest.mark.parametrize("name", ["a.uff", "a.unv", "a.csv", "a.npz", "ascii"])
def test_files_that_are_written_read_back(
    name: str, signals: tuple[Any, Any], tmp_path: Path
) -> None:
    force, acceleration = (signal[:1000] for signal in signals)
    channels = hammer.sep005(("hammer", "N", force), ("top", "m/s^2", acceleration))
    path = tmp_path / name
    asperity.write(path, channels, format="uff-ascii" if name == "ascii" else None, title="a test")
    (read,) = asperity.read(path)
    # Dataset 58 has 12 digits.
    tolerance = 1e-11 if name == "ascii" else 0.0
    for channel, expected in zip(read, channels, strict=True):
        assert (channel["name"], channel["fs"]) == (expected["name"], hammer.RATE)
        np.testing.assert_allclose(channel["data"], expected["data"], rtol=tolerance)
    with pytest.raises(FileExistsError, match="overwrite"):
        asperity.write(path, channels, format="uff")
    asperity.write(path, [force], sample_rate_hz=hammer.RATE, format="npz", overwrite=True)
    with pytest.raises(ValueError, match="uff-ascii"):
        asperity.write(tmp_path / "a.docx", channels)
    with pytest.raises(ValueError, match="wav|format"):
        asperity.write(tmp_path / "a.wav", channels)
    with pytest.raises(TypeError, match="path"):
        asperity.write(tmp_path / "b.uff", path)
    with pytest.raises(OSError):
        asperity.write(tmp_path / "none" / "b.uff", channels)


def test_units_and_notices_of_a_file(tmp_path: Path) -> None:
    file = hammer.write(tmp_path / "a.npz", ("x [mm]", np.arange(4.0)), ("y", np.arange(4.0)))
    with pytest.warns(UserWarning, match="no unit"):
        ((x, y),) = asperity.read(file, si=True)
    assert x["unit_str"] == "m" and x["data"].tolist() == [0.0, 1e-3, 2e-3, 3e-3]
    assert y["unit_str"] == "" and "quantity" not in y


def test_the_history_of_a_simulation_is_analysed() -> None:
    from conftest import SCENARIOS

    run = asperity.simulate(SCENARIOS / "nouira2020-modified.json")
    first = run.summary["fundamental"]
    sources: list[Any] = [run.history, asperity.to_sep005(run.history)]
    for package in ("pandas", "xarray"):
        if importlib.util.find_spec(package):
            sources.append(getattr(run.history, f"to_{package}")())
    for source in sources:
        found = asperity.analyse(source, band_hz=(400, 1200))
        assert found.responses[0].name.startswith("acceleration")
        assert found.hits["frequency_hz"][0] == pytest.approx(first["frequency_hz"], rel=1e-3)
        receptance = found.hits["magnitude_m_per_n"][0]
        assert receptance == pytest.approx(first["receptance_m_per_n"], rel=0.01)
    # The displacement is taken where it is asked for, and of other records nothing is assumed.
    found = asperity.analyse(run.history, response="displacement_m", band_hz=(400, 1200))
    assert found.responses[0].name == "displacement_m"
    names = ("time_s", "force_n", "displacement_m", "acceleration_m_per_s2")
    with pytest.raises(ValueError, match="several channels may be the response"):
        asperity.analyse(asperity.Table({name: run.history[name] for name in names}))


# Real measurements, compared with pyFRF.


def measured_hits() -> list[Any]:
    files = [hammer.MEASURED / f"hit_{n}.npy" for n in (1, 2, 3)]
    if not all(file.is_file() for file in files):
        pytest.skip(f"no measured hits at {hammer.MEASURED}")
    return [np.load(file) for file in files]


def test_averages_of_measured_hits_are_those_of_pyfrf() -> None:
    frf = pytest.importorskip("pyFRF").FRF
    hits = measured_hits()
    other = frf(
        sampling_freq=int(hammer.MEASURED_RATE), exc_type="f", resp_type="a", window="none",
        fft_len=25_600, weighting="linear",
    )
    for _, force, acceleration in hits:
        other.add_data(force, acceleration)
    average = asperity.signal.FrfAverage(25_600, hammer.MEASURED_RATE)
    for _, force, acceleration in hits:
        average.push(force, acceleration)
    inside = slice(60, 3000)
    for ours, theirs in (
        (receptance(average, average.h1()), np.squeeze(other.get_H1())),
        (receptance(average, average.h2()), np.squeeze(other.get_H2())),
        (average.coherence(), np.squeeze(other.get_coherence())),
    ):
        np.testing.assert_allclose(ours[inside], theirs[inside], rtol=1e-9)


def test_measured_universal_files_equal_their_arrays() -> None:
    hits = measured_hits()
    file = hammer.MEASURED / "hits_1_to_3_binary.uff"
    options: dict[str, Any] = {"units": ["N", "m/s^2"], "band_hz": (600, 1200)}
    of_file = asperity.analyse(file, **options)
    arrays = asperity.analyse(
        [hit[1:] for hit in hits], sample_rate_hz=hammer.MEASURED_RATE, **options
    )
    for name in ("force_peak_n", "frequency_hz", "damping_ratio", "harmonic_ratio"):
        np.testing.assert_array_equal(arrays.hits[name], of_file.hits[name], err_msg=name)


# The boundary: each fault an exception with words.


@pytest.mark.parametrize(
    ("source", "error", "words"),
    [
        (None, TypeError, "accepted"),
        (3, TypeError, "accepted"),
        ([], TypeError, "accepted"),
        (object(), TypeError, "accepted"),
        ([1.0, 2.0], TypeError, "accepted"),
        ({"a": 1}, ValueError, "data"),
        ([{"data": [1.0], "name": "x"}], ValueError, "unit_str"),
        ([{"data": [1.0], "name": 3, "unit_str": "N", "fs": 1}], TypeError, "name"),
        ([{"data": [1.0], "name": "x", "unit_str": "N"}], ValueError, "fs"),
        ([{"data": [1.0], "name": "x", "unit_str": "N", "fs": -1}], ValueError, "positive"),
        ([{"data": [1.0], "name": "x", "unit_str": "N", "fs": "a"}], TypeError, "number"),
        ([{"data": [1.0], "name": "x", "unit_str": "N", "time": [0, 1]}], ValueError, "times"),
        ([{"data": "abc", "name": "x", "unit_str": "N", "fs": 1}], ValueError, "one dimension"),
        ([{"data": ["a"], "name": "x", "unit_str": "N", "fs": 1}], TypeError, "real numbers"),
        ([{"data": [1j], "name": "x", "unit_str": "N", "fs": 1}], TypeError, "real numbers"),
        ([{"data": [None], "name": "x", "unit_str": "N", "fs": 1}], TypeError, "real numbers"),
        (
            [{"data": [1.0], "name": "x", "unit_str": "N", "fs": 1, "quantity": "q"}],
            ValueError,
            "accepted",
        ),
        (np.zeros((2, 2, 2, 2)), TypeError, "shape"),
        (np.zeros(()), TypeError, "shape"),
        (np.zeros((3, 3)), ValueError, "sample_axis"),
        (np.zeros((2, 0)), ValueError, "unit|samples|known"),
        (np.zeros((2, 50), dtype=complex), TypeError, "real numbers"),
        (np.zeros((2, 50), dtype=object), TypeError, "real numbers"),
        (np.array([["a", "b"]]), TypeError, "real numbers"),
        ("none.uff", FileNotFoundError, "none.uff"),
    ],
)
def test_sources_that_are_none_are_errors_in_words(
    source: Any, error: type[Exception], words: str
) -> None:
    for function in (asperity.analyse, asperity.decay):
        with pytest.raises(error, match=words):
            function(source, sample_rate_hz=100.0)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"hits": 0}, ValueError, "number from 1"),
        ({"hits": -1}, ValueError, "0 and above"),
        ({"hits": 2.5}, TypeError, "whole number"),
        ({"hits": 9}, asperity.ComputationError, "9 hits requested"),
        ({"estimator": "h3"}, asperity.ScenarioError, "h1"),
        ({"window": "hann"}, asperity.ScenarioError, "exponential"),
        ({"form": "stiffness"}, ValueError, "receptance"),
        ({"band_hz": (120, 80)}, asperity.ScenarioError, "band_hz|second above"),
        ({"band_hz": (80,)}, asperity.ScenarioError, "band_hz"),
        ({"level_n": -1}, asperity.ScenarioError, "level_n"),
        ({"level_n": "high"}, asperity.ScenarioError, "level_n"),
        ({"level_n": float("nan")}, ValueError, "JSON|finite|range"),
        ({"level_n": 1e9}, asperity.ComputationError, "no hit"),
        ({"hold_off_s": 1e-3}, asperity.ScenarioError, "longer than"),
        ({"force": "none"}, ValueError, "none"),
        ({"response": ["top", "top"]}, ValueError, "twice"),
        ({"response": 3.5}, TypeError, "whole number|iterable"),
        ({"sensitivity": "hammer=3"}, ValueError, "3"),
        ({"units": ["N", "furlong"]}, ValueError, "furlong"),
        ({"units": [3]}, TypeError, "str"),
        ({"sample_axis": "middle"}, ValueError, "first"),
        ({"rig": 3}, TypeError, "path or a dict"),
        ({"rig": {"schema": "asperity/rig/1", "bnad_hz": [1, 2]}}, asperity.ScenarioError, "band"),
        ({"rig": "none.json"}, FileNotFoundError, "none.json"),
        ({"progress": 3}, TypeError, "callable"),
    ],
)
def test_wrong_options_are_errors_in_words(
    options: dict[str, Any], error: type[Exception], words: str, signals: tuple[Any, Any]
) -> None:
    channels = hammer.sep005(("hammer", "N", signals[0]), ("top", "m/s^2", signals[1]))
    with pytest.raises(error, match=words):
        asperity.analyse(channels, **options)


@pytest.mark.parametrize("text", ["[1]", "3", "null", "{", "", "\x00"])
def test_files_that_are_no_rig_are_errors(text: str, signals: tuple[Any, Any], tmp_path: Path) -> None:
    rig = tmp_path / "rig.json"
    rig.write_text(text, encoding="utf-8")
    channels = hammer.sep005(("hammer", "N", signals[0]), ("top", "m/s^2", signals[1]))
    with pytest.raises(asperity.ScenarioError):
        asperity.analyse(channels, rig=rig, level_n=5.0)


def test_samples_of_any_layout_give_the_same_numbers(signals: tuple[Any, Any]) -> None:
    force, acceleration = (np.round(1000 * signal) for signal in signals)
    expected = asperity.analyse(
        hammer.sep005(("f", "mN", force), ("a", "mm/s^2", acceleration))
    ).hits["frequency_hz"]
    read_only = acceleration.copy()
    read_only.flags.writeable = False
    for other in (
        acceleration.astype(">f8"),
        acceleration.astype(np.int64),
        acceleration.astype(">i4"),
        np.repeat(acceleration, 3)[::3],
        acceleration[::-1].copy()[::-1],
        np.asfortranarray(np.stack([acceleration, force]))[0],
        read_only,
        acceleration.tolist(),
    ):
        found = asperity.analyse(hammer.sep005(("f", "mN", force), ("a", "mm/s^2", other)))
        np.testing.assert_array_equal(found.hits["frequency_hz"], expected)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_samples_that_are_not_finite_are_a_verdict(value: float, signals: tuple[Any, Any]) -> None:
    force, acceleration = (signal.copy() for signal in signals)
    acceleration[5400] = value
    found = asperity.analyse(hammer.sep005(("f", "N", force), ("a", "m/s^2", acceleration)))
    assert found.hits["averaged"].tolist() == [True, False, True, True]
    with pytest.raises(asperity.ComputationError):
        asperity.analyse(
            hammer.sep005(("f", "N", np.full(5000, value)), ("a", "m/s^2", acceleration[:5000]))
        )


def test_progress_rises_and_its_exception_is_passed_on(signals: tuple[Any, Any]) -> None:
    channels = hammer.sep005(("f", "N", signals[0]), ("a", "m/s^2", signals[1]))
    told: list[float] = []
    asperity.analyse(channels, progress=told.append)
    assert told == sorted(told) and told[-1] == 1.0

    def stop(fraction: float) -> None:
        raise LookupError("stopped")

    with pytest.raises(LookupError, match="stopped"):
        asperity.analyse(channels, progress=stop)


def test_threads_that_call_at_once_get_the_same_result(signals: tuple[Any, Any]) -> None:
    channels = hammer.sep005(("f", "N", signals[0]), ("a", "m/s^2", signals[1]))
    alone = asperity.analyse(channels)
    results: list[asperity.Analysis] = []
    threads = [
        threading.Thread(target=lambda: results.append(asperity.analyse(channels)))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [result.report == alone.report for result in results] == [True] * 4


def test_arrays_take_the_sample_rate_of_the_rig(tmp_path: Path) -> None:
    rig = {"schema": "asperity/rig/1", "sample_rate_hz": 50_000, "band_hz": [700, 1100]}
    (tmp_path / "rig.json").write_text(json.dumps(rig), encoding="utf-8")
    scenario = asperity.Scenario(SCENARIOS / "nouira2020-modified.json").with_(
        {"/method": "modal", "/output_rate_hz": 50_000}
    )
    history = asperity.simulate(scenario).history
    signals = [history["force_n"], history["acceleration_m_per_s2"]]
    units = ["N", "m/s^2"]
    given = asperity.analyse(signals, sample_rate_hz=50_000, units=units, band_hz=(700, 1100))
    for of_rig in (rig, tmp_path / "rig.json"):
        found = asperity.analyse(signals, rig=of_rig, units=units)
        assert found.hits["frequency_hz"].tolist() == given.hits["frequency_hz"].tolist()
    with pytest.raises(ValueError, match="no sample rate"):
        asperity.analyse(signals, rig={"schema": "asperity/rig/1"}, units=units)
