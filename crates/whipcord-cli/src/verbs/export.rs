//! `whipcord export`: files for other programs.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use whipcord_export::{ExportError, Exported, Format, Job};
use whipcord_io::CaseFile;

use crate::inputs::{Settings, read_one};
use crate::model_arguments::ModelArguments;
use crate::warnings::Warnings;
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::style::Style;

/// Write a robot and its shape for MuJoCo, ROS, ParaView, Blender or CAD
///
/// mjcf: a chain of bodies with springs, spatial tendons, actuators, contacts, and keyframes with the solved shape and the tensions.
/// urdf: a serial chain, and the joint angles of the shape as JSON. vtk: backbone, cables, disks and contacts of each step with
/// their fields, for ParaView. gltf: meshes with names and colours. step-points: curves and points for CAD, in mm. All but
/// the last are in m. The summary says what a format cannot hold. Cables are guided where the model has them: at the disks by
/// cosserat-disks, all along the backbone by cosserat.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// Robot file, or - for standard input
    file: PathBuf,
    /// Format
    #[arg(long, value_name = "FORMAT", value_parser = format_parser())]
    to: Format,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    model: ModelArguments,
    /// File to write; by default it has the name of the robot file and lies in the working directory. Files that belong to it are
    /// written beside it
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Bodies (mjcf, urdf; by default 4) or pieces of curves (vtk, gltf, step-points; by default 8) between two disks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    per_span: Option<u16>,
    #[command(flatten)]
    warnings: Warnings,
}

fn format_parser() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::ALL.map(Format::name))
        .try_map(|name| Format::named(&name).ok_or("there is no such format"))
}

/// Solves, writes the files and returns what standard output shows.
pub fn run(args: &ExportArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.file, &args.settings)?;
    let model = args.model.model()?;
    args.warnings.tell(&file, &file.warnings())?;
    let (folder, stem) = target(args, &file)?;
    let job = Job {
        title: &file.title,
        robot: &file.robot,
        case: &file.case,
        model: &model,
        damping: &file.motion.damping,
        per_span: args.per_span.map(usize::from),
    };
    let exported = whipcord_export::export(&job, args.to, &stem).map_err(|error| match error {
        ExportError::Solve { step, error } => Failure::from_step(&file, &error, step),
        other => Failure::Input(format!("error: {}: {other}", file.path.display())),
    })?;
    let written = write(&folder, &exported, &file)?;
    let mut text = format!("{}\n", style.heading(&file.title));
    for path in written {
        text += &format!("{}  {}\n", style.faint("written"), path.display());
    }
    for lost in &exported.lost {
        text += &format!("{}  {lost}\n", style.faint("lost   "));
    }
    Ok(text)
}

/// The folder, and what names of files begin with.
fn target(args: &ExportArgs, file: &CaseFile) -> Result<(PathBuf, String), Failure> {
    let extension = args.to.extension();
    let Some(out) = &args.out else {
        let name = files::unique_names([file.path.as_path()].into_iter()).remove(0);
        return Ok((PathBuf::from("."), name));
    };
    let usage = |what: String| Failure::Input(format!("error: {}: {what}", out.display()));
    if !out.extension().is_some_and(|given| given.eq_ignore_ascii_case(extension)) {
        let format = args.to.name();
        return Err(usage(format!("the name of a file for {format} must end in .{extension}")));
    }
    let stem = out.file_stem().and_then(|stem| stem.to_str());
    let stem = stem.ok_or_else(|| usage("give a name in UTF-8".to_owned()))?;
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    Ok((folder.unwrap_or(Path::new(".")).to_owned(), stem.to_owned()))
}

/// Writes the files, the one that names the others last.
fn write(folder: &Path, exported: &Exported, file: &CaseFile) -> Result<Vec<PathBuf>, Failure> {
    let paths: Vec<PathBuf> = exported
        .files
        .iter()
        .map(|written| match folder == Path::new(".") {
            true => PathBuf::from(&written.name),
            false => folder.join(&written.name),
        })
        .collect();
    for path in &paths {
        files::keep(path, file.files())?;
    }
    for (path, written) in paths.iter().zip(&exported.files).rev() {
        if let Some(parent) = path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
            Folder::create(parent)?;
        }
        files::write(path, &written.bytes)?;
    }
    Ok(paths)
}
