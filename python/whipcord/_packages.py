"""Packages that are needed only for some things."""

from __future__ import annotations

from importlib import import_module
from typing import Any

__all__ = ["needed"]


def needed(module: str) -> Any:
    """The module; where its package is not installed, an error that says how to get it."""
    package = module.partition(".")[0]
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        # A package that is there but misses one of its own says so itself.
        if (error.name or "").partition(".")[0] != package:
            raise
        message = f"this needs the package {package}: pip install {package}"
        raise ModuleNotFoundError(message, name=package) from None
