//! Derivatives of the discrete gradient, eq. (18) of the page on motion: of what dead forces and straight cables exert on the strains in a step by `energy`.

use whipcord::Wrench;
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::block::dot;
use crate::chords::{self, Curvature};
use crate::element::POINTS;
use crate::loads::NodeLoad;
use crate::pose;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::{LEAST_CHANGE, Stage, along_change};

/// The linearisation of the discrete gradient `G(m) + C Δ α` with the strains m at the stage and their change Δ over the step, `α = (L(end) − L(start) − G(m) · Δ)/(Δ · C Δ)`.
#[derive(Clone, Debug)]
pub(crate) struct Conserving {
    curvature: Curvature,
    pulls: Vec<Wrench>,
    poses: Vec<Pose>,
    strains: Vec<Twist>,
    /// `G` at the stage, at the end and at the start.
    gradients: [Vec<Twist>; 3],
    /// `C Δ`.
    scaled: Vec<Twist>,
    /// The second derivative times Δ.
    curved: Vec<Twist>,
    room: Vec<Twist>,
    /// `Δ · C Δ`; zero where there is no correction.
    size: f64,
    alpha: f64,
}

impl Conserving {
    pub fn new(rod: &Rod) -> Self {
        let list = || vec![Twist::default(); rod.points.len()];
        Self {
            curvature: Curvature::new(rod),
            pulls: vec![Wrench::default(); rod.nodes.len()],
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
            strains: list(),
            gradients: [list(), list(), list()],
            scaled: list(),
            curved: list(),
            room: list(),
            size: 0.0,
            alpha: 0.0,
        }
    }

    /// Takes up a stage that is solved.
    pub fn linearise(&mut self, rod: &Rod, stage: &Stage, scheme: &Scheme, gravity: Vec3) {
        let Self { curvature, pulls, poses, strains, gradients, scaled, curved, .. } = self;
        let (force, tension) = forces(rod, stage, gravity);
        let mut levels = [0.0; 3];
        for (k, (gradient, level)) in gradients.iter_mut().zip(&mut levels).enumerate() {
            for ((out, start), at) in strains.iter_mut().zip(&stage.start).zip(&stage.strains) {
                *out = [*at, scheme.end(*start, *at), *start][k];
            }
            pose::nodes(rod, stage.base, strains, poses);
            chords::level_gradient(rod, strains, poses, &tension, &force, pulls, gradient);
            *level = chords::work(rod, poses, &tension) - pose::work(poses, &force);
        }
        let change = |q: usize| scheme.end(stage.start[q], stage.strains[q]) - stage.start[q];
        let (mut size, mut rest) = (0.0, levels[1] - levels[2]);
        for (q, out) in scaled.iter_mut().enumerate() {
            *out = along_change(rod, q, change(q));
            size += dot(out, &change(q));
            rest -= dot(&gradients[0][q], &change(q));
        }
        (self.size, self.alpha) =
            if size < LEAST_CHANGE * rod.length { (0.0, 0.0) } else { (size, rest / size) };
        for (q, out) in strains.iter_mut().enumerate() {
            *out = change(q);
        }
        curved.fill(Twist::default());
        curvature.add(rod, (stage.base, &stage.strains), strains, tension, force, curved);
    }

    /// Adds the derivatives of `Σ potential · on`, by the strains of the stage and by those at the start.
    pub fn add_transposed(
        &mut self,
        rod: &Rod,
        stage: &Stage,
        scheme: &Scheme,
        gravity: Vec3,
        on: &[Twist],
        (by_stage, by_start): (&mut [Twist], &mut [Twist]),
    ) {
        let Self { curvature, gradients, scaled, curved, size, alpha, .. } = self;
        let (force, tension) = forces(rod, stage, gravity);
        curvature.add(rod, (stage.base, &stage.strains), on, tension, force, by_stage);
        if *size == 0.0 {
            return;
        }
        let part = on.iter().zip(&*scaled).map(|(a, b)| dot(a, b)).sum::<f64>() / *size;
        let inverse = 1.0 / scheme.place;
        let [middle, end, start] = gradients;
        for q in 0..rod.points.len() {
            let by_change = along_change(rod, q, on[q]) * *alpha
                - (middle[q] + scaled[q] * (2.0 * *alpha)) * part;
            let by_end = end[q] * part;
            by_stage[q] = by_stage[q] - curved[q] * part + (by_change + by_end) * inverse;
            by_start[q] =
                by_start[q] - start[q] * part + by_end * (1.0 - inverse) - by_change * inverse;
        }
    }

    /// Adds what the potential changes by, for changes of the strains of the stage and of those at the start.
    pub fn add(
        &mut self,
        rod: &Rod,
        stage: &Stage,
        scheme: &Scheme,
        gravity: Vec3,
        (by_stage, by_start): (&[Twist], &[Twist]),
        out: &mut [Twist],
    ) {
        let Self { curvature, gradients, scaled, curved, room, size, alpha, .. } = self;
        let (force, tension) = forces(rod, stage, gravity);
        curvature.add(rod, (stage.base, &stage.strains), by_stage, tension, force, out);
        if *size == 0.0 {
            return;
        }
        let [middle, end, start] = gradients;
        let mut rest = 0.0;
        for q in 0..rod.points.len() {
            room[q] = (by_stage[q] - by_start[q]) * (1.0 / scheme.place);
            rest += dot(&end[q], &(by_start[q] + room[q]))
                - dot(&start[q], &by_start[q])
                - dot(&curved[q], &by_stage[q])
                - dot(&(middle[q] + scaled[q] * (2.0 * *alpha)), &room[q]);
        }
        for q in 0..rod.points.len() {
            out[q] = out[q] + along_change(rod, q, room[q]) * *alpha + scaled[q] * (rest / *size);
        }
    }

    /// The potential of the weight alone, which a factor on all masses multiplies, or of 1 N in one cable alone.
    pub fn alone(
        rod: &Rod,
        stage: &mut Stage,
        scheme: &Scheme,
        gravity: Vec3,
        cable: Option<usize>,
    ) -> Vec<Twist> {
        // The weight of gravity over time is among the loads.
        let weight = |load: &NodeLoad| {
            let force = if cable.is_none() { load.weight } else { Vec3::ZERO };
            NodeLoad { force, ..NodeLoad::default() }
        };
        let weights = stage.loads.iter().map(weight).collect();
        potential_of(rod, stage, scheme, (gravity, cable, weights))
    }

    /// The potential of these dead forces alone.
    pub fn of_forces(
        rod: &Rod,
        stage: &mut Stage,
        scheme: &Scheme,
        loads: &[NodeLoad],
    ) -> Vec<Twist> {
        potential_of(rod, stage, scheme, (Vec3::ZERO, None, loads.to_vec()))
    }
}

/// The potential of gravity, of 1 N in a cable and of dead forces, without that of anything else.
fn potential_of(
    rod: &Rod,
    stage: &mut Stage,
    scheme: &Scheme,
    (gravity, cable, loads): (Vec3, Option<usize>, Vec<NodeLoad>),
) -> Vec<Twist> {
    let loads = core::mem::replace(&mut stage.loads, loads);
    let (tensions, potential) = (stage.tensions.clone(), stage.potential.clone());
    stage.tensions.fill(0.0);
    if let Some(cable) = cable {
        stage.tensions[cable] = 1.0;
    }
    stage.find_conserving_forces(rod, gravity, scheme);
    (stage.loads, stage.tensions) = (loads, tensions);
    core::mem::replace(&mut stage.potential, potential)
}

/// The dead force on each node, and the tension of each chord.
fn forces<'a>(
    rod: &'a Rod,
    stage: &'a Stage,
    gravity: Vec3,
) -> (impl Fn(usize) -> Vec3 + 'a, impl Fn(usize) -> f64 + 'a) {
    (
        move |a: usize| match stage.moves_base {
            true => Vec3::ZERO,
            false => stage.loads[a].force + gravity * rod.nodes[a].mass,
        },
        move |k: usize| stage.tensions[rod.chords[k].cable],
    )
}

/// Multipliers for the strains of all points, `λ′ + ad_ξ λ`.
pub(crate) fn along(rod: &Rod, strains: &[Twist], on: &[Twist], out: &mut [Twist]) {
    for (q, (out, strain)) in out.iter_mut().zip(strains).enumerate() {
        let (value, slope) = Stage::at_point(on, q / POINTS, q % POINTS, rod.lengths[q / POINTS]);
        *out = slope + strain.bracket(value);
    }
}
