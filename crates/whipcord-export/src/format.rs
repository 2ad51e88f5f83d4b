//! The formats by their names.

use crate::error::ExportError;
use crate::files::Exported;
use crate::job::Job;
use crate::{gltf, mjcf, step, urdf, vtk};

/// A format of another program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// That of `MuJoCo`.
    Mjcf,
    /// That of ROS.
    Urdf,
    /// For `ParaView`.
    Vtk,
    /// For `Blender`, browsers and other viewers of three-dimensional scenes.
    Gltf,
    /// Curves and points for CAD.
    StepPoints,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Mjcf, Self::Urdf, Self::Vtk, Self::Gltf, Self::StepPoints];

    /// The name in commands.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Vtk => "vtk",
            Self::Gltf => "gltf",
            Self::StepPoints => "step-points",
        }
    }

    /// What the name of its first file ends in.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
            Self::Vtk => "pvd",
            Self::Gltf => "glb",
            Self::StepPoints => "step",
        }
    }

    /// The format of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }
}

/// Solves the case of a job and gives the files of a format, whose names begin with `stem`.
///
/// ```
/// use whipcord::{Actuation, Backbone, Cable, Case, Disks, Material, Model, ModelKind, Robot, Routing, Section, Stations};
/// use whipcord_export::{Format, Job, export};
///
/// let backbone = Backbone {
///     section: Some(Section::circle(0.003)),
///     material: Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() },
///     ..Backbone::new(0.18)
/// };
/// let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let model = Model::new(ModelKind::CosseratDisks, Stations::Disks, Actuation::Natural);
/// let job = Job {
///     title: "arm",
///     robot: &robot,
///     case: &Case::with_tensions(&[3.0]),
///     model: &model,
///     damping: &whipcord_motion::Damping::Time(0.01),
///     per_span: None,
/// };
/// let exported = export(&job, Format::Mjcf, "arm")?;
/// assert_eq!(exported.files[0].name, "arm.xml");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExportError`] where there is no answer, and for what the format cannot hold.
pub fn export(job: &Job<'_>, format: Format, stem: &str) -> Result<Exported, ExportError> {
    match format {
        Format::Mjcf => mjcf::mjcf(job, stem),
        Format::Urdf => urdf::urdf(job, stem),
        Format::Vtk => vtk::vtk(job, stem),
        Format::Gltf => gltf::gltf(job, stem),
        Format::StepPoints => step::step(job, stem),
    }
}
