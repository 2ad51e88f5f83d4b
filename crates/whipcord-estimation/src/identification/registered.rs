//! Measurements in a frame of their own: the rigid motion of each is estimated with the other unknowns.

use whipcord_numerics::{Mat3, Pose, UnitQuaternion, Vec3};

use super::error::IdentifyError;
use super::experiment::{Experiment, Unknown};
use super::forward::Forward;
use super::quantity::Quantity;
use super::settings::Settings;
use crate::observation::Seen;
use crate::registration::{Alignment, align, nearest_rotation};
use whipcord::robot::Robot;

/// Whether an unknown says where the frame of a measurement is, in this experiment.
fn is_of_frame(unknown: &Unknown, experiment: usize) -> bool {
    unknown.is_of(experiment)
        && matches!(
            unknown.quantity,
            Quantity::MeasuredPosition { .. }
                | Quantity::MeasuredTurn { .. }
                | Quantity::BasePosition { .. }
                | Quantity::BaseTurn { .. }
        )
}

impl Experiment {
    /// Whether it has rotations of bodies that are mounted nobody knows how.
    fn needs_body(&self) -> bool {
        self.body.is_none() && self.observations.iter().any(|seen| seen.seen.is_rotation())
    }

    /// Whether its measurement is to be moved, and nothing that is estimated moves it or the base.
    #[must_use]
    pub fn needs_registration(&self, number: usize, unknowns: &[Unknown]) -> bool {
        self.alignment != Alignment::None
            && !unknowns.iter().any(|unknown| is_of_frame(unknown, number))
    }
}

/// The experiments, each with the frame of its measurement as the model with the start values has it, and the unknowns with those of
/// the frames that are to be estimated ([`Alignment::Rigid`]): six for each experiment, or six for all where all were measured in
/// `one_frame`. Markers on the base ([`Alignment::Base`]) fix the frame by themselves.
///
/// # Errors
/// [`IdentifyError::Frame`] where the measurement does not fix it, and [`IdentifyError::NoAnswerAtStart`].
pub fn registered(
    robot: &Robot,
    experiments: &[Experiment],
    unknowns: &[Unknown],
    one_frame: bool,
    settings: &Settings,
) -> Result<(Vec<Experiment>, Vec<Unknown>), IdentifyError> {
    let of_frames: Vec<usize> = (0..experiments.len())
        .filter(|e| experiments[*e].needs_registration(*e, unknowns))
        .collect();
    let of_bodies: Vec<usize> =
        (0..experiments.len()).filter(|e| experiments[*e].needs_body()).collect();
    if of_frames.is_empty() && of_bodies.is_empty() {
        return Ok((experiments.to_vec(), unknowns.to_vec()));
    }
    let forward = Forward::new(robot, experiments, unknowns, settings)?;
    let x = forward.start()?;
    let experiments = match settings.skips {
        true => forward.marked(&x).0,
        false => experiments.to_vec(),
    };
    let mut all = experiments.clone();
    let forward = Forward::new(robot, &experiments, unknowns, settings)?;
    place(&forward, &x, &of_frames, one_frame, &mut all)?;
    let placed = all.clone();
    let forward = Forward::new(robot, &placed, unknowns, settings)?;
    mount(&forward, &x, &of_bodies, true, &mut all)?;
    let mut found = unknowns.to_vec();
    let turns = |quantity: &Quantity| matches!(quantity, Quantity::BodyTurn { .. });
    if !of_bodies.is_empty() && !unknowns.iter().any(|unknown| turns(&unknown.quantity)) {
        found.extend((0..3).map(|axis| Unknown::new(Quantity::BodyTurn { axis })));
    }
    let mut add = |experiment: Option<usize>| {
        let quantities = (0..3)
            .map(|axis| Quantity::MeasuredPosition { axis })
            .chain((0..3).map(|axis| Quantity::MeasuredTurn { axis }));
        found.extend(quantities.map(|quantity| Unknown { experiment, ..Unknown::new(quantity) }));
    };
    let rigid = of_frames.iter().filter(|e| all[**e].alignment == Alignment::Rigid);
    match one_frame {
        true if rigid.clone().count() > 0 => add(None),
        true => {}
        false => rigid.for_each(|e| add(Some(*e))),
    }
    Ok((all, found))
}

/// As [`registered`], of experiments that are not fitted, with values of the unknowns: each is moved by itself.
pub(super) fn placed(
    robot: &Robot,
    experiments: &[Experiment],
    (unknowns, values): (&[Unknown], &[f64]),
    settings: &Settings,
) -> Result<Vec<Experiment>, IdentifyError> {
    let of_frames: Vec<usize> = (0..experiments.len())
        .filter(|e| experiments[*e].needs_registration(*e, unknowns))
        .filter(|e| !experiments[*e].observations.is_empty())
        .collect();
    let of_bodies: Vec<usize> =
        (0..experiments.len()).filter(|e| experiments[*e].needs_body()).collect();
    let mut all = experiments.to_vec();
    if !of_frames.is_empty() {
        let forward = Forward::new(robot, experiments, unknowns, settings)?;
        place(&forward, values, &of_frames, false, &mut all)?;
    }
    if !of_bodies.is_empty() {
        let placed = all.clone();
        let forward = Forward::new(robot, &placed, unknowns, settings)?;
        mount(&forward, values, &of_bodies, false, &mut all)?;
    }
    Ok(all)
}

/// Sets how the tracked bodies of these experiments are mounted, one rotation for all of them or one for each, by the answers with these values: the rotation nearest to
/// those of all rows.
fn mount(
    forward: &Forward<'_>,
    x: &[f64],
    of_bodies: &[usize],
    one_body: bool,
    into: &mut [Experiment],
) -> Result<(), IdentifyError> {
    let mut sums: Vec<(Mat3, UnitQuaternion)> = Vec::new();
    for &e in of_bodies {
        let (solutions, mut refused) = forward.answers(e, x);
        let view = forward.view(e, x);
        let mut sum = Mat3::ZERO;
        for (step, solution) in &solutions {
            let seen = forward.see(e, *step, solution, &view, |_, seen, marker| {
                if let Seen::Rotation { rotation, .. } = seen.seen {
                    let there = view.frame.rotation * marker.pose.rotation;
                    sum += (there.conjugate() * rotation).to_matrix();
                }
            });
            // What cameras do not see has no place in their images; bodies have a rotation.
            let _ = seen;
        }
        if sum == Mat3::ZERO && !refused.is_empty() {
            return Err(IdentifyError::no_answer(e, refused.swap_remove(0).reason));
        }
        // What the unknown turns add to a body is not counted twice.
        sums.push((sum, view.body));
    }
    let all = sums.iter().fold(Mat3::ZERO, |sum, (of, _)| sum + *of);
    for (&e, (own, turn)) in of_bodies.iter().zip(&sums) {
        let mounted = nearest_rotation(if one_body { &all } else { own });
        into[e].body = Some(turn.conjugate() * mounted);
    }
    Ok(())
}

/// Sets the frames of these experiments, one each or one for all, by the answers with these values.
fn place(
    forward: &Forward<'_>,
    x: &[f64],
    of_frames: &[usize],
    one_frame: bool,
    into: &mut [Experiment],
) -> Result<(), IdentifyError> {
    let mut pairs: Vec<([Vec3; 2], bool)> = Vec::new();
    let mut none = None;
    for (number, &e) in of_frames.iter().enumerate() {
        if !one_frame {
            pairs.clear();
        }
        // The places in the world.
        let (solutions, mut refused) = forward.answers(e, x);
        let view = forward.view(e, x);
        for (step, solution) in &solutions {
            let placed = forward.see(e, *step, solution, &view, |_, seen, marker| {
                if let Seen::Position(measured) = seen.seen {
                    let at_base = seen.place.arc_length(forward.robot.disks()) == 0.0;
                    pairs.push(([measured, marker.point], at_base));
                }
            });
            // What cameras do not see has no place in their images; positions have.
            let _ = placed;
        }
        if none.is_none() && !refused.is_empty() {
            none = Some((e, refused.swap_remove(0).reason));
        }
        if one_frame && number + 1 < of_frames.len() {
            continue;
        }
        let alignment = into[e].alignment;
        let aligned = align(pairs.iter().copied(), alignment).map_err(|error| {
            match none.take().filter(|_| pairs.is_empty()) {
                Some((experiment, reason)) => IdentifyError::no_answer(experiment, reason),
                None => IdentifyError::Frame { experiment: e, error },
            }
        })?;
        let frame = aligned.motion.unwrap_or(Pose::IDENTITY).inverse();
        let moved = if one_frame { of_frames } else { &of_frames[number..=number] };
        for &e in moved {
            into[e].frame = frame;
        }
    }
    Ok(())
}
