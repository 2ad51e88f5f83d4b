//! One arc from base to tip: the constant-curvature model.
//!
//! `docs/theory/constant-curvature.md` derives the equations whose numbers stand in the code.

mod arc;
mod local;
mod refusal;

use whipcord_numerics::Pose;

use crate::budget::{Budget, Meter};
use crate::cancel::Cancel;
use crate::case::{Actuation, Case};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::{Cable, Robot};
use crate::shape::Wrench;
use crate::solution::{CableState, Diagnostics, NoStability, Solution};
use crate::statics::command::Command;
use crate::statics::lengths::{self, Effort, Given, LengthScratch, TensionResponse as _};
use crate::statics::outcome::Failure;
use crate::stations::Stations;
use crate::warm_start::Status;

use arc::{Arc, Elasticity};

/// How the model is driven, and where it gives the shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Where the shape is given.
    pub stations: Stations,
    /// Which command of each cable counts; by nature the shortening.
    pub actuation: Actuation,
    /// What a solve may spend.
    pub budget: Budget,
    /// Ends a solve from outside.
    pub cancel: Cancel,
}

/// The constant-curvature model of one robot: the backbone is an arc of a circle, and the cables
/// run parallel to it.
///
/// Tensions bend an elastic backbone; lengths bend it as little as they allow. It takes no loads,
/// and refuses what no single arc can be.
///
/// ```
/// use whipcord::constant_curvature::{ConstantCurvature, Options, Workspace};
/// use whipcord::{Backbone, Cable, Case, Disks, Robot, Routing, Shortening};
///
/// // A straight cable at 8 mm, shortened by 5 mm: κ L = 5/8.
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(Backbone::new(0.18), Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let model = ConstantCurvature::new(&robot, &Options::default())?;
/// let case = Case::with_shortenings(&[Shortening::Length(0.005)]);
/// let solution = model.solve(&case, &mut Workspace::default())?;
/// assert!((solution.shape.tip().rotation.log().norm() - 0.625).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConstantCurvature {
    robot: Robot,
    actuation: Actuation,
    budget: Budget,
    cancel: Cancel,
    /// Offsets of the cables from the backbone's axis, `(x, y)` in m.
    offsets: Vec<[f64; 2]>,
    /// What the backbone's stiffness is, or why it is of no use here.
    elasticity: Result<Elasticity, SolveError>,
    /// The arc at rest.
    rest: Arc,
    /// Lengths of the cables on the arc at rest in m.
    rest_lengths: Vec<f64>,
    stations: Vec<f64>,
}

/// Scratch memory of a solve.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    commands: Vec<Command>,
    tensions: Vec<f64>,
    lengths: Vec<f64>,
    length_by_tension: Vec<f64>,
    search: LengthScratch,
    meter: Meter,
}

impl ConstantCurvature {
    /// The model of a robot.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for cables that do not run parallel to the backbone up to its tip, for
    /// a rest curvature that is no arc, and, where `options` ask for tensions, for a stiffness that
    /// varies or couples bending with other strains; [`SolveError::Missing`] where they ask for
    /// tensions of a robot whose stiffness is not given.
    pub fn new(robot: &Robot, options: &Options) -> Result<Self, SolveError> {
        options.stations.check(robot)?;
        crate::refusal::bending_friction_of_sections(ModelKind::ConstantCurvature, robot)?;
        let offsets = refusal::offsets(robot)?;
        let rest = refusal::rest(robot)?;
        let elasticity = refusal::elasticity(robot);
        if let (Actuation::Tension, Err(error)) = (options.actuation, &elasticity) {
            return Err(error.clone());
        }
        let actuation = options.actuation;
        let rest_lengths = offsets.iter().map(|offset| rest.cable_length(*offset)).collect();
        let stations = options.stations.arc_lengths(robot);
        Ok(Self {
            robot: robot.clone(),
            actuation,
            budget: options.budget,
            cancel: options.cancel.clone(),
            offsets,
            elasticity,
            rest,
            rest_lengths,
            stations,
        })
    }

    /// The robot this model was built for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    pub(crate) const fn set_budget(&mut self, budget: Budget) {
        self.budget = budget;
    }

    pub(crate) fn set_cancel(&mut self, cancel: &Cancel) {
        self.cancel.clone_from(cancel);
    }

    /// Arc lengths of the stations in m.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// The shape under a case. It is found from the case alone: there is nothing that a neighbouring
    /// answer would make faster.
    ///
    /// # Errors
    /// [`SolveError::Unsupported`] for loads, for friction where tensions are given, and for an elastic
    /// cable that is given its length on a backbone of unknown stiffness; [`SolveError::Missing`] for a cable
    /// without a command; [`SolveError::UnreachableLength`] and [`SolveError::ContradictoryLengths`]
    /// for lengths that no arc has; [`SolveError::SectionFolds`] for tensions that leave a cable no length;
    /// [`SolveError::Invalid`] for a case that does not fit the robot.
    pub fn solve(&self, case: &Case, workspace: &mut Workspace) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::ConstantCurvature);
        self.solve_into(case, workspace, &mut solution).map(|_| solution)
    }

    /// [`Self::solve`] into memory that is at hand: after the first call nothing is allocated where tensions drive the cables.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_into(
        &self,
        case: &Case,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) -> Result<Status, SolveError> {
        let (arc, effort) = self.solve_arc(case, workspace)?;
        self.write(case.base, &arc, effort, workspace, solution);
        Ok(Status::Converged)
    }

    /// The arc.
    fn solve_arc(
        &self,
        case: &Case,
        workspace: &mut Workspace,
    ) -> Result<(Arc, Effort), SolveError> {
        workspace.meter.start(&self.cancel, self.budget);
        case.check(&self.robot)?;
        refusal::obstacles(case)?;
        refusal::loads(case)?;
        workspace.commands.clear();
        for (i, &initial) in self.rest_lengths.iter().enumerate() {
            let kind = ModelKind::ConstantCurvature;
            let actuation = match self.actuation {
                Actuation::Natural if case.commands[i].shortening.is_some() => {
                    Actuation::Shortening
                }
                actuation => actuation,
            };
            let command = Command::of(kind, &self.robot, i, case, actuation, initial)?;
            refusal::command(&self.robot, i, command, &self.elasticity)?;
            workspace.commands.push(command);
        }
        let bent = self.bend(workspace).map_err(|failure| {
            let name = |i: usize| self.robot.cables()[i].name.clone();
            failure.explain(&workspace.commands, &self.rest_lengths, name)
        });
        workspace.meter.checked(bent)
    }

    /// That of the robot, or where it is not known one that gives the same shapes for the same lengths.
    fn elasticity_or_unit(&self) -> Elasticity {
        let unit = Elasticity::geometric(self.rest.length);
        self.elasticity.as_ref().copied().unwrap_or(unit)
    }

    /// The arc under the commands.
    fn bend(&self, workspace: &mut Workspace) -> Result<(Arc, Effort), Failure> {
        let Workspace { commands, tensions, lengths, length_by_tension, search, meter } = workspace;
        tensions.clear();
        tensions.extend(commands.iter().map(|command| match command {
            Command::Tension(tension) => *tension,
            Command::Length { .. } => 0.0,
        }));
        let length = self.rest.length;
        let elasticity = self.elasticity_or_unit();
        let mut rod = arc::Rod {
            rest: self.rest,
            elasticity,
            offsets: &self.offsets,
            arc: self.rest,
            lengths,
            length_by_tension,
        };
        let by_length = commands.iter().any(Command::is_length);
        let effort = if by_length {
            let given = Given { length, commands, bracket: true, meter };
            let solved = lengths::solve(&given, tensions, &mut rod, search);
            solved
                .map_err(|fault| fault.failure(|fault| Failure::of_section(fault, tensions, 0.0)))?
        } else {
            rod.respond(tensions, false)
                .map_err(|fault| Failure::of_section(fault, tensions, rod.borne(tensions)))?;
            Effort::default()
        };
        Ok((rod.arc, effort))
    }

    fn write(
        &self,
        base: Pose,
        arc: &Arc,
        effort: Effort,
        workspace: &Workspace,
        solution: &mut Solution,
    ) {
        let at = |&s: &f64| arc.pose(s);
        let disks = &self.robot.disks().arc_lengths;
        solution.shape.set(&self.stations, self.stations.iter().map(at), base);
        solution.disks.set(disks, disks.iter().map(at), base);
        // With hole friction, prescribed lengths leave their tensions open.
        let knows_forces =
            self.elasticity.is_ok() && !self.robot.cables().iter().any(Cable::has_friction);
        let Workspace { commands, tensions, lengths, .. } = workspace;
        let cables = self.robot.cables();
        solution.cables.resize_with(cables.len(), CableState::default);
        for (i, state) in solution.cables.iter_mut().enumerate() {
            let (name, length) = (&cables[i].name, [lengths[i], self.rest_lengths[i]]);
            commands[i].answer(name, tensions[i], length, self.rest.length, state);
            state.tension = state.tension.filter(|_| knows_forces);
        }
        solution.model = ModelKind::ConstantCurvature;
        solution.contacts.clear();
        solution.internal.clear();
        solution.base_wrench = knows_forces.then(Wrench::default);
        solution.diagnostics = Diagnostics {
            iterations: effort.iterations,
            residual: effort.residual,
            stability_absent: Some(NoStability::NoEnergy),
            steps: 1,
            ..Diagnostics::default()
        };
    }
}
