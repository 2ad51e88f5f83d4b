"""The command ``whipcord``."""

from __future__ import annotations

import signal
import sys

from . import _core


def main() -> int:
    """Runs the command line with the arguments of the process."""
    # Python would note Ctrl-C and wait until the command is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.main(["whipcord", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
