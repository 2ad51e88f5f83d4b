use core::f64::consts::PI;

use super::along::{Along, Paths};
use super::disks::Disks;
use super::error::{Problem, RobotError};
use super::limits::{DISTANCE, LENGTH};

/// The shape of the cross-sections. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Section {
    /// A solid rod or a tube.
    Round {
        /// Outer diameter.
        outer: Along<f64>,
        /// Inner diameter, 0 for a solid rod.
        inner: Along<f64>,
    },
    /// A rectangular bar.
    Rectangle {
        /// Extent along x.
        width: Along<f64>,
        /// Extent along y.
        height: Along<f64>,
    },
}

/// What a cross-section contributes to stiffness and weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionProperties {
    /// Area in m².
    pub area: f64,
    /// Second moment of area about x in m⁴.
    pub second_moment_x: f64,
    /// Second moment of area about y in m⁴.
    pub second_moment_y: f64,
    /// Torsion constant of Saint-Venant in m⁴.
    pub torsion_constant: f64,
}

const OUTER: Paths = Paths {
    value: "backbone.diameters",
    values: "backbone.diameters.values",
    places: "backbone.diameters.at",
};
const INNER: Paths = Paths {
    value: "backbone.inner_diameter",
    values: "backbone.inner_diameter.values",
    places: "backbone.inner_diameter.at",
};
const WIDTH: Paths = of_bar("backbone.section.width");
const HEIGHT: Paths = of_bar("backbone.section.height");

const fn of_bar(value: &'static str) -> Paths {
    Paths { value, values: value, places: "backbone.section.at" }
}

impl Section {
    /// A solid rod of this diameter.
    #[must_use]
    pub const fn circle(diameter: f64) -> Self {
        Self::tube(diameter, 0.0)
    }

    /// A tube of these diameters.
    #[must_use]
    pub const fn tube(outer: f64, inner: f64) -> Self {
        Self::Round { outer: Along::Uniform(outer), inner: Along::Uniform(inner) }
    }

    /// A rectangular bar of this extent along x and y.
    #[must_use]
    pub const fn rectangle(width: f64, height: f64) -> Self {
        Self::Rectangle { width: Along::Uniform(width), height: Along::Uniform(height) }
    }

    /// Its properties at one end of a piece of the backbone inside which nothing jumps; see
    /// [`Along::at_end`].
    #[must_use]
    pub fn at_end(&self, disks: &Disks, arc_length: f64, inside: f64) -> SectionProperties {
        let at = |along: &Along<f64>| along.at_end(disks, arc_length, inside);
        match self {
            Self::Round { outer, inner } => SectionProperties::annulus(at(outer), at(inner)),
            Self::Rectangle { width, height } => {
                SectionProperties::rectangle(at(width), at(height))
            }
        }
    }

    /// Both quantities that it is made of.
    fn parts(&self) -> [&Along<f64>; 2] {
        match self {
            Self::Round { outer: a, inner: b } | Self::Rectangle { width: a, height: b } => [a, b],
        }
    }

    /// Radius in m of the circle around it at an arc length.
    pub(super) fn reach_at(&self, disks: &Disks, arc_length: f64) -> f64 {
        let at = |along: &Along<f64>| along.at(disks, arc_length);
        match self {
            Self::Round { outer, .. } => 0.5 * at(outer),
            Self::Rectangle { width, height } => 0.5 * at(width).hypot(at(height)),
        }
    }

    /// Whether it is the same along the whole backbone.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.parts().iter().all(|along| along.is_uniform())
    }

    /// Arc lengths besides those of the disks at which its slope, or it itself, jumps.
    pub fn places(&self) -> impl Iterator<Item = f64> + '_ {
        self.parts().into_iter().flat_map(Along::places).copied()
    }

    /// The same for a robot with other disks.
    #[must_use]
    pub fn apart_from(&self, disks: &Disks) -> Self {
        match self {
            Self::Round { outer, inner } => {
                Self::Round { outer: outer.apart_from(disks), inner: inner.apart_from(disks) }
            }
            Self::Rectangle { width, height } => {
                Self::Rectangle { width: width.apart_from(disks), height: height.apart_from(disks) }
            }
        }
    }

    pub(super) fn check(&self, disks: &Disks, length: f64) -> Result<(), RobotError> {
        let positive = |path: &str, &value: &f64| LENGTH.check(path, value);
        match self {
            Self::Round { outer, inner } => {
                let uniform = Paths { value: "backbone.diameter", ..OUTER };
                let paths = if outer.is_uniform() { uniform } else { OUTER };
                outer.check(disks, length, paths, positive)?;
                inner.check(disks, length, INNER, |path, &value| DISTANCE.check(path, value))
            }
            Self::Rectangle { width, height } => {
                width.check(disks, length, WIDTH, positive)?;
                height.check(disks, length, HEIGHT, positive)
            }
        }
    }

    /// Refuses a bore that is not narrower than the tube: between its places each diameter is
    /// linear, so that it suffices to look at all of them.
    pub(super) fn check_bore(&self, disks: &Disks) -> Result<(), RobotError> {
        let Self::Round { outer, inner } = self else { return Ok(()) };
        let mut places = disks.arc_lengths.clone();
        places.extend(self.places());
        places.sort_by(f64::total_cmp);
        for piece in places.windows(2) {
            let middle = 0.5 * (piece[0] + piece[1]);
            for &s in piece {
                let [outer, inner] = [outer, inner].map(|along| along.at_end(disks, s, middle));
                if inner >= outer {
                    let problem = Problem::BoreTooWide { inner, outer };
                    return Err(RobotError::new(INNER.value, problem));
                }
            }
        }
        Ok(())
    }
}

impl SectionProperties {
    pub(crate) fn annulus(outer: f64, inner: f64) -> Self {
        let (o2, i2) = (outer * outer, inner * inner);
        let second_moment = PI / 64.0 * (o2 * o2 - i2 * i2);
        Self {
            area: PI / 4.0 * (o2 - i2),
            second_moment_x: second_moment,
            second_moment_y: second_moment,
            torsion_constant: 2.0 * second_moment,
        }
    }

    pub(crate) fn rectangle(width: f64, height: f64) -> Self {
        Self {
            area: width * height,
            second_moment_x: width * height.powi(3) / 12.0,
            second_moment_y: height * width.powi(3) / 12.0,
            torsion_constant: rectangle_torsion_constant(width, height),
        }
    }
}

/// Saint-Venant's series for a rectangle `a ≥ b`
/// (Timoshenko and Goodier, Theory of Elasticity, art. 109):
/// `J = a b³ (1/3 − (64/π⁵)(b/a) Σ tanh(nπa/2b)/n⁵)` over odd n.
fn rectangle_torsion_constant(width: f64, height: f64) -> f64 {
    let (a, b) = if width >= height { (width, height) } else { (height, width) };
    let (sum, _) = torsion_series(a / b);
    a * b.powi(3) * (1.0 / 3.0 - 64.0 / PI.powi(5) * (b / a) * sum)
}

/// `Σ tanh(nπx/2)/n⁵` over odd n and its derivative by `x`, for `x ≥ 1`.
///
/// With `q = e^(−nπx)` it is `Σ 1/n⁵ − Σ 2q/(1 + q)/n⁵`. The first sum is `31/32 ζ(5)`; the second falls by
/// 1/535 from term to term, so that six of them are exact.
pub(crate) fn torsion_series(x: f64) -> (f64, f64) {
    const ODD_FIFTH_POWERS: f64 = 1.004_523_762_795_139_6;
    let (mut sum, mut slope) = (ODD_FIFTH_POWERS, 0.0);
    for n in [11.0_f64, 9.0, 7.0, 5.0, 3.0, 1.0] {
        let q = (-n * PI * x).exp();
        sum -= 2.0 * q / (1.0 + q) / n.powi(5);
        slope += 2.0 * PI * q / (1.0 + q).powi(2) / n.powi(4);
    }
    (sum, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Timoshenko and Goodier, table of art. 109: k₁ in `J = k₁ a b³`.
    #[test]
    fn rectangle_torsion_matches_the_published_table() {
        for (ratio, k) in [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (4.0, 0.281), (10.0, 0.312)] {
            let j = SectionProperties::rectangle(0.002, 0.002 * ratio).torsion_constant;
            assert!((j / (ratio * 0.002_f64.powi(4)) - k).abs() < 6e-4, "{ratio}");
        }
        let square = SectionProperties::rectangle(1.0, 1.0).torsion_constant;
        assert!((square - 0.140_577_014_955_15).abs() < 1e-10);
    }

    #[test]
    fn a_tube_is_the_difference_of_two_rods() {
        let tube = SectionProperties::annulus(3.0, 2.0);
        let (outer, inner) =
            (SectionProperties::annulus(3.0, 0.0), SectionProperties::annulus(2.0, 0.0));
        assert!((tube.area - (outer.area - inner.area)).abs() < 1e-14);
        assert!(
            (tube.torsion_constant - (outer.torsion_constant - inner.torsion_constant)).abs()
                < 1e-13
        );
    }
}
