//! Targets made by the same model from random commands: all of them can be reached.

use std::time::Instant;

use whipcord::{Actuation, Case, Loads, Model, ModelKind, Robot, Solution, Vec3};
use whipcord_inverse::{
    Actuator, CableLimits, CommandedBy, InverseSolver, Limits, Preference, ReachOptions,
    ReachStatus, Target,
};

use crate::robots;

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

    /// Tensions of which about every third is zero.
    pub fn tensions(&mut self, cables: usize, greatest: f64) -> Vec<f64> {
        (0..cables).map(|_| if self.next() < 0.35 { 0.0 } else { self.next() * greatest }).collect()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Tip,
    Pose,
    Axis,
    Shape,
}

pub fn target_of(kind: Kind, solution: &Solution) -> Target {
    let tip = *solution.disks.poses.last().unwrap();
    match kind {
        Kind::Tip => Target::Tip(tip.position),
        Kind::Pose => Target::Pose(tip),
        Kind::Axis => {
            Target::Axis { point: None, direction: tip.rotation.rotate(Vec3::new(0.0, 0.0, 1.0)) }
        }
        Kind::Shape => Target::Shape(
            solution.disks.poses.iter().map(|pose| pose.position).enumerate().skip(1).collect(),
        ),
    }
}

/// How many planted targets of how many were reached, with seconds and solves for each.
pub struct Tally {
    pub asked: usize,
    pub reached: usize,
    /// Of each target but the first, in s.
    pub seconds: Vec<f64>,
    pub solves: usize,
    missed: Vec<usize>,
}

/// What is asked of a robot, so many times.
pub struct Question<'a> {
    pub kind: ModelKind,
    pub robot: &'a Robot,
    /// Greatest tension in N.
    pub greatest: f64,
    pub loads: &'a Loads,
    pub of: Kind,
    pub by: CommandedBy,
    pub count: usize,
    /// How often each target is asked for.
    pub times: usize,
    /// Shapes to start from, as for many targets.
    pub shapes: usize,
}

pub fn study(question: &Question<'_>, options: &ReachOptions) -> Tally {
    let &Question { kind, robot, greatest, loads, of, by, count, shapes, .. } = question;
    let model = Model::new(kind, Default::default(), Actuation::Natural);
    let cables = robot.cables().len();
    let limits =
        Limits::uniform(cables, CableLimits { tension: [0.0, greatest], ..CableLimits::default() });
    let case = Case { loads: loads.clone(), ..Case::default() };
    let mut solver = InverseSolver::new(&model, robot, &case, &limits, by).unwrap();
    solver.start_from_shapes(shapes);
    let mut random = Random(99);
    let mut prepared = model.prepare(robot, loads).unwrap();
    let mut tally =
        Tally { asked: 0, reached: 0, seconds: Vec::new(), solves: 0, missed: Vec::new() };
    for number in 0..count {
        let tensions = random.tensions(cables, greatest);
        let planted = match by {
            CommandedBy::Motors => {
                let commands: Vec<f64> =
                    robot.motors().iter().map(|_| 2.0 * random.next() - 1.0).collect();
                Case::with_motors(robot, &commands).unwrap()
            }
            _ => Case::with_tensions(&tensions),
        };
        let Ok(solution) = prepared.solve(&Case { loads: loads.clone(), ..planted }, None) else {
            continue;
        };
        if solution.diagnostics.is_unstable()
            || solution.cables.iter().any(|c| c.tension.is_some_and(|t| t > greatest))
        {
            continue;
        }
        let target = target_of(of, &solution);
        tally.asked += 1;
        // Of several times the least: what else the machine does is not counted.
        let mut seconds = f64::INFINITY;
        let mut ask = || {
            let clock = Instant::now();
            let answer = solver.reach(&target, options).unwrap();
            seconds = seconds.min(clock.elapsed().as_secs_f64());
            answer
        };
        for _ in 1..question.times {
            ask();
        }
        let answer = ask();
        if tally.asked > 1 {
            tally.seconds.push(seconds);
        }
        tally.solves += answer.solves;
        if answer.status == ReachStatus::Reached {
            tally.reached += 1;
            // What the answer says of itself a solve of its case confirms.
            let again = prepared.solve(&answer.case, None).unwrap();
            let off = (again.disks.poses.last().unwrap().position
                - solution.disks.poses.last().unwrap().position)
                .norm();
            if of != Kind::Axis {
                assert!(off <= 1e-5 * robots::LENGTH, "{off}");
            }
            for cable in &again.cables {
                assert!((0.0..=greatest).contains(&cable.tension.unwrap()));
            }
        } else {
            tally.missed.push(number);
        }
    }
    tally
}

#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn print(name: &str, of: Kind, tally: &Tally) {
    let mut seconds = tally.seconds.clone();
    seconds.sort_by(f64::total_cmp);
    let part = |part: usize| 1e3 * seconds.get(seconds.len() * part / 100).unwrap_or(&f64::NAN);
    println!(
        "{name}, {of:?}: {} of {}, median {:.3} ms, of 90 % {:.3} ms, mean {:.3} ms, {:.1} solves; missed {:?}",
        tally.reached,
        tally.asked,
        part(50),
        part(90),
        1e3 * seconds.iter().sum::<f64>() / seconds.len().max(1) as f64,
        tally.solves as f64 / tally.asked.max(1) as f64,
        &tally.missed[..tally.missed.len().min(5)],
    );
}

pub const FIRST: ReachOptions = ReachOptions {
    tolerance: None,
    prefer: Preference::First,
    starts: 32,
    solves: 4000,
    clearance: None,
    proof: None,
    allows_unstable: false,
    null_space: true,
};

#[test]
fn planted_targets_are_reached() {
    for (name, robot, greatest) in robots::all() {
        let cables = robot.cables().len();
        let (kinds, by): (&[Kind], _) = match name {
            "with motors" => (&[Kind::Tip], CommandedBy::Motors),
            _ if cables >= 6 => {
                (&[Kind::Tip, Kind::Pose, Kind::Axis, Kind::Shape], CommandedBy::Case)
            }
            _ => (&[Kind::Tip, Kind::Shape], CommandedBy::Case),
        };
        for &of in kinds {
            let question = Question {
                kind: ModelKind::Cosserat,
                robot: &robot,
                greatest,
                loads: &Loads::default(),
                of,
                by,
                count: 40,
                times: 1,
                shapes: if of == Kind::Shape { 0 } else { 16 },
            };
            let tally = study(&question, &FIRST);
            print(name, of, &tally);
            assert!(tally.asked >= 20);
            assert_eq!(tally.reached, tally.asked, "{name} {of:?} {:?}", tally.missed);
        }
    }
}

#[test]
#[ignore = "minutes"]
fn study_of_planted_targets() {
    let count = std::env::var("COUNT").ok().and_then(|n| n.parse().ok()).unwrap_or(1000);
    let only = std::env::var("ROBOT").ok();
    let load = std::env::var("LOADED").ok();
    for (name, robot, greatest) in robots::all() {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let by = if name == "with motors" { CommandedBy::Motors } else { CommandedBy::Case };
        for (loaded, loads) in [("", Loads::default()), (", loaded", robots::load())] {
            if load.as_ref().is_some_and(|load| (load == "1") == loaded.is_empty()) {
                continue;
            }
            for of in [Kind::Tip, Kind::Pose, Kind::Shape] {
                let count = if loaded.is_empty() { count } else { count / 5 };
                let question = Question {
                    kind: ModelKind::Cosserat,
                    robot: &robot,
                    greatest,
                    loads: &loads,
                    of,
                    by,
                    count,
                    times: 1,
                    shapes: std::env::var("SHAPES")
                        .ok()
                        .and_then(|n| n.parse().ok())
                        .unwrap_or(128),
                };
                let options = ReachOptions { null_space: false, ..FIRST };
                let tally = study(&question, &options);
                print(&format!("{name}{loaded}"), of, &tally);
            }
        }
    }
}

/// How random targets inside and outside of the workspace ended.
#[derive(Debug, Default)]
struct Outcomes {
    reached: usize,
    nearest: usize,
    undecided: usize,
    /// Reached, but a solve of the commands is farther from the target than the tolerance.
    beyond_tolerance: usize,
    /// A command or a tension outside its limits, by however little.
    limits_violated: usize,
    seconds: f64,
}

/// In turn points in a ball about the base that is a little larger than what the robot reaches, and tips of the robot, every second of them moved
/// off by up to a tenth of the length.
fn random_targets(robot: &Robot, greatest: f64, loads: &Loads, count: usize) -> Outcomes {
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let cables = robot.cables().len();
    let least = 0.05 * greatest;
    let limits = Limits::uniform(
        cables,
        CableLimits { tension: [least, greatest], ..CableLimits::default() },
    );
    let case = Case { loads: loads.clone(), ..Case::with_tensions(&vec![least; cables]) };
    let mut solver = InverseSolver::new(&model, robot, &case, &limits, CommandedBy::Case).unwrap();
    let mut prepared = model.prepare(robot, loads).unwrap();
    let mut random = Random(2024);
    let mut outcomes = Outcomes::default();
    for number in 0..count {
        let mut ball = Vec3::new(1.0, 1.0, 1.0);
        while ball.norm() > 1.0 {
            ball = Vec3::new(random.next(), random.next(), random.next()) * 2.0
                - Vec3::new(1.0, 1.0, 1.0);
        }
        let tensions: Vec<f64> =
            (0..cables).map(|_| least + random.next() * (greatest - least)).collect();
        let mut tip = || {
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
            prepared.solve(&case, None).map(|solution| solution.disks.tip().position)
        };
        let point = match number % 4 {
            0 | 2 => ball * (1.05 * robots::LENGTH),
            1 => tip().unwrap(),
            _ => tip().unwrap() + ball * (0.1 * robots::LENGTH),
        };
        let clock = Instant::now();
        let answer = solver.reach(&Target::Tip(point), &FIRST).unwrap();
        outcomes.seconds += clock.elapsed().as_secs_f64();
        match answer.status {
            ReachStatus::Reached => outcomes.reached += 1,
            ReachStatus::Nearest => outcomes.nearest += 1,
            ReachStatus::UnreachableProven | ReachStatus::Undecided => outcomes.undecided += 1,
        }
        let is_within = |x: f64| (least..=greatest).contains(&x);
        let tensions = answer.solution.cables.iter().map(|cable| cable.tension.unwrap());
        if !answer.commands.iter().copied().chain(tensions).all(is_within) {
            outcomes.limits_violated += 1;
        }
        if answer.status == ReachStatus::Reached {
            let again = prepared.solve(&answer.case, None).unwrap();
            let miss = (again.disks.tip().position - point).norm();
            outcomes.beyond_tolerance += usize::from(miss > 1e-5 * robots::LENGTH);
        }
    }
    outcomes
}

#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn check_random_targets(count: usize, robots: Vec<(&'static str, Robot, f64)>) {
    for (name, robot, greatest) in robots {
        let outcomes = random_targets(&robot, greatest, &Loads::default(), count);
        println!("{name}: {outcomes:?}");
        assert_eq!(outcomes.beyond_tolerance, 0, "{name}");
        assert_eq!(outcomes.limits_violated, 0, "{name}");
        // A quarter are tips.
        assert!(4 * outcomes.reached >= count && outcomes.nearest > 0, "{name}");
        // Where the descent ends at no minimum nothing is said.
        assert!(outcomes.undecided * 20 <= count, "{name}");
    }
}

fn driven_by_tensions() -> impl Iterator<Item = (&'static str, Robot, f64)> {
    robots::all().into_iter().filter(|(name, ..)| *name != "with motors")
}

#[test]
fn random_targets_keep_tolerance_and_limits() {
    check_random_targets(60, driven_by_tensions().take(5).collect());
}

#[test]
#[ignore = "minutes"]
fn study_of_random_targets() {
    let count = std::env::var("COUNT").ok().and_then(|n| n.parse().ok()).unwrap_or(2000);
    let first = std::env::var("FIRST").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
    check_random_targets(count, driven_by_tensions().skip(first).collect());
}

#[test]
fn what_was_asked_before_changes_no_answer() {
    let robot = robots::two_segments();
    let model = Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural);
    let limits = Limits::uniform(6, CableLimits { tension: [0.1, 4.0], ..CableLimits::default() });
    let loads = robots::load();
    let case = Case { loads: loads.clone(), ..Case::with_tensions(&[0.1; 6]) };
    let mut random = Random(5);
    let mut prepared = model.prepare(&robot, &loads).unwrap();
    let targets: Vec<Target> = (0..8)
        .map(|number| {
            let planted = Case::with_tensions(&random.tensions(6, 4.0));
            let solution = prepared.solve(&Case { loads: loads.clone(), ..planted }, None);
            target_of([Kind::Tip, Kind::Pose][number % 2], &solution.unwrap())
        })
        .collect();
    for shapes in [0, 12] {
        let solver = || {
            let mut solver =
                InverseSolver::new(&model, &robot, &case, &limits, CommandedBy::Case).unwrap();
            solver.start_from_shapes(shapes);
            solver
        };
        let mut one = solver();
        for (number, target) in targets.iter().enumerate() {
            let prefer = [Preference::LeastChange, Preference::LeastTension][number / 2 % 2];
            let options = ReachOptions { prefer, ..ReachOptions::default() };
            let [before, alone] =
                [&mut one, &mut solver()].map(|solver| solver.reach(target, &options).unwrap());
            assert_eq!(before.commands, alone.commands);
            assert_eq!(before.solves, alone.solves);
        }
    }
}

#[test]
fn every_model_reaches_what_it_makes() {
    let robot = robots::two_segments();
    for kind in [
        ModelKind::CosseratDisks,
        ModelKind::PiecewiseConstantCurvature,
        ModelKind::PseudoRigidBody,
    ] {
        for by in [CommandedBy::Tensions, CommandedBy::Shortenings] {
            let question = Question {
                kind,
                robot: &robot,
                greatest: 4.0,
                loads: &Loads::default(),
                of: Kind::Pose,
                by,
                count: 10,
                times: 1,
                shapes: 0,
            };
            let tally = study(&question, &FIRST);
            print(kind.name(), Kind::Pose, &tally);
            assert_eq!(tally.reached, tally.asked, "{kind} {by:?}");
        }
    }
}

#[test]
fn the_actuators_are_what_the_case_commands() {
    let robot = robots::with_motors();
    let motors = [Actuator::Motor(0), Actuator::Motor(1)];
    let of = |case: &Case, by| Actuator::of(&robot, case, ModelKind::Cosserat, by).unwrap();
    assert_eq!(of(&Case::default(), CommandedBy::Case), motors);
    let tensions = Case::with_tensions(&[1.0; 4]);
    assert_eq!(of(&tensions, CommandedBy::Case), (0..4).map(Actuator::Tension).collect::<Vec<_>>());
    assert_eq!(of(&tensions, CommandedBy::Motors), motors);
}
