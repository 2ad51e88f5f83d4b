//! The Cosserat model against published and exact solutions.
//!
//! Where a solution is that of an inextensible rod without shear, the rod is made so slender that
//! `EI/(EA L²)`, the size of the difference, lies far below the tolerance.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::common::{fine_options, round, solve_finely, stability_of_path};
use whipcord::{
    Backbone, Case, Disks, Loads, Mat3, Material, Model, RestCurvature, Robot, Section, Stiffness,
    Vec3, Wrench,
};

/// A round rod of length 1 (unless given) and EI = 1, with `EI/(EA L²) = 6·10⁻¹²`.
fn slender(length: f64, torsional_stiffness: f64) -> Backbone {
    let diameter = 1e-5 * length;
    let young = 64.0 / (PI * diameter.powi(4));
    round(length, diameter, young, 0.5 * torsional_stiffness * young)
}

/// A rod of length 1 and EI = 1, GJ = 0.7, that neither stretches nor shears.
fn inextensible() -> Backbone {
    let stiffness = Stiffness::Diagonal {
        shear: None,
        axial: None,
        bending: [1.0; 2].into(),
        torsion: 0.7.into(),
    };
    Backbone {
        stiffness: Some(stiffness),
        extensible: false,
        shearable: false,
        ..Backbone::new(1.0)
    }
}

fn without_cables(backbone: Backbone) -> Robot {
    let disks = Disks::equally_spaced(backbone.length, 2, 0.01);
    Robot::new(backbone, disks, vec![]).unwrap()
}

fn loaded(loads: Loads) -> Case {
    Case { loads, ..Case::default() }
}

fn tip_force(force: Vec3) -> Case {
    loaded(Loads { tip_force: force, ..Loads::default() })
}

/// A force across the tip that turns with it.
fn tip_follower(force: f64) -> Case {
    loaded(Loads { tip_force: Vec3::new(force, 0.0, 0.0), tip_follower: true, ..Loads::default() })
}

/// Mattiasson, Int. J. Numer. Methods Eng. 17 (1981) 145–153, table 1, recomputed to 15 digits by
/// elliptic integrals: P L²/EI, tip angle, deflection across and shortening along the rod, over L.
#[test]
fn the_elastica_under_a_dead_force_across_its_tip() {
    let table = [
        (0.2, 0.09963616303740186, 0.0663644821448305, 0.0026465483405227687),
        (0.4, 0.19715462370320763, 0.13097524208521436, 0.01035392154903758),
        (0.6, 0.2907377668411655, 0.19235027968744872, 0.022487667979028046),
        (0.8, 0.37906300761322154, 0.24945154202800207, 0.03816561324048124),
        (1.0, 0.461351949711879, 0.30172077379981355, 0.05643323628337688),
        (1.5, 0.6395398261507783, 0.410978211248258, 0.10794150068355925),
        (2.0, 0.7817498315565431, 0.49345748039671183, 0.16064172082516723),
        (2.5, 0.8949967509911082, 0.5556594626608021, 0.209958457370735),
        (3.0, 0.9860169467113541, 0.6032534411299774, 0.2544201845641871),
        (3.5, 1.0601169384514135, 0.6403916855935008, 0.29393944236873953),
        (4.0, 1.1212393474875764, 0.6699641812776668, 0.32894124224684596),
        (4.5, 1.172277923493894, 0.6939669988895509, 0.35998717242065903),
        (5.0, 1.215368117611681, 0.7137915236119128, 0.38762836072442985),
        (6.0, 1.283697285801245, 0.7445711488895153, 0.4345888286819051),
        (7.0, 1.3349598574718553, 0.7673690997404634, 0.4729274283863369),
        (8.0, 1.3744315067013926, 0.7849823749533146, 0.5048277321335316),
        (9.0, 1.4054653336239529, 0.7990555274708402, 0.5318205626725272),
        (10.0, 1.4302855388038576, 0.8106090248802964, 0.5549955977537513),
    ];
    for (backbone, bound) in [(slender(1.0, 0.7), 1e-9), (inextensible(), 1e-11)] {
        let robot = without_cables(backbone);
        for (force, angle, across, along) in table {
            let tip = solve_finely(&robot, &tip_force(Vec3::new(force, 0.0, 0.0))).shape.tip();
            let error = (tip.position - Vec3::new(across, 0.0, 1.0 - along)).norm();
            assert!(error < bound, "P L²/EI = {force}: off by {error:.1e} L");
            let turn = (tip.rotation.log() - Vec3::new(0.0, angle, 0.0)).norm();
            assert!(turn < bound, "P L²/EI = {force}: tip angle off by {turn:.1e}");
        }
    }
}

/// Argyris and Symeonidis, CMAME 26 (1981) 75–123: the same under a force that stays across the tip,
/// integrated from the tip. Columns: P L²/EI, tip angle, tip along and across.
#[test]
fn the_elastica_under_a_follower_force() {
    let table = [
        (1.0, 0.49588464242265495, 0.935645669480692, 0.32064199467501286),
        (2.0, 0.9682388025171706, 0.7673621915346398, 0.5738390625609429),
        (5.0, 2.09815723994096, 0.1722778753991257, 0.7806901427780999),
        (10.0, 2.992714816235367, -0.0921231811893621, 0.5469832645937226),
        (15.0, 3.1280076147685008, 0.048501116586166945, 0.4370731418259254),
        (20.0, 2.8505799010356494, 0.2757101230900774, 0.3301576597812318),
        (30.0, 1.6908577111061975, 0.4761412371309773, -0.20169084010922256),
        (37.142857142857146, 0.8521720695085979, 0.24138858663726018, -0.47858982769438574),
    ];
    let robot = without_cables(inextensible());
    for (force, angle, along, across) in table {
        let tip = solve_finely(&robot, &tip_follower(force)).shape.tip();
        let error = (tip.position - Vec3::new(across, 0.0, along)).norm();
        assert!(error < 1e-10, "P L²/EI = {force}: off by {error:.1e} L");
        let turn = (tip.rotation.log() - Vec3::new(0.0, angle, 0.0)).norm();
        assert!(turn < 1e-10, "P L²/EI = {force}: tip angle off by {turn:.1e}");
    }
}

/// The cantilever of Argyris and Symeonidis, CMAME 26 (1981) 75–123, under a force that stays across
/// its tip, with the extensible rod of Simo and Vu-Quoc, CMAME 58 (1986) 79–116: L = 100,
/// EI = 3.5·10⁷, EA = 4.2·10⁸, GA = 1.61538·10⁸; integrated from the tip. Columns: force, tip angle, tip along and across.
#[test]
fn an_extensible_rod_under_a_follower_force() {
    let table = [
        (10000.0, 1.340236180914509, 58.307190176815084, 71.10951872666057),
        (20000.0, 2.2944921149935404, 7.970815791453525, 75.38621520550501),
        (40000.0, 3.087980141694914, -6.994465586951744, 50.37532658706875),
        (60000.0, 3.04816022820267, 14.232911375161464, 40.064181267903535),
        (80000.0, 2.572277881746626, 39.63159295160301, 21.63340206365357),
        (100000.0, 1.8749816584033314, 49.24762016937639, -11.62882490308835),
        (120000.0, 1.1616089960815112, 35.03142215630542, -40.41011156582603),
        (130000.0, 0.8517122165808528, 24.07176239845651, -47.8277169897967),
    ];
    let backbone = Backbone {
        section: Some(Section::rectangle(1.0, 1.0)),
        material: Material {
            young_modulus: Some(4.2e8),
            shear_modulus: Some(1.615_38e8),
            ..Material::default()
        },
        ..Backbone::new(100.0)
    };
    let given = Stiffness::diagonal([1.615_38e8; 2], 4.2e8, [3.5e7; 2], 1e7);
    let given = Backbone { stiffness: Some(given), ..Backbone::new(100.0) };
    for (backbone, (force, angle, along, across)) in
        [backbone, given].iter().flat_map(|b| table.map(|row| (b, row)))
    {
        let robot = without_cables(backbone.clone());
        let tip = solve_finely(&robot, &tip_follower(force)).shape.tip();
        let error = (tip.position - Vec3::new(across, 0.0, along)).norm();
        assert!(error < 1e-7, "{force}: off by {error:.1e}");
        let turn = (tip.rotation.log() - Vec3::new(0.0, angle, 0.0)).norm();
        assert!(turn < 1e-8, "{force}: tip angle off by {turn:.1e}");
    }
}

/// A planar end moment is dead and follower at once, and strains the axis of no rod, however thick:
/// it rolls the rod up to arcs of a circle (Simo and Vu-Quoc, CMAME 58 (1986) 79–116).
#[test]
fn an_end_moment_rolls_the_rod_up() {
    let thick = |diameter: f64| {
        let young = 64.0 / (PI * f64::powi(diameter, 4));
        round(1.0, diameter, young, young / 2.6)
    };
    for backbone in [thick(1e-3), thick(0.1), inextensible()] {
        let robot = without_cables(backbone);
        for angle in [FRAC_PI_2, PI, TAU, 2.0 * TAU] {
            let tip_moment = Vec3::new(0.0, angle, 0.0);
            let solution = solve_finely(&robot, &loaded(Loads { tip_moment, ..Loads::default() }));
            for (s, pose) in solution.shape.arc_length.iter().zip(&solution.shape.poses) {
                let turn = angle * s;
                let on_circle = Vec3::new(1.0 - turn.cos(), 0.0, turn.sin()) / angle;
                let error = (pose.position - on_circle).norm();
                assert!(error < 1e-10, "{angle} rad at {s}: off by {error:.1e} L");
            }
        }
    }
}

/// Where stability changes its sign as the load on a straight rod grows, to 1e-8 of it.
fn buckling_load(stability: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    assert!(stability(low) > 0.0 && stability(high) < 0.0);
    while high - low > 1e-8 * high {
        let middle = 0.5 * (low + high);
        if stability(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Timoshenko and Gere, Theory of Elastic Stability: π²/4 · EI/L² for the clamped–free column.
#[test]
fn stability_vanishes_at_eulers_load() {
    let robot = without_cables(inextensible());
    let stability = |force: f64| {
        let solution = solve_finely(&robot, &tip_force(Vec3::new(0.0, 0.0, -force)));
        let tip = solution.shape.tip().position;
        let left = solution.diagnostics.stability_lost_at.is_some();
        assert!(left || tip.x.hypot(tip.y) < 1e-9, "{tip:?}");
        stability_of_path(&solution)
    };
    let load = buckling_load(stability, 1.0, 5.0);
    assert!((load / 2.467_401_100_272_339_5 - 1.0).abs() < 1e-6, "{load}");
}

/// Greenhill (1881): a column buckles under its own weight at ρ A g L³/EI = 7.8373.
#[test]
fn stability_vanishes_at_greenhills_weight() {
    let mut backbone = slender(1.0, 0.7);
    let area = PI / 4.0 * 1e-10;
    backbone.material.density = Some(1.0 / area);
    let robot = without_cables(backbone);
    let stability = |weight: f64| {
        let gravity = Some(Vec3::new(0.0, 0.0, -weight));
        let solution = solve_finely(&robot, &loaded(Loads { gravity, ..Loads::default() }));
        stability_of_path(&solution)
    };
    let load = buckling_load(stability, 4.0, 15.0);
    assert!((load / 7.837_347_438_943_484 - 1.0).abs() < 1e-6, "{load}");
}

/// Past Euler's load the straight rod is no answer to stay in: with the least push sideways the
/// model finds the bent one, which is stable.
#[test]
fn past_eulers_load_the_bent_branch_is_found() {
    let robot = without_cables(slender(1.0, 0.7));
    for factor in [1.1, 1.5, 2.0] {
        let case = tip_force(Vec3::new(1e-3, 0.0, -factor * 2.467_401_100_272_339_5));
        let solution = solve_finely(&robot, &case);
        let tip = solution.shape.tip().position;
        assert!(solution.diagnostics.stable == Some(true), "{factor}: unstable at {tip:?}");
        assert!(tip.x > 0.3, "{factor}: {tip:?}");
    }
}

/// Bathe and Bolourchi, Int. J. Numer. Methods Eng. 14 (1979) 961–986: a bend of 45° and radius 100
/// with a square section of side 1, E = 10⁷, ν = 0, and a dead force normal to its plane. Published
/// numbers fall into families by the torsion constant; these are for Saint-Venant's 0.140577 and
/// GA = 0.5·10⁷, converged by shooting; the torsion constant has six digits. There the base tangent is y and the bend goes to x.
#[test]
fn the_45_degree_bend() {
    let table = [
        (300.0, [22.112614520452258, 58.535932620775945, 40.4802615804463]),
        (450.0, [18.369275642879984, 51.96971735520057, 48.704788627667924]),
        (600.0, [15.557785823972365, 46.89192478142183, 53.60736926567687]),
    ];
    let backbone = Backbone {
        section: Some(Section::rectangle(1.0, 1.0)),
        material: Material {
            young_modulus: Some(1e7),
            poisson_ratio: Some(0.0),
            ..Material::default()
        },
        rest_curvature: RestCurvature::Uniform(Vec3::new(0.0, 0.01, 0.0)),
        ..Backbone::new(100.0 * PI / 4.0)
    };
    let robot = without_cables(backbone);
    let rest = solve_finely(&robot, &Case::default()).shape.tip().position;
    assert!((rest - Vec3::new(29.289_321_88, 0.0, 70.710_678_12)).norm() < 1e-7);
    for (force, [x, y, z]) in table {
        let tip =
            solve_finely(&robot, &tip_force(Vec3::new(0.0, -force, 0.0))).shape.tip().position;
        let error = (tip - Vec3::new(x, -z, y)).norm();
        assert!(error < 1e-6, "{force}: {tip:?} is off by {error:.1e}");
    }
}

/// The same bend with the polar torsion constant 1/6 of Simo and Vu-Quoc, CMAME 58 (1986) 79–116, by
/// a stiffness that is given: with GA, with 5/6 of it, and all but rigid against shear and extension;
/// converged by shooting.
#[test]
fn the_45_degree_bend_of_simo_and_vu_quoc() {
    let (ga, ea) = (0.5e7, 1e7);
    let table = [
        (ga, ea, 300.0, [22.244780945368017, 58.77912248968342, 40.19189167014999]),
        (ga, ea, 450.0, [18.50817892537004, 52.23855801115552, 48.502927344140936]),
        (ga, ea, 600.0, [15.684800534039109, 47.150438573629366, 53.474858791825326]),
        (ga / 1.2, ea, 300.0, [22.24467942667617, 58.77889732997539, 40.19239233229472]),
        (ga / 1.2, ea, 450.0, [18.50806487559263, 52.23826184672306, 48.50349153181401]),
        (ga / 1.2, ea, 600.0, [15.684689478980072, 47.1500962403424, 53.47547799822525]),
        (1e6 * ga, 1e6 * ea, 300.0, [22.245034741815438, 58.779685390643, 40.18828384158691]),
        (1e6 * ga, 1e6 * ea, 450.0, [18.508464045281293, 52.23929842020918, 48.49798262556949]),
        (1e6 * ga, 1e6 * ea, 600.0, [15.685078161880536, 47.15129439944964, 53.468598448583755]),
    ];
    for (ga, ea, force, [x, y, z]) in table {
        let bending = 1e7 / 12.0;
        let backbone = Backbone {
            stiffness: Some(Stiffness::diagonal([ga; 2], ea, [bending; 2], bending)),
            rest_curvature: RestCurvature::Uniform(Vec3::new(0.0, 0.01, 0.0)),
            ..Backbone::new(100.0 * PI / 4.0)
        };
        let case = tip_force(Vec3::new(0.0, -force, 0.0));
        let tip = solve_finely(&without_cables(backbone), &case).shape.tip().position;
        let error = (tip - Vec3::new(x, -z, y)).norm();
        assert!(error < 1e-8, "{ga:e}, {force}: {tip:?} is off by {error:.1e}");
    }
}

/// Love, Treatise on the Mathematical Theory of Elasticity (1927), art. 271: a naturally straight
/// rod held as a helix of radius 0.3 and pitch angle 0.4 by a force and a couple along the helix's
/// axis; EI = 1, GJ = 0.7, L = 4. It is one of several equilibria under these loads: the shot starts
/// from the moment at its base.
#[test]
fn a_wrench_along_its_axis_holds_loves_helix() {
    // Columns are the base frame's axes in the frame of the helix.
    let [a, b, c] = [
        [-1.0, 0.0, 0.0],
        [0.0, -0.3894183423086505, 0.9210609940028851],
        [0.0, 0.9210609940028851, 0.3894183423086505],
    ]
    .map(Vec3::from);
    let base = Mat3::from_rows(a, b, c);
    let start = Vec3::new(0.3, 0.0, 0.0);
    let tip = Vec3::from([0.28785143922324063, -0.08450768566887278, 1.557673369234602]);
    let force = Vec3::from([0.0, 0.0, -1.1012145235632311]);
    let moment = Vec3::from([-0.09306109081127903, -0.3169861855012113, 2.930527503461398]);
    let base_moment = Vec3::from([0.0, -0.3303643570689693, 2.930527503461398]);

    let robot = without_cables(slender(4.0, 0.7));
    let case = loaded(Loads {
        tip_force: base.transpose_mul(force),
        tip_moment: base.transpose_mul(moment),
        ..Loads::default()
    });
    let mut near = solve_finely(&robot, &Case::default());
    near.base_wrench = Some(Wrench { force: Vec3::ZERO, moment: base.transpose_mul(base_moment) });
    let mut model = Model::Cosserat(fine_options()).prepare(&robot, &case.loads).unwrap();
    let solution = model.solve(&case, Some(&near)).unwrap();

    let in_helix = |p: Vec3| start + base * p;
    let error = (in_helix(solution.shape.tip().position) - tip).norm();
    assert!(error < 1e-8, "tip off by {error:.1e}");
    for position in solution.shape.positions() {
        let p = in_helix(position);
        assert!((p.x.hypot(p.y) - 0.3).abs() < 1e-8, "{p:?} is not on the cylinder");
    }
    let base_moment_error = (base * solution.base_wrench.unwrap().moment - base_moment).norm();
    assert!(base_moment_error < 1e-8, "base moment off by {base_moment_error:.1e}");
}
