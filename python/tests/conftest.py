"""What several tests need."""

from __future__ import annotations

import signal
from pathlib import Path

import matplotlib
import pytest
import whipcord

matplotlib.use("Agg")
# Whoever starts the tests in the background has Ctrl-C ignored, here and in what they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def _from_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Examples are named as from the root of the project."""
    monkeypatch.chdir(ROOT)


@pytest.fixture(scope="session")
def case() -> whipcord.Case:
    """Case III of the paper."""
    return whipcord.load(ROOT / "examples/table1/case-3.toml")


@pytest.fixture(scope="session")
def segment() -> whipcord.Case:
    """A robot with three cables."""
    return whipcord.load(ROOT / "examples/three-cable-segment.toml")
