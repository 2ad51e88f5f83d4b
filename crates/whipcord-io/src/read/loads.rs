use whipcord::{DistributedLoad, LoadFrame, Loads, PointLoad, PointMass, Profile, Vec3};

use super::{vec3, vector};
use crate::check::Fields;

/// `[loads]` of a robot whose backbone has this length.
pub(crate) fn loads(fields: &Fields, length: f64) -> Loads {
    let or_none = |fields: &Fields, name: &str| vec3(fields, name).unwrap_or(Vec3::ZERO);
    let point = |fields: &Fields| {
        Some(PointLoad {
            at: fields.number("at")?,
            force: or_none(fields, "force"),
            moment: or_none(fields, "moment"),
            follower: fields.flag("follower"),
        })
    };
    let mass = |fields: &Fields| {
        Some(PointMass { at: fields.number("at")?, mass: fields.number("mass")? })
    };
    let spread = |fields: &Fields| DistributedLoad {
        profile: profile(fields, length),
        follower: fields.flag("follower"),
    };
    Loads {
        frame: match fields.text("frame") {
            Some("world") => LoadFrame::World,
            _ => LoadFrame::Base,
        },
        gravity: vec3(fields, "gravity"),
        tip_force: or_none(fields, "tip_force"),
        tip_moment: or_none(fields, "tip_moment"),
        tip_follower: fields.flag("follower"),
        points: fields.tables("point").iter().filter_map(point).collect(),
        distributed: fields.tables("distributed").iter().map(spread).collect(),
        masses: fields.tables("mass").iter().filter_map(mass).collect(),
    }
}

/// Lists go with `at`; a single vector beside them is the same at every station.
fn profile(fields: &Fields, length: f64) -> Profile {
    let is_list = |name: &str| {
        fields.list(name).is_some_and(|list| list.iter().any(|item| item.as_list().is_some()))
    };
    let at = fields.numbers("at");
    if at.is_none() && !is_list("force") && !is_list("moment") {
        let vector = |name| vec3(fields, name).unwrap_or(Vec3::ZERO);
        return Profile::Constant {
            from: fields.number("from").unwrap_or(0.0),
            to: fields.number("to").unwrap_or(length),
            force: vector("force"),
            moment: vector("moment"),
        };
    }
    // Lists without stations: the library says how many it misses.
    let at = at.unwrap_or_default();
    let values = |name| match vec3(fields, name) {
        Some(one) => vec![one; at.len()],
        None => fields.list(name).unwrap_or_default().iter().filter_map(vector).collect(),
    };
    Profile::Linear { force: values("force"), moment: values("moment"), at }
}
