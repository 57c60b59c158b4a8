"""Times of the package side by side with those of the engine alone.

    python benches/speed.py TARGET

TARGET is the folder of the builds of the same profile as the installed package, such as
``target/debug``: it holds the command ``asperity`` and, after
``cargo build -p asperity-law --example million_pressures``, that example.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import asperity

RIG = Path(__file__).parents[3] / "fixtures" / "scenarios" / "nouira2020-modified.json"
HITS = 100_000
ROUNDS = 3


def hits(command: Path) -> None:
    """100 000 modal hits: columns in Python against the engine's own time in the command."""
    values = np.linspace(9.0, 32.0, HITS)
    scenario = asperity.Scenario(RIG).with_({"/method": "modal"})
    for number in range(ROUNDS):
        with tempfile.TemporaryDirectory() as folder:
            vary = f"/excitation/peak_n=9:32:{HITS}"
            line = [command, "sweep", RIG, "--set", "/method=modal", "--vary", vary, "--out", folder]
            line += ["--json", "--quiet"]
            done = subprocess.run([str(word) for word in line], check=True, capture_output=True, text=True)
        engine = json.loads(done.stdout)["wall_s"]
        started = time.perf_counter()
        found = asperity.sweep(scenario, {"/excitation/peak_n": values})
        here = time.perf_counter() - started
        assert found.rows == HITS and found.failed == 0
        print(f"hits {number + 1}: engine {engine:.2f} s, Python {here:.2f} s, {here / engine:.3f}")


def stiffnesses(example: Path) -> None:
    """A million stiffnesses: one call against a loop in Rust."""
    law = asperity.Law({"kind": "power", "coefficient": 1.81e10, "exponent": 0.35})
    pressures = 1e6 * np.arange(1_000_000) / 1_000_000
    for number in range(ROUNDS):
        loop = float(subprocess.run([str(example)], check=True, capture_output=True).stdout)
        here = np.inf
        for _ in range(20):
            started = time.perf_counter()
            found = law.stiffness(pressures)
            here = min(here, time.perf_counter() - started)
            del found
        print(
            f"stiffness {number + 1}: Rust {1e3 * loop:.2f} ms, Python {1e3 * here:.2f} ms, "
            f"{here / loop:.3f}"
        )


def imports() -> None:
    """Import of the package, beyond that of NumPy."""
    program = (
        "import time, numpy; t = time.perf_counter(); import asperity; "
        "print(time.perf_counter() - t)"
    )
    for number in range(ROUNDS):
        done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True)
        print(f"import {number + 1}: {1e3 * float(done.stdout):.1f} ms")


if __name__ == "__main__":
    target = Path(sys.argv[1])
    imports()
    stiffnesses(target / "examples" / "million_pressures")
    hits(target / "asperity")
