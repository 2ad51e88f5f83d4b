//! Named segments of the backbone.

use super::error::{Problem, RobotError, check_on_backbone};
use super::limits::STIFFNESS_FACTOR;
use super::stiffness::Stiffness;

/// A named segment of the backbone, between two arc lengths, with factors on the stiffness that section and material, or
/// [`Stiffness`], give there. A fit can estimate them.
///
/// ```
/// use whipcord::robot::BackboneSegment;
/// let near = BackboneSegment { bending_factor: 1.1, ..BackboneSegment::new("near", [0.0, 0.1]) };
/// assert!(near.contains(0.0) && !near.contains(0.1));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BackboneSegment {
    /// Name, unique among the segments.
    pub name: String,
    /// Group of segments that it belongs to. Segments of a group can share parameters in a fit.
    pub group: Option<String>,
    /// Arc lengths in m at which it begins and ends.
    pub range: [f64; 2],
    /// Factor on EI about x and y.
    pub bending_factor: f64,
    /// Factor on GJ.
    pub torsion_factor: f64,
    /// Factor on EA.
    pub extension_factor: f64,
    /// Factor on GA.
    pub shear_factor: f64,
}

/// Segments shorter than this, relative to the length of the backbone, are none to a model.
const LEAST_LENGTH: f64 = 1e-9;

impl BackboneSegment {
    /// A segment that does not change the stiffness, between two arc lengths in m.
    #[must_use]
    pub fn new(name: impl Into<String>, range: [f64; 2]) -> Self {
        Self {
            name: name.into(),
            group: None,
            range,
            bending_factor: 1.0,
            torsion_factor: 1.0,
            extension_factor: 1.0,
            shear_factor: 1.0,
        }
    }

    /// Whether an arc length in m lies in it; where it ends, the next one begins.
    #[must_use]
    pub fn contains(&self, arc_length: f64) -> bool {
        (self.range[0]..self.range[1]).contains(&arc_length)
    }

    /// Whether it leaves the stiffness as it is.
    #[must_use]
    pub fn is_neutral(&self) -> bool {
        self.stiffness_factors() == [1.0; 4]
    }

    /// The factors on GA, EA, EI and GJ.
    #[must_use]
    pub const fn stiffness_factors(&self) -> [f64; 4] {
        [self.shear_factor, self.extension_factor, self.bending_factor, self.torsion_factor]
    }

    const fn factors(&self) -> [(&'static str, f64); 4] {
        [
            ("bending_factor", self.bending_factor),
            ("torsion_factor", self.torsion_factor),
            ("extension_factor", self.extension_factor),
            ("shear_factor", self.shear_factor),
        ]
    }
}

/// The segment in which `inside` lies, the last one also at the tip.
pub(super) fn at(
    segments: &[BackboneSegment],
    length: f64,
    inside: f64,
) -> Option<(usize, &BackboneSegment)> {
    let is_it = |segment: &BackboneSegment| {
        segment.contains(inside) || (inside >= length && segment.range[1] >= length)
    };
    segments.iter().enumerate().find(|(_, segment)| is_it(segment))
}

pub(super) fn check(
    segments: &[BackboneSegment],
    length: f64,
    stiffness: Option<&Stiffness>,
) -> Result<(), RobotError> {
    for (index, segment) in segments.iter().enumerate() {
        let path = |key: &str| format!("backbone.segments[{index}].{key}");
        if let Some(first) = segments[..index].iter().position(|of| of.name == segment.name) {
            let problem = Problem::DuplicateName {
                what: "segment of the backbone",
                name: segment.name.clone(),
                first,
            };
            return Err(RobotError::new(path("name"), problem));
        }
        let [from, to] = segment.range;
        check_on_backbone(&path("starts_at"), from, length)?;
        check_on_backbone(&path("ends_at"), to, length)?;
        let previous = index.checked_sub(1).map_or(0.0, |before| segments[before].range[1]);
        if from < previous {
            let problem = Problem::NotIncreasing { value: from, previous };
            return Err(RobotError::new(path("starts_at"), problem));
        }
        if to <= from {
            let problem = Problem::NotIncreasing { value: to, previous: from };
            return Err(RobotError::new(path("ends_at"), problem));
        }
        let least = LEAST_LENGTH * length;
        if to - from < least {
            let problem = Problem::TooClose { pitch: to - from, least };
            return Err(RobotError::new(path("ends_at"), problem));
        }
        for (key, factor) in segment.factors() {
            STIFFNESS_FACTOR.check(&path(key), factor)?;
            if factor != 1.0 && matches!(stiffness, Some(Stiffness::Matrix(_))) {
                return Err(RobotError::new(path(key), Problem::FactorOnMatrix));
            }
        }
    }
    Ok(())
}
