"""Tables as mappings of columns."""

from __future__ import annotations

import numpy as np
import pytest

import asperity


def test_a_table_is_a_mapping_of_its_columns() -> None:
    table = asperity.Table({"time_s": np.arange(3.0), "force_n": np.zeros(3)})
    assert list(table) == ["time_s", "force_n"]
    assert len(table) == 2
    assert table.rows == 3
    assert "time_s" in table
    assert dict(table).keys() == table.keys()
    assert "3 rows" in repr(table)
    assert asperity.Table({}).rows == 0


def test_an_unknown_column_names_those_that_exist() -> None:
    table = asperity.Table({"time_s": np.arange(3.0)})
    with pytest.raises(KeyError, match="time_s"):
        table["force_n"]
    assert table.get("force_n") is None


def test_columns_of_other_shapes_are_errors() -> None:
    with pytest.raises(ValueError, match="equal lengths"):
        asperity.Table({"a": np.zeros(3), "b": np.zeros(2)})
    with pytest.raises(ValueError, match="one dimension"):
        asperity.Table({"a": np.zeros((3, 1))})
