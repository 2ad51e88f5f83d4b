//! More straight cables held at their lengths than lengths are independent: whether one of them pulls depends
//! on which of the others do.

use crate::common::accurate;
use core::f64::consts::TAU;

use whipcord::cosserat::Options;
use whipcord::{
    Actuation, Cable, Case, Disks, Loads, Model, Robot, Routing, Shortening, Solution,
    Statics as _, Vec3,
};

use crate::common::{paper_backbone, tensions};

/// In units of EI/L² and EI/L the force is up to 30, nine times what buckles the rod alone, and the moment 7.
const LOADS: [(Vec3, Vec3); 3] = [
    (Vec3::new(0.3, -0.2, 0.5), Vec3::new(0.01, 0.0, 0.02)),
    (Vec3::new(-0.3, 0.4, -0.6), Vec3::new(-0.006, 0.012, 0.004)),
    (Vec3::new(1.5, 2.0, 3.0), Vec3::new(0.04, -0.07, -0.15)),
];

/// A robot with so many straight cables all round, and their shortenings in m: none, those of an arc, and
/// those of an arc that fit no shape of a rod that does not get shorter.
fn robot(cables: usize, disks: usize) -> Robot {
    let cable = |i: usize| {
        let angle = TAU * i as f64 / cables as f64;
        Cable::new(format!("c{i}"), Routing::Straight { angle, radius: 0.008 })
    };
    let disks = Disks::equally_spaced(0.18, disks, 0.008);
    Robot::new(paper_backbone(), disks, (0..cables).map(cable).collect()).unwrap()
}

fn shortenings(cables: usize) -> [Vec<f64>; 3] {
    let arc = |i: usize| 0.002 * (TAU * i as f64 / cables as f64 - 1.0).cos();
    let off = |i: usize| 3e-5 * (7.0 * i as f64).sin();
    [
        vec![0.0; cables],
        (0..cables).map(arc).collect(),
        (0..cables).map(|i| arc(i) + off(i)).collect(),
    ]
}

fn case(shortened: &[f64], load: usize) -> Case {
    let (tip_force, tip_moment) = LOADS[load];
    let lengths: Vec<Shortening> = shortened.iter().map(|&s| Shortening::Length(s)).collect();
    let loads = Loads { tip_force, tip_moment, ..Loads::default() };
    Case { loads, ..Case::with_shortenings(&lengths) }
}

/// Greatest amount in m by which a cable is too long, or pulls and is too short.
fn missed(solution: &Solution, shortened: &[f64]) -> f64 {
    let of_cable = |(cable, shortened): (&whipcord::CableState, &f64)| {
        let over = cable.length - (cable.initial_length - shortened);
        if cable.tension.unwrap() > 0.0 { over.abs() } else { over }
    };
    solution.cables.iter().zip(shortened).map(of_cable).fold(0.0, f64::max)
}

fn by_length() -> Options {
    Options { actuation: Actuation::Shortening, ..accurate() }
}

/// The answer is an equilibrium under its tensions, whichever cables have them.
#[test]
fn every_cable_pulls_at_its_length_or_is_slack() {
    for cables in [4, 5, 6, 8] {
        let robot = robot(cables, 10);
        for shortened in shortenings(cables) {
            for load in 0..LOADS.len() {
                let asked = case(&shortened, load);
                let label = format!("{cables} cables, {shortened:?}, load {load}");
                let mut models = vec![Model::Cosserat(by_length())];
                // The last load twists by a radian from disk to disk: ten are too few for it.
                if load < 2 {
                    models.push(Model::CosseratDisks(by_length()));
                }
                for model in models {
                    let solution =
                        model.solve(&robot, &asked).unwrap_or_else(|e| panic!("{label}: {e}"));
                    assert!(tensions(&solution).iter().all(|&t| t >= 0.0));
                    let missed = missed(&solution, &shortened);
                    assert!(missed < 1e-10, "{label}: {missed:.1e} m");
                }
            }
        }
    }
}

/// An independent check: cables straight from disk to disk pull alike as disks are added, at order two.
#[test]
fn with_more_disks_the_same_cables_pull() {
    for (cables, load) in [(4, 0), (5, 1), (6, 0), (8, 2)] {
        for shortened in shortenings(cables) {
            let asked = case(&shortened, load);
            let continuous =
                Model::Cosserat(by_length()).solve(&robot(cables, 10), &asked).unwrap();
            let with = |disks: usize| {
                let disks = robot(cables, disks);
                Model::CosseratDisks(by_length()).solve(&disks, &asked).unwrap()
            };
            let off = |disks: &Solution| {
                let tip = |solution: &Solution| solution.disks.tip().position;
                (tip(disks) - tip(&continuous)).norm()
            };
            let (coarse, fine) = (with(41), with(81));
            let ratio = off(&coarse) / off(&fine);
            assert!((3.8..4.2).contains(&ratio), "{cables} cables: {ratio}");
            let pulls = |s: &Solution| tensions(s).iter().map(|&t| t > 0.0).collect::<Vec<_>>();
            assert_eq!(pulls(&fine), pulls(&continuous));
        }
    }
}
