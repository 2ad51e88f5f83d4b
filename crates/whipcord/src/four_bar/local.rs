//! Jacobian and compliance at a place: with the lengths, eq. (12), and where the strain energy is known to
//! wrenches, eqs. (14) to (16).

use whipcord_numerics::{Twist, UnitQuaternion};

use super::FourBar;
use super::contact_response::{ContactResponse, Load};
use super::options::{LengthRule, Objective, Options};
use super::solve::Workspace;
use crate::case::Case;
use crate::error::SolveError;
use crate::kinematics::{
    Compliance, ComplianceUnknown, Compliances, DerivativeMethod, DrivenBy, Local, Matrix6,
};
use crate::robot::Robot;
use crate::shape::{Solution, Wrench};
use crate::stations::Stations;

/// The answer, and how the place at an arc length in m moves and, if known, yields.
///
/// # Errors
/// As [`FourBar::solve_with_derivatives`].
pub(crate) fn solve_at(
    options: &Options,
    robot: &Robot,
    case: &Case,
    arc_length: f64,
) -> Result<(Solution, Local), SolveError> {
    let options = Options { stations: Stations::At(vec![arc_length]), ..options.clone() };
    let model = FourBar::new(robot, &options)?;
    let mut workspace = Workspace::default();
    let (solution, derivatives) = model.solve_with_derivatives(case, &mut workspace)?;
    let to_base = case.base.rotation.conjugate();
    let cables = robot.cables().len();
    let local = Local {
        driven_by: vec![DrivenBy::Shortening; cables],
        actuation_jacobian: derivatives.station(0).iter().map(|t| turned(to_base, *t)).collect(),
        length_jacobian: (0..cables).map(|cable| derivatives.length(cable).to_vec()).collect(),
        compliances: match model.newtons() {
            Err(unknown) => Err(unknown),
            Ok(scale) => Ok(model.compliances(arc_length, scale, &solution, &workspace)?),
        },
        method: DerivativeMethod::Exact,
    };
    Ok((solution, local))
}

fn turned(rotation: UnitQuaternion, Twist { linear, angular }: Twist) -> Twist {
    Twist { linear: rotation.rotate(linear), angular: rotation.rotate(angular) }
}

impl FourBar {
    /// Newtons by the model's own measure of force, or why it says nothing of wrenches.
    pub(super) fn newtons(&self) -> Result<f64, ComplianceUnknown> {
        if self.options.objective != Objective::StrainEnergy {
            return Err(ComplianceUnknown::NoEnergy);
        }
        if self.options.lengths != LengthRule::Free {
            return Err(ComplianceUnknown::SharedLengths);
        }
        self.tension_scale.ok_or(ComplianceUnknown::NoStiffness)
    }

    /// How a place yields in an answer, whose joints are in the workspace.
    fn compliances(
        &self,
        arc_length: f64,
        scale: f64,
        answer: &Solution,
        workspace: &Workspace,
    ) -> Result<Compliances, SolveError> {
        let mut contact_response = ContactResponse::at(
            workspace.joints.iter().map(|joint| joint.bend()).collect(),
            answer.cables.iter().map(|c| c.tension.unwrap_or(0.0) / scale).collect(),
        );
        let (section, part) = self.locate(arc_length);
        let load = Load { section, part, wrench: Wrench::default() };
        let length = self.robot.backbone().length;
        let mut under = |lengths: &[f64]| -> Result<Compliance, SolveError> {
            let (mut entries, mut drift) = (Vec::new(), Vec::new());
            contact_response
                .linearise(&self.sections, lengths, &[])
                .map_err(|_| SolveError::NoDerivatives)?;
            contact_response.compliance(&self.sections, &[load], &mut entries, &mut drift);
            let columns = core::array::from_fn(|j| {
                let entry = |i: usize| entries[6 * i + j] / scale;
                Twist {
                    linear: [entry(0), entry(1), entry(2)].into(),
                    angular: [entry(3), entry(4), entry(5)].into(),
                }
            });
            if !columns.iter().all(|t: &Twist| t.linear.is_finite() && t.angular.is_finite()) {
                return Err(SolveError::NoDerivatives);
            }
            let compliance = Matrix6::from_columns(&columns);
            Ok(Compliance { compliance, stiffness: compliance.inverse(length) })
        };
        // A cable that may be as long as it likes keeps its tension, and so does one that is slack.
        let free = vec![f64::INFINITY; answer.cables.len()];
        let pulls = |cable: &crate::CableState| cable.tension.is_some_and(|tension| tension > 0.0);
        let held = |cable| if pulls(cable) { cable.length } else { f64::INFINITY };
        let locked: Vec<f64> = answer.cables.iter().map(held).collect();
        Ok(Compliances { tensions_held: under(&free)?, lengths_held: under(&locked)? })
    }
}
