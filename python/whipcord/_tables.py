"""What all parts of a robot have in common: they are tables of a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, ClassVar, TypeVar, Union

from . import _core

Quantity = Union[float, str]
"""A number in SI, or a text with a unit such as ``"180 mm"``."""

Self = TypeVar("Self", bound="Table")


def plain(value: Any) -> Any:
    """The value as a tree of dicts, tuples and numbers."""
    if isinstance(value, Table):
        return value.as_dict()
    if isinstance(value, (list, tuple)):
        return tuple(plain(item) for item in value)
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    return value


@dataclass(frozen=True)
class Table:
    """A table of a robot file: its entries are those of the file, in SI, and never change."""

    _name: ClassVar[str]
    """Name of the table in the file."""
    _inner: ClassVar[Mapping[str, type[Table]]] = {}
    """Entries that are tables themselves, or lists of them."""

    def _set(self, **given: Any) -> None:
        """Checks what was given and keeps it in SI."""
        self._keep(_core.table_in_si(self._name, {key: plain(item) for key, item in given.items()}))

    def _keep(self, entries: Mapping[str, Any]) -> None:
        for field in fields(self):
            default = None if field.default is MISSING else field.default
            value = entries.get(field.name, default)
            inner = self._inner.get(field.name)
            if inner is not None and isinstance(value, dict):
                value = inner._of(value)
            elif inner is not None and isinstance(value, tuple):
                items = (inner._of(item) if isinstance(item, dict) else item for item in value)
                value = tuple(items)
            object.__setattr__(self, field.name, value)

    @classmethod
    def _of(cls: type[Self], entries: Mapping[str, Any]) -> Self:
        """Of a table that is known to be right and in SI."""
        self = cls.__new__(cls)
        self._keep(entries)
        return self

    def _given(self) -> dict[str, Any]:
        """The entries that are not their defaults."""
        given = {}
        for field in fields(self):
            value = getattr(self, field.name)
            default = None if field.default is MISSING else field.default
            if field.default is MISSING or value != default:
                given[field.name] = value
        return given

    def as_dict(self) -> dict[str, Any]:
        """The entries as a robot file has them, in SI."""
        return {key: plain(value) for key, value in self._given().items()}

    def replace(self: Self, **changes: Any) -> Self:
        """The same with these entries changed; None takes one out."""
        return type(self)(**{**self._given(), **changes})

    def __repr__(self) -> str:
        entries = ", ".join(f"{key}={value!r}" for key, value in self._given().items())
        return f"{type(self).__name__}({entries})"
