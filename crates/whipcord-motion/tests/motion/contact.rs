//! Motion among obstacles, against statics and closed forms.

use whipcord::{Case, Form, Loads, Model, Obstacle, Pose, Vec3, cosserat};
use whipcord_motion::{Commands, Damping, Initial, Method, MotionOptions, Simulation};

use super::robots::{paper, rod, straight};

fn floor(height: f64, friction: f64) -> Obstacle {
    // The half-space lies below z = 0 of its frame; its z axis is turned to x.
    let rotation = whipcord::UnitQuaternion::exp(Vec3::Y * core::f64::consts::FRAC_PI_2);
    Obstacle {
        name: "floor".to_owned(),
        form: Form::HalfSpace,
        pose: Pose { position: Vec3::X * height, rotation },
        friction,
        movable: None,
    }
}

fn down() -> Loads {
    Loads { gravity: Some(Vec3::new(-9.81, 0.0, 0.0)), ..Loads::default() }
}

#[test]
fn explore() {
    let robot = rod(0.5, 4e-3, 2e9, 0.25, 4000.0, vec![]);
    for (friction, dt) in
        [(0.0, 0.001), (0.0, 0.005), (0.0, 0.01), (0.0, 0.02), (0.3, 0.001), (0.3, 0.01)]
    {
        let case =
            Case { obstacles: vec![floor(-0.05, friction)], loads: down(), ..Case::default() };
        let options = MotionOptions {
            initial: Initial::Rest,
            damping: Damping::Time(0.005),
            ..Default::default()
        };
        let mut simulation = Simulation::new(&robot, &case, options).unwrap();
        let steps = (1.0_f64 / dt).round() as usize;
        let clock = std::time::Instant::now();
        let mut deepest = 0.0_f64;
        for k in 0..steps {
            let state = simulation.step(&Commands::default(), dt).unwrap();
            for c in &state.contacts {
                deepest = deepest.min(c.gap);
            }
            let low =
                state.poses.iter().map(|p| p.position.x).fold(0.0_f64, f64::min) + 0.05 - 0.002;
            deepest = deepest.min(low);
            if k % (steps / 10) == 0 || k + 1 == steps {
                println!(
                    "t {:.3} tip {:.5} contacts {:?} parts {} E {:.6} defect {:.3e} contact {:.3e}",
                    state.time,
                    state.tip().position.x,
                    state
                        .contacts
                        .iter()
                        .map(|c| (
                            (c.arc_length * 1e4).round() / 1e4,
                            (c.force.unwrap() * 1e4).round() / 1e4
                        ))
                        .collect::<Vec<_>>(),
                    state.diagnostics.parts,
                    state.energy.total(),
                    state.energy.defect(),
                    state.energy.contacts
                );
            }
        }
        println!(
            "dt {dt} mu {friction} time {:.3} s deepest {deepest:.2e}",
            clock.elapsed().as_secs_f64()
        );
        let mut prepared =
            Model::Cosserat(cosserat::Options::default()).prepare(&robot, &case.loads).unwrap();
        let still = prepared.solve(&case, None).unwrap();
        println!(
            "statics {:?} {:?}",
            still.shape.poses.last().unwrap().position.x,
            still.contacts.iter().map(|c| (c.arc_length, c.force)).collect::<Vec<_>>()
        );
    }
    let _ = (paper(vec![straight("a", 0.0, 0.008)]), Method::Robust);
}
