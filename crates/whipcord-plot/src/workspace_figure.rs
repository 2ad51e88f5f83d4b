//! Where the tip of a robot can go: voxels in three views or sections, coloured by a value.

use std::collections::BTreeMap;

use whipcord::Vec3;

use crate::colour::Colour;
use crate::error::{PlotError, finite, not_empty, positive};
use crate::legend::{Entry, Swatch};
use crate::orthogonal::picture;
use crate::svg::{Fill, Stroke};

/// Voxels with a value each.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkspaceFigure {
    /// Above the picture.
    pub title: String,
    /// What the values are, with their unit, for the legend; none where they are not shown.
    pub quantity: Option<String>,
    /// Edge of a voxel in m.
    pub voxel: f64,
    /// Centre of each voxel in m, and its value.
    pub cells: Vec<(Vec3, f64)>,
    /// Points of the boundary in m.
    pub boundary: Vec<Vec3>,
    /// The backbone at rest in m.
    pub backbone: Vec<Vec3>,
    /// Sections through this point along the planes of the axes in place of views of all voxels.
    pub section: Option<Vec3>,
    /// Width in px.
    pub width: f64,
}

/// From low to high: viridis, which stays ordered in grey and for all kinds of colour vision.
const SCALE: [Colour; 6] = [
    Colour::new(0x44, 0x01, 0x54),
    Colour::new(0x41, 0x44, 0x87),
    Colour::new(0x2a, 0x78, 0x8e),
    Colour::new(0x22, 0xa8, 0x84),
    Colour::new(0x7a, 0xd1, 0x51),
    Colour::new(0xfd, 0xe7, 0x25),
];
/// The colour of voxels without values.
const PLAIN: Colour = Colour::new(0x6b, 0xa5, 0xd8);
const BOUNDARY: Colour = Colour::new(0xa8, 0x32, 0x32);

/// The voxels from the front, the side and above, in one scale. A square of a view has the mean of the values behind one another; of a
/// section, that of its voxel.
///
/// ```
/// use whipcord::Vec3;
/// use whipcord_plot::{WorkspaceFigure, workspace_figure};
///
/// let figure = WorkspaceFigure {
///     title: "Workspace".into(),
///     quantity: Some("stiffness (N/m)".into()),
///     voxel: 0.01,
///     cells: vec![(Vec3::new(0.005, 0.005, 0.105), 20.0), (Vec3::new(0.015, 0.005, 0.105), 30.0)],
///     boundary: vec![],
///     backbone: vec![Vec3::ZERO, Vec3::new(0.0, 0.0, 0.1)],
///     section: None,
///     width: 800.0,
/// };
/// assert!(workspace_figure(&figure)?.contains("stiffness"));
/// # Ok::<(), whipcord_plot::PlotError>(())
/// ```
///
/// # Errors
/// [`PlotError`] when there is nothing to draw, or a number is not finite.
pub fn workspace_figure(figure: &WorkspaceFigure) -> Result<String, PlotError> {
    not_empty(|| "the list of voxels".to_owned(), &figure.cells)?;
    positive(|| "the edge of a voxel".to_owned(), figure.voxel)?;
    for (centre, value) in &figure.cells {
        finite(|| "a value".to_owned(), *value)?;
        for x in centre.to_array() {
            finite(|| "a coordinate".to_owned(), x)?;
        }
    }
    let half = 0.5 * figure.voxel;
    let corner = Vec3::new(half, half, half);
    let corners = figure.cells.iter().flat_map(|(centre, _)| [*centre - corner, *centre + corner]);
    let points: Vec<Vec3> = corners.chain(figure.backbone.iter().copied()).collect();
    let levels = Levels::of(figure);
    let entries = levels.legend(figure);
    picture((&figure.title, figure.width), &points, entries, |svg, view, axes, _| {
        for (place, value) in squares(figure, axes) {
            let mut centre = [0.0; 3];
            for (axis, index) in axes.into_iter().zip(place) {
                centre[axis] = (f64::from(index) + 0.5) * figure.voxel;
            }
            let [x, y] = view.place(Vec3::new(centre[0], centre[1], centre[2]));
            let size = view.scale() * figure.voxel;
            // A hair more than the voxel, so that no white lines are left between squares.
            let size = [size + 0.3, size + 0.3];
            let fill = Fill::new(levels.colour(value));
            svg.rect([x - 0.5 * size[0], y - 0.5 * size[1]], size, Some(fill), None);
        }
        for point in figure.boundary.iter().filter(|point| is_in(figure, axes, **point)) {
            svg.circle(view.place(*point), 0.9, Some(Fill::new(BOUNDARY)), None);
        }
        let backbone: Vec<_> = figure.backbone.iter().map(|point| view.place(*point)).collect();
        svg.polyline(&backbone, Stroke::new(Colour::INK, 2.0), "backbone");
    })
}

/// Whether a point is to be seen in a view, or in a section.
fn is_in(figure: &WorkspaceFigure, axes: [usize; 2], point: Vec3) -> bool {
    let depth = 3 - axes[0] - axes[1];
    let place = |x: f64| (x / figure.voxel).floor();
    figure.section.is_none_or(|section| place(point[depth]) == place(section[depth]))
}

/// The squares of a view with the means of the values behind one another.
fn squares(figure: &WorkspaceFigure, axes: [usize; 2]) -> BTreeMap<[i32; 2], f64> {
    let mut sums: BTreeMap<[i32; 2], (f64, f64)> = BTreeMap::new();
    for (centre, value) in figure.cells.iter().filter(|(centre, _)| is_in(figure, axes, *centre)) {
        #[allow(
            clippy::cast_possible_truncation,
            reason = "pictures have fewer squares than pixels"
        )]
        let place = axes.map(|axis| (centre[axis] / figure.voxel).floor() as i32);
        let (sum, count) = sums.entry(place).or_default();
        *sum += value;
        *count += 1.0;
    }
    sums.into_iter().map(|(place, (sum, count))| (place, sum / count)).collect()
}

/// The ranges of the colours: each has about as many voxels.
pub(crate) struct Levels {
    /// Upper ends of all but the last.
    ends: Vec<f64>,
    range: [f64; 2],
    is_plain: bool,
}

impl Levels {
    /// At a sixth of the voxels each.
    pub fn of(figure: &WorkspaceFigure) -> Self {
        let mut values: Vec<f64> = figure.cells.iter().map(|(_, value)| *value).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len() - 1;
        let at = |k: usize| values[k * last / SCALE.len()];
        let mut ends: Vec<f64> = (1..SCALE.len()).map(at).collect();
        ends.dedup();
        Self { ends, range: [values[0], values[last]], is_plain: figure.quantity.is_none() }
    }

    /// The colour of a value.
    pub fn colour(&self, value: f64) -> Colour {
        if self.is_plain {
            return PLAIN;
        }
        let level = self.ends.partition_point(|end| *end < value);
        SCALE[level * (SCALE.len() - 1) / self.ends.len().max(1)]
    }

    fn legend(&self, figure: &WorkspaceFigure) -> Vec<Entry> {
        let area = |label: String, colour: Colour| Entry {
            label,
            swatches: vec![Swatch::Area(Fill::new(colour), None)],
        };
        let Some(quantity) = &figure.quantity else {
            return vec![area("the tip gets here".to_owned(), PLAIN)];
        };
        let mut from = self.range[0];
        let mut entries = vec![Entry { label: quantity.clone(), swatches: Vec::new() }];
        let ends = self.ends.iter().copied().chain([self.range[1]]);
        for to in ends {
            let text =
                |x: f64| whipcord::format::significant(x, 3, whipcord::format::Round::Nearest);
            entries.push(area(format!("{} to {}", text(from), text(to)), self.colour(to)));
            from = to;
        }
        entries
    }
}
