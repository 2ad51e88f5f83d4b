//! Models drawn over a photograph of the robot, as its camera would see them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use core::f64::consts::TAU;
use whipcord::{Robot, Solution, Vec3};
use whipcord_estimation::camera::Camera;
use whipcord_estimation::observation::{InImage, Overlaid, Rms};

use crate::body::{Body, Disk, Part};
use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty};
use crate::legend::Legend;
use crate::marker::{self, Marker};
use crate::robot_figure::{Bodies, Colours, MEASURED, RobotView, bodies, label};
use crate::scene::{self, Form};
use crate::svg::{Fill, Point, Stroke, Svg};
use crate::title::Title;

/// A photograph as it is stored.
#[derive(Clone, Copy, Debug)]
pub struct Photograph<'a> {
    /// The bytes of a PNG or JPEG file.
    pub bytes: &'a [u8],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// What is drawn over a photograph besides the models.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayOptions {
    /// Above the picture; may be empty.
    pub title: String,
    /// Where disks or markers were found: column and row, the centre of the first pixel at (0, 0).
    pub measured: Vec<[f64; 2]>,
    /// Width of the picture in px.
    pub width: f64,
}

impl Default for OverlayOptions {
    fn default() -> Self {
        Self { title: String::new(), measured: Vec::new(), width: 980.0 }
    }
}

impl RobotView {
    /// A model's answer over a photograph, named with how far it is from the markers that were seen there, in mm
    /// and in per cent of the length in m.
    #[must_use]
    pub fn overlaid(overlaid: &Overlaid, markers: &[InImage], length: f64) -> Self {
        let name = label(overlaid.solution.model, &overlaid.solution);
        let name = match overlaid.rms(markers) {
            Some(Rms { distance, .. }) => format!(
                "{name}: RMS {:.2} mm, {:.2} % of the length",
                1e3 * distance,
                1e2 * distance / length
            ),
            None => name,
        };
        let solution = Solution { shape: overlaid.fine.clone(), ..overlaid.solution.clone() };
        Self::model(name, &solution)
    }
}

const MARGIN: f64 = 14.0;
const LEGEND_GAP: f64 = 10.0;
/// Widths of lines and the light around them, which parts them from the photograph, in px.
const BACKBONE: f64 = 2.2;
const RIM: f64 = 1.1;
const CABLE: f64 = 1.0;
const HALO: f64 = 1.6;
/// Radius of the sign at a disk's centre in px, and of that where it was found, beneath it.
const CENTRE: f64 = 2.6;
const FOUND: f64 = 5.0;
/// Corners of a rim.
const CORNERS: u32 = 48;
/// Longest line that is not cut, beyond the edges of the photograph, relative to its size.
const FAR: f64 = 4.0;

/// Where the camera puts points of the world on the picture.
struct View<'a> {
    camera: &'a Camera,
    /// Picture px to a pixel of the photograph.
    scale: f64,
    corner: Point,
    size: [f64; 2],
}

/// The models over the photograph: backbone, rims of the disks, cables, and a sign at each disk's centre,
/// each model in its colour; diamonds where disks or markers were found.
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, the bytes are neither PNG nor JPEG, a number is not
/// finite, or no disk of a model is in the photograph.
pub fn overlay_figure(
    robot: &Robot,
    camera: &Camera,
    photograph: Photograph<'_>,
    views: &[RobotView],
    options: &OverlayOptions,
) -> Result<String, PlotError> {
    not_empty(|| "the list of views".to_owned(), views)?;
    for &pixel in options.measured.iter().flatten() {
        finite(|| "a measured pixel".to_owned(), pixel)?;
    }
    let kind = kind(photograph.bytes)?;
    let [columns, rows] = photograph.size.map(f64::from);
    let width = options.width - 2.0 * MARGIN;
    let scale = width / columns;
    if !(400.0..=10_000.0).contains(&options.width) || !(1.0..=20_000.0).contains(&(scale * rows)) {
        let height = scale * rows;
        return Err(PlotError::Size { width: options.width, height, largest: 10_000 });
    }
    let colours = Colours::new(robot, views);
    let bodies = bodies(robot, views, &colours)?;
    let title = Title::new(&options.title, width);
    let corner = [MARGIN, MARGIN + title.height()];
    let view = View { camera, scale, corner, size: [columns, rows] };
    for (robot_view, (body, _)) in views.iter().zip(&bodies) {
        view.check(&robot_view.label, body)?;
    }

    let entries = colours.legend_of(robot, views, !options.measured.is_empty());
    let legend = Legend::of_height(entries, width, 0.0);
    let below = corner[1] + scale * rows + LEGEND_GAP;
    let mut svg = Svg::new(options.width, below + legend.height() + MARGIN);
    title.draw(&mut svg, [MARGIN, MARGIN]);
    let size = [scale * columns, scale * rows];
    svg.image(
        corner,
        size,
        &format!("data:image/{kind};base64,{}", STANDARD.encode(photograph.bytes)),
    );
    svg.open_within("overlay", corner, size);
    view.draw_lines(&mut svg, &bodies);
    let ink = Some(Stroke::new(MEASURED, 1.1));
    for &pixel in &options.measured {
        let at = view.on_picture(pixel);
        marker::draw(&mut svg, Marker::Diamond, at, FOUND, Fill::new(Colour::WHITE), ink);
    }
    view.draw_centres(&mut svg, &bodies);
    svg.close();
    legend.draw(&mut svg, [MARGIN, below]);
    svg.finish(&options.title)
}

/// The kind of a picture by its first bytes.
fn kind(bytes: &[u8]) -> Result<&'static str, PlotError> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Ok("png")
    } else if bytes.starts_with(&[0xff, 0xd8, 0xff]) {
        Ok("jpeg")
    } else {
        Err(PlotError::Photograph)
    }
}

impl View<'_> {
    fn on_picture(&self, pixel: [f64; 2]) -> Point {
        [0, 1].map(|i| self.corner[i] + self.scale * (pixel[i] + 0.5))
    }

    /// Where a point is drawn; `None` when the camera does not see it, or far beyond its image.
    fn place(&self, point: Vec3) -> Option<Point> {
        let pixel = self.camera.project(point).ok()?;
        let near = (0..2).all(|i| pixel[i].abs() <= FAR * self.size[i]);
        near.then(|| self.on_picture(pixel))
    }

    /// Refuses a model of which nothing is in the photograph.
    fn check(&self, label: &str, body: &Body) -> Result<(), PlotError> {
        let inside = |point: Vec3| {
            let pixel = self.camera.project(point);
            pixel.is_ok_and(|pixel| (0..2).all(|i| (-0.5..=self.size[i] - 0.5).contains(&pixel[i])))
        };
        let disks = body.disks.iter().map(|disk| disk.pose.position);
        // A body without disks is seen by its backbone.
        let backbone = body.pieces.iter().filter(|_| body.disks.is_empty());
        let ends = backbone.flat_map(|piece| piece.points.first().copied());
        if disks.chain(ends).any(inside) {
            Ok(())
        } else {
            Err(PlotError::NotSeen { what: label.to_owned() })
        }
    }

    /// Pale bodies first, then the others; of each kind first the light around all lines.
    fn draw_lines(&self, svg: &mut Svg, bodies: &Bodies) {
        for (pale, halo) in [(true, true), (true, false), (false, true), (false, false)] {
            let strength = if pale { 0.5 } else { 1.0 };
            let stroke = |colour: Colour, width: f64| {
                if halo {
                    Stroke::new(Colour::WHITE, width + HALO)
                } else {
                    Stroke::new(colour.tint(strength), width)
                }
            };
            for (body, look) in bodies.iter().filter(|(_, look)| look.pale == pale) {
                for disk in &body.disks {
                    self.line(svg, &rim(disk), stroke(look.colour, RIM), "rim");
                }
                for piece in &body.pieces {
                    let (stroke, class) = match piece.part {
                        Part::Cable(i) => (stroke(look.cables[i], CABLE), "cable"),
                        Part::Backbone => (stroke(look.colour, BACKBONE), "backbone"),
                        Part::Anchor(_) => continue,
                    };
                    self.line(svg, &piece.points, stroke, class);
                }
            }
        }
    }

    fn draw_centres(&self, svg: &mut Svg, bodies: &Bodies) {
        let light = Some(Stroke::new(Colour::WHITE, 0.8));
        for (body, look) in bodies.iter().filter(|(_, look)| !look.pale) {
            // As in the legend.
            let sign = match look.form {
                Form::Line { marker, .. } => marker,
                Form::Whole => Marker::Circle,
            };
            for at in body.disks.iter().filter_map(|disk| self.place(disk.pose.position)) {
                marker::draw(svg, sign, at, CENTRE, Fill::new(look.colour), light);
            }
        }
    }

    /// A line through the points, broken where the camera does not see it.
    fn line(&self, svg: &mut Svg, points: &[Vec3], stroke: Stroke, class: &str) {
        let places: Vec<Option<Point>> = points.iter().map(|&p| self.place(p)).collect();
        for seen in places.split(Option::is_none) {
            let seen: Vec<Point> = seen.iter().copied().flatten().collect();
            if seen.len() > 1 {
                svg.polyline(&scene::simplified(&seen, 0.04), stroke, class);
            }
        }
    }
}

fn rim(disk: &Disk) -> Vec<Vec3> {
    let corner = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
        disk.pose.transform(disk.radius * Vec3::new(cos, sin, 0.0))
    };
    (0..=CORNERS).map(corner).collect()
}
