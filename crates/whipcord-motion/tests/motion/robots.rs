//! Robots that several tests move.

use whipcord::{Backbone, Cable, Disks, Material, Robot, Routing, Section};
use whipcord_motion::Course;

/// A round rod without disks.
pub fn rod(
    length: f64,
    diameter: f64,
    young: f64,
    poisson: f64,
    density: f64,
    cables: Vec<Cable>,
) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(young),
            poisson_ratio: Some(poisson),
            density: Some(density),
            ..Material::default()
        },
        ..Backbone::new(length)
    };
    Robot::new(backbone, Disks::none(length), cables).unwrap()
}

/// A cable parallel to the backbone.
pub fn straight(name: &str, angle: f64, radius: f64) -> Cable {
    Cable::new(name, Routing::Straight { angle, radius })
}

/// The paper's robot with disks of 1 g and these cables.
pub fn paper(cables: Vec<Cable>) -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            density: Some(1040.0),
            ..Material::default()
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks {
        mass: 1e-3,
        outer_radius: Some(0.01),
        thickness: Some(1e-3),
        ..Disks::equally_spaced(0.18, 11, 0.008)
    };
    Robot::new(backbone, disks, cables).unwrap()
}

/// A cable on a helix of half a turn.
pub fn helix() -> Cable {
    Cable::new("helix", Routing::Helix { start_angle: 0.0, turns: 0.5, radius: 0.008 })
}

/// From zero to each value in this time in s, with a rest behind each.
pub fn ramps(ramp: f64, rest: f64, values: &[f64]) -> Course {
    let (mut times, mut rows) = (vec![0.0], vec![0.0]);
    for (k, value) in values.iter().enumerate() {
        let start = (ramp + rest) * k as f64;
        times.extend([start + ramp, start + ramp + rest]);
        rows.extend([*value, *value]);
    }
    Course::table(times, rows).unwrap()
}
