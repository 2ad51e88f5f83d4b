//! Friction of cables: their tensions in all passages by the law of the holes, in every step of the iteration.
//!
//! Where cables are straight between disks a passage is a chord, and its near hole that of a disk. Where they are continuous a passage stands for one point of an
//! element, and a hole for the way from point to point, on which the cable turns. A cable on a motor with inertia has a further passage in front of these, from the motor to the
//! hole in the base.

use whipcord::{HoleFriction, HoleResponse, Robot, Wrench};
use whipcord_numerics::{GAUSS_2, Pose, Twist, Vec3};

use crate::block::{add, dot, transposed_bracket};
use crate::chords;
use crate::drives::Drives;
use crate::element::{POINTS, add_to_nodes};
use crate::hole_rows::HoleRows;
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// The holes of a robot in motion, and room for their equations.
#[derive(Clone, Debug)]
pub(crate) struct Friction {
    pub holes: HoleFriction,
    /// The cable of each passage; those between a motor with inertia and the base are the last ones.
    cables: Vec<usize>,
    /// Number of passages inside the robot.
    inside: usize,
    /// Length in m that the drive of each cable leaves, but for what motors with inertia shorten.
    targets: Vec<f64>,
    /// Pairs of cables, with how the tension of the second at its motor lengthens the first.
    yields: Vec<(usize, usize, f64)>,
    /// The shape at the end of a step.
    strains: Vec<Twist>,
    poses: Vec<Pose>,
    pulls: Vec<Wrench>,
    /// A gradient by the strains.
    gradient: Vec<Twist>,
    lengths: Vec<f64>,
    turns: Vec<f64>,
    /// What a tension of 1 N in each passage exerts on the nodes, then the velocities that it takes away.
    columns: Vec<Vec<Twist>>,
    /// What a change of the velocities adds to a length or an angle.
    row: Vec<Twist>,
    /// Rows of the response, by passage.
    by_lengths: Vec<f64>,
    by_turns: Vec<f64>,
    /// What other forces add to lengths and to angles, by force and passage.
    by_forces: [Vec<f64>; 2],
    /// Changes of the tensions, then those by each force.
    responses: Vec<Vec<f64>>,
}

/// A passage whose piece of cable stays in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Locked {
    pub passage: usize,
    pub cable: usize,
    /// How far the piece gives in m/N.
    pub yielding: f64,
    /// Tension in N and length in m where it stays.
    pub tension: f64,
    pub length: f64,
}

/// The equations of the holes have no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SingularHoles;

impl Friction {
    /// `None` for a robot whose cables have no friction.
    pub fn new(robot: &Robot, rod: &Rod) -> Option<Self> {
        if !robot.cables().iter().any(whipcord::Cable::has_friction) {
            return None;
        }
        let (nodes, points) = (rod.nodes.len(), rod.points.len());
        let rest: Vec<Twist> = rod.points.iter().map(|point| point.rest).collect();
        let mut poses = vec![Pose::IDENTITY; nodes];
        pose::nodes(rod, Pose::IDENTITY, &rest, &mut poses);
        let mut cables = rod.cables_of_passages();
        let inside = cables.len();
        let lengths: Vec<f64> =
            (0..inside).map(|p| length(rod, p, cables[p], &rest, &poses)).collect();
        let passages: Vec<(usize, f64)> =
            cables.iter().copied().zip(lengths.iter().copied()).collect();
        let lever = robot.routes().iter().map(|route| route.at(0.0).offset.norm());
        let lever = lever.fold(1e-3 * rod.length, f64::max);
        let bending = rod.points.iter().map(|point| point.stiffness.d.rows[0].x);
        let bending = bending.fold(f64::INFINITY, f64::min);
        let with_inertia = robot.motors().iter().filter(|motor| motor.dynamics.is_some());
        let driven: Vec<usize> =
            with_inertia.flat_map(|motor| motor.cables.iter().map(|of| of.cable)).collect();
        let compliance = lever * lever * rod.length / bending;
        let holes = HoleFriction::new(robot, &passages, compliance).with_drives(&driven);
        cables.extend(driven);
        let count = cables.len();
        Some(Self {
            holes,
            cables,
            inside,
            targets: vec![0.0; robot.cables().len()],
            yields: Vec::new(),
            strains: rest,
            poses,
            pulls: vec![Wrench::default(); nodes],
            gradient: vec![Twist::default(); points],
            lengths: vec![0.0; count],
            turns: vec![0.0; count],
            columns: vec![vec![Twist::default(); nodes]; count],
            row: vec![Twist::default(); nodes],
            by_lengths: vec![0.0; count * (count + 1)],
            by_turns: vec![0.0; count * (count + 1)],
            by_forces: Default::default(),
            responses: Vec::new(),
        })
    }

    /// Lengths of all passages in a shape.
    pub fn lengths(&self, rod: &Rod, strains: &[Twist], poses: &[Pose]) -> Vec<f64> {
        let cables = self.cables[..self.inside].iter().enumerate();
        let mut lengths: Vec<f64> =
            cables.map(|(p, &cable)| length(rod, p, cable, strains, poses)).collect();
        lengths.resize(self.cables.len(), 0.0);
        lengths
    }

    /// The cables on motors with inertia, each with its passage between motor and base.
    pub fn outside(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.cables.iter().copied().zip(0..).skip(self.inside)
    }

    /// The passages of a cable from a passage on.
    fn from(&self, rod: &Rod, passage: usize) -> Vec<usize> {
        let cable = self.cables[passage];
        let (outside, first) = match passage.checked_sub(self.inside) {
            Some(_) => (Some(passage), rod.first_passages[cable]),
            None => (None, passage),
        };
        let inside = (first..self.inside).take_while(|&k| self.cables[k] == cable);
        outside.into_iter().chain(inside).collect()
    }

    /// Commands a cable by the unstretched length in m that its drive leaves, but for what a motor with inertia shortens.
    pub fn command_length(&mut self, cable: usize, target: f64) {
        self.targets[cable] = target;
        self.holes.command_length(cable, target);
    }

    /// Energy in J of the stretch of a cable and its drive, where the passages have these tensions.
    pub fn stretch(&self, robot: &Robot, cable: usize, tensions: &[f64]) -> f64 {
        let passages = self.cables.iter().zip(tensions).zip(self.holes.yielding());
        let own = passages.filter(|((of, _), _)| **of == cable);
        let inside: f64 = own.map(|((_, tension), by)| 0.5 * by * tension * tension).sum();
        let outside = self.outside().find(|(of, _)| *of == cable);
        let tension = outside.and_then(|(_, p)| tensions.get(p)).copied().unwrap_or_default();
        inside + 0.5 * robot.outside_compliance(cable) * tension * tension
    }

    /// Has motors with inertia leave the lengths that they do where the cables have the tensions of a stage, and yield as these change.
    fn follow_drives(&mut self, scheme: &Scheme, stage: &Stage, drives: &Drives) {
        let Self { holes, cables, inside, targets, yields, .. } = self;
        let driven = &cables[*inside..];
        yields.clear();
        let mut moved = vec![0.0; driven.len()];
        drives.add_lengths(
            scheme,
            driven,
            &stage.tensions,
            |i, more| moved[i] += more,
            |i, j, by| yields.push((driven[i], driven[j], by)),
        );
        let is_driven = |cable: usize| drives.moves(cable);
        for (&cable, more) in driven.iter().zip(moved).filter(|(cable, _)| is_driven(**cable)) {
            holes.command_length(cable, targets[cable] + more);
        }
        holes.set_yields(yields.iter().copied());
    }

    /// Changes the tensions in a step of the iteration of a stage, whose residual is already solved for; adds what they do to the velocities.
    pub fn solve(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &mut Stage,
        drives: &Drives,
    ) -> Result<(), SingularHoles> {
        self.linearise(rod, scheme, (stage, drives), &[]);
        self.respond_to_forces(&[])?;
        self.take(stage);
        Ok(())
    }

    /// Finds how lengths and angles respond to the tensions, in the linearisation of a stage whose residual is already solved for, and to forces of 1 N that take these velocities away
    /// each.
    pub fn linearise(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        (stage, drives): (&Stage, &Drives),
        by_forces: &[Vec<Twist>],
    ) {
        self.follow_drives(scheme, stage, drives);
        self.measure(rod, scheme, stage);
        let n = self.cables.len();
        for p in 0..n {
            self.find_column(rod, scheme, stage, p);
        }
        for of_forces in &mut self.by_forces {
            of_forces.clear();
            of_forces.resize(by_forces.len() * n, 0.0);
        }
        for p in 0..n {
            for is_turn in [false, true] {
                self.find_gradient(rod, p, is_turn);
                self.respond(rod, scheme, stage, p, by_forces, is_turn);
            }
        }
    }

    /// Finds how the tensions change where the forces change by these amounts, in the cases that the holes have then: [`Self::responses`].
    pub fn respond_to_forces(&mut self, changes: &[f64]) -> Result<(), SingularHoles> {
        let response = HoleResponse {
            lengths: &self.by_lengths,
            turns: &self.by_turns,
            lengths_by_force: &self.by_forces[0],
            turns_by_force: &self.by_forces[1],
        };
        let found = self.holes.changes_with_forces(response, changes).ok_or(SingularHoles)?;
        self.responses.resize_with(found.len(), Vec::new);
        for (out, found) in self.responses.iter_mut().zip(found) {
            out.clone_from(found);
        }
        Ok(())
    }

    /// How the tensions of all passages change with what a stage lacks and the changes of the forces that were given; then how that changes with each of the forces.
    pub fn responses(&self) -> &[Vec<f64>] {
        &self.responses
    }

    /// Adds what changes of all tensions do to velocities.
    pub fn add_velocities(&self, changes: &[f64], velocities: &mut [Twist]) {
        for (column, change) in self.columns.iter().zip(changes).filter(|(_, by)| **by != 0.0) {
            for (x, y) in velocities.iter_mut().zip(column) {
                *x = *x - *y * *change;
            }
        }
    }

    /// Changes the tensions as they respond, with what they do to the velocities.
    pub fn take(&mut self, stage: &mut Stage) {
        let Self { holes, responses, columns, cables, inside, .. } = self;
        let Some(changes) = responses.first() else { return };
        holes.advance(changes);
        for (&cable, &tension) in cables.iter().zip(holes.tensions()).skip(*inside) {
            stage.tensions[cable] = tension;
        }
        for (p, (&tension, before)) in holes.tensions().iter().zip(&mut stage.passages).enumerate()
        {
            let change = tension - *before;
            *before = tension;
            for (x, y) in stage.residual.iter_mut().zip(&columns[p]) {
                *x = *x - *y * change;
            }
        }
    }

    /// Measures lengths and angles at the end of the step as the stage has it now; what the equations of the holes leave, as a part of the length.
    pub fn measure(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) -> f64 {
        self.take_end(rod, scheme, stage);
        self.measure_shape(rod);
        self.holes.assess(&self.lengths, &self.turns)
    }

    /// Takes the shape at the end of the step as the stage has it now.
    fn take_end(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) {
        for ((end, start), strain) in self.strains.iter_mut().zip(&stage.start).zip(&stage.strains)
        {
            *end = scheme.end(*start, *strain);
        }
        pose::nodes(rod, stage.base, &self.strains, &mut self.poses);
    }

    /// The linearised equations of the holes at the end of the step that was assessed last.
    pub fn rows(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage) -> HoleRows {
        self.take_end(rod, scheme, stage);
        let n = self.cables.len();
        let mut rows = HoleRows {
            equations: self.holes.equations(),
            cables: self.cables.clone(),
            from: (0..n).map(|p| self.from(rod, p)).collect(),
            outside: self.outside().collect(),
            pulls: Vec::with_capacity(n),
            beyond: Vec::with_capacity(n),
            turns: Vec::with_capacity(n),
            yielding: self.holes.yielding().to_vec(),
        };
        for p in 0..n {
            self.find_gradient(rod, p, false);
            rows.beyond.push(self.gradient.clone());
            // Of a hole in which the cable does not slide the angle does not count.
            if rows.equations[p].by_turn == 0.0 {
                self.gradient.fill(Twist::default());
            } else {
                self.find_gradient(rod, p, true);
            }
            rows.turns.push(self.gradient.clone());
            self.find_unit_pull(rod, scheme, stage, p);
            rows.pulls.push(self.gradient.clone());
        }
        let own = rows.beyond.clone();
        for (p, beyond) in rows.beyond.iter_mut().enumerate() {
            for &k in &rows.from[p][1..] {
                add(beyond, &own[k], 1.0);
            }
        }
        rows
    }

    /// Writes the gradient by the strains at the end of the step of the length of a passage, or of the angle in its near hole.
    fn find_gradient(&mut self, rod: &Rod, p: usize, is_turn: bool) {
        let cable = self.cables[p];
        self.gradient.fill(Twist::default());
        if p >= self.inside {
            return;
        }
        match (rod.has_chords(), is_turn) {
            (true, false) => self.straight_length(rod, p),
            (true, true) => self.straight_turn(rod, p, cable),
            (false, false) => self.length_at_point(rod, p, cable),
            (false, true) => self.turn_at_point(rod, p, cable),
        }
    }

    /// Measures lengths and angles of the shape at hand.
    fn measure_shape(&mut self, rod: &Rod) {
        for p in 0..self.inside {
            let cable = self.cables[p];
            self.lengths[p] = length(rod, p, cable, &self.strains, &self.poses);
            self.turns[p] = if rod.has_chords() {
                let [before, after] = self.directions(rod, p, cable);
                angle(before, after)
            } else {
                self.turn(rod, p, cable, &self.strains)
            };
        }
    }

    /// The passages whose pieces of cable stay in them however the robot moves a little from the shape of a stage, where the holes are as they remember; `None` where a cable slides
    /// or is about to.
    pub fn locked(&mut self, rod: &Rod, stage: &Stage) -> Option<Vec<Locked>> {
        self.strains.copy_from_slice(&stage.strains);
        self.poses.copy_from_slice(&stage.poses);
        self.measure_shape(rod);
        let of = |(passage, yielding): (usize, f64)| Locked {
            passage,
            cable: self.cables[passage],
            yielding,
            tension: self.holes.tensions()[passage],
            length: self.lengths[passage],
        };
        Some(self.holes.locked(&self.turns)?.into_iter().map(of).collect())
    }

    /// What a tension of 1 N in a passage exerts on the nodes.
    pub fn pull(&mut self, rod: &Rod, stage: &Stage, passage: usize) -> Vec<Twist> {
        self.add_pull(rod, &Scheme::STATICS, stage, passage);
        self.columns[passage].clone()
    }

    /// What a tension of 1 N in a passage does to the velocities, against its pull.
    fn find_column(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage, p: usize) {
        self.add_pull(rod, scheme, stage, p);
        stage.matrix.solve(&mut self.columns[p]);
    }

    /// Writes what a tension of 1 N in a passage exerts on the nodes.
    fn add_pull(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage, p: usize) {
        self.find_unit_pull(rod, scheme, stage, p);
        let Self { gradient, columns, .. } = self;
        let column = &mut columns[p];
        column.fill(Twist::default());
        for (q, (pull, strain)) in gradient.iter().zip(&stage.strains).enumerate() {
            if *pull != Twist::default() {
                let (e, k) = (q / POINTS, q % POINTS);
                let across = transposed_bracket(strain, pull);
                add_to_nodes(&mut column[2 * e..], pull, &across, 1.0, k, rod.lengths[e]);
            }
        }
    }

    /// Writes what a tension of 1 N in a passage exerts on the strains of the stage, times the weights of the points.
    fn find_unit_pull(&mut self, rod: &Rod, scheme: &Scheme, stage: &Stage, p: usize) {
        let Self { cables, inside, pulls, gradient, .. } = self;
        if p >= *inside {
            gradient.fill(Twist::default());
            return;
        }
        if rod.has_chords() {
            let tension = |of: usize| if of == p { 1.0 } else { 0.0 };
            chords::gradient(rod, &stage.strains, &stage.poses, tension, pulls, gradient);
            return;
        }
        gradient.fill(Twist::default());
        let q = p - rod.first_passages[cables[p]];
        let crossing = &rod.crossings[q * rod.cables.len() + cables[p]];
        let pull = Pull::new(crossing, &stage.strains[q], &stage.start[q], scheme);
        gradient[q] = pull.wrench(crossing) * rod.points[q].weight;
    }

    /// Writes how a quantity of the shape at the end of the step, with the gradient at hand, responds to the tensions and to the step that they leave.
    fn respond(
        &mut self,
        rod: &Rod,
        scheme: &Scheme,
        stage: &Stage,
        p: usize,
        by_forces: &[Vec<Twist>],
        is_turn: bool,
    ) {
        let n = self.cables.len();
        let Self { gradient, row, columns, by_lengths, by_turns, .. } = self;
        row.fill(Twist::default());
        let mut left = 0.0;
        for (q, gradient) in gradient.iter().enumerate() {
            if *gradient == Twist::default() {
                continue;
            }
            let gradient = *gradient * (1.0 / scheme.place);
            let (e, k) = (q / POINTS, q % POINTS);
            left += dot(&gradient, &stage.lack[q]);
            let (slope, value) = stage.tangents[q].transposed_strain_change(&gradient);
            add_to_nodes(&mut row[2 * e..], &slope, &value, 1.0, k, rod.lengths[e]);
        }
        let through = |x: &[Twist]| row.iter().zip(x).map(|(a, b)| dot(a, b)).sum::<f64>();
        let out = if is_turn { by_turns } else { by_lengths };
        let out = &mut out[p * (n + 1)..(p + 1) * (n + 1)];
        for (out, column) in out.iter_mut().zip(columns.iter()) {
            *out = -through(column);
        }
        out[n] = left + through(&stage.residual);
        let of_forces = &mut self.by_forces[usize::from(is_turn)];
        for (k, column) in by_forces.iter().enumerate() {
            of_forces[k * n + p] = -through(column);
        }
    }

    /// The gradient of the length of a continuous passage.
    fn length_at_point(&mut self, rod: &Rod, p: usize, cable: usize) {
        let q = p - rod.first_passages[cable];
        let crossing = &rod.crossings[q * rod.cables.len() + cable];
        let strain = &self.strains[q];
        let pull = Pull::new(crossing, strain, strain, &Scheme::STATICS).wrench(crossing);
        self.gradient[q] = pull * rod.points[q].weight;
    }

    /// The angle by which a continuous cable turns from the point before a passage to its own, or from the axis of the base.
    fn turn(&self, rod: &Rod, p: usize, cable: usize, strains: &[Twist]) -> f64 {
        let q = p - rod.first_passages[cable];
        let tangent = |q: usize| rod.crossings[q * rod.cables.len() + cable].tangent(&strains[q]);
        let [from, to] = GAUSS_2.nodes;
        let (e, k) = (q / POINTS, q % POINTS);
        let h = rod.lengths[e];
        // How the section turns on the way, by the curvatures at both points.
        let way = match (q, k) {
            (0, _) => strains[0].angular * (from * h),
            (_, 1) => (strains[q - 1].angular + strains[q].angular) * (0.5 * (to - from) * h),
            _ => {
                let before = rod.lengths[e - 1] * (1.0 - to);
                strains[q - 1].angular * before + strains[q].angular * (from * h)
            }
        };
        let turn = Pose::exp(Twist { linear: Vec3::ZERO, angular: way }).rotation;
        let before = if q == 0 { Vec3::Z } else { tangent(q - 1) };
        angle(before, turn.rotate(tangent(q)))
    }

    /// The gradient of that angle, by differences.
    fn turn_at_point(&mut self, rod: &Rod, p: usize, cable: usize) {
        let q = p - rod.first_passages[cable];
        for point in q.saturating_sub(1)..=q {
            let mut gradient = [0.0; 6];
            for (i, entry) in gradient.iter_mut().enumerate() {
                let step = if i < 3 { 1e-6 } else { 1e-6 / rod.length };
                let kept = self.strains[point];
                let mut at = |by: f64| {
                    let part = match i {
                        0..3 => &mut self.strains[point].linear,
                        _ => &mut self.strains[point].angular,
                    };
                    part[i % 3] += by;
                    let turn = self.turn(rod, p, cable, &self.strains);
                    self.strains[point] = kept;
                    turn
                };
                *entry = (at(step) - at(-step)) / (2.0 * step);
            }
            let [a, b, c, d, e, f] = gradient;
            self.gradient[point] =
                Twist { linear: Vec3::new(a, b, c), angular: Vec3::new(d, e, f) };
        }
    }

    /// The gradient of the length of a chord.
    fn straight_length(&mut self, rod: &Rod, p: usize) {
        let Self { strains, poses, pulls, gradient, .. } = self;
        let tension = |of: usize| if of == p { 1.0 } else { 0.0 };
        chords::gradient(rod, strains, poses, tension, pulls, gradient);
    }

    /// Directions of a cable on both sides of the near hole of a chord.
    fn directions(&self, rod: &Rod, p: usize, cable: usize) -> [Vec3; 2] {
        let before = match p > rod.first_passages[cable] {
            true => rod.chords[p - 1].direction(&self.poses),
            false => self.poses[0].rotation.rotate(Vec3::Z),
        };
        [before, rod.chords[p].direction(&self.poses)]
    }

    /// The gradient of the angle at the near hole of a chord.
    fn straight_turn(&mut self, rod: &Rod, p: usize, cable: usize) {
        /// An angle so small, in rad, has no direction.
        const STRAIGHT: f64 = 1e-9;
        let [before, after] = self.directions(rod, p, cable);
        let (sin, cos) = (before.cross(after).norm(), before.dot(after));
        if sin < STRAIGHT {
            return;
        }
        let Self { strains, poses, pulls, gradient, .. } = self;
        pulls.fill(Wrench::default());
        let mut add = |of: usize, own: Vec3, other: Vec3| {
            let force = (own * cos - other) * (1.0 / sin);
            rod.chords[of].add_for_direction(poses, force, pulls);
        };
        add(p, after, before);
        if p > rod.first_passages[cable] {
            add(p - 1, before, after);
        }
        pose::work_gradient(rod, strains, poses, |node| pulls[node], gradient);
    }
}

fn angle(a: Vec3, b: Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Length in m of a passage.
pub(crate) fn length(rod: &Rod, p: usize, cable: usize, strains: &[Twist], poses: &[Pose]) -> f64 {
    if rod.has_chords() {
        return rod.chords[p].way(poses).norm();
    }
    let q = p - rod.first_passages[cable];
    rod.points[q].weight * rod.crossings[q * rod.cables.len() + cable].tangent(&strains[q]).norm()
}
