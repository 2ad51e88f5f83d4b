//! Robots of several kinds.

use whipcord::{
    Along, Backbone, Cable, Disks, Loads, Material, Motor, Robot, Routing, Section, Vec3,
};

pub const LENGTH: f64 = 0.18;

/// A force on the tip.
pub fn load() -> Loads {
    Loads { tip_force: Vec3::new(0.1, -0.05, -0.05), ..Loads::default() }
}

pub fn backbone(diameter: f64) -> Backbone {
    let material =
        Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Material::default() };
    Backbone { section: Some(Section::circle(diameter)), material, ..Backbone::new(LENGTH) }
}

pub fn disks() -> Disks {
    Disks::equally_spaced(LENGTH, 10, 0.008).with_holes(12)
}

pub fn straight(name: &str, degrees: f64, ends_at: Option<f64>) -> Cable {
    let angle = degrees.to_radians();
    Cable { ends_at, ..Cable::new(name, Routing::Straight { angle, radius: 0.008 }) }
}

pub fn helix(name: &str, degrees: f64, turns: f64) -> Cable {
    let routing = Routing::Helix { start_angle: degrees.to_radians(), turns, radius: 0.008 };
    Cable::new(name, routing)
}

fn converging(name: &str, degrees: f64) -> Cable {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let at = |radius: f64| [radius * cos, radius * sin];
    Cable::new(name, Routing::Linear { start: at(0.008), end: at(0.003) })
}

pub fn holes(name: &str, holes: [usize; 10]) -> Cable {
    Cable::new(name, Routing::holes(holes.to_vec()))
}

pub fn robot(cables: Vec<Cable>) -> Robot {
    Robot::new(backbone(0.003), disks(), cables).unwrap()
}

pub fn three_straight() -> Robot {
    robot((0..3).map(|k| straight(&format!("s{k}"), 120.0 * f64::from(k), None)).collect())
}

pub fn two_segments() -> Robot {
    robot(
        (0..6)
            .map(|k| {
                let turn = if k < 3 { 0.0 } else { 60.0 };
                let ends_at = if k < 3 { Some(0.1) } else { None };
                straight(&format!("s{k}"), 120.0 * f64::from(k % 3) + turn, ends_at)
            })
            .collect(),
    )
}

/// Two motors, each with two opposite cables behind soft drives.
pub fn with_motors() -> Robot {
    let cables =
        (0..4).map(|k| straight(&format!("s{k}"), 90.0 * f64::from(k), None)).collect::<Vec<_>>();
    let motor = |name: &str, a: usize, b: usize| Motor {
        stiffness: Some(2e3),
        pretension: 1.0,
        ..Motor::spool(name, [(a, 0.005), (b, -0.005)])
    };
    robot(cables).with_motors(vec![motor("x", 0, 2), motor("y", 1, 3)]).unwrap()
}

/// Each with the greatest tension of its cables in N.
pub fn all() -> Vec<(&'static str, Robot, f64)> {
    let tapered = Backbone {
        section: Some(Section::Round {
            outer: Along::At { arc_lengths: vec![0.0, LENGTH], values: vec![0.0036, 0.002] },
            inner: Along::Uniform(0.0),
        }),
        ..backbone(0.003)
    };
    let three = |k: i32| 120.0 * f64::from(k);
    vec![
        ("three straight", three_straight(), 4.0),
        (
            "two straight and a helix",
            robot(vec![
                straight("a", 0.0, None),
                straight("b", 120.0, None),
                helix("c", 240.0, 1.0),
            ]),
            4.0,
        ),
        (
            "three straight and a helix",
            robot(
                (0..3)
                    .map(|k| straight(&format!("s{k}"), three(k), None))
                    .chain([helix("h", 0.0, 1.0)])
                    .collect(),
            ),
            4.0,
        ),
        (
            "four through holes",
            robot(vec![
                holes("a", [1, 2, 3, 4, 4, 4, 4, 3, 2, 1]),
                holes("b", [4, 5, 6, 7, 8, 9, 10, 11, 12, 1]),
                holes("c", [7, 7, 7, 6, 5, 4, 3, 3, 3, 3]),
                holes("d", [10, 9, 8, 8, 9, 10, 11, 12, 12, 12]),
            ]),
            4.0,
        ),
        ("two segments", two_segments(), 4.0),
        (
            "helices and counter-helices",
            robot(
                (0..6)
                    .map(|k| {
                        helix(&format!("h{k}"), three(k % 3), if k < 3 { 0.75 } else { -0.75 })
                    })
                    .collect(),
            ),
            4.0,
        ),
        (
            "three segments",
            robot(
                (0..9)
                    .map(|k| {
                        let segment = k / 3;
                        let ends_at =
                            [Some(0.06), Some(0.12), None][usize::try_from(segment).unwrap()];
                        straight(
                            &format!("s{k}"),
                            three(k % 3) + 40.0 * f64::from(segment),
                            ends_at,
                        )
                    })
                    .collect(),
            ),
            4.0,
        ),
        (
            "converging",
            robot((0..4).map(|k| converging(&format!("c{k}"), 90.0 * f64::from(k))).collect()),
            4.0,
        ),
        (
            "tapered",
            Robot::new(
                tapered,
                disks(),
                (0..4).map(|k| straight(&format!("s{k}"), 90.0 * f64::from(k), None)).collect(),
            )
            .unwrap(),
            2.0,
        ),
        ("with motors", with_motors(), 6.0),
    ]
}
