"""The shards of a data set, on whatever runs them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from .case import Case
from .errors import InputError
from .sweeping import Sweep


def shard(case: Case, out: str, number: int, count: int, options: dict[str, Any]) -> Sweep:
    """Makes one shard, in a worker; where it was begun by one that was killed, what is missing of it."""
    return case.sweep(out=out, shard=(number, count), resume=True, **options)


def whole(shards: Sequence[Sweep]) -> Sweep:
    """What became of all shards together."""
    failures = [each.first_failure for each in shards if each.first_failure is not None]
    return replace(
        shards[0],
        rows=sum(each.rows for each in shards),
        parts=sum(each.parts for each in shards),
        kept_parts=sum(each.kept_parts for each in shards),
        failed=sum(each.failed for each in shards),
        unstable=sum(each.unstable for each in shards),
        first_failure=min(failures, default=None),
    )


def checked(count: int) -> int:
    """A number of shards."""
    if count < 1:
        raise InputError(f"shards must be 1 at least, but is {count}", path="shards")
    return count
