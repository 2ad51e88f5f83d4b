use whipcord::{Case, Loads, Vec3};
use whipcord_motion::{Commands, Damping, LoadCourse, Method, MotionOptions, Simulation};
use super::robots::{rod, paper, straight};
#[test]
fn scratch() {
    let robot = rod(0.5, 2e-3, 200e9, 0.25, 8000.0, vec![]);
    let down = Vec3::new(-9.81, 0.0, 0.0);
    let case = Case { loads: Loads { gravity: Some(down), ..Loads::default() }, ..Case::default() };
    let weight = Loads { tip_force: down * 0.02, ..Loads::default() };
    let release = whipcord_motion::Course::table(vec![0.0, 0.0], vec![1.0, 0.0]).unwrap();
    for (method, dt, elements) in [(Method::Accurate, 4e-4, 10), (Method::Accurate, 2e-4, 10), (Method::Accurate, 1e-4, 10), (Method::Accurate, 5e-5, 10), (Method::Accurate, 1e-4, 20), (Method::Energy, 2e-5, 10), (Method::Energy, 1e-5, 10)] {
        let options = MotionOptions { loads: vec![LoadCourse { loads: weight.clone(), factor: release.clone() }], elements, method, ..MotionOptions::default() };
        let mut s = Simulation::new(&robot, &case, options).unwrap();
        print!("{method:?} {dt} {elements}:");
        let (mut its, mut fac, mut n) = (0, 0, 0);
        let t0 = std::time::Instant::now();
        for _ in 0..5 {
            for _ in 0..(0.1_f64 / dt).round() as usize { let d = s.step(&Commands::default(), dt).unwrap().diagnostics; its += d.iterations; fac += d.factorisations; n += 1; }
            print!(" {:.6}", s.state().tip().position.x);
        }
        println!(" {:?} its {:.2} fac {:.2} {:.1} us", s.state().energy, its as f64 / n as f64, fac as f64 / n as f64, t0.elapsed().as_secs_f64() / n as f64 * 1e6);
    }
    let robot = paper(vec![straight("a", 0.0, 0.008)]);
    for dt in [1e-3, 5e-3, 1e-2, 2e-2] {
        let options = MotionOptions { damping: Damping::Time(3.5e-3), ..MotionOptions::default() };
        let mut s = Simulation::new(&robot, &Case::with_tensions(&[0.0]), options).unwrap();
        let (mut its, mut fac, mut n) = (0, 0, 0);
        let t0 = std::time::Instant::now();
        let commands = Commands::tensions(&[4.0]);
        for _ in 0..(1.0_f64 / dt).round() as usize { let d = s.step(&commands, dt).unwrap().diagnostics; its += d.iterations; fac += d.factorisations; n += 1; }
        println!("paper {dt} {} elements: {:?} defect {:e} its {:.2} fac {:.2} {:.1} us", s.arc_lengths().len(), s.state().energy, s.state().energy.defect(), its as f64 / n as f64, fac as f64 / n as f64, t0.elapsed().as_secs_f64() / n as f64 * 1e6);
    }
}
