//! What cables do on the strains of a stage, and how that and their lengths change with the strains, for derivatives over motions.

use whipcord::Wrench;
use whipcord_numerics::{Pose, Twist, Vec3};

use crate::block::{dot, transposed_bracket};
use crate::chords::{self, Curvature};
use crate::conserving::{Conserving, along};
use crate::element::POINTS;
use crate::pose;
use crate::pull::Pull;
use crate::rod::Rod;
use crate::scheme::Scheme;
use crate::stage::Stage;

/// Room for what cables do on the strains.
#[derive(Clone, Debug)]
pub(crate) struct CableWork {
    pub curvature: Curvature,
    /// What the multipliers are for the strains, `λ′ + ad_ξ λ`.
    pub along: Vec<Twist>,
    gradient: Vec<Twist>,
    pulls: Vec<Wrench>,
    strains: Vec<Twist>,
    poses: Vec<Pose>,
}

impl CableWork {
    pub fn new(rod: &Rod) -> Self {
        let list = || vec![Twist::default(); rod.points.len()];
        Self {
            curvature: Curvature::new(rod),
            along: list(),
            gradient: list(),
            pulls: vec![Wrench::default(); rod.nodes.len()],
            strains: list(),
            poses: vec![Pose::IDENTITY; rod.nodes.len()],
        }
    }

    /// Adds the derivatives by the strains of the pull of straight cables, times the multipliers.
    pub fn add_by_strains(&mut self, rod: &Rod, stage: &Stage, on: &[Twist], out: &mut [Twist]) {
        let tension = |k: usize| stage.chord_tension(rod, k);
        let Self { gradient, pulls, .. } = self;
        chords::gradient(rod, &stage.strains, &stage.poses, tension, pulls, gradient);
        let gradient = core::mem::take(gradient);
        self.add_by_turning(rod, stage, &gradient, on, out);
        self.gradient = gradient;
        let Self { curvature, along, .. } = self;
        let none = |_| Vec3::ZERO;
        curvature.add(rod, (stage.base, &stage.strains), along, tension, none, out);
    }

    /// Finds what the multipliers are for the strains, and adds the derivatives by the strains of what forces on the strains do on the velocities.
    pub fn add_by_turning(
        &mut self,
        rod: &Rod,
        stage: &Stage,
        forces: &[Twist],
        on: &[Twist],
        out: &mut [Twist],
    ) {
        along(rod, &stage.strains, on, &mut self.along);
        for (q, (out, force)) in out.iter_mut().zip(forces).enumerate() {
            let (e, k) = (q / POINTS, q % POINTS);
            let (value, _) = Stage::at_point(on, e, k, rod.lengths[e]);
            // ad_ξ λ = −ad_λ ξ.
            *out = *out - transposed_bracket(&value, force);
        }
    }

    /// What a tension of 1 N in a cable exerts on the strains of the stage, times the weights of the points.
    pub fn find_unit_pull(
        &mut self,
        rod: &Rod,
        stage: &mut Stage,
        scheme: &Scheme,
        cable: usize,
    ) -> &[Twist] {
        let Self { gradient, pulls, .. } = self;
        if rod.has_chords() && scheme.conserves {
            *gradient = Conserving::alone(rod, stage, scheme, Vec3::ZERO, Some(cable));
            return gradient;
        }
        if rod.has_chords() {
            let tension = |k: usize| if rod.chords[k].cable == cable { 1.0 } else { 0.0 };
            chords::gradient(rod, &stage.strains, &stage.poses, tension, pulls, gradient);
            return gradient;
        }
        gradient.fill(Twist::default());
        for (q, out) in gradient.iter_mut().enumerate().take(POINTS * rod.cables[cable].elements) {
            let crossing = &rod.crossings[q * rod.cables.len() + cable];
            let pull = Pull::new(crossing, &stage.strains[q], &stage.start[q], scheme);
            *out = pull.wrench(crossing) * rod.points[q].weight;
        }
        gradient
    }

    /// What a tension of 1 N in a cable does on multipliers: `Σ w t · (λ′ + ad_ξ λ)`.
    pub fn tension_work(
        &mut self,
        rod: &Rod,
        stage: &mut Stage,
        scheme: &Scheme,
        cable: usize,
        on: &[Twist],
    ) -> f64 {
        let mut of_points = core::mem::take(&mut self.along);
        along(rod, &stage.strains, on, &mut of_points);
        let pulls = self.find_unit_pull(rod, stage, scheme, cable);
        let work = pulls.iter().zip(&of_points).map(|(a, b)| dot(a, b)).sum();
        self.along = of_points;
        work
    }

    /// The gradient of the length of a cable at the end of the step by the strains of the stage.
    pub fn length_gradient(
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
