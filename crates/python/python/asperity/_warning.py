"""Doubts about results as warnings of Python."""

from __future__ import annotations

import warnings
from collections.abc import Iterable


class AsperityWarning(RuntimeWarning):
    """Doubt about a result that was computed; the classes of all such warnings derive from it.

    ``warnings.filterwarnings("error", category=asperity.AsperityWarning)`` makes every doubt an
    exception. Of this class itself are runs of a sweep and amplitudes of a steady response that failed,
    and pressures outside the range in which a law was measured (``outside_measured_range``).
    """


class AccuracyWarning(AsperityWarning):
    """Doubt about the numbers of a response.

    The accuracy asked for was not reached (``accuracy_not_reached``), the energy balance does not close
    (``energy_balance``), the response depends on rounding (``sensitive``), a maximum is hardly told from a ripple
    (``marginal_peak``), the largest response is where the force is too weak (``hidden_resonance``), the record ends
    before the response has decayed and widens the peak (``not_decayed``), or time integration gives another steady
    response (``integration_differs``, ``another_motion``, ``not_kept``). The names are the kinds in
    ``summary["warnings"]``.
    """


class JudgementWarning(AsperityWarning):
    """An identified law that may be used with care only, or not at all.

    The text has the judgement and its reasons, which ``report["judgement"]`` has with their numbers.
    """


class NoticeWarning(UserWarning):
    """An assumption or an omission, as the command notes it: records that were left out, a band that was
    chosen. The ``notices`` of analyses and identifications have the texts too. It is no doubt about a
    result, and no `AsperityWarning`.
    """


#: Kinds of warnings that are not about numbers.
_OF_THE_RANGE = {"outside_measured_range"}


def category(kind: str) -> type[AsperityWarning]:
    """The class of a kind of warning."""
    return AsperityWarning if kind in _OF_THE_RANGE else AccuracyWarning


def tell(found: Iterable[tuple[str, str]], stacklevel: int = 3) -> None:
    """Warns the caller of the function that calls this one; a text once."""
    for kind, text in dict.fromkeys(found):
        warnings.warn(f"{kind}: {text}", category(kind), stacklevel=stacklevel)


def note(notices: Iterable[str], stacklevel: int = 3) -> None:
    """Passes notices on to the caller of the function that calls this one; a text once."""
    for text in dict.fromkeys(notices):
        warnings.warn(text, NoticeWarning, stacklevel=stacklevel)
