use whipcord::{Pose, UnitQuaternion, Vec3};

use super::vec3;
use crate::check::Fields;

/// The pose that `[base]` or an obstacle gives.
///
/// # Errors
/// The path in it of a direction that is zero.
pub(crate) fn pose(fields: &Fields) -> Result<Pose, &'static str> {
    let position = vec3(fields, "position").unwrap_or(Vec3::ZERO);
    let rotation = if let Some(wxyz) = fields.vector("orientation") {
        UnitQuaternion::from_wxyz(wxyz).ok_or("orientation")?
    } else if let Some(turn) = fields.table("rotation") {
        let axis = vec3(turn, "axis").unwrap_or(Vec3::ZERO);
        let norm = axis.norm();
        if norm == 0.0 {
            return Err("rotation.axis");
        }
        UnitQuaternion::exp(axis * (turn.number("angle").unwrap_or(0.0) / norm))
    } else {
        UnitQuaternion::IDENTITY
    };
    Ok(Pose { position, rotation })
}
