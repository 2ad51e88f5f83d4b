use proptest::prelude::*;
use whipcord::{Pose, Twist, UnitQuaternion, Vec3};
use whipcord_estimation::registration::{
    Registration, RegistrationError, register, register_by_least_turn,
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
