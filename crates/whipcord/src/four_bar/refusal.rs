//! What the model cannot take, by name.

use whipcord_numerics::Pose;

use super::equilibrium::knows_stiffness;
use super::options::{Chord, LengthRule, Objective, Options};
use super::section;
use crate::case::{Actuation, Case, Loads};
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::refusal;
use crate::robot::{Robot, Stiffness};

const NO_FORCES: &str = "it takes no forces without a strain energy: take the objective strain-energy with the length rule free, or use cosserat";
const NO_STIFFNESS: &str = "it takes no forces without a stiffness: give section and young_modulus, or stiffness, or leave it out";
const GIVE_SHORTENING: &str = "it is driven by lengths without a strain energy: give each cable's shortening, or take the objective strain-energy with the length rule free, or use cosserat";

pub(super) fn unsupported(
    path: impl Into<String>,
    what: &'static str,
    advice: &'static str,
) -> SolveError {
    SolveError::Unsupported { model: ModelKind::FourBar, path: path.into(), what, advice }
}

/// Why forces are not taken.
fn no_forces(options: &Options) -> &'static str {
    if options.has_energy() { NO_STIFFNESS } else { NO_FORCES }
}

/// Why tensions are not taken.
fn give_shortening(options: &Options) -> &'static str {
    if options.has_energy() { NO_STIFFNESS } else { GIVE_SHORTENING }
}

/// Refuses a robot or options.
pub(super) fn robot(robot: &Robot, options: &Options) -> Result<(), SolveError> {
    let knows_forces = options.has_energy() && matches!(knows_stiffness(robot), Ok(true));
    refusal::without_disks(ModelKind::FourBar, robot)?;
    if options.actuation == Actuation::Tension && !knows_forces {
        return Err(unsupported("actuation", "tension", give_shortening(options)));
    }
    if options.objective == Objective::StrainEnergy
        && robot.backbone().stiffness.as_ref().is_some_and(Stiffness::is_coupled)
    {
        return Err(unsupported(
            "backbone.stiffness.matrix",
            "strains that are coupled",
            "its strain energy is that of bending about x and y and of twist, each by itself: take the objective coupler-angle, or use cosserat",
        ));
    }
    for (i, cable) in robot.cables().iter().enumerate() {
        if let (Some(path), false) = (robot.path_of_stretch(i), knows_forces) {
            return Err(unsupported(path, "a cable or drive that stretches", no_forces(options)));
        }
        if options.lengths == LengthRule::Free && !options.has_energy() && cable.has_friction() {
            return Err(unsupported(
                format!("cables[{i}].friction"),
                "friction on a cable that slides freely, without forces",
                "take the objective strain-energy, or the length rule proportional or equal, where friction changes no length",
            ));
        }
    }
    if options.objective == Objective::AsPrinted {
        as_printed(robot, options)?;
    }
    if knows_forces {
        return Ok(());
    }
    refusal::bending_friction(
        ModelKind::FourBar,
        robot,
        "friction against bending of the backbone, without forces",
        "give the stiffness of the backbone and take the objective strain-energy and the length rule free",
    )
}

fn as_printed(robot: &Robot, options: &Options) -> Result<(), SolveError> {
    if !robot.backbone().rest_curvature.is_zero() {
        return Err(unsupported(
            "backbone.rest_curvature",
            "a pre-bent backbone with the objective as-printed",
            "the printed equations are those of a straight one: take coupler-angle",
        ));
    }
    if let Some(i) = section::endings(robot).iter().position(|ending| ending.part > 0.0) {
        return Err(unsupported(
            format!("cables[{i}].ends_at"),
            "a cable that ends between two disks with the objective as-printed",
            "let it end at a disk, or take coupler-angle",
        ));
    }
    if robot.cables().len() > 1 {
        return Err(unsupported(
            "cables[1]",
            "a second cable with the objective as-printed",
            "the printed equations are those of one cable: take coupler-angle",
        ));
    }
    if options.lengths == LengthRule::Free {
        return Err(unsupported(
            "the length rule free",
            "with the objective as-printed",
            "the printed equations take the length in each section as given: take proportional or equal",
        ));
    }
    if options.chord == Chord::Arc {
        return Err(unsupported(
            "the chord arc",
            "with the objective as-printed",
            "the printed equations have a rigid link: take bisector",
        ));
    }
    Ok(())
}

/// Refuses a case; of one that gives more than lengths and obstacles where forces are not taken.
pub(super) fn case(
    robot: &Robot,
    options: &Options,
    case: &Case,
    takes_forces: bool,
) -> Result<(), SolveError> {
    let plausible = |command: &crate::case::CableCommand| {
        command.tension.is_none_or(|t| t >= 0.0 && t.is_finite())
            && command.shortening.is_none_or(|s| s.in_metres(1.0).abs() < 1.0)
    };
    let plain = case.loads == Loads::default() && case.base == Pose::IDENTITY;
    // The full check builds the path of every quantity: too slow where all is well.
    let fits = case.commands.len() == robot.cables().len() && case.commands.iter().all(plausible);
    if !plain || !fits {
        case.check(robot)?;
    }
    if takes_forces {
        return Ok(());
    }
    if !case.obstacles.is_empty() && !options.has_energy() {
        return Err(unsupported(
            "obstacles",
            "only lengths and no energy decide where it bends",
            "take the objective strain-energy and the length rule free, or use cosserat",
        ));
    }
    if let Some((path, what)) = case.loads.first() {
        return Err(unsupported(path, what, no_forces(options)));
    }
    for (i, command) in case.commands.iter().enumerate() {
        if command.shortening.is_none() {
            return Err(SolveError::Missing {
                model: ModelKind::FourBar,
                path: format!("cables[{i}].shortening"),
                advice: give_shortening(options),
            });
        }
    }
    Ok(())
}
