//! Loads that are spread along the backbone, and masses on it.
//!
//! Rods have length 1 and EI = 1, and are so slender that stretch and shear count for nothing unless
//! a test says so.

use crate::common;
use core::f64::consts::PI;

use crate::common::{fine_options, paper_robot, round, solve_finely, solve_with, straight};
use crate::oracle::Oracle;
use whipcord::cosserat::{Accuracy, Cosserat, Options, Workspace};
use whipcord::derivatives::{Hold, Place};
use whipcord::{
    Backbone, Case, Disks, DistributedLoad, LoadFrame, Loads, Material, Parameter, PointLoad,
    PointMass, Pose, Profile, Robot, Solution, SolveError, StabilityAnalysis, UnitQuaternion, Vec3,
};

const GREENHILL: f64 = 7.837_347_438_943_484;

/// Length 1, EI = 1 and this diameter: `EI/(EA L²) = d²/16`.
fn rod_of(diameter: f64) -> Backbone {
    let young = 64.0 / (PI * diameter.powi(4));
    round(1.0, diameter, young, 0.35 * young)
}

fn slender() -> Robot {
    Robot::new(rod_of(1e-5), Disks::equally_spaced(1.0, 5, 0.01), vec![]).unwrap()
}

fn spread(loads: Vec<DistributedLoad>) -> Case {
    Case { loads: Loads { distributed: loads, ..Loads::default() }, ..Case::default() }
}

fn uniform(force: Vec3) -> DistributedLoad {
    DistributedLoad::uniform(1.0, force)
}

fn twisting(moment: Vec3) -> DistributedLoad {
    let profile = Profile::Constant { from: 0.0, to: 1.0, force: Vec3::ZERO, moment };
    DistributedLoad { profile, follower: false }
}

fn linear(at: &[f64], force: &[Vec3]) -> DistributedLoad {
    let profile = Profile::Linear { at: at.to_vec(), force: force.to_vec(), moment: vec![] };
    DistributedLoad { profile, follower: false }
}

fn largest_difference(a: &Solution, b: &Solution) -> f64 {
    a.shape.distances(&b.shape).chain(a.disks.distances(&b.disks)).fold(0.0, f64::max)
}

/// `w L⁴/8EI + w L²/2GA`, `w L⁴/30EI + w L²/6GA` where the load falls to nothing at the tip,
/// `11 w L⁴/120EI + w L²/3GA` where it rises from nothing at the base, and, on a stretch from a to b,
/// the integral of a point load's `s²(3L − s)/6EI + s/GA` (Timoshenko beam). The square of the load
/// is eliminated by Richardson's extrapolation.
#[test]
fn small_deflections_are_those_of_beam_theory() {
    let rod = Robot::new(rod_of(0.05), Disks::equally_spaced(1.0, 3, 0.1), vec![]).unwrap();
    let area = rod.backbone().section_at(rod.disks(), 0.0).unwrap().area;
    let shear = rod.backbone().material.shear_modulus().unwrap() * area;
    let influence = |s: f64| s.powi(3) / 6.0 - s.powi(4) / 24.0 + s * s / (2.0 * shear);
    let x = Vec3::X;
    let stretch = Profile::Constant { from: 0.3, to: 0.7, force: x, moment: Vec3::ZERO };
    let cases = [
        (uniform(x), 1.0 / 8.0 + 0.5 / shear),
        (linear(&[0.0, 1.0], &[x, Vec3::ZERO]), 1.0 / 30.0 + 1.0 / (6.0 * shear)),
        (linear(&[0.0, 1.0], &[Vec3::ZERO, x]), 11.0 / 120.0 + 1.0 / (3.0 * shear)),
        (DistributedLoad { profile: stretch, follower: false }, influence(0.7) - influence(0.3)),
        // A moment about y bends by m L³/3EI.
        (twisting(Vec3::Y), 1.0 / 3.0),
    ];
    for (load, expected) in cases {
        for follower in [false, true] {
            let per_load = |size: f64| {
                let scaled = DistributedLoad { profile: times(&load.profile, size), follower };
                solve_finely(&rod, &spread(vec![scaled])).disks.tip().position.x / size
            };
            let linear = (4.0 * per_load(5e-3) - per_load(1e-2)) / 3.0;
            assert!((linear / expected - 1.0).abs() < 2e-8, "{load:?}: {linear} {expected}");
        }
    }
}

fn times(profile: &Profile, factor: f64) -> Profile {
    let scale = |list: &[Vec3]| list.iter().map(|&v| factor * v).collect();
    match profile {
        &Profile::Constant { from, to, force, moment } => {
            Profile::Constant { from, to, force: factor * force, moment: factor * moment }
        }
        Profile::Linear { at, force, moment } => {
            Profile::Linear { at: at.clone(), force: scale(force), moment: scale(moment) }
        }
    }
}

/// Inextensible cantilever under a dead load across it: size, base moment, slope, transverse and axial
/// position of the tip, from `θ″ = −V(s) cos θ` by shooting (SciPy's DOP853 at 1e-13).
#[test]
fn large_deflections_under_dead_loads_are_those_of_the_elastica() {
    let across = |size: f64| uniform(Vec3::X * size);
    let falling = |size: f64| linear(&[0.0, 1.0], &[Vec3::X * size, Vec3::ZERO]);
    let references = [
        (
            across(1.0),
            [
                0.496_933_399_930_717,
                0.165_115_560_502_441,
                0.123_471_401_983_352,
                0.991_246_395_346_636,
            ],
        ),
        (
            across(5.0),
            [
                2.226_892_553_812_13,
                0.697_004_777_536_496,
                0.495_905_044_622_392,
                0.846_657_179_954_259,
            ],
        ),
        (
            across(10.0),
            [
                3.742_191_110_871_56,
                1.052_643_117_196_805,
                0.700_199_715_514_311,
                0.656_353_761_238_602,
            ],
        ),
        (
            across(20.0),
            [
                5.761_532_585_829_24,
                1.339_501_541_737_222,
                0.829_881_443_439_313,
                0.445_232_052_239_6,
            ],
        ),
        (
            falling(10.0),
            [
                1.612_523_594_175_52,
                0.395_201_180_939_266,
                0.310_281_260_252_692,
                0.944_881_714_250_291,
            ],
        ),
        (
            falling(40.0),
            [
                5.075_444_452_610_35,
                1.059_336_437_809_622,
                0.739_538_507_262_053,
                0.619_549_557_647_354,
            ],
        ),
    ];
    for (load, [moment, slope, x, z]) in references {
        let solution = solve_finely(&slender(), &spread(vec![load]));
        let tip = solution.disks.tip();
        assert!((tip.position - Vec3::new(x, 0.0, z)).norm() < 1e-9, "{:?}", tip.position);
        assert!((tip.rotation.log().y - slope).abs() < 1e-9);
        assert!((solution.base_wrench.unwrap().moment.y - moment).abs() < 1e-9);
    }
}

/// Inextensible cantilever under a pressure that stays across it: size, base moment, slope, transverse
/// and axial position of the tip, from an initial value problem started at the tip (SciPy's DOP853
/// at 1e-13). What the pressure exerts on the base is that on the chord, `p (Δz, −Δx)`.
#[test]
fn large_deflections_under_pressure_are_those_of_the_elastica() {
    for [p, moment, slope, x, z] in [
        [
            1.0,
            0.498_886_223_451_062,
            0.166_542_811_811_943,
            0.124_443_731_974_619,
            0.991_103_528_635_81,
        ],
        [
            5.0,
            2.367_326_011_363_8,
            0.818_294_510_385_758,
            0.560_423_244_407_959,
            0.795_522_590_296_955,
        ],
        [
            10.0,
            4.074_672_634_751_98,
            1.556_046_432_549_164,
            0.830_147_854_019_838,
            0.354_667_544_915_862,
        ],
        [
            20.0,
            5.109_379_199_117_47,
            2.654_538_562_249_861,
            0.652_643_895_009_354,
            -0.291_537_075_204_441,
        ],
        [
            40.0,
            3.464_469_395_058_67,
            3.697_081_553_706_715,
            0.150_031_852_366_22,
            -0.388_218_898_340_218,
        ],
    ] {
        let solution = solve_finely(&slender(), &spread(vec![uniform(Vec3::X * p).following()]));
        let tip = solution.disks.tip();
        assert!((tip.position - Vec3::new(x, 0.0, z)).norm() < 1e-9, "{p}: {:?}", tip.position);
        // The quaternion knows more than half a turn.
        let turn = 2.0 * tip.rotation.v.y.atan2(tip.rotation.w);
        assert!((turn - slope).abs() < 1e-9, "{p}: {turn}");
        let base = solution.base_wrench.unwrap();
        assert!((base.moment.y - moment).abs() < 1e-8, "{p}");
        assert!((base.force - p * Vec3::new(z, 0.0, -x)).norm() < 1e-8 * p, "{p}");
        assert_eq!(solution.diagnostics.stability, None);
    }
}

/// A moment `m` per length about y, dead or not, bends the rod in its plane to `θ = m (s − s²/2)`; one
/// about the axis that follows twists it by as much.
#[test]
fn distributed_moments_bend_and_twist() {
    // ∫ sin θ ds and ∫ cos θ ds by SciPy's quad.
    for [m, x, z] in [
        [1.0, 0.323_905_232_096_089, 0.934_384_163_331_167],
        [6.0, 0.567_110_923_499_552, -0.329_218_975_805_752],
    ] {
        let dead = twisting(Vec3::Y * m);
        for load in [dead.clone(), dead.following()] {
            let tip = solve_finely(&slender(), &spread(vec![load])).disks.tip();
            assert!((tip.position - Vec3::new(x, 0.0, z)).norm() < 1e-9);
            assert!((2.0 * tip.rotation.v.y.atan2(tip.rotation.w) - 0.5 * m).abs() < 1e-10);
        }
    }
    // GJ is 0.35 · 2 EI.
    let twist = solve_finely(&slender(), &spread(vec![twisting(Vec3::Z).following()]));
    assert!((twist.disks.tip().rotation.log().z - 0.5 / 0.7).abs() < 1e-10);
}

/// The column of Greenhill, its weight given as a density, as a dead load along it, and as the masses
/// that a fine list of them is; each changes its stability at the load.
#[test]
fn a_column_buckles_under_any_form_of_its_weight() {
    let down = |weight: f64| uniform(Vec3::Z * -weight);
    let masses = |weight: f64| {
        const COUNT: usize = 400;
        let mass = |i: usize| PointMass {
            at: (i as f64 + 0.5) / COUNT as f64,
            mass: weight / COUNT as f64,
        };
        Loads {
            gravity: Some(Vec3::Z * -1.0),
            masses: (0..COUNT).map(mass).collect(),
            ..Loads::default()
        }
    };
    let massless = Backbone {
        material: Material { density: Some(0.0), ..rod_of(1e-5).material },
        ..rod_of(1e-5)
    };
    let carrier = Robot::new(massless, Disks::equally_spaced(1.0, 2, 0.01), vec![]).unwrap();
    let options = Options {
        accuracy: Accuracy::Steps(48),
        stability: StabilityAnalysis::Eigenvalue,
        ..Options::default()
    };
    let value = |robot: &Robot, case: &Case| {
        let solution = solve_with(options.clone(), robot, case).unwrap();
        let left = solution.diagnostics.stability_lost_at.is_some();
        assert!(left || solution.disks.tip().position.x.abs() < 1e-9);
        common::stability_of_path(&solution)
    };
    for factor in [0.5, 1.0 - 1e-4, 1.0 + 1e-4, 1.3] {
        let weight = factor * GREENHILL;
        let stable = factor < 1.0;
        let load = value(&slender(), &spread(vec![down(weight)]));
        assert_eq!(load > 0.0, stable, "{factor}: {load}");
        let carried = Case { loads: masses(weight), ..Case::default() };
        let carried = value(&carrier, &carried);
        assert_eq!(carried > 0.0, stable, "{factor}: {carried}");
        // Lumping costs of the order of the square of the distance between the masses.
        assert!((carried - load).abs() < 1e-5, "{factor}: {carried} {load}");
    }
}

/// The weight of a camera is a force where it sits.
#[test]
fn a_mass_is_the_force_of_its_weight() {
    let mut robot = paper_robot(vec![straight(30.0)]);
    let mut backbone = robot.backbone().clone();
    backbone.material.density = Some(1040.0);
    robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
    let gravity = Vec3::new(3.0, -2.0, 9.0);
    let at_tip = PointMass { at: 0.18, mass: 0.02 };
    let between = PointMass { at: 0.077, mass: 0.05 };
    let carrying = |loads| Case { loads, ..Case::with_tensions(&[2.0]) };
    let weight = Loads { gravity: Some(gravity), ..Loads::default() };
    let masses = Loads { masses: vec![at_tip, between], ..weight.clone() };
    let forces = Loads {
        tip_force: gravity * at_tip.mass,
        points: vec![PointLoad {
            at: between.at,
            force: gravity * between.mass,
            ..PointLoad::default()
        }],
        ..weight
    };
    let [a, b] = [masses.clone(), forces].map(|loads| solve_finely(&robot, &carrying(loads)));
    assert!(largest_difference(&a, &b) < 1e-13);
    assert!((a.base_wrench.unwrap().force - b.base_wrench.unwrap().force).norm() < 1e-13);
    // Without gravity it has no weight.
    let floating = Loads { gravity: None, ..masses };
    assert!(floating.is_none());
    let bare = solve_finely(&robot, &Case::with_tensions(&[2.0]));
    assert!(largest_difference(&solve_finely(&robot, &carrying(floating)), &bare) < 1e-15);
}

/// A list of stations with equal values is a constant load; one load is the sum of its parts; a stair
/// of many point loads tends to it.
#[test]
fn profiles_agree_with_what_they_stand_for() {
    let robot = paper_robot(vec![straight(0.0), straight(100.0)]);
    let solve = |loads: Vec<DistributedLoad>| {
        let case = Case { ..Case::with_tensions(&[2.0, 1.0]) };
        solve_finely(
            &robot,
            &Case { loads: Loads { distributed: loads, ..Loads::default() }, ..case },
        )
    };
    let (f, m) = (Vec3::new(0.6, -0.4, 1.0), Vec3::new(0.02, 0.03, -0.04));
    for follower in [false, true] {
        let load = |profile| DistributedLoad { profile, follower };
        let constant =
            |from, to, force, moment| load(Profile::Constant { from, to, force, moment });
        let whole = solve(vec![constant(0.03, 0.15, f, m)]);
        let listed = Profile::Linear {
            at: vec![0.03, 0.05, 0.11, 0.15],
            force: vec![f; 4],
            moment: vec![m; 4],
        };
        assert!(largest_difference(&whole, &solve(vec![load(listed)])) < 1e-11 * 0.18);
        let parts = vec![
            constant(0.03, 0.08, f, Vec3::ZERO),
            constant(0.08, 0.15, f, Vec3::ZERO),
            constant(0.03, 0.15, Vec3::ZERO, m),
        ];
        assert!(largest_difference(&whole, &solve(parts)) < 1e-11 * 0.18);
        // The middle of each of n parts: an error of the order of 1/n².
        let points = |n: usize| {
            let h = 0.12 / n as f64;
            let point = |i: usize| PointLoad {
                at: 0.03 + (i as f64 + 0.5) * h,
                force: f * h,
                moment: m * h,
                follower,
            };
            let loads = Loads { points: (0..n).map(point).collect(), ..Loads::default() };
            solve_finely(&robot, &Case { loads, ..Case::with_tensions(&[2.0, 1.0]) })
        };
        let [coarse, fine] = [8, 16].map(|n| largest_difference(&whole, &points(n)));
        assert!(coarse < 1e-3 * 0.18 && (3.4..4.6).contains(&(coarse / fine)), "{coarse} {fine}");
    }
}

/// Against the paper's eq. (3) in strains: a profile with forces and moments, dead and following, on a
/// robot with cables, gravity and masses.
#[test]
fn the_second_formulation_agrees() {
    let mut robot = paper_robot(vec![straight(0.0), straight(140.0)]);
    let mut backbone = robot.backbone().clone();
    backbone.material.density = Some(1040.0);
    robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
    let profile = Profile::Linear {
        at: vec![0.02, 0.07, 0.16],
        force: vec![Vec3::new(0.5, 0.2, -1.0), Vec3::new(1.0, -0.6, 0.3), Vec3::new(0.0, 1.0, 0.4)],
        moment: vec![Vec3::new(0.02, 0.03, 0.01), Vec3::new(0.0, -0.05, 0.02), Vec3::X * 0.03],
    };
    let stretch = Profile::Constant {
        from: 0.055,
        to: 0.18,
        force: Vec3::new(-0.4, 0.3, 0.5),
        moment: Vec3::new(0.01, 0.0, -0.06),
    };
    for (first, second) in [(false, false), (false, true), (true, false), (true, true)] {
        let loads = Loads {
            gravity: Some(Vec3::new(2.0, -9.0, 3.0)),
            tip_force: Vec3::new(0.05, 0.1, -0.02),
            masses: vec![PointMass { at: 0.13, mass: 0.01 }],
            distributed: vec![
                DistributedLoad { profile: profile.clone(), follower: first },
                DistributedLoad { profile: stretch.clone(), follower: second },
            ],
            ..Loads::default()
        };
        let case = Case { loads, ..Case::with_tensions(&[2.0, 1.0]) };
        let solution = solve_finely(&robot, &case);
        let answer = Oracle::new(&robot, &case, &solution.shape.arc_length).solve(1e-10);
        for (&s, pose) in solution.shape.arc_length.iter().zip(&solution.shape.poses) {
            let frame = answer
                .frames
                .iter()
                .min_by(|a, b| (a.arc_length - s).abs().total_cmp(&(b.arc_length - s).abs()))
                .unwrap();
            let error = (frame.position - pose.position).norm() / 0.18;
            assert!(error < 2e-9, "{first} {second}, at {s}: {error:.1e} L");
        }
        let base = solution.base_wrench.unwrap();
        assert!((base.force - answer.base_force).norm() < 1e-8 * base.force.norm());
        assert!((base.moment - answer.base_moment).norm() < 1e-8 * base.moment.norm());
    }
}

/// Steps end where a profile begins, kinks and ends: the method keeps its order.
#[test]
fn the_error_falls_with_the_fifth_power_of_the_step() {
    let robot = paper_robot(vec![straight(0.0)]);
    let profile = Profile::Linear {
        at: vec![0.017, 0.071, 0.163],
        force: vec![Vec3::X * 3.0, Vec3::new(0.0, 5.0, -2.0), Vec3::Y],
        moment: vec![Vec3::X * 0.1, Vec3::ZERO, Vec3::Z * 0.2],
    };
    for follower in [false, true] {
        let case = Case {
            loads: Loads {
                distributed: vec![DistributedLoad { profile: profile.clone(), follower }],
                ..Loads::default()
            },
            ..Case::with_tensions(&[2.0])
        };
        let with = |steps| {
            let accuracy = Accuracy::Steps(steps);
            solve_with(Options { accuracy, ..fine_options() }, &robot, &case).unwrap()
        };
        let exact = solve_finely(&robot, &case);
        let [coarse, fine] = [26, 52].map(|steps| largest_difference(&exact, &with(steps)));
        let order = (coarse / fine).log2();
        assert!(order > 4.5, "{order}: {coarse:.1e} {fine:.1e}");
    }
}

/// Given as lengths, the cables of a loaded robot find the tensions they had.
#[test]
fn lengths_give_the_tensions_back() {
    let robot = paper_robot(vec![straight(0.0), straight(120.0), straight(240.0)]);
    for follower in [false, true] {
        let load = DistributedLoad {
            profile: Profile::Constant {
                from: 0.05,
                to: 0.14,
                force: Vec3::new(1.0, 2.0, -1.0),
                moment: Vec3::new(0.05, 0.0, 0.1),
            },
            follower,
        };
        let loads = Loads { distributed: vec![load], ..Loads::default() };
        let tensions = [3.0, 1.0, 0.5];
        let pulled = Case { loads: loads.clone(), ..Case::with_tensions(&tensions) };
        let pulled = solve_finely(&robot, &pulled);
        let held = solve_finely(&robot, &common::lengths_of(&pulled, &loads));
        for (cable, tension) in held.cables.iter().zip(tensions) {
            assert!((cable.tension.unwrap() / tension - 1.0).abs() < 1e-7, "{cable:?}");
        }
        assert!(largest_difference(&pulled, &held) < 1e-10);
    }
}

/// A load far beyond what one shot from the base can take (see `strong_loads.rs`): the rod
/// hangs like a string, all but its ends along the load.
#[test]
fn strong_distributed_loads_converge() {
    for weight in [2e2, 5e3] {
        let load = uniform(Vec3::X * weight);
        let solution = solve_with(Options::default(), &slender(), &spread(vec![load])).unwrap();
        let tip = solution.disks.tip().position;
        // Off by the length over which the bend at the base dies out, √(EI/F).
        let reach = weight.sqrt().recip();
        assert!((1.0 - tip.x).abs() < reach && (0.0..3.0 * reach).contains(&tip.z), "{tip:?}");
        assert!((solution.base_wrench.unwrap().force.x / weight - 1.0).abs() < 1e-12);
        assert!(solution.diagnostics.stable == Some(true));
        // Equilibrium of the whole: the moment of all forces about the base.
        let moment = solution.base_wrench.unwrap().moment.y;
        assert!((moment / (2.0 * weight).sqrt() - 1.0).abs() < 0.1, "{moment}");
    }
}

#[test]
fn what_cannot_be_is_refused_by_its_path() {
    let robot = slender();
    let refused = |loads: Loads| match solve_with(
        Options::default(),
        &robot,
        &Case { loads, ..Case::default() },
    ) {
        Err(SolveError::Invalid(error)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let load = |profile| Loads {
        distributed: vec![DistributedLoad { profile, follower: false }],
        ..Loads::default()
    };
    let constant = |from, to| Profile::Constant { from, to, force: Vec3::X, moment: Vec3::ZERO };
    let listed = |at: &[f64], force: &[Vec3]| Profile::Linear {
        at: at.to_vec(),
        force: force.to_vec(),
        moment: vec![],
    };
    let mass = |at, mass| Loads { masses: vec![PointMass { at, mass }], ..Loads::default() };
    for (loads, text) in [
        (
            load(constant(0.5, 0.2)),
            "`to` of distributed load 1: must increase from the base to the tip, but 0.2 follows 0.5",
        ),
        (
            load(constant(0.5, 1.5)),
            "`to` of distributed load 1: lies at 1.5 m, beyond the tip at 1 m",
        ),
        (load(constant(1.0, 1.0)), "`from` of distributed load 1: must increase"),
        (
            load(constant(0.5, 0.5 + 1e-12)),
            "is the least: give a load on so short a stretch as a point load",
        ),
        (load(constant(f64::NAN, 1.0)), "`from` of distributed load 1: must be a finite number"),
        (
            load(listed(&[0.1], &[Vec3::X])),
            "`at` of distributed load 1: must have at least 2 entries, but has 1",
        ),
        (load(listed(&[0.1, 0.1], &[Vec3::X; 2])), "`at` of distributed load 1: must increase"),
        (
            load(listed(&[0.1, 0.3], &[Vec3::X; 3])),
            "`force` of distributed load 1: must have 2 entries, one for each entry of `at`, but has 3",
        ),
        (
            load(listed(&[0.1, 0.3], &[Vec3::X * 1e13; 2])),
            "must be at most 1e12 N/m, but is 1e13 N/m",
        ),
        (mass(-1.0, 1.0), "`at` of mass 1: must not be negative"),
        (mass(0.5, -1.0), "`mass` of mass 1: must not be negative"),
    ] {
        let message = refused(loads);
        assert!(message.contains(text), "{message}");
    }
}

/// Derivatives by tension and gravity, with everything that is dead on the rod and a base that is
/// turned, against differences of solutions on the same steps.
#[test]
fn derivatives_know_distributed_loads_and_masses() {
    let mut robot = paper_robot(vec![straight(0.0), straight(140.0)]);
    let mut backbone = robot.backbone().clone();
    backbone.material.density = Some(1040.0);
    robot = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec()).unwrap();
    let profile = Profile::Constant {
        from: 0.03,
        to: 0.15,
        force: Vec3::new(1.0, 2.0, -1.0),
        moment: Vec3::new(0.05, -0.02, 0.1),
    };
    let loads = Loads {
        frame: LoadFrame::World,
        gravity: Some(Vec3::new(1.0, -2.0, 9.0)),
        distributed: vec![DistributedLoad { profile, follower: false }],
        masses: vec![PointMass { at: 0.1, mass: 0.02 }],
        ..Loads::default()
    };
    let turn = UnitQuaternion::exp(Vec3::new(0.4, 1.0, -0.3));
    let base = Pose { rotation: turn, ..Pose::IDENTITY };
    let case = Case { loads, base, ..Case::with_tensions(&[2.0, 1.0]) };
    let options = Options { accuracy: Accuracy::Steps(16), ..fine_options() };
    let model = Cosserat::new(&robot, &case.loads, &options).unwrap();
    let mut workspace = Workspace::default();
    let parameters = [Parameter::Gravity { axis: 1 }];
    let (_, derivatives) =
        model.solve_with_derivatives(&case, None, &parameters, &mut workspace).unwrap();
    let mut tip =
        |case: &Case| model.solve(case, None, &mut workspace).unwrap().disks.tip().position;
    let moved = |sign: f64, of: &dyn Fn(&mut Case, f64)| {
        let mut case = case.clone();
        of(&mut case, sign);
        case
    };
    let by_tension = |case: &mut Case, h: f64| {
        case.commands[0].tension = Some(2.0 + 1e-4 * h);
    };
    let by_gravity = |case: &mut Case, h: f64| {
        case.loads.gravity = Some(Vec3::new(1.0, -2.0 + 1e-3 * h, 9.0));
    };
    let tension = (tip(&moved(1.0, &by_tension)) - tip(&moved(-1.0, &by_tension))) / 2e-4;
    let gravity = (tip(&moved(1.0, &by_gravity)) - tip(&moved(-1.0, &by_gravity))) / 2e-3;
    let exact = [
        derivatives.command(0).twist(Place::Tip).linear,
        derivatives.parameter(0, Hold::Commands).twist(Place::Tip).linear,
    ];
    for (difference, exact) in [tension, gravity].into_iter().zip(exact) {
        // Derivatives are in the frame of the base.
        let exact = turn.rotate(exact);
        assert!((difference - exact).norm() < 1e-6 * exact.norm(), "{difference:?} {exact:?}");
    }
}
