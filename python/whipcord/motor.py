"""Motors that pull the cables of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from ._tables import Quantity, Table

__all__ = ["Motor"]


@dataclass(frozen=True, init=False, repr=False)
class Motor(Table):
    """A motor that pulls one or several cables: a spool behind a gear, or without `spool_radius` a linear drive. Its angle or travel
    is a command of the :class:`Case`.

    Parameters
    ----------
    name
        Name, unique in the robot.
    group
        Group of motors that it belongs to. Motors of a group can share parameters in a fit.
    cables
        Names of the cables that it pulls; a minus sign before a name for a cable that is paid out where the others are
        wound up.
    spool_radius
        Radius of the spool in m: one for all cables, or one for each.
    gear_ratio
        Turns of the motor for one of the spool; 1 by default.
    stiffness
        Stiffness of drive and cable outside the robot in N/m, of each cable by itself; rigid by default.
    free_length
        Length in m of each cable between motor and base.
    pretension
        Tension in N of each cable where the motor is at its offset and the robot has its shape at rest.
    backlash
        Play of the drive: an angle of the spool in rad, or a length of a linear drive in m.
    angle_offset
        Angle in rad of the motor at which it shortens no cable.
    travel_offset
        Travel in m of a linear drive at which it shortens no cable.
    angle_limits
        Least and greatest angle of the motor in rad.
    travel_limits
        Least and greatest travel of a linear drive in m.
    rate_limit
        Greatest rate of the command in rad/s or m/s.
    torque_limit
        Greatest torque of the motor in N·m.
    force_limit
        Greatest force of a linear drive in N.
    inertia
        Moment of inertia in kg·m² about the shaft of the motor, before the gear, or the mass in kg of a linear drive. Its command is then the
        set-point of a position loop in motions, which needs a `proportional_gain`; elsewhere the motor is where its command says.
    damping
        Viscous friction of a motor with inertia, before the gear, in N·m·s/rad or N·s/m.
    proportional_gain
        Position loop of a motor with inertia: torque by the error of its position in N·m/rad, or force in N/m, within `torque_limit` or `force_limit`.
    derivative_gain
        Torque or force by the rate of that error in N·m·s/rad or N·s/m.
    integral_gain
        Torque or force by the integral of that error over time in N·m/(rad·s) or N/(m·s).

    Examples
    --------
    >>> Motor(name="bend", cables=["left", "-right"], spool_radius="10 mm", stiffness="5 N/mm")
    Motor(name='bend', cables=('left', '-right'), spool_radius=0.01, stiffness=5000.0)
    """

    name: str
    cables: tuple[str, ...]
    spool_radius: float | tuple[float, ...] | None = None
    gear_ratio: float | None = None
    stiffness: float | None = None
    free_length: float | None = None
    pretension: float | None = None
    backlash: float | None = None
    angle_offset: float | None = None
    travel_offset: float | None = None
    angle_limits: tuple[float, float] | None = None
    travel_limits: tuple[float, float] | None = None
    rate_limit: float | None = None
    torque_limit: float | None = None
    force_limit: float | None = None
    group: str | None = None
    inertia: float | None = None
    damping: float | None = None
    proportional_gain: float | None = None
    derivative_gain: float | None = None
    integral_gain: float | None = None

    _name: ClassVar[str] = "motors"

    def __init__(
        self,
        *,
        name: str,
        cables: Sequence[str],
        spool_radius: Quantity | Sequence[Quantity] | None = None,
        gear_ratio: float | None = None,
        stiffness: Quantity | None = None,
        free_length: Quantity | None = None,
        pretension: Quantity | None = None,
        backlash: Quantity | None = None,
        angle_offset: Quantity | None = None,
        travel_offset: Quantity | None = None,
        angle_limits: Sequence[Quantity] | None = None,
        travel_limits: Sequence[Quantity] | None = None,
        rate_limit: Quantity | None = None,
        torque_limit: Quantity | None = None,
        force_limit: Quantity | None = None,
        group: str | None = None,
        inertia: Quantity | None = None,
        damping: Quantity | None = None,
        proportional_gain: Quantity | None = None,
        derivative_gain: Quantity | None = None,
        integral_gain: float | None = None,
    ) -> None:
        self._set(
            name=name,
            cables=cables,
            spool_radius=spool_radius,
            gear_ratio=gear_ratio,
            stiffness=stiffness,
            free_length=free_length,
            pretension=pretension,
            backlash=backlash,
            angle_offset=angle_offset,
            travel_offset=travel_offset,
            angle_limits=angle_limits,
            travel_limits=travel_limits,
            rate_limit=rate_limit,
            torque_limit=torque_limit,
            force_limit=force_limit,
            group=group,
            inertia=inertia,
            damping=damping,
            proportional_gain=proportional_gain,
            derivative_gain=derivative_gain,
            integral_gain=integral_gain,
        )
