//! Steps take no memory.

use whipcord::{Case, Loads, Shortening, Vec3};
use whipcord_motion::{CableDrive, Commands, Course, Damping, Method, MotionOptions, Simulation};

use super::robots::{helix, paper, straight};

#[test]
fn steps_allocate_nothing() {
    let robot = paper(vec![helix(), straight("b", 1.0, 0.008)]);
    let loads = Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() };
    let by_tension = Case { loads: loads.clone(), ..Case::with_tensions(&[1.0, 0.0]) };
    let by_length = Case { loads, ..Case::with_shortenings(&[Shortening::Length(0.0); 2]) };
    // A jump would be an impact.
    let ramp =
        |by: f64| CableDrive::Shortening(Course::table(vec![0.0, 0.1], vec![0.0, by]).unwrap());
    for (case, pull) in [
        (by_tension, Commands::tensions(&[3.0, 1.0])),
        (by_length, Commands::new([3e-3, -5e-3].map(ramp).to_vec())),
    ] {
        for method in [Method::Accurate, Method::Energy, Method::Robust] {
            for tolerance in [None, Some(1e-5)] {
                let damping = Damping::Time(5e-3);
                let options =
                    MotionOptions { method, tolerance, damping, ..MotionOptions::default() };
                let mut simulation = Simulation::new(&robot, &case, options).unwrap();
                // The first steps grow the lists of the active set.
                for _ in 0..3 {
                    simulation.step(&pull, 5e-3).unwrap();
                }
                let info = allocation_counter::measure(|| {
                    for _ in 0..20 {
                        simulation.step(&pull, 5e-3).unwrap();
                    }
                });
                assert_eq!(info.count_total, 0, "{method:?} {tolerance:?}");
            }
        }
    }
}
