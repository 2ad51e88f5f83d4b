//! What a file is to reach, within which limits, in words.

use whipcord::{Shortening, UnitQuaternion, Vec3};
use whipcord_inverse::{Preference, Target};
use whipcord_io::{CableBounds, CaseFile, Clearance};
use whipcord_study::quantity::{
    degrees, fixed_millimetres, millimetres, newtons, number, shortening,
};

/// Target, limits and preference of a file: the name of each and what it says.
pub fn describe(file: &CaseFile) -> Vec<(String, String)> {
    let goal = &file.goal;
    let mut lines = Vec::new();
    let mut aim = goal.target.as_ref().map(target);
    if let [first, .., last] = goal.path.as_slice() {
        let (count, from, to) = (goal.path.len(), first.time, last.time);
        let times = format!("from {} s to {} s", number(from, 6), number(to, 6));
        aim = Some(format!("a path of {count} points, {times}"));
    }
    if let Some(aim) = aim {
        let mut parts = vec![aim];
        parts.extend(goal.tolerance.map(|far| format!("within {}", millimetres(far))));
        parts.extend(goal.tolerance_angle.map(|far| format!("within {}", degrees(far))));
        lines.push(("target".to_owned(), parts.join(", ")));
    }
    lines.extend(bounds(&goal.all).map(|words| ("limits".to_owned(), words)));
    for (cable, own) in file.robot.cables().iter().zip(&goal.own) {
        lines.extend(bounds(own).map(|words| (format!("limits {}", cable.name), words)));
    }
    let least = goal.preference.map(|preference| {
        let what = match preference {
            Preference::LeastTension => "the least tension",
            Preference::LeastChange => "the least change of the commands",
            Preference::MostClearance => "the most clearance from obstacles",
            Preference::First => "the first that is found",
        };
        what.to_owned()
    });
    let clearance = goal.clearance.map(|clearance| match clearance {
        Clearance::Touch => "obstacles may be touched".to_owned(),
        Clearance::Least(least) => format!("{} from obstacles", millimetres(least)),
    });
    let preferred: Vec<String> = least.into_iter().chain(clearance).collect();
    if !preferred.is_empty() {
        lines.push(("prefer".to_owned(), preferred.join(", ")));
    }
    lines
}

fn bounds(of: &CableBounds) -> Option<String> {
    let between = |words: fn(f64) -> String, what: &str, [least, greatest]: [f64; 2]| {
        format!("{what} {} to {}", words(least), words(greatest))
    };
    let mut parts = Vec::new();
    parts.extend(of.tension.map(|limits| between(newtons, "tension", limits)));
    parts.extend(of.shortening.map(|[least, greatest]: [Shortening; 2]| {
        format!("shortening {} to {}", shortening(least), shortening(greatest))
    }));
    parts.extend(of.rate.map(|(rate, dimension)| match dimension {
        whipcord_io::Dimension::ForceRate => format!("at most {} a second", newtons(rate)),
        _ => format!("at most {} a second", millimetres(rate)),
    }));
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// A place in mm.
pub fn point(at: Vec3) -> String {
    let [x, y, z] = at.to_array().map(|c| fixed_millimetres(c, 3));
    format!("({x}, {y}, {z}) mm")
}

/// What is to be reached.
pub fn target(target: &Target) -> String {
    let along = |direction: Vec3| {
        let [x, y, z] = (direction * (1.0 / direction.norm())).to_array().map(|c| number(c, 4));
        format!("along ({x}, {y}, {z})")
    };
    match target {
        Target::Tip(at) => format!("tip at {}", point(*at)),
        Target::Pose(pose) => {
            let wxyz = pose.rotation.wxyz().map(|c| number(c, 4)).join(", ");
            let turned = match pose.rotation == UnitQuaternion::IDENTITY {
                true => "not turned".to_owned(),
                false => format!("orientation ({wxyz})"),
            };
            format!("tip at {}, {turned}", point(pose.position))
        }
        Target::Axis { point: None, direction } => format!("axis {}", along(*direction)),
        Target::Axis { point: Some(at), direction } => {
            format!("tip at {}, axis {}", point(*at), along(*direction))
        }
        Target::Shape(points) => match points.len() {
            1 => "1 disk".to_owned(),
            count => format!("{count} disks"),
        },
    }
}
