//! What becomes of the random robots among random obstacles: a study of every model, which looks for an answer to each refusal in other ways.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::LazyLock;
use std::time::Instant;

use whipcord::{
    Actuation, Cable, Case, Loads, Model, ModelKind, Obstruction, Robot, Shortening, Solution,
    SolveError, Statics, Stations,
};

use super::{
    ALONG, STATIONS, Scenario, Solve, arcs_by_length, arcs_by_tension, bodies_by_length,
    bodies_by_tension, by_length, by_tension, disks_by_length, disks_by_tension, four_bar, overlap,
    placed, pulled, rod, scenario,
};
use crate::common::samples;

/// Other ways to an answer of a model that was refused: finer meshes, and steps of actuation one after the other, each from the answer before.
const FINER: [(&str, Finer); 3] =
    [("finer", Finer::Mesh), ("in 24 steps", Finer::Steps(24)), ("in 96 steps", Finer::Steps(96))];

#[derive(Clone, Copy, Debug)]
enum Finer {
    /// Of a model whose mesh can be finer.
    Mesh,
    /// Each a part of the whole way.
    Steps(usize),
}

/// Another way to the answer to a case whose commands are those that the model is driven by; `None` where the model has none.
fn solved_otherwise(
    kind: ModelKind,
    way: Finer,
    robot: &Robot,
    case: &Case,
) -> Option<Result<Solution, SolveError>> {
    let stations = Stations::Equal(STATIONS);
    let rods = |accuracy| whipcord::cosserat::Options {
        accuracy,
        stations: stations.clone(),
        ..Default::default()
    };
    let fine = whipcord::cosserat::Accuracy::Steps(240);
    match (way, kind) {
        (Finer::Mesh, ModelKind::Cosserat) => Some(Model::Cosserat(rods(fine)).solve(robot, case)),
        (Finer::Mesh, ModelKind::CosseratDisks) => {
            Some(Model::CosseratDisks(rods(fine)).solve(robot, case))
        }
        (Finer::Mesh, _) => None,
        (Finer::Steps(parts), _) => {
            let model = crate::common::model_with_forces(kind, stations, Actuation::Natural);
            let mut prepared = match model.prepare(robot, &Loads::default()) {
                Ok(prepared) => prepared,
                Err(error) => return Some(Err(error)),
            };
            if robot.cables().iter().any(Cable::has_friction) {
                // What the holes remember goes with the case.
                let divided = crate::cosserat_disks::friction_study::divided(case, parts);
                return Some(prepared.solve(&divided, None));
            }
            let mut last = None;
            for part in 1..=parts {
                let mut step = case.clone();
                let share = part as f64 / parts as f64;
                for command in &mut step.commands {
                    command.tension = command.tension.map(|tension| share * tension);
                    command.shortening = command.shortening.map(|shortening| match shortening {
                        Shortening::Fraction(fraction) => Shortening::Fraction(share * fraction),
                        Shortening::Length(length) => Shortening::Length(share * length),
                    });
                }
                match prepared.solve(&step, last.as_ref()) {
                    Ok(solution) => last = Some(solution),
                    Err(error) => return Some(Err(error)),
                }
            }
            last.map(Ok)
        }
    }
}

/// Which other way finds an answer that does not overlap, and that touches or is known to be stable; `None` where none does: the refusal
/// is confirmed.
fn way_to_answer(kind: ModelKind, robot: &Robot, case: &Case) -> Option<&'static str> {
    let finds = |way: Finer| {
        let found = solved_otherwise(kind, way, robot, case);
        found.and_then(Result::ok).is_some_and(|solution| {
            let depth = overlap(robot, case, &solution).watched.0;
            let stable = solution.diagnostics.stable;
            let stands = stable.map_or(!solution.contacts.is_empty(), |stable| stable);
            depth <= 1e-8 && stands
        })
    };
    FINER.iter().find(|(_, way)| finds(*way)).map(|(name, _)| *name)
}

/// A model of a study, and what it is given.
struct Studied {
    name: &'static str,
    solve: Solve,
    kind: ModelKind,
    /// Whether by tensions, not by lengths.
    is_pulled: bool,
    rubs: bool,
}

impl Studied {
    const fn new(name: &'static str, solve: Solve, kind: ModelKind, is_pulled: bool) -> Self {
        Self { name, solve, kind, is_pulled, rubs: false }
    }

    const fn rubbing(name: &'static str, solve: Solve, kind: ModelKind, is_pulled: bool) -> Self {
        Self { name, solve, kind, is_pulled, rubs: true }
    }

    /// Robot and case as the model is given them.
    fn given(&self, robot: &Robot, case: &Case) -> (Robot, Case) {
        let case = if self.is_pulled { pulled(robot, case) } else { case.clone() };
        (if self.rubs { rubbing(robot) } else { robot.clone() }, case)
    }
}

/// What became of the robots of a study by one model.
#[derive(Debug, Default)]
struct Outcomes {
    /// By what they came to.
    counts: BTreeMap<&'static str, usize>,
    /// In ms, sorted.
    times: Vec<f64>,
    /// The deepest overlap of disks and watched places, and of the backbone anywhere, by the length.
    overlap: [f64; 2],
    /// Refusals that another way does not confirm.
    unconfirmed: usize,
    /// Of those that were given up, those that another way leads to an answer: that they are out of reach is not claimed.
    reached_otherwise: usize,
}

impl Outcomes {
    fn of(studied: &Studied, robots: &[Range<usize>], tell: bool) -> Self {
        let solve = studied.solve;
        let mut outcomes = Self::default();
        let end = robots.iter().map(|range| range.end).max().unwrap_or(0);
        let numbered = samples(scenario(), end).enumerate();
        let is_chosen = |number: usize| robots.iter().any(|range| range.contains(&number));
        for (number, scenario) in numbered.filter(|(number, _)| is_chosen(*number)) {
            let Some(case) = placed(solve, &scenario) else { continue };
            let start = processor_time();
            let outcome = solve(&scenario.robot, &case);
            let time = processor_time() - start;
            outcomes.times.push(time);
            let came_to = match &outcome {
                Ok(solution) => {
                    let deepest = overlap(&scenario.robot, &case, solution);
                    let [watched, along] = &mut outcomes.overlap;
                    *watched = watched.max(deepest.watched.0);
                    *along = along.max(deepest.along.0);
                    let jumped = solution.diagnostics.stability_lost_at.is_some();
                    if jumped { "solved after a jump" } else { "solved" }
                }
                Err(SolveError::ObstacleInTheWay { .. }) => "overlap at rest",
                Err(SolveError::Obstructed { why, .. }) => match why {
                    Obstruction::Slips => "slip off",
                    Obstruction::Leaps => "jump away",
                    Obstruction::NoneAlone { .. } => "no stable shape without obstacles",
                    Obstruction::NotConverged { .. } => "touch on without an equilibrium",
                    Obstruction::BudgetSpent { .. } => "given up",
                    Obstruction::TooManyContacts { .. } => "too many contacts",
                    Obstruction::Model(_) => "no shape under the contacts",
                    Obstruction::NoClearance { .. } => "a disk wedges",
                    Obstruction::NotHeld { .. } => "an object is not held",
                },
                Err(_) => "no shape",
            };
            if tell {
                let name = scenario.form.name();
                match &outcome {
                    Err(SolveError::ObstacleInTheWay { .. }) => {}
                    Err(error) => {
                        let (robot, case) = studied.given(&scenario.robot, &case);
                        let confirmed = match way_to_answer(studied.kind, &robot, &case) {
                            None => "confirmed".to_owned(),
                            Some(way) if came_to == "given up" => {
                                outcomes.reached_otherwise += 1;
                                format!("reached {way}")
                            }
                            Some(way) => {
                                outcomes.unconfirmed += 1;
                                format!("NOT CONFIRMED: {way}")
                            }
                        };
                        println!("{number} {name} {time:.0} ms: {error} — {confirmed}");
                    }
                    Ok(_) if time > SLOW => println!("{number} {name} {time:.0} ms: {came_to}"),
                    Ok(_) => {}
                }
            }
            *outcomes.counts.entry(came_to).or_insert(0) += 1;
        }
        outcomes.times.sort_by(f64::total_cmp);
        outcomes
    }

    fn count(&self, came_to: &str) -> usize {
        self.counts.get(came_to).copied().unwrap_or(0)
    }

    /// Those with an answer, and all that could have one: not those that overlap at rest.
    fn solved(&self) -> (usize, usize) {
        let solved = self.count("solved") + self.count("solved after a jump");
        (solved, self.times.len() - self.count("overlap at rest"))
    }

    fn tell(&self, name: &str) {
        let part = |p: usize| self.times[(self.times.len() - 1) * p / 100];
        let (solved, possible) = self.solved();
        let [watched, along] = self.overlap;
        println!(
            "{name}: {solved} of {possible} solved ({:.1} %), p50 {:.1} ms, p99 {:.0} ms, worst {:.0} ms, overlap {watched:.0e} and {along:.0e}, {} refusals not confirmed, {} given up and reached otherwise, {:?}",
            100.0 * solved as f64 / possible as f64,
            part(50),
            part(99),
            part(100),
            self.unconfirmed,
            self.reached_otherwise,
            self.counts
        );
    }
}

/// What this thread has used of a processor, in ms, where the system tells; else what has passed.
fn processor_time() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| 1e3 * START.elapsed().as_secs_f64(), |time| 1e-6 * time)
}

const MODELS: [Studied; 9] = {
    use ModelKind::{
        Cosserat, CosseratDisks, FourBar, PiecewiseConstantCurvature, PseudoRigidBody,
    };
    [
        Studied::new("cosserat by tension", by_tension, Cosserat, true),
        Studied::new("cosserat by length", by_length, Cosserat, false),
        Studied::new("cosserat-disks by tension", disks_by_tension, CosseratDisks, true),
        Studied::new("cosserat-disks by length", disks_by_length, CosseratDisks, false),
        Studied::new("arcs by tension", arcs_by_tension, PiecewiseConstantCurvature, true),
        Studied::new("arcs by length", arcs_by_length, PiecewiseConstantCurvature, false),
        Studied::new("rigid bodies by tension", bodies_by_tension, PseudoRigidBody, true),
        Studied::new("rigid bodies by length", bodies_by_length, PseudoRigidBody, false),
        Studied::new("four-bar by length", four_bar, FourBar, false),
    ]
};

/// Of every model: how many of 1,000 robots have an answer, why the others have none, and how long they take.
/// `cargo test --release -p whipcord --test mechanics contact::overlap::outcomes::study_of_outcomes -- --ignored --nocapture`
///
/// Each refusal is confirmed where a finer mesh and smaller steps of actuation find no answer either; where the solve was given up, that they find none is
/// not claimed.
///
/// The environment variables `ROBOTS=0..250,301` and `MODEL=arcs` choose a part of them.
#[test]
#[ignore = "a study, which takes an hour"]
fn study_of_outcomes() {
    outcomes_of(&MODELS, "0..1000");
}

/// The same of robots whose cables rub in their holes.
#[test]
#[ignore = "a study: minutes"]
fn study_of_outcomes_with_friction_at_holes() {
    outcomes_of(&RUBBING, "0..60");
}

fn rubbing(robot: &Robot) -> Robot {
    let rub = |cable: &Cable| Cable { friction: Some(0.2), ..cable.clone() };
    let cables = robot.cables().iter().map(rub).collect();
    Robot::new(robot.backbone().clone(), robot.disks().clone(), cables).unwrap()
}

const RUBBING: [Studied; 6] = {
    use ModelKind::{
        Cosserat, CosseratDisks, FourBar, PiecewiseConstantCurvature, PseudoRigidBody,
    };
    let arcs = PiecewiseConstantCurvature;
    [
        Studied::rubbing("cosserat, rubbing", |r, c| by_tension(&rubbing(r), c), Cosserat, true),
        Studied::rubbing(
            "cosserat-disks, rubbing",
            |r, c| disks_by_tension(&rubbing(r), c),
            CosseratDisks,
            true,
        ),
        Studied::rubbing(
            "arcs, rubbing, by tension",
            |r, c| arcs_by_tension(&rubbing(r), c),
            arcs,
            true,
        ),
        Studied::rubbing(
            "arcs, rubbing, by length",
            |r, c| arcs_by_length(&rubbing(r), c),
            arcs,
            false,
        ),
        Studied::rubbing(
            "rigid bodies, rubbing",
            |r, c| bodies_by_tension(&rubbing(r), c),
            PseudoRigidBody,
            true,
        ),
        Studied::rubbing("four-bar, rubbing", |r, c| four_bar(&rubbing(r), c), FourBar, false),
    ]
};

fn outcomes_of(models: &[Studied], robots: &str) {
    let range = |text: &str| match text.split_once("..") {
        Some((first, end)) => first.parse().unwrap()..end.parse().unwrap(),
        None => text.parse().map(|number: usize| number..number + 1).unwrap(),
    };
    let chosen = std::env::var("ROBOTS").unwrap_or_else(|_| robots.to_owned());
    let robots: Vec<Range<usize>> = chosen.split(',').map(range).collect();
    let chosen = std::env::var("MODEL").unwrap_or_default();
    for studied in models.iter().filter(|studied| studied.name.starts_with(&chosen)) {
        Outcomes::of(studied, &robots, true).tell(studied.name);
    }
}

/// Answers that take longer than this are told, in ms.
const SLOW: f64 = 1000.0;

/// Robots of the study that come to an answer in small steps of actuation come to one at once: those that lose their equilibrium where none is near, those that
/// come to rest in contact only from the shape without obstacles, those whose cables contradict each other where they leave the shape at rest, and those whose backbone
/// slides on the edge of a box, also where shear has tilted its cross-sections.
#[test]
fn what_small_steps_lead_to_is_found_at_once() {
    let named = |name: &str| MODELS.iter().find(|model| model.name == name).unwrap();
    for (name, robots) in [
        ("arcs by tension", &[169, 178, 690, 730][..]),
        ("rigid bodies by tension", &[217, 310]),
        ("rigid bodies by length", &[128, 490, 594, 771, 938]),
        ("four-bar by length", &[256, 279]),
        ("cosserat-disks by length", &[357]),
        ("cosserat-disks by tension", &[989]),
        ("cosserat by length", &[325]),
    ] {
        let robots: Vec<Range<usize>> = robots.iter().map(|&n| n..n + 1).collect();
        let outcomes = Outcomes::of(named(name), &robots, false);
        assert_eq!(outcomes.solved(), (robots.len(), robots.len()), "{name}: {outcomes:?}");
        assert!(outcomes.overlap[0] <= 1e-8, "{name}: {outcomes:?}");
        if name.starts_with("four-bar") {
            // Their equilibrium is never lost.
            assert_eq!(outcomes.count("solved"), robots.len(), "{name}: {outcomes:?}");
        }
    }
}

/// Lengths that are brought to the given ones in steps, each from the answer before, lead through stable shapes, and all at once to one that is not: the answer is the
/// stable one.
#[test]
fn lengths_at_once_lead_where_they_lead_in_steps() {
    let robots: Vec<Scenario> = samples(scenario(), 890).collect();
    // One cable is slack, and the others bear an eighth to a nineteenth of what the unstable shape takes.
    for (number, expected) in [(889, &[10.46, 0.0][..]), (806, &[4.894, 6.073, 0.0])] {
        let Scenario { robot, case, .. } = &robots[number];
        let at_once = disks_by_length(robot, case).unwrap();
        assert_eq!(at_once.diagnostics.stable, Some(true), "{number}");
        let kind = ModelKind::CosseratDisks;
        let in_steps = solved_otherwise(kind, Finer::Steps(24), robot, case).unwrap().unwrap();
        let apart = at_once.shape.distances(&in_steps.shape).fold(0.0, f64::max);
        assert!(apart < 1e-5 * robot.backbone().length, "{number}: {apart}");
        let tensions = at_once.cables.iter().map(|cable| cable.tension.unwrap());
        let off = tensions.zip(expected).map(|(tension, known)| (tension - known).abs());
        assert!(off.fold(0.0, f64::max) < 0.01, "{number}: {:?}", at_once.cables);
    }
}

/// A robot of the study that is pulled into a coil, and that has no stable shape on finer steps without obstacles either.
#[test]
fn what_has_no_stable_shape_without_obstacles_is_told() {
    let scenario = samples(scenario(), 70).last().unwrap();
    let case = pulled(&scenario.robot, &placed(disks_by_tension, &scenario).unwrap());
    let kind = ModelKind::CosseratDisks;
    let among = rod(kind, Actuation::Tension, &scenario.robot, &case);
    let Err(SolveError::Obstructed { why: Obstruction::NoneAlone { lost_at }, .. }) = among else {
        panic!("{among:?}");
    };
    let fine = whipcord::cosserat::Options {
        accuracy: whipcord::cosserat::Accuracy::Tolerance(1e-8),
        ..Default::default()
    };
    let case = Case { obstacles: Vec::new(), ..case };
    let alone = Model::CosseratDisks(fine).solve(&scenario.robot, &case).unwrap();
    assert!(alone.diagnostics.is_unstable());
    let lost = alone.diagnostics.stability_lost_at.unwrap();
    assert!((lost - lost_at.unwrap()).abs() < 0.02, "{lost}");
}

/// Robots of the study that are pulled by 13.8 to 15.7 EI/ℓ² in each span of length ℓ, and by 51 and 58. A chain of 40 rigid links in the place of a
/// span, moved against dampers under tensions that rise slowly, comes to rest under all of them, or its holes meet at this part of them.
#[test]
fn free_robots_lose_their_shape_where_the_holes_of_a_cable_meet() {
    let robots: Vec<Scenario> = samples(scenario(), 250).collect();
    for (number, lost_at) in
        [(1, None), (112, None), (249, None), (9, Some(0.338)), (12, Some(0.391))]
    {
        let Scenario { robot, case, .. } = &robots[number];
        let solution = disks_by_tension(robot, case).unwrap();
        let diagnostics = &solution.diagnostics;
        assert_eq!(diagnostics.stable, Some(lost_at.is_none()), "{number}");
        let told: Option<f64> = diagnostics.stability_lost_at;
        assert_eq!(told.is_some(), lost_at.is_some(), "{number}");
        let off = told.zip(lost_at).map_or(0.0, |(told, lost_at)| (told - lost_at).abs());
        assert!(off < 0.03, "{number}: {told:?}");
    }
}

/// Robots of the study whose spans bear so much that their verdict takes finer steps, with cables that stick in all of their holes.
#[test]
fn cables_that_stick_in_their_holes_count_as_held_in_the_verdict() {
    let robots: Vec<Scenario> = samples(scenario(), 33).collect();
    for number in [29, 30, 32] {
        let Scenario { robot, case, .. } = &robots[number];
        let solution = disks_by_tension(&rubbing(robot), case).unwrap();
        let diagnostics = &solution.diagnostics;
        println!("{number}: {:?} {:?}", diagnostics.stable, diagnostics.stability_absent);
        assert_eq!(diagnostics.stable.is_some(), diagnostics.stability_absent.is_none());
    }
}

/// The first robots of the study: nearly all have an answer, wherever they jump to on the way.
#[test]
fn nearly_all_robots_among_obstacles_are_solved() {
    for studied in MODELS {
        let name = studied.name;
        let outcomes = Outcomes::of(&studied, core::slice::from_ref(&(0..8)), false);
        outcomes.tell(name);
        let (solved, possible) = outcomes.solved();
        assert!(solved + 1 >= possible && possible > 2, "{name}: {outcomes:?}");
        let [watched, along] = outcomes.overlap;
        assert!(watched <= 1e-8 && along <= ALONG, "{name}: {outcomes:?}");
    }
}
