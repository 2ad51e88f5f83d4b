use proptest::prelude::*;
use whipcord::{Pose, Twist, UnitQuaternion, Vec3};
use whipcord_estimation::registration::{
    Alignment, Registration, RegistrationError, align, register, register_by_least_turn,
    register_robustly,
};

const MEASURED: [[f64; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [0.06, 0.01, 0.02],
    [0.11, 0.03, -0.04],
    [-0.02, 0.09, 0.05],
    [0.03, -0.07, 0.12],
];
const TARGET: [[f64; 3]; 5] = [
    [0.301, 0.2, -0.1],
    [0.291, 0.262, -0.08],
    [0.27, 0.31, -0.139],
    [0.211, 0.18, -0.052],
    [0.372, 0.229, 0.018],
];

fn pairs() -> Vec<[Vec3; 2]> {
    MEASURED.iter().zip(&TARGET).map(|(&a, &b)| [a.into(), b.into()]).collect()
}

fn rms(motion: &Pose, pairs: &[[Vec3; 2]]) -> f64 {
    let squares = pairs.iter().map(|[a, b]| (motion.transform(*a) - *b).norm_squared());
    (squares.sum::<f64>() / pairs.len() as f64).sqrt()
}

/// Kabsch's algorithm by singular values (NumPy 2.x): the rotation `V diag(1, 1, ±1) Uᵀ` of the covariance
/// `U S Vᵀ`.
#[test]
fn the_motion_is_that_of_kabsch() {
    let found = register(&pairs()).unwrap();
    let rotation = [
        [-0.002_071_561_161_173_64, -0.999_970_802_578_635_7, 0.007_355_448_632_988_31],
        [0.999_904_216_664_143, -0.002_171_967_378_539_46, -0.013_668_944_910_728_82],
        [0.013_684_521_607_269_83, 0.007_326_428_048_185_07, 0.999_879_521_402_671],
    ];
    let matrix = found.motion.rotation.to_matrix();
    for (row, expected) in matrix.rows.iter().zip(rotation) {
        assert!((*row - Vec3::from(expected)).max_abs() < 1e-12, "{row:?}");
    }
    let position =
        Vec3::new(0.300_853_562_373_770_6, 0.200_639_580_155_955_23, -0.101_176_945_556_520_06);
    assert!((found.motion.position - position).max_abs() < 1e-14);
    assert!((found.rms - 0.001_297_502_642_089_680_8).abs() < 1e-14);
    assert!((rms(&found.motion, &pairs()) - found.rms).abs() < 1e-15);
}

#[test]
fn a_line_leaves_its_turn_open() {
    let tilt = UnitQuaternion::exp(Vec3::new(0.3, -0.2, 0.0));
    let pairs: Vec<[Vec3; 2]> = (0..5)
        .map(|i| {
            let along = 0.02 * f64::from(i) * Vec3::Z;
            [tilt.conjugate().rotate(along + Vec3::X), along]
        })
        .collect();
    assert_eq!(
        register(&pairs).unwrap_err().to_string(),
        "the points are on one line, so that any turn about it, (0, 0, 1), fits as well: measure a point off the line, or ask for the least turn"
    );
    let found = register_by_least_turn(&pairs).unwrap();
    assert_eq!(found.turn_deviation, None);
    assert!(found.rms < 1e-15);
    // The tilt is the least turn that takes one line to the other.
    assert!((found.motion.rotation * tilt.conjugate()).log().norm() < 1e-9);
    let two = register_by_least_turn(&pairs[..2]).unwrap();
    assert!((two.motion.rotation * tilt.conjugate()).log().norm() < 1e-9);
}

#[test]
fn what_cannot_be_registered_is_named() {
    let message = |pairs: &[[Vec3; 2]]| register(pairs).unwrap_err().to_string();
    assert_eq!(
        message(&pairs()[..2]),
        "a rigid registration needs 3 points or more that are known on both sides, but has 2"
    );
    let mut bad = pairs();
    bad[3][1].y = f64::NAN;
    assert_eq!(
        message(&bad),
        "a coordinate of pair 4 is NaN, which must be a finite number within 1e9 m"
    );
    assert!(matches!(
        register(&[[Vec3::X, Vec3::Y]; 4]),
        Err(RegistrationError::Coincident { .. })
    ));
    let cross = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
    assert_eq!(
        message(&cross.map(|p| [p, -p])),
        "two different turns fit the 6 pairs of points equally well: are the points of one side mirrored, or in another order?"
    );
}

/// The spread of the fitted turn about the axis of a slender set of points is the one it states.
#[test]
fn the_stated_deviation_is_that_of_repeated_measurements() {
    let target: Vec<Vec3> =
        (0..8).map(|i| Vec3::new(0.004 * f64::from(i % 2), 0.0, 0.03 * f64::from(i))).collect();
    let mut state = 1_u64;
    let mut normal = || {
        // Irwin and Hall: the sum of twelve uniform numbers less six.
        let mut sum = -6.0;
        for _ in 0..12 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum += (state >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    };
    let (mut squares, mut stated) = (0.0, 0.0);
    let runs = 400;
    for _ in 0..runs {
        let pairs: Vec<[Vec3; 2]> = target
            .iter()
            .map(|&p| [p + 1e-5 * Vec3::new(normal(), normal(), normal()), p])
            .collect();
        let found: Registration = register(&pairs).unwrap();
        squares += found.motion.rotation.log().dot(found.axis).powi(2);
        stated += found.turn_deviation.unwrap().powi(2);
    }
    let ratio = (squares / stated).sqrt();
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

proptest! {
    #[test]
    fn a_rigid_motion_is_found_and_no_other_is_better(
        points in prop::collection::vec(prop::array::uniform3(-0.2_f64..0.2), 4..12),
        noise in prop::collection::vec(prop::array::uniform3(-0.01_f64..0.01), 12),
        turn in prop::array::uniform3(-1.8_f64..1.8),
        change in prop::array::uniform6(-1e-3_f64..1e-3),
    ) {
        let motion = Pose::exp(Twist { linear: Vec3::new(0.3, -2.0, 1.0), angular: turn.into() });
        let exact: Vec<[Vec3; 2]> = points
            .iter()
            .map(|&p| [p.into(), motion.transform(p.into())])
            .collect();
        let found = register(&exact).unwrap();
        prop_assert!(found.rms < 1e-14);
        let noisy: Vec<[Vec3; 2]> =
            exact.iter().zip(noise).map(|([a, b], n)| [*a, *b + n.into()]).collect();
        let found = register(&noisy).unwrap();
        let [a, b, c, d, e, f] = change;
        let other = found.motion
            * Pose::exp(Twist { linear: Vec3::new(a, b, c), angular: Vec3::new(d, e, f) });
        prop_assert!(found.rms <= rms(&other, &noisy) + 1e-12);
    }
}

/// Numbers of 0 to 1 without a pattern.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

/// Points that a robot of 200 mm might have, as another frame has them with noise.
fn noisy(seed: &mut u64, count: usize) -> Vec<[Vec3; 2]> {
    let frame = Pose {
        position: Vec3::new(0.4, -0.2, 0.9),
        rotation: UnitQuaternion::exp(Vec3::new(0.3, -1.1, 0.4)),
    };
    let around = |seed: &mut u64, size: f64| {
        // The sum of three has nearly a normal distribution, with the standard deviation `size`.
        let mut one = || 2.0 * size * (random(seed) + random(seed) + random(seed) - 1.5);
        Vec3::new(one(), one(), one())
    };
    (0..count)
        .map(|_| {
            let target = around(seed, 0.04) + 0.18 * Vec3::Z;
            [frame.transform(target) + around(seed, 0.2e-3), target]
        })
        .collect()
}

#[test]
fn jumps_do_not_tilt_the_motion() {
    let mut seed = 7;
    for part in [0.005, 0.02, 0.08] {
        for anywhere in [false, true] {
            let mut pairs = noisy(&mut seed, 600);
            let jumps = (600.0 * part) as usize;
            let clean = register(&pairs[jumps..]).unwrap().motion;
            for pair in &mut pairs[..jumps] {
                pair[0] += match anywhere {
                    false => Vec3::new(0.04, 0.02, -0.006),
                    true => {
                        let mut one = || random(&mut seed) - 0.5;
                        // No smaller than what can be told from noise.
                        let to = Vec3::new(one(), one(), one());
                        to + to * (0.02 / to.norm())
                    }
                };
            }
            let (found, lowered) = register_robustly(&pairs).unwrap();
            assert_eq!(lowered, (0..jumps).collect::<Vec<_>>());
            let off = |motion: &Pose| {
                let apart = pairs[jumps..]
                    .iter()
                    .map(|[a, _]| (motion.transform(*a) - clean.transform(*a)).norm());
                apart.fold(0.0, f64::max)
            };
            assert!(off(&found.motion) < 5e-5, "{} of {part}", off(&found.motion));
            let squares = register(&pairs).unwrap().motion;
            assert!(off(&squares) > 3.0 * off(&found.motion), "{}", off(&squares));
            // So is that of a table, in which markers on the base count as the others.
            let aligned = align(pairs.iter().map(|pair| (*pair, false)), Alignment::Rigid).unwrap();
            assert_eq!((aligned.motion, aligned.lowered), (Some(found.motion), lowered));
        }
    }
}

#[test]
fn without_jumps_all_count_the_same() {
    let mut seed = 3;
    for count in [10, 12, 40, 2000] {
        let pairs = noisy(&mut seed, count);
        let (found, lowered) = register_robustly(&pairs).unwrap();
        assert!(lowered.is_empty());
        assert_eq!(found, register(&pairs).unwrap());
    }
    // Rounding of exact measurements is no jump, and a jump among them is one.
    let mut pairs: Vec<[Vec3; 2]> =
        noisy(&mut seed, 60).into_iter().map(|[_, target]| [target, target]).collect();
    pairs[..3].iter_mut().for_each(|pair| pair[0] += 1e-14 * Vec3::X);
    assert!(register_robustly(&pairs).unwrap().1.is_empty());
    pairs[7][0] += 0.05 * Vec3::X;
    assert_eq!(register_robustly(&pairs).unwrap().1, [7]);
    // Where a fifth of the rows is off, it is the model.
    let mut pairs = noisy(&mut seed, 500);
    pairs[..100].iter_mut().for_each(|pair| pair[0] += 0.05 * Vec3::X);
    assert_eq!(register_robustly(&pairs).unwrap(), (register(&pairs).unwrap(), Vec::new()));
}

#[test]
fn the_base_is_found_beside_jumps() {
    // One point in many steps, of which two jump; and a marker elsewhere, which does not count.
    let mut seed = 5;
    let shift = Vec3::new(0.1, 0.2, -0.3);
    let mut pairs: Vec<([Vec3; 2], bool)> = (0..40)
        .flat_map(|_| {
            let noise = 1e-4 * Vec3::new(random(&mut seed), random(&mut seed), random(&mut seed));
            [([Vec3::X, Vec3::Z], false), ([noise - shift, Vec3::ZERO], true)]
        })
        .collect();
    pairs[11].0[0] += 0.03 * Vec3::Y;
    pairs[31].0[0] -= 0.3 * Vec3::Y;
    let found = align(pairs, Alignment::Base).unwrap();
    assert_eq!(found.lowered, [11, 31]);
    assert!((found.motion.unwrap().position - shift).norm() < 1e-4);
}
