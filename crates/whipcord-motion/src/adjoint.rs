//! The transposed linearisation of one stage, section "Gradients" of the page on motion: from derivatives by what a stage gives to derivatives by
//! what it is made from.

use whipcord::Wrench;
use whipcord_numerics::{DenseLu, Twist, Vec3};

use crate::block::{Block, add, dot, sum};
use crate::cable_work::CableWork;
use crate::conserving::{Conserving, along};
use crate::element::{NODES, POINTS, add_to_nodes};
use crate::hole_rows::HoleRows;
use crate::iteration::{Mechanics, Solver};
use crate::node_loads::{dead_load, inertia_and_weight, load_rates};
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// Corrections of what acts by the poses at most.
pub(crate) const MOST_CORRECTIONS: usize = 60;
/// Change of the multipliers, as a part of them, at which the corrections end.
const SMALL: f64 = 3e-15;
/// A change at which they may end where rounding lets it fall no further.
const SMALL_ENOUGH: f64 = 1e-9;

/// Derivatives by factors on properties of the whole robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Factors {
    /// By a factor on the stiffness of all sections.
    pub stiffness: f64,
    /// By a factor on the damping of all sections.
    pub damping: f64,
    /// By a factor on all masses and moments of inertia, and with them on the weight.
    pub mass: f64,
}

/// Derivatives by what a stage gives, which become those by what it is made from.
#[derive(Clone, Debug)]
pub(crate) struct StageAdjoint {
    /// By the velocities of the nodes; after [`Self::pull_back`] by `V_h`.
    pub velocities: Vec<Twist>,
    /// By the strains; after [`Self::pull_back`] by `ξ_h`.
    pub strains: Vec<Twist>,
    /// After [`Self::pull_back`]: by the strains at the start of the step, from which lengths at its end are extrapolated.
    pub start: Vec<Twist>,
    /// After [`Self::pull_back`]: of each cable by its tension, or by its length where it is driven by that.
    pub cables: Vec<f64>,
    /// By the tension of each cable at the end of the step; after [`Self::pull_back`] by that at its start.
    pub tensions: Vec<f64>,
    /// By the unstretched length beyond the near hole of each passage of cables with friction, at the end of the step; after [`Self::pull_back`] at its start.
    pub beyond: Vec<f64>,
    /// By the tension of each cable at the stage, beside what that does to the motion: of cables that are driven by their lengths.
    pub stage_tensions: Vec<f64>,
    /// By displacements of the base along and about its own axes; after [`Self::pull_back`] with what the equations of the stage depend on it.
    pub base: Twist,
    /// How the pose of a free base changes with its velocity.
    pub base_by_velocity: Option<Block>,
    /// How the pose of a free base at the end changes with its velocity at the stage.
    pub end_by_velocity: Option<Block>,
    /// After [`Self::pull_back`]: by displacements of the base at the start of the step, and at its end but for that by the velocity at the end, of the equations of contacts.
    pub base_ends: [Twist; 2],
    /// After [`Self::pull_back`]: by the velocity at the stage of a base that is led.
    pub led: Twist,
    /// After [`Self::pull_back`]: what the equations of contacts depend on the length of the step by themselves.
    pub by_length: f64,
    /// After [`Self::pull_back`]: by the arc length of the place of each contact.
    pub places: Vec<f64>,
    /// `λ`: multipliers of the equations of motion.
    multipliers: Vec<Twist>,
    /// The multipliers that a length of each cable has, and its gradient by the strains.
    of_lengths: Vec<(Vec<Twist>, Vec<Twist>)>,
    right: Vec<Twist>,
    before: Vec<Twist>,
    /// Derivatives, by the strains, of what acts by the poses (dead loads and straight cables) times the multipliers.
    by_poses: Vec<Twist>,
    /// The same by the strains at the start of the step, where the scheme conserves.
    by_start: Vec<Twist>,
    /// The same by displacements of the base.
    by_base: Twist,
    conserving: Conserving,
    cable_work: CableWork,
    lu: DenseLu,
}

/// The transposed equations were not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotSolved;

/// Linearises the stage that the solver has solved, and factors its matrix.
pub(crate) fn linearise(
    Mechanics { rod, loads }: Mechanics<'_>,
    solver: &mut Solver,
    scheme: &Scheme,
    conserving: &mut Conserving,
) -> Result<(), NotSolved> {
    let Solver { stage, drag, is_linearised, .. } = solver;
    *is_linearised = false;
    if let Some(base) = stage.free_base {
        stage.base = base.pose(stage.velocities[0]);
    }
    pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
    if scheme.conserves {
        stage.find_conserving_forces(rod, loads.gravity, scheme);
        conserving.linearise(rod, stage, scheme, loads.gravity);
    }
    stage.assemble(rod, scheme, loads.gravity, *drag, true);
    stage.matrix.factor().map_err(|_| NotSolved)
}

impl StageAdjoint {
    pub fn new(rod: &Rod) -> Self {
        let list = |n: usize| vec![Twist::default(); n];
        let (nodes, points) = (rod.nodes.len(), rod.points.len());
        Self {
            velocities: list(nodes),
            strains: list(points),
            start: list(points),
            cables: vec![0.0; rod.cables.len()],
            tensions: vec![0.0; rod.cables.len()],
            beyond: Vec::new(),
            stage_tensions: vec![0.0; rod.cables.len()],
            base: Twist::default(),
            base_by_velocity: None,
            end_by_velocity: None,
            base_ends: [Twist::default(); 2],
            led: Twist::default(),
            by_length: 0.0,
            places: Vec::new(),
            multipliers: list(nodes),
            of_lengths: Vec::new(),
            right: list(nodes),
            before: list(nodes),
            by_poses: list(points),
            by_start: list(points),
            by_base: Twist::default(),
            conserving: Conserving::new(rod),
            cable_work: CableWork::new(rod),
            lu: DenseLu::default(),
        }
    }

    /// Derivatives by histories, tensions, lengths and factors from those by velocities and strains, of the stage that the solver has solved. Those
    /// by factors are added.
    pub fn pull_back(
        &mut self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        scheme: &Scheme,
        factors: &mut Factors,
    ) -> Result<(), NotSolved> {
        let Mechanics { rod, loads } = mechanics;
        linearise(mechanics, solver, scheme, &mut self.conserving)?;
        let Solver { stage, lengths, contacts, friction, holds_passages, .. } = solver;
        let touching = contacts.rows(rod, scheme, stage);
        self.start.fill(Twist::default());
        self.by_length = 0.0;
        self.base_ends = [Twist::default(); 2];
        self.led = self.velocities[0];
        self.places.clear();
        self.places.resize(contacts.list.len(), 0.0);
        let mut tensions = Vec::new();
        let holes = friction.as_mut().filter(|_| !*holds_passages);
        let holes = holes.map(|friction| friction.rows(rod, scheme, stage));
        if let Some(rows) = &holes {
            let by_end;
            (by_end, tensions) = rows.by_beyond(&self.beyond);
            for &(cable, p) in &rows.outside {
                tensions[p] += self.stage_tensions[cable];
            }
            self.add_by_end(scheme, &by_end, 1.0);
        }
        let find = |this: &mut Self,
                    out: &mut Vec<Twist>,
                    velocities: &[Twist],
                    strains: &[Twist],
                    base: Twist| {
            this.solve(mechanics, stage, scheme, (velocities, strains, base))?;
            out.clone_from(&this.multipliers);
            Ok(())
        };
        let (velocities, mut strains) =
            (core::mem::take(&mut self.velocities), core::mem::take(&mut self.strains));
        let mut multipliers = Vec::new();
        let by_pose = self.base;
        find(self, &mut multipliers, &velocities, &strains, by_pose)?;
        // Cables that are driven by their lengths and taut, section "Gradients".
        let taut: Vec<usize> =
            lengths.cables.iter().copied().filter(|&i| stage.tensions[i] > 0.0).collect();
        // Then contacts that push, then the passages of cables with friction.
        let first_passage = taut.len() + touching.unknowns();
        let n = first_passage + holes.as_ref().map_or(0, HoleRows::count);
        let mut forces = vec![0.0; n];
        let ends = core::mem::replace(&mut self.tensions, vec![0.0; rod.cables.len()]);
        if n > 0 {
            self.of_lengths.resize(n, Default::default());
            let none = vec![Twist::default(); rod.nodes.len()];
            let mut of_lengths = core::mem::take(&mut self.of_lengths);
            let (of_taut, others) = of_lengths.split_at_mut(taut.len());
            let (of_touching, of_holes) = others.split_at_mut(touching.unknowns());
            for (&cable, (of_length, gradient)) in taut.iter().zip(of_taut) {
                self.cable_work.length_gradient(rod, stage, scheme, cable, gradient);
                // Lengths are the same wherever the base is.
                find(self, of_length, &none, gradient, Twist::default())?;
            }
            for (row, (of_row, gradient)) in touching.rows.iter().zip(of_touching) {
                gradient.clone_from(&row.stage);
                let mut by_velocity = none.clone();
                if let Some(of) = &self.end_by_velocity {
                    by_velocity[0] = of.apply_transposed(&row.bases[2]);
                }
                find(self, of_row, &by_velocity, gradient, row.bases[1])?;
            }
            for (r, (of_row, gradient)) in of_holes.iter_mut().enumerate() {
                let Some(rows) = &holes else { break };
                *gradient = rows.gradient(r);
                gradient.iter_mut().for_each(|of| *of = *of * (1.0 / scheme.place));
                find(self, of_row, &none, gradient, Twist::default())?;
            }
            let mut matrix = vec![0.0; n * n];
            for (j, &cable) in taut.iter().enumerate() {
                for (i, (of_length, _)) in of_lengths.iter().enumerate() {
                    matrix[j * n + i] =
                        self.cable_work.tension_work(rod, stage, scheme, cable, of_length);
                }
                matrix[j * n + j] += rod.cables[cable].compliance / scheme.place;
                // The tension at the end lies straight beyond that of the stage, unless it would be negative.
                self.tensions[cable] = if lengths.end_tension_of(cable, stage, scheme) > 0.0 {
                    ends[cable]
                } else {
                    0.0
                };
                forces[j] = self.cable_work.tension_work(rod, stage, scheme, cable, &multipliers)
                    - self.tensions[cable] / scheme.place
                    - self.stage_tensions[cable];
            }
            for push in &touching.pushes {
                let j = taut.len() + push.unknown;
                for (i, (of_row, _)) in of_lengths.iter().enumerate() {
                    matrix[j * n + i] = push.work(of_row);
                }
                forces[j] = push.work(&multipliers);
            }
            for (row, i) in touching.rows.iter().zip(taut.len()..) {
                for (j, by) in &row.unknowns {
                    matrix[(taut.len() + j) * n + i] -= by;
                }
            }
            if let Some(rows) = &holes {
                // By columns: its transpose is what is solved with.
                for (i, (of_row, _)) in of_lengths.iter().enumerate() {
                    for (p, work) in rows.tension_work(rod, stage, of_row).iter().enumerate() {
                        matrix[(first_passage + p) * n + i] += work;
                    }
                }
                for (r, equation) in rows.equations.iter().enumerate() {
                    for &(p, factor) in &equation.tensions {
                        matrix[(first_passage + p) * n + first_passage + r] -= factor;
                    }
                }
                let works = rows.tension_work(rod, stage, &multipliers);
                for ((force, work), by) in
                    forces[first_passage..].iter_mut().zip(works).zip(&tensions)
                {
                    *force = work - by;
                }
            }
            // Motors with inertia yield to the tensions of their cables.
            let drives = &lengths.drives;
            let yields = |i: usize, j: usize, by: f64| matrix[j * n + i] += by;
            drives.add_lengths(scheme, &taut, &stage.tensions, |_, _| (), yields);
            self.lu.factor(n, &matrix).map_err(|_| NotSolved)?;
            self.lu.solve(&mut forces);
            for (&cable, force) in taut.iter().zip(&forces) {
                let by_end = self.tensions[cable] + rod.cables[cable].compliance * force;
                self.tensions[cable] = by_end * (1.0 - 1.0 / scheme.place);
            }
            for (k, (force, (of_length, gradient))) in forces.iter().zip(&of_lengths).enumerate() {
                add(&mut multipliers, of_length, -force);
                add(&mut strains, gradient, -force);
                match k.checked_sub(taut.len()).and_then(|k| touching.rows.get(k)) {
                    Some(row) => {
                        add(&mut self.start, &row.start, -force);
                        self.by_length -= force * row.by_length;
                        self.places[row.contact] -= force * row.by_place;
                        let [start, stage, end] = row.bases;
                        self.base = self.base - stage * *force;
                        self.base_ends[0] = self.base_ends[0] - start * *force;
                        self.base_ends[1] = self.base_ends[1] - end * *force;
                    }
                    // Where the stage is not at the end, the end lies beyond it, away from the start.
                    None => add(&mut self.start, gradient, -force * (scheme.place - 1.0)),
                }
            }
            self.of_lengths = of_lengths;
        }
        if let Some(rows) = &holes {
            self.cables.fill(0.0);
            self.beyond.clear();
            let equations = rows.equations.iter().zip(&rows.cables).zip(&forces[first_passage..]);
            for ((equation, cable), worth) in equations {
                self.cables[*cable] += equation.by_command * worth;
                self.beyond.push(equation.by_before * worth);
            }
        }
        for (i, out) in self.cables.iter_mut().enumerate().filter(|_| holes.is_none()) {
            *out = if lengths.cables.contains(&i) {
                taut.iter().position(|&of| of == i).map_or(0.0, |k| forces[k])
            } else {
                -self.cable_work.tension_work(rod, stage, scheme, i, &multipliers)
            };
        }
        for shift in &touching.shifts {
            self.places[shift.contact] -= shift.work(&multipliers);
        }
        self.multipliers.copy_from_slice(&multipliers);
        self.find_by_poses(mechanics, stage, scheme);
        self.base = self.base - self.by_base;
        if scheme.conserves {
            self.add_by_start(rod, stage, scheme);
            let CableWork { along: of_points, .. } = &mut self.cable_work;
            along(rod, &stage.strains, &self.multipliers, of_points);
            let weight = Conserving::alone(rod, stage, scheme, loads.gravity, None);
            factors.mass -= weight.iter().zip(of_points).map(|(a, b)| dot(a, b)).sum::<f64>();
        }
        self.histories(mechanics, stage, scheme, strains, factors);
        self.velocities = multipliers;
        for (velocity, node) in self.velocities.iter_mut().zip(&rod.nodes) {
            velocity.linear *= node.mass * scheme.inertia;
            velocity.angular = node.inertia.scale(velocity.angular) * scheme.inertia;
        }
        Ok(())
    }

    /// The derivative by the time at which loads act on the stage that was pulled back last.
    pub fn load_rate(
        &self,
        mechanics: Mechanics<'_>,
        solver: &mut Solver,
        scheme: &Scheme,
        time: f64,
    ) -> f64 {
        let rates = load_rates(mechanics, &mut solver.stage, scheme, time);
        rates.map_or(0.0, |rates| -sum(&rates, &self.multipliers))
    }

    /// Adds derivatives by the strains at the end of the step, times a factor, to those by the strains of the stage and at the start.
    fn add_by_end(&mut self, scheme: &Scheme, by_end: &[Twist], factor: f64) {
        let by_stage = factor / scheme.place;
        add(&mut self.strains, by_end, by_stage);
        add(&mut self.start, by_end, factor - by_stage);
    }

    /// Multipliers for derivatives by velocities and strains.
    fn solve(
        &mut self,
        mechanics: Mechanics<'_>,
        stage: &Stage,
        scheme: &Scheme,
        (velocities, strains, base): (&[Twist], &[Twist], Twist),
    ) -> Result<(), NotSolved> {
        let rod = mechanics.rod;
        self.right.copy_from_slice(velocities);
        if let Some(by_velocity) = &self.base_by_velocity {
            self.right[0] = self.right[0] + by_velocity.apply_transposed(&base);
        }
        add_transposed_changes(rod, stage, strains, &mut self.right);
        self.multipliers.copy_from_slice(&self.right);
        stage.matrix.solve_transposed(&mut self.multipliers);
        if !(mechanics.loads.any_dead || rod.has_chords()) {
            return Ok(());
        }
        // The matrix turns dead loads and moves straight cables by the velocities of their nodes; what truly moves them is a matter of all strains below.
        let mut last = f64::INFINITY;
        for _ in 0..MOST_CORRECTIONS {
            self.before.copy_from_slice(&self.multipliers);
            self.find_by_poses(mechanics, stage, scheme);
            for by in &mut self.by_poses {
                *by = *by * -1.0;
            }
            self.multipliers.copy_from_slice(&self.right);
            if mechanics.loads.any_dead {
                for a in mechanics.loads.first_free()..rod.nodes.len() {
                    let moment = dead_moment(mechanics, stage, a, &self.before[a], true);
                    self.multipliers[a].angular += moment * scheme.g;
                }
            }
            if let Some(by_velocity) = &self.base_by_velocity {
                let of_base = by_velocity.apply_transposed(&self.by_base);
                self.multipliers[0] = self.multipliers[0] - of_base;
            }
            stage.matrix.add_links_transposed(&self.before, &mut self.multipliers);
            add_transposed_changes(rod, stage, &self.by_poses, &mut self.multipliers);
            stage.matrix.solve_transposed(&mut self.multipliers);
            if is_settled(&self.multipliers, &self.before, &mut last)? {
                return Ok(());
            }
        }
        Err(NotSolved)
    }

    /// What dead loads and straight cables, which act by the poses, add to the derivatives by the strains, for the multipliers as they are.
    fn find_by_poses(&mut self, mechanics: Mechanics<'_>, stage: &Stage, scheme: &Scheme) {
        let Mechanics { rod, loads } = mechanics;
        let Self { multipliers, by_poses, by_start, by_base, cable_work, conserving, .. } = self;
        by_poses.fill(Twist::default());
        by_start.fill(Twist::default());
        *by_base = Twist::default();
        if loads.any_dead {
            let moment = |a: usize| {
                let moment = if a < loads.first_free() {
                    Default::default()
                } else {
                    // Where the scheme conserves, forces act by the gradient of their heights.
                    dead_moment(mechanics, stage, a, &multipliers[a], !stage.by_heights(scheme))
                };
                Wrench { force: Default::default(), moment: stage.poses[a].rotation.rotate(moment) }
            };
            pose::work_gradient(rod, &stage.strains, &stage.poses, moment, by_poses);
            let sum = (0..rod.nodes.len()).fold(Vec3::ZERO, |sum, a| sum + moment(a).moment);
            by_base.angular = stage.poses[0].rotation.conjugate().rotate(sum);
        }
        if scheme.conserves {
            cable_work.add_by_turning(rod, stage, &stage.potential, multipliers, by_poses);
            let sides = (by_poses.as_mut_slice(), by_start.as_mut_slice());
            conserving.add_transposed(rod, stage, scheme, loads.gravity, &cable_work.along, sides);
        } else if rod.has_chords() {
            cable_work.add_by_strains(rod, stage, multipliers, by_poses);
        }
    }

    /// Takes from the derivatives by the strains at the start of the step what the equations of a scheme that conserves depend on them.
    fn add_by_start(&mut self, rod: &Rod, stage: &Stage, scheme: &Scheme) {
        let Self {
            start, by_start, multipliers, cable_work: CableWork { along: room, .. }, ..
        } = self;
        for (start, by) in start.iter_mut().zip(by_start) {
            *start = *start - *by;
        }
        if rod.has_chords() {
            return;
        }
        along(rod, &stage.strains, multipliers, room);
        for (i, line) in rod.cables.iter().enumerate() {
            for q in 0..POINTS * line.elements {
                let crossing = &rod.crossings[q * rod.cables.len() + i];
                let pull = Pull::new(crossing, &stage.strains[q], &stage.start[q], scheme);
                let by = pull.transposed_start_change(crossing, &room[q]);
                start[q] = start[q] - by * (stage.tensions[i] * rod.points[q].weight);
            }
        }
    }

    /// Derivatives by the strain histories, into [`Self::strains`], and by the factors.
    fn histories(
        &mut self,
        mechanics: Mechanics<'_>,
        stage: &Stage,
        scheme: &Scheme,
        mut strains: Vec<Twist>,
        factors: &mut Factors,
    ) {
        let Mechanics { rod, loads } = mechanics;
        for e in 0..rod.elements() {
            for k in 0..POINTS {
                let q = POINTS * e + k;
                let (point, tangent) = (&rod.points[q], &stage.tangents[q]);
                let (value, slope) = Stage::at_point(&self.multipliers, e, k, rod.lengths[e]);
                let strain = stage.strains[q];
                let of_wrench = slope + strain.bracket(value);
                let (along, across) = tangent.transposed_wrench_change(&slope, &value);
                let rest = strains[q] - (along + across) * point.weight - self.by_poses[q];
                let (transported, across) = tangent.transposed_strain_change(&rest);
                if e == 0 {
                    let mut of_element = [Twist::default(); NODES];
                    let length = rod.lengths[0];
                    add_to_nodes(&mut of_element, &transported, &across, 1.0, k, length);
                    self.led = self.led + of_element[0];
                }
                let damped = point.damping.apply(&of_wrench) * (point.weight * scheme.damping);
                strains[q] = transported * (1.0 / scheme.g) + damped;
                let elastic = point.stiffness.apply(&(strain - point.rest));
                factors.stiffness -= point.weight * dot(&elastic, &of_wrench);
                let change = strain - stage.strain_history[q];
                factors.damping -= dot(&damped, &change);
            }
        }
        self.strains = strains;
        for a in loads.first_free()..rod.nodes.len() {
            let of_mass = inertia_and_weight(mechanics, stage, scheme, a);
            factors.mass -= dot(&of_mass, &self.multipliers[a]);
        }
    }
}

/// `R_aᵀF × λ + R_aᵀM × μ`: what turns with the node, times the multipliers of its equations.
fn dead_moment(
    mechanics: Mechanics<'_>,
    stage: &Stage,
    a: usize,
    multiplier: &Twist,
    with_force: bool,
) -> Vec3 {
    let load = dead_load(mechanics, stage, a, with_force);
    load.linear.cross(multiplier.linear) + load.angular.cross(multiplier.angular)
}

/// Whether corrections of what acts by the poses need not go on; `last` is their last change.
pub(crate) fn is_settled(
    now: &[Twist],
    before: &[Twist],
    last: &mut f64,
) -> Result<bool, NotSolved> {
    let (mut change, mut size) = (0.0, 0.0);
    for (now, before) in now.iter().zip(before) {
        let apart = *now - *before;
        change += dot(&apart, &apart);
        size += dot(now, now);
    }
    let change: f64 = (change / f64::max(size, f64::MIN_POSITIVE)).sqrt();
    if !change.is_finite() {
        return Err(NotSolved);
    }
    let is_small = change < SMALL || (change < SMALL_ENOUGH && change > 0.5 * *last);
    *last = change;
    Ok(is_small)
}

/// Adds to the derivatives by the velocities what those by the strains are through eq. (10).
fn add_transposed_changes(rod: &Rod, stage: &Stage, strains: &[Twist], out: &mut [Twist]) {
    for e in 0..rod.elements() {
        for k in 0..POINTS {
            let q = POINTS * e + k;
            let (slope, value) = stage.tangents[q].transposed_strain_change(&strains[q]);
            add_to_nodes(&mut out[2 * e..], &slope, &value, 1.0, k, rod.lengths[e]);
        }
    }
}
