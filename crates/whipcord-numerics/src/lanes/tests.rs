use pulp::WithSimd;

use super::*;
use crate::{Mat3, Pose, Twist, UnitQuaternion, Vec3, magnus_6};

/// Twists whose parts are between -0.2 and 0.2.
fn twists(count: usize) -> Vec<[Twist; 3]> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64 * 0.4 - 0.2
    };
    let mut vector = || Vec3::new(next(), next(), next());
    let mut twist = || Twist { linear: vector(), angular: vector() };
    (0..count).map(|_| [twist(), twist(), twist()]).collect()
}

struct Motions<'a>(&'a [[Twist; 3]]);

impl WithSimd for Motions<'_> {
    type Output = Vec<[f64; 7]>;

    /// Each motion made twice, in the order given.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<[f64; 7]> {
        let mut out = Vec::new();
        for chunk in self.0.chunks_exact(8) {
            for group in chunk.chunks_exact(Lanes::<S>::COUNT) {
                let part = |f: &dyn Fn(&[Twist; 3]) -> f64| {
                    let values: Vec<f64> = group.iter().map(f).collect();
                    Lanes::load(simd, &values, 0)
                };
                let vector = |f: &dyn Fn(&[Twist; 3]) -> Vec3| {
                    LaneVec3::new(part(&|t| f(t).x), part(&|t| f(t).y), part(&|t| f(t).z))
                };
                let twist = |i: usize| LaneTwist {
                    linear: vector(&|t| t[i].linear),
                    angular: vector(&|t| t[i].angular),
                };
                let motion = LanePose::exp(magnus_6_exponent(&[twist(0), twist(1), twist(2)]));
                let pose = LanePose::identity(simd).then(motion).then(motion);
                for lane in 0..Lanes::<S>::COUNT {
                    let p = [
                        pose.position.x,
                        pose.position.y,
                        pose.position.z,
                        pose.w,
                        pose.v.x,
                        pose.v.y,
                        pose.v.z,
                    ];
                    out.push(p.map(|lanes| lanes.as_slice()[lane]));
                }
            }
        }
        out
    }
}

#[test]
fn lanes_do_what_scalars_do_to_the_last_bit() {
    let twists = twists(8 * 500);
    let expected: Vec<[f64; 7]> = twists
        .iter()
        .map(|twists| {
            let motion = magnus_6(twists);
            let pose = Pose::IDENTITY * motion * motion;
            let ([x, y, z], [w, a, b, c]) = (pose.position.to_array(), pose.rotation.wxyz());
            [x, y, z, w, a, b, c]
        })
        .collect();
    for width in [Width::Widest, Width::Avx2, Width::One] {
        assert!(width.dispatch(Motions(&twists)) == expected, "{width:?}");
    }
}

/// Factors matrices that need not be definite, and solves with them.
struct Factors<'a>(&'a [Mat3]);

const RIGHT: Vec3 = Vec3::new(1.0, -2.0, 0.5);

impl WithSimd for Factors<'_> {
    type Output = Vec<Option<Vec3>>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = Vec::new();
        for group in self.0.chunks_exact(Lanes::<S>::COUNT) {
            let entry = |i: usize, j: usize| {
                let values: Vec<f64> = group.iter().map(|a| a.rows[i][j]).collect();
                Lanes::load(simd, &values, 0)
            };
            let (xx, yx, yy) = (entry(0, 0), entry(1, 0), entry(1, 1));
            let (zx, zy, zz) = (entry(2, 0), entry(2, 1), entry(2, 2));
            let (factors, definite) = LaneSym3 { xx, yx, yy, zx, zy, zz }.ldlt(simd);
            let solved = factors.solve(LaneVec3::splat(simd, RIGHT));
            let (one, zero) = (Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0));
            let definite = definite.select(one, zero);
            for lane in 0..Lanes::<S>::COUNT {
                let [x, y, z] = [solved.x, solved.y, solved.z].map(|x| x.as_slice()[lane]);
                out.push((definite.as_slice()[lane] == 1.0).then(|| Vec3::new(x, y, z)));
            }
        }
        out
    }
}

#[test]
fn factors_are_those_of_scalars_to_the_last_bit() {
    let matrix = |[a, b, c]: &[Twist; 3]| {
        let rows = Mat3::from_rows(a.linear, a.angular, b.linear);
        let square = rows * rows.transpose();
        // Some of them are not definite, and some hold an unknown.
        let shift = Mat3::diagonal(c.linear * 0.02);
        let mut matrix = square + shift;
        if c.angular.x > 0.15 {
            matrix.rows[1].y = f64::INFINITY;
        }
        matrix
    };
    let matrices: Vec<Mat3> = twists(8 * 200).iter().map(matrix).collect();
    let expected: Vec<Option<Vec3>> =
        matrices.iter().map(|a| a.ldlt().map(|factors| factors.solve(RIGHT))).collect();
    assert!(expected.iter().filter(|x| x.is_none()).count() > 50);
    assert!(expected.iter().flatten().filter(|x| x.y == 0.0).count() > 50);
    for width in [Width::Widest, Width::Avx2, Width::One] {
        assert!(width.dispatch(Factors(&matrices)) == expected, "{width:?}");
    }
}

#[test]
fn widths_are_those_of_the_processor() {
    assert_eq!(Width::One.lanes(), 1);
    assert!(Width::Avx2.lanes() <= 4);
    assert!(Width::Widest.lanes() >= Width::Avx2.lanes());
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx512f") {
        assert_eq!([Width::Avx2.lanes(), Width::Widest.lanes()], [4, 8]);
    }
}

struct Turns<'a>(&'a [Pose]);

impl WithSimd for Turns<'_> {
    type Output = Vec<Option<Vec3>>;

    /// From each to the next, in groups of as many as there are lanes.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut out = Vec::new();
        let lanes = Lanes::<S>::COUNT;
        for first in (0..self.0.len() - 1).step_by(lanes).take_while(|at| at + lanes < self.0.len())
        {
            let pose = |first: usize| {
                let of = |f: &dyn Fn(&Pose) -> f64| {
                    let values: Vec<f64> = self.0[first..first + lanes].iter().map(f).collect();
                    Lanes::load(simd, &values, 0)
                };
                let v = LaneVec3::new(
                    of(&|pose| pose.rotation.v.x),
                    of(&|pose| pose.rotation.v.y),
                    of(&|pose| pose.rotation.v.z),
                );
                let w = of(&|pose| pose.rotation.w);
                LanePose { position: LaneVec3::splat(simd, Vec3::ZERO), w, v }
            };
            let turn = pose(first + 1).turn_from(&pose(first));
            out.extend((0..lanes).map(|lane| turn.map(|turn| turn.of(lane))));
        }
        out
    }
}

#[test]
fn a_small_turn_between_frames_in_lanes_is_that_of_scalars() {
    let turned = |k: usize, scale: f64| {
        let axis = Vec3::new((0.7 * k as f64).sin(), 0.3, (1.3 * k as f64).cos());
        let rotation = UnitQuaternion::exp(axis * (scale * k as f64));
        Pose { position: Vec3::ZERO, rotation }
    };
    let poses: Vec<Pose> = (0..65).map(|k| turned(k, 4e-4)).collect();
    for width in [Width::Widest, Width::Avx2, Width::One] {
        let turns = width.dispatch(Turns(&poses));
        assert_eq!(turns.len(), 64);
        for (pair, turn) in poses.windows(2).zip(turns) {
            let expected = (pair[0].rotation.conjugate() * pair[1].rotation).log();
            assert!((turn.unwrap() - expected).max_abs() < 1e-15, "{width:?}");
        }
        // The arcsine's series does not reach so far.
        let far: Vec<Pose> = (0..9).map(|k| turned(k, 0.3)).collect();
        assert!(width.dispatch(Turns(&far)).iter().any(Option::is_none));
    }
}
