"""JSON text of Python values, with the numbers and arrays of NumPy, and laws."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from . import _asperity


def _plain(value: object) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    if isinstance(value, _asperity.Law):
        return value.to_dict()
    raise TypeError(
        f"a document cannot hold a {type(value).__name__}; "
        "accepted: dict, list, tuple, str, int, float, bool, None, numbers and arrays of NumPy, Law"
    )


def text_of(value: object) -> str:
    """JSON text of `value`; numbers that are not finite are a ValueError."""
    return json.dumps(value, allow_nan=False, default=_plain)
