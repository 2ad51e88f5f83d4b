"""The package is typed, and its stubs say what is there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

EXAMPLE = """
import numpy as np
import whipcord
from whipcord import Backbone, Cable, Case, Disks, Loads, Robot, Routing

robot = Robot(
    backbone=Backbone(length="180 mm", diameter=3e-3, young_modulus="1.1 GPa", poisson_ratio=0.3),
    disks=Disks(count=10, hole_circle_radius="8 mm", holes=12),
    cables=[
        Cable(name="pull", holes=[1, 2, 3, 4]),
        Cable(name="turn", routing=Routing.helix(turns=0.5, radius="8 mm")),
    ],
)
case = Case(robot, tension=["400 gf", 0.5], loads=Loads(tip_force=["0.05 N", 0, 0]))
solution = case.solve(tension=np.array([1.0, 2.0]), model="cosserat", stations=37)
reveal_type(solution.position)
reveal_type(robot.backbone.length)
batch = case.solve_batch(np.ones((10, 2)))
reveal_type(batch.ok)
_, derivatives = case.differentiate(parameters=["backbone.young_modulus"])
reveal_type(derivatives.compliance())
whipcord.plot.compare(solution, solution).set_title("two")
try:
    whipcord.load("robot.toml")
except whipcord.FileError as error:
    print(error.problems)
"""


CONFIGURATION = """
[mypy]
strict = true
# JAX has annotations, but not on all functions.
untyped_calls_exclude = jax

[mypy-pandas.*,pyarrow.*,matplotlib.*,mpl_toolkits.*,jax.*,torch.*,mujoco.*,yourdfpy.*]
ignore_missing_imports = true
"""


def mypy(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def test_an_example_is_typed_strictly(tmp_path: Path) -> None:
    (tmp_path / "example.py").write_text(EXAMPLE)
    done = mypy("mypy", "--strict", "example.py", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    revealed = [line.split("Revealed type is ")[1] for line in done.stdout.splitlines() if "Revealed" in line]
    # How they are spelt differs from one version of mypy and NumPy to the next.
    words = [("ndarray", "float"), ("float",), ("ndarray", "bool"), ("ndarray", "float")]
    assert len(revealed) == len(words)
    for kind, expected in zip(revealed, words):
        assert all(word in kind for word in expected) and "Any]]" not in kind, revealed


def python_of(page: Path) -> str:
    """The Python on a page, each line at its number on the page; without commands of the shell and options of cells."""
    lines, inside = [], False
    for line in page.read_text("utf-8").splitlines():
        if line.startswith("```"):
            inside = not inside and re.fullmatch(r"```(python|\{code-cell\} \w+)", line) is not None
            lines.append("")
        else:
            lines.append(line if inside and not re.match(r"[!%]|:[\w-]+:", line) else "")
    return "\n".join(lines) + "\n"


def test_the_python_of_all_pages_is_typed_strictly(tmp_path: Path) -> None:
    (tmp_path / "mypy.ini").write_text(CONFIGURATION)
    names = []
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        code = python_of(page)
        if code.strip():
            names.append("_".join(page.relative_to(ROOT).with_suffix("").parts).replace("-", "_") + ".py")
            (tmp_path / names[-1]).write_text(code, "utf-8")
    assert {"README.py", "docs_python.py", "docs_tutorials_own_robot.py"} <= set(names)
    done = mypy("mypy", "--config-file", "mypy.ini", *names, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_wrong_types_are_found(tmp_path: Path) -> None:
    (tmp_path / "wrong.py").write_text(
        "import whipcord\nwhipcord.Backbone(length=[1])\nwhipcord.load(3)\nwhipcord.Disks(numer=3)\nwhipcord.plott\n"
    )
    done = mypy("mypy", "--strict", "wrong.py", cwd=tmp_path)
    lines = [line.split(":")[1] for line in done.stdout.splitlines() if " error: " in line]
    assert lines == ["2", "3", "4", "5"], done.stdout


def test_the_stubs_say_what_the_extension_has(tmp_path: Path) -> None:
    done = mypy("mypy.stubtest", "whipcord._core", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
