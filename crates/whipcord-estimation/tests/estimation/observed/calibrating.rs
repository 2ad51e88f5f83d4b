use whipcord::{Pose, Vec3};
use whipcord_estimation::camera::{
    CalibrationWarning, Camera, Distortion, FreeParameters, Lens, Pinhole, Sighting, calibrate,
};

/// Corners of a board of 5 by 4, 30 mm apart.
fn board() -> Vec<Vec3> {
    (0..20).map(|k| 0.03 * Vec3::new(f64::from(k % 5), f64::from(k / 5), 0.0)).collect()
}

/// What five photographs show of it.
const SEEN: [&[[f64; 2]]; 5] = [
    &[
        [180.85, 144.18],
        [252.41, 146.52],
        [320.22, 148.73],
        [383.11, 151.03],
        [442.09, 154.11],
        [176.51, 215.22],
        [246.31, 215.76],
        [312.88, 215.18],
        [375.07, 215.48],
        [432.93, 215.88],
        [172.61, 283.41],
        [241.12, 281.34],
        [306.14, 279.75],
        [366.81, 277.67],
        [423.97, 275.84],
        [169.58, 347.40],
        [236.35, 343.92],
        [299.47, 340.33],
        [359.21, 336.47],
        [415.43, 332.83],
    ],
    &[
        [188.92, 102.97],
        [266.08, 117.87],
        [350.03, 134.66],
        [438.99, 152.88],
        [531.04, 173.45],
        [151.96, 169.18],
        [232.23, 187.54],
        [319.31, 207.77],
        [412.87, 229.87],
        [510.41, 252.98],
        [112.33, 243.36],
        [194.44, 265.65],
        [285.28, 289.86],
        [382.45, 315.60],
        [484.94, 341.99],
        [70.42, 323.83],
        [154.35, 351.00],
        [247.53, 380.01],
        [348.19, 410.17],
        [455.61, 440.61],
    ],
    &[
        [93.12, 242.61],
        [146.40, 213.80],
        [206.42, 181.82],
        [274.86, 145.64],
        [352.04, 105.92],
        [123.89, 314.88],
        [178.88, 289.81],
        [241.24, 262.20],
        [312.44, 230.90],
        [392.00, 195.66],
        [155.55, 386.14],
        [212.70, 366.03],
        [277.30, 343.35],
        [350.30, 316.16],
        [432.13, 286.42],
        [187.99, 456.75],
        [246.77, 440.65],
        [312.82, 422.06],
        [387.33, 400.83],
        [470.05, 375.56],
    ],
    &[
        [331.60, 62.88],
        [397.95, 71.60],
        [466.66, 81.04],
        [537.36, 91.95],
        [608.29, 103.45],
        [330.99, 123.33],
        [395.04, 132.83],
        [461.08, 143.34],
        [528.62, 153.95],
        [596.70, 165.33],
        [330.43, 179.31],
        [392.01, 189.62],
        [455.17, 199.73],
        [520.11, 211.42],
        [584.61, 223.03],
        [330.18, 230.41],
        [388.90, 241.34],
        [449.82, 252.31],
        [511.13, 263.71],
        [573.31, 275.03],
    ],
    &[
        [411.35, 85.71],
        [428.15, 160.32],
        [443.30, 232.69],
        [457.58, 301.03],
        [470.24, 365.82],
        [350.15, 104.78],
        [369.13, 184.34],
        [386.33, 259.64],
        [403.30, 331.22],
        [418.55, 397.50],
        [280.90, 127.85],
        [303.03, 210.62],
        [323.15, 290.42],
        [342.63, 363.84],
        [360.92, 432.48],
        [203.91, 153.45],
        [228.43, 240.80],
        [252.84, 323.55],
        [275.81, 399.46],
        [297.19, 470.11],
    ],
];

fn seen() -> Vec<Vec<Sighting>> {
    let view = |pixels: &&[[f64; 2]]| {
        let pairs = board().into_iter().zip(*pixels);
        pairs.map(|(point, &pixel)| Sighting { point, pixel }).collect()
    };
    SEEN.iter().map(view).collect()
}

/// `cv2.calibrateCameraExtended(…, (640, 480), flags=…, criteria=(3, 500, 1e-15))`, OpenCV 5.0.0, with
/// `CALIB_FIX_K3`, 0, and `CALIB_FIX_K3 | CALIB_ZERO_TANGENT_DIST`: RMS; fx, fy, cx, cy; coefficients. It takes the pixels in
/// single precision.
#[test]
fn the_lens_is_that_of_opencv() {
    for (free_parameters, rms, [fx, fy, cx, cy], coefficients) in [
        (
            FreeParameters::Four,
            0.248048234,
            [811.571144592, 796.789678783, 328.800898538, 243.566957883],
            &[-0.276648565, 0.075479275, 0.001440497, -0.000726266][..],
        ),
        (
            FreeParameters::Five,
            0.247760054,
            [811.758617867, 796.960258116, 328.883552886, 243.463337767],
            &[-0.294149202, 0.335421297, 0.001366395, -0.00070339, -1.036638932][..],
        ),
    ] {
        let found = calibrate([640, 480], &seen(), free_parameters).unwrap();
        assert!((found.rms - rms).abs() < 1e-5, "{}", found.rms);
        let ([a, b], [c, d]) = (found.lens.focal(), found.lens.centre());
        for (got, expected) in [a, b, c, d].into_iter().zip([fx, fy, cx, cy]) {
            assert!((got - expected).abs() < 1e-2, "{got} {expected}");
        }
        let got = found.lens.distortion().coefficients();
        for (got, expected) in got.iter().zip(coefficients) {
            assert!((got - expected).abs() < 1e-3, "{got} {expected}");
        }
        assert_eq!(found.view_rms.len(), 5);
    }
}

/// Its standard deviations of fx, fy, cx, cy and the coefficients, and RMS of each photograph; the same call.
#[test]
fn the_deviations_are_those_of_opencv() {
    let found = calibrate([640, 480], &seen(), FreeParameters::Four).unwrap();
    let sure = &found.deviations;
    let got = [sure.focal, sure.centre].concat();
    let got = got.into_iter().chain(sure.distortion.iter().map(|deviation| deviation.unwrap()));
    let expected = [
        2.20937667,
        2.17444117,
        3.33924548,
        2.99196721,
        1.40639599e-2,
        8.19109697e-2,
        6.10724678e-4,
        5.28642077e-4,
    ];
    for (got, expected) in got.zip(expected) {
        assert!((got / expected - 1.0).abs() < 3e-5, "{got} {expected}");
    }
    let of_views = [0.22015602, 0.24418724, 0.22414674, 0.26112438, 0.28480844];
    for (got, expected) in found.view_rms.iter().zip(of_views) {
        assert!((got - expected).abs() < 1e-5, "{got} {expected}");
    }
    // What is not sought is known.
    let radial = calibrate([640, 480], &seen(), FreeParameters::Radial).unwrap();
    assert_eq!(radial.deviations.distortion[2..], [Some(0.0), Some(0.0)]);
}

#[test]
fn what_speaks_against_relying_on_it_is_said() {
    let mut views = seen();
    let warnings = |views: &[Vec<Sighting>]| {
        let found = calibrate([640, 480], views, FreeParameters::Four).unwrap();
        found.warnings([640, 480], views)
    };
    assert_eq!(warnings(&views), [CalibrationWarning::FewPhotographs { given: 5, advised: 8 }]);
    // Two corners of one photograph are taken for one another.
    let (a, b) = (views[3][7].pixel, views[3][8].pixel);
    (views[3][7].pixel, views[3][8].pixel) = (b, a);
    let warnings = warnings(&views);
    let outlier = |warning: &&CalibrationWarning| {
        matches!(warning, CalibrationWarning::Outlier { view: 3, .. })
    };
    assert!(warnings.iter().any(|warning| outlier(&warning)), "{warnings:?}");
}

#[test]
fn an_exact_lens_is_found_to_rounding() {
    let distortion = Distortion::new(&[-0.2, 0.05, 1e-3, -5e-4]).unwrap();
    let lens = Pinhole::new([812.5, 798.0], [331.25, 242.75], distortion).unwrap();
    let start = calibrate([640, 480], &seen(), FreeParameters::Four).unwrap();
    let views: Vec<Vec<Sighting>> = start
        .poses
        .iter()
        .map(|&pose| {
            let camera = Camera::new(Lens::Pinhole(lens), pose, None).unwrap();
            let see = |point: Vec3| Sighting { point, pixel: camera.project(point).unwrap() };
            board().into_iter().map(see).collect()
        })
        .collect();
    let found = calibrate([640, 480], &views, FreeParameters::Four).unwrap();
    assert!(found.rms < 1e-8, "{}", found.rms);
    for (got, expected) in found
        .lens
        .focal()
        .into_iter()
        .chain(found.lens.centre())
        .zip([812.5, 798.0, 331.25, 242.75])
    {
        assert!((got - expected).abs() < 1e-5, "{got}");
    }
    for (pose, expected) in found.poses.iter().zip(&start.poses) {
        assert!((pose.position - expected.position).norm() < 1e-8);
    }
}

#[test]
fn what_cannot_be_calibrated_is_named() {
    let message = |views: &[Vec<Sighting>], free_parameters| {
        calibrate([640, 480], views, free_parameters).unwrap_err().to_string()
    };
    assert_eq!(
        message(&seen()[..2], FreeParameters::Four),
        "a calibration needs 3 photographs of the board or more, but 2 are given"
    );
    let mut short = seen();
    short[1].truncate(3);
    assert!(
        message(&short, FreeParameters::Four)
            .starts_with("photograph 2: a board has four points or more")
    );
    // Straight on, the size of the board tells its distance and the focal length together alone.
    let lens = Lens::Pinhole(Pinhole::new([800.0; 2], [319.5, 239.5], Distortion::NONE).unwrap());
    let flat: Vec<Vec<Sighting>> = [0.3, 0.35, 0.4]
        .into_iter()
        .map(|distance| {
            let pose = Pose { position: Vec3::new(0.06, 0.045, -distance), ..Pose::IDENTITY };
            let camera = Camera::new(lens, pose, None).unwrap();
            let see = |point: Vec3| Sighting { point, pixel: camera.project(point).unwrap() };
            board().into_iter().map(see).collect()
        })
        .collect();
    assert_eq!(
        message(&flat, FreeParameters::Four),
        "the photographs do not tell the focal length: the boards in them are tilted by no more than some 0.0° to one \
         another; tilt the board to the camera by some 30°, differently in each"
    );
    // With rounding to pixels the focal length is anything.
    let mut rounded = flat;
    for at in rounded.iter_mut().flatten() {
        at.pixel = at.pixel.map(f64::round);
    }
    let text = message(&rounded, FreeParameters::None);
    assert!(text.starts_with("the photographs do not tell the focal length"), "{text}");
    let fewer: Vec<Vec<Sighting>> = seen().iter().take(3).map(|view| view[..8].to_vec()).collect();
    let eight: Vec<Vec<Sighting>> = fewer.iter().map(|view| view[3..7].to_vec()).collect();
    assert_eq!(
        message(&eight, FreeParameters::Five),
        "12 points in the photographs are too few for the 27 unknowns of lens and places: 14 or more are needed"
    );
}
