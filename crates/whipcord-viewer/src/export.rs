//! One page that needs no server: the page, and the frames of a grid of positions of the sliders.

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;
use whipcord::{ModelPreset, Shape, Solution, Twist, Vec3};
use whipcord_inverse::Workspace;
use whipcord_io::{CaseFile, load};

use crate::answer::{MomentLaw, moment_laws};
use crate::bench::Bench;
use crate::convert::pose;
use crate::error::ViewError;
use crate::grid::Grid;
use crate::inverse::cloud;
use crate::page::{Page, page};
use crate::protocol::{Cloud, Command, Pose, Request, Scene};
use crate::scene::{begin_with, scene};

/// Most bytes of an exported page.
pub const MOST_BYTES: usize = 5_000_000;
/// Bytes that the frames of all models together take at most, before they are written as text, which takes a third more.
const MOST_OF_FRAMES: usize = 2_600_000;
/// Frames of a model at most.
const MOST_FRAMES: usize = 4100;
/// Numbers of a touch, and how many of them frames have room for where there are obstacles.
const TOUCH_NUMBERS: usize = 13;
const TOUCHES: usize = 8;
/// Bytes of a strain and of a cable in a frame.
const STRAIN_BYTES: usize = 12;
const CABLE_BYTES: usize = 12;
/// Numbers of the pose of a movable object.
const POSE_NUMBERS: usize = 7;
/// At so many places between frames the interpolation is held against solves.
const TRIALS: usize = 100;

/// What an exported page has instead of a server. Numbers stand in base64, little-endian, frame after frame.
#[derive(Debug, Serialize)]
struct Recording {
    scene: Scene,
    /// The positions of each slider. The last frame is that of the file, which is none of theirs.
    axes: Vec<Vec<f64>>,
    models: Vec<Recorded>,
    /// What moments the strains between each two stations mean, where the stiffness is known.
    moment_laws: Option<Vec<MomentLaw>>,
    /// Where the tip can go, where the page shows that.
    #[serde(skip_serializing_if = "Option::is_none")]
    cloud: Option<Cloud>,
}

/// The frames of one model.
#[derive(Debug, Serialize)]
struct Recorded {
    model: String,
    /// What 1 of the integers of each component of the strains is: shear x, shear y, stretch, bending x, bending y, twist.
    scales: [f64; 6],
    /// Six 16-bit integers for each piece between two stations.
    strains: String,
    /// Tension in N (negative where there is none), length in m and 1 where it is slack, as 32-bit floats, of each cable.
    cables: String,
    initial_lengths: Vec<f64>,
    /// A byte for each frame: 0 where no solution was found.
    valid: String,
    /// A byte for each frame: how many touches it has.
    contact_counts: String,
    /// Of each touch, as 32-bit floats: obstacle, arc length in m, point in m, normal, force in N (negative where there is
    /// none), friction in N, and whether it sticks (negative where nothing rubs).
    contacts: String,
    /// The movable objects, by their numbers among the obstacles.
    objects: Vec<usize>,
    /// Of each of these in each frame, as 32-bit floats: position in m, quaternion (w, x, y, z).
    object_poses: String,
    /// Of all frames.
    solved: usize,
    greatest_residual: f64,
    /// How far the tip was from a solve at places between frames, in m.
    trials: Trials,
}

#[derive(Debug, Serialize)]
struct Trials {
    count: usize,
    median: f64,
    greatest: f64,
}

/// How far an export is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The model that is solved.
    pub model: ModelPreset,
    /// Solves that are done, of all models.
    pub done: usize,
    /// Solves that there are to do.
    pub all: usize,
}

/// Writes the page of a robot file, with frames of these models, or of the first that takes the robot. `tell` hears of
/// every solve that is done.
///
/// # Errors
/// [`ViewError`] for a file that cannot be used, a model that does not take the robot, a robot that is too large for one page, and a
/// binary without the page.
pub fn export(
    path: &Path,
    models: &[ModelPreset],
    tell: impl FnMut(Progress),
) -> Result<String, ViewError> {
    let file = Arc::new(load(path)?);
    let page = page()?;
    written(page, &record(&file, models, None, tell)?)
}

/// Writes the page of a robot with where its tip can go, as it was surveyed by this model.
///
/// # Errors
/// As [`export`].
pub fn export_workspace(
    file: &CaseFile,
    model: ModelPreset,
    workspace: &Workspace,
    tell: impl FnMut(Progress),
) -> Result<String, ViewError> {
    let page = page()?;
    let file = Arc::new(file.clone());
    written(page, &record(&file, &[model], Some(cloud(0, workspace)), tell)?)
}

/// The page with a recording inside.
fn written(page: Page, recording: &Recording) -> Result<String, ViewError> {
    let text = one_page(page, &serde_json::to_string(recording)?)?;
    if text.len() > MOST_BYTES {
        return Err(ViewError::TooLarge { bytes: text.len(), most: MOST_BYTES });
    }
    Ok(text)
}

fn record(
    file: &Arc<CaseFile>,
    models: &[ModelPreset],
    cloud: Option<Cloud>,
    mut tell: impl FnMut(Progress),
) -> Result<Recording, ViewError> {
    let mut scene = scene(file);
    begin_with(&mut scene, models)?;
    for choice in &mut scene.models {
        if !scene.initial.models.contains(&choice.name) {
            choice.refusal = Some("not in this page".to_owned());
        }
    }
    let presets: Vec<ModelPreset> =
        scene.initial.models.iter().filter_map(|name| name.parse().ok()).collect();
    if presets.is_empty() {
        return Err(ViewError::Refused { message: "no model takes this robot".to_owned() });
    }
    let pieces = scene.stations.len() - 1;
    let touching = if scene.obstacles.is_empty() { 0 } else { 4 * TOUCH_NUMBERS * TOUCHES };
    let moving = file.case.obstacles.iter().filter(|obstacle| obstacle.movable.is_some()).count();
    let bytes = pieces * STRAIN_BYTES
        + scene.cables.len() * CABLE_BYTES
        + 4 * POSE_NUMBERS * moving
        + 2
        + touching;
    // A cloud takes up to a megabyte.
    let room = if cloud.is_some() { MOST_OF_FRAMES / 2 } else { MOST_OF_FRAMES };
    let most = (room / presets.len() / bytes).min(MOST_FRAMES);
    let grid = Grid::new(&scene.initial.commands, |slider| scene.reach(slider), most);
    let each = grid.frames() + TRIALS;
    let all = each * presets.len();
    let recorded = presets.iter().enumerate().map(|(k, &model)| {
        let mut done = k * each;
        let mut one_more = || {
            done += 1;
            tell(Progress { model, done, all });
        };
        frames(file, &scene, &grid, model, &mut one_more)
    });
    let recorded = recorded.collect();
    let axes = grid.axes.into_iter().map(|axis| axis.values).collect();
    let laws = moment_laws(&file.robot, &scene.stations);
    let moment_laws = laws.filter(|laws| {
        laws.iter().all(|law| {
            law.rows.as_flattened().iter().chain(&law.rest).all(|number| number.is_finite())
        })
    });
    Ok(Recording { scene, axes, models: recorded, moment_laws, cloud })
}

/// Frames in an order in which each is solved from a neighbour: every other row backwards.
fn frames(
    file: &Arc<CaseFile>,
    scene: &Scene,
    grid: &Grid,
    preset: ModelPreset,
    one_more: &mut impl FnMut(),
) -> Recorded {
    let mut bench = Bench::new(Arc::clone(file));
    let row = grid.axes.last().map_or(1, |axis| axis.values.len());
    let mut all: Vec<Option<Solution>> = vec![None; grid.frames()];
    let last = all.len() - 1;
    for k in 0..=last {
        let (line, at) = (k / row, k % row);
        let turned = k < last && line % 2 == 1;
        let frame = line * row + if turned { row - 1 - at } else { at };
        all[frame] = solve(&mut bench, scene, preset, grid.commands(frame));
        one_more();
    }
    let lengths: Vec<f64> = scene.stations.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let strains: Vec<Option<Vec<Twist>>> =
        all.iter().map(|frame| Some(frame.as_ref()?.shape.strains().collect())).collect();
    let known = || strains.iter().flatten().flatten();
    let scales = [0, 1, 2, 3, 4, 5].map(|c| {
        let greatest = known().map(|&strain| component(strain, c).abs()).fold(0.0, f64::max);
        if greatest > 0.0 { greatest / f64::from(i16::MAX) } else { 1.0 }
    });
    let mut packed = Vec::with_capacity(all.len() * lengths.len() * STRAIN_BYTES);
    let mut cables = Vec::new();
    // As the page has them: in whole steps.
    let mut rounded: Vec<Option<Vec<Twist>>> = Vec::with_capacity(all.len());
    for (frame, strains) in all.iter().zip(&strains) {
        let mut pieces = Vec::with_capacity(lengths.len());
        for piece in 0..lengths.len() {
            let strain = strains
                .as_ref()
                .map_or(Twist { linear: Vec3::Z, ..Default::default() }, |s| s[piece]);
            let steps =
                [0, 1, 2, 3, 4, 5].map(|c| (component(strain, c) / scales[c]).round() as i16);
            steps.iter().for_each(|steps| packed.extend(steps.to_le_bytes()));
            let [x, y, z, bend_x, bend_y, twist]: [f64; 6] =
                core::array::from_fn(|c| f64::from(steps[c]) * scales[c]);
            let linear = Vec3::new(x, y, 1.0 + z);
            pieces.push(Twist { linear, angular: Vec3::new(bend_x, bend_y, twist) });
        }
        rounded.push(strains.is_some().then_some(pieces));
        for cable in 0..scene.cables.len() {
            let state = frame.as_ref().map(|frame| &frame.cables[cable]);
            let numbers = state.map_or([0.0; 3], |state| {
                [state.tension.unwrap_or(-1.0), state.length, f64::from(u8::from(state.slack))]
            });
            numbers.iter().for_each(|&number| cables.extend((number as f32).to_le_bytes()));
        }
    }
    let valid: Vec<u8> = all.iter().map(|frame| u8::from(frame.is_some())).collect();
    let (contact_counts, contacts) = contacts(&all);
    let (objects, object_poses) = objects(scene, &all);
    let first = all.iter().flatten().next();
    Recorded {
        model: preset.name().to_owned(),
        scales,
        strains: base64(&packed),
        cables: base64(&cables),
        initial_lengths: first
            .map(|solution| solution.cables.iter().map(|cable| cable.initial_length).collect())
            .unwrap_or_default(),
        valid: base64(&valid),
        contact_counts: base64(&contact_counts),
        contacts: base64(&contacts),
        objects,
        object_poses: base64(&object_poses),
        solved: all.iter().flatten().count(),
        greatest_residual: all.iter().flatten().map(|s| s.diagnostics.residual).fold(0.0, f64::max),
        trials: trials(&mut bench, scene, grid, preset, &rounded, &lengths, one_more),
    }
}

/// How many touches each frame has, and all of them: the first 255 of a frame, which no robot of disks comes near.
fn contacts(all: &[Option<Solution>]) -> (Vec<u8>, Vec<u8>) {
    let (mut counts, mut packed) = (Vec::with_capacity(all.len()), Vec::new());
    for frame in all {
        let contacts = frame.as_ref().map_or(&[][..], |frame| &frame.contacts);
        let kept = &contacts[..contacts.len().min(usize::from(u8::MAX))];
        counts.push(kept.len() as u8);
        for touch in kept {
            let [x, y, z] = touch.point.to_array();
            let [a, b, c] = touch.normal.to_array();
            let (obstacle, force) = (touch.obstacle as f64, touch.force.unwrap_or(-1.0));
            let [f, g, h] = touch.friction.unwrap_or_default().to_array();
            let sticks = touch.friction.map_or(-1.0, |_| f64::from(u8::from(touch.sticks)));
            let numbers: [f64; TOUCH_NUMBERS] =
                [obstacle, touch.arc_length, x, y, z, a, b, c, force, f, g, h, sticks];
            numbers.iter().for_each(|&number| packed.extend((number as f32).to_le_bytes()));
        }
    }
    (counts, packed)
}

/// The movable objects, and where each is in each frame: where there is no solution, where it is in the file.
fn objects(scene: &Scene, all: &[Option<Solution>]) -> (Vec<usize>, Vec<u8>) {
    let first = all.iter().flatten().next();
    let numbers: Vec<usize> =
        first.iter().flat_map(|frame| &frame.objects).map(|object| object.obstacle).collect();
    let mut packed = Vec::with_capacity(4 * POSE_NUMBERS * numbers.len() * all.len());
    for frame in all {
        for &number in &numbers {
            let mut of_frame = frame.iter().flat_map(|frame| &frame.objects);
            let Pose { position, orientation } = of_frame
                .find(|object| object.obstacle == number)
                .map_or(scene.obstacles[number].pose, |object| pose(&object.pose));
            let numbers = position.iter().chain(&orientation);
            numbers.for_each(|&number| packed.extend((number as f32).to_le_bytes()));
        }
    }
    (numbers, packed)
}

fn solve(
    bench: &mut Bench,
    scene: &Scene,
    preset: ModelPreset,
    commands: Vec<Command>,
) -> Option<Solution> {
    let request = Request { commands, ..scene.initial.clone() };
    let case = bench.case(&request).ok()?;
    let (_, found) = bench.found(&[preset], &case).pop()?;
    found.ok().map(|found| found.solution)
}

/// How far the interpolated tip is from the solved one, at places that fill the space between the frames evenly
/// (Halton's sequence).
fn trials(
    bench: &mut Bench,
    scene: &Scene,
    grid: &Grid,
    preset: ModelPreset,
    strains: &[Option<Vec<Twist>>],
    lengths: &[f64],
    one_more: &mut impl FnMut(),
) -> Trials {
    let mut errors = Vec::new();
    for n in 1..=TRIALS {
        one_more();
        let fractions: Vec<f64> = (0..grid.axes.len()).map(|axis| halton(n, axis)).collect();
        let commands = grid.between(&fractions);
        let Some(around) = grid.around(&commands, |frame| strains[frame].is_some()) else {
            continue;
        };
        let Some(solution) = solve(bench, scene, preset, commands) else { continue };
        let mut mixed = vec![Twist::default(); lengths.len()];
        for (frame, weight) in around {
            for (sum, &strain) in mixed.iter_mut().zip(strains[frame].iter().flatten()) {
                *sum = *sum + strain * weight;
            }
        }
        let Some(&base) = solution.shape.poses.first() else { continue };
        let tip = Shape::of_strains(base, &mixed, lengths).tip();
        errors.push((tip.position - solution.shape.tip().position).norm());
    }
    errors.sort_by(f64::total_cmp);
    Trials {
        count: errors.len(),
        median: errors.get(errors.len() / 2).copied().unwrap_or(0.0),
        greatest: errors.last().copied().unwrap_or(0.0),
    }
}

/// The radical inverse of n in the base of the axis.
fn halton(mut n: usize, axis: usize) -> f64 {
    const PRIMES: [usize; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    let base = PRIMES[axis % PRIMES.len()];
    let (mut value, mut digit) = (0.0, 1.0 / base as f64);
    while n > 0 {
        value += digit * (n % base) as f64;
        n /= base;
        digit /= base as f64;
    }
    value
}

/// A component of a strain without that of a straight, unstretched piece.
fn component(strain: Twist, c: usize) -> f64 {
    let straight = if c == 2 { 1.0 } else { 0.0 };
    if c < 3 { strain.linear[c] - straight } else { strain.angular[c - 3] }
}

/// What an exported page may do: nothing but run what is in it.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
    img-src data: blob:; media-src blob:; base-uri 'none'; form-action 'none'";

/// The page with all that it needs inside.
fn one_page(page: Page, data: &str) -> Result<String, ViewError> {
    let mut html = page.html.to_owned();
    // Text inside a script ends at the first `</script`, wherever that stands.
    let script = page.script.replace("</script", "<\\/script");
    let data = data.replace('<', "\\u003c");
    let policy = format!("<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\" />");
    let head = html.find("<head>").ok_or(ViewError::OtherPage { what: "<head>" })? + "<head>".len();
    html.insert_str(head, &policy);
    replace_tag(&mut html, "<script", "</script>", "")?;
    replace_tag(
        &mut html,
        "<link rel=\"stylesheet\"",
        ">",
        &format!("<style>{}</style>", page.style),
    )?;
    let inside = format!(
        "<script type=\"application/json\" id=\"recording\">{data}</script><script type=\"module\">{script}</script></body>"
    );
    let end = html.rfind("</body>").ok_or(ViewError::OtherPage { what: "</body>" })?;
    html.replace_range(end..end + "</body>".len(), &inside);
    Ok(html)
}

fn replace_tag(
    html: &mut String,
    start: &'static str,
    end: &'static str,
    by: &str,
) -> Result<(), ViewError> {
    let from = html.find(start).ok_or(ViewError::OtherPage { what: start })?;
    let length = html[from..].find(end).ok_or(ViewError::OtherPage { what: end })?;
    let to = from + length + end.len();
    html.replace_range(from..to, by);
    Ok(())
}

fn base64(bytes: &[u8]) -> String {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests;
