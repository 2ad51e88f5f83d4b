//! Cables that are anchored to the rod between two disks.

use core::f64::consts::PI;

use crate::common::{accurate, bending_stiffness, helix, lengths_of, paper_backbone, straight};
use crate::contact::{among, sphere};
use whipcord::batch::{BatchOptions, Rows, solve_batch};
use whipcord::cosserat::Accuracy;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Actuation, BranchOptions, Cable, Case, Differentiable as _, Disks, DistributedLoad, Loads,
    Model, Parameter, PointLoad, Profile, Robot, Routing, Solution, StabilityAnalysis,
    Statics as _, Stations, Vec3,
};

const LENGTH: f64 = 0.18;
const RADIUS: f64 = 0.008;

fn with(disks: Disks, cables: Vec<Cable>) -> Robot {
    Robot::new(paper_backbone(), disks, cables).unwrap()
}

fn anchored(routing: Routing, at: f64) -> Cable {
    Cable { ends_at: Some(at), ..Cable::new(format!("to {at}"), routing) }
}

fn options() -> Options {
    Options { stations: Stations::Equal(7), ..accurate() }
}

fn solve_as(options: Options, robot: &Robot, case: &Case) -> Solution {
    Model::CosseratDisks(options)
        .solve(robot, case)
        .unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn solve(robot: &Robot, case: &Case) -> Solution {
    solve_as(options(), robot, case)
}

/// The greatest distance between stations.
fn apart(a: &Solution, b: &Solution) -> f64 {
    a.shape.distances(&b.shape).fold(0.0, f64::max)
}

/// Dead and follower loads, at places and spread, on both sides of the anchors.
fn loads() -> Loads {
    let spread = |from: f64, to: f64, force, follower| DistributedLoad {
        profile: Profile::Constant { from, to, force, moment: Vec3::new(0.0, 2e-3, 1e-3) },
        follower,
    };
    Loads {
        tip_force: Vec3::new(0.03, -0.05, 0.02),
        points: vec![
            PointLoad {
                at: 0.1,
                force: Vec3::new(0.0, 0.05, 0.0),
                moment: Vec3::new(1e-3, 0.0, 2e-3),
                follower: true,
            },
            PointLoad { at: 0.124, force: Vec3::new(0.02, 0.03, 0.0), ..PointLoad::default() },
        ],
        distributed: vec![
            spread(0.09, 0.15, Vec3::new(0.2, 0.1, 0.0), false),
            spread(0.1, 0.13, Vec3::new(-0.1, 0.2, 0.0), true),
        ],
        ..Loads::default()
    }
}

/// Two cables end in the same span, which no other crosses: a disk more at each anchor changes nothing.
#[test]
fn a_disk_at_the_anchor_changes_nothing_where_no_cable_crosses_the_span() {
    let places = [0.06, 0.12, LENGTH];
    let cables = |stiff: Option<f64>, friction: Option<f64>| {
        let of = |cable: Cable| Cable { axial_stiffness: stiff, friction, ..cable };
        vec![of(anchored(helix(30.0, 0.4), 0.121)), of(anchored(straight(200.0), 0.06))]
    };
    let robots = |stiff, friction| {
        let at = |more: &[f64]| {
            let mut at = vec![0.0];
            at.extend(places);
            at.extend(more);
            at.sort_by(f64::total_cmp);
            let count = at.len();
            Disks {
                arc_lengths: at,
                hole_circle_radii: vec![RADIUS; count],
                ..Disks::equally_spaced(LENGTH, count, RADIUS)
            }
        };
        [at(&[]), at(&[0.121])].map(|disks| with(disks, cables(stiff, friction)))
    };
    for loads in [Loads::default(), loads()] {
        for (stiff, friction) in [(None, None), (Some(300.0), None), (None, Some(0.2))] {
            let robots = robots(stiff, friction);
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&[3.0, 1.0]) };
            let [ours, other] = [0, 1].map(|i| solve(&robots[i], &case));
            let off = apart(&ours, &other);
            assert!(off < 1e-8 * LENGTH, "{off} {stiff:?} {friction:?} {loads:?}");
            let lengths = lengths_of(&ours, &loads);
            let driven = Options { actuation: Actuation::Shortening, ..options() };
            if friction.is_some() || stiff.is_some() {
                continue;
            }
            let again = solve_as(driven, &robots[0], &lengths);
            assert!(apart(&ours, &again) < 1e-7 * LENGTH, "{}", apart(&ours, &again));
            for (a, b) in again.cables.iter().zip(&other.cables) {
                let (a, b) = (a.tension.unwrap(), b.tension.unwrap());
                assert!((a - b).abs() < 1e-6 * b, "{a} {b}");
            }
        }
    }
    // Under dead loads alone there is a measure of stability, with tensions and with lengths held.
    let loads = Loads { tip_force: Vec3::new(0.03, 0.02, -0.1), ..Loads::default() };
    let robots = robots(None, None);
    let case = Case { loads: loads.clone(), ..Case::with_tensions(&[3.0, 1.0]) };
    let held = lengths_of(&solve(&robots[1], &case), &loads);
    for (actuation, case) in [(Actuation::Tension, &case), (Actuation::Shortening, &held)] {
        let [ours, other] = [0, 1].map(|i| {
            let stability = StabilityAnalysis::Eigenvalue;
            let options = Options { actuation, stability, ..options() };
            solve_as(options, &robots[i], case).diagnostics.stability.unwrap()
        });
        assert!((ours - other).abs() < 1e-5 * other.abs(), "{actuation:?}: {ours} {other}");
    }
}

/// Cables that cross the span of the anchor.
fn crossed(at: f64) -> Robot {
    let through = [helix(100.0, 0.3), straight(230.0)].map(|r| Cable::new(format!("{r:?}"), r));
    let mut cables = vec![anchored(helix(20.0, 0.4), at), anchored(straight(150.0), at - 0.004)];
    cables.extend(through);
    with(Disks::equally_spaced(LENGTH, 7, RADIUS), cables)
}

fn pulled() -> Case {
    Case::with_tensions(&[2.0, 1.0, 1.5, 0.7])
}

/// An anchor beside a disk tends to one at the disk, from both sides and linearly with the distance.
#[test]
fn an_anchor_beside_a_disk_tends_to_one_at_the_disk() {
    for loads in [Loads::default(), loads()] {
        let case = Case { loads, ..pulled() };
        let disk = 0.12;
        let at_disk = solve(&crossed(disk), &case);
        for side in [-1.0, 1.0] {
            let off =
                |distance: f64| apart(&solve(&crossed(disk + side * distance), &case), &at_disk);
            // The second anchor moves along.
            let [far, near] = [1e-4, 1e-5].map(off);
            assert!(near < 1e-5 && (8.0..12.0).contains(&(far / near)), "{side} {far} {near}");
            let nearest = off(3e-6 * LENGTH);
            assert!(nearest < 2e-6, "{side} {nearest}");
        }
    }
}

/// A plane rod of links from the base to the tip in one span, bent by cables that are drawn from the base disk to the tip
/// disk and to an anchor: the least of `½ EI/h Σ δφ² + Σ τ ℓ − F x` by Newton's method.
fn least_energy(
    links: usize,
    stiffness: f64,
    anchor: usize,
    (r, tensions): ([f64; 2], [f64; 2]),
) -> Vec<f64> {
    let h = LENGTH / links as f64;
    let gradient = |phi: &[f64]| -> Vec<f64> {
        // Positions of the nodes and what a unit of each angle moves them by.
        let mut place = vec![[0.0, 0.0]];
        for i in 0..links {
            let between = 0.5 * (if i > 0 { phi[i - 1] } else { 0.0 } + phi[i]);
            let [x, z] = place[i];
            place.push([x + h * between.sin(), z + h * between.cos()]);
        }
        let mut out = vec![0.0; links];
        for i in 0..links {
            let before = if i > 0 { phi[i - 1] } else { 0.0 };
            out[i] += stiffness / h * (phi[i] - before);
            if i > 0 {
                out[i - 1] -= stiffness / h * (phi[i] - before);
            }
        }
        for (end, (r, tension)) in [links, anchor].into_iter().zip(r.into_iter().zip(tensions)) {
            let angle = phi[end - 1];
            let way = [place[end][0] + r * angle.cos() - r, place[end][1] - r * angle.sin()];
            let length = way[0].hypot(way[1]);
            let t = way.map(|x| x / length);
            for i in 0..end {
                let before = if i > 0 { phi[i - 1] } else { 0.0 };
                let between = 0.5 * (before + phi[i]);
                let by = 0.5 * h * (t[0] * between.cos() - t[1] * between.sin()) * tension;
                out[i] += by;
                if i > 0 {
                    out[i - 1] += by;
                }
            }
            out[end - 1] += tension * (-t[0] * r * angle.sin() - t[1] * r * angle.cos());
        }
        out
    };
    let mut phi = vec![0.0; links];
    for _ in 0..40 {
        let g = gradient(&phi);
        let mut matrix = vec![vec![0.0; links + 1]; links];
        for j in 0..links {
            let step = 1e-6;
            let at = |by: f64| {
                let mut moved = phi.clone();
                moved[j] += by;
                gradient(&moved)
            };
            let (ahead, behind) = (at(step), at(-step));
            for i in 0..links {
                matrix[i][j] = (ahead[i] - behind[i]) / (2.0 * step);
            }
        }
        for i in 0..links {
            matrix[i][links] = -g[i];
        }
        for i in 0..links {
            for k in i + 1..links {
                let f = matrix[k][i] / matrix[i][i];
                for j in i..=links {
                    matrix[k][j] -= f * matrix[i][j];
                }
            }
        }
        let mut most: f64 = 0.0;
        let mut change = vec![0.0; links];
        for i in (0..links).rev() {
            let known: f64 = (i + 1..links).map(|j| matrix[i][j] * change[j]).sum();
            change[i] = (matrix[i][links] - known) / matrix[i][i];
            most = most.max(change[i].abs());
        }
        phi.iter_mut().zip(&change).for_each(|(phi, change)| *phi += change);
        if most < 1e-12 {
            break;
        }
    }
    phi
}

/// One span with a cable to the tip and one to an anchor at mid-span: of all shapes it has that of the least energy.
#[test]
fn a_crossed_span_has_the_shape_of_the_least_energy() {
    let mut backbone = paper_backbone();
    (backbone.extensible, backbone.shearable) = (false, false);
    let cables = vec![
        Cable::new("through", straight(0.0)),
        anchored(Routing::Straight { angle: PI, radius: 0.006 }, 0.5 * LENGTH),
    ];
    let robot = Robot::new(backbone, Disks::equally_spaced(LENGTH, 2, RADIUS), cables).unwrap();
    let stiffness = bending_stiffness(&robot);
    for tensions in [[0.5, 0.0], [0.0, 2.5], [0.7, 1.2], [0.3, 2.5]] {
        let solution = solve(&robot, &Case::with_tensions(&tensions));
        let angle = |links: usize, anchor: usize, at: usize| {
            least_energy(links, stiffness, anchor, ([RADIUS, -0.006], tensions))[at - 1]
        };
        for (station, part) in [(3, 0.5), (6, 1.0)] {
            let at = |links: usize| angle(links, links / 2, (part * links as f64) as usize);
            let (coarse, fine) = (at(24), at(48));
            let exact = fine + (fine - coarse) / 3.0;
            let ours = solution.shape.poses[station].rotation.log().y;
            assert!((ours - exact).abs() < 2e-5, "{tensions:?} {part}: {ours} {exact}");
        }
    }
}

/// A straight cable that ends at mid-span bends the rod by τ r up to its anchor while it bends little, and not at all beyond.
#[test]
fn the_rod_is_straight_beyond_the_anchor_of_the_only_cable() {
    let at = 0.5 * LENGTH;
    let robot = with(Disks::equally_spaced(LENGTH, 2, RADIUS), vec![anchored(straight(0.0), at)]);
    let solution = solve(&robot, &Case::with_tensions(&[0.01]));
    let bend = |k: usize| solution.shape.poses[k].rotation.log().y;
    let exact = 0.01 * RADIUS * at / bending_stiffness(&robot);
    assert!((bend(3) - exact).abs() < 1e-2 * exact, "{} {exact}", bend(3));
    assert!((bend(6) - bend(3)).abs() < 1e-12);
}

/// The cable of a central hole presses the rod by its tension up to its anchor. It goes through the base, which the rod
/// buckles towards at `π² EI/s²`, whatever else pulls little.
#[test]
fn a_central_cable_to_an_anchor_buckles_its_part_of_the_span() {
    let at = 0.7 * LENGTH;
    let central = Routing::Straight { angle: 0.0, radius: 0.0 };
    let robot = |disks: usize| {
        let mut backbone = paper_backbone();
        (backbone.extensible, backbone.shearable) = (false, false);
        let disks = Disks::equally_spaced(LENGTH, disks, RADIUS);
        Robot::new(backbone, disks, vec![anchored(central.clone(), at)]).unwrap()
    };
    let robot = robot(2);
    let critical = PI * PI * bending_stiffness(&robot) / (at * at);
    for (part, stable) in [(0.99, true), (1.01, false)] {
        let solution = solve(&robot, &Case::with_tensions(&[part * critical]));
        assert_eq!(solution.diagnostics.is_unstable(), !stable, "{part}");
    }
}

/// Where a crossed span loses its stability the compliance grows without bound.
#[test]
fn a_crossed_span_loses_its_stability_where_its_compliance_is_unbounded() {
    let mut backbone = paper_backbone();
    (backbone.extensible, backbone.shearable) = (false, false);
    let central = Routing::Straight { angle: 0.0, radius: 0.0 };
    let mut cables = vec![anchored(central, 0.11)];
    cables.extend([0.0, 120.0, 240.0].map(|angle| Cable::new(format!("{angle}"), straight(angle))));
    let robot = Robot::new(backbone, Disks::equally_spaced(LENGTH, 2, RADIUS), cables).unwrap();
    let case = |tension: f64| Case::with_tensions(&[tension, 0.2, 0.2, 0.2]);
    let critical = PI * PI * bending_stiffness(&robot) / (0.11 * 0.11);
    let (mut low, mut high) = (0.1 * critical, 2.0 * critical);
    let unstable = |tension: f64| {
        let stability = StabilityAnalysis::Eigenvalue;
        let solution = solve_as(Options { stability, ..options() }, &robot, &case(tension));
        solution.diagnostics.stability.unwrap() < 0.0
    };
    assert!(!unstable(low) && unstable(high));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if unstable(middle) { high = middle } else { low = middle }
    }
    let compliance = |tension: f64| {
        // A straight rod is as straight in few steps.
        let options = Options { accuracy: Accuracy::Steps(48), ..options() };
        let model = Model::CosseratDisks(options);
        let (_, local) = model.solve_at(&robot, &case(tension), LENGTH).unwrap();
        local.compliances.unwrap().tensions_held.compliance.rows()[0][0]
    };
    let [far, near] = [0.01, 0.001].map(|below| compliance(low * (1.0 - below)));
    assert!((9.5..10.5).contains(&(near / far)), "{near} {far}");
}

/// What is found by tensions is found again by its lengths, loaded or not, and elastic cables stretch.
#[test]
fn lengths_lead_back_to_the_tensions() {
    for loads in [Loads::default(), loads()] {
        for stiff in [None, Some(400.0)] {
            let robot = crossed(0.131);
            let cables = robot
                .cables()
                .iter()
                .map(|cable| Cable { axial_stiffness: stiff, ..cable.clone() });
            let robot = with(robot.disks().clone(), cables.collect());
            let case = Case { loads: loads.clone(), ..pulled() };
            let found = solve(&robot, &case);
            let mut lengths = lengths_of(&found, &loads);
            if let Some(stiffness) = stiff {
                for (command, cable) in lengths.commands.iter_mut().zip(&found.cables) {
                    let stretch = cable.tension.unwrap() * cable.initial_length / stiffness;
                    command.shortening = Some(whipcord::Shortening::Length(
                        cable.initial_length - cable.length + stretch,
                    ));
                }
            }
            let driven = Options { actuation: Actuation::Shortening, ..options() };
            let again = solve_as(driven, &robot, &lengths);
            assert!(apart(&found, &again) < 1e-7 * LENGTH, "{}", apart(&found, &again));
        }
    }
}

/// The work of the tensions is that of a potential: how one tension changes the length of another cable is how that changes the
/// first, and without load lengths are the derivatives of the least energy.
#[test]
fn tensions_and_lengths_are_reciprocal() {
    let robot = crossed(0.131);
    for loads in
        [Loads::default(), Loads { tip_force: Vec3::new(0.05, 0.02, 0.0), ..Loads::default() }]
    {
        let lengths = |cable: usize, by: f64| {
            let mut tensions = [2.0, 1.0, 1.5, 0.7];
            tensions[cable] += by;
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
            let options = Options { accuracy: Accuracy::Steps(96), ..options() };
            solve_as(options, &robot, &case).cables.iter().map(|c| c.length).collect::<Vec<_>>()
        };
        let rate = |of: usize, by: usize| {
            let step = 1e-3;
            (lengths(by, step)[of] - lengths(by, -step)[of]) / (2.0 * step)
        };
        for (i, j) in [(0, 1), (0, 2), (1, 3), (0, 3)] {
            let (a, b) = (rate(i, j), rate(j, i));
            let size = (rate(i, i) * rate(j, j)).sqrt();
            assert!((a - b).abs() < 1e-6 * size, "{i} {j}: {a} {b}");
        }
    }
}

/// Friction at the holes of a cable that ends between two disks which others cross: at its tensions, span by span, the robot
/// without friction has the same shape.
#[test]
fn a_cable_with_friction_may_end_between_disks() {
    let robot = crossed(0.131);
    let rubbing = |cable: &Cable| Cable { friction: Some(0.25), ..cable.clone() };
    let rubbing = with(robot.disks().clone(), robot.cables().iter().map(rubbing).collect());
    for loads in [Loads::default(), loads()] {
        let case = Case { loads: loads.clone(), ..pulled() };
        let solution = solve(&rubbing, &case);
        let free = solve(&robot, &case);
        assert!(apart(&solution, &free) > 1e-4);
        // Five holes in which the first turns, and the base.
        assert_eq!(solution.cables[0].span_tensions.len(), 5);
        let tensions = &solution.cables[0].span_tensions;
        assert!(tensions.windows(2).all(|pair| pair[1] <= pair[0]), "{tensions:?}");
    }
}

#[test]
fn branches_contacts_batches_and_derivatives_take_anchors() {
    let robot = crossed(0.131);
    let model = Model::CosseratDisks(Options::default());
    let case = Case {
        loads: Loads { tip_force: Vec3::new(0.0, 0.02, -0.6), ..Loads::default() },
        ..pulled()
    };
    let mut prepared = model.prepare(&robot, &case.loads).unwrap();
    let found = prepared.branches(&case, &BranchOptions::default()).unwrap();
    assert!(!found.equilibria.is_empty());
    // A ball against the tip: with its force as a load the robot has the same shape.
    let free = model.solve(&robot, &pulled()).unwrap();
    let tip = free.disks.tip().position;
    let ball = sphere(tip + Vec3::new(0.012, 0.0, 0.01), 0.01);
    let among = among(pulled(), vec![ball]);
    let solution = model.solve(&robot, &among).unwrap();
    assert!(!solution.contacts.is_empty());
    let (pushes, _) = crate::contact::pushes_of(&solution);
    let alone = Case { loads: pushes, ..pulled() };
    let again = model.solve(&robot, &alone).unwrap();
    let apart = again.disks.distances(&solution.disks).fold(0.0, f64::max);
    assert!(apart < 1e-5 * LENGTH, "{apart}");
    // On the steps that keep it where it is.
    let parameters = [Parameter::YoungModulus, Parameter::Radius { cable: 1 }];
    let mut prepared = model.prepare(&robot, &among.loads).unwrap();
    prepared.solve_with_derivatives(&among, None, &parameters).unwrap();
    let case = pulled();
    let values = [2.0, 1.0, 1.5, 0.7, 1.0, 0.5, 1.0, 0.3];
    let rows = Rows::Tensions { values: &values, case: &case };
    let batch = solve_batch(&model, &robot, rows, &BatchOptions::default()).unwrap();
    assert!(batch.outcomes().iter().all(Result::is_ok));
}
