//! The transposed linearisation of one stage, section "Gradients" of the page on motion: from derivatives by what a stage gives to derivatives by
//! what it is made from.

use whipcord::Wrench;
use whipcord_numerics::{DenseLu, Pose, Twist};

use crate::block::{dot, transposed_bracket};
use crate::chords::{self, Curvature};
use crate::element::{POINTS, add_to_nodes};
use crate::iteration::{Mechanics, Solver};
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// Corrections of what acts by the poses at most.
const MOST_CORRECTIONS: usize = 60;
/// Change of the multipliers, as a part of them, at which the corrections end.
const SMALL: f64 = 1e-13;
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
    /// `λ`: multipliers of the equations of motion.
    multipliers: Vec<Twist>,
    /// The multipliers that a length of each cable has, and its gradient by the strains.
    of_lengths: Vec<(Vec<Twist>, Vec<Twist>)>,
    right: Vec<Twist>,
    before: Vec<Twist>,
    /// Derivatives, by the strains, of what acts by the poses (dead loads and straight cables) times the multipliers.
    by_poses: Vec<Twist>,
    straight: Straight,
    lu: DenseLu,
}

/// Room for the pulls of straight cables.
#[derive(Clone, Debug)]
struct Straight {
    curvature: Curvature,
    /// What the multipliers are for the strains, `λ′ + ad_ξ λ`.
    along: Vec<Twist>,
    gradient: Vec<Twist>,
    pulls: Vec<Wrench>,
    strains: Vec<Twist>,
    poses: Vec<Pose>,
}

/// The transposed equations were not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotSolved;

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
            multipliers: list(nodes),
            of_lengths: Vec::new(),
            right: list(nodes),
            before: list(nodes),
            by_poses: list(points),
            straight: Straight {
                curvature: Curvature::new(rod),
                along: list(points),
                gradient: list(points),
                pulls: vec![Wrench::default(); nodes],
                strains: list(points),
                poses: vec![Pose::IDENTITY; nodes],
            },
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
        let Solver { stage, lengths, drag, is_linearised, .. } = solver;
        *is_linearised = false;
        pose::nodes(rod, stage.base, &stage.strains, &mut stage.poses);
        stage.assemble(rod, scheme, loads.gravity, *drag, true);
        stage.matrix.factor().map_err(|_| NotSolved)?;
        let find =
            |this: &mut Self, out: &mut Vec<Twist>, velocities: &[Twist], strains: &[Twist]| {
                this.solve(mechanics, stage, scheme, (velocities, strains))?;
                out.clone_from(&this.multipliers);
                Ok(())
            };
        let (velocities, mut strains) =
            (core::mem::take(&mut self.velocities), core::mem::take(&mut self.strains));
        let mut multipliers = Vec::new();
        find(self, &mut multipliers, &velocities, &strains)?;
        self.start.fill(Twist::default());
        // Cables that are driven by their lengths and taut, section "Gradients".
        let taut: Vec<usize> =
            lengths.cables.iter().copied().filter(|&i| stage.tensions[i] > 0.0).collect();
        let mut forces = vec![0.0; taut.len()];
        let ends = core::mem::replace(&mut self.tensions, vec![0.0; rod.cables.len()]);
        if !taut.is_empty() {
            self.of_lengths.resize(taut.len(), Default::default());
            let none = vec![Twist::default(); rod.nodes.len()];
            let mut of_lengths = core::mem::take(&mut self.of_lengths);
            for (&cable, (of_length, gradient)) in taut.iter().zip(&mut of_lengths) {
                self.straight.length_gradient(rod, stage, scheme, cable, gradient);
                find(self, of_length, &none, gradient)?;
            }
            let n = taut.len();
            let mut matrix = vec![0.0; n * n];
            for (j, &cable) in taut.iter().enumerate() {
                for (i, (of_length, _)) in of_lengths.iter().enumerate() {
                    matrix[j * n + i] =
                        self.straight.tension_work(rod, stage, scheme, cable, of_length);
                }
                matrix[j * n + j] += rod.cables[cable].compliance / scheme.place;
                // The tension at the end lies straight beyond that of the stage, unless it would be negative.
                self.tensions[cable] = if lengths.end_tension_of(cable, stage, scheme) > 0.0 {
                    ends[cable]
                } else {
                    0.0
                };
                forces[j] = self.straight.tension_work(rod, stage, scheme, cable, &multipliers)
                    - self.tensions[cable] / scheme.place;
            }
            self.lu.factor(n, &matrix).map_err(|_| NotSolved)?;
            self.lu.solve(&mut forces);
            for (&cable, force) in taut.iter().zip(&forces) {
                let by_end = self.tensions[cable] + rod.cables[cable].compliance * force;
                self.tensions[cable] = by_end * (1.0 - 1.0 / scheme.place);
            }
            for (force, (of_length, gradient)) in forces.iter().zip(&of_lengths) {
                for (multiplier, of) in multipliers.iter_mut().zip(of_length) {
                    *multiplier = *multiplier - *of * *force;
                }
                for ((strain, start), of) in strains.iter_mut().zip(&mut self.start).zip(gradient) {
                    *strain = *strain - *of * *force;
                    // Where the stage is not at the end, the end lies beyond it, away from the start.
                    *start = *start - *of * (*force * (scheme.place - 1.0));
                }
            }
            self.of_lengths = of_lengths;
        }
        for (i, out) in self.cables.iter_mut().enumerate() {
            *out = if lengths.cables.contains(&i) {
                taut.iter().position(|&of| of == i).map_or(0.0, |k| forces[k])
            } else {
                -self.straight.tension_work(rod, stage, scheme, i, &multipliers)
            };
        }
        self.multipliers.copy_from_slice(&multipliers);
        self.find_by_poses(mechanics, stage);
        self.histories(mechanics, stage, scheme, strains, factors);
        self.velocities = multipliers;
        for (velocity, node) in self.velocities.iter_mut().zip(&rod.nodes) {
            velocity.linear *= node.mass * scheme.inertia;
            velocity.angular = node.inertia.scale(velocity.angular) * scheme.inertia;
        }
        Ok(())
    }

    /// Multipliers for derivatives by velocities and strains.
    fn solve(
        &mut self,
        mechanics: Mechanics<'_>,
        stage: &Stage,
        scheme: &Scheme,
        (velocities, strains): (&[Twist], &[Twist]),
    ) -> Result<(), NotSolved> {
        let rod = mechanics.rod;
        self.right.copy_from_slice(velocities);
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
            self.find_by_poses(mechanics, stage);
            for by in &mut self.by_poses {
                *by = *by * -1.0;
            }
            self.multipliers.copy_from_slice(&self.right);
            if mechanics.loads.any_dead {
                for a in 1..rod.nodes.len() {
                    let moment = dead_moment(mechanics, stage, a, &self.before[a]);
                    self.multipliers[a].angular += moment * scheme.g;
                }
            }
            stage.matrix.add_links_transposed(&self.before, &mut self.multipliers);
            add_transposed_changes(rod, stage, &self.by_poses, &mut self.multipliers);
            stage.matrix.solve_transposed(&mut self.multipliers);
            let (mut change, mut size) = (0.0, 0.0);
            for (now, before) in self.multipliers.iter().zip(&self.before) {
                let apart = *now - *before;
                change += dot(&apart, &apart);
                size += dot(now, now);
            }
            let change: f64 = (change / f64::max(size, f64::MIN_POSITIVE)).sqrt();
            if !change.is_finite() {
                return Err(NotSolved);
            }
            if change < SMALL || (change < SMALL_ENOUGH && change > 0.5 * last) {
                return Ok(());
            }
            last = change;
        }
        Err(NotSolved)
    }

    /// What dead loads and straight cables, which act by the poses, add to the derivatives by the strains, for the multipliers as they are.
    fn find_by_poses(&mut self, mechanics: Mechanics<'_>, stage: &Stage) {
        let Mechanics { rod, loads } = mechanics;
        let Self { multipliers, by_poses, straight, .. } = self;
        by_poses.fill(Twist::default());
        if loads.any_dead {
            let moment = |a: usize| {
                let moment = if a == 0 {
                    Default::default()
                } else {
                    dead_moment(mechanics, stage, a, &multipliers[a])
                };
                Wrench { force: Default::default(), moment: stage.poses[a].rotation.rotate(moment) }
            };
            pose::work_gradient(rod, &stage.strains, &stage.poses, moment, by_poses);
        }
        if rod.has_chords() {
            straight.add_by_strains(rod, stage, multipliers, by_poses);
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
                let (transported, _) = tangent.transposed_strain_change(&rest);
                let damped = point.damping.apply(&of_wrench) * (point.weight * scheme.damping);
                strains[q] = transported * (1.0 / scheme.g) + damped;
                let elastic = point.stiffness.apply(&(strain - point.rest));
                factors.stiffness -= point.weight * dot(&elastic, &of_wrench);
                let change = strain - stage.strain_history[q];
                factors.damping -= dot(&damped, &change);
            }
        }
        self.strains = strains;
        for a in 1..rod.nodes.len() {
            let (node, velocity) = (&rod.nodes[a], &stage.velocities[a]);
            let moving = if scheme.inertia == 0.0 { 0.0 } else { 1.0 };
            let change = (*velocity - stage.velocity_history[a]) * scheme.inertia;
            let Twist { linear: nu, angular: omega } = *velocity;
            let weight = stage.poses[a].rotation.conjugate().rotate(loads.gravity);
            let force = (change.linear + omega.cross(nu) * moving - weight) * node.mass;
            let moment = node.inertia.scale(change.angular)
                + omega.cross(node.inertia.scale(omega)) * moving;
            factors.mass -= dot(&Twist { linear: force, angular: moment }, &self.multipliers[a]);
        }
    }
}

/// `R_aᵀF × λ + R_aᵀM × μ`: what turns with the node, times the multipliers of its equations.
fn dead_moment(
    mechanics: Mechanics<'_>,
    stage: &Stage,
    a: usize,
    multiplier: &Twist,
) -> whipcord_numerics::Vec3 {
    let load = &stage.loads[a];
    let turn = stage.poses[a].rotation.conjugate();
    let force = turn.rotate(load.force + mechanics.loads.gravity * mechanics.rod.nodes[a].mass);
    force.cross(multiplier.linear) + turn.rotate(load.moment).cross(multiplier.angular)
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

impl Straight {
    /// Adds the derivatives by the strains of the pull of straight cables, times the multipliers.
    fn add_by_strains(&mut self, rod: &Rod, stage: &Stage, on: &[Twist], out: &mut [Twist]) {
        let Self { curvature, along, gradient, pulls, .. } = self;
        let tension = |k: usize| stage.tensions[rod.chords[k].cable];
        chords::gradient(rod, &stage.strains, &stage.poses, tension, pulls, gradient);
        for (q, (along, out)) in along.iter_mut().zip(&mut *out).enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            let (value, slope) = Stage::at_point(on, e, k, rod.lengths[e]);
            *along = slope + stage.strains[q].bracket(value);
            // ad_ξ λ = −ad_λ ξ.
            *out = *out - transposed_bracket(&value, &gradient[q]);
        }
        curvature.add(rod, stage.base, &stage.strains, along, tension, out);
    }

    /// What a tension of 1 N in a cable does on multipliers: `Σ w t · (λ′ + ad_ξ λ)`.
    fn tension_work(
        &mut self,
        rod: &Rod,
        stage: &Stage,
        scheme: &Scheme,
        cable: usize,
        on: &[Twist],
    ) -> f64 {
        let Self { gradient, pulls, .. } = self;
        if rod.has_chords() {
            let tension = |k: usize| if rod.chords[k].cable == cable { 1.0 } else { 0.0 };
            chords::gradient(rod, &stage.strains, &stage.poses, tension, pulls, gradient);
        }
        let points = 0..POINTS * rod.cables[cable].elements;
        let of_point = |q: usize| {
            let (e, k) = (q / POINTS, q % POINTS);
            let (value, slope) = Stage::at_point(on, e, k, rod.lengths[e]);
            let strain = stage.strains[q];
            let along = slope + strain.bracket(value);
            if rod.has_chords() {
                return dot(&gradient[q], &along);
            }
            let crossing = &rod.crossings[q * rod.cables.len() + cable];
            let pull = Pull::new(crossing, &strain, &stage.start[q], scheme).wrench(crossing);
            rod.points[q].weight * dot(&pull, &along)
        };
        points.map(of_point).sum()
    }

    /// The gradient of the length of a cable at the end of the step by the strains of the stage.
    fn length_gradient(
        &mut self,
        rod: &Rod,
        stage: &Stage,
        scheme: &Scheme,
        cable: usize,
        out: &mut Vec<Twist>,
    ) {
        out.clear();
        out.resize(rod.points.len(), Twist::default());
        if rod.has_chords() {
            let Self { pulls, strains, poses, .. } = self;
            for ((end, start), strain) in strains.iter_mut().zip(&stage.start).zip(&stage.strains) {
                *end = scheme.end(*start, *strain);
            }
            pose::nodes(rod, stage.base, strains, poses);
            let tension =
                |k: usize| if rod.chords[k].cable == cable { 1.0 / scheme.place } else { 0.0 };
            return chords::gradient(rod, strains, poses, tension, pulls, out);
        }
        for (q, out) in out.iter_mut().enumerate().take(POINTS * rod.cables[cable].elements) {
            let crossing = &rod.crossings[q * rod.cables.len() + cable];
            let end = scheme.end(stage.start[q], stage.strains[q]);
            let pull = Pull::new(crossing, &end, &end, &Scheme::STATICS).wrench(crossing);
            *out = pull * (rod.points[q].weight / scheme.place);
        }
    }
}
