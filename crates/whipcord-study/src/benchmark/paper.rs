//! The four robots of the paper's Table 1, so that the benchmark needs no files.

use whipcord::{
    Backbone, Cable, CableCommand, Case, Disks, Material, Robot, RobotError, Routing, Section,
    Shortening,
};

/// A robot and what is asked of it.
#[derive(Clone, Debug)]
pub struct Example {
    /// For people.
    pub title: String,
    /// The robot.
    pub robot: Robot,
    /// Tension for the Cosserat model, shortening for the four-bar model.
    pub case: Case,
}

/// 400 g hung on the cable.
const TENSION: f64 = 0.4 * 9.80665;

/// Table 1: routing and measured shortening. The paper names nine holes for ten disks in cases I and
/// III, which `examples/table1` explains.
const ROUTINGS: [(&str, [usize; 10], f64); 4] = [
    ("I straight", [4; 10], 0.055),
    ("II helical", [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], 0.070),
    ("III general", [1, 2, 3, 4, 4, 4, 4, 3, 2, 1], 0.057),
    ("IV general", [10, 10, 10, 10, 10, 10, 11, 12, 1, 2], 0.053),
];

/// The paper's prototype with each of the four routings.
///
/// # Errors
/// None: the numbers are valid, as a test shows.
pub fn table_1() -> Result<Vec<Example>, RobotError> {
    ROUTINGS
        .into_iter()
        .map(|(title, holes, shortening)| {
            let backbone = Backbone {
                section: Some(Section::circle(0.003)),
                material: Material {
                    young_modulus: Some(1.1e9),
                    poisson_ratio: Some(0.3),
                    ..Default::default()
                },
                ..Backbone::new(0.18)
            };
            let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
            let cable = Cable::new("pull", Routing::holes(holes.to_vec()));
            let command = CableCommand {
                tension: Some(TENSION),
                shortening: Some(Shortening::Fraction(shortening)),
            };
            Ok(Example {
                title: title.to_owned(),
                robot: Robot::new(backbone, disks, vec![cable])?,
                case: Case { commands: vec![command], ..Case::default() },
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_robots_are_valid() {
        let examples = table_1().unwrap();
        assert_eq!(examples.len(), 4);
        for example in examples {
            example.case.check(&example.robot).unwrap();
        }
    }
}
