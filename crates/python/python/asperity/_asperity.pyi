import os
from collections.abc import Callable, Mapping
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ComputationError",
    "Scenario",
    "ScenarioError",
    "__version__",
    "restore_scenario",
    "simulate",
]
__version__: str

class ScenarioError(ValueError):
    pointer: str
    accepted: str | None
    faults: list[dict[str, str | None]]

class ComputationError(Exception): ...

@final
class Scenario:
    def __new__(
        cls,
        source: Scenario | str | os.PathLike[str] | dict[str, Any],
        *,
        folder: str | os.PathLike[str] | None = None,
    ) -> Scenario: ...
    def with_(self, values: dict[str, Any]) -> Scenario: ...
    def to_dict(self) -> dict[str, Any]: ...
    @property
    def title(self) -> str | None: ...
    @property
    def sha256(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...

def restore_scenario(text: str, path: str | os.PathLike[str]) -> Scenario: ...
def simulate(
    scenario: Scenario | str | os.PathLike[str] | dict[str, Any],
    progress: Callable[[float], object] | None,
) -> tuple[
    dict[str, Any], Mapping[str, NDArray[np.float64]], Mapping[str, NDArray[np.float64]] | None
]: ...
