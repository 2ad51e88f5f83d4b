//! Loads that turn with the body.

use crate::common::accurate;
use whipcord::cosserat::{Options, Workspace};
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Model, PointLoad, Robot, Routing, Section,
    Solution, Statics, Vec3,
};

const LENGTH: f64 = 1.0;

/// A rod of length 1 with EI = 1, so slender that it hardly stretches or shears.
fn slender(cables: Vec<Cable>) -> Robot {
    let diameter: f64 = 1e-4;
    let moment_of_area = core::f64::consts::PI * diameter.powi(4) / 64.0;
    let backbone = Backbone {
        section: Some(Section::circle(diameter)),
        material: Material {
            young_modulus: Some(1.0 / moment_of_area),
            poisson_ratio: Some(0.3),
            ..Material::default()
        },
        ..Backbone::new(LENGTH)
    };
    Robot::new(backbone, Disks::equally_spaced(LENGTH, 11, 0.01), cables).unwrap()
}

fn solve(robot: &Robot, case: &Case) -> Solution {
    Model::Cosserat(accurate()).solve(robot, case).unwrap()
}

fn tip_force(force: Vec3, follower: bool) -> Loads {
    Loads { tip_force: force, tip_follower: follower, ..Loads::default() }
}

/// Inextensible cantilever under a transverse follower force at its tip (Argyris and Symeonidis,
/// Comput. Methods Appl. Mech. Eng. 26, 1981): `P L²/EI`, then slope, axial and transverse position
/// of the tip, from an initial value problem `ψ″ = a² cos ψ` started at the tip (DOP853 at 1e-13).
const TRANSVERSE: [[f64; 4]; 8] = [
    [1.0, 0.495_884_642_422_654_95, 0.935_645_669_480_692, 0.320_641_994_675_012_86],
    [2.0, 0.968_238_802_517_170_6, 0.767_362_191_534_639_8, 0.573_839_062_560_942_9],
    [5.0, 2.098_157_239_940_96, 0.172_277_875_399_125_7, 0.780_690_142_778_099_9],
    [10.0, 2.992_714_816_235_367, -0.092_123_181_189_362_1, 0.546_983_264_593_722_6],
    [15.0, 3.128_007_614_768_500_8, 0.048_501_116_586_166_945, 0.437_073_141_825_925_4],
    [20.0, 2.850_579_901_035_649_4, 0.275_710_123_090_077_4, 0.330_157_659_781_231_8],
    [30.0, 1.690_857_711_106_197_5, 0.476_141_237_130_977_3, -0.201_690_840_109_222_56],
    [
        37.142_857_142_857_146,
        0.852_172_069_508_597_9,
        0.241_388_586_637_260_18,
        -0.478_589_827_694_385_74,
    ],
];

#[test]
fn transverse_follower_force_follows_the_published_path() {
    let robot = slender(vec![]);
    for [force, slope, along, across] in TRANSVERSE {
        // What stretch and shear of the rod, of the order of EI/GA L², leave.
        let tolerance = 3e-9 * (1.0 + force);
        let case = Case { loads: tip_force(Vec3::X * force, true), ..Case::default() };
        let solution = solve(&robot, &case);
        let tip = solution.disks.tip();
        assert!((tip.position.z - along).abs() < tolerance, "{force}: {}", tip.position.z - along);
        assert!(
            (tip.position.x - across).abs() < tolerance,
            "{force}: {}",
            tip.position.x - across
        );
        let turned = tip.rotation.rotate(Vec3::Z);
        assert!((turned.x.atan2(turned.z) - slope).sin().abs() < tolerance, "{force}");
        assert_eq!(solution.diagnostics.stability, None);
    }
}

/// A follower load at the turned tip is the dead load that has the same direction there.
#[test]
fn agrees_with_the_dead_load_of_the_same_direction() {
    let cable = Cable::new("a", Routing::Helix { start_angle: 0.4, turns: 0.6, radius: 0.01 });
    let robot = slender(vec![cable]);
    let follower = Loads {
        tip_force: Vec3::new(0.4, 0.2, -0.3),
        tip_moment: Vec3::new(0.1, -0.2, 0.15),
        tip_follower: true,
        points: vec![PointLoad {
            at: 0.37,
            force: Vec3::new(-0.2, 0.3, 0.1),
            moment: Vec3::new(0.0, 0.1, 0.05),
            follower: true,
        }],
        ..Loads::default()
    };
    let case = Case { loads: follower.clone(), ..Case::with_tensions(&[40.0]) };
    let solution = solve(&robot, &case);
    let tip = solution.disks.tip().rotation;
    // The place of the point load is no disk: ask a model with a station there.
    let at_load = {
        let options = Options { stations: whipcord::Stations::Equal(101), ..accurate() };
        Model::Cosserat(options).solve(&robot, &case).unwrap().shape.poses[37].rotation
    };
    let dead = Loads {
        tip_force: tip.rotate(follower.tip_force),
        tip_moment: tip.rotate(follower.tip_moment),
        tip_follower: false,
        points: vec![PointLoad {
            at: 0.37,
            force: at_load.rotate(follower.points[0].force),
            moment: at_load.rotate(follower.points[0].moment),
            follower: false,
        }],
        ..Loads::default()
    };
    let same = solve(&robot, &Case { loads: dead, ..Case::with_tensions(&[40.0]) });
    for (a, b) in solution.disks.positions().zip(same.disks.positions()) {
        assert!((a - b).norm() < 2e-9, "{}", (a - b).norm());
    }
    let (a, b) = (solution.base_wrench.unwrap(), same.base_wrench.unwrap());
    assert!((a.force - b.force).norm() < 1e-8 && (a.moment - b.moment).norm() < 1e-8);
}

#[test]
fn an_end_moment_rolls_the_rod_up_whether_it_follows_or_not() {
    let robot = slender(vec![]);
    for (moment, follower) in [(1.5, true), (1.5, false), (6.0, true)] {
        let loads =
            Loads { tip_moment: Vec3::Y * moment, tip_follower: follower, ..Loads::default() };
        let tip = solve(&robot, &Case { loads, ..Case::default() }).disks.tip().position;
        let circle = Vec3::new((1.0 - f64::cos(moment)) / moment, 0.0, f64::sin(moment) / moment);
        assert!((tip - circle).norm() < 1e-8, "{moment} {follower}");
    }
}

#[test]
fn lengths_give_back_the_tensions_under_a_follower_load() {
    let cables = [0.0, 2.0, 4.0]
        .map(|a| Cable::new(format!("{a}"), Routing::Straight { angle: a, radius: 0.01 }));
    let robot = slender(cables.to_vec());
    let loads = tip_force(Vec3::new(0.3, -0.5, 0.2), true);
    let tensions = [60.0, 20.0, 35.0];
    let pulled = solve(&robot, &Case { loads: loads.clone(), ..Case::with_tensions(&tensions) });
    let shortenings: Vec<_> = pulled
        .cables
        .iter()
        .map(|c| whipcord::Shortening::Length(c.initial_length - c.length))
        .collect();
    let held = solve(&robot, &Case { loads, ..Case::with_shortenings(&shortenings) });
    for (cable, tension) in held.cables.iter().zip(tensions) {
        assert!((cable.tension.unwrap() / tension - 1.0).abs() < 1e-6, "{:?}", cable);
    }
}

#[test]
fn a_warm_start_finds_the_same_answer() {
    let robot = slender(vec![]);
    let case = |force: f64| Case { loads: tip_force(Vec3::X * force, true), ..Case::default() };
    let model = whipcord::cosserat::Cosserat::new(&robot, &Loads::default(), &accurate()).unwrap();
    let mut workspace = Workspace::default();
    let near = model.solve(&case(4.9), None, &mut workspace).unwrap();
    let warm = model.solve(&case(5.0), Some(&near), &mut workspace).unwrap();
    let cold = model.solve(&case(5.0), None, &mut Workspace::default()).unwrap();
    assert!((warm.disks.tip().position - cold.disks.tip().position).norm() < 1e-9);
    assert!(warm.diagnostics.iterations < cold.diagnostics.iterations);
}
