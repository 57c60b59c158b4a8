"""The reference of the package as a page of the book, from signatures and docstrings.

    python reference.py            writes docs/src/reference/python.md
    python reference.py --check    fails if the page is not what the installed package gives

Docstrings are those of the installed package; signatures of compiled functions and classes are those
of its stub.
"""

from __future__ import annotations

import argparse
import ast
import builtins
import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import asperity
from asperity import _asperity

PAGE = Path(__file__).resolve().parents[2] / "docs" / "src" / "reference" / "python.md"

REGENERATE = (
    "regenerate the page with the installed package: python crates/python/reference.py"
)

HEAD = """\
# The Python package

<!-- Written by crates/python/reference.py from the docstrings of the package; edit these instead. -->

All functions, classes and exceptions of the package `asperity` and of its modules `asperity.plot` and
`asperity.signal`.
[Use asperity in Python](../how-to/use-python.md) introduces them; the pages of the part "In Python" show each
job. Numbers are in SI units, stated at the end of each name. `help(asperity.sweep)` prints the same text.

In signatures these names stand for longer types:

| name | meaning |
|---|---|
| `ScenarioLike` | `Scenario`, a path or JSON text (`str`, `os.PathLike`), or a `dict` |
| `ArrayLike` | a number, an array, or anything that NumPy makes an array of |
| `Floats`, `Complex` | an array of `float64`, of `complex128` |
| `Path` | `str` or `os.PathLike` |
| `Rig` | a `Path`, or a `dict` |
| `Values` | an array, a list, or a text such as `"9:32:24"` |
"""

#: Parts of the page: a title, the module, and names in their order.
PARTS: tuple[tuple[str, ModuleType, tuple[str, ...]], ...] = (
    ("Scenarios", asperity, ("Scenario",)),
    (
        "Responses",
        asperity,
        (
            "simulate",
            "Simulation",
            "MeshMotion",
            "sweep",
            "Sweep",
            "study",
            "Study",
            "steady",
            "SteadyResponses",
            "modes",
            "Modes",
            "write_matrices",
            "explore",
            "Explorer",
        ),
    ),
    (
        "Contact laws",
        asperity,
        (
            "Law",
            "laws",
            "tabulate",
            "LawTables",
            "fit_power",
            "PowerFit",
            "law_from_stiffness",
            "law_from_pressure",
        ),
    ),
    (
        "Measurements",
        asperity,
        (
            "analyse",
            "Analysis",
            "ResponseAnalysis",
            "decay",
            "DecayAnalysis",
            "read",
            "write",
            "to_sep005",
        ),
    ),
    ("Identification of laws", asperity, ("identify", "Identification")),
    ("Tables and figures", asperity, ("Table", "Figure")),
    ("Exceptions", asperity, ("ScenarioError", "ComputationError")),
    ("Warnings", asperity, ("AsperityWarning", "AccuracyWarning", "JudgementWarning", "NoticeWarning")),
    (
        "The module `asperity.plot`",
        asperity.plot,
        ("frf", "history", "law", "backbone", "features"),
    ),
    (
        "The module `asperity.signal`",
        asperity.signal,
        (
            "find_hits",
            "Hits",
            "Hit",
            "quality_issues",
            "QualityIssue",
            "pulse",
            "Pulse",
            "ForceWindow",
            "ResponseWindow",
            "ExponentialWindow",
            "FrfAverage",
            "convert_frf",
            "FrequencyResponse",
            "Harmonics",
            "Peak",
            "HalfPower",
            "circle_fit",
            "CircleFit",
            "logarithmic_decrement",
            "LogarithmicDecrement",
            "backbone",
        ),
    ),
)

#: Names of modules that have no entry of their own.
LEFT_OUT = {"STYLE", "__version__", "plot", "signal"}

#: Classes of results, which only the package makes: their arguments are not shown.
MADE = {
    "Analysis",
    "CircleFit",
    "DecayAnalysis",
    "Explorer",
    "HalfPower",
    "Harmonics",
    "Hit",
    "Hits",
    "Identification",
    "LawTables",
    "LogarithmicDecrement",
    "MeshMotion",
    "Modes",
    "PowerFit",
    "Pulse",
    "QualityIssue",
    "ResponseAnalysis",
    "Simulation",
    "SteadyResponses",
    "Study",
    "Sweep",
}

#: Sections of a docstring whose items are definitions.
DEFINITIONS = ("Parameters", "Attributes", "Returns", "Raises")

#: Longest line of a signature.
WIDTH = 96


@dataclasses.dataclass(frozen=True)
class Stub:
    """The stub of the compiled part."""

    classes: dict[str, ast.ClassDef]

    @classmethod
    def read(cls) -> Stub:
        path = Path(asperity.__file__).with_name("_asperity.pyi")
        body = ast.parse(path.read_text(encoding="utf-8")).body
        return cls({node.name: node for node in body if isinstance(node, ast.ClassDef)})

    def members(self, name: str) -> list[ast.FunctionDef]:
        """Methods and properties of a class in their order; an overload is one of several."""
        return [node for node in self.classes[name].body if isinstance(node, ast.FunctionDef)]


def page() -> str:
    """The page."""
    stub = Stub.read()
    links: dict[str, str] = {}
    for module in {module.__name__: module for _, module, _ in PARTS}.values():
        listed = {name for _, of, names in PARTS if of is module for name in names}
        missing = set(module.__all__) - listed - LEFT_OUT
        unknown = listed - set(module.__all__)
        if missing or unknown:
            raise ValueError(f"{module.__name__}: not in the reference: {missing}; unknown: {unknown}")
        # Columns have the names of functions that draw them.
        if module is not asperity.plot:
            links |= {name: f"#{anchor(module, name)}" for name in listed}
    parts = [HEAD]
    for title, module, names in PARTS:
        parts.append(f"## {title}\n")
        if module is not asperity:
            parts.append(text_of(module, links))
        for name in names:
            parts.append(f'<a id="{anchor(module, name)}"></a>\n')
            parts.extend(entry(name, getattr(module, name), links, stub))
    return re.sub(r"\n{3,}", "\n\n", "\n".join(parts)).rstrip() + "\n"


def anchor(module: ModuleType, name: str) -> str:
    """The anchor of an entry; those of headings do not tell `sweep` from `Sweep`."""
    return f"{module.__name__}.{name}"


def entry(name: str, value: Any, links: dict[str, str], stub: Stub) -> Iterator[str]:
    """The pieces of the text about a function or class."""
    yield f"### `{name}`\n"
    if not inspect.isclass(value):
        yield code([signature(name, value)])
        yield text_of(value, links)
        return
    compiled = name in stub.classes and getattr(_asperity, name) is value
    bases = [base.__name__ for base in value.__bases__ if base is not object]
    if issubclass(value, Exception) or (name in MADE and bases):
        yield code([f"class {name}({', '.join(bases)})"])
    elif name not in MADE:
        if compiled:
            made = [node for node in stub.members(name) if node.name == "__new__"]
            if made:
                yield code([stub_signature(node, name, owner=True) for node in made])
        else:
            yield code([signature(name, value)])
    yield text_of(value, links)
    members = compiled_members(name, stub) if compiled else python_members(value)
    for member, lines in members:
        yield f"#### `{name}.{member}`\n"
        yield code(lines)
        yield text_of(inspect.getattr_static(value, member), links)


def compiled_members(name: str, stub: Stub) -> Iterator[tuple[str, list[str]]]:
    """Public members of a compiled class, with their signatures."""
    found: dict[str, list[str]] = {}
    for node in stub.members(name):
        if node.name.startswith("_"):
            continue
        decorators = {ast.unparse(decorator) for decorator in node.decorator_list}
        if "property" in decorators:
            found[node.name] = [attribute(node.name, annotation(node.returns))]
        else:
            found.setdefault(node.name, []).append(stub_signature(node, node.name, owner=True))
    yield from found.items()


def python_members(value: type) -> Iterator[tuple[str, list[str]]]:
    """Public methods and properties that a class defines, with their signatures."""
    fields = {field.name for field in dataclasses.fields(value)} if dataclasses.is_dataclass(value) else set()
    for name, member in vars(value).items():
        if name.startswith("_") or name in fields or name in getattr(value, "__slots__", ()):
            continue
        if isinstance(member, property):
            assert member.fget is not None
            returned = inspect.signature(member.fget).return_annotation
            yield name, [attribute(name, shortened(returned))]
        elif isinstance(member, classmethod):
            yield name, ["@classmethod\n" + signature(name, member.__func__, owner=True)]
        elif inspect.isfunction(member):
            yield name, [signature(name, member, owner=True)]


def attribute(name: str, kind: str) -> str:
    return f"{name}: {kind}"


def signature(name: str, value: Callable[..., Any], *, owner: bool = False) -> str:
    """The signature of a function or of the arguments of a class."""
    found = inspect.signature(value)
    parameters = list(found.parameters.values())[1 if owner else 0 :]
    texts: list[str] = []
    keyword_only = False
    for parameter in parameters:
        if parameter.kind is parameter.KEYWORD_ONLY and not keyword_only:
            texts.append("*")
            keyword_only = True
        text = f"**{parameter.name}" if parameter.kind is parameter.VAR_KEYWORD else parameter.name
        if parameter.annotation is not parameter.empty:
            text += f": {shortened(parameter.annotation)}"
        if parameter.default is not parameter.empty:
            text += f" = {parameter.default!r}".replace("'", '"')
        texts.append(text)
    returned = found.return_annotation
    is_class = inspect.isclass(value)
    end = "" if is_class or returned is found.empty else f" -> {shortened(returned)}"
    return laid_out(name, texts, end)


def stub_signature(node: ast.FunctionDef, name: str, *, owner: bool) -> str:
    """The signature of a function of the stub."""
    arguments = node.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults: list[ast.expr | None] = [None] * (len(positional) - len(arguments.defaults))
    defaults += arguments.defaults
    texts = [stub_argument(*pair) for pair in zip(positional, defaults)][1 if owner else 0 :]
    if arguments.kwonlyargs:
        texts.append("*")
        texts += [stub_argument(*pair) for pair in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    end = "" if node.name == "__new__" else f" -> {annotation(node.returns)}"
    return laid_out(name, texts, end)


def stub_argument(argument: ast.arg, default: ast.expr | None) -> str:
    text = argument.arg
    if argument.annotation is not None:
        text += f": {annotation(argument.annotation)}"
    return text if default is None else f"{text} = {ast.unparse(default)}"


def annotation(node: ast.expr | None) -> str:
    return "None" if node is None else shortened(ast.unparse(node))


def shortened(kind: Any) -> str:
    """An annotation with the names that the head of the page explains."""
    text = kind if isinstance(kind, str) else inspect.formatannotation(kind)
    text = re.sub(r"\b_(?=(ScenarioLike|Floats|Complex)\b)", "", text)
    text = text.replace("NDArray[np.float64]", "Floats").replace("NDArray[np.complex128]", "Complex")
    text = text.replace("NDArray[np.bool_]", "NDArray[bool]")
    return re.sub(r"\b(_asperity|asperity)\.(?=\w)", "", text).replace("'", '"')


def laid_out(name: str, parameters: list[str], end: str) -> str:
    """A signature in one line, or with a line for each parameter."""
    line = f"{name}({', '.join(parameters)}){end}"
    if len(line) <= WIDTH:
        return line
    return f"{name}(\n" + "".join(f"    {one},\n" for one in parameters) + f"){end}"


def code(lines: list[str]) -> str:
    return "```python\n" + "\n".join(lines) + "\n```\n"


def text_of(value: Any, links: dict[str, str]) -> str:
    """The docstring of a value as Markdown."""
    text = getattr(value, "__doc__", None)
    if not text:
        name = getattr(value, "__qualname__", getattr(value, "__name__", repr(value)))
        raise ValueError(f"{name} has no docstring")
    return markdown(inspect.cleandoc(text), links)


def markdown(text: str, links: dict[str, str]) -> str:
    """A docstring in the style of numpydoc as Markdown."""
    pieces: list[str] = []
    for title, lines in sections(text):
        if title in DEFINITIONS:
            pieces.append(f"**{title}**\n")
            pieces.extend(definitions(title, lines, links))
            pieces.append("")
        elif title == "Examples":
            pieces.append("**Examples**\n")
            pieces.append(code(example(lines)))
        elif title is None:
            pieces.append(prose(lines, links) + "\n")
        else:
            raise ValueError(f"unknown section {title!r} in a docstring")
    return "\n".join(pieces)


def sections(text: str) -> Iterator[tuple[str | None, list[str]]]:
    """The sections of a docstring; the text before the first has no title."""
    title: str | None = None
    found: list[str] = []
    lines = text.splitlines()
    index = 0
    while index < len(lines):
        following = lines[index + 1] if index + 1 < len(lines) else ""
        if following and set(following) == {"-"} and len(following) == len(lines[index]):
            yield title, found
            title, found = lines[index], []
            index += 2
            continue
        found.append(lines[index])
        index += 1
    yield title, found


def definitions(title: str, lines: list[str], links: dict[str, str]) -> Iterator[str]:
    """Items of a section, as a list."""
    head: str | None = None
    body: list[str] = []
    for line in [*lines, "end"]:
        if line and not line.startswith(" "):
            if head is not None:
                yield item(title, head, body, links)
            head, body = line, []
        else:
            body.append(line[4:])


def item(title: str, head: str, body: list[str], links: dict[str, str]) -> str:
    names, separator, kind = head.partition(" : ")
    named = title in ("Parameters", "Attributes")
    if named:
        text = ", ".join(f"`{name}`" for name in names.split(", "))
        if separator:
            text += f" ({kind_of(kind, links)})"
    elif title == "Raises":
        text = ", ".join(kind_of(name, links) for name in names.split(", "))
    else:
        text = kind_of(head, links)
    described = prose(body, links)
    indented = described.replace("\n", "\n  ").replace("\n  \n", "\n\n")
    if described.startswith("- "):
        return f"- {text}:\n  {indented}"
    return f"- {text}: {indented}" if described else f"- {text}"


def kind_of(text: str, links: dict[str, str]) -> str:
    """A type in words; braces are code, and names of the page are links."""

    def linked(match: re.Match[str]) -> str:
        word = match.group(0)
        if word in links and word[0].isupper():
            return f"[`{word}`]({links[word]})"
        return f"`{word}`" if is_exception(word) else word

    pieces = re.split(r"(\{[^}]*\}|\"[^\"]*\")", text)
    return "".join(
        f"`{piece}`" if number % 2 else re.sub(r"\b\w+\b", linked, piece)
        for number, piece in enumerate(pieces)
    )


def is_exception(word: str) -> bool:
    value = getattr(builtins, word, None)
    return inspect.isclass(value) and issubclass(value, BaseException)


def prose(lines: list[str], links: dict[str, str]) -> str:
    """Paragraphs and lists; blocks of examples become code."""
    blocks: list[str] = []
    paragraph: list[str] = []
    shown: list[str] = []

    def end() -> None:
        if paragraph:
            blocks.append("\n".join(inline(line, links) for line in paragraph))
            paragraph.clear()
        if shown:
            blocks.append(code(example(shown)).rstrip())
            shown.clear()

    for line in [*lines, ""]:
        if line.startswith((">>>", "...")) or (shown and line):
            if not shown:
                end()
            shown.append(line)
        elif line:
            paragraph.append(line)
        else:
            end()
    return "\n\n".join(blocks)


def inline(line: str, links: dict[str, str]) -> str:
    """A line with its code spans; characters with a meaning in Markdown are escaped elsewhere."""
    pieces = re.split(r"(``.+?``|`.+?`)", line)
    found = []
    for number, piece in enumerate(pieces):
        if number % 2 == 0:
            listed = re.match(r"\s*[-*] ", piece) if number == 0 else None
            start = listed.group(0) if listed else ""
            found.append(start + re.sub(r"([\\*_<>\[\]])", r"\\\1", piece[len(start) :]))
        elif piece.startswith("``"):
            found.append(f"`{piece[2:-2]}`")
        else:
            name = piece[1:-1]
            found.append(f"[{piece}]({links[name]})" if name in links else piece)
    return "".join(found)


def example(lines: list[str]) -> list[str]:
    """Lines of an example without directives of doctest."""
    text = "\n".join(re.sub(r"\s*# doctest: .*$", "", line) for line in lines)
    return text.strip("\n").splitlines()


def main() -> int:
    parser = argparse.ArgumentParser(description="Write the page of the book about the package.")
    parser.add_argument("--check", action="store_true", help="compare the page, write nothing")
    if not parser.parse_args().check:
        PAGE.write_text(page(), encoding="utf-8", newline="\n")
        return 0
    if PAGE.read_text(encoding="utf-8") == page():
        return 0
    print(f"{PAGE} is not that of the installed package; {REGENERATE}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
