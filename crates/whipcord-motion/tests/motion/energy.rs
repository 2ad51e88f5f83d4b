//! Energies.

use whipcord::{Case, Loads, Vec3};
use whipcord_motion::{Commands, Damping, Method, MotionOptions, Simulation};

use super::robots::{helix, paper, rod};

/// The energy of rod and cables, and of gravity, is conserved to rounding at every step size.
#[test]
fn the_energy_method_conserves_energy() {
    let still = Vec3::ZERO;
    let down = Vec3::new(0.0, -9.81, 0.0);
    for (gravity, limit) in [(still, 1e-12), (down, 1e-12)] {
        for dt in [1e-4, 1e-3, 5e-3, 1e-2, 2e-2] {
            let robot = paper(vec![helix()]);
            let loads = Loads { gravity: Some(gravity), ..Loads::default() };
            let case = Case { loads, ..Case::with_tensions(&[4.0]) };
            let options =
                MotionOptions { method: Method::Energy, elements: 5, ..MotionOptions::default() };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            let commands = Commands::tensions(&[1.0]);
            let mut worst = 0.0_f64;
            let steps = (2.0_f64 / dt).round() as usize;
            for _ in 0..steps {
                let state = simulation.step(&commands, dt).unwrap();
                worst = worst.max(state.energy.defect().abs());
                assert_eq!(state.diagnostics.parts, 1);
            }
            let scale = 4.0 * 0.0107;
            assert!(worst / scale < limit, "{dt}: {:e}", worst / scale);
        }
    }
}

/// Without damping, the accurate method loses little energy at small steps and gains none.
#[test]
fn energy_balances_of_the_other_methods_converge() {
    let robot = rod(0.3, 3e-3, 2e9, 0.3, 1200.0, vec![]);
    let loads = Loads { gravity: Some(Vec3::new(9.81, 0.0, 0.0)), ..Loads::default() };
    let case = Case { loads, ..Case::default() };
    for method in [Method::Accurate, Method::Robust] {
        let defect = |dt: f64| {
            let options = MotionOptions {
                method,
                initial: whipcord_motion::Initial::Rest,
                damping: Damping::Time(5e-3),
                ..MotionOptions::default()
            };
            let mut simulation = Simulation::new(&robot, &case, options).unwrap();
            for _ in 0..(0.4_f64 / dt).round() as usize {
                simulation.step(&Commands::default(), dt).unwrap();
            }
            simulation.state().energy.defect().abs()
        };
        let (coarse, fine) = (defect(4e-3), defect(2e-3));
        assert!(fine < 0.4 * coarse);
    }
}
