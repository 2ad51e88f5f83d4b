//! Shapes that another program writes, one JSON object in each line, and that all pages show as they come.

use std::fmt::Display;
use std::io::BufRead;
use std::sync::Arc;
use std::time::Instant;

use serde::Deserialize;
use tokio::sync::watch;
use whipcord::{ModelKind, ModelPreset, Pose, Shape, UnitQuaternion};
use whipcord_io::CaseFile;

use crate::answer::of_shape;
use crate::history::History;
use crate::protocol::{CableState, Shown};
use crate::scene::initial_lengths;
use crate::stations::Places;

/// Most bytes of a line.
const MOST_BYTES: u64 = 4 * 1024 * 1024;
/// Most stations of a shape, and most markers.
const MOST_PLACES: usize = 10_000;

/// What a line says. Lengths are in m, in the world; quaternions are (w, x, y, z).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    /// In s; without it, since the first line.
    time: Option<f64>,
    /// A shape of each robot, in the order of the robots; null for one that stays as it is.
    #[serde(default)]
    shapes: Vec<Option<GivenShape>>,
    /// Positions of markers.
    #[serde(default)]
    measured: Vec<[f64; 3]>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GivenShape {
    /// Of the model that it is of, or of what else it comes from.
    model: Option<String>,
    arc_length: Vec<f64>,
    positions: Vec<[f64; 3]>,
    orientations: Vec<[f64; 4]>,
    /// In N, of each cable.
    tensions: Option<Vec<Option<f64>>>,
}

/// A robot whose shapes come by a stream.
#[derive(Debug)]
pub struct Streamed {
    file: Arc<CaseFile>,
    places: Places,
    initial_lengths: Vec<f64>,
}

impl Streamed {
    /// The robot of a file.
    pub fn new(file: &Arc<CaseFile>) -> Self {
        let places = Places::of(&file.robot);
        let initial_lengths = initial_lengths(&file.robot, &places);
        Self { file: Arc::clone(file), places, initial_lengths }
    }
}

/// Reads lines until there are no more, and tells of each; of a line that means nothing it says why.
pub fn follow(
    mut lines: impl BufRead,
    robots: &[Streamed],
    tell: &watch::Sender<History>,
    mut complain: impl FnMut(&dyn Display),
) {
    let begun = Instant::now();
    let mut text = Vec::new();
    for number in 1_u64.. {
        text.clear();
        let mut limited = std::io::Read::take(&mut lines, MOST_BYTES);
        match limited.read_until(b'\n', &mut text) {
            Ok(0) => return,
            Err(error) => return complain(&format_args!("the stream has ended: {error}")),
            Ok(_) => {}
        }
        if text.len() as u64 == MOST_BYTES {
            return complain(&format_args!(
                "line {number} of the stream has more than {MOST_BYTES} bytes: send fewer stations"
            ));
        }
        if text.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        match shown(&text, robots, begun.elapsed().as_secs_f64()) {
            Ok(shown) => tell.send_modify(|history| history.push(shown)),
            Err(why) => complain(&format_args!("line {number} of the stream: {why}")),
        }
    }
}

/// What a line has the pages show.
fn shown(text: &[u8], robots: &[Streamed], now: f64) -> Result<Shown, String> {
    let line: Line = serde_json::from_slice(text).map_err(|error| error.to_string())?;
    if line.shapes.len() > robots.len() {
        return Err(format!(
            "{} shapes are given for {} robots: name the files of all robots when the viewer is started",
            line.shapes.len(),
            robots.len()
        ));
    }
    let time = line.time.unwrap_or(now);
    if !time.is_finite() || line.measured.as_flattened().iter().any(|x| !x.is_finite()) {
        return Err("a number is not finite".to_owned());
    }
    if line.measured.len() > MOST_PLACES {
        return Err(format!("more than {MOST_PLACES} markers are given"));
    }
    let shapes = line.shapes.into_iter().zip(robots).enumerate().map(|(k, (given, robot))| {
        let answer = given.map(|given| answer(given, robot)).transpose();
        answer.map_err(|why| format!("shape {}: {why}", k + 1))
    });
    Ok(Shown { time, shapes: shapes.collect::<Result<_, _>>()?, measured: line.measured })
}

fn answer(given: GivenShape, robot: &Streamed) -> Result<crate::protocol::Answer, String> {
    let Streamed { file, places, initial_lengths } = robot;
    let GivenShape { model, arc_length, positions, orientations, tensions } = given;
    let count = arc_length.len();
    if positions.len() != count || orientations.len() != count {
        return Err(format!(
            "{count} arc lengths, {} positions and {} orientations: there must be as many of each",
            positions.len(),
            orientations.len()
        ));
    }
    if !(2..=MOST_PLACES).contains(&count) {
        return Err(format!("{count} stations: give 2 to {MOST_PLACES}"));
    }
    let numbers = positions.as_flattened().iter().chain(&arc_length);
    if numbers.chain(orientations.as_flattened()).any(|x| !x.is_finite()) {
        return Err("a number is not finite".to_owned());
    }
    if arc_length.windows(2).any(|ends| ends[1] <= ends[0]) {
        return Err("the arc lengths do not ascend".to_owned());
    }
    let cables = file.robot.cables().len();
    if tensions.as_ref().is_some_and(|all| all.len() != cables) {
        return Err(format!("tensions: give one for each of the {cables} cables"));
    }
    let poses = positions.iter().zip(&orientations).map(|(&position, &turn)| {
        let rotation = UnitQuaternion::from_wxyz(turn)
            .ok_or_else(|| "an orientation is a quaternion of length 0".to_owned())?;
        Ok(Pose { position: position.into(), rotation })
    });
    let given = Shape { arc_length, poses: poses.collect::<Result<_, String>>()? };
    // It need not be known where the page wants it.
    let shape = places.along(&given);
    let cables = initial_lengths.iter().enumerate().map(|(k, &initial_length)| CableState {
        tension: tensions.as_ref().and_then(|all| all[k]),
        length: initial_length,
        initial_length,
        shortening: 0.0,
        slack: false,
        span_tensions: Vec::new(),
    });
    let usual = || ModelPreset::usual(ModelKind::Cosserat).name().to_owned();
    Ok(of_shape(&file.robot, model.unwrap_or_else(usual), &shape, cables.collect(), 0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

    use super::*;
    use crate::protocol::Answer;
    use crate::tests::example;

    fn robot() -> Streamed {
        Streamed::new(&Arc::new(whipcord_io::load(example("two-segment-arm.toml")).unwrap()))
    }

    /// What is told of these lines last, and the complaints.
    fn told(text: &str, robots: &[Streamed]) -> (Option<Arc<Shown>>, Vec<String>) {
        let (tell, heard) = watch::channel(History::default());
        let mut complaints = Vec::new();
        follow(text.as_bytes(), robots, &tell, |why| complaints.push(why.to_string()));
        let last = heard.borrow().latest();
        (last, complaints)
    }

    #[test]
    fn a_shape_is_shown_at_the_stations_of_the_page() {
        let robots = [robot()];
        // A quarter of a circle about y, known at five places, moved to (1, 2, 3).
        let length = robots[0].file.robot.backbone().length;
        let radius = length / std::f64::consts::FRAC_PI_2;
        let place = |s: f64| {
            let phi = s / radius;
            [1.0 + radius * (1.0 - phi.cos()), 2.0, 3.0 + radius * phi.sin()]
        };
        let s: Vec<f64> = (0..5).map(|k| length * f64::from(k) / 4.0).collect();
        let positions: Vec<_> = s.iter().map(|&s| place(s)).collect();
        let turn = |s: f64| [(0.5 * s / radius).cos(), 0.0, (0.5 * s / radius).sin(), 0.0];
        let orientations: Vec<_> = s.iter().map(|&s| turn(s)).collect();
        let line = serde_json::json!({
            "time": 1.5, "measured": [[0.1, 0.2, 0.3]],
            "shapes": [{"arc_length": s, "positions": positions, "orientations": orientations}],
        });
        let (last, complaints) = told(&format!("{line}\n\n"), &robots);
        assert_eq!(complaints, [""; 0]);
        let last = last.unwrap();
        assert_eq!((last.time, last.measured.clone()), (1.5, vec![[0.1, 0.2, 0.3]]));
        let Some(Answer::Solved(solved)) = &last.shapes[0] else { panic!("{last:?}") };
        for (&s, found) in robots[0].places.arc_lengths.iter().zip(&solved.positions) {
            let off = place(s).iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-3 * length, "{off} at {s}");
        }
        // Its curvature is that of the circle.
        assert!(solved.strains.iter().all(|e| (e[1] - 1.0 / radius).abs() < 1e-2 / radius));
    }

    #[test]
    fn lines_that_mean_nothing_are_named_and_passed_over() {
        let robots = [robot()];
        let text = "nonsense\n{\"time\": 2}\n{\"shapes\": [null, null]}\n\
            {\"shapes\": [{\"arc_length\": [0, 0], \"positions\": [[0,0,0],[0,0,1]], \"orientations\": [[1,0,0,0],[1,0,0,0]]}]}\n\
            {\"shapes\": [{\"arc_length\": [0, 1], \"positions\": [[0,0,0],[0,0,1]], \"orientations\": [[1,0,0,0],[0,0,0,0]]}]}\n\
            {\"shapes\": [{\"arc_length\": [0, 1], \"positions\": [[0,0,0]], \"orientations\": [[1,0,0,0],[1,0,0,0]]}]}\n";
        let (last, complaints) = told(text, &robots);
        assert_eq!(last.unwrap().time, 2.0);
        let words = ["line 1", "line 3 of the stream: 2 shapes", "ascend", "length 0", "as many"];
        assert_eq!(complaints.len(), words.len(), "{complaints:?}");
        for (complaint, words) in complaints.iter().zip(words) {
            assert!(complaint.contains(words), "{complaint}");
        }
    }
}
