//! `whipcord workspace`: where the tip can go.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use whipcord::{Actuation, Model, ModelKind, ModelPreset, Stations, Vec3};
use whipcord_inverse::{Cell, Workspace, WorkspaceOptions};
use whipcord_io::{CaseFile, boundary_table, warnings_json, workspace_json, workspace_table};
use whipcord_plot::{WorkspaceFigure, workspace_figure, workspace_glb};
use whipcord_viewer::export_workspace;

use crate::deadline;
use crate::inputs::read_one;
use crate::inverse::{RobotArguments, failure, solver};
use crate::progress;
use crate::target_argument::{Place, length};
use whipcord_study::failure::Failure;
use whipcord_study::files::{self, Folder};
use whipcord_study::quantity::{fixed_millimetres, millimetres, number};
use whipcord_study::style::Style;

/// Where the tip can go: volume or area, boundary, and maps of dexterity, accuracy and stiffness
///
/// Shapes all over the commands mark the voxels that the tip gets into, and the survey grows from them until
/// no neighbour is in reach. Limits are those of [limits], [[cables]] and [[motors]]. The folder gets
/// workspace.json, voxels.csv and voxels.parquet (for each voxel a place of the tip, its commands and the dexterity, with --map stiffness the stiffness too),
/// boundary.csv (points of the boundary with what holds the tip back), pictures of all voxels and of sections, and workspace.glb, the
/// voxels as a body in glTF.
#[derive(Debug, Args)]
pub struct WorkspaceArgs {
    #[command(flatten)]
    robot: RobotArguments,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Edge of a voxel, such as "4 mm"; by default a twenty-fifth of the length of the backbone
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    voxel: Option<f64>,
    /// What the pictures show
    #[arg(long, value_name = "WHAT", default_value = "reach")]
    map: Map,
    /// Point that the sections go through, such as "40, 0, 100 mm"; by default the middle of the tips
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    section: Option<Place>,
    /// Also write workspace.html, a page with the robot, its sliders and the workspace, which opens without a server
    #[arg(long)]
    page: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Map {
    /// Where the tip gets
    Reach,
    /// The least motion of the tip for commands that would bend the robot by half a turn
    Dexterity,
    /// By how much the tip is off at most if the commands are off by 1 % of those that bend the robot by half a turn
    Accuracy,
    /// The least stiffness of the tip against a force, with the commands held
    Stiffness,
}

/// Width of the pictures in px.
const WIDTH: f64 = 900.0;

/// Surveys, writes the folder and returns what standard output shows.
pub fn run(args: &WorkspaceArgs, style: Style) -> Result<String, Failure> {
    let file = read_one(&args.robot.file, &args.robot.settings)?;
    let warnings = file.warnings();
    args.robot.warnings.tell(&file, &warnings)?;
    let model = Model::new(args.robot.kind, Stations::Disks, Actuation::Natural);
    let model = args.robot.four_bar.applied_to(model.cancelled_by(&deadline::cancel()))?;
    let mut solver = solver(args.robot.by, &file, &model)?;
    let options = WorkspaceOptions {
        voxel: args.voxel,
        clearance: file.goal.least_clearance(),
        has_stiffness: args.map == Map::Stiffness,
        ..WorkspaceOptions::default()
    };
    let workspace = solver.workspace(&options).map_err(|error| failure(&file, &error))?;
    let no_result = |error| files::no_result(&error);
    let name = args.robot.kind.name();
    let json = workspace_json(&file.title, &file.robot, name, &solver, &workspace);
    let mut json = json.map_err(no_result)?;
    json["warnings"] = warnings_json(&file, &warnings);
    let voxels = workspace_table(&file.robot, &solver, &workspace);
    let boundary = boundary_table(&file.robot, &solver, &workspace);
    let parquet = voxels.to_parquet().map_err(no_result)?;
    let drawn = |error| Failure::Solve(format!("error: the workspace cannot be drawn: {error}"));
    let section = section(args, &file, &workspace)?;
    let through = match args.section {
        None => "the middle".to_owned(),
        Some(Place(point)) => {
            format!("({}) mm", point.to_array().map(|x| fixed_millimetres(x, 1)).join(", "))
        }
    };
    let figures = [
        ("workspace", "from the front, the side and above".to_owned(), None),
        ("sections", format!("sections through {through}"), Some(section)),
    ]
    .map(|(name, what, section)| Ok((name, figure(args.map, &file, &workspace, &what, section)?)));
    let figures: Vec<(&str, WorkspaceFigure)> =
        figures.into_iter().collect::<Result<_, Failure>>()?;
    let mut pictures = Vec::with_capacity(figures.len());
    for (name, figure) in &figures {
        pictures.push((*name, workspace_figure(figure).map_err(drawn)?));
    }
    let model = workspace_glb(&figures[0].1).map_err(drawn)?;
    let page = args.page.then(|| page(args.robot.kind, &file, &workspace)).transpose()?;

    let folder = Folder::create(&args.out)?;
    folder.write("workspace.json", &format!("{json:#}\n"))?;
    folder.write_table("voxels.csv", &voxels)?;
    files::write(&folder.path().join("voxels.parquet"), &parquet)?;
    folder.write_table("boundary.csv", &boundary)?;
    for (name, svg) in &pictures {
        folder.write_figure(name, svg)?;
    }
    files::write(&folder.path().join("workspace.glb"), &model)?;
    if let Some(page) = page {
        folder.write("workspace.html", &page)?;
    }
    Ok(match args.json {
        true => format!("{json:#}\n"),
        false => summary(args, &file, &workspace, style),
    })
}

/// The point that sections go through: what was asked for, which must be among the tips in one direction at least, or the middle of the tips.
fn section(args: &WorkspaceArgs, file: &CaseFile, workspace: &Workspace) -> Result<Vec3, Failure> {
    let [least, greatest] = workspace.extent;
    let Some(Place(point)) = args.section else { return Ok((least + greatest) * 0.5) };
    let [from, to] = [least, greatest].map(Vec3::to_array);
    let is_among = |(axis, x): (usize, f64)| {
        (from[axis] - workspace.voxel..=to[axis] + workspace.voxel).contains(&x)
    };
    if point.to_array().into_iter().enumerate().any(is_among) {
        return Ok(point);
    }
    let ranges = ["x", "y", "z"].iter().zip(from.iter().zip(&to)).map(|(axis, (a, b))| {
        format!("{axis} {} to {} mm", fixed_millimetres(*a, 1), fixed_millimetres(*b, 1))
    });
    Err(Failure::Input(format!(
        "error: {}: --section: no plane through this point meets the tips, which have {}",
        file.path.display(),
        ranges.collect::<Vec<_>>().join(", ")
    )))
}

/// A page with the robot and its workspace.
fn page(kind: ModelKind, file: &CaseFile, workspace: &Workspace) -> Result<String, Failure> {
    let bar = progress::bar(0);
    let page = export_workspace(file, ModelPreset::usual(kind), workspace, |progress| {
        bar.set_length(progress.all as u64);
        bar.set_position(progress.done as u64);
        bar.set_message("frames of the page");
    });
    bar.finish_and_clear();
    page.map_err(|error| Failure::Input(format!("error: {error}")))
}

fn figure(
    map: Map,
    file: &CaseFile,
    workspace: &Workspace,
    what: &str,
    section: Option<Vec3>,
) -> Result<WorkspaceFigure, Failure> {
    let value = |cell: &Cell| match map {
        Map::Reach => Some(0.0),
        Map::Dexterity => Some(1e3 * cell.dexterity.least_motion()),
        Map::Accuracy => Some(10.0 * cell.dexterity.singular[0].0),
        Map::Stiffness => cell.stiffness.map(|[least, _]| least),
    };
    let centre = |cell: &Cell| {
        let [x, y, z] = cell.index.map(|i| (f64::from(i) + 0.5) * workspace.voxel);
        Vec3::new(x, y, z)
    };
    let cells: Vec<(Vec3, f64)> =
        workspace.cells.iter().filter_map(|cell| Some((centre(cell), value(cell)?))).collect();
    if cells.is_empty() {
        return Err(Failure::Input(format!(
            "error: {}: this model does not know the stiffness of the tip: ask for --map reach or dexterity, or for the model cosserat",
            file.path.display()
        )));
    }
    let rest = whipcord::at_rest(&file.robot, file.case.base, &Stations::Disks);
    let backbone = rest
        .map_or_else(Vec::new, |rest| rest.disks.poses.iter().map(|pose| pose.position).collect());
    Ok(WorkspaceFigure {
        title: format!("{}: where the tip can go, {what}", file.title),
        quantity: match map {
            Map::Reach => None,
            Map::Dexterity => Some("least motion of the tip (mm)".to_owned()),
            Map::Accuracy => Some("error of the tip for 1 % of the commands (mm)".to_owned()),
            Map::Stiffness => Some("least stiffness (N/m)".to_owned()),
        },
        voxel: workspace.voxel,
        cells,
        // The boundary of a surface is all of it, and in front of a body it hides the colours.
        boundary: match section {
            Some(_) if workspace.dimension == 3 => {
                workspace.boundary.iter().map(|point| point.tip).collect()
            }
            _ => Vec::new(),
        },
        backbone,
        section,
        width: WIDTH,
    })
}

fn summary(args: &WorkspaceArgs, file: &CaseFile, workspace: &Workspace, style: Style) -> String {
    let mut text = format!("{}\n{}\n\n", style.heading(&file.title), args.robot.kind);
    let mut line = |name: &str, value: String| {
        text += &format!("{}  {value}\n", style.faint(format!("{name:<10}")));
    };
    let measure = workspace.measure;
    match workspace.dimension {
        3 => line("volume", format!("{} cm³", number(1e6 * measure, 3))),
        2 => line(
            "area",
            format!("{} cm², a surface no thicker than a voxel", number(1e4 * measure, 3)),
        ),
        _ => line("length", format!("{}, a curve no thicker than a voxel", millimetres(measure))),
    }
    let [least, greatest] = workspace.extent.map(Vec3::to_array);
    for (axis, (a, b)) in ["x", "y", "z"].iter().zip(least.iter().zip(&greatest)) {
        line(axis, format!("{} to {} mm", fixed_millimetres(*a, 1), fixed_millimetres(*b, 1)));
    }
    let voxels = workspace.cells.len();
    line("voxels", format!("{voxels} of {}", millimetres(workspace.voxel)));
    line("boundary", format!("{} points", workspace.boundary.len()));
    if !workspace.is_complete {
        text +=
            "the survey has spent its solves: the workspace may be larger; take larger voxels\n";
    }
    text += &format!("results: {}\n", args.out.display());
    text
}
