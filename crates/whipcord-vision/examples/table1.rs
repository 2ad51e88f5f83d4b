//! The paper's procedure on synthetic photographs of its four cases, printed in the form of its Table 1.
//!
//! `cargo run --release -p whipcord-vision --example table1 [-- FOLDER]`, from the root of the repository; with a folder
//! the photographs are written there, as they are and with what was found.
//!
//! In place of the real robot stands the model with cables straight from hole to hole, under the paper's 400 g. It is
//! photographed before and after actuation through a lens that bends a little, under uneven light and with noise. The
//! first photograph gives the scale, from the backbone's known length, and where the base is and how it stands. In the
//! second the disks are found, and the two models of the paper are laid over it, as it lays them: in the plane of
//! the picture, without a camera model. The paper's own numbers are against photographs that are not public.

#![allow(clippy::print_stdout, reason = "an example prints what it shows")]

use std::error::Error;
use std::path::{Path, PathBuf};

use whipcord::{
    Actuation, Model, ModelKind, Pose, Robot, Shape, Solution, Stations, UnitQuaternion, Vec3,
};
use whipcord_estimation::camera::{
    Camera, Distortion, Lens, LocateError, Pinhole, Sighting, locate,
};
use whipcord_estimation::observation::{in_image, overlay};
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_io::CaseFile;
use whipcord_vision::detect::{Base, Expected, Kind, Mark, Search, find, in_order};
use whipcord_vision::render::{Blur, Light, Noise, Rendered, Scene};
use whipcord_vision::{Photo, annotated};

/// Length of the backbone in mm.
const LENGTH: f64 = 180.0;
/// Of the photographs, in pixels.
const SIZE: [u32; 2] = [1400, 1000];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    println!(
        "SYNTHETIC photographs; RMS over disks 2 to 10 in mm: in the plane of the picture, through the"
    );
    println!("camera that the unbent robot locates, and in brackets the paper's, of a real robot");
    println!(
        "{:20} {:>18} {:>18} {:>10} {:>8}",
        "case", "four-bar", "cosserat", "detection", "px/mm"
    );
    for number in 1..=4 {
        let file = whipcord_io::load(format!("examples/table1/case-{number}.toml"))?;
        let straight = whipcord_io::load("examples/table1/prototype.toml")?;
        let lens = Pinhole::new(
            [6400.0, 6400.0],
            [702.0, 497.0],
            Distortion::new(&[-0.2, 0.05, 0.0, 0.0])?,
        )?;
        let camera = camera(lens)?;
        let real = solve(&file, ModelKind::CosseratDisks)?;
        let before =
            photograph(&straight.robot, &solve(&straight, ModelKind::Cosserat)?, &camera, 0)?;
        let after = photograph(&file.robot, &real, &camera, number)?;

        let unbent = disks(&before.photo)?;
        let (base, tip) = (unbent[0].pixel, unbent[9].pixel);
        let (along, up) = (distance(base, tip), [tip[0] - base[0], tip[1] - base[1]]);
        let scale = along / LENGTH;
        let up = up.map(|c| c / along);
        // The plane of the picture in mm: to the right, which is the robot's y, and along the unbent robot.
        let plane = |p: [f64; 2]| {
            let [u, v] = [p[0] - base[0], p[1] - base[1]];
            [(v * up[0] - u * up[1]) / scale, (u * up[0] + v * up[1]) / scale]
        };
        let marks = disks(&after.photo)?;
        let seen: Vec<[f64; 2]> = marks.iter().map(|mark| plane(mark.pixel)).collect();
        let off: Vec<f64> =
            marks.iter().zip(&after.disks).map(|(m, t)| distance(m.pixel, *t) / scale).collect();

        let located = located(&lens, &straight.robot, &unbent)?;
        let markers = in_image(&file.robot, &observations(&marks), 0, 0);

        let mut cells = Vec::new();
        for (kind, paper) in [
            (ModelKind::FourBar, PAPER[number - 1][0]),
            (ModelKind::Cosserat, PAPER[number - 1][1]),
        ] {
            let shape = solve(&file, kind)?.disks;
            let errors: Vec<f64> = flat(&shape).zip(&seen).map(|(a, b)| distance(a, *b)).collect();
            let model = Model::new(kind, Stations::Disks, Actuation::Natural);
            let overlaid = overlay(&model, &file.robot, &file.case, &located, &markers, 2)?;
            let beside: Vec<f64> =
                overlaid.residuals.iter().flatten().map(|miss| 1e3 * miss.distance).collect();
            cells.push(format!("{:.2}  {:.2} ({paper:.2})", rms(&errors[1..]), rms(&beside[1..])));
            let list = |errors: &[f64]| -> String {
                errors.iter().map(|error| format!(" {error:5.2}")).collect()
            };
            println!("    {kind:9} error at each disk in mm, plane: {}", list(&errors));
            println!("    {:9}                            camera:{}", "", list(&beside));
        }
        let (title, detection) = (&file.title, rms(&off));
        println!("{title:20} {:>18} {:>18} {detection:>10.3} {scale:>8.3}", cells[0], cells[1]);
        if let Some(folder) = &folder {
            write(folder, number, &before.photo, &after.photo, &marks)?;
        }
    }
    Ok(())
}

/// RMS errors of the paper's Table 1 in mm: optimisation-based (four-bar) and Cosserat.
const PAPER: [[f64; 2]; 4] = [[1.79, 2.08], [1.85, 1.87], [1.44, 1.80], [1.37, 1.90]];

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// The disks in the plane of the picture, y and z in mm.
fn flat(shape: &Shape) -> impl Iterator<Item = [f64; 2]> + '_ {
    shape.positions().map(|p| [1e3 * p.y, 1e3 * p.z])
}

fn solve(file: &CaseFile, kind: ModelKind) -> Result<Solution, Box<dyn Error>> {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    Ok(model.prepare(&file.robot, &file.case.loads)?.solve(&file.case, None)?)
}

/// 1.5 m away, looking along −x, the robot upright in 1400×1000 pixels.
fn camera(lens: Pinhole) -> Result<Camera, Box<dyn Error>> {
    let rotation = UnitQuaternion::from_wxyz([0.5, -0.5, -0.5, 0.5]).unwrap_or_default();
    let pose = Pose { position: Vec3::new(1.5, 0.0, 0.09), rotation };
    Ok(Camera::new(Lens::Pinhole(lens), pose, Some(SIZE))?)
}

/// The camera, where the disks of the unbent robot put it; that it looks along −x is known.
fn located(lens: &Pinhole, robot: &Robot, unbent: &[Mark]) -> Result<Camera, LocateError> {
    let centres = robot.disks().arc_lengths.iter().map(|&s| Vec3::new(0.0, 0.0, s));
    let seen: Vec<Sighting> =
        centres.zip(unbent).map(|(point, mark)| Sighting { point, pixel: mark.pixel }).collect();
    Ok(locate(lens, Some(SIZE), &seen, Some(-Vec3::X))?.camera)
}

fn observations(marks: &[Mark]) -> Vec<Observation> {
    let of_disk = |(disk, mark): (usize, &Mark)| Observation {
        step: 0,
        place: Place::Disk(disk),
        offset: Vec3::ZERO,
        seen: Seen::Pixel { camera: 0, pixel: mark.pixel },
        deviation: None,
    };
    marks.iter().enumerate().map(of_disk).collect()
}

fn photograph(
    robot: &Robot,
    solution: &Solution,
    camera: &Camera,
    seed: usize,
) -> Result<Rendered, Box<dyn Error>> {
    let mut scene = Scene::of(robot);
    scene.light = Light { gradient: [0.35, -0.25], vignette: 0.3 };
    scene.blur = Blur { deviation: 1.0, motion: [0.0, 0.0] };
    scene.noise = Noise::of(0.02, seed as u64);
    Ok(scene.photograph(robot, solution, camera)?)
}

fn disks(photo: &Photo) -> Result<Vec<Mark>, Box<dyn Error>> {
    let search = Search { kind: Kind::Disks, colour: None, radius: None, mask: None };
    let expected = Expected { count: Some(10), base: Some(Base::Bottom), places: None };
    Ok(in_order(&find(photo, &search)?, &expected)?)
}

fn write(
    folder: &Path,
    number: usize,
    before: &Photo,
    after: &Photo,
    marks: &[Mark],
) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    for (name, photo) in [("before", before), ("after", after)] {
        std::fs::write(folder.join(format!("case-{number}-{name}.png")), photo.to_png()?)?;
    }
    let numbered: Vec<_> = (1..).zip(marks.iter().copied()).collect();
    let found = annotated(after, Kind::Disks, &numbered);
    std::fs::write(folder.join(format!("case-{number}-found.jpg")), found.to_jpeg()?)?;
    Ok(())
}
