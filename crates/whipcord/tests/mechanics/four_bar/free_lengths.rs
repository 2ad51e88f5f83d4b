//! Several cables under the length rule `free`: every cable is as long as commanded, or marked slack, or the solve is
//! refused.

use proptest::prelude::*;
use whipcord::four_bar::{LengthRule, Objective, Options};
use whipcord::{Robot, Routing, Solution, SolveError};

use super::{equal_disks, robot, try_solve};

const LENGTH: f64 = 0.18;

fn options(strain: bool) -> Options {
    let objective = if strain { Objective::StrainEnergy } else { Objective::CouplerAngle };
    Options { objective, lengths: LengthRule::Free, ..Options::default() }
}

fn any_robot() -> impl Strategy<Value = Robot> {
    let cable = (0.0..core::f64::consts::TAU, -0.5..0.5_f64, proptest::bool::ANY);
    let routing = |(start_angle, turns, straight): (f64, f64, bool)| Routing::Helix {
        start_angle,
        turns: if straight { 0.0 } else { turns },
        radius: 0.008,
    };
    (prop::collection::vec(cable.prop_map(routing), 2..6), 2..10_usize)
        .prop_map(|(routings, sections)| robot(&equal_disks(LENGTH, sections), routings))
}

/// By how much the worst cable that is not marked slack misses its length, and any other exceeds it, by the length
/// of the backbone.
fn miss(solution: &Solution, shortenings: &[f64]) -> f64 {
    let of = |(cable, shortening): (&whipcord::CableState, &f64)| {
        let excess = cable.length - (cable.initial_length - shortening);
        if cable.slack { excess.max(0.0) } else { excess.abs() }
    };
    solution.cables.iter().zip(shortenings).map(of).fold(0.0, f64::max) / LENGTH
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: proptest::test_runner::RngSeed::Fixed(7),
        ..ProptestConfig::default()
    })]

    /// Whatever is commanded.
    #[test]
    fn lengths_are_met_or_marked_slack_or_refused(
        robot in any_robot(),
        pulls in prop::collection::vec(-0.02..0.02_f64, 6),
        strain: bool,
    ) {
        let pulls = &pulls[..robot.cables().len()];
        match try_solve(&robot, &options(strain), pulls) {
            Ok(solution) => {
                let miss = miss(&solution, pulls);
                prop_assert!(miss < 1e-8, "{miss:e} {:?}", solution.cables);
            }
            Err(SolveError::CablesConflict { excess, .. }) => {
                prop_assert!(excess > 1e-8 * LENGTH && excess < 0.04, "{excess}");
            }
            Err(SolveError::UnreachableLength { requested, reachable, .. }) => {
                prop_assert!(reachable < requested && reachable >= 0.0);
            }
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    /// The lengths of a shape that the robot has, all of them commanded.
    #[test]
    fn lengths_of_a_shape_are_met(
        robot in any_robot(),
        pull in 0.0..0.02_f64,
        strain: bool,
    ) {
        let cables = robot.cables().len();
        let mut alone = vec![-0.1; cables];
        alone[0] = pull;
        let there = try_solve(&robot, &options(strain), &alone).unwrap();
        let all: Vec<f64> = there.cables.iter().map(|c| c.initial_length - c.length).collect();
        let again = try_solve(&robot, &options(strain), &all).unwrap();
        let miss = miss(&again, &all);
        prop_assert!(miss < 1e-8, "{miss:e}");
        let apart = again.disks.distances(&there.disks).fold(0.0, f64::max);
        prop_assert!(apart < 1e-6 * LENGTH, "{apart:e}");
    }
}
