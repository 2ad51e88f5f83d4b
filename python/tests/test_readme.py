"""What the front page and the page about Python say is what happens."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import matplotlib.pyplot as pyplot
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def blocks(page: str) -> list[str]:
    return re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)


def test_the_python_of_the_front_page_runs() -> None:
    scope: dict[str, Any] = {}
    for block in blocks("README.md"):
        exec(block, scope)
    assert np.allclose(1e3 * scope["solution"].tip, [46.81, 76.68, 143.37], atol=0.01)
    pyplot.close("all")


def test_the_page_about_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # It writes a robot file.
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    scope: dict[str, Any] = {"tensions": np.ones((5, 1)), "weights": np.ones((5, 10, 3))}
    found = blocks("docs/python.md")
    assert len(found) >= 2
    for block in found:
        exec(block, scope)
    assert (tmp_path / "robot.toml").is_file()
    assert scope["batch"].ok.all()
    pyplot.close("all")
