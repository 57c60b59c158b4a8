"""Dynamics of structures with rough contact interfaces.

Scenarios are files, JSON texts or dicts; results are dicts and NumPy arrays under the names of
the files that the command ``asperity`` writes, equal to the last bit. All numbers are in SI units,
stated at the end of each name.

>>> import asperity
>>> run = asperity.simulate("rig.json")                  # doctest: +SKIP
>>> run.summary["fundamental"]["frequency_hz"]           # doctest: +SKIP
>>> run.history["time_s"], run.history["displacement_m"] # doctest: +SKIP
"""

from . import plot, signal
from ._analyse import Analysis, DecayAnalysis, ResponseAnalysis, analyse, decay
from ._asperity import ComputationError, Figure, Law, Scenario, ScenarioError, __version__
from ._explore import Explorer, explore
from ._identify import Identification, identify
from ._law import (
    LawTables,
    PowerFit,
    fit_power,
    law_from_pressure,
    law_from_stiffness,
    laws,
    tabulate,
)
from ._matrices import write_matrices
from ._measurement import read, to_sep005, write
from ._simulate import MeshMotion, Simulation, simulate
from ._steady import Modes, SteadyResponses, modes, steady
from ._study import Study, study
from ._sweep import Sweep, sweep
from ._table import Table
from ._warning import AccuracyWarning, AsperityWarning, JudgementWarning, NoticeWarning

__all__ = [
    "AccuracyWarning",
    "Analysis",
    "AsperityWarning",
    "ComputationError",
    "DecayAnalysis",
    "Explorer",
    "Figure",
    "Identification",
    "JudgementWarning",
    "Law",
    "LawTables",
    "MeshMotion",
    "Modes",
    "NoticeWarning",
    "PowerFit",
    "ResponseAnalysis",
    "Scenario",
    "ScenarioError",
    "Simulation",
    "SteadyResponses",
    "Study",
    "Sweep",
    "Table",
    "__version__",
    "analyse",
    "decay",
    "explore",
    "fit_power",
    "identify",
    "law_from_pressure",
    "law_from_stiffness",
    "laws",
    "modes",
    "plot",
    "read",
    "signal",
    "simulate",
    "steady",
    "study",
    "sweep",
    "tabulate",
    "to_sep005",
    "write",
    "write_matrices",
]
