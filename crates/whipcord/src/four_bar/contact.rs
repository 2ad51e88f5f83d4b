//! How the sections yield to what pushes the robot: the side of contact that this model is asked for.

use whipcord_numerics::{Pose, Vec3, equally_spaced};

use super::FourBar;
use super::contact_response::{ContactResponse, Load, SingularSystem};
use super::joint::Joint;
use super::options::{Conflicts, LengthRule, Objective};
use super::refusal;
use super::several::MOST_CONFLICT;
use super::solve::{MET, Workspace};
use crate::cancel::Cancel;
use crate::case::Case;
use crate::contact;
use crate::contact::Unobstructed;
use crate::contact::model::{Compliant, Push};
use crate::derivatives::CoordinateDerivatives;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::parameter::Parameter;
use crate::shape::{NoStability, Solution, Wrench};

/// The backbone is watched at this many places or more from base to tip.
const WATCHED: usize = 40;
/// The most sections of a robot among obstacles.
const MOST_SECTIONS: usize = 300;

/// The sections among obstacles.
struct ContactAdapter<'a> {
    model: &'a FourBar,
    workspace: &'a mut Workspace,
    /// Newtons by the model's own measure of force; 1 where no stiffness is known.
    scale: f64,
    watched: Vec<f64>,
    /// Section and fraction of each watched place, and where it is.
    places: Vec<(usize, f64)>,
    poses: Vec<Pose>,
    found: ContactResponse,
    kept: ContactResponse,
    targets: Vec<f64>,
    loads: Vec<Load>,
}

impl FourBar {
    /// The shape among the obstacles of a case.
    pub(super) fn solve_in_contact(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        workspace: &mut Workspace,
    ) -> Result<Solution, SolveError> {
        self.check_obstacles(case)?;
        let watched = self.watched();
        let mut free = FreeChain { model: self, workspace, watched: &watched };
        if let Some(solution) = contact::solve_free(&mut free, &self.robot, case, warm_start)? {
            return Ok(solution);
        }
        contact::solve(&mut self.adapter(watched, workspace), &self.robot, case, warm_start)
    }

    /// The same, with the derivatives of the answer and the contacts that hold it.
    pub(super) fn linearize_in_contact(
        &self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
        workspace: &mut Workspace,
    ) -> Result<(Solution, CoordinateDerivatives), SolveError> {
        self.check_obstacles(case)?;
        let watched = self.watched();
        let mut free = FreeChain { model: self, workspace, watched: &watched };
        if contact::solve_free(&mut free, &self.robot, case, warm_start)?.is_some() {
            let alone = Case { obstacles: Vec::new(), ..case.clone() };
            return self.solve_and_linearize(&alone, None, parameters, workspace);
        }
        let mut adapter = self.adapter(watched, workspace);
        let (solution, holding) =
            contact::solve_holding(&mut adapter, &self.robot, case, warm_start)?;
        let ContactAdapter { found, loads, .. } = adapter;
        let derivatives = self.linearize(found, &loads, case, &holding, parameters)?;
        Ok((solution, derivatives))
    }

    fn check_obstacles(&self, case: &Case) -> Result<(), SolveError> {
        case.check(&self.robot)?;
        refusal::case(&self.robot, case)?;
        if self.options.objective != Objective::StrainEnergy
            || self.options.lengths != LengthRule::Free
        {
            return Err(refusal::unsupported(
                "obstacles",
                "only lengths and no energy decide where it bends",
                "take the objective strain-energy and the length rule free, or use cosserat",
            ));
        }
        if self.sections.len() > MOST_SECTIONS {
            return Err(refusal::unsupported(
                "obstacles",
                "the robot has more than 300 sections, and among obstacles their equations are dense",
                "use cosserat, or a robot of fewer disks",
            ));
        }
        Ok(())
    }

    fn adapter<'a>(
        &'a self,
        watched: Vec<f64>,
        workspace: &'a mut Workspace,
    ) -> ContactAdapter<'a> {
        let places = watched.iter().map(|&s| self.locate(s)).collect();
        let mut found = ContactResponse::default();
        found.reset(&self.sections, self.initial_lengths.len());
        ContactAdapter {
            model: self,
            workspace,
            scale: self.tension_scale.unwrap_or(1.0),
            watched,
            places,
            poses: Vec::new(),
            kept: found.clone(),
            found,
            targets: Vec::new(),
            loads: Vec::new(),
        }
    }

    /// Where the backbone is watched: the disks and equal parts between.
    fn watched(&self) -> Vec<f64> {
        let each = WATCHED.div_ceil(self.sections.len());
        let mut watched = vec![0.0];
        for pair in self.robot.disks().arc_lengths.windows(2) {
            watched.extend(equally_spaced(pair[0], pair[1], each + 1).skip(1));
        }
        watched
    }

    /// The section of an arc length and the fraction of it that lies behind, the whole of it at a disk.
    pub(super) fn locate(&self, arc_length: f64) -> (usize, f64) {
        let (section, part) = self.robot.disks().locate(arc_length);
        if part == 0.0 && section > 0 { (section - 1, 1.0) } else { (section, part) }
    }
}

/// The sections without obstacles.
struct FreeChain<'a> {
    model: &'a FourBar,
    workspace: &'a mut Workspace,
    watched: &'a [f64],
}

impl Unobstructed for FreeChain<'_> {
    fn watched(&self) -> &[f64] {
        self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.model.initial_lengths
    }

    fn solve(
        &mut self,
        case: &Case,
        _from: Option<&Solution>,
        centres: &mut Vec<Vec3>,
    ) -> Result<Solution, SolveError> {
        let mut solution = Solution::empty(ModelKind::FourBar);
        self.model.solve_and_tell(case, self.workspace, &mut solution)?;
        // The answer is where the base of the case is.
        let to_base = case.base.inverse();
        let joints = &self.workspace.joints;
        let centre = |&s: &f64| {
            let (section, part) = self.model.locate(s);
            let there = joints[section].pose_at(part, &self.model.sections[section]);
            to_base.transform(solution.disks.poses[section].transform(there.position))
        };
        centres.clear();
        centres.extend(self.watched.iter().map(centre));
        Ok(solution)
    }

    fn look(&mut self, case: &Case, centres: &mut Vec<Vec3>) -> Result<(), SolveError> {
        self.solve(case, None, centres).map(|_| ())
    }
}

impl ContactAdapter<'_> {
    fn set_loads(&mut self, pushes: &[Push]) {
        self.loads.clear();
        for push in pushes {
            let (section, part) = self.model.locate(push.arc_length);
            let Wrench { force, moment } = push.wrench;
            let wrench = Wrench { force: force / self.scale, moment: moment / self.scale };
            self.loads.push(Load { section, part, wrench });
        }
    }

    fn look(&mut self) {
        let (found, sections) = (&self.found, &self.model.sections);
        self.poses.clear();
        self.poses.extend(self.places.iter().map(|&(s, part)| found.pose_at(sections, s, part)));
    }
}

/// Equations that are singular say that the robot is about to buckle.
fn singular_system(SingularSystem: SingularSystem) -> SolveError {
    SolveError::NoDerivatives
}

impl Compliant for ContactAdapter<'_> {
    fn watched(&self) -> &[f64] {
        &self.watched
    }

    fn initial_lengths(&self) -> &[f64] {
        &self.model.initial_lengths
    }

    fn knows_forces(&self) -> bool {
        self.model.tension_scale.is_some()
    }

    fn force_scale(&self) -> f64 {
        // The energy of a robot that bends by 1 rad is about n times the scale.
        self.scale * self.model.sections.len() as f64 / self.model.robot.backbone().length
    }

    fn cancel(&self) -> &Cancel {
        &self.model.options.cancel
    }

    fn effort(&self) -> f64 {
        // To look where it is, and to solve its equations, which are dense: those of so many sections take as long.
        const LOOK: f64 = 0.4;
        const SECTIONS: f64 = 60.0;
        LOOK + (self.model.sections.len() as f64 / SECTIONS).powi(3)
    }

    fn refine(&mut self) -> Result<bool, SolveError> {
        Ok(false)
    }

    fn reset(&mut self) {
        self.found.reset(&self.model.sections, self.model.initial_lengths.len());
    }

    fn start_from(&mut self, answer: &Solution) {
        self.found.start_from(&self.model.sections, answer);
        let scale = self.scale;
        let pulls = answer.cables.iter().map(|cable| cable.tension.unwrap_or(0.0) / scale);
        self.found.multipliers.clear();
        self.found.multipliers.extend(pulls);
    }

    fn consider(&mut self, case: &Case, pushes: &[Push]) -> Result<(), SolveError> {
        self.targets.clear();
        for (command, &initial) in case.commands.iter().zip(&self.model.initial_lengths) {
            let shortening = command.shortening.map_or(0.0, |s| s.in_metres(initial));
            self.targets.push(initial - shortening);
        }
        self.set_loads(pushes);
        let (sections, targets) = (&self.model.sections, &self.targets);
        self.found.linearise(sections, targets, &self.loads).map_err(singular_system)?;
        self.look();
        Ok(())
    }

    fn pose(&self, arc_length: f64) -> Pose {
        let k = self.watched.partition_point(|&s| s < arc_length);
        if self.watched.get(k) == Some(&arc_length) {
            return self.poses[k];
        }
        let (section, part) = self.model.locate(arc_length);
        self.found.pose_at(&self.model.sections, section, part)
    }

    fn unsettled(&self) -> f64 {
        self.found.unsettled()
    }

    fn advance(&mut self, changes: &[[f64; 6]], part: f64) -> Result<(), SolveError> {
        let changes = changes.iter().flatten().map(|change| change / self.scale);
        self.found.advance(changes, part);
        Ok(())
    }

    fn compliance(
        &mut self,
        pushes: &[Push],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) -> Result<(), SolveError> {
        // Those that are new push nothing yet.
        self.set_loads(pushes);
        self.found.compliance(&self.model.sections, &self.loads, compliance, drift);
        compliance.iter_mut().for_each(|entry| *entry /= self.scale);
        Ok(())
    }

    fn stands_alone(&mut self) -> bool {
        self.found.stands()
    }

    fn keep(&mut self) {
        self.kept.clone_from(&self.found);
    }

    fn pose_before(&self, arc_length: f64) -> Pose {
        let (section, part) = self.model.locate(arc_length);
        self.kept.pose_at(&self.model.sections, section, part)
    }

    fn go_back(&mut self) {
        self.found.clone_from(&self.kept);
        self.look();
    }

    fn solution(&mut self, case: &Case, pushes: &[Push]) -> Result<Solution, SolveError> {
        let joints = &mut self.workspace.joints;
        joints.clear();
        joints.extend(self.found.bends.iter().map(|&bend| Joint::Bend(bend)));
        self.workspace.targets.clone_from(&self.targets);
        let (model, multipliers) = (self.model, &self.found.multipliers);
        // Of cables that depend on one another not all lengths can be had.
        let part = match model.options.conflicts {
            Conflicts::Refuse => MET,
            Conflicts::Compromise => MOST_CONFLICT,
        };
        let excess = self.found.lengths.iter().zip(&self.targets).map(|(have, want)| have - want);
        let worst = excess.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some(worst) = worst.filter(|worst| worst.1 > part * model.robot.backbone().length) {
            return Err(model.conflict(worst, 0, model.sections.len()));
        }
        let mut solution = model.solution_of_joints(case.base, self.workspace, multipliers);
        if self.knows_forces() {
            let mut total = Wrench::default();
            for push in pushes {
                let arm = self.pose(push.arc_length).position;
                total.force += push.wrench.force;
                total.moment += push.wrench.moment + arm.cross(push.wrench.force);
            }
            solution.base_wrench = Some(total);
        }
        if pushes.iter().any(|push| push.wrench.force != Vec3::ZERO) {
            solution.diagnostics.stability_absent = Some(NoStability::Touching);
        }
        Ok(solution)
    }
}
