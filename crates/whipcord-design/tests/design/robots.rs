//! Robots and random numbers.

use whipcord::{Backbone, Cable, Disks, Material, Robot, Routing, Section};

pub const LENGTH: f64 = 0.18;

pub fn backbone(length: f64) -> Backbone {
    let material = Material {
        young_modulus: Some(1.1e9),
        poisson_ratio: Some(0.3),
        density: Some(1100.0),
        ..Material::default()
    };
    Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(length) }
}

/// Ten disks and straight cables in these directions, at this distance from the axis.
pub fn straight(angles: &[f64], radius: f64) -> Robot {
    let cable = |(k, angle): (usize, &f64)| {
        Cable::new(format!("c{k}"), Routing::Straight { angle: *angle, radius })
    };
    let cables = angles.iter().enumerate().map(cable).collect();
    Robot::new(backbone(LENGTH), Disks::equally_spaced(LENGTH, 10, 0.008), cables).unwrap()
}

pub fn holed(length: f64, disks: usize, holes: usize, cables: usize) -> Robot {
    let cable = |k: usize| Cable::new(format!("c{k}"), Routing::holes(vec![1 + k; disks]));
    let plates = Disks::equally_spaced(length, disks, 0.008).with_holes(holes);
    Robot::new(backbone(length), plates, (0..cables).map(cable).collect()).unwrap()
}

/// The same robot with other holes.
pub fn with_holes(robot: &Robot, lists: &[Vec<usize>]) -> Robot {
    let mut cables = robot.cables().to_vec();
    for (cable, list) in cables.iter_mut().zip(lists) {
        cable.routing = Routing::holes(list.clone());
    }
    Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
}

/// Pseudo-random numbers in 0 … 1 (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}
