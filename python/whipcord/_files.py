"""Files that are written."""

from __future__ import annotations

import os

from . import _core


def write(path: str | os.PathLike[str], content: str) -> None:
    """Writes a file, whole or not at all; an ``OSError`` names the file."""
    write_bytes(path, content.encode())


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """The same of bytes."""
    try:
        _core.write_file(os.fspath(path), content)
    except OSError as error:
        raise type(error)(f"cannot write {os.fspath(path)}: {error}") from None
