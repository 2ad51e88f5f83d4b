//! Shapes of natural vibrations in three views.

use whipcord::{Pose, Vec3};

use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty};
use crate::legend::{Entry, Swatch};
use crate::orthogonal::picture;
use crate::projection::Projection;
use crate::svg::{Stroke, Svg};

/// The shape of a vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeLine {
    /// Entry in the legend.
    pub label: String,
    /// Displacement of each node in m and its rotation in rad in the world, in any scale.
    pub shape: Vec<(Vec3, Vec3)>,
}

/// Vibrations about a shape of the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct ModesFigure {
    /// Above the picture.
    pub title: String,
    /// Poses of the nodes in the equilibrium: three for each element, whose ends are those of its neighbours.
    pub poses: Vec<Pose>,
    /// The vibrations.
    pub modes: Vec<ModeLine>,
    /// Width in px.
    pub width: f64,
}

/// The greatest displacement that is drawn, relative to the length of the robot.
const AMPLITUDE: f64 = 0.15;
/// The greatest rotation that is drawn in rad: it limits vibrations that hardly displace anything.
const GREATEST_ROTATION: f64 = 1.0;
/// Length of the strokes across the backbone, which show how it twists, relative to the length of the robot.
const STROKE: f64 = 0.03;
/// About as many strokes are drawn.
const STROKES: usize = 10;

/// Both ends of each vibration from the front, the side and above, in one scale, over the equilibrium. Short strokes across the backbone show how its sections turn.
///
/// ```
/// use whipcord::{Pose, Vec3};
/// use whipcord_plot::{ModeLine, ModesFigure, modes_figure};
///
/// let at = |z: f64| Pose { position: Vec3::new(0.0, 0.0, z), ..Pose::IDENTITY };
/// let bent = |z: f64| (Vec3::new(z * z, 0.0, 0.0), Vec3::new(0.0, 2.0 * z, 0.0));
/// let figure = ModesFigure {
///     title: "Modes".into(),
///     poses: [0.0, 0.1, 0.2].map(at).to_vec(),
///     modes: vec![ModeLine { label: "1: 2.5 Hz".into(), shape: [0.0, 0.1, 0.2].map(bent).to_vec() }],
///     width: 800.0,
/// };
/// assert!(modes_figure(&figure)?.contains("1: 2.5 Hz"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, a number is not finite or a shape has not one entry for each node.
pub fn modes_figure(figure: &ModesFigure) -> Result<String, PlotError> {
    not_empty(|| "the list of vibrations".to_owned(), &figure.modes)?;
    not_empty(|| "the list of nodes".to_owned(), &figure.poses)?;
    for mode in &figure.modes {
        let (given, expected) = (mode.shape.len(), figure.poses.len());
        if given != expected {
            let what = format!("nodes of `{}`", mode.label);
            return Err(PlotError::Count { what, given, expected });
        }
        for x in mode.shape.iter().flat_map(|(a, b)| [a.to_array(), b.to_array()]).flatten() {
            finite(|| format!("a displacement of `{}`", mode.label), x)?;
        }
    }
    let backbone: Vec<Vec3> = figure.poses.iter().map(|pose| pose.position).collect();
    for x in backbone.iter().flat_map(|point| point.to_array()) {
        finite(|| "a coordinate".to_owned(), x)?;
    }
    let length: f64 = backbone.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let drawn: Vec<[Curve; 2]> = figure
        .modes
        .iter()
        .map(|mode| {
            let scale = scale(mode, length);
            [scale, -scale].map(|scale| Curve::new(&figure.poses, mode, scale, STROKE * length))
        })
        .collect();
    let points: Vec<Vec3> = drawn
        .iter()
        .flatten()
        .flat_map(|curve| curve.line.iter().chain(curve.strokes.iter().flatten()))
        .chain(&backbone)
        .copied()
        .collect();

    let rest = Stroke::new(Colour::INK, 1.6);
    let line = |label: &str, stroke: Stroke| Entry {
        label: label.to_owned(),
        swatches: vec![Swatch::Line(stroke)],
    };
    let mut entries = vec![line("equilibrium", rest)];
    for (k, mode) in figure.modes.iter().enumerate() {
        entries.push(line(&mode.label, Stroke::new(Colour::nth(k), 2.0)));
    }
    picture((&figure.title, figure.width), &points, entries, |svg, view, _, _| {
        for (k, curves) in drawn.iter().enumerate() {
            let [there, back] = curves;
            back.draw(svg, view, Stroke::new(Colour::nth(k).tint(0.5), 1.2));
            there.draw(svg, view, Stroke::new(Colour::nth(k), 2.0));
        }
        let places: Vec<_> = smooth(&backbone).iter().map(|point| view.place(*point)).collect();
        svg.polyline(&places, rest, "backbone");
    })
}

/// What a shape is multiplied by for a robot of this length in m.
fn scale(mode: &ModeLine, length: f64) -> f64 {
    let greatest = |of: fn(&(Vec3, Vec3)) -> Vec3| {
        mode.shape.iter().map(|node| of(node).norm()).fold(f64::MIN_POSITIVE, f64::max)
    };
    let displacement = AMPLITUDE * length / greatest(|node| node.0);
    displacement.min(GREATEST_ROTATION / greatest(|node| node.1))
}

/// A displaced backbone.
struct Curve {
    line: Vec<Vec3>,
    strokes: Vec<[Vec3; 2]>,
}

impl Curve {
    fn new(poses: &[Pose], mode: &ModeLine, scale: f64, stroke: f64) -> Self {
        let every = poses.len().div_ceil(STROKES).max(1);
        let (mut line, mut strokes) = (Vec::new(), Vec::new());
        for (k, (pose, (displacement, rotation))) in poses.iter().zip(&mode.shape).enumerate() {
            let place = pose.position + *displacement * scale;
            line.push(place);
            if k % every == 0 {
                let across = pose.rotation.rotate(Vec3::X) * (0.5 * stroke);
                let across =
                    Pose::exp(whipcord::Twist { linear: Vec3::ZERO, angular: *rotation * scale })
                        .rotation
                        .rotate(across);
                strokes.push([place - across, place + across]);
            }
        }
        Self { line: smooth(&line), strokes }
    }

    fn draw(&self, svg: &mut Svg, view: &Projection, stroke: Stroke) {
        let places: Vec<_> = self.line.iter().map(|point| view.place(*point)).collect();
        svg.polyline(&places, stroke, "mode");
        for ends in &self.strokes {
            let [a, b] = ends.map(|point| view.place(point));
            svg.line(a, b, Stroke { width: 1.0, ..stroke });
        }
    }
}

/// Parts of an element that are drawn straight.
const PARTS: usize = 6;

/// A line through the nodes of elements with three nodes each, quadratic in each element as its displacements are.
fn smooth(nodes: &[Vec3]) -> Vec<Vec3> {
    let mut line = Vec::with_capacity(nodes.len() * PARTS);
    for element in nodes.windows(3).step_by(2) {
        for k in 0..PARTS {
            let t = k as f64 / PARTS as f64;
            let weights = [(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
            let point = element.iter().zip(weights).fold(Vec3::ZERO, |sum, (p, w)| sum + *p * w);
            line.push(point);
        }
    }
    // The last node, and one before it that belongs to no element of three.
    line.extend_from_slice(&nodes[2 * (nodes.len().saturating_sub(1) / 2)..]);
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(shape: Vec<(Vec3, Vec3)>) -> ModesFigure {
        let at = |z: f64| Pose { position: Vec3::new(0.0, 0.0, z), ..Pose::IDENTITY };
        let modes = vec![ModeLine { label: "1".to_owned(), shape }];
        let poses = [0.0, 0.1].map(at).to_vec();
        ModesFigure { title: String::new(), poses, modes, width: 800.0 }
    }

    #[test]
    fn twist_alone_moves_only_the_strokes() {
        let twist = figure(vec![(Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, Vec3::Z)]);
        assert!((scale(&twist.modes[0], 0.1) - GREATEST_ROTATION).abs() < 1e-12);
        let curve = Curve::new(&twist.poses, &twist.modes[0], 0.5, 0.01);
        assert_eq!(curve.line.last(), Some(&twist.poses[1].position));
        assert!((curve.strokes[1][1].y - 0.005 * 0.5_f64.sin()).abs() < 1e-12);
        assert!(modes_figure(&twist).is_ok());
    }

    #[test]
    fn lines_are_quadratic_in_elements() {
        let nodes = [0.0, 1.0, 2.0, 3.0, 4.0].map(|x| Vec3::new(x, x * x, 0.0));
        let line = smooth(&nodes);
        assert_eq!(line.len(), 2 * PARTS + 1);
        assert!(line.iter().all(|p| (p.y - p.x * p.x).abs() < 1e-12));
        assert_eq!(smooth(&nodes[..4]).last(), Some(&nodes[3]));
        assert_eq!(smooth(&nodes[..2]), nodes[..2]);
    }

    #[test]
    fn nothing_nan_and_missing_nodes_are_refused() {
        let still = (Vec3::ZERO, Vec3::ZERO);
        assert!(modes_figure(&figure(vec![still])).is_err());
        assert!(modes_figure(&figure(vec![still, (Vec3::X * f64::NAN, Vec3::ZERO)])).is_err());
        assert!(modes_figure(&ModesFigure { modes: vec![], ..figure(vec![]) }).is_err());
    }
}
