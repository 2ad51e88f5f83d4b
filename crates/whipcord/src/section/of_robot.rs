//! The cross-sections of a robot: from its material and shape, or from the stiffness that its file gives.

use whipcord_numerics::{Mat3, Vec3};

use super::bending_friction::{BENDING_AXES, BendingFriction};
use super::properties::{Coupling, Section, Stiffness};
use super::tangent::Hessian;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::{self, Robot, StiffnessMatrix};

/// Stiffness and rest curvature at one end or inside of a piece of the backbone in which nothing
/// jumps; `inside` lies between its ends.
pub(crate) fn section_at(robot: &Robot, s: f64, inside: f64) -> Result<Section, SolveError> {
    let backbone = robot.backbone();
    let rest_curvature = backbone.rest_curvature.at_end(robot.disks(), s, inside);
    let (mut stiffness, coupling) = match &backbone.stiffness {
        Some(given) => split(&given.at_end(robot.disks(), s, inside)),
        None => (of_material(robot, s, inside)?, None),
    };
    if let Some((_, segment)) = backbone.segment_at(inside) {
        let Stiffness { shear, bending } = &mut stiffness;
        let [ga, ea, ei, gj] = segment.stiffness_factors();
        *shear = shear.scale(Vec3::new(ga, ga, ea));
        *bending = bending.scale(Vec3::new(ei, ei, gj));
    }
    if !backbone.shearable {
        (stiffness.shear.x, stiffness.shear.y) = (f64::INFINITY, f64::INFINITY);
    }
    if !backbone.extensible {
        stiffness.shear.z = f64::INFINITY;
    }
    let mut section = Section::new(stiffness, rest_curvature);
    if let Some(coupling) = coupling {
        section = section.coupled(coupling);
    }
    if let Some(given) = &backbone.bending_friction {
        let ratio = robot::BendingFriction::STIFFNESS_RATIO;
        let elastic = [ratio * stiffness.bending.x, ratio * stiffness.bending.y];
        section = section.with_friction(BendingFriction {
            limit: given.yield_moment,
            stiffness: given.yield_stiffness.unwrap_or(elastic),
            plastic: [0.0; BENDING_AXES],
        });
    }
    Ok(section)
}

/// Stiffness of the first cross-section that follows from section and material, without the factors of segments.
///
/// # Errors
/// [`SolveError::Missing`] where section, Young's modulus or shear modulus is not given.
pub fn material_stiffness(robot: &Robot) -> Result<robot::Stiffness, SolveError> {
    let Stiffness { shear, bending } = of_material(robot, 0.0, 0.0)?;
    Ok(robot::Stiffness::diagonal([shear.x, shear.y], shear.z, [bending.x, bending.y], bending.z))
}

/// Stiffness matrix at one end or inside of a piece of the backbone in which nothing jumps; `inside`, an arc length in m as well, lies
/// between its ends. The diagonal is infinite on an axis of a backbone that does not shear or stretch.
///
/// # Errors
/// [`SolveError::Missing`] where the stiffness is not given and section, Young's modulus or shear modulus is not either.
pub fn section_stiffness(
    robot: &Robot,
    arc_length: f64,
    inside: f64,
) -> Result<StiffnessMatrix, SolveError> {
    let section = section_at(robot, arc_length, inside)?;
    let (forces, moments) = (section.pivots(), section.stiffness.bending);
    let coupling = section.coupling().copied().unwrap_or_default();
    Ok(core::array::from_fn(|i| {
        core::array::from_fn(|j| match (i < 3, j < 3) {
            (true, true) if i == j => forces[i],
            (false, false) if i == j => moments[i - 3],
            (true, true) => coupling.shear.rows[i][j],
            (true, false) => coupling.mixed.rows[i][j - 3],
            (false, true) => coupling.mixed.rows[j][i - 3],
            (false, false) => coupling.bending.rows[i - 3][j - 3],
        })
    }))
}

/// Compliance of a cross-section without cables at an arc length in m: `∂v/∂N`, `∂v/∂M` and `∂u/∂M` in the frame of the section, zero
/// for an axis that is held. `None` where the stiffness is not given or has no inverse.
#[must_use]
pub fn section_compliance(robot: &Robot, arc_length: f64) -> Option<[Mat3; 3]> {
    let section = section_at(robot, arc_length, arc_length).ok()?;
    Hessian::elastic(&section).factor().map(|tangent| tangent.compliance())
}

/// Stiffness that follows from section and material.
fn of_material(robot: &Robot, s: f64, inside: f64) -> Result<Stiffness, SolveError> {
    let missing = |path: &str, advice| SolveError::Missing {
        model: ModelKind::Cosserat,
        path: format!("backbone.{path}"),
        advice,
    };
    let backbone = robot.backbone();
    let section = backbone.section.as_ref().ok_or_else(|| {
        missing("diameter", "give the backbone's cross-section or stiffness, or use four-bar")
    })?;
    let young = backbone.material.young_modulus.ok_or_else(|| {
        missing(
            "young_modulus",
            "give the backbone's `material` or Young's modulus, or use four-bar",
        )
    })?;
    let shear = backbone.material.shear_modulus().ok_or_else(|| {
        missing("poisson_ratio", "give `poisson_ratio` or `shear_modulus`, or use four-bar")
    })?;
    let area = section.at_end(robot.disks(), s, inside);
    let across = backbone.shear_correction * shear * area.area;
    Ok(Stiffness {
        shear: Vec3::new(across, across, young * area.area),
        bending: Vec3::new(
            young * area.second_moment_x,
            young * area.second_moment_y,
            shear * area.torsion_constant,
        ),
    })
}

/// The diagonal of a stiffness matrix, and what is beside it where there is anything.
fn split(k: &StiffnessMatrix) -> (Stiffness, Option<Coupling>) {
    let diagonal = |i: usize| Vec3::new(k[i][i], k[i + 1][i + 1], k[i + 2][i + 2]);
    // What differs by rounding across the diagonal is made equal.
    let entry = |i: usize, j: usize| if i == j { 0.0 } else { 0.5 * (k[i][j] + k[j][i]) };
    let block = |row: usize, column: usize| {
        let row_of = |i| {
            let at = |j| entry(row + i, column + j);
            Vec3::new(at(0), at(1), at(2))
        };
        Mat3::from_rows(row_of(0), row_of(1), row_of(2))
    };
    let coupling = Coupling { shear: block(0, 0), mixed: block(0, 3), bending: block(3, 3) };
    let any = coupling != Coupling::default();
    (Stiffness { shear: diagonal(0), bending: diagonal(3) }, any.then_some(coupling))
}
