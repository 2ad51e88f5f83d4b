//! Whether a robot with cables straight from hole to hole stays in its equilibrium, with cables that
//! are held at their lengths and with cables that stick in their holes.

use crate::common;
use core::f64::consts::PI;

use crate::common::{helix, paper_backbone, straight};
use whipcord::{
    Cable, Case, Disks, Loads, Model, ModelKind, NoStability, Robot, Routing, Shortening, Solution,
    StabilityAnalysis, Statics as _, Vec3,
};

const LENGTH: f64 = 0.18;

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    let model = Model::new(kind, Default::default(), Default::default())
        .with_stability(StabilityAnalysis::Eigenvalue);
    model.solve(robot, case).unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn stability(kind: ModelKind, robot: &Robot, case: &Case) -> f64 {
    common::stability_of_path(&solve(kind, robot, case))
}

fn robot(sections: usize, cables: Vec<Cable>) -> Robot {
    let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.008);
    Robot::new(paper_backbone(), disks, cables).unwrap()
}

fn named(routings: &[Routing]) -> Vec<Cable> {
    let cable = |(i, routing): (usize, &Routing)| Cable::new(format!("c{i}"), routing.clone());
    routings.iter().enumerate().map(cable).collect()
}

fn pushed(force: f64) -> Loads {
    Loads { tip_force: Vec3::new(0.0, 0.0, -force), ..Loads::default() }
}

/// The lengths that the cables have in an answer.
fn lengths(solution: &Solution) -> Vec<Shortening> {
    let cut = |c: &whipcord::CableState| Shortening::Length(c.initial_length - c.length);
    solution.cables.iter().map(cut).collect()
}

/// Three straight cables that are locked keep the tip upright however few the disks are: it buckles
/// sideways, at `π² EI/L²` instead of `π²/4 EI/L²`, less what shear and compression take of it.
#[test]
fn locked_cables_hold_the_tip_upright() {
    for sections in [2, 5] {
        let held = robot(sections, named(&[straight(0.0), straight(120.0), straight(240.0)]));
        let euler = PI * PI * common::bending_stiffness(&held) / (LENGTH * LENGTH);
        let at = |share: f64| {
            // As long as on the straight rod under the load and cables that are hardly taut beside it.
            let axial = 1.1e9 * PI * 0.003_f64.powi(2) / 4.0;
            let force = share * euler;
            let cut = Shortening::Length(LENGTH * (force + 3e-4) / axial);
            let locked = Case { loads: pushed(force), ..Case::with_shortenings(&[cut; 3]) };
            stability(ModelKind::CosseratDisks, &held, &locked)
        };
        let (before, beyond) = (at(0.995), at(1.003));
        assert!(before > 0.0 && beyond < 0.0, "{sections}: {before} {beyond}");
    }
}

#[test]
fn with_many_disks_it_is_that_of_the_continuous_model() {
    let routings = [straight(0.0), straight(120.0), helix(240.0, 0.2), straight(80.0)];
    for tip_force in [Vec3::new(0.0, 0.0, -0.25), Vec3::new(0.05, -0.08, -0.2)] {
        let loads = Loads { tip_force, ..Loads::default() };
        let difference = |sections: usize| {
            let robot = robot(sections, named(&routings));
            let pulled =
                Case { loads: loads.clone(), ..Case::with_tensions(&[2.0, 1.0, 0.7, 0.3]) };
            let of = |kind| {
                // The same tensions, held by the lengths that they give in that model.
                let cut = lengths(&solve(kind, &robot, &pulled));
                let mut locked = Case { loads: loads.clone(), ..Case::with_shortenings(&cut) };
                locked.commands[3] = pulled.commands[3];
                stability(kind, &robot, &locked)
            };
            let free = stability(ModelKind::CosseratDisks, &robot, &pulled);
            let locked = of(ModelKind::CosseratDisks);
            assert!(locked > 1.5 * free, "{locked} {free}");
            (locked - of(ModelKind::Cosserat)).abs()
        };
        let (coarse, fine) = (difference(8), difference(16));
        assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
    }
}

/// A locked cable that stretches without end is one at constant tension; one that hardly stretches is
/// one that does not.
#[test]
fn elastic_cables_hold_it_like_springs() {
    let with = |stiffness: Option<f64>| {
        let mut cables = named(&[straight(0.0), helix(120.0, 0.3), straight(240.0)]);
        for cable in &mut cables {
            cable.axial_stiffness = stiffness;
        }
        let robot = robot(6, cables);
        let pulled = Case::with_tensions(&[2.0, 1.0, 0.5]);
        let solution = solve(ModelKind::CosseratDisks, &robot, &pulled);
        let cut = solution.cables.iter().map(|cable| {
            let stretch =
                stiffness.map_or(0.0, |k| cable.initial_length * cable.tension.unwrap() / k);
            Shortening::Length(cable.initial_length - cable.length + stretch)
        });
        let locked = Case::with_shortenings(&cut.collect::<Vec<_>>());
        let of = |case| stability(ModelKind::CosseratDisks, &robot, case);
        (of(&pulled), of(&locked))
    };
    let [soft, middle, hard, rigid] =
        [Some(20.0), Some(2e3), Some(1e7), None].map(|stiffness| with(stiffness).1);
    let free = with(None).0;
    assert!(free < soft && soft < middle && middle < hard && hard <= rigid);
    assert!((hard - rigid).abs() < 1e-3 * rigid, "{hard} {rigid}");
}

/// In a robot of one section cables that stick in the base holes are cables that are held at their
/// lengths; where one slides, or is about to, nothing is said.
#[test]
fn cables_that_stick_are_held() {
    let with = |friction| -> Vec<Cable> {
        let around = named(&[straight(0.0), straight(120.0), straight(240.0)]);
        around.into_iter().map(|cable| Cable { friction, ..cable }).collect()
    };
    let (rubs, free) = (robot(1, with(Some(0.3))), robot(1, with(None)));
    let steps = |steps: &[[f64; 3]]| {
        let (last, before) = steps.split_last().unwrap();
        let before = before.iter().map(|t| Case::with_tensions(t).commands).collect();
        Case { before, loads: pushed(0.1), ..Case::with_tensions(last) }
    };
    // More would buckle the one long section between its disks.
    let (pull, back) = ([0.3, 0.12, 0.1], [0.299, 0.1203, 0.1003]);
    let of = |case: &Case| solve(ModelKind::CosseratDisks, &rubs, case);
    assert_eq!(of(&steps(&[pull])).diagnostics.stability, None);
    let absent = of(&steps(&[pull])).diagnostics.stability_absent;
    assert_eq!(absent, Some(NoStability::Sliding));
    // Once more the same: nothing moves, but a little more would.
    assert_eq!(of(&steps(&[pull, pull])).diagnostics.stability, None);
    let stuck = of(&steps(&[pull, back]));
    let held = Case { loads: pushed(0.1), ..Case::with_shortenings(&lengths(&stuck)) };
    let expected = stability(ModelKind::CosseratDisks, &free, &held);
    let found = stuck.diagnostics.stability.unwrap();
    assert!((found - expected).abs() < 1e-5 * expected, "{found} {expected}");
    let loose = Case { loads: pushed(0.1), ..Case::with_tensions(&pull) };
    assert!(found > 2.0 * stability(ModelKind::CosseratDisks, &free, &loose), "{found}");
    // Wound up by its length a cable is held whatever the base hole does.
    let wound = stability(ModelKind::CosseratDisks, &rubs, &held);
    assert!((wound - expected).abs() < 1e-5 * expected, "{wound} {expected}");
}

/// However strong the bend: a cable that was pulled through its holes holds nothing there.
#[test]
fn a_cable_that_slid_leaves_nothing_to_say() {
    let cable = Cable { friction: Some(0.3), ..Cable::new("a", straight(0.0)) };
    let robot = robot(9, vec![cable]);
    for shortening in [0.02, 0.04, 0.06] {
        let case = Case::with_shortenings(&[Shortening::Length(shortening)]);
        let solution = solve(ModelKind::CosseratDisks, &robot, &case);
        assert_eq!(solution.diagnostics.stability, None, "{shortening}");
    }
}
