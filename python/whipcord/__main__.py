"""The command ``whipcord``."""

from __future__ import annotations

import sys

from . import _core


def main() -> int:
    """Runs the command line with the arguments of the process."""
    return _core.main(["whipcord", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
