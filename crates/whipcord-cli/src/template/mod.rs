//! Templates of robot files, for `whipcord new`.

mod parts;
pub mod questions;

use core::f64::consts::{PI, TAU};
use std::iter::repeat_n;

use clap::ValueEnum;

use whipcord_study::quantity::number;

/// The kind of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Round backbone, cables straight through holes
    Arm,
    /// Round backbone, cables that wind round it
    Helical,
    /// Backbone and cables that narrow towards the tip
    Tapered,
    /// Flat strip that closes round a ball
    Gripper,
}

/// A quantity as text, and in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// With its unit.
    pub text: String,
    /// In SI.
    pub value: f64,
}

/// Material of the backbone.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus.
    pub young_modulus: Given,
    /// Its description in a comment; empty if unknown.
    pub name: &'static str,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Density in kg/m³; a typical value if unknown.
    pub density: f64,
}

/// Materials by name: Young's modulus in GPa, Poisson's ratio and density in kg/m³.
pub const MATERIALS: [(&str, &str, &str, f64, f64, f64); 5] = [
    ("nitinol", "superelastic nickel-titanium", "60 GPa", 60e9, 0.33, 6450.0),
    ("steel", "spring steel", "200 GPa", 200e9, 0.3, 7850.0),
    ("abs", "ABS, printed", "1.1 GPa", 1.1e9, 0.35, 1040.0),
    ("nylon", "polyamide, laser-sintered", "1.7 GPa", 1.7e9, 0.4, 950.0),
    ("tpu", "thermoplastic polyurethane", "26 MPa", 26e6, 0.45, 1200.0),
];

impl Material {
    /// A material of the list.
    pub fn named(name: &str) -> Option<Self> {
        let (_, name, text, value, poisson_ratio, density) =
            MATERIALS.into_iter().find(|(known, ..)| name.eq_ignore_ascii_case(known))?;
        let young_modulus = Given { text: text.to_owned(), value };
        Some(Self { young_modulus, name, poisson_ratio, density })
    }

    /// A material with this Young's modulus.
    pub const fn of_modulus(young_modulus: Given) -> Self {
        Self { young_modulus, name: "", poisson_ratio: 0.3, density: 1000.0 }
    }
}

/// The parameters of a template.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Kind of the robot.
    pub kind: Kind,
    /// Length of the backbone.
    pub length: Given,
    /// Diameter of the backbone (at the base, if it is tapered), or thickness of the strip.
    pub diameter: Given,
    /// Material of the backbone.
    pub material: Material,
    /// Number of disks.
    pub disks: usize,
    /// Number of cables.
    pub cables: usize,
}

/// Bending angle by the tension of the first cable, in rad.
const BEND: f64 = PI / 3.0;
/// The same for a gripper without its ball.
const CLOSED: f64 = 4.8;
/// Shortening of the cable of a gripper that holds the ball, relative to its length.
const GRIPPED: f64 = 0.153;
/// Tension of the other cables relative to the first.
const TAUT: f64 = 0.1;
/// Dimensions at the tip of a tapered robot relative to those at the base.
const TAPER: f64 = 0.5;

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Arm, Self::Helical, Self::Tapered, Self::Gripper];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Arm => "arm",
            Self::Helical => "helical",
            Self::Tapered => "tapered",
            Self::Gripper => "gripper",
        }
    }

    /// Maximum number of cables; a strip bends in two directions.
    pub const fn most_cables(self) -> usize {
        match self {
            Self::Gripper => 2,
            _ => 12,
        }
    }

    /// Minimum number of disks; a finger with fewer cannot lie against a ball.
    pub const fn least_disks(self) -> usize {
        match self {
            Self::Gripper => 5,
            _ => 3,
        }
    }

    /// Name of the second dimension of the backbone.
    pub const fn diameter_name(self) -> &'static str {
        match self {
            Self::Arm | Self::Helical => "Diameter of the backbone",
            Self::Tapered => "Diameter of the backbone at its base",
            Self::Gripper => "Thickness of the strip",
        }
    }

    /// The default parameters.
    pub fn plan(self) -> Plan {
        let (length, diameter, material, disks, cables) = match self {
            Self::Arm => (200, ("1.5 mm", 1.5e-3), "nitinol", 11, 3),
            Self::Helical => (200, ("1.5 mm", 1.5e-3), "nitinol", 11, 1),
            Self::Tapered => (200, ("4 mm", 4e-3), "nylon", 11, 2),
            Self::Gripper => (120, ("0.3 mm", 0.3e-3), "steel", 13, 1),
        };
        let (text, value) = diameter;
        let metres = f64::from(length) / 1e3;
        Plan {
            kind: self,
            length: Given { text: format!("{length} mm"), value: metres },
            diameter: Given { text: text.to_owned(), value },
            // The default is in the list.
            material: Material::named(material).unwrap_or_else(|| {
                Material::of_modulus(Given { text: "1 GPa".to_owned(), value: 1e9 })
            }),
            disks,
            cables,
        }
    }
}

impl Plan {
    /// Distance of the cables from the axis, at the base, in m.
    fn radius(&self) -> f64 {
        (self.length.value / 20.0).max(1.5 * self.diameter.value)
    }

    /// Width of a strip, in m.
    fn width(&self) -> f64 {
        self.length.value / 15.0
    }

    /// Bending stiffness at the base, in N·m².
    fn bending_stiffness(&self) -> f64 {
        let d = self.diameter.value;
        let inertia = match self.kind {
            Kind::Gripper => self.width() * d.powi(3) / 12.0,
            _ => PI * d.powi(4) / 64.0,
        };
        self.material.young_modulus.value * inertia
    }

    /// Tension of the first cable, in N, and its shortening, in m, for a straight cable on an inextensible backbone.
    fn pull(&self) -> (f64, f64) {
        let (l, r, ei) = (self.length.value, self.radius(), self.bending_stiffness());
        match self.kind {
            Kind::Arm | Kind::Helical => (BEND * ei / (r * l), BEND * r),
            // The curvature is τ r/EI, where r and the diameter decrease linearly to one half: the bending angle is the integral
            // of 1/(1 − s/2L)³, and the shortening that of 1/(1 − s/2L)².
            Kind::Tapered => (BEND * ei / (3.0 * r * l), BEND * r * 2.0 / 3.0),
            Kind::Gripper => (CLOSED * ei / (r * l), GRIPPED * l),
        }
    }

    /// Angle of a cable round the axis, in rad.
    fn angle(&self, cable: usize) -> f64 {
        TAU * cable as f64 / self.cables as f64
    }

    /// A dimension at each disk, decreasing linearly from the base to the tip.
    fn tapering(&self, at_base: f64) -> Vec<f64> {
        let last = self.disks.saturating_sub(1).max(1) as f64;
        (0..self.disks).map(|k| at_base * (1.0 - (1.0 - TAPER) * k as f64 / last)).collect()
    }

    /// The robot file; `name` is that of the file.
    pub fn robot_file(&self, name: &str) -> String {
        let sections = [
            parts::head(self, name),
            parts::backbone(self),
            parts::disks(self),
            parts::cables(self),
        ];
        let more = [parts::obstacle(self), parts::more(self)];
        sections
            .into_iter()
            .chain(more)
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join("\n")
    }
}

/// `"7.5 mm"` in quotes, with three digits.
fn millimetres(metres: f64) -> String {
    format!("\"{} mm\"", number(metres * 1e3, 3))
}

/// The same hole in every disk.
fn same_hole(hole: usize, disks: usize) -> String {
    repeat_n(hole.to_string(), disks).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(kind: Kind, length: f64, diameter: f64, disks: usize, cables: usize) -> Plan {
        let metres = |value: f64| Given { text: format!("{} mm", value * 1e3), value };
        let of_kind = kind.plan();
        Plan { length: metres(length), diameter: metres(diameter), disks, cables, ..of_kind }
    }

    #[test]
    fn robots_of_all_sizes_are_valid_without_warnings() {
        for kind in Kind::ALL {
            let thickest = if kind == Kind::Gripper { 0.02 } else { 0.1 };
            for length in [0.01, 0.18, 3.0] {
                for slenderness in [thickest, 1e-3] {
                    for (disks, cables) in
                        [(kind.least_disks(), 1), (10, 2), (100, kind.most_cables())]
                    {
                        let plan = plan(kind, length, slenderness * length, disks, cables);
                        let text = plan.robot_file("robot.toml");
                        let file = whipcord_io::parse(&text, "robot.toml")
                            .unwrap_or_else(|error| panic!("{error}\n{text}"));
                        assert!(file.warnings().is_empty(), "{:?}\n{text}", file.warnings());
                        assert_eq!(file.robot.cables().len(), cables);
                        assert_eq!(file.robot.disks().count(), disks);
                    }
                }
            }
        }
    }

    #[test]
    fn the_pull_of_a_taper_is_that_of_its_curvature() {
        let plan = plan(Kind::Tapered, 0.2, 4e-3, 11, 1);
        let (tension, shortening) = plan.pull();
        let (mut bend, mut shortened) = (0.0, 0.0);
        let steps = 10_000;
        for k in 0..steps {
            let narrow = 1.0 - 0.5 * (f64::from(k) + 0.5) / f64::from(steps);
            let arm = plan.radius() * narrow;
            let curvature = tension * arm / (plan.bending_stiffness() * narrow.powi(4));
            bend += curvature * 0.2 / f64::from(steps);
            shortened += curvature * arm * 0.2 / f64::from(steps);
        }
        assert!((bend / BEND - 1.0).abs() < 1e-6, "{bend}");
        assert!((shortened / shortening - 1.0).abs() < 1e-6, "{shortened} {shortening}");
    }
}
