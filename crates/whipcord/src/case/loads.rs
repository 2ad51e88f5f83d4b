//! What acts on a robot from outside.

use whipcord_numerics::{UnitQuaternion, Vec3};

use crate::robot::{Problem, RobotError, check_on_backbone, limits};

/// External loads. Directions are those of [`Loads::frame`], or of the cross-section where a load
/// follows the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loads {
    /// The frame that gravity and all loads that do not follow the body are given in.
    pub frame: LoadFrame,
    /// Acceleration of gravity in m/s². It acts on the backbone, the disks and [`Loads::masses`].
    pub gravity: Option<Vec3>,
    /// Force at the backbone's tip in N.
    pub tip_force: Vec3,
    /// Moment at the backbone's tip in N·m.
    pub tip_moment: Vec3,
    /// Whether tip force and tip moment turn with the tip.
    pub tip_follower: bool,
    /// Forces and moments along the backbone.
    pub points: Vec<PointLoad>,
    /// Forces and moments spread along the backbone.
    pub distributed: Vec<DistributedLoad>,
    /// What the robot carries besides its own weight.
    pub masses: Vec<PointMass>,
}

/// A frame that the directions of loads are given in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LoadFrame {
    /// That of the robot's base: the loads turn with [`crate::Case::base`].
    #[default]
    Base,
    /// That in which the pose of the base is given.
    World,
}

/// A force and a moment at one place of the backbone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointLoad {
    /// Arc length in m.
    pub at: f64,
    /// Force in N.
    pub force: Vec3,
    /// Moment in N·m.
    pub moment: Vec3,
    /// Whether they turn with the cross-section.
    pub follower: bool,
}

/// A mass at one place of the backbone's axis, such as a camera or a gripper. Only its weight acts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointMass {
    /// Arc length in m.
    pub at: f64,
    /// Mass in kg.
    pub mass: f64,
}

/// A force and a moment spread along the backbone, for each metre of its undeformed length.
#[derive(Clone, Debug, PartialEq)]
pub struct DistributedLoad {
    /// How they vary along the backbone.
    pub profile: Profile,
    /// Whether they turn with the cross-sections.
    pub follower: bool,
}

/// How a distributed load varies along the backbone.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// The same everywhere on a stretch.
    Constant {
        /// Arc length in m at which the stretch begins.
        from: f64,
        /// Arc length in m at which it ends.
        to: f64,
        /// Force in N/m.
        force: Vec3,
        /// Moment in N·m/m.
        moment: Vec3,
    },
    /// Given at stations and linear between them; none beyond the first and the last.
    Linear {
        /// Arc lengths of the stations in m, increasing; at least two.
        at: Vec<f64>,
        /// Force at each in N/m; empty where there is none.
        force: Vec<Vec3>,
        /// Moment at each in N·m/m; empty where there is none.
        moment: Vec<Vec3>,
    },
}

/// Least length of a stretch or a piece of a profile, as a fraction of the backbone's: shorter ones
/// are point loads.
const LEAST_PIECE: f64 = 1e-9;

impl PointLoad {
    fn check(&self, length: f64) -> Result<(), RobotError> {
        check_on_backbone("at", self.at, length)?;
        limits::FORCE.check_vector("force", self.force)?;
        limits::MOMENT.check_vector("moment", self.moment)
    }

    fn acts(&self) -> bool {
        self.force != Vec3::ZERO || self.moment != Vec3::ZERO
    }
}

impl PointMass {
    fn check(&self, length: f64) -> Result<(), RobotError> {
        check_on_backbone("at", self.at, length)?;
        limits::MASS.check("mass", self.mass)
    }
}

impl DistributedLoad {
    /// A dead force in N/m, the same all along a backbone of this length.
    #[must_use]
    pub fn uniform(length: f64, force: Vec3) -> Self {
        let profile = Profile::Constant { from: 0.0, to: length, force, moment: Vec3::ZERO };
        Self { profile, follower: false }
    }

    /// The same load, turning with the cross-sections.
    #[must_use]
    pub fn following(self) -> Self {
        Self { follower: true, ..self }
    }

    fn check(&self, length: f64) -> Result<(), RobotError> {
        let (force, moment) = (limits::LINE_FORCE, limits::LINE_MOMENT);
        let behind = |path: String, value: f64, previous: f64| {
            let least = LEAST_PIECE * length;
            if value <= previous {
                Err(RobotError::new(path, Problem::NotIncreasing { value, previous }))
            } else if value - previous < least {
                let stretch = value - previous;
                Err(RobotError::new(path, Problem::TooShort { stretch, least }))
            } else {
                Ok(())
            }
        };
        match &self.profile {
            Profile::Constant { from, to, force: f, moment: m } => {
                check_on_backbone("from", *from, length)?;
                check_on_backbone("to", *to, length)?;
                // The end of the stretch may be the default: the start is the one that is given.
                let path = if *from >= length { "from" } else { "to" };
                behind(path.to_owned(), *to, *from)?;
                force.check_vector("force", *f)?;
                moment.check_vector("moment", *m)
            }
            Profile::Linear { at, force: forces, moment: moments } => {
                if at.len() < 2 {
                    return Err(RobotError::new(
                        "at",
                        Problem::TooFew { given: at.len(), least: 2 },
                    ));
                }
                for (i, &s) in at.iter().enumerate() {
                    let path = format!("at[{i}]");
                    check_on_backbone(&path, s, length)?;
                    if i > 0 {
                        behind(path, s, at[i - 1])?;
                    }
                }
                for (key, range, values) in [("force", force, forces), ("moment", moment, moments)]
                {
                    if !values.is_empty() && values.len() != at.len() {
                        let problem =
                            Problem::StationCount { given: values.len(), expected: at.len() };
                        return Err(RobotError::new(key, problem));
                    }
                    for (i, &value) in values.iter().enumerate() {
                        range.check_vector(&format!("{key}[{i}]"), value)?;
                    }
                }
                Ok(())
            }
        }
    }

    fn acts(&self) -> bool {
        self.profile.pieces().any(|p| p.force != [Vec3::ZERO; 2] || p.moment != [Vec3::ZERO; 2])
    }
}

/// A part of a profile along which it is linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Arc lengths of its ends in m.
    pub at: [f64; 2],
    /// Force at its ends in N/m.
    pub force: [Vec3; 2],
    /// Moment at its ends in N·m/m.
    pub moment: [Vec3; 2],
}

impl Profile {
    /// The parts along which it is linear, from the base on.
    pub fn pieces(&self) -> impl Iterator<Item = Piece> + '_ {
        let count = match self {
            Self::Constant { .. } => 1,
            Self::Linear { at, .. } => at.len().saturating_sub(1),
        };
        (0..count).map(|i| match self {
            Self::Constant { from, to, force, moment } => {
                Piece { at: [*from, *to], force: [*force; 2], moment: [*moment; 2] }
            }
            Self::Linear { at, force, moment } => {
                let ends = |values: &[Vec3]| {
                    [i, i + 1].map(|j| values.get(j).copied().unwrap_or(Vec3::ZERO))
                };
                Piece { at: [at[i], at[i + 1]], force: ends(force), moment: ends(moment) }
            }
        })
    }

    /// Arc lengths in m at which it begins, has a corner or ends.
    pub fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        let count = match self {
            Self::Constant { .. } => 2,
            Self::Linear { at, .. } => at.len(),
        };
        (0..count).map(|i| match self {
            Self::Constant { from, to, .. } => [*from, *to][i],
            Self::Linear { at, .. } => at[i],
        })
    }
}

impl Loads {
    /// Whether there is no load at all.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.gravity.is_none_or(|g| g == Vec3::ZERO)
            && self.tip_force == Vec3::ZERO
            && self.tip_moment == Vec3::ZERO
            && !self.points.iter().any(PointLoad::acts)
            && !self.distributed.iter().any(DistributedLoad::acts)
    }

    /// Whether a load turns with the backbone. Such loads have no energy.
    #[must_use]
    pub fn has_follower(&self) -> bool {
        (self.tip_follower && (self.tip_force != Vec3::ZERO || self.tip_moment != Vec3::ZERO))
            || self.points.iter().any(|p| p.follower && p.acts())
            || self.distributed.iter().any(|load| load.follower && load.acts())
    }

    /// Whether a moment keeps its direction in space. Such moments have no energy where their sections can turn.
    pub(crate) fn has_dead_moment(&self) -> bool {
        let of_line = |load: &DistributedLoad| {
            let turns = |piece: Piece| piece.moment.iter().any(|&moment| moment != Vec3::ZERO);
            !load.follower && load.profile.pieces().any(turns)
        };
        (!self.tip_follower && self.tip_moment != Vec3::ZERO)
            || self.points.iter().any(|p| !p.follower && p.moment != Vec3::ZERO)
            || self.distributed.iter().any(of_line)
    }

    /// The first of these loads that acts: its path in the terms of the robot file, and what it is.
    pub(crate) fn first(&self) -> Option<(String, &'static str)> {
        if self.gravity.is_some_and(|g| g != Vec3::ZERO) {
            Some(("loads.gravity".to_owned(), "weight"))
        } else if self.tip_force != Vec3::ZERO {
            Some(("loads.tip_force".to_owned(), "a force"))
        } else if self.tip_moment != Vec3::ZERO {
            Some(("loads.tip_moment".to_owned(), "a moment"))
        } else if let Some(i) = self.points.iter().position(PointLoad::acts) {
            Some((format!("loads.point[{i}]"), "a force or moment"))
        } else {
            let i = self.distributed.iter().position(DistributedLoad::acts)?;
            Some((format!("loads.distributed[{i}]"), "a distributed force or moment"))
        }
    }

    /// Arc lengths in m of all places at which a load begins, ends or sits, in a fixed order: point
    /// loads, masses, knots of distributed loads.
    pub(crate) fn places(&self) -> impl Iterator<Item = f64> + '_ {
        let points = self.points.iter().map(|point| point.at);
        let masses = self.masses.iter().map(|mass| mass.at);
        points.chain(masses).chain(self.distributed.iter().flat_map(|load| load.profile.knots()))
    }

    /// The rotation from [`Loads::frame`] to the world, in which the base is turned by `base`.
    #[must_use]
    pub fn to_world(&self, base: UnitQuaternion) -> UnitQuaternion {
        match self.frame {
            LoadFrame::Base => base,
            LoadFrame::World => UnitQuaternion::IDENTITY,
        }
    }

    /// The rotation from [`Loads::frame`] to the frame of a base that is turned by `base`.
    pub(crate) fn to_base(&self, base: UnitQuaternion) -> UnitQuaternion {
        match self.frame {
            LoadFrame::Base => UnitQuaternion::IDENTITY,
            LoadFrame::World => base.conjugate(),
        }
    }

    pub(super) fn check(&self, length: f64) -> Result<(), RobotError> {
        if let Some(gravity) = self.gravity {
            limits::ACCELERATION.check_vector("loads.gravity", gravity)?;
        }
        limits::FORCE.check_vector("loads.tip_force", self.tip_force)?;
        limits::MOMENT.check_vector("loads.tip_moment", self.tip_moment)?;
        let named = |list: &'static str, i: usize| {
            move |error: RobotError| error.under(&format!("loads.{list}[{i}]"))
        };
        for (i, point) in self.points.iter().enumerate() {
            point.check(length).map_err(named("point", i))?;
        }
        for (i, load) in self.distributed.iter().enumerate() {
            load.check(length).map_err(named("distributed", i))?;
        }
        for (i, mass) in self.masses.iter().enumerate() {
            mass.check(length).map_err(named("mass", i))?;
        }
        Ok(())
    }
}
