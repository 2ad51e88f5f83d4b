//! Backbones whose stiffness is given, varies along the length, is coupled, or has axes that are
//! held: against closed forms, published numbers and an independent integration.

use crate::common;
use core::f64::consts::{FRAC_PI_4, PI};

use crate::common::{Wildness, distance, fine_options, paper_backbone, solve_finely, solve_with};
use whipcord::cosserat::{Accuracy, Options};
use whipcord::robot::StiffnessMatrix;
use whipcord::{
    Along, Backbone, Cable, Case, Disks, Loads, Mat3, Pose, Robot, Routing, StabilityAnalysis,
    Stiffness, Vec3,
};

fn robot(backbone: Backbone, cables: Vec<Cable>) -> Robot {
    let disks = Disks::equally_spaced(backbone.length, 3, 0.01);
    Robot::new(backbone, disks, cables).unwrap()
}

fn tip_force(force: Vec3) -> Case {
    Case { loads: Loads { tip_force: force, ..Loads::default() }, ..Case::default() }
}

/// A backbone of length 1 and of this stiffness: GA, EA, EI and GJ.
fn unit(shear: f64, axial: f64, bending: f64, torsion: f64) -> Backbone {
    Backbone {
        stiffness: Some(Stiffness::diagonal([shear; 2], axial, [bending; 2], torsion)),
        ..Backbone::new(1.0)
    }
}

fn diagonal(entries: [f64; 6]) -> StiffnessMatrix {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { entries[i] } else { 0.0 }))
}

/// Sets an entry and its mirror.
fn couple(k: &mut StiffnessMatrix, i: usize, j: usize, value: f64) {
    k[i][j] = value;
    k[j][i] = value;
}

#[test]
fn a_given_stiffness_is_that_of_a_section_and_a_material() {
    let disks = common::paper_disks();
    let area = paper_backbone().section_at(&disks, 0.0).unwrap();
    let (young, shear) = (1.1e9, paper_backbone().material.shear_modulus().unwrap());
    let stiffness = Stiffness::diagonal(
        [shear * area.area; 2],
        young * area.area,
        [young * area.second_moment_x; 2],
        shear * area.torsion_constant,
    );
    let given = Backbone {
        section: None,
        material: whipcord::Material::default(),
        stiffness: Some(stiffness),
        linear_density: Some((1040.0 * area.area).into()),
        ..paper_backbone()
    };
    let mut made = paper_backbone();
    made.material.density = Some(1040.0);
    let cable = Cable::new("pull", common::helix(20.0, 0.4));
    let [given, made] =
        [given, made].map(|b| Robot::new(b, disks.clone(), vec![cable.clone()]).unwrap());
    let gravity = Some(Vec3::new(3.0, 0.0, -9.0));
    let case = Case {
        loads: Loads { gravity, tip_force: Vec3::new(0.0, 0.03, 0.0), ..Loads::default() },
        ..Case::with_tensions(&[3.0])
    };
    let (a, b) = (common::solve(&given, &case), common::solve(&made, &case));
    assert_eq!(a.shape, b.shape);
    assert_eq!(a.diagnostics.stability, b.diagnostics.stability);
}

/// Timoshenko: P L³/3EI of bending and P L/κGA of shear, in the limit of a small force.
#[test]
fn a_cantilever_bends_and_shears() {
    let force = 1e-6;
    let section = whipcord::Section::rectangle(0.1, 0.2);
    let base = Backbone {
        section: Some(section),
        material: whipcord::Material {
            young_modulus: Some(12.0),
            shear_modulus: Some(5.0),
            ..Default::default()
        },
        ..Backbone::new(1.0)
    };
    // Across y: EI about x is 12 · 0.1 · 0.2³/12, GA is 5 · 0.02.
    let bent = force / 3.0 / 8e-4;
    for (shearable, shear_correction, sheared) in
        [(true, 1.0, force / 0.1), (true, 5.0 / 6.0, force / 0.1 * 1.2), (false, 1.0, 0.0)]
    {
        let backbone = Backbone { shearable, shear_correction, ..base.clone() };
        let tip = solve_finely(&robot(backbone, vec![]), &tip_force(Vec3::new(0.0, force, 0.0)))
            .shape
            .tip()
            .position;
        let error = (tip.y / (bent + sheared) - 1.0).abs();
        assert!(error < 1e-5, "{shearable} {shear_correction}: off by {error:.1e}");
    }
}

/// Where stability changes its sign as the compressive force grows.
fn buckling_load(backbone: &Backbone) -> f64 {
    let robot = robot(backbone.clone(), vec![]);
    let stability = |force: f64| {
        let case = tip_force(Vec3::new(0.0, 0.0, -force));
        let options = Options {
            accuracy: Accuracy::Steps(64),
            stability: StabilityAnalysis::Eigenvalue,
            ..Options::default()
        };
        common::stability_of_path(&solve_with(options, &robot, &case).unwrap())
    };
    let (mut low, mut high) = (0.5, 5.0);
    assert!(stability(low) > 0.0 && stability(high) < 0.0);
    while high - low > 1e-7 * high {
        let middle = 0.5 * (low + high);
        if stability(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A clamped–free column that shears and gets shorter buckles at `P (1 + P (1/GA − 1/EA)) = P_E`
/// (Haringx 1942; Reissner, ZAMP 23 (1972) 795–804; Magnusson, Ristinmaa and Ljung, Int. J. Solids
/// Struct. 38 (2001) 8441–8457).
#[test]
fn a_column_that_shears_and_gets_shorter_buckles_at_haringxs_load() {
    let euler = PI * PI / 4.0;
    let (ga, ea) = (10.0, 25.0);
    for (shearable, extensible) in [(true, true), (true, false), (false, true), (false, false)] {
        let backbone = Backbone { shearable, extensible, ..unit(ga, ea, 1.0, 0.7) };
        let c = f64::from(u8::from(shearable)) / ga - f64::from(u8::from(extensible)) / ea;
        let exact =
            if c == 0.0 { euler } else { ((1.0 + 4.0 * c * euler).sqrt() - 1.0) / (2.0 * c) };
        let load = buckling_load(&backbone);
        assert!((load / exact - 1.0).abs() < 1e-6, "{shearable} {extensible}: {load} not {exact}");
    }
}

/// Where bending is coupled with twist, a column is as stiff as it is when its twist is free.
#[test]
fn coupling_with_twist_softens_a_column() {
    let mut k = diagonal([1e6, 1e6, 1e6, 1.0, 3.0, 0.7]);
    couple(&mut k, 3, 5, 0.5);
    let backbone = Backbone {
        stiffness: Some(Stiffness::Matrix(k.into())),
        shearable: false,
        extensible: false,
        ..Backbone::new(1.0)
    };
    let exact = PI * PI / 4.0 * (1.0 - 0.25 / 0.7);
    let load = buckling_load(&backbone);
    assert!((load / exact - 1.0).abs() < 1e-6, "{load} not {exact}");
    let rest = solve_finely(&robot(backbone, vec![]), &Case::default());
    assert!((rest.diagnostics.stability.unwrap() - 1.0).abs() < 1e-9);
}

/// The robot turned about its axis, with the matrix that its stiffness then has.
fn turned(robot: &Robot, angle: f64) -> Robot {
    let (sin, cos) = angle.sin_cos();
    let turn = Mat3::from_rows(
        Vec3::new(cos, -sin, 0.0),
        Vec3::new(sin, cos, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
    );
    let backbone = robot.backbone();
    let old = backbone.stiffness.as_ref().unwrap().at_end(robot.disks(), 0.0, 0.0);
    let entry = |i: usize, j: usize| {
        let rotation =
            |i: usize, k: usize| if i / 3 == k / 3 { turn.rows[i % 3][k % 3] } else { 0.0 };
        (0..6)
            .flat_map(|k| (0..6).map(move |l| (k, l)))
            .map(|(k, l)| rotation(i, k) * old[k][l] * rotation(j, l))
            .sum::<f64>()
    };
    let matrix: StiffnessMatrix = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
    let cable = |c: &Cable| {
        let routing = match c.routing {
            Routing::Straight { angle: at, radius } => {
                Routing::Straight { angle: at + angle, radius }
            }
            Routing::Helix { start_angle, turns, radius } => {
                Routing::Helix { start_angle: start_angle + angle, turns, radius }
            }
            _ => panic!("another routing"),
        };
        Cable { routing, ..c.clone() }
    };
    let backbone = Backbone {
        stiffness: Some(Stiffness::Matrix(matrix.into())),
        rest_curvature: backbone.rest_curvature.map(|&u| turn * u),
        ..backbone.clone()
    };
    let cables = robot.cables().iter().map(cable).collect();
    Robot::new(backbone, robot.disks().clone(), cables).unwrap()
}

#[test]
fn a_robot_that_is_turned_answers_the_same() {
    let angle = FRAC_PI_4;
    let about_z = Pose {
        position: Vec3::ZERO,
        rotation: whipcord::UnitQuaternion::exp(Vec3::new(0.0, 0.0, angle)),
    };
    let mut coupled = diagonal([3000.0, 2000.0, 8000.0, 6e-3, 3e-3, 2.5e-3]);
    couple(&mut coupled, 0, 5, 0.7);
    couple(&mut coupled, 2, 3, -1.1);
    couple(&mut coupled, 3, 4, 1e-3);
    let given = [
        Stiffness::diagonal([3000.0, 2000.0], 8000.0, [6e-3, 3e-3], 2.5e-3),
        Stiffness::Matrix(coupled.into()),
    ];
    let cables = vec![
        Cable::new("straight", Routing::Straight { angle: 0.3, radius: 0.008 }),
        Cable::new("helical", Routing::Helix { start_angle: 2.0, turns: 0.4, radius: 0.007 }),
    ];
    let holds = [(true, true), (false, true), (true, false), (false, false)];
    for (stiffness, (shearable, extensible)) in
        given.iter().flat_map(|g| holds.map(|hold| (g.clone(), hold)))
    {
        let backbone = Backbone {
            stiffness: Some(stiffness),
            linear_density: Some(0.02.into()),
            rest_curvature: Vec3::new(1.0, -0.5, 0.7).into(),
            shearable,
            extensible,
            ..Backbone::new(0.3)
        };
        let one = robot(backbone, cables.clone());
        let other = turned(&one, angle);
        let loads = Loads {
            gravity: Some(Vec3::new(1.0, 0.0, -9.81)),
            tip_force: Vec3::new(0.02, 0.01, 0.03),
            tip_moment: Vec3::new(0.0, 1e-3, 5e-4),
            ..Loads::default()
        };
        let turned_loads = Loads {
            gravity: loads.gravity.map(|g| about_z.rotation.rotate(g)),
            tip_force: about_z.rotation.rotate(loads.tip_force),
            tip_moment: about_z.rotation.rotate(loads.tip_moment),
            ..Loads::default()
        };
        for (loads, turned_loads) in [(loads, turned_loads), (Loads::default(), Loads::default())] {
            let case = Case { loads: loads.clone(), ..Case::with_tensions(&[1.0, 1.5]) };
            let turned_case = Case { loads: turned_loads.clone(), ..case.clone() };
            let (a, b) = (solve_finely(&one, &case), solve_finely(&other, &turned_case));
            for (p, q) in a.shape.poses.iter().zip(&b.shape.poses) {
                let off = (about_z.rotation.rotate(p.position) - q.position).norm();
                assert!(off < 1e-11, "{shearable} {extensible}: off by {off:.1e}");
            }
            let [a_least, b_least] = [&a, &b].map(|s| s.diagnostics.stability.unwrap());
            assert!((a_least - b_least).abs() < 1e-7, "{a_least} {b_least}");
            // The lengths that come out give the tensions that went in.
            let by_length = |robot: &Robot, solution, loads: &Loads| {
                common::solve_lengths(robot, &common::lengths_of(solution, loads)).unwrap()
            };
            let (back, turned_back) =
                (by_length(&one, &a, &loads), by_length(&other, &b, &turned_loads));
            for tensions in [&back, &turned_back].map(common::tensions) {
                assert!(
                    (tensions[0] - 1.0).abs() + (tensions[1] - 1.5).abs() < 1e-5,
                    "{tensions:?}"
                );
            }
        }
    }
}

/// A fully coupled section with rest curvature, a force, a moment and a cable beside the axis, against
/// an integration of the strains themselves, `(K + cables) ξ′ = …` in the form of Rucker and Webster,
/// by SciPy's DOP853 (relative tolerance 1e-13) shooting at the tip with `scipy.optimize.root`; that
/// leaves 2e-12 N of the force at the tip. Columns: tension; tip; x and z axes there; base moment.
#[test]
fn a_fully_coupled_section_agrees_with_an_independent_integration() {
    let table = [
        (
            0.0,
            [0.19179050374056922, -0.09272376640857476, -0.04344654111075235],
            [-0.9624599512810064, 0.09377908539355839, -0.25470831420065054],
            [0.2125834949752828, -0.32301044183967137, -0.92221066580617],
            [0.02420009917049255, 0.051841119581339745, -0.020270485412809482],
        ),
        (
            1.5,
            [0.16745747427703112, -0.0658433081349964, -0.07368740023595657],
            [-0.9667630355531852, -0.13518676403648144, 0.21701099492274964],
            [-0.20542544925473022, -0.09461170944922305, -0.9740888097260985],
            [0.015799921603449354, 0.04243838482017222, -0.021869251207483047],
        ),
    ];
    let matrix = [
        [3000.0, 200.0, -400.0, 0.30, -0.50, 0.80],
        [200.0, 2500.0, 300.0, 0.20, 0.40, -0.60],
        [-400.0, 300.0, 8000.0, -1.20, 0.90, 0.50],
        [0.30, 0.20, -1.20, 5.0e-3, 1.0e-3, -6e-4],
        [-0.50, 0.40, 0.90, 1.0e-3, 4.0e-3, 7e-4],
        [0.80, -0.60, 0.50, -6e-4, 7e-4, 3.0e-3],
    ];
    let (x, y) = (0.006_f64, 0.005_f64);
    let routing = Routing::Linear { start: [x, y], end: [x, y] };
    let backbone = Backbone {
        stiffness: Some(Stiffness::Matrix(matrix.into())),
        rest_curvature: Vec3::new(0.5, -1.0, 0.8).into(),
        ..Backbone::new(0.3)
    };
    let rod = robot(backbone, vec![Cable::new("pull", routing)]);
    for (tension, tip, x_axis, z_axis, moment) in table {
        let loads = Loads {
            tip_force: Vec3::new(0.15, -0.1, -0.2),
            tip_moment: Vec3::new(0.01, 0.02, -0.015),
            ..Loads::default()
        };
        let solution = solve_finely(&rod, &Case { loads, ..Case::with_tensions(&[tension]) });
        let found = solution.shape.tip();
        let off = (found.position - Vec3::from(tip)).norm();
        assert!(off < 1e-10, "{tension} N: tip off by {off:.1e}");
        for (axis, expected) in [(Vec3::X, x_axis), (Vec3::Z, z_axis)] {
            let off = (found.rotation.rotate(axis) - Vec3::from(expected)).norm();
            assert!(off < 1e-9, "{tension} N: frame off by {off:.1e}");
        }
        let off = (solution.base_wrench.unwrap().moment - Vec3::from(moment)).norm();
        assert!(off < 1e-11, "{tension} N: moment off by {off:.1e}");
    }
}

/// Two arcs are what a straight cable makes of a backbone in two parts.
#[test]
fn a_step_of_stiffness_makes_two_arcs() {
    let (tension, radius, step) = (2.0, 0.008, 0.11);
    let (bending, axial) = ([4e-3, 1e-3], [8000.0, 3000.0]);
    let at = |values: [f64; 2]| Along::At { arc_lengths: vec![step; 2], values: values.to_vec() };
    for extensible in [true, false] {
        let backbone = Backbone {
            stiffness: Some(Stiffness::Diagonal {
                shear: None,
                axial: extensible.then(|| at(axial)),
                bending: at(bending).map(|&k| [k; 2]),
                torsion: 1e-3.into(),
            }),
            shearable: false,
            extensible,
            ..Backbone::new(0.3)
        };
        let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius });
        let tip = solve_finely(&robot(backbone, vec![cable]), &Case::with_tensions(&[tension]))
            .shape
            .tip();
        let arc = |part: usize, length: f64| {
            let squeeze = if extensible { tension / axial[part] } else { 0.0 };
            let curvature = tension * radius / bending[part];
            let angle = curvature * length;
            let reach = (1.0 - squeeze) / curvature;
            let position = Vec3::new(1.0 - angle.cos(), 0.0, angle.sin()) * reach;
            let turn = whipcord::UnitQuaternion::exp(Vec3::new(0.0, angle, 0.0));
            Pose { position, rotation: turn }
        };
        let exact = arc(0, step) * arc(1, 0.3 - step);
        let off = (tip.position - exact.position).norm();
        assert!(off < 1e-12, "off by {off:.1e}");
    }
}

#[test]
fn kinks_and_steps_between_the_disks_cost_no_order() {
    let places = vec![0.05, 0.13, 0.13, 0.21];
    let along =
        |values: [f64; 4]| Along::At { arc_lengths: places.clone(), values: values.to_vec() };
    let backbone = Backbone {
        stiffness: Some(Stiffness::Diagonal {
            shear: Some(along([900.0, 700.0, 400.0, 300.0]).map(|&k| [k, 1.1 * k])),
            axial: Some(2000.0.into()),
            bending: along([6e-3, 5e-3, 2e-3, 1e-3]).map(|&k| [k, 1.3 * k]),
            torsion: along([3e-3, 2e-3, 2e-3, 1e-3]),
        }),
        rest_curvature: along([1.0, 0.0, -2.0, 3.0]).map(|&u| Vec3::new(u, 0.5 * u, 1.0)),
        linear_density: Some(along([0.02, 0.03, 0.01, 0.01])),
        ..Backbone::new(0.3)
    };
    let cable = Cable::new("pull", Routing::Helix { start_angle: 0.4, turns: 0.5, radius: 0.008 });
    let robot = robot(backbone, vec![cable]);
    let loads = Loads {
        gravity: Some(Vec3::new(5.0, 0.0, -9.0)),
        tip_force: Vec3::new(0.0, 0.05, 0.0),
        ..Loads::default()
    };
    for (loads, ratio) in [(Loads::default(), 45.0), (loads, 22.0)] {
        let case = Case { loads, ..Case::with_tensions(&[1.5]) };
        let solve = |steps| {
            let accuracy = Accuracy::Steps(steps);
            solve_with(Options { accuracy, ..fine_options() }, &robot, &case).unwrap()
        };
        let exact = solve(480);
        let [coarse, fine] = [30, 60].map(|steps| distance(&solve(steps), &exact));
        assert!(coarse / fine > ratio, "{coarse:.1e} to {fine:.1e}: {:.1}", coarse / fine);
    }
}

/// Random robots whose rods neither stretch nor shear are the limit of ever stiffer ones.
#[test]
fn great_stiffness_tends_to_what_is_held() {
    let mut compared = 0;
    for wild in [Wildness::UNLOADED, Wildness::LOADED] {
        for (made, case) in common::samples(common::robot(wild), 24) {
            let backbone = made.backbone();
            if !backbone.is_uniform() {
                continue;
            }
            compared += 1;
            let area = backbone.section_at(made.disks(), 0.0).unwrap();
            let material = &backbone.material;
            let (young, shear) =
                (material.young_modulus.unwrap(), material.shear_modulus().unwrap());
            let (ga, ea) = (shear * area.area, young * area.area);
            let with = |factor: f64, held: bool| {
                let stiffness = Stiffness::diagonal(
                    [factor * ga; 2],
                    factor * ea,
                    [young * area.second_moment_x, young * area.second_moment_y],
                    shear * area.torsion_constant,
                );
                let backbone = Backbone {
                    material: whipcord::Material {
                        density: material.density,
                        ..Default::default()
                    },
                    stiffness: Some(stiffness),
                    extensible: !held,
                    shearable: !held,
                    ..backbone.clone()
                };
                let robot =
                    Robot::new(backbone, made.disks().clone(), made.cables().to_vec()).unwrap();
                (common::solve(&robot, &case), robot)
            };
            let (limit, rigid) = with(1.0, true);
            for (factor, bound) in [(1e6, 3e-7), (1e12, 2e-8)] {
                let (stiff, _) = with(factor, false);
                let off = distance(&stiff, &limit) / backbone.length;
                assert!(off < bound, "{factor:e}: off by {off:.1e} L\n{rigid:?}\n{case:?}");
                let [a, b] = [&stiff, &limit].map(|s| s.diagnostics.stability);
                let (a, b) = (a.unwrap_or(0.0), b.unwrap_or(0.0));
                assert!((a - b).abs() < 1e-5 * (1.0 + b.abs()), "{factor:e}: {a} not {b}");
            }
            let back =
                common::solve_lengths(&rigid, &common::lengths_of(&limit, &case.loads)).unwrap();
            let off = distance(&back, &limit) / backbone.length;
            assert!(off < 1e-6, "by length: off by {off:.1e} L\n{rigid:?}\n{case:?}");
        }
    }
    assert!(compared >= 15, "{compared}");
}

/// A cable along the axis of a backbone that cannot get shorter cannot be shortened either.
#[test]
fn a_central_cable_of_a_rod_that_does_not_stretch() {
    let cable = Cable::new("core", Routing::Straight { angle: 0.0, radius: 0.0 });
    let rod = robot(
        Backbone { extensible: false, shearable: false, ..unit(1.0, 1.0, 1.0, 0.7) },
        vec![cable],
    );
    let pulled = solve_finely(&rod, &Case::with_tensions(&[50.0]));
    assert!((pulled.shape.tip().position - Vec3::Z).norm() < 1e-14);
    assert!((pulled.cables[0].length - 1.0).abs() < 1e-14);
    let shorten = |by| {
        common::solve_lengths(&rod, &Case::with_shortenings(&[whipcord::Shortening::Length(by)]))
    };
    assert!(shorten(-0.1).unwrap().cables[0].slack);
    assert!(shorten(0.0).is_ok());
    let error = shorten(0.01).unwrap_err();
    let whipcord::SolveError::UnreachableLength { reachable, .. } = error else {
        panic!("{error}");
    };
    assert!(reachable.abs() < 1e-9, "{reachable}");
}

/// The "curved beam" of the regression tests of Kynema-FMB and BeamDyn
/// (`static_curved_composite_beam_bending`): the parabola through (0, 0), (38.2683, −7.61205) and
/// (70.7107, −29.2893), clamped with its slope at the root, under a force of 600 out of its plane.
#[test]
fn a_curved_beam_of_beamdyn() {
    const INTERVALS: usize = 240;
    let ([x1, y1], [x2, y2]) = ([38.2683, -7.61205], [70.7107, -29.2893]);
    let bend = (y2 / x2 - y1 / x1) / (x2 - x1);
    let root = y1 / x1 - bend * x1;
    let slope = |x: f64| root + 2.0 * bend * x;
    // ∫ √(1 + y′²) dx.
    let primitive = |p: f64| 0.5 * (p * (1.0 + p * p).sqrt() + p.asinh()) / (2.0 * bend);
    let arc_length = |x: f64| primitive(slope(x)) - primitive(root);
    let length = arc_length(x2);
    let place_of = |s: f64| {
        let mut x = s;
        for _ in 0..50 {
            x -= (arc_length(x) - s) / (1.0 + slope(x).powi(2)).sqrt();
        }
        x
    };
    let curvature = |s: f64| -2.0 * bend / (1.0 + slope(place_of(s)).powi(2)).powf(1.5);
    let h = length / INTERVALS as f64;
    // A chord lies above a convex curve, by h²/12 of its second derivative on average.
    let value = |s: f64| {
        let second = curvature(s + h) - 2.0 * curvature(s) + curvature(s - h);
        Vec3::new(0.0, curvature(s) - second / 12.0, 0.0)
    };
    let arc_lengths: Vec<f64> =
        (0..=INTERVALS).map(|i| length * i as f64 / INTERVALS as f64).collect();
    let backbone = Backbone {
        stiffness: Some(Stiffness::diagonal([4_166_670.0; 2], 1e7, [833_300.0; 2], 833_300.0)),
        rest_curvature: Along::At {
            values: arc_lengths.iter().map(|&s| value(s)).collect(),
            arc_lengths,
        },
        ..Backbone::new(length)
    };
    let rod = robot(backbone, vec![]);
    // The robot's z is the tangent at the root, its x points to where the beam bends, its y down.
    let norm = (1.0 + root * root).sqrt();
    let (along, across) = ([1.0 / norm, root / norm], [root / norm, -1.0 / norm]);
    let options = Options { accuracy: Accuracy::Steps(INTERVALS), ..fine_options() };
    let tip = |force: f64| {
        let case = tip_force(Vec3::new(0.0, -force, 0.0));
        let p = solve_with(options.clone(), &rod, &case).unwrap().shape.tip().position;
        let in_plane = |i: usize| p.z * along[i] + p.x * across[i];
        Vec3::new(in_plane(0), in_plane(1), -p.y)
    };
    let rest = (tip(0.0) - Vec3::new(x2, y2, 0.0)).norm();
    assert!(rest < 1e-8, "at rest off by {rest:.1e}");
    let published = Vec3::new(-23.6459716009048, 13.7208006040058, 53.5776450626989);
    let off = (tip(600.0) - tip(0.0) - published).norm();
    assert!(off < 1e-8, "off by {off:.1e}");
}
