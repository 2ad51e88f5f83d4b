"""Data sets of many shapes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow.parquet
import pytest
import whipcord
from whipcord.errors import InputError, WhipcordTimeout

VARY = {"cables.a.tension": "0 N:3 N:4", "cables.b.tension": [0, "1.5 N"]}


@pytest.fixture(scope="module")
def segment() -> whipcord.Case:
    return whipcord.load("examples/three-cable-segment.toml")


def test_rows_are_those_of_a_batch(segment: whipcord.Case, tmp_path: Path) -> None:
    made = segment.sweep(VARY, tmp_path / "data", outputs=["tip", "stability", "jacobian"])
    assert (made.rows, made.parts, made.failed) == (8, 1, 0)
    table = pyarrow.parquet.read_table(made.files[0])
    assert tuple(table.column_names) == made.columns
    tension = np.zeros((8, 3))
    tension[:, 2] = 1.0  # of the file
    for column, name in enumerate("ab"):
        tension[:, column] = table[f"cables.{name}.tension [N]"].to_numpy()
    batch = segment.solve_batch(tension)
    tips = np.column_stack([table[f"tip_{c} [m]"].to_numpy() for c in "xyz"])
    assert np.allclose(tips, batch.position[:, -1], atol=1e-8)
    assert table["stable"].to_pylist() == [True] * 8 and table["error"].null_count == 8
    _, derivatives = segment.differentiate(tension=tension[5])
    jacobian = [table[f"b_jacobian_{c} [m/N]"][5].as_py() for c in "xyz"]
    assert np.allclose(jacobian, derivatives.position_by_command[-1][:, 1], atol=1e-9)


def test_shards_are_the_whole(segment: whipcord.Case, tmp_path: Path) -> None:
    vary = {"cables.a.tension": "0 N:3 N", "backbone.length": "90 mm:110 mm"}

    def sweep(name: str, shard: tuple[int, int], resume: bool = False) -> whipcord.Sweep:
        return segment.sweep(
            vary, tmp_path / name, samples=20, seed=4, rows_per_part=3, shard=shard, resume=resume
        )

    whole = sweep("whole", (0, 1))
    shards = [sweep("shards", (number, 2)) for number in range(2)]
    assert sum(shard.rows for shard in shards) == whole.rows == whole.manifest["rows"]
    assert [path.read_bytes() for path in whole.files] == [path.read_bytes() for path in shards[1].files]
    whole.files[2].unlink()
    assert sweep("whole", (0, 1), resume=True).kept_parts == 6


def test_a_table_gives_the_rows(segment: whipcord.Case, tmp_path: Path) -> None:
    made = segment.sweep(table={"cables.a.tension [N]": [1, 2]}, out=tmp_path / "t", outputs="tensions")
    table = pyarrow.parquet.read_table(made.folder / "part-000000.parquet")
    assert table["a_tension [N]"].to_pylist() == [1, 2]


def test_what_cannot_be_swept_says_why(segment: whipcord.Case, tmp_path: Path) -> None:
    def wrong(path: str, **arguments: object) -> str:
        asked: dict[str, object] = {"vary": VARY, "out": tmp_path / "wrong", **arguments}
        with pytest.raises(InputError) as caught:
            segment.sweep(**asked)  # type: ignore[arg-type]
        assert caught.value.path == path
        return str(caught.value)

    assert "nothing varies" in wrong("vary", vary=None)
    assert "its entries are" in wrong("vary", vary={"cables.z.tension": "1 N"})
    assert "finite" in wrong("table", vary=None, table={"cables.a.tension [N]": [np.nan]})
    assert "one length" in wrong("table", vary=None, table={"a": [1], "b": [1, 2]})
    assert "sobol" in wrong("sampling", samples=3, sampling="halton")
    assert "jacobian" in wrong("outputs", outputs="colour")
    assert "shard" in wrong("shard", shard=(2, 2))
    assert "whole number" in wrong("samples", samples=0)
    segment.sweep(VARY, tmp_path / "begun")
    assert "resume" in wrong("out", out=tmp_path / "begun")
    with pytest.raises(WhipcordTimeout):
        segment.sweep({"cables.a.tension": "0 N:3 N"}, tmp_path / "long", samples=10**9, timeout=0.2)
