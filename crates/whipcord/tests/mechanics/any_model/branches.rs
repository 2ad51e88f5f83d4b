//! Equilibria under one load by every model that has them: discrete columns, limit points, and what a solve finds.
//!
//! Rods have length 1 and a bending stiffness of 1 in the plane of x and z, and 100 across it, so that they buckle in that plane.

use core::f64::consts::{FRAC_PI_2, PI};

use whipcord::{
    Actuation, Backbone, BranchOptions, Branches, Cable, CableCommand, Case, CriticalKind, Disks,
    DistributedLoad, Form, Loads, ModelKind, Obstacle, Pose, RestCurvature, Robot, Routing,
    Shortening, Solution, SolveError, StabilityAnalysis, Stations, Stiffness, Vec3,
};

use crate::common::model_with_forces;

const PCC: ModelKind = ModelKind::PiecewiseConstantCurvature;
const PRB: ModelKind = ModelKind::PseudoRigidBody;
const ALL: [ModelKind; 5] =
    [ModelKind::Cosserat, ModelKind::CosseratDisks, PCC, PRB, ModelKind::FourBar];

/// Su 2009, table of optimal parameters: bodies by the length of a section, joints by EI over it.
const BODIES: [f64; 4] = [0.1, 0.35, 0.4, 0.15];
const JOINTS: [f64; 3] = [3.51, 2.99, 2.58];

fn blade(sections: usize, rest_curvature: f64, cables: Vec<Cable>) -> Robot {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [100.0, 1.0].into(),
        torsion: 1.5.into(),
    };
    let backbone = Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        rest_curvature: RestCurvature::Uniform(Vec3::Y * rest_curvature),
        ..Backbone::new(1.0)
    };
    Robot::new(backbone, Disks::equally_spaced(1.0, sections + 1, 0.05), cables).unwrap()
}

fn side(name: &str, angle: f64) -> Cable {
    Cable::new(name, Routing::Straight { angle, radius: 0.03 })
}

fn pushed(x: f64, z: f64) -> Case {
    let loads = Loads { tip_force: Vec3::new(x, 0.0, z), ..Loads::default() };
    Case { loads, ..Case::default() }
}

fn try_branches(kind: ModelKind, robot: &Robot, case: &Case) -> Result<Branches, SolveError> {
    let model = model_with_forces(kind, Stations::Disks, Actuation::Natural);
    model.prepare(robot, &case.loads)?.branches(case, &BranchOptions::default())
}

fn branches(kind: ModelKind, robot: &Robot, case: &Case) -> Branches {
    try_branches(kind, robot, case).unwrap()
}

fn tip(solution: &Solution) -> [f64; 2] {
    let p = solution.disks.tip().position;
    assert!(p.y.abs() < 1e-7, "{p:?} is not in the plane");
    [p.x, p.z]
}

/// The lengths of the rigid bodies that turn, and the stiffness of the joints before them.
fn chain_of_bodies(sections: usize) -> Vec<(f64, f64)> {
    let h = 1.0 / sections as f64;
    let mut bodies: Vec<(f64, f64)> = Vec::new();
    for section in 0..sections {
        for (joint, (&stiffness, &link)) in JOINTS.iter().zip(&BODIES[1..]).enumerate() {
            // The last body of a section and the first of the next are one.
            let next = if joint == 2 && section + 1 < sections { BODIES[0] } else { 0.0 };
            bodies.push(((link + next) * h, stiffness / h));
        }
    }
    bodies
}

/// The n-th buckling load of that chain under a dead load on its end: of `Σ kⱼ (φⱼ − φⱼ₋₁)² = P Σ lⱼ φⱼ²`, with φ the angles of the
/// bodies, by the number of negative pivots of the tridiagonal matrix.
fn chain_buckles_at(bodies: &[(f64, f64)], n: usize) -> f64 {
    let below = |load: f64| {
        let mut pivot = f64::INFINITY;
        let negative = |(j, &(length, stiffness)): (usize, &(f64, f64))| {
            let next = bodies.get(j + 1).map_or(0.0, |&(_, next)| next);
            pivot = stiffness + next - load * length - stiffness * stiffness / pivot;
            pivot < 0.0
        };
        bodies.iter().enumerate().map(negative).filter(|&negative| negative).count()
    };
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) >= n { high = middle } else { low = middle }
    }
    low
}

/// The same of arcs, whose angle grows linearly from disk to disk: those of finite elements with linear shape functions,
/// `(6/h²) (1 − cos θ)/(2 + cos θ)` with `θ = (2n − 1) π/(2 N)` for N arcs of length h.
fn arcs_buckle_at(sections: usize, n: usize) -> f64 {
    let count = sections as f64;
    let cos = ((2 * n - 1) as f64 * PI / (2.0 * count)).cos();
    6.0 * count * count * (1.0 - cos) / (2.0 + cos)
}

/// The same of rigid links from disk to disk that make equal angles with both: the angles of the disks are `sin(iθ)`, with
/// `4/h² tan²(θ/2)` and the same θ.
fn links_buckle_at(sections: usize, n: usize) -> f64 {
    let count = sections as f64;
    let half = (2 * n - 1) as f64 * PI / (4.0 * count);
    4.0 * count * count * half.tan().powi(2)
}

#[test]
fn columns_buckle_at_the_loads_of_their_discrete_models() {
    let euler = |n: usize| ((2 * n - 1) as f64 * FRAC_PI_2).powi(2);
    for sections in [1, 2, 5, 12] {
        for kind in ALL {
            let exact = |n: usize| match kind {
                PCC => arcs_buckle_at(sections, n),
                PRB => chain_buckles_at(&chain_of_bodies(sections), n),
                ModelKind::FourBar => links_buckle_at(sections, n),
                _ => euler(n),
            };
            // One arc has a single bend.
            let has_one_bend = sections == 1 && matches!(kind, PCC | ModelKind::FourBar);
            let modes = if has_one_bend { 1 } else { 2 };
            let load = 1.2 * exact(modes);
            let found = branches(kind, &blade(sections, 0.0, vec![]), &pushed(0.0, -load));
            let path = found.critical_points.iter().filter(|point| point.branch == 0);
            let critical: Vec<f64> = path.map(|point| point.load * load).collect();
            // The path is followed beyond the load, and may meet another.
            assert!(critical.len() >= modes, "{kind}, {sections} sections: {critical:?}");
            for (n, at) in critical.iter().take(modes).enumerate() {
                let off = at / exact(n + 1) - 1.0;
                // The rods integrate two waves in 16 steps, and count an eigenvalue of -1e-6 as none.
                assert!(off.abs() < 1e-5, "{kind}, {sections} sections, mode {n}: {off:e}");
            }
        }
    }
}

/// All planar equilibria of the chain of bodies under a load on its end: every joint bears the load times the distance of the end from
/// it, and where the chain ends for an assumed place of its end must be that place.
fn equilibria_of_chain(bodies: &[(f64, f64)], first: f64, load: f64) -> Vec<[f64; 2]> {
    let end = |x: f64| {
        let (mut angle, mut at) = (0.0_f64, [0.0, first]);
        for &(length, stiffness) in bodies {
            angle += load * (x - at[0]) / stiffness;
            at = [at[0] + length * angle.sin(), at[1] + length * angle.cos()];
        }
        at
    };
    let miss = |x: f64| end(x)[0] - x;
    let place = |i: usize| -1.0 + 2.0 * (i as f64 + 0.37) / 4000.0;
    let mut found = Vec::new();
    for i in 0..4000 {
        let (mut low, mut high) = (place(i), place(i + 1));
        if miss(low) * miss(high) < 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if miss(low) * miss(middle) <= 0.0 { high = middle } else { low = middle }
            }
            found.push(end(low));
        }
    }
    found
}

#[test]
fn buckled_bodies_are_all_equilibria_of_their_chain() {
    for (sections, factor, count) in [(1, 2.0, 3), (4, 1.3, 3), (4, 11.0, 5)] {
        let bodies = chain_of_bodies(sections);
        let load = factor * chain_buckles_at(&bodies, 1);
        let first = BODIES[0] / sections as f64;
        let mut exact = equilibria_of_chain(&bodies, first, load);
        assert_eq!(exact.len(), count, "{exact:?}");
        let found = branches(PRB, &blade(sections, 0.0, vec![]), &pushed(0.0, -load));
        // Secondary branches leave the plane.
        let in_plane = found.equilibria.iter().filter(|e| {
            let y = e.solution.disks.tip().position.y;
            y.abs() < 1e-7
        });
        for equilibrium in in_plane {
            let [x, z] = tip(&equilibrium.solution);
            let place = exact.iter().position(|e| (e[0] - x).hypot(e[1] - z) < 1e-8);
            exact.remove(place.unwrap_or_else(|| panic!("({x}, {z}) is not among {exact:?}")));
        }
        assert!(exact.is_empty(), "{exact:?} were not found");
    }
}

/// The potential energy of planar arcs of equal length under a load on the tip, by their bends.
fn energy_of_arcs(bends: &[f64], load: f64) -> f64 {
    let h = 1.0 / bends.len() as f64;
    let (mut angle, mut height, mut energy) = (0.0_f64, 0.0, 0.0);
    for &bend in bends {
        let half = 0.5 * bend;
        let chord = if half == 0.0 { h } else { h * half.sin() / half };
        height += chord * (angle + half).cos();
        angle += bend;
        energy += 0.5 * bend * bend / h;
    }
    energy + load * height
}

#[test]
fn buckled_arcs_have_stationary_energy() {
    const STEP: f64 = 1e-4;
    for (sections, factor) in [(1, 1.5), (5, 1.3), (5, 10.5)] {
        let load = factor * arcs_buckle_at(sections, 1);
        let found = branches(PCC, &blade(sections, 0.0, vec![]), &pushed(0.0, -load));
        let in_plane = |y: f64| y.abs() < 1e-7;
        let mut bent = 0;
        for equilibrium in &found.equilibria {
            let poses = &equilibrium.solution.disks.poses;
            if !poses.iter().all(|pose| in_plane(pose.position.y)) {
                continue;
            }
            let turn = |pair: &[Pose]| (pair[0].rotation.conjugate() * pair[1].rotation).log().y;
            let bends: Vec<f64> = poses.windows(2).map(turn).collect();
            bent += usize::from(bends[0].abs() > 0.1);
            for arc in 0..sections {
                let at = |step: f64| {
                    let mut moved = bends.clone();
                    moved[arc] += step;
                    energy_of_arcs(&moved, load)
                };
                // Of fourth order.
                let near = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let far = (at(2.0 * STEP) - at(-2.0 * STEP)) / (4.0 * STEP);
                let slope = (4.0 * near - far) / 3.0;
                assert!(slope.abs() < 1e-8 * load, "{sections}, {factor}: {slope:e} at {bends:?}");
            }
        }
        assert!(bent >= 2, "{sections}, {factor}: {bent}");
    }
}

/// Branches that leave the plane of a blade reach a least load and return: the loads of these limit points with straight cables from hole to
/// hole tend to those with continuous cables, with the square of the distance of the disks.
#[test]
fn limit_points_with_many_disks_tend_to_those_of_the_continuous_rod() {
    let limit = |kind: ModelKind, sections: usize| {
        let robot = blade(sections, 0.0, vec![side("one", 0.0), side("other", PI)]);
        let case = Case { loads: pushed(0.0, -28.0).loads, ..Case::with_tensions(&[10.0; 2]) };
        let found = branches(kind, &robot, &case);
        let limits = found.critical_points.iter().filter(|p| p.kind == CriticalKind::Limit);
        let loads: Vec<f64> = limits.map(|point| point.load).collect();
        assert_eq!(loads.len(), 4, "{kind}, {sections}: {:?}", found.critical_points);
        // By symmetry they are the same.
        assert!(loads.iter().all(|load| (load - loads[0]).abs() < 1e-7), "{kind}: {loads:?}");
        loads[0]
    };
    let exact = limit(ModelKind::Cosserat, 10);
    let errors = [10, 20, 40].map(|n| (limit(ModelKind::CosseratDisks, n) - exact).abs());
    assert!(errors[2] < 1e-3 * exact, "{errors:?} of {exact}");
    for pair in errors.windows(2) {
        assert!((3.6..4.4).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// Robots on whose branches all kinds of events lie, and so do cables of given lengths, distributed and follower loads.
fn cases() -> Vec<(&'static str, Robot, Case)> {
    let both = || vec![side("one", 0.0), side("other", PI)];
    let shortened = |shortening: f64| CableCommand {
        tension: None,
        shortening: Some(Shortening::Length(shortening)),
    };
    let spread = Loads {
        distributed: vec![
            DistributedLoad::uniform(1.0, Vec3::new(3.0, 0.0, -6.0)),
            DistributedLoad {
                follower: true,
                ..DistributedLoad::uniform(1.0, Vec3::new(-1.0, 0.5, 0.0))
            },
        ],
        ..Loads::default()
    };
    let follower = Loads { tip_follower: true, ..pushed(1.0, -3.0).loads };
    let lengths = |case: Case, shortenings: [f64; 2]| Case {
        commands: shortenings.map(shortened).to_vec(),
        ..case
    };
    vec![
        ("column", blade(6, 0.0, vec![]), pushed(0.0, -3.5)),
        ("bent", blade(6, 0.8, vec![]), pushed(-0.5, -3.0)),
        (
            "pulled",
            blade(6, 0.0, both()),
            Case { loads: pushed(0.3, -3.0).loads, ..Case::with_tensions(&[4.0, 1.0]) },
        ),
        (
            "one cable shortened, the other slack",
            blade(6, 0.0, both()),
            lengths(pushed(-1.0, -2.0), [0.02, -0.05]),
        ),
        ("spread", blade(6, 0.3, vec![]), Case { loads: spread, ..Case::default() }),
        ("follower", blade(6, 0.2, vec![]), Case { loads: follower, ..Case::default() }),
    ]
}

/// The path is that of the solve: what a solve finds by its own ways, starting at once from no load or raising the load at the tensions that
/// give the lengths, lies on a branch; and each stable equilibrium is one that a solve stays in when it starts there.
#[test]
fn equilibria_on_branches_are_those_of_solves() {
    for (name, robot, case) in cases() {
        for kind in ALL {
            let found = branches(kind, &robot, &case);
            assert!(found.complete, "{name}, {kind}: {:?}", found.critical_points);
            let model = model_with_forces(kind, Stations::Disks, Actuation::Natural);
            let mut solving = model.prepare(&robot, &case.loads).unwrap();
            let is_near =
                |a: &Solution, b: &Solution| a.disks.distances(&b.disks).all(|d| d < 2e-6);
            let answer = solving.solve(&case, None).unwrap();
            let on_branch = found.equilibria.iter().filter(|e| e.branch.is_some());
            let met = on_branch.filter(|e| is_near(&e.solution, &answer)).count();
            assert_eq!(met, 1, "{name}, {kind}: {:?}", answer.disks.tip());
            let unchecked = model.clone().with_stability(StabilityAnalysis::Off);
            let mut unchecked = unchecked.prepare(&robot, &case.loads).unwrap();
            for equilibrium in &found.equilibria {
                let start = &equilibrium.solution;
                // Models of sections leave unstable equilibria whatever is asked of their stability.
                let again = match (equilibrium.stable, kind) {
                    (Some(false), PCC | PRB) => continue,
                    (Some(false), _) => unchecked.solve(&case, Some(start)),
                    _ => solving.solve(&case, Some(start)),
                };
                let again = again.unwrap();
                assert!(is_near(start, &again), "{name}, {kind}: {:?}", again.disks.tip());
            }
        }
    }
}

/// The same path under a load that is half as much again has the same critical points, and the equilibria of the load before it.
/// A column that a small force across bends leans with it however far it is loaded: the path turns away from the straight shape beside the buckling
/// load, and does not go on to the other side of it.
#[test]
fn the_path_of_an_imperfect_column_turns_with_its_imperfection() {
    let buckling = PI * PI / 4.0;
    for kind in ALL {
        for (across, load) in [(3e-3, 2.4), (1e-3, 2.4), (1e-3, 1.3), (3e-4, 3.0)] {
            let case = pushed(across * buckling, -load * buckling);
            let found = branches(kind, &blade(9, 0.0, Vec::new()), &case);
            let on_path: Vec<_> =
                found.equilibria.iter().filter(|of| of.branch == Some(0)).collect();
            let [only] = &on_path[..] else { panic!("{kind} {across} {load}: {found:?}") };
            assert_eq!(only.stable, Some(true), "{kind} {across} {load}");
            assert!(tip(&only.solution)[0] > 0.1, "{kind} {across} {load}");
        }
    }
}

#[test]
fn critical_loads_do_not_depend_on_the_load_that_is_asked_for() {
    for kind in ALL {
        let robot = blade(6, 0.0, vec![]);
        let at = |load: f64| -> Vec<f64> {
            let found = branches(kind, &robot, &pushed(0.0, -load));
            found.critical_points.iter().map(|point| point.load * load).collect()
        };
        let (little, much) = (at(2.0), at(3.0));
        assert_eq!((little.len(), much.len()), (1, 1), "{kind}");
        assert!((little[0] / much[0] - 1.0).abs() < 1e-7, "{kind}: {little:?} {much:?}");
    }
}

/// Of models that bend alike, with many sections: the same number of equilibria, the same stability, and shapes that agree as far as the
/// sections allow.
#[test]
fn models_of_sections_tend_to_the_rods() {
    for (name, case) in [("column", pushed(0.0, -4.0)), ("aside", pushed(1.0, -3.0))] {
        let of = |kind: ModelKind, sections: usize| {
            let found = branches(kind, &blade(sections, 0.4, vec![]), &case).equilibria;
            found.into_iter().filter(|e| e.branch.is_some()).collect::<Vec<_>>()
        };
        let rod = of(ModelKind::Cosserat, 10);
        for kind in [PCC, PRB] {
            let away = |sections: usize| {
                let sections = of(kind, sections);
                assert_eq!(sections.len(), rod.len(), "{name}, {kind}");
                let pairs = sections.iter().zip(&rod);
                pairs.fold(0.0, |worst: f64, (a, b)| {
                    assert_eq!((a.branch, a.stable), (b.branch, b.stable), "{name}, {kind}");
                    let (a, b) = (tip(&a.solution), tip(&b.solution));
                    worst.max((a[0] - b[0]).hypot(a[1] - b[1]))
                })
            };
            let errors = [10, 20].map(away);
            assert!(errors[0] < 0.02, "{name}, {kind}: {errors:?}");
            // The coefficients of the bodies are those of one section under a force and a moment, not of many short ones.
            let tends = kind == PRB || (3.6..4.4).contains(&(errors[0] / errors[1]));
            assert!(tends, "{name}, {kind}: {errors:?}");
        }
    }
}

#[test]
fn what_has_no_branches_says_what_to_use_instead() {
    let cables = vec![side("one", 0.0), side("other", PI)];
    let robot = blade(6, 0.0, cables.clone());
    let case = Case::with_tensions(&[1.0, 0.0]);
    let refused =
        |kind: ModelKind, robot: &Robot, case: &Case| match try_branches(kind, robot, case) {
            Err(SolveError::Unsupported { model, advice, .. }) => {
                assert_eq!(model, kind);
                advice
            }
            other => panic!("{kind}: {other:?}"),
        };
    {
        let kind = ModelKind::ConstantCurvature;
        assert!(refused(kind, &robot, &case).contains("cosserat"));
    }
    let rubbing = cables.into_iter().map(|cable| Cable { friction: Some(0.1), ..cable }).collect();
    let rubbing = blade(6, 0.0, rubbing);
    assert!(refused(ModelKind::CosseratDisks, &rubbing, &case).contains("friction"));
    let pose = Pose { position: Vec3::new(0.5, 0.0, 0.5), ..Pose::IDENTITY };
    let ball = Obstacle {
        name: "ball".into(),
        form: Form::Sphere { radius: 0.1 },
        pose,
        friction: 0.0,
        movable: None,
    };
    let crowded = Case { obstacles: vec![ball], ..case };
    for kind in ALL {
        refused(kind, &robot, &crowded);
    }
}
