"""The command ``asperity``: ``python -m asperity``, and the script that the package installs."""

import signal
import sys

from ._asperity import command


def main() -> int:
    """Carry out the command line; returns its exit status."""
    # Ctrl-C ends the command, or stops it between its steps, as it does without Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return command(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
