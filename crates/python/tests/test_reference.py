"""The reference of the package in the book is that of its docstrings."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Iterator
from types import ModuleType

import pytest

import asperity
from conftest import ROOT

GENERATOR = ROOT / "crates" / "python" / "reference.py"


@pytest.fixture(scope="module")
def reference() -> Iterator[ModuleType]:
    """The program that writes the page."""
    spec = importlib.util.spec_from_file_location("reference", GENERATOR)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, spec.name, module)  # dataclasses look their module up
        spec.loader.exec_module(module)
        yield module


def test_the_page_is_that_of_the_docstrings(reference: ModuleType) -> None:
    written = reference.PAGE.read_text(encoding="utf-8").splitlines()
    given = reference.page().splitlines()
    different = [
        f"line {number}: {ours!r} instead of {theirs!r}"
        for number, (ours, theirs) in enumerate(zip(written, given), start=1)
        if ours != theirs
    ]
    assert written == given, f"{reference.REGENERATE}; {different[:1]}"


def test_links_of_the_page_lead_to_entries(reference: ModuleType) -> None:
    text = reference.page()
    anchors = re.findall(r'<a id="([^"]+)"></a>', text)
    assert len(set(anchors)) == len(anchors)
    assert set(re.findall(r"\]\(#([^)]+)\)", text)) <= set(anchors)
    for name in set(asperity.__all__) - reference.LEFT_OUT:
        assert f"asperity.{name}" in anchors


def test_docstrings_become_markdown(reference: ModuleType) -> None:
    text = """Scale x_1 by ``2 * k``, as `sweep`.

    Parameters
    ----------
    values, others : array of shape (n,)
        Numbers in N,
        any sign.
    kind : {"a", "b"}, optional
        Kind.

    Returns
    -------
    Table
        Columns.

    Raises
    ------
    ValueError
        If not.

    Examples
    --------
    >>> scale(1)   # doctest: +SKIP
    2
    """
    links = {"sweep": "#sweep", "Table": "#table"}
    found = reference.markdown(reference.inspect.cleandoc(text), links)
    assert found == (
        "Scale x\\_1 by `2 * k`, as [`sweep`](#sweep).\n\n"
        "**Parameters**\n\n"
        "- `values`, `others` (array of shape (n,)): Numbers in N,\n  any sign.\n"
        '- `kind` (`{"a", "b"}`, optional): Kind.\n\n'
        "**Returns**\n\n"
        "- [`Table`](#table): Columns.\n\n"
        "**Raises**\n\n"
        "- `ValueError`: If not.\n\n"
        "**Examples**\n\n"
        "```python\n>>> scale(1)\n2\n```\n"
    )
