"""What the front page says is what happens."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import matplotlib.pyplot as pyplot
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_the_python_of_the_front_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert len(blocks) >= 2
    # It writes a robot file.
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    scope: dict[str, Any] = {"tensions": np.ones((5, 1)), "weights": np.ones((5, 10, 3))}
    for block in blocks:
        exec(block, scope)
    assert (tmp_path / "robot.toml").is_file()
    assert scope["batch"].ok.all()
    pyplot.close("all")
