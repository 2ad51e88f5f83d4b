//! How cross-section and rest curvature change with the parameters of the backbone.

use core::f64::consts::PI;

use whipcord_numerics::Vec3;

use super::quantity::Parameter;
use crate::robot::section::torsion_series;
use crate::robot::{Along, Backbone, Disks, Section, SectionProperties};

impl Backbone {
    /// Derivative of the cross-section's properties by a parameter, at one end of a piece in which
    /// nothing jumps ([`Along::at_end`]); `None` for a parameter that is none of its measures.
    pub(crate) fn section_change(
        &self,
        disks: &Disks,
        arc_length: f64,
        inside: f64,
        parameter: &Parameter,
    ) -> Option<SectionProperties> {
        let at = |along: &Along<f64>| along.at_end(disks, arc_length, inside);
        let share =
            |along: &Along<f64>, entry| share(along, entry).at_end(disks, arc_length, inside);
        match self.section.as_ref()? {
            Section::Round { outer, inner } => {
                let (d_outer, d_inner) = match *parameter {
                    Parameter::Diameter => (1.0, 0.0),
                    Parameter::DiameterAt { entry } => (share(outer, entry), 0.0),
                    Parameter::InnerDiameter => (0.0, 1.0),
                    _ => return None,
                };
                Some(annulus_change(at(outer), at(inner), d_outer, d_inner))
            }
            Section::Rectangle { width, height } => {
                let (d_width, d_height) = match *parameter {
                    Parameter::Width => (1.0, 0.0),
                    Parameter::Height => (0.0, 1.0),
                    _ => return None,
                };
                Some(rectangle_change(at(width), at(height), d_width, d_height))
            }
        }
    }

    /// Derivative of the rest curvature by a parameter, at one end of a piece in which nothing jumps.
    pub(crate) fn rest_curvature_change(
        &self,
        disks: &Disks,
        arc_length: f64,
        inside: f64,
        parameter: &Parameter,
    ) -> Vec3 {
        let mut change = Vec3::ZERO;
        match *parameter {
            Parameter::RestCurvature { axis } => change[axis] = 1.0,
            Parameter::RestCurvatureAt { entry, axis } => {
                let along = share(&self.rest_curvature, entry);
                change[axis] = along.at_end(disks, arc_length, inside);
            }
            _ => {}
        }
        change
    }
}

/// Weight of one entry along the backbone.
fn share<T>(along: &Along<T>, entry: usize) -> Along<f64> {
    let mut weights = along.map(|_| 0.0);
    if let Some(weight) = weights.values_mut().get_mut(entry) {
        *weight = 1.0;
    }
    weights
}

fn annulus_change(outer: f64, inner: f64, d_outer: f64, d_inner: f64) -> SectionProperties {
    let second_moment = PI / 16.0 * (outer.powi(3) * d_outer - inner.powi(3) * d_inner);
    SectionProperties {
        area: PI / 2.0 * (outer * d_outer - inner * d_inner),
        second_moment_x: second_moment,
        second_moment_y: second_moment,
        torsion_constant: 2.0 * second_moment,
    }
}

fn rectangle_change(width: f64, height: f64, d_width: f64, d_height: f64) -> SectionProperties {
    let (w2, h2) = (width * width, height * height);
    SectionProperties {
        area: d_width * height + width * d_height,
        second_moment_x: d_width * height * h2 / 12.0 + width * h2 * d_height / 4.0,
        second_moment_y: d_height * width * w2 / 12.0 + height * w2 * d_width / 4.0,
        torsion_constant: if width >= height {
            torsion_change(width, height, d_width, d_height)
        } else {
            torsion_change(height, width, d_height, d_width)
        },
    }
}

/// Of `J = a b³/3 − (64/π⁵) b⁴ Σ tanh(nπa/2b)/n⁵` for `a ≥ b`, over odd n.
fn torsion_change(a: f64, b: f64, da: f64, db: f64) -> f64 {
    let (sum, slope) = torsion_series(a / b);
    let c = 64.0 / PI.powi(5);
    let b3 = b.powi(3);
    (b3 / 3.0 - c * b3 * slope) * da + (a * b * b - 4.0 * c * b3 * sum + c * a * b * b * slope) * db
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_changes_as_its_properties_do() {
        for (w, h) in [(0.002, 0.001), (0.001, 0.0015)] {
            let d = 1e-8;
            for (dw, dh) in [(1.0, 0.0), (0.0, 1.0)] {
                let at = |f: f64| SectionProperties::rectangle(w + f * d * dw, h + f * d * dh);
                let (a, b) = (at(-1.0), at(1.0));
                let change = rectangle_change(w, h, dw, dh);
                let close = |x: f64, y: f64, is: f64| {
                    assert!(((y - x) / (2.0 * d) - is).abs() < 1e-7 * is.abs(), "{is}");
                };
                close(a.area, b.area, change.area);
                close(a.second_moment_x, b.second_moment_x, change.second_moment_x);
                close(a.second_moment_y, b.second_moment_y, change.second_moment_y);
                close(a.torsion_constant, b.torsion_constant, change.torsion_constant);
            }
        }
    }
}
