//! A controller that solves a loaded robot in every cycle: time and memory of the calls.
//!
//! ```text
//! cargo run --release -p whipcord --example controller [CYCLES] [ROUNDS] [MODEL]
//! ```
//!
//! Tensions (or cable lengths) and the force on the tip walk at random from cycle to cycle. Each round repeats the same walk, so
//! that the least time of a cycle over the rounds is without the interruptions by other programs; the greatest of these
//! least times is the worst case of the solve itself. Allocations are counted in a round of their own.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a program that prints, and ends where a solve fails"
)]

use std::f64::consts::TAU;
use std::time::Instant;

use whipcord::{
    Actuation, Backbone, Budget, Cable, Case, Disks, Loads, Material, Model, ModelKind, Robot,
    Routing, Section, Shortening, Solution, Stations, Status, Vec3, WarmStart,
};

/// Cycles of a walk, and how often it is repeated.
const CYCLES: usize = 100_000;
const ROUNDS: usize = 3;
/// Cycles before the count of allocations begins.
const WARM_UP: usize = 2_000;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let mut count = |default| arguments.next().map_or(default, |text| text.parse().unwrap());
    let (cycles, rounds): (usize, usize) = (count(CYCLES), count(ROUNDS));
    let chosen: Option<ModelKind> = arguments.next().map(|name| name.parse().unwrap());
    println!("{cycles} cycles, the least time of each over {rounds} rounds, in µs");
    println!(
        "{:<28} {:<10} {:>7} {:>7} {:>7} {:>7} {:>18} {:>11} {:>12}",
        "model",
        "commands",
        "p50",
        "p99",
        "p99.9",
        "worst",
        "worst as it came",
        "iterations",
        "allocations"
    );
    for kind in [
        ModelKind::Cosserat,
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
    ] {
        if chosen.is_some_and(|chosen| chosen != kind) {
            continue;
        }
        for actuation in [Actuation::Tension, Actuation::Shortening] {
            print_line(kind, actuation, cycles, rounds);
        }
    }
}

fn print_line(kind: ModelKind, actuation: Actuation, cycles: usize, rounds: usize) {
    let walk: Vec<Case> = walk(actuation, cycles);
    let mut controller = Controller::new(kind, actuation, &walk[0]);
    let (mut least, mut greatest, mut iterations) = (vec![f64::INFINITY; cycles], 0.0_f64, 0);
    for _ in 0..rounds {
        controller.rest(&walk[0]);
        for (least, case) in least.iter_mut().zip(&walk) {
            let begun = Instant::now();
            controller.cycle(case);
            let time = 1e6 * begun.elapsed().as_secs_f64();
            *least = least.min(time);
            greatest = greatest.max(time);
            iterations = iterations.max(controller.solution.diagnostics.iterations);
        }
    }
    controller.rest(&walk[0]);
    let mut allocations = 0;
    for (cycle, case) in walk.iter().enumerate() {
        let counted = allocation_counter::measure(|| {
            controller.cycle(case);
        });
        allocations += if cycle < WARM_UP.min(cycles / 2) { 0 } else { counted.count_total };
    }
    least.sort_by(f64::total_cmp);
    let at = |share: f64| least[(share * (cycles - 1) as f64) as usize];
    let by = match actuation {
        Actuation::Shortening => "lengths",
        _ => "tensions",
    };
    println!(
        "{:<28} {by:<10} {:>7.0} {:>7.0} {:>7.0} {:>7.0} {greatest:>18.0} {iterations:>11} {allocations:>12}",
        kind.name(),
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0)
    );
}

/// What a program does in each cycle.
struct Controller {
    model: whipcord::Prepared,
    solution: Solution,
    from: WarmStart<'static>,
}

impl Controller {
    fn new(kind: ModelKind, actuation: Actuation, case: &Case) -> Self {
        let mut model =
            Model::new(kind, Stations::Disks, actuation).prepare(&robot(), &case.loads).unwrap();
        model.set_budget(Budget { iterations: 200, ..Budget::UNLIMITED });
        Self { model, solution: Solution::empty(kind), from: WarmStart::None }
    }

    /// Solves a case from cold.
    fn rest(&mut self, case: &Case) {
        self.from = WarmStart::None;
        self.cycle(case);
    }

    fn cycle(&mut self, case: &Case) {
        let status = self.model.solve_into(case, self.from, &mut self.solution).unwrap();
        assert_eq!(status, Status::Converged);
        self.from = WarmStart::Output;
    }
}

/// The robot of the paper with three straight cables and its own weight.
fn robot() -> Robot {
    let material = Material {
        young_modulus: Some(1.1e9),
        poisson_ratio: Some(0.3),
        density: Some(1040.0),
        ..Material::default()
    };
    let section = Some(Section::circle(0.003));
    let backbone = Backbone { section, material, ..Backbone::new(0.18) };
    let straight = |k: u32| {
        let angle = TAU * f64::from(k) / 3.0;
        Cable::new(format!("{k}"), Routing::Straight { angle, radius: 0.008 })
    };
    let disks = Disks::equally_spaced(0.18, 10, 0.008);
    Robot::new(backbone, disks, (0..3).map(straight).collect()).unwrap()
}

/// A random walk of the commands and of the force on the tip: neighbouring cycles differ by 1 % of the range of the
/// commands at most.
fn walk(actuation: Actuation, cycles: usize) -> Vec<Case> {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut place = [0.5; 6];
    let step = |_| {
        for value in &mut place {
            *value = (*value + 0.02 * (random.next() - 0.5)).clamp(0.0, 1.0);
        }
        let [a, b, c, x, y, z] = place;
        let mut case = match actuation {
            Actuation::Shortening => {
                // Two cables lead and the third follows, so that the lengths fit together.
                let lengths = [4e-3 * (a - 0.5), 4e-3 * (b - 0.5)];
                let third = -lengths[0] - lengths[1] - 1e-3 * c;
                Case::with_shortenings(&[lengths[0], lengths[1], third].map(Shortening::Length))
            }
            _ => Case::with_tensions(&[3.0 * a, 3.0 * b, 3.0 * c]),
        };
        case.loads = Loads {
            gravity: Some(Vec3::new(0.0, 0.0, -9.806_65)),
            tip_force: Vec3::new(0.2 * (x - 0.5), 0.2 * (y - 0.5), 0.2 * (z - 0.5)),
            ..Loads::default()
        };
        case
    };
    (0..cycles).map(step).collect()
}

/// Numbers between 0 and 1 (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}
