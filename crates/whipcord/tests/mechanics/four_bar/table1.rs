//! The four-bar model on the robots of the paper's Table 1, against tips found by an independent
//! program: minimisation over the rotation vector ω by sequential quadratic programming from
//! several starts, polished by Newton's method on finite differences.

use whipcord::four_bar::{Chord, Objective, Options};
use whipcord::{Case, Model, ModelKind, Robot, Routing, Statics, Stations, Vec3};

use super::{equal_disks, solve};

const HOLES: [[usize; 10]; 4] = [
    [4, 4, 4, 4, 4, 4, 4, 4, 4, 4],
    [1, 2, 3, 4, 5, 6, 7, 8, 9, 10],
    [1, 2, 3, 4, 4, 4, 4, 3, 2, 1],
    [10, 10, 10, 10, 10, 10, 11, 12, 1, 2],
];
const SHORTENINGS: [f64; 4] = [0.055, 0.070, 0.057, 0.053];

#[rustfmt::skip]
const TIPS: [(Objective, Chord, [[f64; 3]; 4]); 4] = [
    (Objective::CouplerAngle, Chord::Bisector, [
        [0.0, 0.098_001_978_2, 0.137_496_467_8],
        [0.011_746_573_2, 0.071_026_342_3, 0.154_332_320_1],
        [0.047_064_258_8, 0.080_282_589_3, 0.140_926_264_7],
        [0.012_422_465_9, -0.091_082_323_3, 0.144_103_223_8],
    ]),
    (Objective::CouplerAngle, Chord::Arc, [
        [0.0, 0.096_908_972_0, 0.138_481_411_6],
        [0.011_517_734_0, 0.069_834_833_6, 0.155_022_829_4],
        [0.046_431_328_6, 0.079_349_299_8, 0.141_863_769_3],
        [0.012_259_302_9, -0.090_042_270_2, 0.144_904_422_5],
    ]),
    (Objective::StrainEnergy, Chord::Bisector, [
        [0.0, 0.098_001_978_2, 0.137_496_467_8],
        [0.016_334_170_3, 0.072_780_162_2, 0.153_039_882_0],
        [0.050_134_043_0, 0.077_376_624_7, 0.141_824_429_1],
        [0.011_679_076_0, -0.091_157_375_0, 0.144_263_484_4],
    ]),
    (Objective::StrainEnergy, Chord::Arc, [
        [0.0, 0.096_908_972_0, 0.138_481_411_6],
        [0.015_810_449_2, 0.071_549_134_9, 0.153_813_403_2],
        [0.049_371_240_4, 0.076_607_199_0, 0.142_688_129_0],
        [0.011_557_889_4, -0.090_118_224_3, 0.145_051_723_5],
    ]),
];

fn robot(case: usize) -> Robot {
    super::robot(&equal_disks(0.18, 9), vec![Routing::holes(HOLES[case].to_vec())])
}

#[test]
fn tips_are_those_of_an_independent_minimisation() {
    for (objective, chord, tips) in TIPS {
        for case in 0..4 {
            let robot = robot(case);
            let options = Options { objective, chord, ..Options::default() };
            let initial = solve(&robot, &options, &[0.0]).cables[0].initial_length;
            let solution = solve(&robot, &options, &[SHORTENINGS[case] * initial]);
            let error = solution.disks.tip().position - Vec3::from(tips[case]);
            assert!(error.max_abs() < 2e-10, "{objective} {chord} {case}: {error:?}");
            assert!(solution.diagnostics.residual < 1e-13);
            assert!(!solution.cables[0].slack);
        }
    }
}

#[test]
fn shapes_are_near_those_of_the_cosserat_rod_with_the_same_lengths_from_hole_to_hole() {
    for case in 0..4 {
        let robot = robot(case);
        let cosserat = Model::new(ModelKind::Cosserat, Stations::Disks, Default::default());
        let rod = cosserat.solve(&robot, &Case::with_tensions(&[0.4 * 9.806_65])).unwrap();
        let length = rod.disks.hole_to_hole_length(&robot.routes()[0]).unwrap();
        let initial = solve(&robot, &Options::default(), &[0.0]).cables[0].initial_length;
        let bars = solve(&robot, &Options::default(), &[initial - length]);
        let apart = bars.disks.rms_distance(&rod.disks);
        println!("case {}: {:.3} mm", case + 1, 1e3 * apart);
        assert!(apart < 3.5e-3, "{case}: {apart}");
    }
}
