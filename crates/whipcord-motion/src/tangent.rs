//! The linearisation of one stage, section "Gradients" of the page on motion: from changes of what a stage is made from to changes of what it gives. The transpose of
//! [`crate::adjoint`].

use whipcord_numerics::{DenseLu, Twist, Vec3};

use crate::adjoint::{Factors, MOST_CORRECTIONS, NotSolved, is_settled, linearise};
use crate::block::{Block, add, dot, sum, transposed_bracket};
use crate::cable_work::CableWork;
use crate::conserving::Conserving;
use crate::contact_rows::ContactRow;
use crate::element::{POINTS, add_to_nodes};
use crate::hole_rows::HoleRows;
use crate::iteration::{Mechanics, Solver};
use crate::node_loads::{add_forces, dead_load, inertia_and_weight, load_rates};
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// Changes of what a stage is made from, which become those of what it gives.
#[derive(Clone, Debug)]
pub(crate) struct StageTangent {
    /// Of `V_h`; after [`Self::push_forward`] of the velocities.
    pub velocities: Vec<Twist>,
    /// Of `ξ_h`; after [`Self::push_forward`] of the strains.
    pub strains: Vec<Twist>,
    /// Of the strains at the start of the step.
    pub start: Vec<Twist>,
    /// Of each cable: of its tension, or of its length where it is driven by that.
    pub cables: Vec<f64>,
    /// Of the tension of each cable at the start of the step; after [`Self::push_forward`] at its end, for those that are driven by their lengths.
    pub tensions: Vec<f64>,
    /// Of the unstretched length beyond the near hole of each passage of cables with friction, at the start of the step; after [`Self::push_forward`] at its end.
    pub beyond: Vec<f64>,
    /// After [`Self::push_forward`]: of the tension of each cable at the stage.
    pub stage_tensions: Vec<f64>,
    /// Displacement of the base along and about its own axes, but for that by the velocity of the stage.
    pub base: Twist,
    /// How the pose of a free base changes with its velocity.
    pub base_by_velocity: Option<Block>,
    /// Displacements of the base at the start of the step, and at its end but for that by the velocity at the end.
    pub base_ends: [Twist; 2],
    /// How the pose of a free base at the end changes with its velocity at the stage.
    pub end_by_velocity: Option<Block>,
    /// Of the velocity at the stage of a base that is led.
    pub led: Twist,
    /// Time in s at which loads act on the stage, and how much later that is.
    pub time: [f64; 2],
    /// Of the length of the step.
    pub length: f64,
    /// Of the arc length of the place of each contact.
    pub places: Vec<f64>,
    /// What the equations of motion lack where the velocities do not change.
    right: Vec<Twist>,
    /// What the strains change by where the velocities do not.
    history: Vec<Twist>,
    potential: Vec<Twist>,
    before: Vec<Twist>,
    conserving: Conserving,
    cable_work: CableWork,
    lu: DenseLu,
}

/// A change of velocities and strains.
type Found = (Vec<Twist>, Vec<Twist>);

impl StageTangent {
    pub fn new(rod: &Rod) -> Self {
        let list = |n: usize| vec![Twist::default(); n];
        let (nodes, points, cables) = (rod.nodes.len(), rod.points.len(), rod.cables.len());
        Self {
            velocities: list(nodes),
            strains: list(points),
            start: list(points),
            cables: vec![0.0; cables],
            tensions: vec![0.0; cables],
            beyond: Vec::new(),
            stage_tensions: vec![0.0; cables],
            base: Twist::default(),
            base_by_velocity: None,
            base_ends: [Twist::default(); 2],
            end_by_velocity: None,
            led: Twist::default(),
            time: [0.0; 2],
            length: 0.0,
            places: Vec::new(),
            right: list(nodes),
            history: list(points),
            potential: list(points),
            before: list(nodes),
            conserving: Conserving::new(rod),
            cable_work: CableWork::new(rod),
            lu: DenseLu::default(),
        }
    }

    /// Changes of velocities, strains and tensions for those of histories, tensions, lengths and factors, of the stage that the solver has solved.
    pub fn push_forward(
        &mut self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        scheme: &Scheme,
        factors: &Factors,
    ) -> Result<(), NotSolved> {
        let rod = mechanics.rod;
        linearise(mechanics, solver, scheme, &mut self.conserving)?;
        let Solver { stage, lengths, contacts, friction, holds_passages, .. } = solver;
        self.gather(mechanics, stage, scheme, factors);
        if friction.is_some() && *holds_passages {
            let start = self.start.clone();
            (self.velocities, self.strains) = self.solve(mechanics, stage, scheme, &start)?;
            return Ok(());
        }
        let holes = friction.as_mut().map(|friction| friction.rows(rod, scheme, stage));
        for i in 0..rod.cables.len() {
            let is_by_length = lengths.cables.contains(&i);
            self.stage_tensions[i] = if is_by_length { 0.0 } else { self.cables[i] };
            if !is_by_length && holes.is_none() && self.cables[i] != 0.0 {
                self.add_pull(rod, stage, scheme, i, self.cables[i]);
            }
        }
        let touching = contacts.rows(rod, scheme, stage);
        for shift in &touching.shifts {
            let moved = self.place(shift.contact);
            shift.add(&mut self.right, moved);
        }
        let start = self.start.clone();
        let bases = [self.base_ends[0], self.base, self.base_ends[1]];
        let (mut velocities, mut strains) = self.solve(mechanics, stage, scheme, &start)?;
        // Cables that are driven by their lengths and taut: each has a tension that keeps its length.
        let taut: Vec<usize> =
            lengths.cables.iter().copied().filter(|&i| stage.tensions[i] > 0.0).collect();
        let first_passage = taut.len() + touching.unknowns();
        let n = first_passage + holes.as_ref().map_or(0, HoleRows::count);
        let (mut responses, mut gradients) = (Vec::<Found>::new(), Vec::new());
        for &cable in &taut {
            self.right.fill(Twist::default());
            self.history.fill(Twist::default());
            self.base = Twist::default();
            self.add_pull(rod, stage, scheme, cable, 1.0);
            let still = vec![Twist::default(); rod.points.len()];
            responses.push(self.solve(mechanics, stage, scheme, &still)?);
            let mut gradient = Vec::new();
            self.cable_work.length_gradient(rod, stage, scheme, cable, &mut gradient);
            gradients.push(gradient);
        }
        // The unknown of each response: tensions, then pushes of contacts, then the tensions of passages.
        let mut unknowns: Vec<usize> = (0..taut.len()).collect();
        for push in &touching.pushes {
            self.right.fill(Twist::default());
            self.history.fill(Twist::default());
            self.base = Twist::default();
            push.add(&mut self.right);
            let still = vec![Twist::default(); rod.points.len()];
            responses.push(self.solve(mechanics, stage, scheme, &still)?);
            unknowns.push(taut.len() + push.unknown);
        }
        for (p, pull) in holes.iter().flat_map(|rows| rows.pulls.iter().enumerate()) {
            self.right.fill(Twist::default());
            self.history.fill(Twist::default());
            self.base = Twist::default();
            self.add_forces(rod, stage, pull, 1.0);
            let still = vec![Twist::default(); rod.points.len()];
            responses.push(self.solve(mechanics, stage, scheme, &still)?);
            unknowns.push(first_passage + p);
        }
        let mut matrix = vec![0.0; n * n];
        let mut changes = vec![0.0; n];
        for (i, (&cable, gradient)) in taut.iter().zip(&gradients).enumerate() {
            let along = |strains: &[Twist]| sum(gradient, strains);
            let compliance = rod.cables[cable].compliance;
            // Straight through start and stage to the end.
            let carried = compliance * self.tensions[cable] * (1.0 - 1.0 / scheme.place);
            changes[i] = along(&strains) + along(&start) * (scheme.place - 1.0)
                - self.cables[cable]
                - carried;
            for (j, (_, response)) in unknowns.iter().zip(&responses) {
                matrix[i * n + j] = -along(response);
            }
            matrix[i * n + i] += compliance / scheme.place;
        }
        for (row, i) in touching.rows.iter().zip(taut.len()..) {
            changes[i] = row.by_stage(&strains)
                + row.by_start(&start)
                + row.by_length * self.length
                + row.by_place * self.place(row.contact)
                + row.by_bases(&bases)
                + self.by_base_velocity(row, &velocities);
            for (j, by) in &row.unknowns {
                matrix[i * n + taut.len() + j] -= by;
            }
            for (j, response) in unknowns.iter().zip(&responses) {
                matrix[i * n + j] -= row.by_stage(&response.1);
                matrix[i * n + j] -= self.by_base_velocity(row, &response.0);
            }
        }
        let ends = |start: &[Twist], strains: &[Twist]| -> Vec<Twist> {
            start.iter().zip(strains).map(|(start, strain)| scheme.end(*start, *strain)).collect()
        };
        if let Some(rows) = &holes {
            let still = vec![Twist::default(); rod.points.len()];
            let free = ends(&start, &strains);
            let ends: Vec<Vec<Twist>> = responses.iter().map(|(_, of)| ends(&still, of)).collect();
            for (r, equation) in rows.equations.iter().enumerate() {
                let i = first_passage + r;
                for (j, end) in unknowns.iter().zip(&ends) {
                    matrix[i * n + j] -= rows.by_strains(r, end);
                }
                for &(p, factor) in &equation.tensions {
                    matrix[i * n + first_passage + p] -= factor;
                }
                let before = self.beyond.get(r).copied().unwrap_or_default();
                let command = self.cables[rows.cables[r]];
                changes[i] = rows.by_strains(r, &free)
                    - equation.by_before * before
                    - equation.by_command * command;
            }
        }
        let yields = |i: usize, j: usize, by: f64| matrix[i * n + j] += by;
        lengths.drives.add_lengths(scheme, &taut, &stage.tensions, |_, _| (), yields);
        if n > 0 {
            self.lu.factor(n, &matrix).map_err(|_| NotSolved)?;
            self.lu.solve(&mut changes);
        }
        for &cable in &lengths.cables {
            let change = taut.iter().position(|of| *of == cable).map_or(0.0, |k| changes[k]);
            self.stage_tensions[cable] = change;
            let before = self.tensions[cable];
            self.tensions[cable] = if lengths.end_tension_of(cable, stage, scheme) > 0.0 {
                before + (change - before) / scheme.place
            } else {
                0.0
            };
        }
        let of_responses: Vec<f64> = unknowns.iter().map(|j| changes[*j]).collect();
        add_responses(&mut velocities, &mut strains, &responses, &of_responses);
        if let Some(rows) = &holes {
            self.stage_tensions.fill(0.0);
            for &(cable, p) in &rows.outside {
                self.stage_tensions[cable] = changes[first_passage + p];
            }
            self.beyond = rows.beyond_changes(&ends(&start, &strains), &changes[first_passage..]);
        }
        (self.velocities, self.strains) = (velocities, strains);
        Ok(())
    }

    /// What an equation of contacts has for the velocity of a free base, which moves its pose at the stage and at the end.
    fn by_base_velocity(&self, row: &ContactRow, velocities: &[Twist]) -> f64 {
        let [_, stage, end] = &row.bases;
        let of = |by: &Option<Block>, on: &Twist| {
            by.as_ref().map_or(0.0, |by| dot(on, &by.apply(&velocities[0])))
        };
        of(&self.base_by_velocity, stage) + of(&self.end_by_velocity, end)
    }

    fn place(&self, contact: usize) -> f64 {
        self.places.get(contact).copied().unwrap_or_default()
    }

    /// What the equations lack for the changes of histories and factors, and what these do to the strains.
    fn gather(
        &mut self,
        mechanics: Mechanics<'_>,
        stage: &mut Stage,
        scheme: &Scheme,
        factors: &Factors,
    ) {
        let Mechanics { rod, loads } = mechanics;
        let led = [self.led, Twist::default(), Twist::default()];
        let Self { right, history, .. } = self;
        right.fill(Twist::default());
        for q in 0..rod.points.len() {
            let (e, k) = (q / POINTS, q % POINTS);
            let (point, tangent) = (&rod.points[q], &stage.tangents[q]);
            let strain = stage.strains[q];
            history[q] = tangent.transport(&self.strains[q]) * (1.0 / scheme.g);
            if e == 0 && self.led != Twist::default() {
                let (value, slope) = Stage::at_point(&led, 0, k, rod.lengths[0]);
                history[q] = history[q] + tangent.strain_change(slope, value);
            }
            let elastic = point.stiffness.apply(&(strain - point.rest));
            let damping = |of: Twist| point.damping.apply(&of) * scheme.damping;
            let wrench = elastic * factors.stiffness
                + damping(strain - stage.strain_history[q]) * factors.damping
                - damping(self.strains[q]);
            let across = transposed_bracket(&strain, &wrench);
            add_to_nodes(&mut right[2 * e..], &wrench, &across, point.weight, k, rod.lengths[e]);
        }
        for a in loads.first_free()..rod.nodes.len() {
            let (node, change) = (&rod.nodes[a], self.velocities[a] * scheme.inertia);
            right[a].linear -= change.linear * node.mass;
            right[a].angular -= node.inertia.scale(change.angular);
            let of_mass = inertia_and_weight(mechanics, stage, scheme, a);
            right[a] = right[a] + of_mass * factors.mass;
        }
        let [time, later] = self.time;
        if later != 0.0
            && let Some(rates) = load_rates(mechanics, stage, scheme, time)
        {
            add(&mut self.right, &rates, later);
        }
        if scheme.conserves {
            if factors.mass != 0.0 {
                let weight = Conserving::alone(rod, stage, scheme, loads.gravity, None);
                self.add_forces(rod, stage, &weight, factors.mass);
            }
            self.add_start(rod, stage, scheme);
        }
    }

    /// What the pulls of continuous cables change by with the strains at the start, where the scheme conserves.
    fn add_start(&mut self, rod: &Rod, stage: &Stage, scheme: &Scheme) {
        if rod.has_chords() {
            return;
        }
        self.potential.fill(Twist::default());
        for (i, line) in rod.cables.iter().enumerate() {
            for q in 0..POINTS * line.elements {
                let crossing = &rod.crossings[q * rod.cables.len() + i];
                let pull = Pull::new(crossing, &stage.strains[q], &stage.start[q], scheme);
                let change = pull.start_change(crossing, &self.start[q]);
                let weight = stage.tensions[i] * rod.points[q].weight;
                self.potential[q] = self.potential[q] + change * weight;
            }
        }
        let forces = self.potential.clone();
        self.add_forces(rod, stage, &forces, 1.0);
    }

    /// Adds forces on the strains, times the weights of the points and a factor.
    fn add_forces(&mut self, rod: &Rod, stage: &Stage, forces: &[Twist], factor: f64) {
        add_forces(rod, stage, forces, factor, &mut self.right);
    }

    /// Adds what a change of the tension of a cable exerts.
    fn add_pull(&mut self, rod: &Rod, stage: &mut Stage, scheme: &Scheme, cable: usize, by: f64) {
        let forces = self.cable_work.find_unit_pull(rod, stage, scheme, cable).to_vec();
        self.add_forces(rod, stage, &forces, by);
    }

    /// Changes of velocities and strains for what the equations lack at hand.
    fn solve(
        &mut self,
        mechanics: Mechanics<'_>,
        stage: &Stage,
        scheme: &Scheme,
        start: &[Twist],
    ) -> Result<Found, NotSolved> {
        let rod = mechanics.rod;
        // What the strains change by at once acts by the stiffness of the sections.
        let mut right = self.right.clone();
        for (q, change) in self.history.iter().enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            let (along, across) = stage.tangents[q].wrench_change(change);
            let weight = rod.points[q].weight;
            add_to_nodes(&mut right[2 * e..], &along, &across, weight, k, rod.lengths[e]);
        }
        let mut velocities: Vec<Twist> = right.iter().map(|of| *of * -1.0).collect();
        stage.matrix.solve(&mut velocities);
        let mut strains = self.strain_changes(rod, stage, &velocities);
        if !(mechanics.loads.any_dead || rod.has_chords()) {
            return Ok((velocities, strains));
        }
        // As in the transposed equations, the matrix has the poses by the velocities of their nodes alone.
        let mut last = f64::INFINITY;
        for _ in 0..MOST_CORRECTIONS {
            self.before.copy_from_slice(&velocities);
            velocities.copy_from_slice(&right);
            self.add_by_poses(mechanics, (stage, scheme), (&strains, start), &mut velocities);
            self.take_approximation(mechanics, stage, scheme, &mut velocities);
            for out in &mut velocities {
                *out = *out * -1.0;
            }
            stage.matrix.solve(&mut velocities);
            strains = self.strain_changes(rod, stage, &velocities);
            if is_settled(&velocities, &self.before, &mut last)? {
                return Ok((velocities, strains));
            }
        }
        Err(NotSolved)
    }

    /// Eq. (10) with what the histories add.
    fn strain_changes(&self, rod: &Rod, stage: &Stage, velocities: &[Twist]) -> Vec<Twist> {
        let of_point = |(q, history): (usize, &Twist)| {
            let (e, k) = (q / POINTS, q % POINTS);
            let (value, slope) = Stage::at_point(velocities, e, k, rod.lengths[e]);
            *history + stage.tangents[q].strain_change(slope, value)
        };
        self.history.iter().enumerate().map(of_point).collect()
    }

    /// Adds what dead loads and straight cables, which act by the poses, change by; the velocities are those at hand.
    fn add_by_poses(
        &mut self,
        mechanics: Mechanics<'_>,
        (stage, scheme): (&Stage, &Scheme),
        (strains, start): (&[Twist], &[Twist]),
        out: &mut [Twist],
    ) {
        let Mechanics { rod, loads } = mechanics;
        let Self { before, potential, conserving, cable_work, base_by_velocity, .. } = self;
        if loads.any_dead {
            let by_velocity = base_by_velocity.map(|of| of.apply(&before[0])).unwrap_or_default();
            let changes = (self.base + by_velocity, strains);
            pose::exact_displacements(rod, &stage.strains, &stage.poses, changes, |a, turn, _| {
                if a >= loads.first_free() {
                    let back = stage.poses[a].rotation.conjugate();
                    // Where the scheme conserves, forces act by the gradient of their heights.
                    let load = dead_load(mechanics, stage, a, !stage.by_heights(scheme));
                    out[a] = out[a] - turned(&load, back.rotate(turn));
                }
            });
        }
        if !(scheme.conserves || rod.has_chords()) {
            return;
        }
        potential.fill(Twist::default());
        if scheme.conserves {
            let sides = (strains, start);
            conserving.add(rod, stage, scheme, loads.gravity, sides, potential);
        } else {
            let tension = |k: usize| stage.chord_tension(rod, k);
            let none = |_| Vec3::ZERO;
            let curvature = &mut cable_work.curvature;
            curvature.add(rod, (stage.base, &stage.strains), strains, tension, none, potential);
        }
        for (q, change) in potential.iter().enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            let across = transposed_bracket(&stage.strains[q], change)
                + transposed_bracket(&strains[q], &stage.potential[q]);
            add_to_nodes(&mut out[2 * e..], change, &across, 1.0, k, rod.lengths[e]);
        }
    }

    /// Takes away what the matrix has in place of [`Self::add_by_poses`], for the velocities at hand.
    fn take_approximation(
        &self,
        mechanics: Mechanics<'_>,
        stage: &Stage,
        scheme: &Scheme,
        out: &mut [Twist],
    ) {
        let Mechanics { rod, loads } = mechanics;
        if loads.any_dead {
            for a in loads.first_free()..rod.nodes.len() {
                let load = dead_load(mechanics, stage, a, true);
                out[a] = out[a] + turned(&load, self.before[a].angular * scheme.g);
            }
        }
        stage.matrix.take_links(&self.before, out);
    }
}

/// Adds to velocities and strains what tensions do that change so.
fn add_responses(
    velocities: &mut [Twist],
    strains: &mut [Twist],
    responses: &[Found],
    changes: &[f64],
) {
    for ((of_velocities, of_strains), change) in responses.iter().zip(changes) {
        add(velocities, of_velocities, *change);
        add(strains, of_strains, *change);
    }
}

/// How dead force and moment change in the frame of a section that turns.
fn turned(load: &Twist, turn: Vec3) -> Twist {
    Twist { linear: load.linear.cross(turn), angular: load.angular.cross(turn) }
}
