//! What the robot is: backbone, disks and cables, checked once and then unchanging.

mod along;
mod backbone;
mod bending_friction;
mod cable;
mod disks;
mod error;
pub(crate) mod fourier;
pub mod limits;
mod motor;
mod motor_dynamics;
mod range;
pub(crate) mod route;
pub(crate) mod section;
mod segment;
mod stiffness;

use whipcord_numerics::{Vec3, integral};

pub use along::{Along, Linear};
pub use backbone::{Backbone, Material, RestCurvature};
pub use bending_friction::BendingFriction;
pub use cable::{Cable, HoleOffset, Interpolation, Routing};
pub use disks::Disks;
pub(crate) use error::check_on_backbone;
pub use error::{Problem, RobotError, in_words};
pub use motor::{Drive, DriveKeys, Motor, MotorCable, MotorLimits};
pub use motor_dynamics::MotorDynamics;
pub use route::{Route, RoutePoint};
pub use section::{Section, SectionProperties};
pub use segment::BackboneSegment;
pub use stiffness::{Stiffness, StiffnessMatrix};

/// A cable-driven continuum robot: valid by construction, and unchanging.
///
/// ```
/// use whipcord::{Backbone, Cable, Disks, Material, Robot, Routing, Section};
///
/// let backbone = Backbone {
///     section: Some(Section::circle(0.003)),
///     material: Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() },
///     ..Backbone::new(0.18)
/// };
/// let disks = Disks::equally_spaced(0.18, 10, 0.008).with_holes(12);
/// let cable = Cable::new("pull", Routing::holes(vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1]));
/// let robot = Robot::new(backbone, disks, vec![cable])?;
/// assert_eq!(robot.disks().arc_lengths.len(), 10);
/// # Ok::<(), whipcord::RobotError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Robot {
    backbone: Backbone,
    disks: Disks,
    cables: Vec<Cable>,
    routes: Vec<Route>,
    motors: Vec<Motor>,
    /// Of each cable.
    outside: Vec<motor::Outside>,
}

impl Robot {
    /// A robot of these parts.
    ///
    /// # Errors
    /// [`RobotError`] with the path of the offending quantity when a number is out of its range or
    /// the parts do not fit together.
    pub fn new(
        backbone: Backbone,
        mut disks: Disks,
        cables: Vec<Cable>,
    ) -> Result<Self, RobotError> {
        limits::check_count("cables", cables.len(), limits::MOST_CABLES)?;
        backbone.check(&disks)?;
        disks.check(backbone.length)?;
        disks.snap_to_ends(backbone.length);
        backbone.check_with(&disks)?;
        disks.check_thickness(|s| backbone.outer_radius_at(&disks, s))?;
        let mut routes = Vec::with_capacity(cables.len());
        for (index, cable) in cables.iter().enumerate() {
            if let Some(first) = cables[..index].iter().position(|c| c.name == cable.name) {
                return Err(RobotError::new(
                    format!("cables[{index}].name"),
                    Problem::DuplicateName { what: "cable", name: cable.name.clone(), first },
                ));
            }
            let route = Route::new(cable, &backbone, &disks)
                .map_err(|error| error.under(&format!("cables[{index}]")))?;
            routes.push(route);
        }
        let outside = motor::outside(&[], &cables);
        Ok(Self { backbone, disks, cables, routes, motors: Vec::new(), outside })
    }

    /// The same robot with these motors.
    ///
    /// ```
    /// # use whipcord::{Backbone, Cable, Disks, Robot, Routing};
    /// use whipcord::{Case, robot::Motor};
    ///
    /// # let straight = |name: &str, angle| Cable::new(name, Routing::Straight { angle, radius: 0.008 });
    /// # let cables = vec![straight("left", 0.0), straight("right", 3.14)];
    /// # let robot = Robot::new(Backbone::new(0.18), Disks::equally_spaced(0.18, 10, 0.008), cables)?;
    /// // One spool winds the left cable and pays the right one out.
    /// let motor = Motor { stiffness: Some(5e3), ..Motor::spool("bend", [(0, 0.01), (1, -0.01)]) };
    /// let robot = robot.with_motors(vec![motor])?;
    /// let case = Case::with_motors(&robot, &[0.5])?;
    /// assert_eq!(case.commands[1].shortening.map(|s| s.in_metres(0.18)), Some(-0.005));
    /// # Ok::<(), whipcord::RobotError>(())
    /// ```
    ///
    /// # Errors
    /// [`RobotError`] with the path of the quantity that cannot be.
    pub fn with_motors(self, motors: Vec<Motor>) -> Result<Self, RobotError> {
        motor::check(&motors, &self.cables)?;
        let outside = motor::outside(&motors, &self.cables);
        Ok(Self { motors, outside, ..self })
    }

    /// A robot of these parts, with the motors of this one.
    ///
    /// # Errors
    /// As [`Self::new`] and [`Self::with_motors`].
    pub fn with_parts(
        &self,
        backbone: Backbone,
        disks: Disks,
        cables: Vec<Cable>,
    ) -> Result<Self, RobotError> {
        Self::new(backbone, disks, cables)?.with_motors(self.motors.clone())
    }

    /// The backbone.
    #[must_use]
    pub fn backbone(&self) -> &Backbone {
        &self.backbone
    }

    /// The disks, base disk first, or the stations that stand for them where there are none.
    #[must_use]
    pub fn disks(&self) -> &Disks {
        &self.disks
    }

    /// Whether it has disks. A body without has cables in channels.
    #[must_use]
    pub fn has_disks(&self) -> bool {
        self.disks.are_present
    }

    /// Whether its backbone has friction against bending, so that answers depend on the steps before.
    #[must_use]
    pub const fn has_bending_friction(&self) -> bool {
        self.backbone.bending_friction.is_some()
    }

    /// Whether answers depend on the steps before: by friction of cables, or of the backbone against bending.
    #[must_use]
    pub fn has_history(&self) -> bool {
        self.has_bending_friction() || self.cables.iter().any(Cable::has_friction)
    }

    /// The cables.
    #[must_use]
    pub fn cables(&self) -> &[Cable] {
        &self.cables
    }

    /// The motors.
    #[must_use]
    pub fn motors(&self) -> &[Motor] {
        &self.motors
    }

    /// What a tension of 1 N in a cable adds to its length inside the robot in m, where it is so long at rest: the stretch of
    /// the cable inside, of the cable between motor and base, and of the drive.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn cable_compliance(&self, cable: usize, rest_length: f64) -> f64 {
        let stiffness = self.cables[cable].axial_stiffness;
        stiffness.map_or(0.0, |stiffness| rest_length / stiffness) + self.outside[cable].compliance
    }

    /// The same robot, whose cables give by this much in m under 1 N where they and their drives are rigid.
    #[must_use]
    pub fn giving(&self, compliance: f64) -> Self {
        let mut giving = self.clone();
        for cable in 0..self.cables.len() {
            if !self.is_elastic(cable) {
                giving.outside[cable].compliance = compliance;
            }
        }
        giving
    }

    /// The part of [`Self::cable_compliance`] that lies outside the robot.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn outside_compliance(&self, cable: usize) -> f64 {
        self.outside[cable].compliance
    }

    /// The tension in N of a cable at which it has the length that shortenings count from: the pretension of its motor.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn pretension(&self, cable: usize) -> f64 {
        self.outside[cable].pretension
    }

    /// By how much in m a cable that is so long at rest, and its drive, are longer under a tension than where shortenings count from.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn cable_stretch(&self, cable: usize, rest_length: f64, tension: f64) -> f64 {
        self.cable_compliance(cable, rest_length) * (tension - self.pretension(cable))
    }

    /// The motor that pulls a cable, by its number.
    #[must_use]
    pub fn motor_of(&self, cable: usize) -> Option<usize> {
        let pulls = |motor: &Motor| motor.cables.iter().any(|of| of.cable == cable);
        self.motors.iter().position(pulls)
    }

    /// The quantity by which a cable stretches, in the terms of the robot file; `None` where it does not.
    pub(crate) fn path_of_stretch(&self, cable: usize) -> Option<String> {
        if self.cables[cable].axial_stiffness.is_some() {
            return Some(format!("cables[{cable}].axial_stiffness"));
        }
        let motor = self.motor_of(cable)?;
        self.motors[motor].stiffness.map(|_| format!("motors[{motor}].stiffness"))
    }

    /// Whether a cable or its drive stretches.
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn is_elastic(&self, cable: usize) -> bool {
        self.cables[cable].axial_stiffness.is_some() || self.outside[cable].compliance > 0.0
    }

    /// In which part it differs from another robot: `backbone`, `disks`, `cables` or `motors`; `None` where the two are one.
    #[must_use]
    pub fn differs_in(&self, other: &Self) -> Option<&'static str> {
        let parts = [
            ("backbone", self.backbone != other.backbone),
            ("disks", self.disks != other.disks),
            ("cables", self.cables != other.cables),
            ("motors", self.motors != other.motors),
        ];
        parts.into_iter().find_map(|(part, differs)| differs.then_some(part))
    }

    /// Where each cable runs in the backbone's cross-sections; one for each of [`Self::cables`].
    #[must_use]
    pub fn routes(&self) -> &[Route] {
        &self.routes
    }

    /// Length in m of the part of a cable inside the robot at rest, where the cable follows the curve of its
    /// routing. A cable that runs straight from hole to hole is no longer than that.
    #[must_use]
    pub fn cable_length(&self, cable: usize) -> f64 {
        let Some(route) = self.routes.get(cable) else { return 0.0 };
        let mut places = vec![0.0];
        places.extend_from_slice(route.breakpoints());
        places.push(route.end());
        self.rest_length(cable, &places)
    }

    /// Length in m of a cable on the rod at rest: by quadrature between the breakpoints.
    pub(crate) fn rest_length(&self, cable: usize, breakpoints: &[f64]) -> f64 {
        /// What a rule of order 10 changes when its pieces are halved is a thousand times what is left.
        const CHANGE: f64 = 1e-11;
        let route = &self.routes[cable];
        let stretch = |s: f64| {
            let point = route.at(s);
            let u = self.backbone.rest_curvature_at(&self.disks, s);
            (Vec3::Z + u.cross(point.offset) + point.slope).norm()
        };
        let reached = breakpoints.partition_point(|&s| s <= route.end());
        let pieces = breakpoints[..reached].windows(2);
        pieces.map(|pair| integral(&stretch, [pair[0], pair[1]], CHANGE)).sum()
    }
}
