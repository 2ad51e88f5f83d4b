use whipcord::{Loads, PointLoad, Vec3};

use super::vec3;
use crate::check::Fields;

/// `[loads]`.
pub(crate) fn loads(fields: &Fields) -> Loads {
    let or_none = |fields: &Fields, name: &str| vec3(fields, name).unwrap_or(Vec3::ZERO);
    let point = |fields: &Fields| {
        Some(PointLoad {
            at: fields.number("at")?,
            force: or_none(fields, "force"),
            moment: or_none(fields, "moment"),
            follower: fields.flag("follower"),
        })
    };
    Loads {
        gravity: vec3(fields, "gravity"),
        tip_force: or_none(fields, "tip_force"),
        tip_moment: or_none(fields, "tip_moment"),
        tip_follower: fields.flag("follower"),
        points: fields.tables("point").iter().filter_map(point).collect(),
    }
}
