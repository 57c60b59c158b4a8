"""The live page of a scenario, in a notebook or in a browser."""

from __future__ import annotations

import json
import os
import sys
import tempfile
import threading
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _asperity
from ._analyse import Analysis

if TYPE_CHECKING:
    from ._simulate import ScenarioLike

#: Passes the messages of the frame on to the kernel, and the answers back.
_SCRIPT = """
export default {
  render({ model, el }) {
    const frame = document.createElement("iframe");
    frame.title = "asperity explore";
    frame.style.cssText = `width: 100%; height: ${model.get("height")}px; border: 0;`;
    const address = URL.createObjectURL(new Blob([model.get("page")], { type: "text/html" }));
    frame.src = address;
    // Tells the requests of this frame from requests of other frames of the model.
    const name = [...crypto.getRandomValues(new Uint32Array(2))].join("-");
    const asked = event => {
      const request = event.source === frame.contentWindow && event.data?.asperity;
      if (request) model.send({ ...request, frame: name });
    };
    const answered = message => {
      if (message.frame === name) frame.contentWindow?.postMessage({ asperity: message }, "*");
    };
    addEventListener("message", asked);
    model.on("msg:custom", answered);
    el.append(frame);
    return () => {
      removeEventListener("message", asked);
      model.off("msg:custom", answered);
      URL.revokeObjectURL(address);
    };
  },
};
"""

#: Height of the frame in CSS pixels.
_HEIGHT = 760


class Explorer:
    """The page of a scenario, as `explore` makes it in a notebook.

    Attributes
    ----------
    widget : anywidget.AnyWidget
        The page; a cell that ends with the explorer shows it.
    """

    widget: Any

    def __init__(self, answers: _asperity.LivePage, folder: Any) -> None:
        self._answers = answers
        # The data of the page, which end with it.
        self._folder = folder
        self.widget = _widget(answers)

    @property
    def scenario(self) -> _asperity.Scenario:
        """The scenario as the page shows it now."""
        return self._answers.scenario()

    def close(self) -> None:
        """End the computations under way, and the widget."""
        self._answers.close()
        self.widget.close()

    def _repr_mimebundle_(self, **options: Any) -> Any:
        return self.widget._repr_mimebundle_(**options)


def explore(
    scenario: ScenarioLike,
    data: str | os.PathLike[str] | dict[str, Any] | Analysis | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    port: int | None = None,
    browser: bool = True,
) -> Explorer | _asperity.Scenario:
    """Show the live page of a scenario: move a number, and see laws, receptance, force levels and steady responses follow.

    In a notebook the page is a widget, which needs the package ``anywidget`` (``pip install asperity[explore]``); the kernel
    computes, while no cell runs. Elsewhere the page is served to the browser of this machine until Ctrl-C, as by the command
    ``asperity explore``.

    Parameters
    ----------
    scenario : Scenario, str, os.PathLike or dict
        The scenario that the page starts from.
    data : Analysis, dict, str or os.PathLike, optional
        Measured hits shown beside the computed ones, with chi-square by feature: the result of `analyse`, its ``report``, or
        the path of an ``analysis.json``.
    out : str or os.PathLike, optional
        Folder for what the page saves; ``out/`` and the name of the scenario's file with ``-explore`` by default.
    port : int, optional
        Port of the served page; a free one by default.
    browser : bool, optional
        Open the served page in a browser.

    Returns
    -------
    Explorer or Scenario
        In a notebook the `Explorer`, whose ``scenario`` is the scenario as the page shows it; elsewhere, after Ctrl-C, the
        scenario as it was left.

    Raises
    ------
    ScenarioError
        If the scenario is not valid.
    OSError
        If a file cannot be read, or the port is in use.
    ImportError
        In a notebook without ``anywidget``.

    Examples
    --------
    >>> page = asperity.explore("rig.json")                                     # doctest: +SKIP
    >>> page.scenario.simulate()                                                # doctest: +SKIP
    """
    path, folder = _data_file(data)
    answers = _asperity.LivePage(
        scenario, path, None if out is None else Path(out), temporary=folder is not None
    )
    if _in_notebook():
        return Explorer(answers, folder)

    def announce(url: str) -> None:
        print(url, flush=True)
        if browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()

    try:
        answers.serve(port, announce)
    except KeyboardInterrupt:
        pass
    finally:
        answers.close()
        if folder is not None:
            folder.cleanup()
    return answers.scenario()


def _widget(answers: _asperity.LivePage) -> Any:
    """The page in a frame of a notebook, whose messages the kernel answers."""
    try:
        import anywidget  # type: ignore[import-not-found,unused-ignore]
        import traitlets  # type: ignore[import-not-found,unused-ignore]
    except ImportError as error:
        raise ImportError(
            "the live page of a notebook needs the package anywidget: pip install asperity[explore]"
        ) from error

    # Made here, since its base is there with the package only.
    synced = {
        "_esm": _SCRIPT,
        "page": traitlets.Unicode().tag(sync=True),
        "height": traitlets.Int(_HEIGHT).tag(sync=True),
    }
    widget = type("ExploreWidget", (anywidget.AnyWidget,), synced)(page=answers.page())
    requests = Requests(answers, widget.send)
    widget.on_msg(lambda _widget, message, _buffers: requests.take(message))
    return widget


class Requests:
    """Requests of frames, answered by threads of their own; `send` carries the answers."""

    def __init__(self, answers: _asperity.LivePage, send: Callable[[dict[str, Any]], object]) -> None:
        self._answers = answers
        self._send = send
        self._open: set[tuple[str, int]] = set()
        self._stopped: set[tuple[str, int]] = set()

    def take(self, message: Any) -> threading.Thread | None:
        """Begins the answer to a message of a frame; the thread of it, if it is a request."""
        if not isinstance(message, dict):
            return None
        frame, number = message.get("frame"), message.get("id")
        place, body = message.get("place"), message.get("body")
        if not isinstance(frame, str) or not isinstance(number, int):
            return None
        key = (frame, number)
        if message.get("stop") and key in self._open:
            self._stopped.add(key)
        if not isinstance(place, str) or not isinstance(body, str):
            return None
        self._open.add(key)
        thread = threading.Thread(target=self._answer, args=(key, place, body), daemon=True)
        thread.start()
        return thread

    def _answer(self, key: tuple[str, int], place: str, body: str) -> None:
        address = {"frame": key[0], "id": key[1]}

        def send(part: int | str) -> bool:
            if key in self._stopped:
                return False
            self._send({**address, "status" if isinstance(part, int) else "line": part})
            return True

        try:
            self._answers.answer(place, body, send)
        finally:
            self._open.discard(key)
            self._stopped.discard(key)
            self._send({**address, "end": True})


def _in_notebook() -> bool:
    """True where a kernel runs this program."""
    shell = sys.modules.get("IPython")
    current = shell.get_ipython() if shell is not None else None
    return current is not None and getattr(current, "kernel", None) is not None


def _data_file(data: Any) -> tuple[Path | None, tempfile.TemporaryDirectory[str] | None]:
    """The `analysis.json` of some data, and the folder made for it."""
    if data is None or isinstance(data, str | os.PathLike):
        return None if data is None else Path(data), None
    if not isinstance(data, Analysis | dict):
        kind = type(data).__name__
        raise TypeError(
            f"data cannot be of the type {kind}; accepted: the result of analyse, its report, or the path of an analysis.json"
        )
    report = data.report if isinstance(data, Analysis) else data
    folder = tempfile.TemporaryDirectory(prefix="asperity-")
    path = Path(folder.name) / "analysis.json"
    path.write_text(json.dumps(report), encoding="utf-8")
    if isinstance(data, Analysis):
        columns = [data.frf["frequency_hz"], data.frf["magnitude"]]
        table = np.column_stack(columns)
        header = "frequency_hz,magnitude"
        np.savetxt(path.with_name("frf.csv"), table, delimiter=",", header=header, comments="", fmt="%.17g")
    return path, folder
