//! What is to be reached and its limits, as tables of a file.

use whipcord::Shortening;
use whipcord_inverse::{Preference, Target};

use super::describe::shortening;
use super::design::describe_design;
use super::{Item, Table};
use crate::read::{CableBounds, Clearance, Goal};
use crate::units::Dimension;

/// Adds the tables `[target]`, `[limits]`, `[prefer]` and `[design]` to a file, and the limits of its cables: read again, it says the same. A shape or a path is
/// told by the name of its file.
pub fn describe_goal(goal: &Goal, file: &mut Table) {
    if let Some((_, Item::List(cables))) =
        file.entries.iter_mut().find(|(name, _)| name == "cables")
    {
        for (cable, own) in cables.iter_mut().zip(&goal.own) {
            if let Item::Table(cable) = cable {
                insert(cable, own, ["tension_limits", "shortening_limits", "rate_limit"]);
            }
        }
    }
    let mut target = Table::default();
    let table = goal.table.as_ref().map(|path| path.display().to_string());
    match &goal.target {
        Some(Target::Tip(point)) => target.insert("tip", *point),
        Some(Target::Pose(pose)) => {
            let mut table = Table::default();
            table.insert("position", pose.position);
            // What is not turned says so, too.
            table.insert("orientation", pose.rotation.wxyz());
            target.insert("pose", table);
        }
        Some(Target::Axis { point, direction }) => {
            target.insert_some("tip", *point);
            target.insert("axis", *direction);
        }
        Some(Target::Shape(_)) => target.insert_some("shape", table.as_deref()),
        None if !goal.path.is_empty() => target.insert_some("path", table.as_deref()),
        None => {}
    }
    if !target.is_empty() {
        target.insert_some("tolerance", goal.tolerance);
        target.insert_some("tolerance_angle", goal.tolerance_angle);
        file.insert("target", target);
    }
    let mut limits = Table::default();
    insert(&mut limits, &goal.all, ["tension", "shortening", "rate"]);
    if !limits.is_empty() {
        file.insert("limits", limits);
    }
    let mut prefer = Table::default();
    prefer.insert_some(
        "least",
        goal.preference.and_then(|preference| match preference {
            Preference::LeastTension => Some("tension"),
            Preference::LeastChange => Some("change"),
            Preference::MostClearance => Some("clearance"),
            Preference::First => None,
        }),
    );
    match goal.clearance {
        Some(Clearance::Touch) => prefer.insert("clearance", "touch"),
        Some(Clearance::Least(least)) => prefer.insert("clearance", least),
        None => {}
    }
    if !prefer.is_empty() {
        file.insert("prefer", prefer);
    }
    describe_design(&goal.design, file);
}

fn insert(table: &mut Table, bounds: &CableBounds, [tension, shortened, rate]: [&str; 3]) {
    table.insert_some(tension, bounds.tension);
    let pair = |pair: [Shortening; 2]| Item::List(pair.map(shortening).to_vec());
    table.insert_some(shortened, bounds.shortening.map(pair));
    table.insert_some(
        rate,
        bounds.rate.map(|(rate, dimension)| match dimension {
            Dimension::ForceRate => Item::Text(format!("{rate:?} N/s")),
            _ => Item::Number(rate),
        }),
    );
}
