"""Where the tip can go."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError, WhipcordTimeout

LIMITS = {"tension": [0, "4 N"]}


@pytest.fixture(scope="module")
def segment() -> whipcord.Case:
    return whipcord.load("examples/three-cable-segment.toml")


@pytest.fixture(scope="module")
def surface(segment: whipcord.Case) -> whipcord.Workspace:
    return segment.workspace(voxel="6 mm", limits=LIMITS)


def test_commands_lead_into_their_voxels(segment: whipcord.Case, surface: whipcord.Workspace) -> None:
    assert surface.dimension == 2 and surface.complete and surface.voxel == 6e-3
    assert (surface.command >= 0).all() and (surface.command <= 4).all()
    batch = segment.solve_batch(surface.command)
    assert np.allclose(batch.position[:, -1], surface.tip, atol=2e-6)
    # A place that is found on few steps may be at the other side of a face of the voxel.
    off = abs(batch.position[:, -1] - surface.centre).max(axis=1)
    assert (off <= 3e-3 + 2e-5).all()
    assert (surface.extent[0] <= surface.tip).all() and (surface.tip <= surface.extent[1]).all()


def test_maps_are_those_of_the_derivatives(segment: whipcord.Case, surface: whipcord.Workspace) -> None:
    for row in (0, len(surface) // 2):
        _, derivatives = segment.differentiate(tension=surface.command[row])
        compliance = derivatives.compliance()[:3, :3]
        stiffest = 1 / np.linalg.eigvalsh(0.5 * (compliance + compliance.T))
        assert np.isclose(surface.map("stiffness")[row], stiffest.min(), rtol=1e-3)
        assert np.isclose(surface.stiffness[row, 1], stiffest.max(), rtol=1e-2)
        jacobian = derivatives.position_by_command[-1]
        ratio = np.linalg.svd(jacobian, compute_uv=False)
        # The tensions that bend the robot by half a turn are the same for the three cables.
        assert np.isclose(surface.motion[row, 1] / surface.condition[row], surface.map("dexterity")[row])
        assert (
            np.isclose(ratio[0] / ratio[1], surface.condition[row], rtol=1e-2) or surface.directions[row] == 3
        )
    assert np.allclose(surface.map("accuracy"), 0.01 * surface.motion[:, 1])
    without = segment.workspace(voxel="12 mm", limits=LIMITS, stiffness=False)
    assert np.isnan(without.stiffness).all()


def test_the_boundary_says_what_holds_the_tip_back(surface: whipcord.Workspace) -> None:
    boundary = surface.boundary
    assert len(boundary) == len(boundary.limits) > 0
    assert np.allclose(np.linalg.norm(boundary.normal, axis=1), 1)
    words = {word for each in boundary.limits for word in each}
    assert any("tension of cable" in word for word in words)


def test_it_is_a_table_and_an_array(surface: whipcord.Workspace, tmp_path: Path) -> None:
    table = surface.to_pandas()
    assert len(table) == len(surface) and np.array_equal(table["tip_z"], surface.tip[:, 2])
    assert np.array_equal(table["tension:a"], surface.command[:, 0])
    arrow = surface.to_arrow()
    assert arrow.num_rows == len(surface) and arrow.column_names == list(table.columns)
    surface.to_parquet(tmp_path / "voxels.parquet")
    surface.to_csv(tmp_path / "voxels.csv")
    assert (tmp_path / "voxels.csv").read_text().startswith("x,y,z,tip_x")
    corner, grid = surface.grid(surface.map("dexterity"))
    assert np.isfinite(grid).sum() == len(surface)
    number = np.round((surface.centre[3] - corner) / surface.voxel - 0.5).astype(int)
    assert grid[tuple(number)] == surface.map("dexterity")[3]
    plane = surface.section("y")
    assert plane.any() and (abs(surface.centre[plane, 1] - 3e-3) < 1e-12).all()


def test_halving_the_voxels_changes_little(segment: whipcord.Case, surface: whipcord.Workspace) -> None:
    finer = segment.workspace(voxel="3 mm", limits=LIMITS, stiffness=False)
    assert abs(finer.measure - surface.measure) < 0.1 * finer.measure


def test_what_cannot_be_asked_is_said(segment: whipcord.Case, surface: whipcord.Workspace) -> None:
    with pytest.raises(InputError, match="a thousandth of the length"):
        segment.workspace(voxel="1 um")
    with pytest.raises(InputError, match="finite number or a text"):
        segment.workspace(voxel=[1])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="no motors"):
        segment.workspace(by="motors")
    with pytest.raises(InputError, match="greater than zero"):
        segment.workspace(solves=0)
    with pytest.raises(InputError, match="there is no map"):
        surface.map("colour")
    with pytest.raises(InputError, match="axis must be"):
        surface.section("w")
    with pytest.raises(InputError, match="one for each voxel"):
        surface.grid([1.0])
    with pytest.raises(WhipcordTimeout):
        segment.workspace(voxel="1 mm", timeout=0.05)
