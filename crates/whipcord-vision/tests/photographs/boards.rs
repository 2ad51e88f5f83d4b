//! Boards before cameras whose lens is known.

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{Camera, Distortion, FreeParameters, Lens, Pinhole, calibrate};
use whipcord_vision::boards::{Board, BoardError, SeenBoard, Unseen, find};
use whipcord_vision::render::{Blur, BoardScene, Light, Noise, Occluder, RenderedBoard};
use whipcord_vision::{Photo, render};

const SIZE: [u32; 2] = [640, 480];

fn chessboard() -> Board {
    Board::chessboard([9, 6], 0.025).unwrap()
}

fn charuco() -> Board {
    Board::charuco([8, 6], 0.03, 0.022, "DICT_4X4_50").unwrap()
}

fn lens() -> Pinhole {
    let distortion = Distortion::new(&[-0.25, 0.08, 8e-4, -5e-4]).unwrap();
    Pinhole::new([820.0, 815.0], [325.0, 236.0], distortion).unwrap()
}

/// Where the board is seen from: distance in m, tilt about x and y and turn in rad, and how far to the right of and
/// below the middle of the view its middle is.
struct View(f64, [f64; 2], f64, [f64; 2]);

const VIEWS: [View; 9] = [
    View(0.46, [0.0, 0.0], 0.0, [0.0, 0.0]),
    View(0.52, [0.45, -0.3], 0.3, [0.02, 0.01]),
    View(0.55, [-0.5, 0.2], 1.8, [-0.03, 0.0]),
    View(0.50, [0.1, 0.55], 3.0, [0.05, -0.03]),
    View(0.60, [-0.2, -0.6], -0.4, [0.08, 0.06]),
    View(0.58, [0.6, 0.1], 0.1, [-0.09, -0.06]),
    View(0.48, [-0.35, -0.35], -0.1, [0.02, -0.03]),
    View(0.56, [0.3, 0.4], 0.2, [-0.07, 0.06]),
    View(0.62, [-0.6, -0.1], 0.0, [0.1, -0.06]),
];

impl View {
    fn camera(&self, board: &Board, lens: Pinhole, size: [u32; 2]) -> Camera {
        let Self(distance, [x, y], turn, [right, below]) = *self;
        let middle = 0.5 * (board.point(0) + board.point(board.count() - 1));
        let rotation = UnitQuaternion::exp(Vec3::new(x, y, 0.0))
            * UnitQuaternion::exp(Vec3::new(0.0, 0.0, turn));
        let position = middle - rotation.rotate(Vec3::new(right, below, distance));
        Camera::new(Lens::Pinhole(lens), Pose { position, rotation }, Some(size)).unwrap()
    }

    fn photograph(&self, board: &Board, scene: &BoardScene) -> RenderedBoard {
        scene.photograph(board, &self.camera(board, lens(), SIZE)).unwrap()
    }
}

/// Unevenly lit, a little blurred and noisy.
fn scene(blur: f64, noise: f64, seed: u64) -> BoardScene {
    BoardScene {
        light: Light { gradient: [0.4, -0.3], vignette: 0.3 },
        blur: Blur { deviation: blur, motion: [0.0; 2] },
        noise: Noise::of(noise, seed),
        ..BoardScene::default()
    }
}

fn distances(found: &SeenBoard, rendered: &RenderedBoard) -> Vec<f64> {
    let of = |[u, v]: [f64; 2], [a, b]: [f64; 2]| (u - a).hypot(v - b);
    found.corners.iter().map(|c| of(c.seen.pixel, rendered.corners[c.number])).collect()
}

fn rms(distances: &[f64]) -> f64 {
    (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt()
}

#[test]
fn corners_are_found_where_they_are() {
    for board in [chessboard(), charuco()] {
        for (k, view) in VIEWS.iter().take(2).enumerate() {
            for (blur, noise, within) in [(0.0, 0.0, 0.08), (0.7, 0.01, 0.04), (1.2, 0.02, 0.08)] {
                let rendered = view.photograph(&board, &scene(blur, noise, k as u64));
                let found = find(&rendered.photo, &board).unwrap();
                assert_eq!(found.size, SIZE);
                assert!(10 * found.corners.len() >= 7 * board.count(), "{board} {k} {blur}");
                let off = rms(&distances(&found, &rendered));
                assert!(off < within, "{board} {k} {blur}: {off}");
            }
        }
    }
}

#[test]
fn a_board_that_is_turned_has_the_same_corners_in_the_other_order_or_its_own() {
    // On its side: the rows of the chessboard are columns of the picture. Which of the two ways it is nothing tells.
    let rendered = VIEWS[2].photograph(&chessboard(), &scene(0.7, 0.01, 5));
    let found = find(&rendered.photo, &chessboard()).unwrap();
    let same = distances(&found, &rendered);
    let count = chessboard().count();
    let opposite: Vec<f64> = found
        .corners
        .iter()
        .map(|c| {
            let [a, b] = rendered.corners[count - 1 - c.number];
            (c.seen.pixel[0] - a).hypot(c.seen.pixel[1] - b)
        })
        .collect();
    assert!(rms(&same).min(rms(&opposite)) < 0.04);
    // The markers of a ChArUco board tell.
    let rendered = VIEWS[3].photograph(&charuco(), &scene(0.7, 0.01, 5));
    let found = find(&rendered.photo, &charuco()).unwrap();
    assert!(rms(&distances(&found, &rendered)) < 0.04);
}

#[test]
fn a_charuco_board_may_be_partly_hidden() {
    let hand = Occluder {
        corners: vec![[0.0, 0.0], [300.0, 0.0], [260.0, 479.0], [0.0, 479.0]],
        colour: [0.5, 0.3, 0.2],
    };
    let hidden = BoardScene { occluders: vec![hand], ..scene(0.7, 0.01, 1) };
    let rendered = VIEWS[0].photograph(&charuco(), &hidden);
    let found = find(&rendered.photo, &charuco()).unwrap();
    assert!((15..25).contains(&found.corners.len()), "{}", found.corners.len());
    assert!(distances(&found, &rendered).iter().all(|d| *d < 0.2));
    // A chessboard must not.
    let rendered = VIEWS[0].photograph(&chessboard(), &hidden);
    let unseen = find(&rendered.photo, &chessboard()).unwrap_err();
    assert!(matches!(unseen, Unseen::CutOff { seen: [4..=6, 6], expected: [9, 6] }), "{unseen}");
}

#[test]
fn what_is_no_such_board_is_refused() {
    let grey = Photo::uniform(640, 480, [0.3; 3]);
    for board in [chessboard(), charuco()] {
        assert_eq!(find(&grey, &board), Err(Unseen::NoBoard));
        for [width, height] in [[1, 1], [4, 40], [9, 40], [40, 9], [31, 31], [32, 32]] {
            let tiny = Photo::of_rgb8(width, height, &vec![128; 3 * width * height]).unwrap();
            assert_eq!(find(&tiny, &board), Err(Unseen::NoBoard), "{width}×{height}");
        }
    }
    let rendered = VIEWS[0].photograph(&chessboard(), &scene(0.7, 0.01, 1));
    let smaller = Board::chessboard([8, 5], 0.025).unwrap();
    let unseen = find(&rendered.photo, &smaller);
    assert_eq!(unseen, Err(Unseen::OtherBoard { seen: [9, 6], expected: [8, 5] }));
    let unseen = find(&rendered.photo, &charuco()).unwrap_err();
    assert!(matches!(unseen, Unseen::OtherMarkers | Unseen::NoBoard), "{unseen}");
    // The same board with markers of another dictionary.
    let other = Board::charuco([8, 6], 0.03, 0.022, "DICT_6X6_250").unwrap();
    let rendered = VIEWS[0].photograph(&charuco(), &scene(0.7, 0.01, 1));
    assert_eq!(find(&rendered.photo, &other), Err(Unseen::OtherMarkers));
}

#[test]
fn a_large_photograph_that_is_not_sharp_is_looked_at_in_a_smaller_size() {
    let lens = Pinhole::new([2400.0; 2], [960.0, 720.0], Distortion::NONE).unwrap();
    let camera = VIEWS[1].camera(&chessboard(), lens, [1920, 1440]);
    let rendered = scene(6.0, 0.01, 3).photograph(&chessboard(), &camera).unwrap();
    let found = find(&rendered.photo, &chessboard()).unwrap();
    assert!(rms(&distances(&found, &rendered)) < 0.3);
}

/// The lens within three standard deviations, each of which is not out of all proportion.
#[test]
fn photographs_of_a_board_give_the_lens() {
    for board in [chessboard(), charuco()] {
        let views: Vec<_> = VIEWS
            .iter()
            .enumerate()
            .map(|(k, view)| {
                let rendered = view.photograph(&board, &scene(0.8, 0.015, 10 + k as u64));
                find(&rendered.photo, &board).unwrap().sightings()
            })
            .collect();
        let found = calibrate(SIZE, &views, FreeParameters::Four).unwrap();
        let numbers =
            |focal: [f64; 2], centre: [f64; 2]| [focal[0], focal[1], centre[0], centre[1]];
        let (got, sure) = (&found.lens, &found.deviations);
        let all = numbers(got.focal(), got.centre())
            .into_iter()
            .chain(got.distortion().coefficients().iter().copied());
        let truth = numbers(lens().focal(), lens().centre());
        let truth = truth.into_iter().chain(lens().distortion().coefficients().to_vec());
        let deviations = numbers(sure.focal, sure.centre).into_iter().map(Some);
        let deviations = deviations.chain(sure.distortion.iter().copied());
        for ((got, truth), deviation) in all.zip(truth).zip(deviations) {
            let deviation = deviation.unwrap();
            assert!((got - truth).abs() < 3.0 * deviation, "{got} {truth} ± {deviation}");
        }
        assert!(found.rms < 0.05 && sure.pixel < 0.04, "{}", found.rms);
        assert!(sure.focal[0] < 2.0 && found.tilt > 0.9, "{:?} {}", sure.focal, found.tilt);
    }
}

#[test]
fn boards_that_there_are_not() {
    let message = |board: Result<Board, BoardError>| board.unwrap_err().to_string();
    assert!(
        message(Board::chessboard([9, 1], 0.02)).starts_with("a chessboard has 2 to 199 inner")
    );
    assert!(message(Board::chessboard([9, 6], 25.0)).contains("from 0.01 mm to 10 m, but is 25 m"));
    let charuco = |marker, name| message(Board::charuco([8, 6], 0.03, marker, name));
    assert_eq!(
        charuco(0.03, "DICT_4X4_50"),
        "markers of 30.000 mm do not fit into squares of 30.000 mm"
    );
    let text = charuco(0.02, "DICT_4X4_51");
    assert!(
        text.contains("no dictionary \"DICT_4X4_51\"") && text.contains("DICT_4X4_50,"),
        "{text}"
    );
    let text = message(Board::charuco([12, 12], 0.03, 0.02, "DICT_4X4_50"));
    assert_eq!(text, "the board has 72 markers, but DICT_4X4_50 only 50");
    let described = |text, marker| message(Board::described(text, 0.03, marker, None));
    assert!(
        described("charuco:8", None).starts_with("\"charuco:8\" is no board: give chessboard:9x6")
    );
    assert!(
        described("charuco:8x6", Some(0.02)).contains("needs the side of its markers and their")
    );
    assert!(described("chessboard:8x6", Some(0.02)).starts_with("a chessboard has no markers"));
    assert!(matches!(
        scene(0.0, 0.0, 0).photograph(
            &chessboard(),
            &Camera::new(Lens::Pinhole(lens()), Pose::IDENTITY, None).unwrap()
        ),
        Err(render::RenderError::NoSize)
    ));
}
