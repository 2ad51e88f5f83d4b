//! Derivatives with friction against bending of the joints, eq. (5) of its page: what the plastic angles that a step starts from push, and how
//! those that it leaves change.
//!
//! The plastic angles of all joints are numbered by sections, then joints, then axes.

use super::layout::Section;
use super::motion::Coordinates;
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::derivatives::{CoordinateDerivatives, ParameterChange};
use crate::error::SolveError;
use crate::parameter::Parameter;
use crate::section::{BENDING_AXES, BendingFriction};
use crate::solution::Solution;
use crate::statics::friction::{Carrying, History};
use crate::statics::loads::check as check_loads;

/// What derivatives are asked by, and of what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked<'a> {
    pub parameters: &'a [Parameter],
    /// Arc lengths in m.
    pub stations: &'a [f64],
    /// The step of actuation, from 0, and how the plastic angles that it starts from change with each parameter; none where they do not.
    pub step: usize,
    pub history: &'a [Vec<f64>],
}

impl<'a> Asked<'a> {
    /// Of the first step, and of all where friction against bending keeps nothing.
    pub const fn new(parameters: &'a [Parameter], stations: &'a [f64]) -> Self {
        Self { parameters, stations, step: 0, history: &[] }
    }

    /// How the plastic angles before the step change with a parameter.
    pub fn before(&self, parameter: usize) -> &'a [f64] {
        self.history.get(parameter).map_or(&[], |history| history)
    }
}

/// A joint at an answer.
struct JointThere<'a> {
    section: usize,
    friction: &'a BendingFriction,
    /// By axes the direction in which it slides.
    sliding: [Option<f64>; BENDING_AXES],
    /// By axes how its bend changes with the coordinates of its section.
    rates: [Coordinates; BENDING_AXES],
}

impl Linkage {
    /// All joints with friction at these coordinates.
    fn joints(&self, q: &[Coordinates]) -> Vec<JointThere<'_>> {
        let mut joints = Vec::new();
        for (number, (section, q)) in self.sections.iter().zip(q).enumerate() {
            for (joint, friction) in section.friction.iter().enumerate() {
                let bend = section.bend_of_friction(&self.division, joint, q);
                joints.push(JointThere {
                    section: number,
                    friction,
                    sliding: core::array::from_fn(|axis| friction.sliding(axis, bend)),
                    rates: section.bend_rates(&self.division, joint, q),
                });
            }
        }
        joints
    }

    /// Lets the joints of sections beside those of an answer keep its plastic angles, and the branches of the law that it is on.
    pub(super) fn stay_on_branches(&self, sections: &mut [Section], q: &[Coordinates]) {
        for ((moved, section), q) in sections.iter_mut().zip(&self.sections).zip(q) {
            let joints = moved.friction.iter_mut().zip(&section.friction);
            for (joint, (moved, friction)) in joints.enumerate() {
                let bend = section.bend_of_friction(&self.division, joint, q);
                moved.plastic = friction.plastic;
                moved.stay_on_branch_of(friction, bend);
            }
        }
    }

    /// What the joints of sections keep at these coordinates.
    pub(super) fn kept_angles(&self, sections: &[Section], q: &[Coordinates]) -> Vec<f64> {
        let of = |(section, q): (&Section, &Coordinates)| {
            let left = |(joint, friction): (usize, &BendingFriction)| {
                friction.left(section.bend_of_friction(&self.division, joint, q))
            };
            section.friction.iter().enumerate().map(left).collect::<Vec<_>>()
        };
        sections.iter().zip(q).flat_map(of).flatten().collect()
    }

    /// Adds to what a parameter changes at constant coordinates what a change of the plastic angles before the step does.
    pub(super) fn add_history(
        &self,
        q: &[Coordinates],
        history: &[f64],
        change: &mut ParameterChange,
    ) {
        if history.is_empty() {
            return;
        }
        let count = self.division.coordinates();
        change.kept.resize(history.len(), 0.0);
        let changes =
            history.chunks_exact(BENDING_AXES).zip(change.kept.chunks_exact_mut(BENDING_AXES));
        for (JointThere { section, friction, sliding, rates }, (before, kept)) in
            self.joints(q).into_iter().zip(changes)
        {
            for axis in (0..BENDING_AXES).filter(|&axis| sliding[axis].is_none()) {
                kept[axis] += before[axis];
                let moment = friction.stiffness[axis] * before[axis];
                let force = &mut change.force[section * count..(section + 1) * count];
                force.iter_mut().zip(rates[axis]).for_each(|(force, rate)| *force += moment * rate);
            }
        }
    }

    /// How the plastic angles change that an answer at these coordinates leaves, with each parameter.
    pub(super) fn history_behind(
        &self,
        q: &[Coordinates],
        parameters: &[Parameter],
        derivatives: &CoordinateDerivatives,
    ) -> Vec<Vec<f64>> {
        if !self.keeps_history() {
            return Vec::new();
        }
        let count = self.division.coordinates();
        let joints = self.joints(q);
        let of_parameter = |p: usize| {
            let (moved, kept) = derivatives.kept_by(p);
            let mut changes = kept.to_vec();
            changes.resize(joints.len() * BENDING_AXES, 0.0);
            for (joint, changes) in joints.iter().zip(changes.chunks_exact_mut(BENDING_AXES)) {
                let moved = &moved[joint.section * count..(joint.section + 1) * count];
                for axis in (0..BENDING_AXES).filter(|&axis| joint.sliding[axis].is_some()) {
                    let bent = moved.iter().zip(joint.rates[axis]).map(|(by, rate)| by * rate);
                    changes[axis] += bent.sum::<f64>();
                }
            }
            changes
        };
        (0..parameters.len()).map(of_parameter).collect()
    }

    /// Whether a joint is where its friction begins to slide.
    pub(super) fn is_joint_about_to_change(&self, q: &[Coordinates]) -> bool {
        self.sections.iter().zip(q).any(|(section, q)| {
            let mut joints = section.friction.iter().enumerate();
            joints.any(|(joint, friction)| {
                friction.is_at_limit(section.bend_of_friction(&self.division, joint, q))
            })
        })
    }

    /// The answers to all steps of a case in order, from the robot at rest, with their derivatives through all steps before; `each` gets those
    /// that are asked for, by their number from 0, with them.
    ///
    /// # Errors
    /// The number of the first step without them, from 0, and why.
    pub(super) fn differentiate_in_steps(
        &self,
        (case, parameters): (&Case, &[Parameter]),
        stations: &[f64],
        asks: &dyn Fn(usize) -> bool,
        workspace: &mut Workspace,
        mut each: impl FnMut((Solution, Option<CoordinateDerivatives>)),
    ) -> Result<(), (usize, SolveError)> {
        case.check(&self.robot).map_err(|error| (0, error.into()))?;
        workspace.meter.start(&self.options.cancel, self.options.budget);
        if self.has_friction() && !case.obstacles.is_empty() {
            check_loads(&self.robot, &case.loads).map_err(|error| (0, error.of(self.kind)))?;
            let of = (case, parameters);
            return self.rub_with_derivatives_among_obstacles(of, asks, workspace, each);
        }
        let steps: Vec<Case> = case.leading_steps().collect();
        let mut chain = self.clone();
        let mut history: Vec<Vec<f64>> = Vec::new();
        let mut last: Option<Solution> = None;
        workspace.forget();
        workspace.friction.history = History::with_trail();
        let mut carrying = Carrying::default();
        for (n, step) in steps.iter().enumerate() {
            let asked = Asked { parameters, stations, step: n, history: &history };
            // What the holes remember of the steps before stays in the workspace.
            workspace.friction.taken = 0;
            let found = match &chain.friction {
                Some(rubbing) => chain.go_on(step, workspace).and_then(|solution| {
                    let of = (&steps[..], asked);
                    let derivatives =
                        chain.differentiate_trail(rubbing, of, &mut carrying, workspace)?;
                    Ok((solution, derivatives))
                }),
                None => chain.differentiate_step(step, last.as_ref(), asked, workspace),
            };
            let (mut solution, derivatives) = found.map_err(|error| (n, error))?;
            let q = &workspace.scratch.chain.q;
            history = chain.history_behind(q, parameters, &derivatives);
            chain.keep_plastic(q);
            solution.plastic_curvature = chain.plastic_curvature(&solution.shape.arc_length);
            each((last.insert(solution).clone(), asks(n).then_some(derivatives)));
        }
        Ok(())
    }

    /// The same of the last step.
    pub(super) fn differentiate_last_step(
        &self,
        of: (&Case, &[Parameter]),
        stations: &[f64],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        crate::contact::last_with_derivatives(of.0, |asks, each| {
            self.differentiate_in_steps(of, stations, asks, workspace, each)
        })
    }
}
