//! A lens that was calibrated.

use whipcord_numerics::Pose;

use crate::camera::lens::Pinhole;

/// A lens that was calibrated, and how well it explains the photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// The lens.
    pub lens: Pinhole,
    /// Which of its distortion coefficients were sought.
    pub free_parameters: FreeParameters,
    /// How sure its numbers are.
    pub deviations: LensDeviations,
    /// Where the camera was in the frame of the board, for each photograph.
    pub poses: Vec<Pose>,
    /// Greatest angle between the planes of the boards in two photographs, in rad, seen from the camera.
    pub tilt: f64,
    /// Root mean square distance between seen and projected points in pixels, for each photograph.
    pub view_rms: Vec<f64>,
    /// The same of all points.
    pub rms: f64,
}

/// Standard deviations, eq. (k5).
#[derive(Clone, Debug, PartialEq)]
pub struct LensDeviations {
    /// Of the focal lengths in pixels.
    pub focal: [f64; 2],
    /// Of the principal point in pixels.
    pub centre: [f64; 2],
    /// Of the distortion coefficients, 0 where one was not sought; none where the photographs do not tell it.
    pub distortion: Vec<Option<f64>>,
    /// Of a column or row at which a point was seen, in pixels, as what is left of them tells.
    pub pixel: f64,
    /// Covariance of the focal lengths, the principal point and the distortion coefficients that were sought, in this order, by rows; of a coefficient that
    /// the photographs do not tell zero.
    pub covariance: Vec<Vec<f64>>,
}

/// Which distortion coefficients are sought; the others are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FreeParameters {
    /// None: a lens that bends nothing.
    None,
    /// k₁ and k₂.
    Radial,
    /// k₁ k₂ p₁ p₂.
    Four,
    /// These and k₃, as OpenCV does where nothing else is asked for.
    #[default]
    Five,
    /// These and k₄ k₅ k₆.
    Eight,
    /// These and s₁ s₂ s₃ s₄.
    Twelve,
}

impl FreeParameters {
    /// All choices.
    pub const ALL: [Self; 6] =
        [Self::None, Self::Radial, Self::Four, Self::Five, Self::Eight, Self::Twelve];

    /// What it is called.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Radial => "k1k2",
            Self::Four => "4",
            Self::Five => "5",
            Self::Eight => "8",
            Self::Twelve => "12",
        }
    }

    /// How many coefficients the lens then has, and how many of them, from the first, are sought.
    pub(super) const fn counts(self) -> [usize; 2] {
        match self {
            Self::None => [0, 0],
            Self::Radial => [4, 2],
            Self::Four => [4, 4],
            Self::Five => [5, 5],
            Self::Eight => [8, 8],
            Self::Twelve => [12, 12],
        }
    }
}

impl Calibrated {
    /// The larger of the focal lengths' standard deviations, relative to them.
    #[must_use]
    pub fn relative_focal_deviation(&self) -> f64 {
        let [x, y] = [0, 1].map(|i| self.deviations.focal[i] / self.lens.focal()[i]);
        x.max(y)
    }
}
