//! The equilibrium that a motion starts from: that of the statics, made exact in the elements.

use whipcord::{Case, Model, ModelKind, Robot, Solution, Stations};
use whipcord_numerics::{GAUSS_2, Pose, Twist};

use crate::element::POINTS;
use crate::error::MotionError;
use crate::iteration::{Mechanics, Solver};
use crate::rod::Rod;
use crate::scheme::Scheme;

/// Iterations at most.
const MOST: usize = 60;
/// Change of the strains at the end.
const TOLERANCE: f64 = 1e-12;
/// Distance of what may touch, as a part of the length.
const NEAR: f64 = 5e-3;
/// Change below which rounding may be what is left.
const ROUNDING: f64 = 1e-9;
/// The same where the robot touches: the place on the rim of a disk moves with the iteration.
const ROUNDING_IN_CONTACT: f64 = 1e-7;

/// Finds the equilibrium of a case, whose commands are those before the start, as the tensions and lengths in the solver are; its strains and
/// tensions are left in the stage.
pub(crate) fn find(
    robot: &Robot,
    statics: &Case,
    mechanics: Mechanics<'_>,
    solver: &mut Solver,
) -> Result<(), MotionError> {
    let Mechanics { rod, loads } = mechanics;
    let stations: Vec<f64> = rod.nodes.iter().map(|node| node.arc_length).collect();
    let model = if rod.has_chords() { ModelKind::CosseratDisks } else { ModelKind::Cosserat };
    let model = Model::new(model, Stations::At(stations), Default::default());
    let mut prepared = model.prepare(robot, &statics.loads)?;
    let solution = prepared.solve_to_the_end(statics).map_err(|(_, error)| error)?;
    let back = statics.base.inverse();
    let poses: Vec<Pose> = solution.shape.poses.iter().map(|pose| back * *pose).collect();
    strains(rod, &poses, &mut solver.stage.strains);
    for (tension, cable) in solver.stage.tensions.iter_mut().zip(&solution.cables) {
        *tension = cable.tension.unwrap_or(*tension);
    }
    if solver.friction.is_some() {
        solver.stage.passages = tensions_of_answer(rod, robot, &solution);
    }
    loads.at(0.0, &mut solver.stage.loads);
    let known = (solution.contacts.as_slice(), statics.base);
    let within = NEAR * rod.length;
    solver.contacts.base = solver.stage.base;
    solver.contacts.begin(rod, solver.stage.base, &solver.stage.strains, within, known);
    // A base that is free is held until the start.
    solver.stage.matrix.hold_base(true);
    solver.holds_passages = true;
    let found = iterate(mechanics, solver);
    solver.stage.matrix.hold_base(!loads.has_free_base);
    solver.holds_passages = false;
    found
}

/// Newton's method for the equilibrium in the elements.
fn iterate(mechanics: Mechanics<'_>, solver: &mut Solver) -> Result<(), MotionError> {
    let mut change = f64::INFINITY;
    for _ in 0..MOST {
        let stage = &mut solver.stage;
        stage.velocities.fill(Twist::default());
        stage.velocity_history.fill(Twist::default());
        stage.strain_history.copy_from_slice(&stage.strains);
        stage.start.copy_from_slice(&stage.strains);
        let before = change;
        change = solver.iterate(mechanics, &Scheme::STATICS, true).unwrap_or(f64::INFINITY);
        let rounding = if solver.contacts.list.is_empty() { ROUNDING } else { ROUNDING_IN_CONTACT };
        if change < TOLERANCE || (change < rounding && change > 0.5 * before) {
            solver.stage.velocities.fill(Twist::default());
            return Ok(());
        }
        if !change.is_finite() {
            break;
        }
    }
    Err(MotionError::Unbalanced { iterations: MOST, change })
}

/// Strains whose elements connect poses of the nodes.
fn strains(rod: &Rod, poses: &[Pose], out: &mut [Twist]) {
    for (e, &h) in rod.lengths.iter().enumerate() {
        let half = 0.5 * h;
        let mean = |a: usize| (poses[a].inverse() * poses[a + 1]).log() * (1.0 / half);
        let means = [mean(2 * e), mean(2 * e + 1)];
        // The mean of a linear strain, but for the bracket of the Magnus series.
        let change = means[1] - means[0];
        let [a, b] = means.map(|mean| mean - mean.bracket(change) * (half / 12.0));
        for k in 0..POINTS {
            let t = (GAUSS_2.nodes[k] - 0.25) / 0.5;
            out[POINTS * e + k] = a * (1.0 - t) + b * t;
        }
    }
}

/// Tensions of all passages in an answer of the statics, straight between the middles of its spans.
fn tensions_of_answer(rod: &Rod, robot: &Robot, solution: &Solution) -> Vec<f64> {
    let disks = &robot.disks().arc_lengths;
    let cables = rod.cables_of_passages();
    let of_passage = |(p, &cable): (usize, &usize)| {
        let answer = &solution.cables[cable];
        let spans = &answer.span_tensions;
        let place = p - rod.first_passages[cable];
        if spans.is_empty() {
            return answer.tension.unwrap_or_default();
        }
        if rod.has_chords() {
            return spans[place.min(spans.len() - 1)];
        }
        let (e, k) = (place / POINTS, place % POINTS);
        let s = rod.nodes[2 * e].arc_length + GAUSS_2.nodes[k] * rod.lengths[e];
        let middle = |i: usize| 0.5 * (disks[i] + disks[i + 1]);
        let after = (0..spans.len()).position(|i| middle(i) >= s).unwrap_or(spans.len() - 1).max(1);
        if spans.len() == 1 {
            return spans[0];
        }
        let t = (s - middle(after - 1)) / (middle(after) - middle(after - 1));
        spans[after - 1] + t * (spans[after] - spans[after - 1])
    };
    cables.iter().enumerate().map(of_passage).collect()
}
