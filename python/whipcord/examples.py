"""Example robot files, which are part of the package.

>>> import whipcord
>>> whipcord.examples.names()[:2]
['composite-finger.toml', 'contact/among-bodies.toml']
>>> path = whipcord.examples.path("table1/case-3.toml")
>>> whipcord.load(path).title
'Case III: general'

The files are written to a folder in the user's cache, one for each version of the package, or to a temporary folder if the cache is
not writable. Do not edit them there: changes are reverted. On the command line, ``whipcord examples --copy DIR`` copies all files to a
folder of your choice.
"""

from __future__ import annotations

import atexit
import os
import shutil
import sys
import tempfile
from difflib import get_close_matches
from pathlib import Path, PurePosixPath

from . import _core
from ._files import write_bytes
from .errors import InputError

__all__ = ["names", "path"]

_temporary: Path | None = None


def names() -> list[str]:
    """The names of the example robot files in alphabetical order, with slashes."""
    return [name for name, _ in _core.examples() if name.endswith(".toml")]


def path(name: str = "") -> Path:
    """The path of an example, or of a folder of examples.

    All examples are written there, so that files that an example names (`extends`, meshes) exist.

    Parameters
    ----------
    name : str
        Name of a file, as :func:`names` lists it; a folder such as ``"table1"``; or empty, for the folder of all examples.

    Raises
    ------
    InputError
        If there is no such example; the message has the most similar names.

    Examples
    --------
    >>> path("contact/wedge.stl").stat().st_size
    1056
    >>> path("helical-finger")
    Traceback (most recent call last):
    whipcord.errors.InputError: there is no example 'helical-finger'; did you mean 'helical-finger.toml'?
    """
    files = _core.examples()
    known = {""} | {one for one, _ in files}
    known |= {str(folder) for one, _ in files for folder in PurePosixPath(one).parents if folder.name}
    if name not in known:
        raise InputError(f"there is no example {name!r}; {_instead(str(name), known)}", path="name")
    return _folder(files) / name


def _instead(name: str, known: set[str]) -> str:
    near = get_close_matches(name.lower(), sorted(known - {""}), n=3, cutoff=0.5)
    # A file name without its folder is not similar to any full name.
    last = PurePosixPath(name.lower()).stem
    near += [one for one in sorted(known) if PurePosixPath(one).stem == last and one not in near]
    if not near:
        return "whipcord.examples.names() lists them"
    *others, final = (repr(one) for one in near[:3])
    return f"did you mean {', '.join(others)} or {final}?" if others else f"did you mean {final}?"


def _folder(files: list[tuple[str, bytes]]) -> Path:
    """The folder with all examples of this version."""
    global _temporary
    if _temporary is None:
        try:
            return _restored(_cache() / "whipcord" / _core.VERSION / "examples", files)
        except (OSError, RuntimeError):
            # No home folder, no space or no permission.
            _temporary = Path(tempfile.mkdtemp(prefix="whipcord-examples-"))
            atexit.register(shutil.rmtree, _temporary, ignore_errors=True)
    return _restored(_temporary, files)


def _cache() -> Path:
    """The folder for caches of the user."""
    if sys.platform == "win32":
        named = os.environ.get("LOCALAPPDATA")
        usual = ("AppData", "Local")
    elif sys.platform == "darwin":
        named, usual = None, ("Library", "Caches")
    else:
        named, usual = os.environ.get("XDG_CACHE_HOME"), (".cache",)
    # The XDG specification requires that relative paths are ignored.
    if named and Path(named).is_absolute():
        return Path(named)
    return Path.home().joinpath(*usual)


def _restored(folder: Path, files: list[tuple[str, bytes]]) -> Path:
    """Writes the missing and the changed files, and returns the folder."""
    for name, content in files:
        file = folder / name
        try:
            same = file.read_bytes() == content
        except OSError:
            same = False
        if not same:
            file.parent.mkdir(parents=True, exist_ok=True)
            # Atomic, because another process may read or write the same file.
            write_bytes(file, content)
    return folder
