use whipcord_numerics::{GAUSS_3, Twist, UnitQuaternion, Vec3, magnus_6};

use super::along::{Along, Paths};
use super::bending_friction::BendingFriction;
use super::disks::Disks;
use super::error::{Problem, RobotError};
use super::limits::{
    CURVATURE, DENSITY, LENGTH, LINEAR_DENSITY, MODULUS, POISSON_RATIO, SHEAR_CORRECTION,
    YIELD_STRAIN,
};
use super::section::{Section, SectionProperties};
use super::segment::{self, BackboneSegment};
use super::stiffness::{Held, Stiffness};

/// The elastic rod that runs through the disks.
///
/// Its stiffness follows from section and material, or is given as such:
///
/// ```
/// use whipcord::{Backbone, Section, Stiffness};
///
/// let rod = Backbone { section: Some(Section::circle(0.003)), ..Backbone::new(0.18) };
/// // A composite strip, of which only bending and twist matter: EI_x, EI_y and GJ in N·m².
/// let strip = Backbone {
///     stiffness: Some(Stiffness::Diagonal {
///         shear: None,
///         axial: None,
///         bending: [0.12, 0.004].into(),
///         torsion: 0.009.into(),
///     }),
///     linear_density: Some(0.021.into()),
///     extensible: false,
///     shearable: false,
///     ..Backbone::new(0.3)
/// };
/// # let _ = (rod, strip);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Backbone {
    /// Length of the undeformed backbone in m.
    pub length: f64,
    /// Cross-section; a geometric model needs none.
    pub section: Option<Section>,
    /// Material; a geometric model needs none.
    pub material: Material,
    /// Factor κ on the shear stiffness GA that follows from section and material: 1, or Timoshenko's
    /// `6(1+ν)/(7+6ν)` for a circle and 5/6 for a rectangle.
    pub shear_correction: f64,
    /// Stiffness of the sections, instead of that of a material. A section may stand beside it for
    /// weight and for pictures.
    pub stiffness: Option<Stiffness>,
    /// Named segments, from the base on, with factors on the stiffness; between them it stays as it is.
    pub segments: Vec<BackboneSegment>,
    /// Mass per length in kg/m, instead of a density of the material.
    pub linear_density: Option<Along<f64>>,
    /// Curvature and twist of the backbone when nothing pulls on it.
    pub rest_curvature: RestCurvature,
    /// Whether it can stretch; if not, EA is of no effect.
    pub extensible: bool,
    /// Whether its sections can shear; if not, GA is of no effect.
    pub shearable: bool,
    /// Friction against bending inside it, where there is any: bending then depends on the history.
    pub bending_friction: Option<BendingFriction>,
}

/// Elastic constants, each optional: a model says which it needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// What it is called, where it has one of the names that robot files know. No model computes with it.
    pub name: Option<&'static str>,
    /// Young's modulus in Pa.
    pub young_modulus: Option<f64>,
    /// Poisson's ratio.
    pub poisson_ratio: Option<f64>,
    /// Shear modulus in Pa, instead of Poisson's ratio.
    pub shear_modulus: Option<f64>,
    /// Density in kg/m³, needed only where weight matters.
    pub density: Option<f64>,
    /// Strain up to which the material is elastic. No model computes with it: an answer that exceeds it
    /// gets a [warning](crate::warning).
    pub yield_strain: Option<f64>,
}

/// Rest curvature in the body frame, 1/m: (bending about x, bending about y, twist).
pub type RestCurvature = Along<Vec3>;

impl Along<Vec3> {
    /// Whether it is zero everywhere: a backbone that is straight at rest.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.values().iter().all(|u| *u == Vec3::ZERO)
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
            shear_correction: 1.0,
            stiffness: None,
            segments: Vec::new(),
            linear_density: None,
            rest_curvature: RestCurvature::default(),
            extensible: true,
            shearable: true,
            bending_friction: None,
        }
    }

    /// Rest curvature at an arc length, 1/m, in the body frame. `disks` are those of the robot.
    #[must_use]
    pub fn rest_curvature_at(&self, disks: &Disks, arc_length: f64) -> Vec3 {
        self.rest_curvature.at(disks, arc_length)
    }

    /// How the cross-section at arc length `to` is turned against that at `from` when the backbone is at rest, and
    /// by how much in rad it has turned on the way.
    pub(crate) fn rest_rotation(&self, disks: &Disks, from: f64, to: f64) -> (UnitQuaternion, f64) {
        // Of sixth order, for a curvature that varies linearly from place to place.
        const STEPS: usize = 8;
        if self.rest_curvature.is_zero() {
            return (UnitQuaternion::IDENTITY, 0.0);
        }
        let mut places = self.rest_curvature.places().to_vec();
        places.retain(|s| from < *s && *s < to);
        places.extend([from, to]);
        places.sort_by(f64::total_cmp);
        let (mut rotation, mut way) = (UnitQuaternion::IDENTITY, 0.0);
        for piece in places.windows(2) {
            let h = (piece[1] - piece[0]) / STEPS as f64;
            let inside = 0.5 * (piece[0] + piece[1]);
            for k in 0..STEPS {
                let turn = GAUSS_3.nodes.map(|node| {
                    let s = piece[0] + (k as f64 + node) * h;
                    let angular = self.rest_curvature.at_end(disks, s, inside) * h;
                    Twist { linear: Vec3::ZERO, angular }
                });
                rotation = rotation * magnus_6(&turn).rotation;
                let weighted = turn.iter().zip(GAUSS_3.weights);
                way += weighted.map(|(turn, weight)| turn.angular.norm() * weight).sum::<f64>();
            }
        }
        (rotation.renormalized(), way)
    }

    /// Cross-section properties at an arc length, or `None` when the section is not given.
    #[must_use]
    pub fn section_at(&self, disks: &Disks, arc_length: f64) -> Option<SectionProperties> {
        Some(self.section.as_ref()?.at_end(disks, arc_length, arc_length))
    }

    /// Radius in m of the circle around the cross-section at an arc length; 0 where the section is not given.
    #[must_use]
    pub fn outer_radius_at(&self, disks: &Disks, arc_length: f64) -> f64 {
        self.section.as_ref().map_or(0.0, |section| section.reach_at(disks, arc_length))
    }

    /// Mass per length in kg/m at an arc length, or `None` when neither it nor section and density
    /// are given.
    #[must_use]
    pub fn linear_density_at(&self, disks: &Disks, arc_length: f64) -> Option<f64> {
        match &self.linear_density {
            Some(given) => Some(given.at(disks, arc_length)),
            None => Some(self.section_at(disks, arc_length)?.area * self.material.density?),
        }
    }

    /// The segment in which an arc length lies, with its number; at the end of a segment, the next one.
    #[must_use]
    pub fn segment_at(&self, arc_length: f64) -> Option<(usize, &BackboneSegment)> {
        segment::at(&self.segments, self.length, arc_length)
    }

    /// Arc lengths besides those of the disks at which stiffness, mass or rest curvature, or their
    /// slopes, jump.
    #[must_use]
    pub fn places(&self) -> Vec<f64> {
        let mut places = self.rest_curvature.places().to_vec();
        places.extend(self.section.iter().flat_map(Section::places));
        places.extend(self.stiffness.iter().flat_map(Stiffness::places));
        places.extend(self.linear_density.iter().flat_map(Along::places));
        places.extend(self.segments.iter().flat_map(|segment| segment.range));
        places
    }

    /// Whether stiffness and rest curvature are the same along the whole length.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.section.as_ref().is_none_or(Section::is_uniform)
            && self.stiffness.as_ref().is_none_or(Stiffness::is_uniform)
            && self.rest_curvature.is_uniform()
            && self.segments.iter().all(BackboneSegment::is_neutral)
    }

    /// The same backbone for a robot with other disks.
    #[must_use]
    pub fn apart_from(&self, disks: &Disks) -> Self {
        Self {
            section: self.section.as_ref().map(|section| section.apart_from(disks)),
            stiffness: self.stiffness.as_ref().map(|stiffness| stiffness.apart_from(disks)),
            linear_density: self.linear_density.as_ref().map(|along| along.apart_from(disks)),
            rest_curvature: self.rest_curvature.apart_from(disks),
            ..self.clone()
        }
    }

    pub(super) fn check(&self, disks: &Disks) -> Result<(), RobotError> {
        LENGTH.check("backbone.length", self.length)?;
        let length = self.length;
        if let Some(section) = &self.section {
            section.check(disks, length)?;
        }
        self.check_material()?;
        if let Some(stiffness) = &self.stiffness {
            let held = Held { shear: !self.shearable, axial: !self.extensible };
            stiffness.check(disks, length, held)?;
        }
        segment::check(&self.segments, length, self.stiffness.as_ref())?;
        if let Some(along) = &self.linear_density {
            along.check(disks, length, MASS_PER_LENGTH, |path, &value| {
                LINEAR_DENSITY.check(path, value)
            })?;
        }
        if let Some(friction) = &self.bending_friction {
            friction.check()?;
        }
        self.rest_curvature.check(disks, length, CURVED, |path, u| CURVATURE.check_vector(path, *u))
    }

    /// What can only be checked once the disks are known to be valid.
    pub(super) fn check_with(&self, disks: &Disks) -> Result<(), RobotError> {
        self.section.as_ref().map_or(Ok(()), |section| section.check_bore(disks))
    }

    fn check_material(&self) -> Result<(), RobotError> {
        let material = &self.material;
        let given = [
            ("backbone.young_modulus", material.young_modulus, MODULUS),
            ("backbone.shear_modulus", material.shear_modulus, MODULUS),
            ("backbone.poisson_ratio", material.poisson_ratio, POISSON_RATIO),
            ("backbone.density", material.density, DENSITY),
            ("backbone.yield_strain", material.yield_strain, YIELD_STRAIN),
            ("backbone.shear_correction", Some(self.shear_correction), SHEAR_CORRECTION),
        ];
        for (path, value, range) in given {
            if let Some(value) = value {
                range.check(path, value)?;
            }
        }
        let twice = |path: &str, other| Err(RobotError::new(path, Problem::GivenTwice { other }));
        if self.stiffness.is_some() {
            let elastic = &given[..3];
            if let Some((path, ..)) = elastic.iter().find(|(_, value, _)| value.is_some()) {
                return twice(path, "backbone.stiffness");
            }
            if self.shear_correction != 1.0 {
                return twice("backbone.shear_correction", "backbone.stiffness");
            }
        }
        if material.density.is_some() && self.linear_density.is_some() {
            return twice("backbone.density", "backbone.linear_density");
        }
        Ok(())
    }
}

const MASS_PER_LENGTH: Paths = Paths {
    value: "backbone.linear_density",
    values: "backbone.linear_density.values",
    places: "backbone.linear_density.at",
};
const CURVED: Paths = Paths {
    value: "backbone.rest_curvature",
    values: "backbone.rest_curvature.values",
    places: "backbone.rest_curvature.at",
};
