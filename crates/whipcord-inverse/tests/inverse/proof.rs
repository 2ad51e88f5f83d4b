//! Proofs that a target cannot be reached, against dense samples of the shapes.

use std::num::NonZero;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::jobs::share;
use whipcord::{
    Actuation, Cable, Cancel, Case, Loads, Model, ModelKind, Robot, Routing, SolveError, Statics,
    Vec3,
};
use whipcord_inverse::{
    CableLimits, CommandedBy, InverseError, InverseSolver, Limits, NoProof, Preference,
    ReachOptions, ReachStatus, Reached, Target,
};

use crate::clock::Clock;
use crate::planted::Random;
use crate::robots;

const PROVE: ReachOptions = ReachOptions {
    tolerance: None,
    prefer: Preference::First,
    starts: 32,
    solves: 4000,
    clearance: Some(0.0),
    proof: Some(400_000),
    allows_unstable: false,
    null_space: true,
};

fn model() -> Model {
    Model::new(ModelKind::Cosserat, Default::default(), Actuation::Natural)
}

fn solver(robot: &Robot, case: &Case, greatest: f64) -> InverseSolver {
    let limits = CableLimits { tension: [0.0, greatest], ..CableLimits::default() };
    let limits = Limits::uniform(robot.cables().len(), limits);
    InverseSolver::new(&model(), robot, case, &limits, CommandedBy::Tensions).unwrap()
}

/// Targets of a robot beside its shapes, so that some are near and some far.
fn beside_shapes<'a>(
    robot: &'a Robot,
    greatest: f64,
    random: &'a mut Random,
) -> impl FnMut() -> Vec3 + 'a {
    move || {
        let tensions = random.tensions(robot.cables().len(), greatest);
        let shape = model().solve(robot, &Case::with_tensions(&tensions)).unwrap();
        let tip = shape.disks.poses.last().unwrap().position;
        let mut part = || 2.0 * random.next() - 1.0;
        let direction = Vec3::new(part(), part(), part());
        tip + direction * ((0.01 + 0.05 * part().abs()) / direction.norm())
    }
}

/// Seconds of the processor that proofs take of so many targets out of reach, the nearest place included; and how many are proven to 10 %.
pub fn proofs(robot: &Robot, greatest: f64, count: usize) -> (Vec<f64>, usize) {
    let mut solver = solver(robot, &Case::default(), greatest);
    let mut random = Random(17);
    let mut next = beside_shapes(robot, greatest, &mut random);
    let (mut seconds, mut proven) = (Vec::new(), 0);
    // Within reach there is nothing to prove.
    for _ in 0..8 * count {
        if seconds.len() == count {
            break;
        }
        let target = Target::Tip(next());
        let clock = Clock::of_process();
        let answer = solver.reach(&target, &PROVE).unwrap();
        if answer.status == ReachStatus::Reached || answer.miss.position < 0.005 {
            continue;
        }
        seconds.push(clock.seconds());
        let bound = answer.lower_bound.unwrap();
        proven += usize::from(bound >= 0.89 * answer.miss.position);
    }
    (seconds, proven)
}

/// The least distance of a point from the tips of as many shapes.
fn sampled_distance(robot: &Robot, greatest: f64, point: Vec3, count: usize) -> f64 {
    let mut random = Random(5);
    let cables = robot.cables().len();
    let values: Vec<f64> = (0..count).flat_map(|_| random.tensions(cables, greatest)).collect();
    let rows = Rows::Tensions { values: &values, case: &Case::default() };
    let batch = solve_batch(&model(), robot, rows, &BatchOptions::default()).unwrap();
    let tip = batch.arc_lengths().len() - 1;
    (0..count)
        .filter_map(|row| batch.row(row)?.ok())
        .map(|row| {
            let [x, y, z] = row.position(tip);
            (Vec3::new(x, y, z) - point).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

/// Robots without motors that have so many cables.
fn with_cables(count: impl Fn(usize) -> bool) -> Vec<(&'static str, Robot, f64)> {
    let one = robots::robot(vec![Cable::new("a", Routing::Straight { angle: 0.0, radius: 0.008 })]);
    let all = core::iter::once(("one", one, 4.0)).chain(robots::all());
    all.filter(|(_, robot, _)| robot.motors().is_empty() && count(robot.cables().len())).collect()
}

#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn prove(robots: Vec<(&'static str, Robot, f64)>, count: usize, samples: usize) -> (usize, usize) {
    let (mut proven, mut asked) = (0, 0);
    for (name, robot, greatest) in robots {
        let mut solver = solver(&robot, &Case::default(), greatest);
        let mut random = Random(17);
        let mut next = beside_shapes(&robot, greatest, &mut random);
        for _ in 0..count {
            let at = next();
            let clock = Instant::now();
            let answer = solver.reach(&Target::Tip(at), &PROVE).unwrap();
            let seconds = clock.elapsed().as_secs_f64();
            if answer.status == ReachStatus::Reached || answer.miss.position < 0.005 {
                continue;
            }
            asked += 1;
            let bound = answer.lower_bound.unwrap();
            println!(
                "{name}: {:?}, at {:.2} mm, no nearer than {:.2} mm, {} solves, {seconds:.2} s",
                answer.status,
                1e3 * answer.miss.position,
                1e3 * bound,
                answer.solves,
            );
            assert!(bound <= answer.miss.position);
            let sampled = sampled_distance(&robot, greatest, at, samples);
            assert!(bound <= sampled, "{name}: {bound} is contradicted by {sampled}");
            if answer.status == ReachStatus::UnreachableProven
                && bound >= 0.89 * answer.miss.position
            {
                proven += 1;
            }
        }
    }
    (proven, asked)
}

#[test]
fn bounds_of_the_distance_are_not_contradicted() {
    let (proven, asked) = prove(with_cables(|n| n <= 4), 3, 20_000);
    assert!(asked >= 10, "{asked}");
    assert_eq!(proven, asked);
}

#[test]
fn bounds_of_two_segments_are_not_contradicted() {
    let two_segments = vec![("two segments", robots::two_segments(), 4.0)];
    let (proven, asked) = prove(two_segments, 3, 50_000);
    assert!(asked > 0);
    assert_eq!(proven, asked);
}

/// `ROBOT` for one robot.
#[test]
#[ignore = "minutes"]
#[allow(clippy::print_stdout, reason = "a study prints its results")]
fn study_of_proofs() {
    let only = std::env::var("ROBOT").ok();
    let mut robots = with_cables(|n| n <= 6);
    robots.retain(|(name, ..)| only.as_ref().is_none_or(|only| only == name));
    let (proven, asked) = prove(robots, 20, 1_000_000);
    println!("proven to 10 %: {proven} of {asked}");
}

#[test]
fn what_cannot_be_proven_says_why() {
    let robot = robots::three_straight();
    let far = Target::Tip(Vec3::new(0.3, 0.0, 0.0));
    let ask = |solver: &mut InverseSolver, target: &Target| -> Reached {
        solver.reach(target, &PROVE).unwrap()
    };
    let loads = Loads { tip_force: Vec3::new(0.1, 0.0, 0.0), ..Loads::default() };
    let loaded = Case { loads, ..Case::default() };
    let answer = ask(&mut solver(&robot, &loaded, 4.0), &far);
    assert_eq!((answer.status, answer.no_proof), (ReachStatus::Undecided, Some(NoProof::Loads)));
    let answer = ask(&mut solver(&robot, &Case::default(), f64::INFINITY), &far);
    assert_eq!(answer.no_proof, Some(NoProof::TensionLimits));
    let direction = Vec3::new(0.0, 0.0, -1.0);
    let backward = Target::Axis { point: None, direction };
    let answer = ask(&mut solver(&robot, &Case::default(), 0.5), &backward);
    assert_eq!(answer.no_proof, Some(NoProof::NoPoint));
    // A point that is there, with an axis that is not.
    let tip = Vec3::new(0.0, 0.0, robots::LENGTH);
    let turned = Target::Axis { point: Some(tip), direction };
    let answer = ask(&mut solver(&robot, &Case::default(), 0.5), &turned);
    assert_ne!(answer.status, ReachStatus::Reached);
    assert_ne!(answer.status, ReachStatus::UnreachableProven);
}

#[test]
fn a_proof_ends_when_it_is_cancelled() {
    let (_, robot, greatest) = robots::all().swap_remove(5);
    assert_eq!(robot.cables().len(), 6);
    let mut solver = solver(&robot, &Case::default(), greatest);
    let mut random = Random(17);
    let mut next = beside_shapes(&robot, greatest, &mut random);
    let search = ReachOptions { proof: None, ..PROVE };
    let target = loop {
        let target = Target::Tip(next());
        if solver.reach(&target, &search).unwrap().miss.position > 0.01 {
            break target;
        }
    };
    // The search takes milliseconds, and the proof many seconds.
    let cancel = Cancel::new();
    solver.set_cancel(&cancel);
    let timer = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(500));
        cancel.cancel();
    });
    let error = solver.reach(&target, &PROVE).unwrap_err();
    timer.join().unwrap();
    assert!(matches!(error, InverseError::Solve(SolveError::Cancelled { .. })), "{error:?}");
}

#[test]
fn what_is_farther_than_the_robot_is_long_takes_no_boxes() {
    let robot = robots::three_straight();
    let target = Target::Tip(Vec3::new(0.0, 0.03, robots::LENGTH + 0.06));
    let solves = |options: &ReachOptions| -> Reached {
        solver(&robot, &Case::default(), 4.0).reach(&target, options).unwrap()
    };
    let proven = solves(&ReachOptions { proof: Some(0), ..PROVE });
    assert_eq!(proven.status, ReachStatus::UnreachableProven);
    let bound = proven.lower_bound.unwrap();
    assert!(bound >= 0.89 * proven.miss.position && bound <= proven.miss.position);
}

#[test]
fn bounds_depend_on_the_boxes_but_not_on_threads() {
    let (_, robot, greatest) = robots::all().swap_remove(3);
    let target = Target::Tip(Vec3::new(0.05, -0.02, 0.19));
    let bound = |boxes: usize| {
        let options = ReachOptions { proof: Some(boxes), ..PROVE };
        let answer = solver(&robot, &Case::default(), greatest).reach(&target, &options).unwrap();
        (answer.status, answer.lower_bound, answer.miss.position)
    };
    let (status, whole, miss) = bound(400_000);
    assert_eq!(status, ReachStatus::UnreachableProven);
    assert!(whole.unwrap() >= 0.89 * miss, "{whole:?} of {miss}");
    let by_three = Mutex::new(Vec::new());
    let threads = NonZero::new(3);
    share(
        0..3,
        threads,
        || (),
        |_, ()| {
            by_three.lock().unwrap().push(bound(200));
            true
        },
    )
    .unwrap();
    assert_eq!(by_three.into_inner().unwrap(), vec![bound(200); 3]);
    // What too few boxes leave is a bound as well.
    let (_, few, _) = bound(20);
    assert!(few.unwrap() < whole.unwrap(), "{few:?}");
}

#[test]
fn tensions_that_bend_a_robot_by_whole_turns_have_bounds() {
    let robot = robots::three_straight();
    let greatest = 25.0;
    let mut solver = solver(&robot, &Case::default(), greatest);
    // Beside the base, where the robot would have to go through itself, and above it.
    for target in [Vec3::new(-0.12, 0.13, -0.02), Vec3::new(0.1, 0.1, 0.12)] {
        let answer = solver.reach(&Target::Tip(target), &PROVE).unwrap();
        assert_eq!(answer.status, ReachStatus::UnreachableProven, "{target:?}");
        let bound = answer.lower_bound.unwrap();
        let sampled = sampled_distance(&robot, greatest, target, 20_000);
        assert!(bound <= answer.miss.position && bound <= sampled, "{bound} {sampled}");
        assert!(bound >= 0.89 * answer.miss.position, "{bound} of {}", answer.miss.position);
    }
}
