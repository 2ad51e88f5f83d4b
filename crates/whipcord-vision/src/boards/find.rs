//! The corners of a board in a photograph: found as crossings of edges (Bennett and Lasenby, ChESS: quick and robust
//! detection of chess-board features, Computer Vision and Image Understanding 118 (2014) 197) and put in their order by the
//! crates `calib-targets-*`, to sub-pixel by the saddle of a quadric.

use calib_targets_charuco::{CharucoBoardSpec, CharucoDetectError, CharucoDetector, CharucoParams};
use calib_targets_chessboard::{
    ChessboardDetection, ChessboardDetector, ChessboardParams, DetectorConfig, GrayImageView,
    default_chess_config, detect_corners,
};
use chess_corners::{ImageRefiner, OnRefinerReject, UpscaleConfig};
use whipcord_estimation::camera::Sighting;

use super::{Board, Corner, SeenBoard, Unseen};
use crate::photo::Photo;
use crate::plane::Plane;

/// Fewest corners that say where a camera is: with four, what is wrong with one is not seen.
const LEAST: usize = 6;

/// How often a photograph is halved before no board is in it: large ones are often less sharp than their pixels.
const HALVES: u32 = 2;

/// Pixels of a photograph that is not enlarged.
const LARGE: usize = 4_000_000;

/// Pixels across a picture below which the finder of corners has no room to look round one, and fails.
const LEAST_SIDE: usize = 32;

/// What is seen of a board in a photograph. With several boards it is the one of which most is seen.
///
/// # Errors
/// [`Unseen`] when that is nothing, or too little.
pub fn find(photo: &Photo, board: &Board) -> Result<SeenBoard, Unseen> {
    let grey = photo.grey();
    let mut first = None;
    for factor in (0..=HALVES).map(|k| 1 << k) {
        let found = match factor {
            1 => in_picture(&grey, board),
            _ if grey.width.min(grey.height) < 100 * factor => break,
            _ => in_picture(&grey.shrunk(factor), board),
        };
        match found {
            Ok(mut corners) => {
                // Centres of pixels of the halved picture lie between those of the whole one.
                let whole = |at: f64| factor as f64 * at + 0.5 * (factor as f64 - 1.0);
                for corner in &mut corners {
                    corner.seen.pixel = corner.seen.pixel.map(whole);
                }
                let size = [photo.width() as u32, photo.height() as u32];
                return Ok(SeenBoard { size, corners });
            }
            // A picture in half the size shows no more of a board than there is, but may show one at all.
            Err(unseen) => {
                if first.is_none_or(|first| first == Unseen::NoBoard) {
                    first = Some(unseen);
                }
            }
        }
    }
    Err(first.unwrap_or(Unseen::NoBoard))
}

fn in_picture(grey: &Plane, board: &Board) -> Result<Vec<Corner>, Unseen> {
    if grey.width.min(grey.height) < LEAST_SIDE {
        return Err(Unseen::NoBoard);
    }
    let bytes: Vec<u8> =
        grey.values.iter().map(|value| value.round().clamp(0.0, 255.0) as u8).collect();
    let view = GrayImageView { width: grey.width, height: grey.height, data: &bytes };
    let mut corners = match &board.markers {
        None => chessboard(&view, board)?,
        Some(markers) => charuco(&view, board, markers.spec())?,
    };
    corners.sort_by_key(|corner| corner.number);
    Ok(corners)
}

fn front_end() -> DetectorConfig {
    default_chess_config()
        .with_refiner(ImageRefiner::saddle_point())
        .with_chess(|chess| chess.on_refiner_reject = OnRefinerReject::Drop)
}

fn chessboard(view: &GrayImageView<'_>, board: &Board) -> Result<Vec<Corner>, Unseen> {
    let crossings = detect_corners(view, &front_end());
    let best: ChessboardDetection = ChessboardParams::sweep_default()
        .into_iter()
        .filter_map(|params| ChessboardDetector::new(params).ok())
        .filter_map(|detector| detector.detect(&crossings))
        .max_by_key(|found| found.corners.len())
        .ok_or(Unseen::NoBoard)?;
    let range = |axis: fn(&[i32; 2]) -> i32| {
        let values = || best.corners.iter().map(|corner| axis(&[corner.grid.u, corner.grid.v]));
        (values().min().unwrap_or(0), values().max().unwrap_or(0))
    };
    let (u, v) = (range(|at| at[0]), range(|at| at[1]));
    let span = [u, v].map(|(least, most)| (most - least) as usize + 1);
    let expected = board.corners;
    // Turned by a right angle the board's first row goes up or down in the picture.
    let turned = span[0] != expected[0] && span[0] == expected[1] && span[1] == expected[0];
    let along = if turned { [span[1], span[0]] } else { span };
    if along != expected {
        let seen = match (span[0] < span[1]) == (expected[0] < expected[1]) {
            true => span,
            false => [span[1], span[0]],
        };
        return Err(if seen[0] <= expected[0] && seen[1] <= expected[1] {
            Unseen::CutOff { seen, expected }
        } else {
            Unseen::OtherBoard { seen, expected }
        });
    }
    let corners: Vec<Corner> = best
        .corners
        .iter()
        .map(|corner| {
            let (i, j) = ((corner.grid.u - u.0) as usize, (corner.grid.v - v.0) as usize);
            let [i, j] = if turned { [j, span[0] - 1 - i] } else { [i, j] };
            corner_at(board, j * expected[0] + i, corner.position.x, corner.position.y)
        })
        .collect();
    enough(corners, board)
}

fn charuco(
    view: &GrayImageView<'_>,
    board: &Board,
    spec: &CharucoBoardSpec,
) -> Result<Vec<Corner>, Unseen> {
    let mut best = Err(Unseen::NoBoard);
    // Where squares are small the corners of markers are within the ring that crossings are looked for with: then in
    // twice the size. What is large has no small squares.
    let small = view.width * view.height <= LARGE;
    let sizes = [UpscaleConfig::Disabled, UpscaleConfig::Fixed(2)];
    for upscale in sizes.into_iter().take(1 + usize::from(small)) {
        let mut params = CharucoParams::for_board(*spec);
        params.chess = front_end();
        params.chess.upscale = upscale;
        let Ok(detector) = CharucoDetector::new(params) else { continue };
        match detector.detect(view) {
            Ok(found) => {
                let corners = found
                    .corners
                    .iter()
                    .map(|c| corner_at(board, c.id as usize, c.position.x, c.position.y));
                let corners: Vec<Corner> = corners.collect();
                if corners.len() == board.count() {
                    return Ok(corners);
                }
                if corners.len() > best.as_ref().map_or(0, Vec::len) {
                    best = Ok(corners);
                }
            }
            Err(CharucoDetectError::NoMarkers | CharucoDetectError::AlignmentFailed { .. })
                if best.is_err() =>
            {
                best = Err(Unseen::OtherMarkers);
            }
            Err(_) => {}
        }
    }
    enough(best?, board)
}

fn corner_at(board: &Board, number: usize, x: f32, y: f32) -> Corner {
    let pixel = [f64::from(x), f64::from(y)];
    Corner { number, seen: Sighting { point: board.point(number), pixel } }
}

fn enough(corners: Vec<Corner>, board: &Board) -> Result<Vec<Corner>, Unseen> {
    let columns = board.corners[0];
    let spread = |axis: fn(usize, usize) -> usize| {
        let mut lines: Vec<usize> = corners.iter().map(|c| axis(c.number, columns)).collect();
        lines.sort_unstable();
        lines.dedup();
        lines.len()
    };
    let lines =
        spread(|number, columns| number % columns).min(spread(|number, columns| number / columns));
    let of = board.count();
    if corners.len() < LEAST.min(of) || lines < 2 {
        return Err(Unseen::TooFew { found: corners.len(), of, least: LEAST.min(of) });
    }
    Ok(corners)
}
