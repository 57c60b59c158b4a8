"""Matrices of a structure in memory, as files of a scenario."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._numbers import numbers


def write_matrices(
    folder: str | os.PathLike[str],
    stiffness: Any,
    mass: Any,
    dof: ArrayLike,
    *,
    name: str = "body",
    overwrite: bool = False,
) -> dict[str, str]:
    """Write stiffness and mass of a structure, and return the ``matrices`` of a body in a scenario.

    The files are ``NAME-stiffness.npz``, ``NAME-mass.npz`` and ``NAME.dof``. Names in the result are
    absolute, so that scenarios of any folder find them.

    Parameters
    ----------
    folder : str or os.PathLike
        Folder of the files; it is made if it does not exist.
    stiffness, mass : sparse array or array_like of shape (n, n)
        Symmetric matrices without contact, in N/m and kg unless the body states other units: sparse arrays
        of SciPy, or full ones.
    dof : array_like of int, shape (n, 2)
        Node (at least 1) and direction (1 to 3, or 4 to 6 for rotations) of each row.
    name : str
        Start of the files' names.
    overwrite : bool
        Replace existing files.

    Returns
    -------
    dict
        ``format``, ``stiffness``, ``mass`` and ``rows``.

    Raises
    ------
    TypeError
        If an entry is not a real number.
    ValueError
        If shapes do not fit.
    FileExistsError
        If a file exists and is not to be replaced.
    OSError
        If a file cannot be written.

    Examples
    --------
    >>> import numpy as np
    >>> k, m = np.array([[1e6, -1e6], [-1e6, 1e6]]), np.diag([2.0, 1.0])
    >>> matrices = write_matrices("rig", k, m, [[1, 3], [2, 3]])  # doctest: +SKIP
    >>> body = {"name": "chain", "matrices": matrices}            # doctest: +SKIP
    """
    rows = np.asarray(dof)
    if rows.ndim != 2 or rows.shape[1] != 2 or not np.issubdtype(rows.dtype, np.integer):
        raise ValueError("dof has a row of two integers, node and direction, for each row of the matrices")
    arrays = {
        label: _compressed(one, label, len(rows))
        for label, one in (("stiffness", stiffness), ("mass", mass))
    }
    base = Path(folder).absolute()
    paths = {label: base / f"{name}-{label}.npz" for label in arrays}
    listed = base / f"{name}.dof"
    if not overwrite:
        for path in (*paths.values(), listed):
            if path.exists():
                raise FileExistsError(f"{path} exists; overwrite=True replaces it")
    base.mkdir(parents=True, exist_ok=True)
    for label, parts in arrays.items():
        save: Any = np.savez_compressed
        save(paths[label], **parts)
    text = "".join(f"{node}.{direction}\n" for node, direction in rows.tolist())
    listed.write_text(text, encoding="ascii")
    return {
        "format": "npz",
        "stiffness": str(paths["stiffness"]),
        "mass": str(paths["mass"]),
        "rows": str(listed),
    }


def _compressed(matrix: Any, label: str, rows: int) -> dict[str, NDArray[Any]]:
    """Rows of a matrix, compressed as ``scipy.sparse.save_npz`` writes them."""
    if hasattr(matrix, "tocsr"):
        sparse = matrix.tocsr()
        data, indices, indptr = (getattr(sparse, part) for part in ("data", "indices", "indptr"))
        shape = tuple(sparse.shape)
    else:
        full = numbers(matrix, label)
        shape = full.shape
        if len(shape) == 2:
            places, indices = np.nonzero(full)
            data = full[places, indices]
            indptr = np.searchsorted(places, np.arange(shape[0] + 1))
    if shape != (rows, rows):
        raise ValueError(f"{label} has the shape {shape}; accepted: ({rows}, {rows}), as dof has rows")
    return {
        "data": numbers(data, label),
        "indices": np.asarray(indices, dtype=np.int64),
        "indptr": np.asarray(indptr, dtype=np.int64),
        "format": np.array(b"csr"),
        "shape": np.array(shape, dtype=np.int64),
    }
