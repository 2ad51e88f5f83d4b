//! The model with cables straight from hole to hole against numbers made without it.

use crate::common::accurate;
use crate::common::paper_backbone;
use whipcord::cosserat_disks::Options;
use whipcord::{
    Backbone, Cable, Case, Disks, Loads, Material, Model, Robot, Routing, Section, SlipState,
    Statics, Stations, Vec3,
};

/// A robot with the backbone of the paper, twelve holes at 8 mm in each disk, and its answer.
struct Reference {
    rest_curvature: [f64; 3],
    tip_force: [f64; 3],
    tip_moment: [f64; 3],
    /// Holes, tension and friction coefficient.
    cables: Vec<(Vec<usize>, f64, f64)>,
    /// Tensions of a step before.
    before: Option<Vec<f64>>,
    /// Positions of the disks beyond the base.
    disks: Vec<[f64; 3]>,
    lengths: Vec<f64>,
    span_tensions: Vec<Vec<f64>>,
    /// What each cable does in all of its holes, where it rubs.
    slip_states: [SlipState; 2],
}

/// Made with SciPy: `solve_ivp` (DOP853, tolerances 1e-12 and 1e-14) takes the rod of each span as an
/// initial value problem in rotation matrices, `fsolve` finds the wrenches at the starts of all
/// spans at once from the balance of every disk with its cables and the dead load at the tip. A cable
/// that rubs loses (pulled) or gains (released) tension by `exp(μφ)` in every hole, at the base disk
/// from the z axis to its first chord.
#[rustfmt::skip]
fn references() -> Vec<Reference> {
    vec![
    Reference {
        // Precurved, two cables that rub.
        rest_curvature: [-0.231_932_377_644_189_47, -0.865_213_076_274_941_7, 3.322_999_516_644_882_7],
        tip_force: [0.0, 0.0, 0.0],
        tip_moment: [0.0, 0.0, 0.0],
        cables: vec![(vec![6, 6, 6, 7], 1.566_247_075_572_281, 0.2), (vec![7, 7, 6], 2.643_894_406_397_185, 0.2)],
        before: None,
        disks: vec![[-0.018_079_575_56, 0.002_457_623_39, 0.055_960_262_1], [-0.064_451_547_35, 0.006_693_869_66, 0.092_385_226_7], [-0.121_741_816, 0.010_208_522_32, 0.109_490_688_05]],
        lengths: vec![0.167_682_224_8, 0.108_872_273_34],
        span_tensions: vec![vec![1.468_127_282_49, 1.305_252_603_72, 1.216_828_900_71], vec![2.484_656_291_27, 2.201_815_512_61]],
        slip_states: [SlipState::Pulled; 2],
    },
    Reference {
        // Precurved, three cables, a force at the tip.
        rest_curvature: [-0.886_459_943_160_587_1, -0.291_720_232_439_864, 0.882_538_967_456_483_9],
        tip_force: [0.002_115_959_616_034_076_8, -0.004_272_225_273_743_26, 0.113_845_278_737_997_63],
        tip_moment: [0.0, 0.0, 0.0],
        cables: vec![(vec![12, 11, 11, 11, 10], 1.469_408_176_394_395_8, 0.0), (vec![4, 5, 5], 1.589_862_488_440_473_5, 0.0), (vec![3, 3, 2, 3, 2], 1.041_355_831_851_388_7, 0.0)],
        before: None,
        disks: vec![[0.001_951_516_81, 0.003_241_349_38, 0.044_771_358_25], [0.005_270_867_49, 0.011_397_957_46, 0.088_859_550_95], [0.011_497_151_09, 0.020_924_435_26, 0.132_360_923_34], [0.021_657_958_34, 0.029_960_679_56, 0.175_229_590_48]],
        lengths: vec![0.180_077_227_78, 0.088_672_922_86, 0.177_786_414_21],
        span_tensions: vec![],
        slip_states: [SlipState::Pulled; 2],
    },
    Reference {
        // Two cables, a force and a moment at the tip.
        rest_curvature: [0.0, 0.0, 0.0],
        tip_force: [-0.051_775_258_621_428_9, -0.064_814_886_467_137_37, -0.064_811_545_645_770_96],
        tip_moment: [0.004_993_555_207_495_723, -0.005_322_707_372_560_529, -0.002_173_610_831_524_22],
        cables: vec![(vec![6, 5, 6, 6], 2.135_202_293_536_309, 0.0), (vec![12, 11], 1.800_693_036_168_799_8, 0.0)],
        before: None,
        disks: vec![[-0.010_815_382_36, -0.007_384_068_88, 0.057_995_963_59], [-0.041_657_567_01, -0.019_949_719_57, 0.107_394_656_31], [-0.089_366_701_06, -0.027_650_587_99, 0.142_325_433_2]],
        lengths: vec![0.173_092_303_56, 0.060_307_297_81],
        span_tensions: vec![],
        slip_states: [SlipState::Pulled; 2],
    },
    Reference {
        // From rest under loads, which draw the second cable in as they bend the robot.
        rest_curvature: [0.0, 0.0, 0.0],
        tip_force: [0.05, 0.1, -0.04],
        tip_moment: [0.002, -0.001, 0.003],
        cables: vec![(vec![1, 1, 2, 2, 3, 3], 3.0, 0.2), (vec![9, 8, 8, 7], 1.5, 0.3)],
        before: None,
        disks: vec![[0.004_029_972_05, 0.000_967_106_75, 0.035_660_284_26], [0.014_281_679_58, 0.004_642_436_08, 0.069_902_622_19], [0.027_961_002_35, 0.012_764_670_9, 0.102_125_427_36], [0.044_255_050_99, 0.026_313_998_94, 0.131_126_766_31], [0.061_822_949_29, 0.045_423_830_04, 0.155_980_645_03]],
        lengths: vec![0.172_827_072_39, 0.111_906_608_5],
        span_tensions: vec![vec![2.928_924_27, 2.801_154_955, 2.723_194_492, 2.601_170_516, 2.500_160_844], vec![1.546_728_92, 1.666_667_117, 1.788_449_878]],
        slip_states: [SlipState::Pulled, SlipState::Released],
    },
    Reference {
        // The same, let go from 6 N and 3 N: every hole is slid through the other way.
        rest_curvature: [0.0, 0.0, 0.0],
        tip_force: [0.05, 0.1, -0.04],
        tip_moment: [0.002, -0.001, 0.003],
        cables: vec![(vec![1, 1, 2, 2, 3, 3], 1.5, 0.2), (vec![9, 8, 8, 7], 0.4, 0.3)],
        before: Some(vec![6.0, 3.0]),
        disks: vec![[0.002_875_333_06, 0.002_005_030_27, 0.035_764_123_56], [0.010_740_282_2, 0.007_948_960_13, 0.070_330_419_03], [0.022_280_490_21, 0.018_236_386_48, 0.102_787_546_97], [0.036_476_602_02, 0.032_600_190_82, 0.132_539_066_38], [0.051_701_405_15, 0.050_919_562_17, 0.159_488_244_31]],
        lengths: vec![0.174_400_909_83, 0.112_091_163_7],
        span_tensions: vec![vec![1.531_836_485, 1.606_760_371, 1.654_564_995, 1.720_161_877, 1.772_282_332], vec![0.385_342_799, 0.360_778_323, 0.335_742_133]],
        slip_states: [SlipState::Released, SlipState::Pulled],
    },
    ]
}

#[test]
fn the_answers_of_another_formulation() {
    for (k, reference) in references().into_iter().enumerate() {
        let backbone = Backbone {
            rest_curvature: Vec3::from(reference.rest_curvature).into(),
            ..paper_backbone()
        };
        let disks = Disks::equally_spaced(0.18, reference.disks.len() + 1, 0.008).with_holes(12);
        let cable = |(i, (holes, _, friction)): (usize, &(Vec<usize>, f64, f64))| Cable {
            friction: Some(*friction),
            ..Cable::new(format!("c{i}"), Routing::holes(holes.clone()))
        };
        let cables = reference.cables.iter().enumerate().map(cable).collect();
        let robot = Robot::new(backbone, disks, cables).unwrap();
        let tensions: Vec<f64> = reference.cables.iter().map(|cable| cable.1).collect();
        let case = Case {
            loads: Loads {
                tip_force: reference.tip_force.into(),
                tip_moment: reference.tip_moment.into(),
                ..Loads::default()
            },
            before: reference.before.iter().map(|t| Case::with_tensions(t).commands).collect(),
            ..Case::with_tensions(&tensions)
        };
        let solution = Model::CosseratDisks(accurate()).solve(&robot, &case).unwrap();
        for (found, expected) in solution.disks.positions().skip(1).zip(&reference.disks) {
            let error = (found - Vec3::from(*expected)).max_abs();
            assert!(error < 2e-10, "{k}: {found:?} {expected:?}");
        }
        for (cable, length) in solution.cables.iter().zip(&reference.lengths) {
            assert!((cable.length - length).abs() < 2e-10, "{k}: {cable:?} {length}");
        }
        assert_eq!(reference.span_tensions.is_empty(), solution.cables[0].slip_states.is_empty());
        let expected = reference.span_tensions.iter().zip(reference.slip_states);
        for (cable, (expected, contact)) in solution.cables.iter().zip(expected) {
            assert_eq!(cable.span_tensions.len(), expected.len());
            for (found, expected) in cable.span_tensions.iter().zip(expected) {
                assert!((found - expected).abs() < 2e-8, "{k}: {cable:?} {expected}");
            }
            assert!(cable.slip_states.iter().all(|&c| c == contact), "{k}: {cable:?}");
        }
    }
}

/// `am(u, k)`, `sn`, `cn` and the incomplete integral of the second kind `E(am u, k)`, by the
/// arithmetic-geometric mean (Abramowitz & Stegun 16.4, 17.6).
fn jacobi(u: f64, k: f64) -> [f64; 4] {
    let (mut a, mut b, mut c) = (vec![1.0], (1.0 - k * k).sqrt(), vec![k]);
    while c[c.len() - 1].abs() > 1e-15 {
        let last = a[a.len() - 1];
        c.push((last - b) / 2.0);
        a.push((last + b) / 2.0);
        b = (last * b).sqrt();
    }
    let top = a.len() - 1;
    let power = |n: usize| (1_u64 << n) as f64;
    let mut phi = power(top) * a[top] * u;
    let mut zeta = 0.0;
    for n in (1..=top).rev() {
        zeta += c[n] * phi.sin();
        phi = (phi + (c[n] / a[n] * phi.sin()).asin()) / 2.0;
    }
    let lost: f64 = c.iter().enumerate().map(|(n, c)| power(n) / 2.0 * c * c).sum();
    [phi, phi.sin(), phi.cos(), u * (1.0 - lost) + zeta]
}

/// Two disks and a cable between them are a bow with its string: with `θ` measured from the string
/// and s from the middle, `EI θ″ = −τ sin θ`, so that `sin(θ/2) = k sn(ωs, k)` with `ω² = τ/EI`. At
/// the disks the moment is τ times the distance `r cos θ` from the string: with `u = ωL/2`,
/// `2 k cn u = ω r (1 − 2k² sn² u)`. The rod spans `2(2E(am u) − u)/ω` along the string, and the
/// string is `2 r sin θ(L/2)` shorter.
#[test]
fn a_span_is_an_elastica() {
    let (length, radius, young, diameter) = (0.1_f64, 0.008_f64, 1.1e9_f64, 0.003_f64);
    let stiffness = young * core::f64::consts::PI * diameter.powi(4) / 64.0;
    for tension in [0.3, 1.0, 2.0, 3.0, 3.5] {
        let omega = (tension / stiffness).sqrt();
        let u = omega * length / 2.0;
        let lack = |k: f64| {
            let [_, sn, cn, _] = jacobi(u, k);
            2.0 * k * cn - omega * radius * (1.0 - 2.0 * k * k * sn * sn)
        };
        let (mut low, mut high) = (0.0, 0.95);
        assert!(lack(low) < 0.0 && lack(high) > 0.0, "{tension}");
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            *(if lack(middle) < 0.0 { &mut low } else { &mut high }) = middle;
        }
        let [_, sn, _, second] = jacobi(u, low);
        let half = 2.0 * (low * sn).asin();
        let along = 2.0 * (2.0 * second - u) / omega;

        let backbone = Backbone {
            section: Some(Section::circle(diameter)),
            material: Material {
                young_modulus: Some(young),
                poisson_ratio: Some(0.3),
                ..Material::default()
            },
            shearable: false,
            extensible: false,
            ..Backbone::new(length)
        };
        let disks = Disks::equally_spaced(length, 2, radius).with_holes(4);
        let cable = Cable::new("string", Routing::holes(vec![1, 1]));
        let robot = Robot::new(backbone, disks, vec![cable]).unwrap();
        let options = Options { stations: Stations::Equal(5), ..accurate() };
        let model = Model::CosseratDisks(options);
        let solution = model.solve(&robot, &Case::with_tensions(&[tension])).unwrap();
        let tip = solution.disks.tip();
        let bend = tip.rotation.log().y;
        assert!((bend - 2.0 * half).abs() < 1e-8, "{tension}: {bend} {}", 2.0 * half);
        assert!((tip.position.norm() - along).abs() < 1e-10, "{tension}: {along}");
        let string = along - 2.0 * radius * half.sin();
        assert!((solution.cables[0].length - string).abs() < 1e-10, "{tension}: {string}");
        // The tip sees the base under half the bend.
        assert!((tip.position.x.atan2(tip.position.z) - half).abs() < 1e-8);
    }
}
