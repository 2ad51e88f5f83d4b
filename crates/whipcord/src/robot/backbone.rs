use whipcord_numerics::Vec3;

use super::disks::Disks;
use super::error::{Problem, RobotError};
use super::limits::{CURVATURE, DENSITY, DISTANCE, LENGTH, MODULUS, POISSON_RATIO};
use super::section::{Section, SectionProperties};

/// The elastic rod that runs through the disks.
#[derive(Clone, Debug, PartialEq)]
pub struct Backbone {
    /// Length of the undeformed backbone in m.
    pub length: f64,
    /// Cross-section; a geometric model needs none.
    pub section: Option<Section>,
    /// Material; a geometric model needs none.
    pub material: Material,
    /// Curvature and twist of the backbone when nothing pulls on it.
    pub rest_curvature: RestCurvature,
}

/// Elastic constants, each optional: a model says which it needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// Young's modulus in Pa.
    pub young_modulus: Option<f64>,
    /// Poisson's ratio.
    pub poisson_ratio: Option<f64>,
    /// Shear modulus in Pa, instead of Poisson's ratio.
    pub shear_modulus: Option<f64>,
    /// Density in kg/m³, needed only where weight matters.
    pub density: Option<f64>,
}

/// Rest curvature in the body frame, 1/m: (bending about x, bending about y, twist).
#[derive(Clone, Debug, PartialEq)]
pub enum RestCurvature {
    /// The same everywhere.
    Uniform(Vec3),
    /// Given at each disk and varying linearly between them.
    PerDisk(Vec<Vec3>),
}

impl Default for RestCurvature {
    fn default() -> Self {
        Self::Uniform(Vec3::ZERO)
    }
}

impl RestCurvature {
    /// Whether the backbone is straight at rest.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        match self {
            Self::Uniform(u) => *u == Vec3::ZERO,
            Self::PerDisk(list) => list.iter().all(|u| *u == Vec3::ZERO),
        }
    }
}

impl Material {
    /// G in Pa: given, or E/(2(1+ν)).
    #[must_use]
    pub fn shear_modulus(&self) -> Option<f64> {
        self.shear_modulus
            .or_else(|| Some(self.young_modulus? / (2.0 * (1.0 + self.poisson_ratio?))))
    }

    /// ν: given, or E/(2G) − 1.
    #[must_use]
    pub fn poisson_ratio(&self) -> Option<f64> {
        self.poisson_ratio.or_else(|| Some(self.young_modulus? / (2.0 * self.shear_modulus?) - 1.0))
    }
}

impl Backbone {
    /// A straight backbone of this length, of which nothing else is known.
    #[must_use]
    pub fn new(length: f64) -> Self {
        Self {
            length,
            section: None,
            material: Material::default(),
            rest_curvature: RestCurvature::default(),
        }
    }

    /// Rest curvature at an arc length, 1/m, in the body frame. `disks` are those of the robot.
    #[must_use]
    pub fn rest_curvature_at(&self, disks: &Disks, arc_length: f64) -> Vec3 {
        match &self.rest_curvature {
            RestCurvature::Uniform(u) => *u,
            RestCurvature::PerDisk(list) => {
                let (i, t) = disks.locate(arc_length);
                list[i] * (1.0 - t) + list[i + 1] * t
            }
        }
    }

    /// Cross-section properties at an arc length, or `None` when the section is not given.
    #[must_use]
    pub fn section_at(&self, disks: &Disks, arc_length: f64) -> Option<SectionProperties> {
        Some(match self.section.as_ref()? {
            Section::Circle { diameter } => SectionProperties::annulus(*diameter, 0.0),
            Section::Tube { outer, inner } => SectionProperties::annulus(*outer, *inner),
            Section::Rectangle { width, height } => SectionProperties::rectangle(*width, *height),
            Section::Taper { outer, inner } => {
                let (i, t) = disks.locate(arc_length);
                SectionProperties::annulus(outer[i] * (1.0 - t) + outer[i + 1] * t, *inner)
            }
        })
    }

    /// Whether section and rest curvature are the same along the whole length.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        !matches!(self.section, Some(Section::Taper { .. }))
            && matches!(self.rest_curvature, RestCurvature::Uniform(_))
    }

    pub(super) fn check(&self, disks: &Disks) -> Result<(), RobotError> {
        LENGTH.check("backbone.length", self.length)?;
        let count = disks.arc_lengths.len();
        if let Some(section) = &self.section {
            check_section(section, count)?;
        }
        let material = &self.material;
        if let Some(value) = material.young_modulus {
            MODULUS.check("backbone.young_modulus", value)?;
        }
        if let Some(value) = material.shear_modulus {
            MODULUS.check("backbone.shear_modulus", value)?;
        }
        if let Some(value) = material.poisson_ratio {
            POISSON_RATIO.check("backbone.poisson_ratio", value)?;
        }
        if let Some(value) = material.density {
            DENSITY.check("backbone.density", value)?;
        }
        match &self.rest_curvature {
            RestCurvature::Uniform(u) => CURVATURE.check_vector("backbone.rest_curvature", *u),
            RestCurvature::PerDisk(list) => {
                if list.len() != count {
                    return Err(RobotError::new(
                        "backbone.rest_curvature",
                        Problem::Count { given: list.len(), expected: count },
                    ));
                }
                list.iter().enumerate().try_for_each(|(i, u)| {
                    CURVATURE.check_vector(&format!("backbone.rest_curvature[{i}]"), *u)
                })
            }
        }
    }
}

fn check_section(section: &Section, disks: usize) -> Result<(), RobotError> {
    let bore = |inner: f64, outer: f64| {
        DISTANCE.check("backbone.inner_diameter", inner)?;
        if inner < outer {
            Ok(())
        } else {
            let problem = Problem::BoreTooWide { inner, outer };
            Err(RobotError::new("backbone.inner_diameter", problem))
        }
    };
    match section {
        Section::Circle { diameter } => LENGTH.check("backbone.diameter", *diameter),
        Section::Tube { outer, inner } => {
            LENGTH.check("backbone.diameter", *outer)?;
            bore(*inner, *outer)
        }
        Section::Rectangle { width, height } => {
            LENGTH.check("backbone.section.width", *width)?;
            LENGTH.check("backbone.section.height", *height)
        }
        Section::Taper { outer, inner } => {
            if outer.len() != disks {
                return Err(RobotError::new(
                    "backbone.diameters",
                    Problem::Count { given: outer.len(), expected: disks },
                ));
            }
            outer.iter().enumerate().try_for_each(|(i, &d)| {
                LENGTH.check(&format!("backbone.diameters[{i}]"), d)?;
                bore(*inner, d)
            })
        }
    }
}
