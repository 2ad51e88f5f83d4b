//! How a place moves with the lengths, eq. (12), where no energy decides on the shape.

use whipcord_numerics::{Twist, UnitQuaternion};

use super::model::FourBar;
use super::options::{LengthRule, Objective, Options};
use super::workspace::Workspace;
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::kinematics::{ComplianceUnknown, DerivativeMethod, DrivenBy, Local, OneSided};
use crate::robot::Robot;
use crate::solution::Solution;
use crate::stations::Stations;

/// The answer, and how the place at an arc length in m moves.
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
        compliances: Err(model.no_compliance()),
        method: DerivativeMethod::Exact,
        one_sided: OneSided::default(),
        are_lengths_dependent: false,
    };
    Ok((solution, local))
}

fn turned(rotation: UnitQuaternion, Twist { linear, angular }: Twist) -> Twist {
    Twist { linear: rotation.rotate(linear), angular: rotation.rotate(angular) }
}

impl FourBar {
    /// Why it says nothing of wrenches, where it does not.
    fn no_compliance(&self) -> ComplianceUnknown {
        if self.options.objective != Objective::StrainEnergy {
            return ComplianceUnknown::NoEnergy;
        }
        if self.options.lengths != LengthRule::Free {
            return ComplianceUnknown::SharedLengths;
        }
        ComplianceUnknown::NoStiffness
    }

    /// Refuses derivatives by loads and parameters where it has none.
    pub(super) fn no_linearization(&self) -> SolveError {
        let unknown = self.no_compliance();
        SolveError::Unsupported {
            model: ModelKind::FourBar,
            path: "a request for derivatives by loads and parameters".to_owned(),
            what: unknown.reason(),
            advice: unknown.advice(),
        }
    }
}
