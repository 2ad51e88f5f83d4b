"""What all parts of a robot have in common: they are tables of a robot file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, dataclass, fields
from functools import partial
from typing import Any, ClassVar, TypeVar, Union

from . import _core
from ._suggest import suggests
from .errors import InputError

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


def part(value: Any, kind: type[Table], name: str) -> Any:
    """A part, or a dict with its entries, as a tree; None where it is not given."""
    if value is None or isinstance(value, (kind, Mapping)):
        return plain(value)
    raise InputError(f"{name} must be a {kind.__name__}, but is {value!r}", path=name)


def parts(values: Any, kind: type[Table], name: str) -> list[Any] | None:
    """A list of such parts; None where there are none."""
    if values is None:
        return None
    if isinstance(values, (str, Table, Mapping)) or not isinstance(values, Iterable):
        raise InputError(f"{name} must be a list of {kind.__name__}, but is {values!r}", path=name)
    return [part(value, kind, f"{name}[{i}]") for i, value in enumerate(values)] or None


@dataclass(frozen=True)
class Table:
    """A table of a robot file: its entries are those of the file, in SI, and never change."""

    _name: ClassVar[str]
    """Name of the table in the file."""
    _inner: ClassVar[Mapping[str, type[Table]]] = {}
    """Entries that are tables themselves, or lists of them."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__init__" in vars(cls):
            type.__setattr__(cls, "__init__", suggests(vars(cls)["__init__"], partial(_advice, cls)))

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
        """The same with these entries changed; None takes one out.

        Parameters
        ----------
        changes
            The entries, by their names.
        """
        return type(self)(**{**self._given(), **changes})

    def __repr__(self) -> str:
        entries = ", ".join(f"{key}={_shown(value)!r}" for key, value in self._given().items())
        return f"{type(self).__name__}({entries})"


def _advice(kind: type[Table], name: str, value: Any) -> str | None:
    """What a robot file with such an entry in this table is told to write instead."""
    try:
        _core.table_in_si(kind._name, {name: plain(value)})
    except (AttributeError, TypeError, InputError) as error:
        for problem in getattr(error, "problems", ()):
            advice = str(problem["help"])
            meant = re.match(r"did you mean `(\w+)`", advice)
            of_kind = meant is None or meant[1] in {field.name for field in fields(kind)}
            if of_kind and f"no key `{name}`" in problem["message"]:
                return advice
    return None


def _shown(value: Any) -> Any:
    # A view of a dict that cannot be changed is no Python when it is shown.
    return dict(value) if isinstance(value, Mapping) else value
