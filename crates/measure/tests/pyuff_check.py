"""Reads universal files with pyuff and compares them with an npz.

Usage: pyuff_check.py EXPECTED.npz FILE.uff ...

The npz holds `fs` and an array `name [unit]` for each channel. Exit status: 0
all agree, 1 something differs, 77 pyuff is not installed.
"""

import sys

try:
    import numpy as np
    import pyuff
except ImportError as error:
    print(f"{error.name} is not installed", file=sys.stderr)
    sys.exit(77)


def check(expected, path):
    sets = pyuff.UFF(path).read_sets()
    assert [one["type"] for one in sets[:2]] == [151, 164], "151 and 164 come first"
    assert sets[0]["model_name"] == "beam", sets[0]
    assert sets[1]["length"] == 1.0 and sets[1]["force"] == 1.0, sets[1]
    functions = [one for one in sets if one["type"] == 58]
    names = [name for name in expected.files if name != "fs"]
    assert len(functions) == len(names), (len(functions), names)
    binary = path.endswith("binary.uff")
    for name, function in zip(names, functions):
        label, unit = name.rstrip("]").split(" [")
        assert function["id1"] == label, (function["id1"], label)
        assert function["ordinate_axis_units_lab"] == unit, function
        assert function["binary"] == int(binary), function["binary"]
        # Binary data are the same bits; text has thirteen digits.
        tolerance = 0.0 if binary else 5.1e-13
        values = expected[name]
        assert function["data"].shape == values.shape, (function["data"].shape, values.shape)
        scale = np.abs(values)
        assert np.all(np.abs(function["data"] - values) <= tolerance * 10 * scale), name
        step = function["x"][1] - function["x"][0]
        assert abs(step * float(expected["fs"]) - 1) < 1e-12, step


def main():
    expected = np.load(sys.argv[1])
    for path in sys.argv[2:]:
        check(expected, path)


if __name__ == "__main__":
    main()
