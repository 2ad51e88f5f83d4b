//! How a camera maps the world to its image: eq. (c1) to (c6) of `docs/theory/cameras.md`.
//!
//! The camera's frame has its origin at the centre of projection, x to the right of the image, y
//! down and z along the view. Pixels are (column, row), and the centre of the first pixel is (0, 0),
//! as in OpenCV.

mod calibrate;
mod deflation;
mod distortion;
mod error;
mod lens;
mod locate;
mod pose_uncertainty;
mod reprojection_error;
mod stereo;
mod triangulate;
mod view;

pub use calibrate::{
    CalibrateError, Calibrated, CalibrationWarning, FreeParameters, LensDeviations, calibrate,
};
pub use distortion::Distortion;
pub use error::{CameraError, ViewError};
pub use lens::{LENS_PARAMETERS, Lens, Orthographic, Pinhole};
pub use locate::{
    Alternative, LocateError, Located, LocatedRig, PoseUncertainty, Sighting, locate,
    locate_orthographic, locate_rig, pose_deviations,
};
pub use pose_uncertainty::{PoseByLens, PoseCovariance};
pub use reprojection_error::ReprojectionError;
pub use stereo::{
    RefusedPair, SeenByBoth, StereoCalibration, StereoError, StereoPair, calibrate_stereo,
};
pub use triangulate::{
    MatchError, Matched, TriangulateError, Triangulated, match_in_order, triangulate,
};
pub use view::{Camera, Projection, Ray};
