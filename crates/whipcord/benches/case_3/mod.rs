//! The paper's case III, and a load for it.

use whipcord::{Along, Backbone, Cable, Disks, Loads, Material, Robot, Routing, Section, Vec3};

/// The weight of 400 g, in N.
pub const TENSION: f64 = 0.4 * 9.80665;

/// The robot.
pub fn robot() -> Robot {
    let backbone = Backbone {
        section: Some(Section::circle(0.003)),
        material: Material {
            name: None,
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            shear_modulus: None,
            density: Some(1040.0),
            yield_strain: None,
        },
        ..Backbone::new(0.18)
    };
    let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
    let cable = Cable::new("pull", Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]));
    Robot::new(backbone, disks, vec![cable]).unwrap()
}

/// The robot with a rod that gets thinner from disk to disk.
#[allow(dead_code, reason = "not every benchmark needs it")]
pub fn tapered() -> Robot {
    let robot = robot();
    let diameters = (0..10).map(|disk| 0.003 - 5e-5 * f64::from(disk)).collect();
    let (outer, inner) = (Along::PerDisk(diameters), Along::Uniform(0.0));
    let backbone =
        Backbone { section: Some(Section::Round { outer, inner }), ..robot.backbone().clone() };
    Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap()
}

/// Gravity, and a wrench at the tip.
pub fn loads() -> Loads {
    Loads {
        gravity: Some(Vec3::new(0.0, 0.0, -9.80665)),
        tip_force: Vec3::new(0.05, 0.0, 0.02),
        tip_moment: Vec3::new(0.0, 1e-3, 5e-4),
        ..Loads::default()
    }
}
