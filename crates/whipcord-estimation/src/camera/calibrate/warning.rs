use thiserror::Error;

use super::calibrated::{Calibrated, FreeParameters};
use crate::camera::locate::Sighting;

/// What speaks against relying on a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CalibrationWarning {
    /// Few photographs.
    #[error("only {given} photographs show the board: take {advised} or more")]
    FewPhotographs {
        /// Photographs.
        given: usize,
        /// As many as there should be.
        advised: usize,
    },
    /// All boards are much the same way up.
    #[error(
        "the boards are tilted by no more than {:.0}° to one another: tilt the board to the camera by some 30°, differently in each photograph",
        tilt.to_degrees()
    )]
    LittleTilt {
        /// Greatest angle between the planes of two boards in rad.
        tilt: f64,
    },
    /// The focal length is not well known.
    #[error("the focal length is only known to ±{:.1} %", 100.0 * relative)]
    LooseFocalLength {
        /// Its standard deviation, relative to it.
        relative: f64,
    },
    /// Nothing was seen near the corners of the image.
    #[error(
        "the board was only seen up to {:.0} % of the way from the middle of the image to its corners: what the lens does beyond is a guess",
        100.0 * share
    )]
    EdgesUnseen {
        /// Of the way from the principal point to the farthest corner of the image.
        share: f64,
    },
    /// One photograph is much worse than the others.
    #[error(
        "photograph {} is off by {rms:.2} pixels RMS, most by {others:.2}: leave it out, or look at it",
        view + 1
    )]
    Outlier {
        /// Number of the photograph, from 0.
        view: usize,
        /// What is left of it, in pixels.
        rms: f64,
        /// The median of all photographs.
        others: f64,
    },
}

impl CalibrationWarning {
    /// The same, of a photograph that has another number.
    #[must_use]
    pub fn renumbered(self, number: impl FnOnce(usize) -> usize) -> Self {
        match self {
            Self::Outlier { view, rms, others } => {
                Self::Outlier { view: number(view), rms, others }
            }
            other => other,
        }
    }
}

impl Calibrated {
    /// What speaks against relying on it: too little in the photographs, of images of this size, that it was
    /// had from.
    #[must_use]
    pub fn warnings(&self, size: [u32; 2], views: &[Vec<Sighting>]) -> Vec<CalibrationWarning> {
        const ADVISED: usize = 8;
        const TILT: f64 = 20.0;
        const FOCAL: f64 = 0.01;
        const EDGES: f64 = 0.6;
        let mut warnings = Vec::new();
        if views.len() < ADVISED {
            warnings
                .push(CalibrationWarning::FewPhotographs { given: views.len(), advised: ADVISED });
        }
        if self.tilt < f64::to_radians(TILT) {
            warnings.push(CalibrationWarning::LittleTilt { tilt: self.tilt });
        }
        let relative = self.relative_focal_deviation();
        if relative > FOCAL {
            warnings.push(CalibrationWarning::LooseFocalLength { relative });
        }
        let [cx, cy] = self.lens.centre();
        let way = |[u, v]: [f64; 2]| (u - cx).hypot(v - cy);
        let [width, height] = size.map(|n| f64::from(n) - 1.0);
        let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
        let farthest = corners.into_iter().map(way).fold(0.0, f64::max);
        let seen = views.iter().flatten().map(|at| way(at.pixel)).fold(0.0, f64::max);
        if self.free_parameters != FreeParameters::None && seen < EDGES * farthest {
            warnings.push(CalibrationWarning::EdgesUnseen { share: seen / farthest });
        }
        let mut sorted = self.view_rms.clone();
        sorted.sort_by(f64::total_cmp);
        let others = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        for (view, &rms) in self.view_rms.iter().enumerate() {
            if rms > 3.0 * others && rms > 0.1 {
                warnings.push(CalibrationWarning::Outlier { view, rms, others });
            }
        }
        warnings
    }
}
