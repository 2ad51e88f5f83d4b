"""What is asked of a robot, and how it is answered."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy.typing as npt

from . import _core, controlling, designing, exporting, models, reaching, simulating, surveying, sweeping
from ._commands import Commands, commanded, metres, paths, shortening_for, whole
from ._description import Description
from ._suggest import suggests
from ._tables import Quantity
from .batch import Batch, Gradients, pull_back_batch, solve_batch
from .controlling import Controller, Estimator
from .derivatives import Derivatives, Place
from .designing import Designed, Target
from .errors import InputError
from .exporting import Exported
from .models import ModelLike, StationsLike
from .reaching import Followed, Limits, PoseLike, ReachBatch, Reached
from .robot import Damping
from .simulating import Courses, Linearized, LoadsOverTime, Modes, Motion, State
from .solution import Branches, Solution, begun
from .surveying import Workspace
from .sweeping import Sweep
from .viewing import HEIGHT, Viewer, view
from .warning import distinct, tell

__all__ = ["Case", "load"]


def load(path: str | os.PathLike[str]) -> Case:
    """Reads a robot file.

    Parameters
    ----------
    path
        The robot file (:doc:`/robot-file`).

    Raises
    ------
    FileError
        With all that is wrong in the file, and where.

    Examples
    --------
    >>> case = load("examples/table1/case-3.toml")
    >>> case.title
    'Case III: general'
    """
    case = Case._of(_core.Setup.load(os.fspath(path)))
    tell(case.warnings)
    return case


class Case(Description):
    """A robot and what is asked of it. It never changes.

    Parameters
    ----------
    robot
        The robot.
    tension
        (c,) tension of each cable in N.
    shortening
        (c,) initial minus present length of each cable in m, or texts such as ``"5.7 %"`` of its own
        initial length. A cable may have both, as in robot files: each model is driven by the one that it
        takes, and the `actuation` of :meth:`solve` chooses between them.
    motors
        (m,) angle in rad or travel in m of each motor of the robot, instead of the shortenings of its cables.
    loads
        What acts from outside.
    base
        Where the base is; by default the frames of base and world are one.
    steps
        Steps of actuation, the last of which is the case; instead of `tension` and `shortening`.
    independent
        Whether each step starts from the robot at rest, instead of where the one before left it.
    obstacles
        What stands in the robot's way.
    title
        What it is.

    Examples
    --------
    >>> from whipcord import Loads
    >>> robot = load("examples/table1/case-3.toml").robot
    >>> case = Case(robot, tension=["400 gf"], loads=Loads(tip_force=["0.05 N", 0, 0]))
    >>> case.tension
    (3.92266,)
    >>> case.replace(tension=[2.0]).solve().tension
    array([2.])
    """

    @suggests
    def solve(
        self,
        *,
        tension: Commands | None = None,
        shortening: Commands | None = None,
        length: Commands | None = None,
        motors: Commands | None = None,
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        actuation: str | None = None,
        start: Solution | None = None,
        least_squares_lengths: bool = False,
        timeout: float | None = None,
    ) -> Solution:
        """The shape that the robot takes.

        Parameters
        ----------
        tension
            (c,) tension of each cable in N, instead of what the case says; in a case with steps, instead of
            the last one, after those before it. :meth:`replace` takes out the steps.
        shortening
            (c,) initial minus present length of each cable in m, likewise. A cable that has both a tension and a
            shortening is an error, unless `actuation` says which of them drives.
        length
            (c,) present length of each cable inside the robot in m, instead of a shortening.
        motors
            (m,) angle in rad or travel in m of each motor, instead of shortenings of its cables; None leaves those to
            their own commands. Where the drive has play, earlier steps of the case say on which side it was left.
        model
            One of the names in :data:`whipcord.models.NAMES`, or a model with options (:mod:`whipcord.models`).
        stations
            Number of equally spaced places of the shape, both ends included, or their arc lengths in m; by
            default the disks.
        actuation
            ``"tension"`` or ``"shortening"``: what drives all cables where both are given; by default what
            the model is driven by.
        start
            A neighbouring solution to start from. Only the iteration starts there: what friction kept of the
            way to it is not carried over; that is for steps.
        least_squares_lengths
            Where the cable lengths of a case in one step contradict each other, gives the stable shape that misses them least;
            ``diagnostics.length_misses`` has what each cable misses. By default that is an error.
        timeout
            Seconds after which the solve is ended; by default as long as it takes. Ctrl-C ends it, too.

        Raises
        ------
        SolveError
            With the reason why there is no answer, and the numbers that it needs.
        WhipcordTimeout
            Where the time limit was reached; also a ``TimeoutError``.
        InputError
            For arguments that cannot be.

        Examples
        --------
        >>> case = load("examples/table1/case-3.toml")
        >>> solution = case.solve(tension=[2.0], stations=37)
        >>> solution.position.shape
        (37, 3)
        """
        chosen = models.core(model, stations, actuation, timeout)
        name = "shortening"
        if length is not None:
            initial = self._setup.initial_lengths(chosen)
            shortening = shortening_for(length, shortening, initial, self.robot.cables)
            name = "length"
        given = commanded(tension, shortening, chosen, self.robot, motors, name)
        answer = self._setup.solve(chosen, *given, begun(start), least_squares_lengths)
        solution = Solution._of(self, chosen, answer, start)
        tell(solution.warnings)
        return solution

    def _solve(self, model: ModelLike, timeout: float | None = None) -> Solution:
        """The answer of a model to the case as it is, without a word about it."""
        chosen = models.core(model, timeout=timeout)
        return Solution._of(self, chosen, self._setup.solve(chosen), None)

    def view(self, *, open: bool | None = None, height: int = HEIGHT) -> Viewer:
        """Shows the robot in the browser, with sliders for its cables and loads; a notebook shows the page itself.

        Parameters
        ----------
        open
            Whether a tab of the browser is opened: by default, except in a notebook.
        height
            Height of the page in a notebook, in px.

        Returns
        -------
        Viewer
            The page, served until it is closed.
        """
        return view(self.to_toml(), open=open, height=height)

    @suggests
    def solve_steps(
        self,
        *,
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        actuation: str | None = None,
        timeout: float | None = None,
    ) -> list[Solution]:
        """The answers to all steps of the case in order, each from where the one before left the robot.

        Parameters
        ----------
        model, stations, actuation
            As for :meth:`solve`.
        timeout
            Seconds after which all steps together are ended; by default as long as they take.

        Examples
        --------
        >>> case = load("examples/rubbing-finger.toml")
        >>> out, back = [s for s in case.solve_steps(model="cosserat-disks") if s.tension[0] == 1.5]
        >>> bool(back.bend > out.bend)
        True
        """
        chosen = models.core(model, stations, actuation, timeout)
        answers = self._setup.solve_steps(chosen)
        solutions = [Solution._of(self, chosen, answer, None) for answer in answers]
        tell(distinct(warning for solution in solutions for warning in solution.warnings))
        return solutions

    @suggests
    def solve_batch(
        self,
        tension: npt.ArrayLike | None = None,
        *,
        shortening: npt.ArrayLike | None = None,
        motors: npt.ArrayLike | None = None,
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        threads: int | None = None,
        path: bool = False,
        progress: bool = False,
        timeout: float | None = None,
    ) -> Batch:
        """Many shapes at once.

        Parameters
        ----------
        tension
            (N, c) tensions in N; loads and base are those of the case.
        shortening
            (N, c) shortenings in m, instead of tensions.
        motors
            (N, m) angles in rad or travels in m of the motors, instead of both. Each row comes after the earlier steps of
            the case alone, also with `path`: no row moves the play of a drive for the next one.
        model, stations
            As for :meth:`solve`.
        threads
            How many threads share the rows; by default one for each processor. The answers are the same.
        path
            Whether the rows follow a path, so that each may start from the answer before it. As with `start`
            of :meth:`solve`, friction keeps nothing of the rows before.
        progress
            Whether to show a bar (needs the package tqdm).
        timeout
            Seconds after which the batch ends. A row that is not solved by then has no answer, and its error is
            :class:`whipcord.errors.WhipcordTimeout`.

        Returns
        -------
        Batch
            With ``position`` of shape (N, n, 3). A row without an answer does not raise: ``ok`` is false
            there, its numbers are NaN, and ``error(row)`` says why. ``unstable`` marks the answers that the robot
            leaves at the slightest disturbance.

        Examples
        --------
        >>> import numpy as np
        >>> case = load("examples/table1/case-3.toml")
        >>> batch = case.solve_batch(np.linspace(0, 4, 101)[:, None])
        >>> batch.position.shape
        (101, 10, 3)
        >>> bool(batch.ok.all())
        True
        """
        chosen = models.core(model, stations, None, timeout)
        return solve_batch(self, chosen, tension, shortening, motors, threads, path, progress)

    def pull_back_batch(
        self,
        tension: npt.ArrayLike | None = None,
        *,
        shortening: npt.ArrayLike | None = None,
        motors: npt.ArrayLike | None = None,
        parameters: Sequence[str] = (),
        position: npt.ArrayLike | None = None,
        rotation: npt.ArrayLike | None = None,
        cable_tension: npt.ArrayLike | None = None,
        cable_length: npt.ArrayLike | None = None,
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        threads: int | None = None,
        progress: bool = False,
        timeout: float | None = None,
    ) -> Gradients:
        """Vector–Jacobian products of a whole batch: for each row the gradient of one scalar.

        Parameters
        ----------
        tension, shortening, motors
            (N, c) or (N, m) commands of the rows, as for :meth:`solve_batch`.
        parameters
            Paths of parameters of the robot (:meth:`parameter`).
        position
            (N, n, 3) derivative of each row's scalar by its positions.
        rotation
            (N, n, 3) the same by turns of the frames, in rad about the axes of the world.
        cable_tension, cable_length
            (N, c) the same by the tensions and lengths of the cables.
        model, stations
            As for :meth:`solve`.
        threads, progress, timeout
            As for :meth:`solve_batch`.

        Returns
        -------
        Gradients
            ``commands`` of shape (N, c), or (N, m) by motors, and ``parameters`` of shape (N, p); zero in rows without an answer.

        Examples
        --------
        How the height of the tip changes with the tension and with the diameter of the backbone:

        >>> import numpy as np
        >>> case = load("examples/table1/case-3.toml")
        >>> weights = np.zeros((2, 10, 3))
        >>> weights[:, -1, 2] = 1
        >>> slope = case.pull_back_batch([[2.0], [3.0]], position=weights,
        ...                              parameters=["backbone.diameter"])
        >>> slope.commands.shape, slope.parameters.shape
        ((2, 1), (2, 1))
        """
        chosen = models.core(model, stations, None, timeout)
        weights = (position, rotation, cable_tension, cable_length)
        return pull_back_batch(
            self, chosen, tension, shortening, motors, paths(parameters), weights, threads, progress
        )

    @suggests
    def reach(
        self,
        *,
        tip: Sequence[Quantity] | npt.ArrayLike | None = None,
        pose: PoseLike | None = None,
        axis: npt.ArrayLike | None = None,
        shape: npt.ArrayLike | None = None,
        limits: Limits | Mapping[str, Any] | None = None,
        least: str | None = None,
        clearance: Quantity | None = None,
        tolerance: Quantity | None = None,
        tolerance_angle: Quantity | None = None,
        by: str | None = None,
        model: ModelLike = "cosserat",
        starts: int = 32,
        atlas: str | os.PathLike[str] | None = None,
        prove: bool = False,
        timeout: float | None = None,
    ) -> Reached:
        """Commands that bring the robot to a target; by default to that of ``[target]`` of the file.

        Parameters
        ----------
        tip
            (3,) point for the tip in m, or texts with units.
        pose
            Position and orientation of the tip: a pair of a point and a quaternion (w, x, y, z), or a dict as
            ``[target.pose]`` of a robot file.
        axis
            (3,) direction of the backbone at the tip, of any length; alone or with `tip`.
        shape
            (n, 3) points for the disks in m; a row of NaN for a disk that may be anywhere.
        limits
            Limits of all cables, instead of ``[limits]`` of the file. Limits of single cables and motors are those of the
            file.
        least
            Which of several answers is given: that with the least ``"tension"`` (default), the least ``"change"`` of the
            commands of this case, or the most ``"clearance"`` from obstacles.
        clearance
            Least distance from obstacles in m, 0 by default; ``"touch"`` where the robot may touch them.
        tolerance
            How far a point may be from its target in m; by default 1e-5 of the length of the backbone.
        tolerance_angle
            How far a direction may be from its target in rad.
        by
            Which commands are sought: ``"tensions"``, ``"lengths"`` or ``"motors"``; by default those of this case.
        model
            As for :meth:`solve`.
        starts
            Shapes from which the iteration may start, after the commands of this case.
        atlas
            Parquet file for these shapes: the first call computes and writes them, later ones of the same robot, model, loads
            and limits read them.
        prove
            Whether to try to prove that a target cannot be reached, where it is not.
        timeout
            Seconds after which the search is ended; by default as long as it takes.

        Returns
        -------
        Reached
            Where it is not ``ok`` the target is not reached, and the commands are the nearest that were found.

        Examples
        --------
        >>> case = load("examples/three-cable-segment.toml")
        >>> answer = case.reach(tip=["20 mm", 0, "117.5 mm"], limits={"tension": [0, "40 N"]})
        >>> answer.ok, answer.error < 2e-6
        (True, True)
        >>> case.reach(tip=[0, 0, 0.2]).status
        'nearest'
        """
        disks = len(self._setup.disks())
        points = reaching.shape_of(shape, disks)
        target = reaching.target_of(tip, pose, axis)
        if points is not None and target is not None:
            given = ", ".join(target)
            raise InputError(f"shape and {given} are both given: leave out one of them", path="shape")
        asked = reaching.asked(by, whole(starts, "starts"), prove, tolerance, tolerance_angle, atlas)
        chosen = models.core(model, timeout=timeout)
        setup = reaching.with_goal(self, target, limits, least, clearance)
        answer = reaching.reached(self, chosen, _core.reach(setup, chosen, asked, points))
        tell(answer.solution.warnings)
        return answer

    @suggests
    def reach_batch(
        self,
        targets: npt.ArrayLike,
        *,
        limits: Limits | Mapping[str, Any] | None = None,
        least: str | None = None,
        clearance: Quantity | None = None,
        tolerance: Quantity | None = None,
        tolerance_angle: Quantity | None = None,
        by: str | None = None,
        model: ModelLike = "cosserat",
        starts: int = 32,
        atlas: str | os.PathLike[str] | None = None,
        prove: bool = False,
        nearest: bool = False,
        threads: int | None = None,
        progress: bool = False,
        timeout: float | None = None,
    ) -> ReachBatch:
        """Commands for many targets, each by itself.

        From 256 targets on each search starts from the nearest of the commands of the case and of shapes all over the commands, one for every eight targets and
        128 at most, which are computed once for each thread; unless the least change is asked for.

        Parameters
        ----------
        targets
            (N, 3) points for the tip in m, or (N, 7) points with quaternions (w, x, y, z).
        limits, least, clearance, tolerance, tolerance_angle, by, model, starts, atlas, prove
            As for :meth:`reach`.
        nearest
            Whether rows whose target is not reached have the nearest commands that were found, instead of NaN.
        threads
            How many threads share the rows; by default one for each processor. The answers are the same.
        progress
            Whether to show a bar (needs the package tqdm).
        timeout
            Seconds after which the batch ends; rows that are not done by then have the status ``"failed"``.

        Returns
        -------
        ReachBatch
            Arrays with a row for each target, and the status of each.

        Examples
        --------
        >>> case = load("examples/two-segment-arm.toml")
        >>> batch = case.reach_batch([[0.05, 0.0, 0.29], [0.0, 0.0, 0.5]])
        >>> batch.status.tolist()
        ['reached', 'nearest']
        >>> batch.tension.shape
        (2, 6)
        """
        asked = reaching.asked(by, whole(starts, "starts"), prove, tolerance, tolerance_angle, atlas)
        chosen = models.core(model, timeout=timeout)
        setup = reaching.with_goal(self, None, limits, least, clearance)
        return reaching.reach_batch(setup, chosen, asked, targets, threads, nearest, progress)

    @suggests
    def follow(
        self,
        path: npt.ArrayLike | None = None,
        time: npt.ArrayLike | None = None,
        *,
        limits: Limits | Mapping[str, Any] | None = None,
        least: str | None = None,
        clearance: Quantity | None = None,
        tolerance: Quantity | None = None,
        tolerance_angle: Quantity | None = None,
        by: str | None = None,
        model: ModelLike = "cosserat",
        starts: int = 32,
        atlas: str | os.PathLike[str] | None = None,
        nearest: bool = False,
        timeout: float | None = None,
    ) -> Followed:
        """Commands along a path of targets at times, each from those of the point before and within the limits of the
        rates; by default along that of ``[target]`` of the file.

        Parameters
        ----------
        path
            (N, 3) points for the tip in m, or (N, 7) points with quaternions (w, x, y, z).
        time
            (N,) time of each point in s, ascending.
        limits, least, clearance, tolerance, tolerance_angle, by, model, starts, atlas
            As for :meth:`reach`.
        nearest
            Whether points that are not reached have the nearest commands that were found, instead of NaN.
        timeout
            Seconds after which the search is ended; by default as long as it takes.

        Returns
        -------
        Followed
            Arrays with a row for each point, and the places where the robot does not move smoothly.

        Examples
        --------
        >>> import numpy as np
        >>> case = load("examples/two-segment-arm.toml")
        >>> turn = np.linspace(0, 2 * np.pi, 9)
        >>> circle = np.c_[0.04 * np.cos(turn), 0.04 * np.sin(turn), np.full(9, 0.29)]
        >>> followed = case.follow(circle, 0.5 * np.arange(9))
        >>> bool(followed.ok.all()), len(followed.jumps)
        (True, 0)
        """
        asked = reaching.asked(by, whole(starts, "starts"), False, tolerance, tolerance_angle, atlas)
        chosen = models.core(model, timeout=timeout)
        setup = reaching.with_goal(self, None, limits, least, clearance)
        return reaching.follow(setup, chosen, asked, path, time, nearest)

    @suggests
    def workspace(
        self,
        *,
        voxel: Quantity | None = None,
        limits: Limits | Mapping[str, Any] | None = None,
        clearance: Quantity | None = None,
        by: str | None = None,
        stiffness: bool = True,
        model: ModelLike = "cosserat",
        shapes: int | None = None,
        solves: int | None = None,
        timeout: float | None = None,
    ) -> Workspace:
        """Where the tip can go within the limits: voxels, boundary, and maps of dexterity and stiffness.

        Parameters
        ----------
        voxel
            Edge of a voxel in m; by default a twenty-fifth of the length of the backbone.
        limits, clearance, by, model
            As for :meth:`reach`.
        stiffness
            Whether to compute the stiffness of the tip for each voxel.
        shapes
            Shapes that are solved before the survey grows from them; by default 100,000, fewer for models and robots that take long.
        solves
            Solves that the growth may spend; by default 400,000.
        timeout
            Seconds after which the survey is ended; by default as long as it takes.

        Returns
        -------
        Workspace
            Arrays with a row for each voxel, and the points of the boundary.

        Examples
        --------
        >>> case = load("examples/three-cable-segment.toml")
        >>> where = case.workspace(voxel="8 mm", limits={"tension": [0, "4 N"]})
        >>> where.dimension, where.tip.shape[1], where.command.shape[1]
        (2, 3, 3)
        """
        asked = reaching.asked(by, 0, False, None, None)
        chosen = models.core(model, timeout=timeout)
        setup = reaching.with_goal(self, None, limits, None, clearance)
        counts = [
            usual if given is None else whole(given, name)
            for name, given, usual in (("shapes", shapes, 100_000), ("solves", solves, 400_000))
        ]
        if min(counts) < 1:
            raise InputError("shapes and solves must be greater than zero", path="solves")
        return surveying.workspace(setup, chosen, asked, voxel, stiffness, (counts[0], counts[1]))

    @suggests
    def simulate(
        self,
        duration: Quantity | None = None,
        *,
        step: Quantity | None = None,
        every: Quantity | None = None,
        model: Literal["cosserat", "cosserat-disks"] | None = None,
        method: str | None = None,
        tolerance: Quantity | None = None,
        initial: str | State | Motion | None = None,
        elements: int | None = None,
        damping: Damping | Mapping[str, Any] | Quantity | None = None,
        drag: Mapping[str, Quantity] | Quantity | None = None,
        base: Mapping[str, Any] | None = None,
        tension: Courses | None = None,
        shortening: Courses | None = None,
        motors: Courses | None = None,
        loads: LoadsOverTime | None = None,
        timeout: float | None = None,
    ) -> Motion:
        """How the robot moves over time: the Cosserat rod with its masses (:doc:`/theory/motion`).

        What is not given is that of ``[motion]`` of the file, else the default.

        Parameters
        ----------
        duration
            Time in s that is simulated.
        step
            Length of a step in s; by default 10 ms.
        every
            Time in s between two states of the result; by default a step.
        model
            How cables run: ``"cosserat"``, along their routing (default), or ``"cosserat-disks"``, straight from disk to disk.
        method
            ``"accurate"``, ``"energy"`` or ``"robust"``.
        tolerance
            Error in m that a step may have; steps are divided until they meet it.
        initial
            ``"equilibrium"`` under the first commands and loads, ``"rest"`` without them, or where a :class:`whipcord.State`, the end of
            a :class:`whipcord.Motion` or that of a motion in JSON, by its path, is.
        elements
            Least number of elements along the backbone; by default 6.
        damping
            Damping of the backbone; a number is its time in s.
        drag
            Viscous drag of the surroundings on the backbone in N·s/m², ``across`` and ``along`` it; one value is that of both.
        base
            How the base moves: ``velocity`` in m/s along and ``angular_velocity`` in rad/s about its own axes, each three values, rows or functions
            as for ``tension``; ``csv``, the path of a table with its poses over time; or ``free``, True where nothing holds it.
        tension
            Tensions in N over time: one for each cable in order, None for a cable that keeps its command, or by their names. Each is a value;
            rows of times in s and values, with straight lines between them and a jump at a time that is there twice; or a function
            of the time in s, which is taken at the steps.
        shortening
            Shortenings in m over time, likewise.
        motors
            Angles in rad or travels in m of the motors over time, likewise.
        loads
            Pairs of loads and what they are multiplied by over time, beside the loads of the case.
        timeout
            Seconds after which the motion is ended; by default as long as it takes.

        Returns
        -------
        Motion
            Arrays with a row for each state.

        Raises
        ------
        MotionError
            With the time at which the motion does not go on, and the motion until then.

        Examples
        --------
        The arm is bent by a ramp and let go:

        >>> case = load("examples/released-arm.toml")
        >>> ramp = [("0 s", "0 N"), ("0.2 s", "3 N"), ("0.4 s", "3 N"), ("0.4 s", "0 N")]
        >>> motion = case.simulate("0.6 s", tension={"left": ramp})
        >>> motion.time.shape, bool(motion.tip[40, 0] > 0.02)
        ((61,), True)
        """
        return simulating.simulate(
            self,
            duration,
            timeout,
            step=step,
            every=every,
            model=model,
            method=method,
            tolerance=tolerance,
            initial=initial,
            elements=elements,
            damping=damping,
            drag=drag,
            base=base,
            tension=tension,
            shortening=shortening,
            motors=motors,
            loads=loads,
        )

    @suggests
    def modes(
        self, count: int = 6, *, time: Quantity | None = None, model: Literal["cosserat", "cosserat-disks"] | None = None
    ) -> Modes:
        """Natural frequencies, damping ratios and shapes of the vibrations about the equilibrium of the case.

        Parameters
        ----------
        count
            How many, from the lowest frequency on.
        time
            Time in s whose commands and loads of ``[motion]`` act; by default those of the case.
        model
            How cables run: ``"cosserat"``, along their routing (default), or ``"cosserat-disks"``, straight from disk to disk.

        Examples
        --------
        >>> modes = load("examples/released-arm.toml").modes()
        >>> bool(abs(modes.frequency[1] / modes.frequency[0] - 1) < 1e-6)
        True
        """
        return simulating.modes(self, count, time, model)

    @suggests
    def linearize(self) -> Linearized:
        """The motion linearised about the equilibrium that the motion of the case starts from, with the tensions as inputs. About other
        states: :meth:`whipcord.Simulation.linearize`.

        Examples
        --------
        >>> linear = load("examples/released-arm.toml").linearize()
        >>> linear.a.shape[0] == linear.b.shape[0], linear.b.shape[1]
        (True, 2)
        """
        return simulating.Simulation(self).linearize()

    @suggests
    def design(
        self,
        target: Target | None = None,
        *,
        vary: str | Sequence[str],
        targets: Sequence[tuple[Target, Sequence[float]] | tuple[Target, Sequence[float], float]] = (),
        path: npt.ArrayLike | None = None,
        criteria: str | Sequence[str] = (),
        max_jump: int | None = None,
        distinct: bool = False,
        crossing: bool = True,
        diameter: Sequence[Quantity] | None = None,
        fixed: Sequence[Mapping[str, Any]] = (),
        degree: int | None = None,
        places: int | None = None,
        starts: int | None = None,
        iterations: int | None = None,
        solves: int | None = None,
        limits: Limits | Mapping[str, Any] | None = None,
        tolerances: bool | Mapping[str, Any] = False,
        model: ModelLike | None = None,
        timeout: float | None = 60.0,
    ) -> Designed:
        """Change the robot so that it takes target shapes.

        Parameters
        ----------
        target
            A curve such as ``"arc, angle = 90 deg"`` (also circle, helix, s and clothoid), ``"measured"``, a place of the tip in m, the
            places of the disks beyond the base in m, or a dict of places by number of the disk from 0.
        vary
            What may change: ``"cables[0].holes"``, ``"cables[0].routing"``, ``"cables[0].tension"``, each with a number, a name or ``*``,
            ``"backbone.rest_curvature"``, ``"backbone.diameters"``, ``"disks.positions"``, ``"cables"`` (their number), or a number of
            the robot such as ``"backbone.young_modulus"``.
        targets
            Several targets, each with the tensions of the cables in N under which the robot is to take it, and with a weight where the
            squares of its distances are to count otherwise than once.
        path
            (N, 3) places of the tip in m, each of them a target with tensions of its own, which must therefore vary.
        criteria
            What counts beside the targets, as text: ``"tension, weight = 0.01"``, ``"tension, at_most = 6 N"``, ``"clearance, at_least = 5 mm"``
            from obstacles, ``"stiffness, disk = 10, direction = x, at_least = 200 N/m"`` or ``"workspace, weight = 0.1"``. A limit is a hard
            constraint; a weight makes an objective, which counts beside the squares of the distances as parts of the length. With criteria
            there need not be a target.
        max_jump
            Holes by which a cable may move from a disk to the next.
        distinct
            Whether no two cables may share a hole.
        crossing
            Whether cables may cross between two disks.
        diameter
            Least and greatest diameter of the backbone.
        fixed
            Holes that are given: dicts with ``cable``, ``disk`` and ``hole``, both from 1.
        degree
            Degree of the polynomials of a continuous routing; 5 by default.
        places
            Places along the backbone at which a rest curvature or a diameter is given; 37 by default.
        starts
            Starts of least squares; 6 by default.
        iterations
            Steps of least squares from each start; 200 by default.
        solves
            Solves of whole shapes that the search may take, after which it ends with the best so far; 40000 by default. The same number
            gives the same robot on every computer.
        limits
            Limits of the tensions, as for :meth:`reach`.
        tolerances
            True to solve robots with deviations of manufacture, or their standard deviations, as in ``[design.tolerances]``.
        model
            By default ``cosserat-disks`` where holes or disks are varied, else ``cosserat``.
        timeout
            Seconds after which the search ends with the best so far, which :attr:`Designed.ended` tells; 60 by default, None for as long as
            it takes. What is left to do, such as the tolerances, may take as long again.

        Returns
        -------
        Designed
            The robot, how near it comes to its targets, and what is proven.

        Examples
        --------
        >>> case = load("examples/table1/case-3.toml").replace(tension=["8 N"])
        >>> found = case.design("s, angle = 20 deg", vary="cables[0].routing")
        >>> found.findings[0]["known"], bool(found.largest_error < 1e-3)
        ('closed_form', True)
        """
        disks = len(self._setup.disks())
        asked = [] if target is None else [designing.wanted(target, disks, None, None)]
        for each in targets:
            weight = each[2] if len(each) == 3 else None
            asked.append(designing.wanted(each[0], disks, each[1], weight))
        if path is not None:
            asked.append(designing.along(path))
        table: dict[str, Any] = {"vary": [vary] if isinstance(vary, str) else list(vary)}
        given: dict[str, Any] = {
            "criteria": ([criteria] if isinstance(criteria, str) else list(criteria)) or None,
            "max_jump": max_jump,
            "distinct": distinct or None,
            "crossing": None if crossing else False,
            "diameter": None if diameter is None else list(diameter),
            "fixed": [dict(each) for each in fixed] or None,
            "degree": degree,
            "places": places,
            "starts": starts,
            "iterations": iterations,
            "solves": solves,
        }
        if not isinstance(tolerances, bool):
            given["tolerances"] = dict(tolerances)
        table |= {key: value for key, value in given.items() if value is not None}
        changed = self
        if limits is not None:
            changed = type(self)._of(reaching.with_goal(self, None, limits, None, None))
        chosen = models.core("cosserat" if model is None else model, timeout=timeout)
        return designing.found(changed, asked, table, chosen, model is not None, bool(tolerances))

    @suggests
    def sweep(
        self,
        vary: Mapping[str, str | Sequence[float | str]] | None = None,
        out: str | os.PathLike[str] = "sweep",
        *,
        table: Mapping[str, npt.ArrayLike] | None = None,
        samples: int | None = None,
        sampling: str = "latin-hypercube",
        seed: int = 0,
        outputs: str | Sequence[str] = "tip",
        shard: tuple[int, int] = (0, 1),
        resume: bool = False,
        rows_per_part: int | None = None,
        model: ModelLike = "cosserat",
        timeout: float | None = None,
    ) -> Sweep:
        """Write a data set of many shapes, in which commands, loads or any other keys of the robot file vary.

        Parameters
        ----------
        vary
            For each path of a key, as ``--set`` of the command line has it, its values: ``"0 N:20 N:41"`` for 41 values from the first
            to the last, ``"0 N:20 N"`` where rows are sampled, or a list such as ``["1 mm", "1.2 mm"]``. Without `samples` the
            rows are all combinations.
        out
            Folder of the data set.
        table
            Rows in place of `vary`: for each column, named by path and unit such as ``"cables.a.tension [N]"``, its values.
        samples
            Number of rows that are sampled.
        sampling
            ``"latin-hypercube"``, ``"sobol"`` or ``"random"``.
        seed
            What the samples follow from.
        outputs
            Of ``"tip"``, ``"disks"``, ``"tensions"``, ``"lengths"``, ``"stability"`` and ``"jacobian"``.
        shard
            ``(i, n)``: make only the parts of shard i of n, counted from 0. The union of all shards is the data set, bit for bit.
        resume
            Go on with a data set that was begun.
        rows_per_part
            Rows of each Parquet file; by default 65,536, or 4,096 where there are loads or obstacles, cables rub, or the robot is
            read again for each row, and fewer where rows are long.
        model
            A model by its name, or one with options.
        timeout
            Seconds after which the sweep is ended; the parts that are written stay.

        Returns
        -------
        Sweep
            Where the data set is, and what became of its rows.

        Examples
        --------
        >>> import tempfile
        >>> case = load("examples/three-cable-segment.toml")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     made = case.sweep({"cables.a.tension": "0 N:3 N", "cables.b.tension": "0 N:3 N"}, folder, samples=100)
        ...     made.rows, made.failed
        (100, 0)
        """
        question = sweeping.asked(vary, table, samples, sampling, seed, outputs, rows_per_part)
        chosen = models.core(model, timeout=timeout)
        return sweeping.sweep(self._setup, chosen, question, out, shard, resume)

    @suggests
    def export(
        self,
        path: str | os.PathLike[str],
        *,
        to: str | None = None,
        per_span: int | None = None,
        model: ModelLike = "cosserat",
        actuation: str | None = None,
        timeout: float | None = None,
    ) -> Exported:
        """Write the robot and its solved shape for another program.

        Parameters
        ----------
        path
            File to write. Files that belong to it are written beside it.
        to
            ``"mjcf"`` for MuJoCo (``.xml``), ``"urdf"`` (``.urdf``), ``"vtk"`` for ParaView (``.pvd``), ``"gltf"`` for Blender and browsers
            (``.glb``) or ``"step-points"`` for CAD (``.step``); by default what the name of the file ends in.
        per_span
            Bodies (mjcf, urdf; by default 4) or pieces of curves (by default 8) between two disks.
        model
            A model by its name, or one with options. Cables are guided where it has them: at the disks by ``"cosserat-disks"``, all
            along the backbone by ``"cosserat"``.
        actuation
            ``"tension"`` or ``"shortening"``, for all cables; by default as :meth:`solve` has it. A cable of an MJCF file is driven by the same.
        timeout
            Seconds after which the solve is ended.

        Returns
        -------
        Exported
            The files, and what is not in them.

        Examples
        --------
        >>> import tempfile
        >>> case = load("examples/three-cable-segment.toml")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     made = case.export(f"{folder}/segment.xml", model="cosserat-disks")
        ...     made.files[0].read_text().count("<spatial")
        3
        """
        chosen = models.core(model, None, actuation, timeout)
        return exporting.export(self._setup, chosen, path, to, per_span)

    @suggests
    def controller(
        self,
        *,
        period: Quantity,
        gain: float | None = None,
        damping: float | None = None,
        estimator: Estimator | bool | None = None,
        limits: Limits | Mapping[str, Any] | None = None,
        tolerance: Quantity | None = None,
        tolerance_angle: Quantity | None = None,
        by: str | None = None,
        model: ModelLike = "cosserat",
    ) -> Controller:
        """A controller that starts with the commands of this case.

        Parameters
        ----------
        period
            Time of a cycle in s.
        gain
            The part of an error that is left after a second is exp(−gain); by default 5.
        damping
            Weight of the change of the commands; more is calmer near singular shapes. 1e-6 by default.
        estimator
            What is believed of model and measurement; ``False`` ignores measurements.
        limits, by, model
            As for :meth:`reach`; the model must have exact derivatives.
        tolerance, tolerance_angle
            As for :meth:`reach`: how an angle counts beside a distance.

        Returns
        -------
        Controller
            It remembers the commands in force and the estimate: one for each robot.

        Examples
        --------
        >>> case = load("examples/three-cable-segment.toml")
        >>> controller = case.controller(period="1 ms", limits={"tension": [0, "20 N"], "rate": "50 N/s"})
        >>> cycle = controller.step(tip=["20 mm", 0, "117 mm"])
        >>> cycle.command.shape, cycle.jacobian.shape
        ((3,), (6, 3))
        >>> bool((abs(cycle.command - case.tension) <= 0.05 + 1e-12).all())
        True
        """
        asked = reaching.asked(by, 0, False, tolerance, tolerance_angle)
        chosen = models.core(model)
        setup = reaching.with_goal(self, None, limits, None, None)
        given = controlling.options(period, gain, damping, estimator)
        inner = _core.Controller(setup, chosen, asked, given)
        return Controller(self, chosen, inner, len(self._setup.disks()))

    @suggests
    def differentiate(
        self,
        *,
        parameters: Sequence[str] = (),
        tension: Commands | None = None,
        shortening: Commands | None = None,
        motors: Commands | None = None,
        model: ModelLike = "cosserat",
        stations: StationsLike = None,
        actuation: str | None = None,
        start: Solution | None = None,
        timeout: float | None = None,
    ) -> tuple[Solution, Derivatives]:
        """The shape with its exact derivatives, in one pass; other arguments as for :meth:`solve`.

        Parameters
        ----------
        parameters
            Paths of quantities of robot and case, as in robot files and counted from 0:
            ``"backbone.young_modulus"``, ``"cables[0].routing.radius"``, ``"loads.tip_force[2]"``.
        tension, shortening, motors, model, stations, actuation, start, timeout
            As for :meth:`solve`.

        Examples
        --------
        >>> case = load("examples/table1/case-3.toml")
        >>> solution, derivatives = case.differentiate(parameters=["backbone.young_modulus"])
        >>> derivatives.position_by_command.shape, derivatives.position_by_parameter.shape
        ((10, 3, 1), (10, 3, 1))
        """
        chosen = models.core(model, stations, actuation, timeout)
        given = commanded(tension, shortening, chosen, self.robot, motors)
        asked = paths(parameters)
        answer, inner = _core.derivatives(self._setup, chosen, asked, *given, begun(start))
        solution = Solution._of(self, chosen, answer, start)
        tell(solution.warnings)
        return solution, Derivatives(inner, tuple(asked))

    @suggests
    def stiffness(
        self,
        at: Quantity | None = None,
        *,
        tension: Commands | None = None,
        shortening: Commands | None = None,
        motors: Commands | None = None,
        model: ModelLike = "cosserat",
        actuation: str | None = None,
        timeout: float | None = None,
    ) -> Place:
        """How a place moves with the cables and yields to loads.

        Parameters
        ----------
        at
            Arc length of the place in m; the tip by default.
        tension, shortening, motors, model, actuation, timeout
            As for :meth:`solve`.

        Examples
        --------
        >>> tip = load("examples/table1/case-3.toml").stiffness()
        >>> tip.compliance.shape, tip.jacobian.shape
        ((6, 6), (6, 1))
        """
        chosen = models.core(model, None, actuation, timeout)
        place = None if at is None else metres(at, "at")
        given = commanded(tension, shortening, chosen, self.robot, motors)
        answer, values = self._setup.local(chosen, place, *given)
        solution = Solution._of(self, chosen, answer, None)
        tell(solution.warnings)
        return Place._of(solution, values)

    @suggests
    def branches(
        self,
        *,
        tension: Commands | None = None,
        shortening: Commands | None = None,
        motors: Commands | None = None,
        model: ModelLike = "cosserat",
        actuation: str | None = None,
        timeout: float | None = None,
    ) -> Branches:
        """All equilibria under the load that lie on the path from no load and on the branches off it.

        Parameters
        ----------
        tension, shortening, motors, actuation
            As for :meth:`solve`.
        model
            Any model of an equilibrium under loads: not constant-curvature, and four-bar only with the objective
            ``"strain-energy"`` and the length rule ``"free"``.
        timeout
            Seconds after which the search is ended; by default as long as it takes.
        """
        chosen = models.core(model, None, actuation, timeout)
        given = commanded(tension, shortening, chosen, self.robot, motors)
        return Branches._of(self, chosen, self._setup.branches(chosen, *given))
