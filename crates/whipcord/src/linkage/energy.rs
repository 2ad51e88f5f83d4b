//! What the stiffness of a section resists.

use whipcord_numerics::{Jet, Vec3, asin_ratio};

use super::division::{Division, Energy};
use super::layout::Section;
use super::motion::{Coordinates, MOST};
use super::swing::half_bend;
use crate::section::BENDING_AXES;

/// Keeps the derivatives finite at a rotation by half a turn.
const MOST_SINE: f64 = 1.0 - 1e-12;

impl Section {
    /// By how much a joint is bent about x and y against its angles at rest.
    fn bend(&self, joint: usize, q: &Coordinates) -> Vec3 {
        let of = |a: usize| q[a] - self.rest[a];
        Vec3::new(of(1 + 2 * joint), of(2 + 2 * joint), 0.0)
    }

    /// What the friction of a joint acts on, about x and y against rest.
    pub fn bend_of_friction(&self, division: &Division, joint: usize, q: &Coordinates) -> Vec3 {
        match division.energy {
            Energy::Coordinates => self.bend(joint, q),
            Energy::RotationVector => {
                let [x, y, _] = self.turned(q).map(|turned| turned.value);
                Vec3::new(x, y, 0.0)
            }
        }
    }

    /// How that changes with the coordinates, by axes.
    pub fn bend_rates(
        &self,
        division: &Division,
        joint: usize,
        q: &Coordinates,
    ) -> [Coordinates; BENDING_AXES] {
        let mut rates = [[0.0; MOST]; BENDING_AXES];
        match division.energy {
            Energy::Coordinates => {
                (rates[0][1 + 2 * joint], rates[1][2 + 2 * joint]) = (1.0, 1.0);
            }
            Energy::RotationVector => {
                for (rates, turned) in rates.iter_mut().zip(self.turned(q)) {
                    let Vec3 { x, y, z } = turned.gradient;
                    rates[..3].copy_from_slice(&[x, y, z]);
                }
            }
        }
        rates
    }

    /// Lets its joints keep what their friction holds at these coordinates.
    pub fn keep_plastic(&mut self, division: &Division, q: &Coordinates) {
        for k in 0..self.friction.len() {
            let bend = self.bend_of_friction(division, k, q);
            self.friction[k].plastic = self.friction[k].left(bend);
        }
    }

    /// Mean plastic curvature of the section in 1/m: that of its joints over its length.
    pub fn plastic_curvature(&self) -> [f64; BENDING_AXES] {
        core::array::from_fn(|axis| {
            self.friction.iter().map(|joint| joint.plastic[axis]).sum::<f64>() / self.length
        })
    }

    /// Gradient of the elastic energy, and of that of eq. (1) of the page on friction against bending, by the coordinates in N·m.
    pub fn elastic_moments(&self, division: &Division, q: &Coordinates) -> Coordinates {
        match division.energy {
            Energy::Coordinates => {
                let mut moments =
                    core::array::from_fn(|a| self.stiffness[a] * (q[a] - self.rest[a]));
                for (k, friction) in self.friction.iter().enumerate() {
                    let own = friction.moment(self.bend(k, q));
                    moments[1 + 2 * k] += own.x;
                    moments[2 + 2 * k] += own.y;
                }
                moments
            }
            Energy::RotationVector => {
                let Vec3 { x, y, z } = self.energy_of_rotation(q).gradient;
                [x, y, z, 0.0, 0.0, 0.0, 0.0]
            }
        }
    }

    /// Adds the second derivatives of the elastic energy in N·m.
    pub fn add_elastic_stiffness(
        &self,
        division: &Division,
        q: &Coordinates,
        tangent: &mut [[f64; MOST]; MOST],
    ) {
        match division.energy {
            Energy::Coordinates => {
                for a in 0..division.coordinates() {
                    tangent[a][a] += self.stiffness[a];
                }
                for (k, friction) in self.friction.iter().enumerate() {
                    let own = friction.tangent(self.bend(k, q));
                    tangent[1 + 2 * k][1 + 2 * k] += own.x;
                    tangent[2 + 2 * k][2 + 2 * k] += own.y;
                }
            }
            Energy::RotationVector => {
                let h = self.energy_of_rotation(q).hessian;
                let rows = [[h.xx, h.yx, h.zx], [h.yx, h.yy, h.zy], [h.zx, h.zy, h.zz]];
                for (row, own) in tangent.iter_mut().zip(rows) {
                    row.iter_mut().zip(own).for_each(|(x, own)| *x += own);
                }
            }
        }
    }

    /// `½ Σ kᵢ (ωᵢ − ωᵢ*)²` with the rotation vector ω of the section, by `(ψ, b_x, b_y)`: eqs. (5) and (13) of the page on
    /// four-bar sections; and that of eq. (1) of the page on friction against bending about x and y.
    fn energy_of_rotation(&self, q: &Coordinates) -> Jet {
        let turned = self.turned(q);
        let bend = Vec3::new(turned[0].value, turned[1].value, 0.0);
        let [about_z, about_x, about_y, ..] = self.stiffness;
        let mut energy = Jet::default();
        for (change, k) in turned.into_iter().zip([about_x, about_y, about_z]) {
            energy = energy + change * change * (0.5 * k);
        }
        for friction in &self.friction {
            let (moment, tangent) = (friction.moment(bend), friction.tangent(bend));
            // Of the energy of both axes none counts but its derivatives.
            for (axis, change) in turned.into_iter().take(BENDING_AXES).enumerate() {
                energy = energy + change.compose([0.0, moment[axis], tangent[axis]]);
            }
        }
        energy
    }

    /// `ωᵢ − ωᵢ*` about x, y and z, by `(ψ, b_x, b_y)`.
    fn turned(&self, q: &Coordinates) -> [Jet; 3] {
        let twist = Jet::linear(q[0], Vec3::X);
        let (x, y) = (Jet::linear(q[1], Vec3::Y), Jet::linear(q[2], Vec3::Z));
        let square = x * x + y * y;
        let [cos_bend, sine_ratio] = half_bend(square.value).map(|f| square.compose(f));
        let (sin, cos) = (0.5 * q[0]).sin_cos();
        let sin_twist = twist.compose([sin, 0.5 * cos, -0.25 * sin]);
        // The vector part of the section's quaternion.
        let across = sine_ratio * 0.5;
        let vector = [across * x, across * y, cos_bend * sin_twist];
        let squared_sine = vector.into_iter().map(|v| v * v).fold(Jet::default(), |a, b| a + b);
        let [a, da, dda] = asin_ratio(squared_sine.value.min(MOST_SINE));
        let factor = squared_sine.compose([2.0 * a, 2.0 * da, 2.0 * dda]);
        let rest = self.rest_rotation.to_array();
        core::array::from_fn(|i| factor * vector[i] + Jet::linear(-rest[i], Vec3::ZERO))
    }
}
