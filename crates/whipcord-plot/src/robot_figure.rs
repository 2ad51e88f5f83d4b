//! A robot in space and in three orthogonal views.

use core::fmt::Display;

use whipcord::{
    Contact, ModelKind, Obstacle, Pose, Robot, Shape, Solution, Stations, Vec3, at_rest,
};

use crate::acting::Acting;
use crate::body::{Body, Part};
use crate::colour::Colour;
use crate::contact_marks::TouchMarks;
use crate::ellipsoid::{Ellipsoid, Ellipsoids};
use crate::error::{PlotError, finite, not_empty};
use crate::legend::{Entry, Legend, Swatch};
use crate::load_marks::LoadMarks;
use crate::marker::{self, Marker};
use crate::obstacles::Obstacles;
use crate::orthogonal;
use crate::projection::Projection;
use crate::scene::{self, Form, Look};
use crate::space;
use crate::svg::{Fill, Point, Stroke, Svg};
use crate::title::{LINE, Title};

/// One shape of the robot: that of a model, or that before actuation.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotView {
    /// Entry in the legend.
    pub label: String,
    /// Frames along the backbone, close enough that the curve between them is clear: about 100.
    pub shape: Shape,
    /// Frames at the disks, one for each disk of the robot.
    pub disks: Shape,
    /// How its cables run between the disks.
    pub cables: CableCourse,
    /// How it is drawn.
    pub style: ViewStyle,
}

/// How the cables of a model run between the disks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CableCourse {
    /// On the smooth course of their routing.
    #[default]
    Smooth,
    /// Straight from hole to hole.
    HoleToHole,
}

/// How a shape is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewStyle {
    /// In the colour of this model. Of several shapes by one model the last has the full colour.
    Model(ModelKind),
    /// Pale and grey, behind the others: the robot before actuation.
    Before,
}

/// What a figure shows besides the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureOptions {
    /// Above the figure; may be empty.
    pub title: String,
    /// Where the disks of the real robot were found, in m in the world.
    pub measured: Vec<Vec3>,
    /// The same where something is wrong with the measurement; drawn apart.
    pub outliers: Vec<Vec3>,
    /// Where places of the robot are to be, in m in the world.
    pub targets: Vec<Vec3>,
    /// Points in m in the world that there is room for, as those of other pictures of a film.
    pub room: Vec<Vec3>,
    /// What acts on one of the shapes, by [`Acting::on`]; drawn over all of them.
    pub loads: Acting,
    /// How places of it yield and move; drawn over the robot.
    pub ellipsoids: Vec<Ellipsoid>,
    /// What stands in its way.
    pub obstacles: Vec<Obstacle>,
    /// Movable objects where they were before; drawn faintly.
    pub initial: Vec<Obstacle>,
    /// Where one of the shapes touches it; drawn over all of them.
    pub contacts: Vec<Contact>,
    /// Direction from which the robot is seen in space, in rad from x towards y; `None` for one
    /// that shows the bending well.
    pub azimuth: Option<f64>,
    /// Height of that direction above the x–y plane in rad.
    pub elevation: f64,
    /// Width of the figure in px.
    pub width: f64,
}

impl FigureOptions {
    /// The same with these obstacles as an answer has them: movable objects in equilibrium, and faintly where they were before.
    #[must_use]
    pub fn among(self, obstacles: &[Obstacle], solution: Option<&Solution>) -> Self {
        let Some(solution) = solution else {
            return Self { obstacles: obstacles.to_vec(), ..self };
        };
        let before = solution.objects.iter().filter_map(|state| obstacles.get(state.obstacle));
        Self {
            initial: before.cloned().collect(),
            obstacles: solution.placed(obstacles),
            contacts: solution.contacts.clone(),
            ..self
        }
    }
}

impl Default for FigureOptions {
    fn default() -> Self {
        Self {
            title: String::new(),
            measured: Vec::new(),
            outliers: Vec::new(),
            targets: Vec::new(),
            room: Vec::new(),
            loads: Acting::default(),
            ellipsoids: Vec::new(),
            obstacles: Vec::new(),
            initial: Vec::new(),
            contacts: Vec::new(),
            azimuth: None,
            elevation: 22_f64.to_radians(),
            width: 980.0,
        }
    }
}

/// Stations of shapes that are smooth in pictures.
pub const FINE_STATIONS: usize = 181;

impl CableCourse {
    /// Where a model takes the cables to run.
    #[must_use]
    pub const fn of(model: ModelKind) -> Self {
        match model {
            ModelKind::Cosserat | ModelKind::ConstantCurvature => Self::Smooth,
            ModelKind::CosseratDisks
            | ModelKind::FourBar
            | ModelKind::PiecewiseConstantCurvature
            | ModelKind::PseudoRigidBody => Self::HoleToHole,
        }
    }
}

/// What pictures call an answer that has this name.
pub fn label(name: impl Display, solution: &Solution) -> String {
    let unstable = if solution.diagnostics.is_unstable() { ", unstable" } else { "" };
    format!("{name}{unstable}")
}

impl RobotView {
    /// The answer of a model.
    #[must_use]
    pub fn model(label: impl Into<String>, solution: &Solution) -> Self {
        Self {
            label: label.into(),
            shape: solution.shape.clone(),
            disks: solution.disks.clone(),
            cables: CableCourse::of(solution.model),
            style: ViewStyle::Model(solution.model),
        }
    }

    /// The robot before its cables are pulled, on a base of this pose.
    #[must_use]
    pub fn at_rest(robot: &Robot, base: Pose) -> Self {
        let stations = Stations::Equal(FINE_STATIONS);
        let label = "before actuation";
        match at_rest(robot, base, &stations) {
            Some(solution) => Self::model(label, &solution).before(),
            // A robot without section or material is known to a geometric model only, for which the
            // backbone is straight.
            None => Self {
                label: label.to_owned(),
                shape: Shape::straight(&stations.arc_lengths(robot)).moved(base),
                disks: Shape::straight(&robot.disks().arc_lengths).moved(base),
                cables: CableCourse::Smooth,
                style: ViewStyle::Before,
            },
        }
    }

    /// The same shape as that before actuation.
    #[must_use]
    pub fn before(self) -> Self {
        Self { style: ViewStyle::Before, ..self }
    }
}

/// All shapes of a figure.
pub(crate) type Bodies = Vec<(Body, Look)>;

/// What a view shows: the robot, and over it what was measured and what acts.
pub(crate) struct Drawn<'a> {
    pub bodies: Bodies,
    pub measured: &'a [Vec3],
    outliers: &'a [Vec3],
    targets: &'a [Vec3],
    pub loads: LoadMarks,
    pub ellipsoids: Ellipsoids,
    obstacles: Obstacles,
    contacts: TouchMarks,
    /// Points that span all of it.
    pub points: Vec<Vec3>,
}

impl<'a> Drawn<'a> {
    fn new(bodies: Bodies, options: &'a FigureOptions, colours: &Colours) -> Self {
        let mut points: Vec<Vec3> = bodies
            .iter()
            .flat_map(|(body, _)| body.outline())
            .chain(options.measured.iter().chain(&options.outliers).copied())
            .chain(options.targets.iter().chain(&options.room).copied())
            .collect();
        let extent = |i: usize| {
            let [low, high] = range(&points, i);
            high - low
        };
        let extent = extent(0).max(extent(1)).max(extent(2));
        let loads = LoadMarks::new(&options.loads, extent);
        let ellipsoids = Ellipsoids::new(&options.ellipsoids, extent, colours.cables.len());
        points.extend(loads.outline().chain(ellipsoids.outline()));
        let contacts = TouchMarks::new(&options.contacts, extent);
        points.extend(contacts.outline());
        let obstacles = Obstacles::new(&options.obstacles, &options.initial, &points);
        points.extend(obstacles.outline());
        let (measured, outliers) = (options.measured.as_slice(), options.outliers.as_slice());
        let targets = options.targets.as_slice();
        Self { bodies, measured, outliers, targets, loads, ellipsoids, obstacles, contacts, points }
    }

    /// All in a view of this name, which fills a box; measured positions of this radius in px.
    pub fn draw(
        &self,
        svg: &mut Svg,
        view: &Projection,
        (name, at, size): (&str, Point, Point),
        radius: f64,
    ) {
        self.obstacles.draw(svg, view, (&format!("behind-{name}"), at, size), false);
        scene::draw(svg, &self.bodies, view);
        self.obstacles.draw(svg, view, (&format!("before-{name}"), at, size), true);
        self.ellipsoids.draw(svg, view);
        self.loads.draw(svg, view);
        self.contacts.draw(svg, view);
        for (points, colour) in [(self.measured, MEASURED), (self.outliers, OUTLIER)] {
            for &p in points {
                let (at, rim) = (view.place(p), Some(Stroke::new(colour, 1.1)));
                marker::draw(svg, Marker::Diamond, at, radius, Fill::new(Colour::WHITE), rim);
            }
        }
        for at in self.outliers.iter().map(|&p| view.place(p)) {
            strike(svg, at, 2.2 * radius);
        }
        for at in self.targets.iter().map(|&p| view.place(p)) {
            let rim = Some(Stroke::new(TARGET, 1.6));
            svg.circle(at, 1.6 * radius, None, rim);
            svg.circle(at, 0.5 * radius, Some(Fill::new(TARGET)), None);
        }
    }
}

/// Crosses out what lies here.
fn strike(svg: &mut Svg, [x, y]: Point, reach: f64) {
    let stroke = Stroke::new(OUTLIER, 1.3);
    svg.line([x - reach, y - reach], [x + reach, y + reach], stroke);
    svg.line([x - reach, y + reach], [x + reach, y - reach], stroke);
}

/// Least and largest coordinate along this axis.
pub(crate) fn range(points: &[Vec3], axis: usize) -> [f64; 2] {
    points
        .iter()
        .map(|p| p[axis])
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
}

const MARGIN: f64 = 14.0;
/// The views leave at least this to a legend that needs it, in px.
const LEGEND_WIDTH: f64 = 210.0;
/// Colour of the measured positions.
pub(crate) const MEASURED: Colour = Colour::INK;
/// Colour of targets.
const TARGET: Colour = Colour::new(0xd0, 0x1c, 0x8b);
/// Colour of those that are outliers.
const OUTLIER: Colour = Colour::new(0xb0, 0x00, 0x20);

/// The robot in space and in three orthogonal views of one scale: backbone (in its true diameter
/// where that is known), disks with their holes, and cables; each model in its colour, and what was
/// before actuation pale behind them. Of more than two shapes by several models the backbones are
/// lines, with the disks and cables of the first.
///
/// ```
/// use whipcord::{Backbone, Cable, Disks, Pose, Robot, Routing, Shape, Vec3};
/// use whipcord_plot::{CableCourse, FigureOptions, RobotView, ViewStyle, robot_figure};
///
/// let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
/// let cable = Cable::new("pull", Routing::holes(vec![4; 10]));
/// let robot = Robot::new(Backbone::new(0.18), disks, vec![cable])?;
/// let arc_length = robot.disks().arc_lengths.clone();
/// let at = |&s: &f64| Pose { position: Vec3::Z * s, ..Pose::IDENTITY };
/// let shape = Shape { poses: arc_length.iter().map(at).collect(), arc_length };
/// let view = RobotView {
///     label: "before actuation".into(),
///     disks: shape.clone(),
///     shape,
///     cables: CableCourse::Smooth,
///     style: ViewStyle::Before,
/// };
/// let svg = robot_figure(&robot, &[view], &FigureOptions::default())?;
/// assert!(svg.contains("x (mm)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, a number is not finite, or a view does not have as
/// many disks as the robot.
pub fn robot_figure(
    robot: &Robot,
    views: &[RobotView],
    options: &FigureOptions,
) -> Result<String, PlotError> {
    not_empty(|| "the list of views".to_owned(), views)?;
    check_options(options)?;
    let colours = Colours::new(robot, views);
    let drawn = Drawn::new(bodies(robot, views, &colours)?, options, &colours);

    let title = Title::new(&options.title, options.width - 2.0 * MARGIN);
    let top = MARGIN + title.height();
    let space_width = (0.46 * (options.width - 2.0 * MARGIN)).round();
    let entries = colours.legend(robot, views, options, &drawn);
    let left = MARGIN + space_width + 16.0;
    let plan = orthogonal::Plan::new(
        &drawn.points,
        [left, top + 4.0],
        [options.width - MARGIN - left, 640.0],
        Legend::width_of(&entries).min(LEGEND_WIDTH),
    );
    let legend = Legend::of_height(entries, plan.legend_width(), plan.legend_height());
    let bottom =
        plan.bottom().max(plan.legend_place()[1] + legend.height()).max(top + 0.82 * space_width);
    let mut svg = Svg::new(options.width, bottom + MARGIN);
    title.draw(&mut svg, [MARGIN, MARGIN]);
    let axonometric = view_in_space(options, &drawn);
    space::draw(&mut svg, &drawn, axonometric, ([MARGIN, top], [space_width, bottom - top]));
    plan.draw(&mut svg, &drawn);
    legend.draw(&mut svg, plan.legend_place());
    svg.finish(&options.title)
}

fn check_options(options: &FigureOptions) -> Result<(), PlotError> {
    for p in &options.targets {
        for value in p.to_array() {
            finite(|| "a target".to_owned(), value)?;
        }
    }
    for p in options.measured.iter().chain(&options.outliers) {
        for value in p.to_array() {
            finite(|| "a measured position".to_owned(), value)?;
        }
    }
    options.loads.check()?;
    options.ellipsoids.iter().try_for_each(Ellipsoid::check)?;
    for touch in &options.contacts {
        let numbers = touch.point.to_array().into_iter().chain(touch.normal.to_array());
        for value in numbers.chain(touch.force) {
            finite(|| "a number of a contact".to_owned(), value)?;
        }
    }
    finite(|| "the elevation".to_owned(), options.elevation)?;
    finite(|| "the azimuth".to_owned(), options.azimuth.unwrap_or(0.0))?;
    let width = options.width;
    if (400.0..=10_000.0).contains(&width) {
        Ok(())
    } else {
        Err(PlotError::Size { width, height: LINE, largest: 10_000 })
    }
}

/// Who has which colour, and how much is drawn of whom.
pub(crate) struct Colours {
    views: Vec<(Colour, Form)>,
    cables: Vec<Colour>,
}

/// With more shapes than this, of several models, backbones are lines.
const MOST_WHOLE: usize = 2;
/// Width in px of the line that is drawn last, and how much wider each one below it is: where several
/// run together, all are seen.
const LINE_WIDTH: f64 = 1.5;
const WIDER: f64 = 0.7;
/// Of the first, second … shape by the same model that is drawn as a line.
const DASHES: [&str; 4] = ["", "6 4", "2 4", "9 3 2 3"];
/// Of the first of several shapes by the same model: how much it has of the model's colour.
const FIRST_TINT: f64 = 0.4;

impl Colours {
    pub fn new(robot: &Robot, views: &[RobotView]) -> Self {
        let kinds: Vec<ModelKind> = views
            .iter()
            .filter_map(|view| match view.style {
                ViewStyle::Model(kind) => Some(kind),
                ViewStyle::Before => None,
            })
            .collect();
        let lines = kinds.len() > MOST_WHOLE && kinds.iter().any(|kind| *kind != kinds[0]);
        let mut seen = 0;
        let look = |view: &RobotView| {
            let ViewStyle::Model(kind) = view.style else { return (Colour::GREY, Form::Whole) };
            let index = seen;
            seen += 1;
            let colour = Colour::of_model(kind);
            let alike = |kinds: &[ModelKind]| kinds.iter().filter(|one| **one == kind).count();
            let (before, all) = (alike(&kinds[..index]), alike(&kinds));
            if !lines {
                let share = (before + 1) as f64 / all as f64;
                let first = 1.0 / all as f64;
                let tint = match all {
                    1 => 1.0,
                    _ => FIRST_TINT + (1.0 - FIRST_TINT) * (share - first) / (1.0 - first),
                };
                return (colour.tint(tint), Form::Whole);
            }
            let width = LINE_WIDTH + WIDER * (kinds.len() - 1 - index) as f64;
            let stroke = Stroke::new(colour, width).dash(DASHES[before % DASHES.len()]);
            let marker = Marker::of_model(kind);
            (colour, Form::Line { stroke, marker, dressed: index == 0 })
        };
        let views = views.iter().map(look).collect();
        Self { views, cables: (0..robot.cables().len()).map(Colour::nth).collect() }
    }

    fn legend(
        &self,
        robot: &Robot,
        views: &[RobotView],
        options: &FigureOptions,
        drawn: &Drawn<'_>,
    ) -> Vec<Entry> {
        let mut entries = self.legend_of(robot, views, !options.measured.is_empty());
        if !options.outliers.is_empty() {
            let rim = Some(Stroke::new(OUTLIER, 1.2));
            let marker = Swatch::Marker(Marker::Diamond, Fill::new(Colour::WHITE), rim);
            let label = "measured, outlier (crossed out)".to_owned();
            entries.push(Entry { label, swatches: vec![marker] });
        }
        if !options.targets.is_empty() {
            let marker = Swatch::Marker(
                Marker::Circle,
                Fill::new(Colour::WHITE),
                Some(Stroke::new(TARGET, 1.6)),
            );
            entries.push(Entry { label: "target".to_owned(), swatches: vec![marker] });
        }
        entries.extend(drawn.ellipsoids.legend(&options.ellipsoids));
        entries.extend(LoadMarks::legend(&options.loads));
        entries.extend(Obstacles::legend(&options.obstacles));
        entries.extend(TouchMarks::legend(&options.contacts));
        entries
    }

    /// The views, the cables, and what was measured if anything was.
    pub fn legend_of(&self, robot: &Robot, views: &[RobotView], measured: bool) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (view, &(colour, form)) in views.iter().zip(&self.views) {
            let swatches = match (view.style, form) {
                (ViewStyle::Before, _) => vec![Swatch::Line(Stroke::new(colour.tint(0.5), 4.0))],
                (_, Form::Whole) => vec![Swatch::Line(Stroke::new(colour, 4.0))],
                (_, Form::Line { stroke, marker, .. }) => {
                    let stroke = Stroke { width: stroke.width.min(4.0), ..stroke };
                    let rim = Some(Stroke::new(Colour::WHITE, 0.7));
                    vec![Swatch::Line(stroke), Swatch::Marker(marker, Fill::new(colour), rim)]
                }
            };
            entries.push(Entry { label: view.label.clone(), swatches });
        }
        for (cable, &colour) in robot.cables().iter().zip(&self.cables) {
            let swatches = vec![Swatch::Line(Stroke::new(colour, 1.5))];
            entries.push(Entry { label: format!("cable {}", cable.name), swatches });
        }
        if measured {
            let marker = Swatch::Marker(
                Marker::Diamond,
                Fill::new(Colour::WHITE),
                Some(Stroke::new(MEASURED, 1.2)),
            );
            entries.push(Entry { label: "measured".to_owned(), swatches: vec![marker] });
        }
        entries
    }
}

/// Bodies with their looks.
pub(crate) fn bodies(
    robot: &Robot,
    views: &[RobotView],
    colours: &Colours,
) -> Result<Bodies, PlotError> {
    let mut bodies = Vec::with_capacity(views.len());
    for (view, &(colour, form)) in views.iter().zip(&colours.views) {
        let body = Body::new(robot, view)?;
        let pale = view.style == ViewStyle::Before;
        bodies.push((body, Look { colour, cables: colours.cables.clone(), pale, form }));
    }
    Ok(bodies)
}

/// One of eight directions that shows the farthest excursion from the z axis from the side, and a
/// little from the front.
fn view_in_space(options: &FigureOptions, drawn: &Drawn<'_>) -> Projection {
    let azimuth = options.azimuth.unwrap_or_else(|| {
        let backbone = drawn
            .bodies
            .iter()
            .flat_map(|(body, _)| &body.pieces)
            .filter(|piece| piece.part == Part::Backbone)
            .flat_map(|piece| piece.points.iter().copied());
        let farthest = backbone.fold(Vec3::ZERO, |far, p| {
            let reach = |v: Vec3| v.x.hypot(v.y);
            if reach(p) > reach(far) { p } else { far }
        });
        let size = drawn.points.iter().map(|p| p.max_abs()).fold(0.0, f64::max);
        let bend = if farthest.x.hypot(farthest.y) < 0.02 * size {
            0.0
        } else {
            farthest.y.atan2(farthest.x)
        };
        let score = |azimuth: f64| (bend - azimuth - 60_f64.to_radians()).cos();
        (0..8)
            .map(|k| f64::to_radians(f64::from(-60 + 45 * k)))
            .max_by(|&a, &b| score(a).total_cmp(&score(b)))
            .unwrap_or(0.0)
    });
    Projection::axonometric(azimuth, options.elevation)
}
