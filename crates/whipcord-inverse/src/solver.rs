//! The solver of inverse problems of one robot: what it is made of.

use whipcord::{Cancel, Case, Model, Robot, SolveError, Stations};

use crate::actuator::{Actuator, Actuators, CommandedBy, knows_tensions};
use crate::atlas::Atlas;
use crate::descent::Workspace;
use crate::error::InverseError;
use crate::few_steps::on_few_steps;
use crate::forward::Forward;
use crate::landmarks::Landmarks;
use crate::limit::{Clearance, Constraints};
use crate::limits::Limits;
use crate::options::ReachOptions;

/// Solves inverse problems of one robot. It keeps the model, and the shapes that it starts from.
pub struct InverseSolver {
    pub(crate) model: Model,
    /// Where shapes are compared with obstacles.
    stations: Stations,
    pub(crate) case: Case,
    pub(crate) limits: Limits,
    pub(crate) forward: Forward,
    pub(crate) ranges: Ranges,
    /// Whether each bound of an unknown was not given: least, greatest.
    assumed: Vec<[bool; 2]>,
    knows_tensions: bool,
    pub(crate) atlas: Option<Atlas>,
    /// Unknowns of the shapes that a search starts from in place of the commands of the case.
    pub(crate) spread: Option<Vec<Vec<f64>>>,
    pub(crate) landmarks: Landmarks,
    pub(crate) workspace: Workspace,
}

/// A range that is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchRange {
    /// What varies.
    pub actuator: Actuator,
    /// Least and greatest, in N, m or rad.
    pub range: [f64; 2],
    /// Whether each of the two was assumed because no limit is given.
    pub assumed: [bool; 2],
}

/// Least and greatest of the unknowns, and of the values of the actuators.
#[derive(Clone, Debug)]
pub(crate) struct Ranges {
    pub unknowns: Vec<[f64; 2]>,
    pub values: Vec<[f64; 2]>,
}

/// Stations between which obstacles are not looked for, of each part between two disks.
const STATIONS: usize = 61;

impl InverseSolver {
    /// For a model of a robot, whose loads, base, obstacles and steps before are those of the case.
    ///
    /// # Errors
    /// [`InverseError`] where there is nothing to command, where limits do not fit the robot, and where the model refuses the robot.
    pub fn new(
        model: &Model,
        robot: &Robot,
        case: &Case,
        limits: &Limits,
        by: CommandedBy,
    ) -> Result<Self, InverseError> {
        limits.check(robot.cables().len())?;
        let list = Actuator::of(robot, case, model.kind(), by)?;
        let knows_tensions = knows_tensions(model.kind());
        let actuators = Actuators::new(robot, case, list, knows_tensions);
        let stations = match case.obstacles.is_empty() {
            true => Stations::Disks,
            false => Stations::Equal(STATIONS),
        };
        let model = model.at(stations.clone());
        let mut forward = Forward::new(&model, robot, case, actuators)?;
        forward.greatest_tensions = limits.cables.iter().map(|of| of.tension[1]).collect();
        let actuators = &forward.actuators;
        let ranges = Ranges {
            unknowns: actuators.bounds(&actuators.list, robot, limits),
            values: actuators.bounds(&actuators.asked, robot, limits),
        };
        let mut solver = Self {
            ranges,
            assumed: Vec::new(),
            model,
            stations,
            case: case.clone(),
            limits: limits.clone(),
            forward,
            knows_tensions,
            atlas: None,
            spread: None,
            landmarks: Landmarks::default(),
            workspace: Workspace::default(),
        };
        solver.assume_bounds();
        Ok(solver)
    }

    /// A solver of the same problem that has learned nothing, for the many targets of a survey: on few steps where these are exact enough for it.
    pub(crate) fn for_survey(&self) -> Result<Self, SolveError> {
        let is_smooth = self.forward.has_no_memory() && self.case.obstacles.is_empty();
        let model = on_few_steps(&self.model).filter(|_| is_smooth);
        let model = model.unwrap_or_else(|| self.model.clone());
        let actuators = self.forward.actuators.clone();
        let mut forward = Forward::new(&model, self.forward.robot(), &self.case, actuators)?;
        forward.greatest_tensions.clone_from(&self.forward.greatest_tensions);
        Ok(Self {
            ranges: self.ranges.clone(),
            assumed: self.assumed.clone(),
            model,
            stations: self.stations.clone(),
            case: self.case.clone(),
            limits: self.limits.clone(),
            forward,
            knows_tensions: self.knows_tensions,
            atlas: None,
            spread: None,
            landmarks: Landmarks::default(),
            workspace: Workspace::default(),
        })
    }

    /// The unknown commands, in the order of [`crate::Reached::commands`].
    #[must_use]
    pub fn actuators(&self) -> &[Actuator] {
        &self.forward.actuators.asked
    }

    /// What is searched: the ranges of the tensions where every actuator moves one cable, else of the commands.
    #[must_use]
    pub fn search_ranges(&self) -> Vec<SearchRange> {
        let robot = self.forward.robot();
        let actuators = &self.forward.actuators;
        let of = |((actuator, bounds), assumed): ((&Actuator, &[f64; 2]), &[bool; 2])| {
            let [a, b] = bounds.map(|bound| actuators.command(robot, *actuator, bound));
            let (range, assumed) =
                if a <= b { ([a, b], *assumed) } else { ([b, a], [assumed[1], assumed[0]]) };
            SearchRange { actuator: *actuator, range, assumed }
        };
        actuators.list.iter().zip(&self.ranges.unknowns).zip(&self.assumed).map(of).collect()
    }

    /// Where no limit is given, commands up to those that alone bend the robot by a whole turn.
    fn assume_bounds(&mut self) {
        for (bounds, scale) in self.ranges.unknowns.iter_mut().zip(&self.forward.scales) {
            let assumed = [!bounds[0].is_finite(), !bounds[1].is_finite()];
            if assumed[0] {
                bounds[0] = (-2.0 * scale).min(bounds[1]);
            }
            if assumed[1] {
                bounds[1] = (2.0 * scale).max(bounds[0]);
            }
            self.assumed.push(assumed);
        }
        if self.forward.actuators.are_direct() {
            self.ranges.values.clone_from(&self.ranges.unknowns);
        }
    }

    /// Lets this flag end the solves.
    pub fn set_cancel(&mut self, cancel: &Cancel) {
        self.model = self.model.cancelled_by(cancel);
        self.forward.set_cancel(cancel);
    }

    /// Takes the commands of this case in place of those of its own: searches start from them. All else stays.
    pub fn start_at(&mut self, case: &Case) {
        self.case.commands.clone_from(&case.commands);
        self.case.motors.clone_from(&case.motors);
    }

    /// The unknowns that the case commands.
    pub(crate) fn commanded(&mut self) -> Vec<f64> {
        self.forward.commanded(&self.case)
    }

    pub(crate) const fn forward(&self) -> &Forward {
        &self.forward
    }

    pub(crate) const fn forward_mut(&mut self) -> &mut Forward {
        &mut self.forward
    }

    pub(crate) const fn limits(&self) -> &Limits {
        &self.limits
    }

    pub(crate) const fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }

    pub(crate) const fn case(&self) -> &Case {
        &self.case
    }

    /// What is to be kept beside the ranges of the unknowns.
    pub(crate) fn constraints(&self, ranges: &Ranges, options: &ReachOptions) -> Constraints {
        let robot = self.forward.robot();
        let clearance =
            options.clearance.filter(|_| !self.case.obstacles.is_empty()).map(|margin| {
                let (backbone, disks) = (robot.backbone(), robot.disks());
                let arc_lengths = self.stations.arc_lengths(robot);
                let pitch = backbone.length / (STATIONS - 1) as f64;
                let radius = |s: &f64| {
                    let near = |(k, at): (usize, &f64)| {
                        if (at - s).abs() <= pitch { disks.rim_radius(k) } else { 0.0 }
                    };
                    let rims = disks.arc_lengths.iter().enumerate().map(near);
                    rims.fold(backbone.outer_radius_at(disks, *s), f64::max)
                };
                Clearance {
                    obstacles: self.case.obstacles.clone(),
                    margin,
                    radii: arc_lengths.iter().map(radius).collect(),
                    range: 0.01 * backbone.length,
                }
            });
        Constraints::new(
            robot,
            &self.forward.actuators,
            &ranges.values,
            &self.limits,
            self.knows_tensions,
            clearance,
        )
    }
}
