//! The rod's stiffness and rest curvature along its length, with the derivatives that eq. (3) takes.

use whipcord::{Robot, Vec3};

/// Stiffness and rest curvature with their derivatives by arc length.
pub struct Elastic {
    pub shear: Vec3,
    pub bending: Vec3,
    pub rest: Vec3,
    pub shear_rate: Vec3,
    pub bending_rate: Vec3,
    pub rest_rate: Vec3,
}

/// Where a state is asked for: a place, and the smooth piece of the rod it belongs to.
#[derive(Clone, Copy)]
pub struct Place {
    pub at: f64,
    pub from: f64,
    pub to: f64,
}

impl Place {
    /// One-sided: a kink at the end of the piece must not be seen.
    pub fn inside(&self) -> f64 {
        let margin = 1e-11 * (self.to - self.from);
        self.at.clamp(self.from + margin, self.to - margin)
    }

    pub fn middle(&self) -> f64 {
        0.5 * (self.from + self.to)
    }
}

impl Elastic {
    /// At a place; the derivatives are those of the smooth piece it belongs to.
    pub fn at(robot: &Robot, place: &Place) -> Self {
        let backbone = robot.backbone();
        let disks = robot.disks();
        let young = backbone.material.young_modulus.unwrap();
        let shear = backbone.material.shear_modulus().unwrap();
        let kappa = backbone.shear_correction;
        let stiffness = |s: f64| {
            let p = backbone.section_at(disks, s).unwrap();
            (
                Vec3::new(kappa * shear * p.area, kappa * shear * p.area, young * p.area),
                Vec3::new(
                    young * p.second_moment_x,
                    young * p.second_moment_y,
                    shear * p.torsion_constant,
                ),
            )
        };
        let s = place.inside();
        let (k_se, k_bt) = stiffness(s);
        let rest = backbone.rest_curvature_at(disks, s);
        let (mut shear_rate, mut bending_rate) = (Vec3::ZERO, Vec3::ZERO);
        let mut rest_rate = Vec3::ZERO;
        if !backbone.is_uniform() {
            // Polynomials of degree 4 in every piece, of which the five-point difference is exact, but
            // for the torsion of tapered bars: close to one another the points serve those as well.
            let h = 0.02 * (place.to - place.from);
            let c = s.clamp(place.from + 2.1 * h, place.to - 2.1 * h);
            let at = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|k| stiffness(c + k * h));
            let t = (s - c) / h;
            shear_rate = lagrange_slope(t, &at.map(|k| k.0)) / h;
            bending_rate = lagrange_slope(t, &at.map(|k| k.1)) / h;
            if !backbone.rest_curvature.is_uniform() {
                let [a, b] = [c - h, c + h].map(|s| backbone.rest_curvature_at(disks, s));
                rest_rate = (b - a) / (2.0 * h);
            }
        }
        Self { shear: k_se, bending: k_bt, rest, shear_rate, bending_rate, rest_rate }
    }
}

/// Derivative at `t` of the polynomial through values at −2, −1, 0, 1, 2.
fn lagrange_slope(t: f64, values: &[Vec3; 5]) -> Vec3 {
    let nodes = [-2.0, -1.0, 0.0, 1.0, 2.0];
    let mut slope = Vec3::ZERO;
    for i in 0..5 {
        let mut weight = 0.0;
        for j in (0..5).filter(|&j| j != i) {
            let mut product = 1.0 / (nodes[i] - nodes[j]);
            for k in (0..5).filter(|&k| k != i && k != j) {
                product *= (t - nodes[k]) / (nodes[i] - nodes[k]);
            }
            weight += product;
        }
        slope += weight * values[i];
    }
    slope
}
