"""Ctrl-C stops each call that may take long."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import signal
import numpy as np
import asperity, test_identify, test_simulate, test_study
from conftest import SCENARIOS

RIG = SCENARIOS / "nouira2020-modified.json"

# Called by the running computation: the signal comes while it is on its way.
def running(fraction):
    if not started:
        started.append(fraction)
        print("running", flush=True)

started = []
# A shell may start its background jobs with the signal ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
try:
    {call}
except KeyboardInterrupt:
    print("stopped", flush=True)
"""

CALLS = {
    "simulate": "asperity.simulate(test_simulate.slow_scenario(), progress=running)",
    "sweep": (
        'asperity.sweep(RIG, {"/excitation/peak_n": np.linspace(9, 32, 5000)}, progress=running)'
    ),
    "steady": (
        "asperity.steady(RIG, np.linspace(0.5, 12, 200), 1000, 500, harmonics=60, "
        'time_sweep="both", progress=running)'
    ),
    "study": (
        "asperity.Scenario(RIG).study({**test_study.STUDY, "
        '"design": {"kind": "saltelli", "base_rows": 20000}}, progress=running)'
    ),
    "identify": "asperity.identify(test_identify.slow_problem(), progress=running)",
}


@pytest.mark.skipif(sys.platform == "win32", reason="signals of consoles only")
@pytest.mark.parametrize("name", CALLS)
def test_ctrl_c_stops_a_call_on_its_way(name: str) -> None:
    program = PROGRAM.replace("{call}", CALLS[name])
    folder = Path(__file__).parent
    with subprocess.Popen(
        [sys.executable, "-c", program], cwd=folder, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGINT)
        try:
            # The calls take minutes; the limit only ends a test that failed.
            rest, _ = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        assert rest == "stopped\n"
        assert process.returncode == 0
