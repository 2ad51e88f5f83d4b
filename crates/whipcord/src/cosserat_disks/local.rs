//! Jacobian and compliance at a place, by differences of solutions.
//!
//! At held tensions the place is pushed by a little wrench of each kind, and each tension is changed a
//! little; what keeps the cables at their lengths follows from these as in eq. (d4) of
//! `docs/theory/derivatives.md`. All solutions are on the mesh of the answer.

use whipcord_numerics::{Twist, Vec3};

use super::model::{CosseratDisks, Workspace};
use crate::case::{Actuation, CableCommand, Case, PointLoad};
use crate::differences::{Difference, ahead, differentiate};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::kinematics::{Compliance, Compliances, DerivativeMethod, DrivenBy, Local, Matrix6};
use crate::refusal;
use crate::robot::Robot;
use crate::shape::Solution;
use crate::statics::hold::{HeldCables, Hold};
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::stations::Stations;

/// Share of what would bend the robot by about a radian that differences take at first: their error
/// goes with the fourth power, that of the solver with the inverse.
const STEP: f64 = 1e-2;

/// The answer, and how the place at an arc length in m moves and yields; from a neighbouring solution when given.
///
/// # Errors
/// As [`CosseratDisks::solve`]; [`SolveError::Unsupported`] where a cable rubs: pulling and releasing
/// it then give different derivatives.
pub(crate) fn solve_at(
    options: &Options,
    robot: &Robot,
    case: &Case,
    arc_length: f64,
    warm_start: Option<&Solution>,
) -> Result<(Solution, Local), SolveError> {
    refusal::hole_friction(
        ModelKind::CosseratDisks,
        robot,
        "friction at the holes, for compliance and derivatives",
        "with friction the compliance differs between pulling and releasing a cable: set the friction to 0",
    )?;
    // A load to be changed; its place is then one of the mesh as well.
    let mut case = case.clone();
    case.before.clear();
    let push = case.loads.points.len();
    case.loads.points.push(PointLoad { at: arc_length, ..PointLoad::default() });
    let options = Options { stations: Stations::At(vec![arc_length]), ..options.clone() };
    let mut workspace = Workspace::default();
    let model = CosseratDisks::new(robot, &case.loads, &options)?;
    let answer = model.solve(&case, warm_start, &mut workspace)?;

    let near = Options {
        actuation: Actuation::Tension,
        accuracy: Accuracy::Steps(answer.diagnostics.steps),
        stability: StabilityAnalysis::Off,
        ..options.clone()
    };
    let driven_by = driven_by(&case, options.actuation);
    let tensions: Vec<f64> = answer.cables.iter().map(|c| c.tension.unwrap_or(0.0)).collect();
    for (command, &tension) in case.commands.iter_mut().zip(&tensions) {
        *command = CableCommand { tension: Some(tension), shortening: None };
    }
    let mut near = Near {
        model: CosseratDisks::new(robot, &case.loads, &near)?,
        workspace,
        at: answer.clone(),
        case,
        length: robot.backbone().length,
        error: 0.0,
    };
    let local = near.local(push, &tensions, driven_by)?;
    Ok((answer, local))
}

/// Solutions near an answer.
struct Near {
    model: CosseratDisks,
    workspace: Workspace,
    at: Solution,
    /// With the tensions of the answer.
    case: Case,
    length: f64,
    /// Greatest estimated error of a difference, relative to the greatest part of it.
    error: f64,
}

impl Near {
    fn local(
        &mut self,
        push: usize,
        tensions: &[f64],
        driven_by: Vec<DrivenBy>,
    ) -> Result<Local, SolveError> {
        let cables = tensions.len();
        let moment = self.bend_moment().ok_or(SolveError::NoDerivatives)?;
        let turn = self.case.loads.to_base(self.case.base.rotation).conjugate();
        let mut by_wrench = Vec::with_capacity(6);
        for component in 0..6 {
            let axis = turn.rotate([Vec3::X, Vec3::Y, Vec3::Z][component % 3]);
            let step = if component < 3 { moment / self.length } else { moment };
            by_wrench.push(self.difference(STEP * step, false, |case, by| {
                let point = &mut case.loads.points[push];
                match component {
                    0..3 => point.force += by * axis,
                    _ => point.moment += by * axis,
                }
            })?);
        }
        let mut by_tension = Vec::with_capacity(cables);
        for (cable, &tension) in tensions.iter().enumerate() {
            let step = STEP * moment / self.lever(cable);
            // A cable cannot push.
            let one_sided = tension < step;
            by_tension.push(self.difference(step, one_sided, |case, by| {
                case.commands[cable].tension = Some(tension + by);
            })?);
        }
        let robot = self.model.robot();
        let initial: Vec<f64> = self.at.cables.iter().map(|c| c.initial_length).collect();
        let held = HeldCables::new(
            cables,
            |i, j| by_tension[j].lengths[i],
            |i| robot.cables()[i].axial_stiffness.map_or(0.0, |k| initial[i] / k),
            |i| tensions[i] > 0.0,
            |i| driven_by[i] == DrivenBy::Shortening,
        )
        .map_err(|_| SolveError::NoDerivatives)?;
        let to_base = self.case.base.rotation.conjugate();
        let twist = |difference: &Difference| {
            let Twist { linear, angular } = difference.stations[0];
            Twist { linear: to_base.rotate(linear), angular: to_base.rotate(angular) }
        };
        // The motion that goes with a change of the tensions.
        let pulled = |tensions: &[f64]| {
            let mut sum = Twist::default();
            for (column, tension) in by_tension.iter().zip(tensions) {
                let by = twist(column);
                sum.linear += *tension * by.linear;
                sum.angular += *tension * by.angular;
            }
            sum
        };
        let add = |a: Twist, b: Twist| Twist {
            linear: a.linear + b.linear,
            angular: a.angular + b.angular,
        };
        let opposite = |lengths: &[f64]| lengths.iter().map(|x| -x).collect::<Vec<f64>>();
        let yielding = |hold: Hold| {
            let columns = core::array::from_fn(|i| {
                let tensions = held.tensions(hold, &opposite(&by_wrench[i].lengths));
                add(twist(&by_wrench[i]), pulled(&tensions))
            });
            let compliance = Matrix6::from_columns(&columns);
            Compliance { compliance, stiffness: compliance.inverse(self.length) }
        };
        // What the command of a cable changes of every tension.
        let command = |cable: usize| match driven_by[cable] {
            DrivenBy::Tension => {
                let right = opposite(&by_tension[cable].lengths);
                let mut tensions = held.tensions(Hold::Commands, &right);
                tensions[cable] += 1.0;
                tensions
            }
            DrivenBy::Shortening => {
                let right: Vec<f64> =
                    (0..cables).map(|i| if i == cable { -1.0 } else { 0.0 }).collect();
                held.tensions(Hold::Commands, &right)
            }
        };
        let by_command: Vec<Vec<f64>> = (0..cables).map(command).collect();
        let length = |i: usize, tensions: &Vec<f64>| {
            let columns = by_tension.iter().zip(tensions);
            columns.map(|(column, tension)| column.lengths[i] * tension).sum()
        };
        let lengths = |i: usize| by_command.iter().map(|tensions| length(i, tensions)).collect();
        Ok(Local {
            actuation_jacobian: by_command.iter().map(|tensions| pulled(tensions)).collect(),
            length_jacobian: (0..cables).map(lengths).collect(),
            compliances: Ok(Compliances {
                tensions_held: yielding(Hold::Tensions),
                lengths_held: yielding(Hold::Lengths),
            }),
            driven_by,
            method: DerivativeMethod::Differences { error: self.error },
        })
    }

    /// How the answer changes with what `change` does to the case, and how far off that may be.
    fn difference(
        &mut self,
        step: f64,
        one_sided: bool,
        change: impl Fn(&mut Case, f64),
    ) -> Result<Difference, SolveError> {
        let mut by = |step: f64| {
            let solve = |by: f64| {
                let mut case = self.case.clone();
                change(&mut case, by);
                self.model.solve(&case, Some(&self.at), &mut self.workspace)
            };
            if one_sided { ahead(solve, step) } else { differentiate(solve, step) }
        };
        let (coarse, fine) = (by(step)?, by(0.5 * step)?);
        let Twist { linear, angular } = fine.stations[0];
        let was = coarse.stations[0];
        let size = linear.norm() / self.length + angular.norm();
        let off = (linear - was.linear).norm() / self.length + (angular - was.angular).norm();
        // What moves by less than this per radian of what bends does not count.
        if size * step > 1e-6 * STEP {
            self.error = self.error.max(off / size);
        }
        Ok(fine)
    }

    /// About what moment bends the robot by a radian, in N·m; `None` where its stiffness is not given.
    fn bend_moment(&self) -> Option<f64> {
        let robot = self.model.robot();
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let stiffness = |s: f64| -> Option<f64> {
            if let Some(given) = &backbone.stiffness {
                let given = given.at_end(disks, s, s);
                return Some(given[3][3].min(given[4][4]));
            }
            let section = backbone.section_at(disks, s)?;
            let second_moment = section.second_moment_x.min(section.second_moment_y);
            Some(backbone.material.young_modulus? * second_moment)
        };
        Some(stiffness(0.0)?.min(stiffness(self.length)?) / self.length)
    }

    /// How far from the backbone a cable runs, at least a hundredth of its length.
    fn lever(&self, cable: usize) -> f64 {
        let robot = self.model.robot();
        let route = &robot.routes()[cable];
        let offsets = robot.disks().arc_lengths.iter().filter(|s| **s <= route.end());
        offsets.map(|&s| route.at(s).offset.norm()).fold(0.01 * self.length, f64::max)
    }
}

fn driven_by(case: &Case, actuation: Actuation) -> Vec<DrivenBy> {
    let by = |command: &CableCommand| match command.tension {
        Some(_) if actuation != Actuation::Shortening => DrivenBy::Tension,
        _ => DrivenBy::Shortening,
    };
    case.commands.iter().map(by).collect()
}
