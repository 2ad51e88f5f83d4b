"""Files for other programs."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from . import _core
from ._files import write_bytes
from .errors import InputError

__all__ = ["Exported"]

FORMATS = {".xml": "mjcf", ".urdf": "urdf", ".pvd": "vtk", ".glb": "gltf", ".step": "step-points"}


@dataclass(frozen=True)
class Exported:
    """Files that an export wrote.

    Examples
    --------
    >>> import tempfile, whipcord
    >>> case = whipcord.load("examples/table1/case-3.toml")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = case.export(f"{folder}/arm.urdf")
    ...     [path.name for path in made.files], len(made.lost)
    (['arm.urdf', 'arm.joints.json'], 2)
    """

    files: tuple[Path, ...]
    """The files; the first one is what the other program opens."""
    lost: tuple[str, ...]
    """What of the robot and its case is not in them, in words."""


def export(
    setup: _core.Setup,
    model: _core.Model,
    path: str | os.PathLike[str],
    to: str | None,
    per_span: int | None,
) -> Exported:
    """Solves and writes the files of a format, the first one last."""
    out = Path(path)
    extensions = {format: extension for extension, format in FORMATS.items()}
    extension = out.suffix.lower()
    if to is None and extension not in FORMATS:
        endings = ", ".join(FORMATS)
        raise InputError(
            f"{out}: the name says no format: let it end in one of {endings}, or give `to`", path="path"
        )
    format = FORMATS[extension] if to is None else to
    if extensions.get(format, extension) != extension:
        raise InputError(
            f"{out}: the name of a file for {format} must end in {extensions[format]}", path="path"
        )
    if per_span is not None and not 1 <= per_span <= 1000:
        raise InputError(f"per_span is {per_span}: it must be from 1 to 1000", path="per_span")
    contents, lost = _core.export(setup, model, format, out.stem, per_span)
    files = [(out.parent / name, content) for name, content in contents]
    for file, content in reversed(files):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(file, content)
    return Exported(tuple(file for file, _ in files), tuple(lost))
