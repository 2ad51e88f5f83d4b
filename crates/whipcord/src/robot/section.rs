/// The shape of a cross-section. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Section {
    /// A solid rod.
    Circle {
        /// Diameter.
        diameter: f64,
    },
    /// A tube.
    Tube {
        /// Outer diameter.
        outer: f64,
        /// Inner diameter.
        inner: f64,
    },
    /// A rectangular bar.
    Rectangle {
        /// Extent along x.
        width: f64,
        /// Extent along y.
        height: f64,
    },
    /// A solid rod or tube whose diameters are given at each disk and vary linearly between them.
    Taper {
        /// Outer diameter at each disk.
        outer: Vec<f64>,
        /// Inner diameter, 0 for a solid rod.
        inner: f64,
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

impl Section {
    /// A solid rod of this diameter.
    #[must_use]
    pub const fn circle(diameter: f64) -> Self {
        Self::Circle { diameter }
    }
}

impl SectionProperties {
    pub(crate) fn annulus(outer: f64, inner: f64) -> Self {
        use core::f64::consts::PI;
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
    use core::f64::consts::PI;
    let (a, b) = if width >= height { (width, height) } else { (height, width) };
    let sum: f64 = (0..200)
        .map(|k| {
            let n = f64::from(2 * k + 1);
            (0.5 * n * PI * a / b).tanh() / n.powi(5)
        })
        .sum();
    a * b.powi(3) * (1.0 / 3.0 - 64.0 / PI.powi(5) * (b / a) * sum)
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
