"""The examples that the package carries."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import whipcord

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, and an empty folder to work in."""
    cache = tmp_path / "cache"
    for name in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(cache))
    monkeypatch.setenv("HOME", str(cache))
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.chdir(empty)
    return cache


def test_they_are_those_of_the_repository(cache: Path) -> None:
    there = ROOT / "examples"
    robots = sorted(file.relative_to(there).as_posix() for file in there.rglob("*.toml"))
    assert sorted(whipcord.examples.names()) == robots
    folder = whipcord.examples.path()
    assert cache in folder.parents and whipcord.__version__ in folder.parts
    for file in there.rglob("*.*"):
        if file.is_file():
            assert (folder / file.relative_to(there)).read_bytes() == file.read_bytes()
    assert whipcord.examples.path("table1") == folder / "table1"


def test_each_of_them_loads(cache: Path) -> None:
    for name in whipcord.examples.names():
        path = whipcord.examples.path(name)
        assert isinstance(path, Path) and path.is_file()
        assert whipcord.load(path).title


def test_what_was_changed_or_removed_is_restored(cache: Path) -> None:
    path = whipcord.examples.path("table1/case-3.toml")
    content = path.read_bytes()
    path.write_text("half a file")
    path.with_name("prototype.toml").unlink()
    assert whipcord.load(whipcord.examples.path("table1/case-3.toml")).title == "Case III: general"
    assert path.read_bytes() == content


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("table1/case-33.toml", "'table1/case-3.toml'"),
        ("case-3.toml", "'table1/case-3.toml'"),
        ("Tapered-Arm.toml", "'tapered-arm.toml'"),
        ("tabel1", "'table1'"),
        ("?", "whipcord.examples.names() lists them"),
        ("../../secret", "whipcord.examples.names() lists them"),
    ],
)
def test_an_unknown_name_is_answered_with_those_like_it(cache: Path, name: str, near: str) -> None:
    with pytest.raises(whipcord.InputError, match=re.escape(f"there is no example {name!r}")) as raised:
        whipcord.examples.path(name)
    assert near in str(raised.value)


@pytest.mark.skipif(
    sys.platform == "win32", reason="a file as the cache is a path that cannot be written on Unix"
)
def test_without_a_cache_they_are_in_a_temporary_folder(cache: Path) -> None:
    cache.write_text("no folder")
    script = (
        "import whipcord\n"
        "path = whipcord.examples.path('table1/case-3.toml')\n"
        "assert path == whipcord.examples.path('table1/case-3.toml')\n"
        "print(path, whipcord.load(path).title, sep='|')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, env=dict(os.environ)
    )
    path, title = done.stdout.strip().split("|")
    assert title == "Case III: general"
    assert cache not in Path(path).parents and not Path(path).exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")
class TestQuestions:
    """`whipcord new` on a terminal."""

    def ask(self, answers: str, folder: Path) -> tuple[int, str]:
        import pty

        command = [str(Path(sys.executable).parent / "whipcord"), "new", "robot.toml"]
        ours, theirs = pty.openpty()
        with subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, cwd=folder) as process:
            os.close(theirs)
            os.write(ours, answers.encode())
            said = b""
            while True:
                try:
                    read = os.read(ours, 1024)
                except OSError:
                    # Linux's way to say that the other end is closed.
                    break
                if not read:
                    break
                said += read
        os.close(ours)
        return process.returncode, said.decode()

    def test_answers_make_a_robot(self, tmp_path: Path) -> None:
        status, said = self.ask("tapered\n180\n18 cm\n\ntpu\n\n3\n", tmp_path)
        assert status == 0, said
        assert "`180` has no unit" in said and "Number of disks [11]: " in said
        robot = whipcord.load(tmp_path / "robot.toml").robot
        assert (robot.backbone.length, len(robot.cables)) == (0.18, 3)
        assert robot.backbone.young_modulus == 26e6

    def test_the_end_of_the_input_writes_nothing(self, tmp_path: Path) -> None:
        status, said = self.ask("arm\n\x04", tmp_path)
        assert status == 2 and "the input ended before the last question" in said
        assert not (tmp_path / "robot.toml").exists()
