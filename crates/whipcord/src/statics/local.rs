//! Jacobians and compliances of a place, from how it and the lengths of the cables move at held tensions.

use whipcord_numerics::Twist;

use super::command::Command;
use super::hold::{HeldCables, Hold};
use crate::error::SolveError;
use crate::kinematics::{
    Compliance, ComplianceUnknown, Compliances, DerivativeMethod, DrivenBy, Local, Matrix6,
    OneSided,
};

/// How a place moves with one number, in the frame of the base, and how the lengths of the cables do, in m.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub twist: Twist,
    pub lengths: Vec<f64>,
}

/// All that is to be said of a place, from exact derivatives by the tension of each cable and by the components of a wrench on the
/// place, or why these are not known. Of each cable it is asked whether it is taut, and what a tension of 1 N adds to
/// its length in m; `length` is that of the backbone.
pub(crate) fn local_of(
    commands: &[Command],
    (is_taut, compliance): (impl Fn(usize) -> bool, impl Fn(usize) -> f64),
    by_tension: &[Column],
    by_wrench: Result<&[Column], ComplianceUnknown>,
    length: f64,
) -> Result<Local, SolveError> {
    let cables = commands.len();
    let driven_by: Vec<DrivenBy> = commands.iter().map(driven_by).collect();
    let mut held = HeldCables::new(
        cables,
        |i, j| by_tension[j].lengths[i],
        compliance,
        is_taut,
        |i| driven_by[i] == DrivenBy::Shortening,
    )
    .map_err(|_| SolveError::NoDerivatives)?;
    held.settle(0.0);
    // The motion that goes with changes of the tensions.
    let pulled = |tensions: &[f64]| {
        by_tension
            .iter()
            .zip(tensions)
            .fold(Twist::default(), |sum, (column, tension)| sum + column.twist * *tension)
    };
    let opposite = |lengths: &[f64]| lengths.iter().map(|x| -x).collect::<Vec<f64>>();
    let yielding = |by_wrench: &[Column], hold: Hold| {
        let columns = core::array::from_fn(|i| {
            let tensions = held.tensions(hold, &opposite(&by_wrench[i].lengths));
            by_wrench[i].twist + pulled(&tensions)
        });
        let compliance = Matrix6::from_columns(&columns);
        let finite = columns.iter().all(|c| c.linear.is_finite() && c.angular.is_finite());
        let stiffness = compliance.inverse(length);
        if finite {
            Ok(Compliance { compliance, stiffness })
        } else {
            Err(SolveError::NoDerivatives)
        }
    };
    let compliances = match by_wrench {
        Ok(columns) => Ok(Compliances {
            tensions_held: yielding(columns, Hold::Tensions)?,
            lengths_held: yielding(columns, Hold::Lengths)?,
        }),
        Err(unknown) => Err(unknown),
    };
    let command = |cable: usize| match driven_by[cable] {
        DrivenBy::Tension => {
            let mut tensions = held.tensions(Hold::Commands, &opposite(&by_tension[cable].lengths));
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
    let change = |i: usize, tensions: &Vec<f64>| {
        by_tension.iter().zip(tensions).map(|(column, tension)| column.lengths[i] * tension).sum()
    };
    Ok(Local {
        actuation_jacobian: by_command.iter().map(|tensions| pulled(tensions)).collect(),
        length_jacobian: (0..cables)
            .map(|i| by_command.iter().map(|tensions| change(i, tensions)).collect())
            .collect(),
        compliances,
        driven_by,
        method: DerivativeMethod::Exact,
        one_sided: OneSided::default(),
        are_lengths_dependent: held.are_dependent(Hold::Commands),
    })
}

const fn driven_by(command: &Command) -> DrivenBy {
    match command {
        Command::Tension(_) => DrivenBy::Tension,
        Command::Length { .. } => DrivenBy::Shortening,
    }
}
