//! Signs for single data.

use whipcord::ModelKind;

use crate::colour;
use crate::svg::{Fill, Point, Stroke, Svg};

/// The shape of a sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marker {
    /// ●
    #[default]
    Circle,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
    /// ▼
    Wedge,
    /// ⬟
    Pentagon,
}

impl Marker {
    /// The sign of a model, the same in every picture.
    #[must_use]
    pub fn of_model(kind: ModelKind) -> Self {
        Self::nth(colour::place(kind))
    }

    /// Shape number `index`, from 0; they repeat.
    #[must_use]
    pub const fn nth(index: usize) -> Self {
        match index % 6 {
            0 => Self::Circle,
            1 => Self::Square,
            2 => Self::Triangle,
            3 => Self::Diamond,
            4 => Self::Wedge,
            _ => Self::Pentagon,
        }
    }
}

/// Draws a sign about as large as a circle of this radius.
pub(crate) fn draw(
    svg: &mut Svg,
    marker: Marker,
    [x, y]: Point,
    radius: f64,
    fill: Fill,
    stroke: Option<Stroke>,
) {
    // Corners and the angle of the first one; radii that give all shapes nearly the same area.
    let (corners, start, r) = match marker {
        Marker::Circle => {
            svg.circle([x, y], radius, Some(fill), stroke);
            return;
        }
        Marker::Square => (4, 45.0, 1.25 * radius),
        Marker::Triangle => (3, -90.0, 1.45 * radius),
        Marker::Diamond => (4, -90.0, 1.35 * radius),
        Marker::Wedge => (3, 90.0, 1.45 * radius),
        Marker::Pentagon => (5, -90.0, 1.2 * radius),
    };
    let points: Vec<Point> = (0..corners)
        .map(|k| {
            let angle = f64::to_radians(start + 360.0 * f64::from(k) / f64::from(corners));
            [x + r * angle.cos(), y + r * angle.sin()]
        })
        .collect();
    svg.polygon(&points, Some(fill), stroke);
}
