//! Answers with their derivatives, of any model that has them.

use crate::case::Case;
use crate::derivatives::Derivatives;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::model::{Model, Prepared};
use crate::parameter::Parameter;
use crate::robot::{Cable, Robot};
use crate::shape::Solution;

impl Model {
    /// Whether it differentiates its answers exactly by commands, loads and parameters
    /// ([`Prepared::solve_with_derivatives`]).
    #[must_use]
    pub fn has_derivatives(&self, robot: &Robot) -> bool {
        let slides = || !robot.cables().iter().any(Cable::has_friction);
        match self {
            Self::Cosserat(_) => true,
            Self::CosseratDisks(_) => slides(),
            Self::FourBar(_)
            | Self::ConstantCurvature(_)
            | Self::PiecewiseConstantCurvature(_)
            | Self::PseudoRigidBody(_) => false,
        }
    }
}

impl Prepared {
    /// The answer to the last step of a case, with its derivatives by tensions or lengths, by loads at any place, and by these
    /// parameters; from a neighbouring solution when given.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`SolveError::Unsupported`] where the model has no exact derivatives
    /// ([`Model::has_derivatives`]), [`SolveError::Invalid`] for a parameter that robot and case do not have,
    /// and [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub fn solve_with_derivatives(
        &mut self,
        case: &Case,
        warm_start: Option<&Solution>,
        parameters: &[Parameter],
    ) -> Result<(Solution, Derivatives), SolveError> {
        let unsupported = |model: ModelKind| SolveError::Unsupported {
            model,
            path: "a request for derivatives by loads and parameters".to_owned(),
            what: "it has derivatives by the commands alone",
            advice: "use cosserat or cosserat-disks, or differences of answers",
        };
        match self {
            Self::Cosserat(model, workspace) => {
                model.solve_with_derivatives(case, warm_start, parameters, workspace)
            }
            Self::CosseratDisks(model, workspace) => {
                model.solve_with_derivatives(case, warm_start, parameters, workspace)
            }
            Self::FourBar(..) => Err(unsupported(ModelKind::FourBar)),
            Self::ConstantCurvature(..) => Err(unsupported(ModelKind::ConstantCurvature)),
            Self::Linkage(model, _) => Err(unsupported(model.kind())),
        }
    }
}
