//! `whipcord measure`: where the disks or markers are in a photograph.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};
use whipcord::Disks;
use whipcord_estimation::camera::Camera;
use whipcord_io::{CaseFile, load_camera, marks_csv};
use whipcord_vision::detect::{Base, DetectError, Kind, Mark, Mask, Row, Search, colour, find_row};
use whipcord_vision::{Photo, annotated};

use crate::inputs::{Settings, read_one};
use crate::path_argument::path_ending_in;
use crate::photographs::Photograph;
use whipcord_study::failure::Failure;
use whipcord_study::failure::message;
use whipcord_study::files::{self, no_result, write};
use whipcord_study::quantity::fixed;
use whipcord_study::style::Style;
use whipcord_study::table::{Align, Table};

/// Find disks or markers in a photograph
///
/// Prints column and row of each disk or marker in pixels, from base to tip; the centre of the
/// first pixel is (0, 0). -o writes them to a CSV file for [measured], --annotated draws them into
/// a copy of the photograph. If too few or too many are found, or if their order is unclear,
/// standard error lists the detections and nothing is written.
///
/// With --stereo and the files of both cameras, of known poses, the disks or markers are found in two
/// photographs of one moment and triangulated: prints and writes x, y, z in m with their standard
/// deviations, and the distance in pixels from the epipolar constraint. With --robot or --count they
/// are matched by number, else by their order and the epipolar constraint; what violates it is named
/// and left out.
#[derive(Debug, Args)]
pub struct MeasureArgs {
    /// Photograph, PNG or JPEG
    pub(super) photo: PathBuf,
    /// Photograph that a second camera took at the same time, PNG or JPEG
    #[arg(long, value_name = "PHOTO", requires_all = ["camera", "stereo_camera"], conflicts_with = "name")]
    pub(crate) stereo: Option<PathBuf>,
    /// File of the second camera
    #[arg(long, value_name = "FILE", requires = "stereo")]
    pub(super) stereo_camera: Option<PathBuf>,
    /// Side or pixel of the base in the second photograph; by default where the second camera sees it,
    /// or the side that --base gives
    #[arg(long, value_name = "WHERE", requires = "stereo", value_parser = parse_base, allow_hyphen_values = true)]
    pub(super) stereo_base: Option<Base>,
    /// Numbers of disks that are hidden in the second photograph
    #[arg(long, value_name = "K,…", requires = "stereo", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) stereo_hidden: Vec<u32>,
    /// Mask image for the second photograph
    #[arg(long, value_name = "FILE", requires = "stereo")]
    pub(super) stereo_mask: Option<PathBuf>,
    /// Copy of the second photograph to write, with the detections drawn into it
    #[arg(long, value_name = "OUT.png", requires = "stereo", value_parser = path_ending_in(&["png"]))]
    pub(super) stereo_annotated: Option<PathBuf>,
    /// Largest distance from the epipolar constraint in pixels; default 3
    #[arg(long, value_name = "PIXELS", requires = "stereo", value_parser = parse_pixels)]
    pub(super) epipolar: Option<f64>,
    /// Standard deviation of a column or row in pixels, for the covariance; default 0.3
    #[arg(long, value_name = "PIXELS", requires = "stereo", value_parser = parse_pixels)]
    pub(super) pixel_deviation: Option<f64>,
    /// Robot file, which gives the number of disks and their spacing
    #[arg(long, value_name = "FILE", conflicts_with = "count")]
    pub(super) robot: Option<PathBuf>,
    /// Number of disks or markers; without this or --robot, all that form an evenly spaced row
    #[arg(long, value_name = "N")]
    pub(super) count: Option<usize>,
    /// Numbers of disks that are hidden in the photograph, as 1,5; the others keep their numbers
    #[arg(long, value_name = "K,…", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) hidden: Vec<u32>,
    /// Kind of marker: disks seen from the side, coloured dots, or small circles
    #[arg(long, value_name = "KIND", default_value = "disks", value_parser = kind_parser())]
    pub(super) kind: Kind,
    /// Colour of the disks or dots, as "#d02020"; by default disks and circles are found by
    /// contrast, and dots by the most saturated colour
    #[arg(long, value_name = "COLOUR", value_parser = parse_colour)]
    colour: Option<[u8; 3]>,
    /// Radius of a disk or marker in pixels, within a third; by default the most frequent radius
    #[arg(long, value_name = "PIXELS", value_parser = parse_radius)]
    radius: Option<f64>,
    /// Mask image of the same size, white in the region to search
    #[arg(long, value_name = "FILE")]
    pub(super) mask: Option<PathBuf>,
    /// Side of the photograph at which the base is: left, right, top, bottom, or a pixel near the
    /// base, as 512,980
    #[arg(long, value_name = "WHERE", value_parser = parse_base, allow_hyphen_values = true)]
    pub(super) base: Option<Base>,
    /// Camera file, from which the position of the base is computed if --robot is given and --base
    /// is not
    #[arg(long, value_name = "FILE")]
    pub(super) camera: Option<PathBuf>,
    /// Name of the camera in the CSV file; by default that of its file
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Step of actuation that the photograph shows, from 1, for the CSV file
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) step: Option<u32>,
    /// Write a CSV file
    #[arg(short, long, value_name = "OUT.csv")]
    pub(super) output: Option<PathBuf>,
    /// Copy of the photograph to write, with the detections drawn into it
    #[arg(long, value_name = "OUT.png", value_parser = path_ending_in(&["png"]))]
    pub(super) annotated: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

/// What is less sure is pointed at.
const UNSURE: f64 = 0.6;

fn kind_parser() -> impl clap::builder::TypedValueParser<Value = Kind> {
    use clap::builder::{PossibleValuesParser, TypedValueParser as _};
    PossibleValuesParser::new(Kind::ALL.map(Kind::name)).try_map(|name| name.parse::<Kind>())
}

fn parse_colour(text: &str) -> Result<[u8; 3], String> {
    let wrong = || String::from("write a colour as \"#d02020\"");
    let digits = text.strip_prefix('#').unwrap_or(text);
    if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return Err(wrong());
    }
    let channel = |i: usize| u8::from_str_radix(&digits[i..i + 2], 16).map_err(|_| wrong());
    Ok([channel(0)?, channel(2)?, channel(4)?])
}

fn parse_radius(text: &str) -> Result<f64, String> {
    let radius = text.parse::<f64>().ok().filter(|r| (1.0..=10_000.0).contains(r));
    radius.ok_or_else(|| String::from("give a number of pixels from 1 to 10000"))
}

fn parse_pixels(text: &str) -> Result<f64, String> {
    let pixels = text.parse::<f64>().ok().filter(|pixels| (1e-3..=1e3).contains(pixels));
    pixels.ok_or_else(|| String::from("give a number of pixels from 0.001 to 1000"))
}

fn parse_base(text: &str) -> Result<Base, String> {
    let pixel = || {
        let (u, v) = text.split_once(',')?;
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.abs() < 1e6);
        Some(Base::Near([number(u)?, number(v)?]))
    };
    match text {
        "left" => Ok(Base::Left),
        "right" => Ok(Base::Right),
        "top" => Ok(Base::Top),
        "bottom" => Ok(Base::Bottom),
        _ => pixel()
            .ok_or_else(|| String::from("give left, right, top, bottom, or a pixel as 512,980")),
    }
}

/// Finds, writes the files, and returns what standard output shows.
pub fn run(args: &MeasureArgs, style: Style) -> Result<String, Failure> {
    for out in [&args.output, &args.annotated].into_iter().flatten() {
        let others = [&args.mask, &args.robot, &args.camera].into_iter().flatten();
        files::keep(out, others.chain([&args.photo]).map(PathBuf::as_path))?;
    }
    if args.output.is_some() && args.output == args.annotated {
        return Err(Failure::Input(String::from(
            "error: the CSV file and the picture have one name: give each its own",
        )));
    }
    let camera = args.camera.as_deref().map(load_camera).transpose();
    let camera = camera.map_err(|error| Failure::Input(message(&error)))?;
    let view = View {
        photo: &args.photo,
        camera: args.camera.as_deref().zip(camera.as_ref()),
        hidden: &args.hidden,
        mask: args.mask.as_deref(),
        base: args.base,
        is_base_seen: true,
    };
    let robot =
        args.robot.as_deref().map(|path| read_one(path, &Settings::default())).transpose()?;
    let (photograph, marks) = view.find(args, robot.as_ref())?;
    let photo = &photograph.photo;

    let camera_name = args.name.clone().or_else(|| {
        let stem = args.camera.as_deref()?.file_stem()?;
        Some(stem.to_string_lossy().into_owned())
    });
    let text = if args.json {
        format!("{:#}\n", object(args, photo, camera_name.as_deref(), &marks))
    } else {
        summary(args, photo, &marks, style)
    };
    // What can fail but for the disk has been done before anything is written.
    let found = marks.iter().map(|(number, mark)| (*number, mark.pixel, mark.confidence));
    let step = args.step.map(|step| step as usize);
    let csv = marks_csv(step, camera_name.as_deref(), found).to_csv();
    let csv = csv.map_err(|error| no_result(&error))?;
    if let Some(path) = &args.annotated {
        let picture = annotated(photo, args.kind, &marks).to_png();
        let picture = picture.map_err(|error| {
            Failure::Input(format!("error: cannot draw {}: {error}", path.display()))
        })?;
        write(path, &picture)?;
    }
    if let Some(path) = &args.output {
        write(path, csv.as_bytes())?;
    }
    Ok(text)
}

/// A photograph, and what is known of what it shows.
pub(super) struct View<'a> {
    pub(super) photo: &'a Path,
    /// The camera and its file.
    pub(super) camera: Option<(&'a Path, &'a Camera)>,
    /// Numbers of the disks that it does not show.
    pub(super) hidden: &'a [u32],
    pub(super) mask: Option<&'a Path>,
    pub(super) base: Option<Base>,
    /// Whether the pose of the camera is in the frame of the robot.
    pub(super) is_base_seen: bool,
}

impl View<'_> {
    /// The photograph, and what is found in it from base to tip.
    pub(super) fn find(
        &self,
        args: &MeasureArgs,
        robot: Option<&CaseFile>,
    ) -> Result<(Photograph, Vec<(usize, Mark)>), Failure> {
        let photograph = Photograph::read(self.photo)?;
        if let Some((path, camera)) = self.camera {
            photograph.check_camera(&path.display(), camera)?;
        }
        // The mask's own photograph takes as much memory as the other, and is not kept.
        let mask_of = |path: &Path| Photograph::read(path).map(|mask| Mask::light_of(&mask.photo));
        let mask = self.mask.map(mask_of).transpose()?;
        let seen_base = match (self.camera, robot) {
            (Some((_, camera)), Some(file)) if self.is_base_seen => {
                camera.project(file.case.base.position).ok()
            }
            _ => None,
        };
        // A body without disks may bear any number of markers.
        let disks = robot.map(|file| file.robot.disks()).filter(|disks| disks.are_present);
        let hidden: Vec<usize> = self.hidden.iter().map(|&number| number as usize).collect();
        let row = Row {
            count: disks.map(Disks::count).or(args.count),
            places: disks.map(|disks| disks.arc_lengths.as_slice()),
            hidden: &hidden,
            base: self.base.or(seen_base.map(Base::Near)),
        };
        let search = Search {
            kind: args.kind,
            colour: args.colour.map(colour),
            radius: args.radius,
            mask: mask.as_ref(),
        };
        let marks = find_row(&photograph.photo, &search, &row);
        let marks = marks.map_err(|error| refusal(self.photo, &error))?;
        if let Some(seen) = seen_base {
            self.refuse_other_end(seen, &marks)?;
        }
        Ok((photograph, marks))
    }

    /// Refuses a base that is at one end by --base and clearly at the other as the camera sees it.
    fn refuse_other_end(&self, seen: [f64; 2], marks: &[(usize, Mark)]) -> Result<(), Failure> {
        let [Some((_, first)), Some((_, last))] = [marks.first(), marks.last()] else {
            return Ok(());
        };
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let away = |mark: &Mark| distance(mark.pixel, seen);
        // Of a robot that is rolled up both ends are near.
        let far = 0.5 * distance(first.pixel, last.pixel);
        if self.base.is_none() || away(first) < far || away(first) < 2.0 * away(last) {
            return Ok(());
        }
        let place = |[u, v]: [f64; 2]| format!("({u:.0}, {v:.0})");
        Err(Failure::Solve(format!(
            "error: {}: the order is mirrored: by --base the base is at {}, but the camera sees it at {}, nearer to the other \
             end\nhelp: leave out --base, or give the right --camera",
            self.photo.display(),
            place(first.pixel),
            place(seen)
        )))
    }
}

/// What was found is no answer: how to ask for another.
fn refusal(photo: &Path, error: &DetectError) -> Failure {
    let text = format!("error: {}: {error}", photo.display());
    let help = match error {
        DetectError::MaskSize { .. } | DetectError::EmptyMask | DetectError::TooSmall { .. } => {
            return Failure::Input(text);
        }
        DetectError::HiddenOfHowMany => {
            let needs = "--hidden needs --robot or --count: how many disks there are in all";
            return Failure::Input(format!("error: {needs}"));
        }
        DetectError::NoSuchHidden { .. } => {
            return Failure::Input(format!("error: --hidden {error}"));
        }
        DetectError::AmbiguousBase { .. } => "--base left, right, top, bottom, or a pixel near it",
        DetectError::Mirrored { .. } => "--base at the other end, or the right --robot",
        DetectError::TooMany { .. } | DetectError::NoRow { .. } => {
            "--mask with a picture that is white around the robot, --colour, or --radius in pixels"
        }
        DetectError::Gap { .. } => "--count or --robot, and --mask where something else is found",
        DetectError::NoEvenBackground { .. } => "--mask, or --colour",
        DetectError::TooFew { .. } | DetectError::NoneFound { .. } => {
            "--hidden with the numbers of what cannot be seen, --kind, --colour, --radius in pixels, or the right --count"
        }
        DetectError::NothingStandsOut
        | DetectError::ColourLikeBackground
        | DetectError::NoVividColour => "--colour or --kind",
    };
    Failure::Solve(format!("{text}\nhelp: {help}"))
}

fn object(
    args: &MeasureArgs,
    photo: &Photo,
    camera: Option<&str>,
    marks: &[(usize, Mark)],
) -> Value {
    let marks: Vec<Value> = marks
        .iter()
        .map(|(number, mark)| {
            json!({
                "disk": number,
                "u": mark.pixel[0],
                "v": mark.pixel[1],
                "radius": mark.radius,
                "confidence": mark.confidence,
            })
        })
        .collect();
    json!({
        "photo": args.photo.display().to_string(),
        "width": photo.width(),
        "height": photo.height(),
        "kind": args.kind.name(),
        "camera": camera,
        "step": args.step,
        "marks": marks,
    })
}

fn summary(args: &MeasureArgs, photo: &Photo, marks: &[(usize, Mark)], style: Style) -> String {
    let name = args.photo.display();
    let mut text = format!("{}\n", style.heading(&name));
    let (count, kind) = (marks.len(), args.kind.name());
    text += &format!(
        "{count} {kind} in {}×{} pixels, from base to tip\n\n",
        photo.width(),
        photo.height()
    );
    let columns = ["disk", "column", "row", "radius", "confidence"];
    let mut table = Table::new(columns.map(|name| (name, Align::Right)));
    for (number, mark) in marks {
        table.row(vec![
            number.to_string(),
            fixed(mark.pixel[0], 2),
            fixed(mark.pixel[1], 2),
            fixed(mark.radius, 1),
            fixed(mark.confidence, 2),
        ]);
    }
    text += &table.text(style);
    let unsure: Vec<String> = marks
        .iter()
        .filter(|(_, mark)| mark.confidence < UNSURE)
        .map(|(number, _)| number.to_string())
        .collect();
    if !unsure.is_empty() {
        text +=
            &format!("\nnote: look at {}: they do not look quite like {kind}\n", unsure.join(", "));
    }
    for (what, path) in [("measured", &args.output), ("picture", &args.annotated)] {
        if let Some(path) = path {
            text += &format!("\n{what}: {}\n", path.display());
        }
    }
    text
}
