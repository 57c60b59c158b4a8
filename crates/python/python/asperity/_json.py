"""JSON text of Python values, with the numbers and arrays of NumPy, laws and tables."""

from __future__ import annotations

import json
import os
import secrets
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _asperity
from ._table import Table


def _plain(value: object) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, _asperity.Law):
        return value.to_dict()
    if isinstance(value, Table):
        return {name: _cells(column) for name, column in value.items()}
    raise TypeError(
        f"a document cannot hold a {type(value).__name__}; "
        "accepted: dict, list, tuple, str, int, float, bool, None, numbers and arrays of NumPy, Law, Table"
    )


def _cells(column: NDArray[Any]) -> list[Any]:
    """The cells of a column, None where there is no value."""
    if column.dtype.kind != "f":
        return column.tolist()  # type: ignore[no-any-return]
    return [number if number == number else None for number in column.tolist()]


def text_of(value: object) -> str:
    """JSON text of `value`; numbers that are not finite are a ValueError."""
    return json.dumps(value, allow_nan=False, default=_plain)


def save(scenario: _asperity.Scenario, path: str | os.PathLike[str], *, overwrite: bool) -> None:
    """`Scenario.save`."""
    target = Path(path)
    if not overwrite and target.exists():
        raise FileExistsError(f"{target}: the file exists; overwrite=True replaces it")
    document = _moved(scenario.to_dict(), Path(scenario.folder).absolute(), target.absolute().parent)
    # Renamed when it is complete: readers see the old file or the new one.
    partial = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        with partial.open("x", encoding="utf-8", newline="\n") as file:
            json.dump(document, file, indent=2, ensure_ascii=False)
            file.write("\n")
        os.replace(partial, target)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise


#: Keys whose texts are names of files: of samples, matrices, meshes and cells.
_FILES = {"file", "stiffness", "mass", "rows", "mesh", "cells"}


def _moved(value: Any, old: Path, new: Path) -> Any:
    """A document for another folder: each relative name of a file leads to the same file."""
    if isinstance(value, dict):
        return {
            key: _led(member, old, new)
            if key in _FILES and isinstance(member, str)
            else _moved(member, old, new)
            for key, member in value.items()
        }
    if isinstance(value, list):
        return [_moved(member, old, new) for member in value]
    return value


def _led(name: str, old: Path, new: Path) -> str:
    if old == new or os.path.isabs(name):
        return name
    try:
        return Path(os.path.relpath(old / name, new)).as_posix()
    except ValueError:  # another drive
        return (old / name).as_posix()
