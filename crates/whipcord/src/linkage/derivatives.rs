//! Exact derivatives of an answer by commands, loads and parameters.
//!
//! The tangent of the equilibrium, eq. (5), gives all but what parameters change at constant coordinates: these enter the
//! equations through stiffness, rest shape, holes and loads, and their part is differentiated by differences of the equations.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::chain::Chain;
use super::layout::{self, Section};
use super::loads::AppliedLoads;
use super::motion::Coordinates;
use super::places::Places;
use super::plastic_derivatives::Asked;
use super::task::{Right, Task};
use super::{Linkage, Workspace};
use crate::case::Case;
use crate::contact::Holding;
use crate::derivatives::{
    CoordinateCable, CoordinateDerivatives, Equations, KnownPlaces, LinearSystem, ParameterChange,
    SolvedCoordinates, gravity_change,
};
use crate::error::SolveError;
use crate::parameter::{Parameter, StiffnessPart};
use crate::robot::Robot;
use crate::shape::Wrench;
use crate::solution::Solution;

impl Linkage {
    /// [`Self::solve`], with the derivatives of the answer: by tensions or lengths, by loads at any place, and by these
    /// parameters.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Invalid`] for a parameter that robot and case do not have,
    /// [`SolveError::Unsupported`] for so many sections and stations that their equations, which are dense, take too much memory,
    /// and [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_with_derivatives(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        if self.keeps_history() {
            let of = (case, parameters);
            let found = self.differentiate_last_step(of, &self.stations, workspace);
            return workspace.meter.checked(found);
        }
        if let Some(rubbing) = self.friction.as_ref().filter(|_| case.obstacles.is_empty()) {
            return self.solve_sliding_with_derivatives(rubbing, case, parameters, workspace);
        }
        workspace.meter.start(&self.options.cancel, self.options.budget);
        if self.has_friction() || (warm_start.is_none() && case.differentiates_way(&self.robot)) {
            let found = self.rub_and_differentiate((case, parameters), workspace);
            return workspace.meter.checked(found);
        }
        let asked = Asked::new(parameters, &self.stations);
        self.differentiate_step(case, warm_start, asked, workspace)
    }

    /// The same of one step of cables that do not rub, from the plastic angles that its joints keep.
    pub(super) fn differentiate_step(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        asked: Asked<'_>,
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        if case.obstacles.is_empty() {
            workspace.forget();
            let mut solution = Solution::empty(self.kind);
            let status = self.solve_from_here(case, warm_start.into(), workspace, &mut solution)?;
            let solution = workspace.answered(status, solution)?;
            let derivatives = self.differentiate(case, &Holding::default(), asked, workspace)?;
            return Ok((solution, derivatives));
        }
        workspace.meter.start(&self.options.cancel, self.options.budget);
        let found = self.differentiate_among_obstacles(case, warm_start, asked, workspace);
        workspace.meter.checked(found)
    }

    /// The derivatives of the answer that the workspace is at, of a case with the pushes of its contacts among its loads.
    pub(super) fn differentiate(
        &self,
        case: &Case,
        holding: &Holding,
        asked: Asked<'_>,
        workspace: &mut Workspace,
    ) -> Result<CoordinateDerivatives, SolveError> {
        let coordinates = self.division.coordinates() * self.sections.len();
        let at = [asked.stations, &self.robot.disks().arc_lengths, &holding.places];
        let places = KnownPlaces::new(self.kind, coordinates, at)?;
        let Workspace { scratch, loads, commands, tensions, meter, .. } = workspace;
        let task = self.task(loads, tensions, meter);
        let system = self.linear_system(&places.arc_lengths, &task, &mut scratch.chain)?;
        let q = &scratch.chain.q;
        let by_parameter = |(p, parameter): (usize, &Parameter)| {
            let mut change = self.by_parameter(parameter, case, q, |sections, robot, case| {
                self.equations(sections, robot, case, q, tensions)
            })?;
            self.add_history(q, asked.before(p), &mut change);
            Ok(change)
        };
        let parameters = asked.parameters.iter().enumerate().map(by_parameter);
        let parameters = parameters.collect::<Result<Vec<_>, SolveError>>()?;
        let cable = |(i, command): (usize, &_)| CoordinateCable {
            command: *command,
            is_taut: tensions[i] > 0.0,
            compliance: self.robot.cable_compliance(i, self.rest_lengths[i]),
        };
        let solved = SolvedCoordinates {
            system,
            places,
            cables: commands.iter().enumerate().map(cable).collect(),
            parameters,
            length: self.robot.backbone().length,
            is_bending_about_to_change: self.is_joint_about_to_change(q),
        };
        let change = holding.is_about_to_change;
        CoordinateDerivatives::of(solved, change, |compliance| holding.gain(compliance))
    }

    /// The equations of the answer, linearised, with these arc lengths as places.
    pub(super) fn linear_system(
        &self,
        arc_lengths: &[f64],
        task: &Task<'_>,
        chain: &mut Chain,
    ) -> Result<LinearSystem, SolveError> {
        let count = self.division.coordinates();
        let n = count * self.sections.len();
        chain.evaluate(task);
        chain.linearise(task);
        let unit = |side: usize| Right::Unit { section: side / count, coordinate: side % count };
        chain.eliminate_with(task, 0.0, n, unit).ok_or(SolveError::NoDerivatives)?;
        let (mut inverse, mut base) = (vec![0.0; n * n], vec![0.0; 6 * n]);
        for side in 0..n {
            for k in 0..self.sections.len() {
                for (a, x) in chain.response(task, side, k).iter().enumerate() {
                    inverse[(k * count + a) * n + side] = *x;
                }
            }
            let Wrench { force, moment } = chain.base_response(side);
            for axis in 0..3 {
                base[axis * n + side] = force[axis];
                base[(3 + axis) * n + side] = moment[axis];
            }
        }
        let disks: Vec<Pose> = self.disks(&chain.q).collect();
        let places = Places::new(self, &chain.q, &disks, arc_lengths);
        Ok(LinearSystem {
            coordinates: n,
            inverse,
            lengths: chain.length_rates(task),
            base,
            jacobian: places.jacobian(chain, count),
            positions: places.positions(),
        })
    }

    /// How the equations, which are those of sections, a robot and a case, change with a parameter at the coordinates and tensions of
    /// an answer, where the friction of the joints stays on the branch of its law that it is on.
    pub(super) fn by_parameter(
        &self,
        parameter: &Parameter,
        case: &Case,
        q: &[Coordinates],
        equations: impl Fn(&[Section], &Robot, &Case) -> Equations,
    ) -> Result<ParameterChange, SolveError> {
        parameter.check(&self.robot, case)?;
        let section = &self.sections[0];
        let moment = section.stiffness[1] * section.length / self.robot.backbone().length;
        let scale = parameter.scale(&self.robot, case, moment);
        let change = ParameterChange::by_differences(scale, |by| {
            let (mut sections, robot, case) = self.moved(parameter, case, by)?;
            self.stay_on_branches(&mut sections, q);
            Ok(equations(&sections, &robot, &case))
        })?;
        Ok(ParameterChange { gravity: gravity_change(parameter, case), ..change })
    }

    /// Sections, robot and case with a parameter changed by this.
    pub(super) fn moved(
        &self,
        parameter: &Parameter,
        case: &Case,
        by: f64,
    ) -> Result<(Vec<Section>, Robot, Case), SolveError> {
        let mut sections = self.sections.clone();
        match *parameter {
            Parameter::StiffnessScale(part) => {
                for stiffness in sections.iter_mut().map(|section| &mut section.stiffness) {
                    match part {
                        StiffnessPart::Torsion => stiffness[0] *= 1.0 + by,
                        StiffnessPart::Bending => {
                            stiffness[1..].iter_mut().for_each(|k| *k *= 1.0 + by);
                        }
                        // The sections have no such strains.
                        StiffnessPart::Shear | StiffnessPart::Extension => {}
                    }
                }
                let given = self.robot.backbone().bending_friction;
                if part == StiffnessPart::Bending
                    && given.is_none_or(|given| given.yield_stiffness.is_none())
                {
                    let joints = sections.iter_mut().flat_map(|section| &mut section.friction);
                    joints.flat_map(|joint| &mut joint.stiffness).for_each(|k| *k *= 1.0 + by);
                }
            }
            Parameter::HoleAngle { cable, disk } => {
                let turn = UnitQuaternion::exp(Vec3::Z * by);
                for (k, section) in sections.iter_mut().enumerate() {
                    for passage in section.passages.iter_mut().filter(|p| p.cable == cable) {
                        if k == disk {
                            passage.near = turn.rotate(passage.near);
                        }
                        if k + 1 == disk && !passage.is_anchored_inside() {
                            passage.far = turn.rotate(passage.far);
                        }
                    }
                }
            }
            _ => {
                let (robot, case) = parameter.moved(&self.robot, case, by)?;
                let (sections, _) = layout::sections(&robot, self.kind, &self.division)?;
                return Ok((sections, robot, case));
            }
        }
        Ok((sections, self.robot.clone(), case.clone()))
    }

    /// The equations of these sections.
    fn equations(
        &self,
        sections: &[Section],
        robot: &Robot,
        case: &Case,
        q: &[Coordinates],
        tensions: &[f64],
    ) -> Equations {
        let (residuals, chain) = self.residuals(sections, robot, case, q, tensions);
        let rest = layout::rest_lengths(&self.division, sections, tensions.len());
        let target = |(i, &rest): (usize, &f64)| {
            let shortening = case.commands[i].shortening.map_or(0.0, |s| s.in_metres(rest));
            let asked = rest - shortening;
            asked + robot.cable_stretch(i, rest, tensions[i])
        };
        let targets = rest.iter().enumerate().map(target).collect();
        let kept = self.kept_angles(sections, q);
        Equations { residuals, lengths: chain.lengths, targets, base: chain.base, kept }
    }
}

impl Linkage {
    /// What is left of the equilibrium of these sections, and the chain that was evaluated.
    pub(super) fn residuals(
        &self,
        sections: &[Section],
        robot: &Robot,
        case: &Case,
        q: &[Coordinates],
        tensions: &[f64],
    ) -> (Vec<f64>, Chain) {
        let mut loads = AppliedLoads::default();
        loads.gather(robot, &self.division, &case.loads, case.base.rotation);
        let mut chain = Chain::default();
        chain.q.extend_from_slice(q);
        let meter = Default::default();
        let task = Task { sections, ..self.task(&loads, tensions, &meter) };
        chain.evaluate(&task);
        let count = self.division.coordinates();
        let residuals =
            chain.residuals().iter().flat_map(|residual| residual[..count].to_vec()).collect();
        (residuals, chain)
    }
}
