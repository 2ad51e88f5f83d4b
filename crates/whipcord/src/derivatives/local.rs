//! All that exact derivatives say of one place.

use whipcord_numerics::Twist;

use crate::error::SolveError;
use crate::kinematics::{
    Compliance, Compliances, DerivativeMethod, DrivenBy, Local, Matrix6, OneSided,
};
use crate::statics::command::Command;
use crate::statics::hold::Hold;

/// Of a robot of this length in m whose cables, in their order, have these commands, with the Jacobians of the place and of the lengths of the cables, and
/// the compliance of the place; what is about to change, and whether the commanded lengths depend on each other.
pub(super) fn local<'a>(
    length: f64,
    commands: impl Iterator<Item = &'a Command>,
    (actuation_jacobian, length_jacobian): (Vec<Twist>, Vec<Vec<f64>>),
    compliance: impl Fn(Hold) -> Result<Matrix6, SolveError>,
    (one_sided, are_lengths_dependent): (OneSided, bool),
) -> Result<Local, SolveError> {
    let under = |hold: Hold| -> Result<Compliance, SolveError> {
        let compliance = compliance(hold)?;
        Ok(Compliance { compliance, stiffness: compliance.inverse(length) })
    };
    let driven = |command: &Command| match command {
        Command::Tension(_) => DrivenBy::Tension,
        Command::Length { .. } => DrivenBy::Shortening,
    };
    Ok(Local {
        driven_by: commands.map(driven).collect(),
        actuation_jacobian,
        length_jacobian,
        compliances: Ok(Compliances {
            tensions_held: under(Hold::Tensions)?,
            lengths_held: under(Hold::Lengths)?,
        }),
        method: DerivativeMethod::Exact,
        one_sided,
        are_lengths_dependent,
    })
}
