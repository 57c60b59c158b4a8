"""Measurements as files, arrays and SEP005 channels."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _asperity
from ._numbers import columns_of, is_frame, is_series, unit_of, unmasked
from ._table import Table
from ._warning import note

Path = str | os.PathLike[str]
#: Channel by SEP005: a dict with ``data``, ``name``, ``unit_str``, and ``fs`` or ``time``.
Channel = Mapping[str, Any]

_ACCEPTED = (
    "accepted: a path or several, an array of shape (channels, samples) or (samples, channels), "
    "one-dimensional arrays or Series sampled together, a DataFrame or Table, or SEP005 channels "
    "(dicts with data, name, unit_str, and fs or time); for several records a list of any but paths"
)
_QUANTITIES = ("f", "a", "v", "d", "e", "s")


def _is_path(value: object) -> bool:
    return isinstance(value, str | os.PathLike)


def _is_sequence(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Sequence) and not isinstance(value, str | bytes)


def _channel(channel: Channel, at: str) -> dict[str, Any]:
    """A SEP005 channel with all keys that the native part reads."""
    for key in ("data", "name", "unit_str"):
        if key not in channel:
            raise ValueError(f"{at} has no {key!r}; SEP005 channels have data, name and unit_str")
    name, unit = channel["name"], channel["unit_str"]
    for key, text in (("name", name), ("unit_str", unit)):
        if not isinstance(text, str):
            raise TypeError(f"{key!r} of {at} is {text!r}; accepted: str")
    quantity = channel.get("quantity")
    if quantity is not None and quantity not in _QUANTITIES:
        known = ", ".join(_QUANTITIES)
        raise ValueError(f"'quantity' of channel {name!r} is {quantity!r}; accepted: {known}")
    data = _arrays.real(f"'data' of channel {name!r}", channel["data"])
    rate, times, rounding = channel.get("fs"), channel.get("time"), 0.0
    if rate is None and times is None:
        raise ValueError(f"channel {name!r} has neither 'fs' nor 'time'")
    if times is not None:
        dtype = np.asarray(times).dtype
        rounding = float(np.finfo(dtype).eps) if dtype.kind == "f" else 0.0
        times = _arrays.real(f"'time' of channel {name!r}", times)
        if len(times) != len(data):
            raise ValueError(f"channel {name!r} has {len(data)} samples but {len(times)} times")
        if not np.isfinite(times).all():
            raise ValueError(f"'time' of channel {name!r} must be finite")
    if rate is not None:
        rate = _arrays.number(f"'fs' of channel {name!r}", rate)
        if not (rate > 0 and np.isfinite(rate)):
            raise ValueError(f"'fs' of channel {name!r} is {rate}; accepted: a positive rate in Hz")
        if times is not None and len(times) > 1:
            length = (times[-1] - times[0]) * rate
            if not abs(length - (len(times) - 1)) < 0.5:
                raise ValueError(f"'fs' and 'time' of channel {name!r} contradict each other")
    return {
        "name": name,
        "unit_str": unit,
        "quantity": quantity,
        "data": data,
        "fs": rate,
        "time": times,
        "rounding": rounding,
    }


def _unnamed(
    columns: Iterable[NDArray[Any]], sample_rate_hz: float | None
) -> list[dict[str, Any]]:
    """Arrays as channels; names and units are those that the call gives, by their order."""
    if sample_rate_hz is None:
        raise ValueError("arrays have no sample rate; give sample_rate_hz")
    rate = _arrays.number("sample_rate_hz", sample_rate_hz)
    return [
        _channel(
            {"data": column, "name": f"channel {number}", "unit_str": "", "fs": rate},
            f"channel {number}",
        )
        for number, column in enumerate(columns, start=1)
    ]


def _named(columns: Iterable[Any], sample_rate_hz: float | None) -> list[dict[str, Any]]:
    """Columns of data frames as channels with the names of the columns."""
    columns = list(columns)
    found = _unnamed([unmasked(column) for column in columns], sample_rate_hz)
    for channel, column in zip(found, columns, strict=True):
        if column.name is not None:
            channel["name"] = str(column.name)
    return found


def _of_frame(frame: Any, sample_rate_hz: float | None) -> list[dict[str, Any]]:
    """A data frame or table as channels: names are those of the columns, units the endings of the
    names, and times a column ``time_s``."""
    named = frame if isinstance(frame, Table) else columns_of(frame)
    columns = {str(name): unmasked(values) for name, values in named.items()}
    times = columns.pop("time_s", None)
    if times is None and sample_rate_hz is None:
        raise ValueError("there is no column 'time_s' and no sample rate; give sample_rate_hz")
    timing: dict[str, Any] = {"time": times}
    if sample_rate_hz is not None:
        timing = {"fs": sample_rate_hz}
    elif (rate := _asperity.even_rate(_arrays.real("time_s", times))) is not None:
        timing = {"fs": rate, "time": times}
    return [
        _channel({"data": data, "name": name, "unit_str": unit_of(name)[1], **timing}, name)
        for name, data in columns.items()
    ]


def _columns(array: NDArray[Any], sample_axis: str | None) -> NDArray[Any]:
    """An array of shape (channels, samples)."""
    rows, columns = array.shape
    if sample_axis is None and rows == columns and rows > 1:
        raise ValueError(
            f"an array of shape {array.shape} does not tell which axis holds the samples; "
            'give sample_axis "first" or "last"'
        )
    first = rows > columns if sample_axis is None else sample_axis == "first"
    return array.T if first else array


def _record(
    value: Any, sample_rate_hz: float | None, sample_axis: str | None
) -> list[dict[str, Any]] | None:
    """The channels of one record; None for something else."""
    if isinstance(value, Table) or is_frame(value):
        return _of_frame(value, sample_rate_hz)
    if isinstance(value, Mapping):
        return [_channel(value, "the channel")]
    if is_series(value):
        return _named([value], sample_rate_hz)
    if isinstance(value, np.ndarray):
        if value.ndim == 2:
            return _unnamed(_columns(value, sample_axis), sample_rate_hz)
        return _unnamed([value], sample_rate_hz) if value.ndim == 1 else None
    if not _is_sequence(value) or len(value) == 0:
        return None
    if all(isinstance(channel, Mapping) and not isinstance(channel, Table) for channel in value):
        return [_channel(channel, f"channel {n}") for n, channel in enumerate(value, start=1)]
    if all(is_series(column) for column in value):
        return _named(value, sample_rate_hz)
    if all(isinstance(column, np.ndarray) and column.ndim == 1 for column in value):
        return _unnamed(value, sample_rate_hz)
    return None


def sources(
    source: Any, sample_rate_hz: float | None, sample_axis: str | None
) -> list[str] | list[list[dict[str, Any]]]:
    """Paths, or records in arrays, for the native part."""
    if _is_path(source):
        return [os.fspath(source)]
    if isinstance(source, Sequence) and len(source) > 0 and all(map(_is_path, source)):
        return [os.fspath(path) for path in source]
    record = _record(source, sample_rate_hz, sample_axis)
    if record is not None:
        return [record]
    if isinstance(source, np.ndarray) and source.ndim == 3:
        source = list(source)
    if _is_sequence(source) and len(source) > 0:
        records = [_record(item, sample_rate_hz, sample_axis) for item in source]
        found = [record for record in records if record is not None]
        if len(found) == len(records):
            return found
    kind = f"an array of shape {source.shape}" if isinstance(source, np.ndarray) else type(source)
    raise TypeError(f"measurements cannot be {kind}; {_ACCEPTED}")


def records_in_place(source: Any, sample_rate_hz: float | None) -> list[Any]:
    """Records as a document holds them: paths as they are, samples as lists."""
    found = sources(source, sample_rate_hz, None)
    return [record if isinstance(record, str) else _in_place(record) for record in found]


def _in_place(record: list[dict[str, Any]]) -> dict[str, Any]:
    rates = {
        channel["fs"] if channel["time"] is None else _asperity.even_rate(channel["time"])
        for channel in record
    }
    rate = rates.pop()
    if rates or rate is None:
        raise ValueError("the channels of a record must have one sample rate, and even times")
    channels = [
        {
            "name": channel["name"],
            "unit": channel["unit_str"],
            "data": [x if x == x else None for x in channel["data"].tolist()],
        }
        for channel in record
    ]
    return {"sample_rate_hz": rate, "channels": channels}


def texts(name: str, value: Iterable[str] | str | None) -> list[str]:
    """A list of texts of one or several."""
    if value is None:
        return []
    listed = [value] if isinstance(value, str) else list(value)
    for text in listed:
        if not isinstance(text, str):
            raise TypeError(f"{name} holds {text!r}; accepted: str")
    return listed


def read(
    paths: Path | Sequence[Path],
    *,
    sample_rate_hz: float | None = None,
    names: Sequence[str] = (),
    units: Sequence[str] = (),
    sample_axis: str | None = None,
    si: bool = False,
    progress: Callable[[float], object] | None = None,
) -> list[list[dict[str, Any]]]:
    """Read measurement files as records of SEP005 channels.

    Formats are detected from the content: universal files, text, NPY, NPZ, MAT, HDF5, WAV, TDMS.
    Records over frequency and complex channels are left out. Assumptions of the reader are a `NoticeWarning`.

    Parameters
    ----------
    paths : path or sequence of paths
        Files, folders, and patterns such as ``"hits/*.npy"``.
    sample_rate_hz : float, optional
        Sample rate in Hz of files without one.
    names, units : sequence of str, optional
        Of the channels in their order; an empty one keeps that of the file.
    sample_axis : {"first", "last"}, optional
        Axis of an array along which the samples run; by default the longer one.
    si : bool
        Convert channels with a known unit to SI.
    progress : callable, optional
        Called with the fraction done, 0 to 1. An exception that it raises stops the reading and is
        passed on.

    Returns
    -------
    list of list of dict
        The channels of each record, which were sampled together, with ``name``, ``unit_str`` (empty
        if unknown), ``data`` (array of shape ``(samples,)`` in that unit), ``fs`` in Hz for even
        samples, ``time`` in s for others and for those that do not begin at zero, and ``quantity``
        where it is known.

    Raises
    ------
    TypeError
        If `paths` holds something else than paths.
    OSError
        If a file cannot be read.
    ValueError
        If its content or an option is not valid.
    """
    several = [paths] if _is_path(paths) else paths
    if not isinstance(several, Iterable):
        raise TypeError(f"paths is {paths!r}; accepted: a path or several")
    separate: list[Any] = list(several)
    if not all(map(_is_path, separate)):
        raise TypeError(f"paths is {paths!r}; accepted: a path or several")
    listed = [os.fspath(path) for path in separate]
    rate = None if sample_rate_hz is None else _arrays.number("sample_rate_hz", sample_rate_hz)
    records, notices = _asperity.read(
        listed,
        rate,
        texts("names", names),
        texts("units", units),
        sample_axis,
        bool(si),
        progress,
    )
    note(notices)
    return records


def write(
    path: Path,
    source: Any,
    *,
    sample_rate_hz: float | None = None,
    sample_axis: str | None = None,
    format: str | None = None,
    title: str = "",
    overwrite: bool = False,
) -> None:
    """Write measurements to a file that other programs read.

    Parameters
    ----------
    path : str or os.PathLike
        File to write; it appears complete or not at all.
    source : array, SEP005 channels, or several of them
        As for `analyse`, but for paths.
    sample_rate_hz : float, optional
        Sample rate in Hz of arrays.
    sample_axis : {"first", "last"}, optional
        Axis of an array along which the samples run; by default the longer one.
    format : {"uff", "uff-ascii", "csv", "npz"}, optional
        Universal file (dataset 58b or 58), text, or arrays of NumPy; by default that of the name.
    title : str
        Title of the measurement, for universal files.
    overwrite : bool
        Replace an existing file.

    Raises
    ------
    TypeError
        If `source` is none of the above.
    ValueError
        If a channel or an option is not valid, or the format cannot hold the channels.
    FileExistsError
        If the file exists and is not to be replaced.
    OSError
        If the file cannot be written.
    """
    records = sources(source, sample_rate_hz, sample_axis)
    if any(isinstance(record, str) for record in records):
        raise TypeError(f"measurements to write cannot be a path; {_ACCEPTED}")
    channels = [record for record in records if isinstance(record, list)]
    _asperity.write(os.fspath(path), channels, format, title, bool(overwrite))


def to_sep005(table: Table | Mapping[str, Any]) -> list[dict[str, Any]]:
    """Columns over time as SEP005 channels, such as the history of a simulation.

    Parameters
    ----------
    table : Table, mapping or data frame
        Columns of equal length, one of them ``time_s``, evenly spaced.

    Returns
    -------
    list of dict
        A channel for each further column of numbers: ``name`` without the unit, ``unit_str`` by the
        ending of the name, ``data`` of shape (rows,) in that unit, ``fs`` in Hz, and ``time`` in s if
        it does not begin at zero.

    Raises
    ------
    TypeError
        If the times are not real numbers.
    ValueError
        If there is no column ``time_s``, or its steps are not equal.

    Examples
    --------
    >>> run = asperity.simulate("rig.json")                           # doctest: +SKIP
    >>> asperity.analyse(asperity.to_sep005(run.history), ...)        # doctest: +SKIP
    """
    if is_frame(table):
        table = columns_of(table)
    if "time_s" not in table:
        raise ValueError(f"there is no column 'time_s'; the columns are {', '.join(table)}")
    times = _arrays.real("time_s", table["time_s"])
    rate = _asperity.even_rate(times)
    if rate is None:
        raise ValueError("the steps of time_s are not equal")
    channels = []
    for column, values in table.items():
        data = np.asarray(unmasked(values))
        if column == "time_s" or data.dtype.kind not in "fiu":
            continue
        ending, unit = unit_of(column)
        channel = {
            "name": column.removesuffix(ending),
            "unit_str": unit,
            "data": data,
            "fs": rate,
        }
        if times[0] != 0.0:
            channel["time"] = times.tolist()
        channels.append(channel)
    return channels
