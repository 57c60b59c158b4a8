"""Scenarios of the repository, and the command to compare with."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
SCENARIOS = ROOT / "fixtures" / "scenarios"

# Values that depend on the run, not on the numbers.
OF_THE_RUN = {"wall_s"}


def read_csv(path: Path) -> dict[str, Any]:
    """Columns of a table: floats, NaN for an empty field, or text."""
    with path.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns: dict[str, Any] = {}
    for name, fields in zip(header, zip(*rows, strict=True), strict=True):
        try:
            columns[name] = np.array([float(field) if field else np.nan for field in fields])
        except ValueError:
            columns[name] = list(fields)
    return columns


def without_times(value: Any) -> Any:
    """A document without the times that its computation took."""
    if isinstance(value, dict):
        return {key: without_times(v) for key, v in value.items() if key not in OF_THE_RUN}
    if isinstance(value, list):
        return [without_times(item) for item in value]
    return value


def assert_same_columns(table: Any, path: Path) -> None:
    """The columns of `table` are those of the file, to the last bit."""
    written = read_csv(path)
    assert list(table) == list(written)
    for name, column in table.items():
        expected = written[name]
        if isinstance(expected, list) and column.dtype.kind in "bf":
            # Truth values; those that are not known are NaN and empty.
            words = {0.0: "false", 1.0: "true"}
            assert [words.get(float(value), "") for value in column] == expected, name
        elif column.dtype.kind == "U":
            texts = expected if isinstance(expected, list) else [""] * len(expected)
            assert column.tolist() == texts, name
        else:
            finite = np.where(np.isfinite(column), column, np.nan)
            np.testing.assert_array_equal(finite, expected, err_msg=name, strict=False)


#: The command, as the package installs it.
COMMAND = Path(sysconfig.get_path("scripts")) / ("asperity.exe" if os.name == "nt" else "asperity")


@pytest.fixture(scope="session")
def command() -> Callable[..., dict[str, Any]]:
    """The command `asperity` of the package: runs it, returns its answer."""

    def run(*arguments: object) -> dict[str, Any]:
        line = [str(COMMAND), *map(str, arguments), "--json", "--quiet"]
        done = subprocess.run(line, check=True, capture_output=True, text=True, timeout=600)
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer

    return run
