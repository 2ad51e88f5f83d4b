//! The loads on one shape of the robot: what acts where, and how strong it is.

use whipcord::{Case, Pose, Profile, Shape, Vec3};

use crate::error::{PlotError, finite};
use crate::unit;

/// The loads of a case on one shape of the robot, in the frame of that shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Acting {
    pub(crate) single: Vec<Single>,
    pub(crate) spread: Vec<Spread>,
    pub(crate) masses: Vec<Carried>,
    /// In m/s².
    pub(crate) gravity: Option<Vec3>,
}

/// What a vector stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Force,
    Moment,
}

/// A force in N or a moment in N·m at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Single {
    pub kind: Kind,
    pub at: Vec3,
    pub vector: Vec3,
    /// Whether it turns with the cross-section.
    pub follows: bool,
    /// Whether it presses against the end of the backbone.
    pub presses: bool,
}

/// A force in N/m or a moment in N·m/m along a stretch: places, and the vectors there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spread {
    pub kind: Kind,
    pub places: Vec<(Vec3, Vec3)>,
    pub follows: bool,
}

/// A mass in kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carried {
    pub at: Vec3,
    pub mass: f64,
}

/// Places along a load that is spread over the whole backbone.
const PLACES: f64 = 16.0;
/// A force presses against the tip where less than this part of it, as a cosine, pulls at it.
const PRESSES: f64 = -0.5;

impl Acting {
    /// What acts in this case, where this shape, dense or not, takes it.
    #[must_use]
    pub fn on(case: &Case, shape: &Shape) -> Self {
        let (Some(&length), true) = (shape.arc_length.last(), shape.poses.len() > 1) else {
            return Self::default();
        };
        let loads = &case.loads;
        let frame = loads.to_world(case.base.rotation);
        let turned = |vector: Vec3, at: &Pose, follows: bool| {
            if follows { at.rotation.rotate(vector) } else { frame.rotate(vector) }
        };
        let mut acting = Self {
            gravity: loads.gravity.filter(|&g| g != Vec3::ZERO).map(|g| frame.rotate(g)),
            ..Self::default()
        };
        let tip = (length, loads.tip_force, loads.tip_moment, loads.tip_follower);
        let points = loads.points.iter().map(|p| (p.at, p.force, p.moment, p.follower));
        for (s, force, moment, follows) in std::iter::once(tip).chain(points) {
            let pose = shape.at(s);
            for (kind, vector) in [(Kind::Force, force), (Kind::Moment, moment)] {
                if vector != Vec3::ZERO {
                    let vector = turned(vector, &pose, follows);
                    let along = pose.rotation.rotate(Vec3::Z).dot(vector);
                    let presses =
                        kind == Kind::Force && s >= length && along < PRESSES * vector.norm();
                    acting.single.push(Single {
                        kind,
                        at: pose.position,
                        vector,
                        follows,
                        presses,
                    });
                }
            }
        }
        for load in &loads.distributed {
            for kind in [Kind::Force, Kind::Moment] {
                let places = along(&load.profile, length, kind).into_iter().map(|(s, vector)| {
                    let pose = shape.at(s);
                    (pose.position, turned(vector, &pose, load.follower))
                });
                let places: Vec<_> = places.collect();
                if places.iter().any(|(_, vector)| *vector != Vec3::ZERO) {
                    acting.spread.push(Spread { kind, places, follows: load.follower });
                }
            }
        }
        let masses = loads.masses.iter().filter(|m| m.mass > 0.0);
        acting.masses =
            masses.map(|m| Carried { at: shape.at(m.at).position, mass: m.mass }).collect();
        acting
    }

    pub(crate) fn check(&self) -> Result<(), PlotError> {
        let single = self.single.iter().flat_map(|load| [load.at, load.vector]);
        let spread = self.spread.iter().flat_map(|load| &load.places).flat_map(|&(a, v)| [a, v]);
        let masses = self.masses.iter().map(|mass| mass.at);
        for vector in single.chain(spread).chain(masses).chain(self.gravity) {
            for value in vector.to_array() {
                finite(|| "a load".to_owned(), value)?;
            }
        }
        self.masses.iter().try_for_each(|mass| finite(|| "a mass".to_owned(), mass.mass))
    }

    /// Size of the largest single load of this kind.
    pub(crate) fn largest_single(&self, kind: Kind) -> f64 {
        let sizes = self.single.iter().filter(|load| load.kind == kind);
        sizes.map(|load| load.vector.norm()).fold(0.0, f64::max)
    }

    /// Largest size of a spread load of this kind.
    pub(crate) fn largest_spread(&self, kind: Kind) -> f64 {
        let loads = self.spread.iter().filter(|load| load.kind == kind);
        loads.flat_map(|load| &load.places).map(|(_, v)| v.norm()).fold(0.0, f64::max)
    }

    /// Every kind of load that there is: kind, whether it follows, how many there are, and the
    /// largest, with its unit.
    pub(crate) fn single_kinds(&self) -> impl Iterator<Item = (Kind, bool, String)> + '_ {
        kinds().filter_map(|(kind, follows)| {
            let loads = self.single.iter().filter(|l| l.kind == kind && l.follows == follows);
            let sizes: Vec<f64> = loads.map(|load| load.vector.norm()).collect();
            let (one, many, unit) = match kind {
                Kind::Force => ("force", "forces", unit::force as fn(f64) -> unit::Unit),
                Kind::Moment => ("moment", "moments", unit::moment as fn(f64) -> unit::Unit),
            };
            let words = sized(&sizes, one, many, unit)?;
            Some((kind, follows, words))
        })
    }

    /// The same of loads that are spread.
    pub(crate) fn spread_kinds(&self) -> impl Iterator<Item = (Kind, bool, String)> + '_ {
        kinds().filter_map(|(kind, follows)| {
            let loads = self.spread.iter().filter(|l| l.kind == kind && l.follows == follows);
            let sizes = loads.flat_map(|load| &load.places).map(|(_, v)| v.norm());
            let sizes: Vec<f64> = sizes.collect();
            let (name, unit) = match kind {
                Kind::Force => ("load", unit::line_force as fn(f64) -> unit::Unit),
                Kind::Moment => ("line moment", unit::line_moment as fn(f64) -> unit::Unit),
            };
            Some((kind, follows, sized(&sizes, name, name, unit)?))
        })
    }

    /// The masses in words.
    pub(crate) fn masses_in_words(&self) -> Option<String> {
        let sizes: Vec<f64> = self.masses.iter().map(|mass| mass.mass).collect();
        sized(&sizes, "mass", "masses", unit::mass)
    }
}

fn kinds() -> impl Iterator<Item = (Kind, bool)> {
    [Kind::Force, Kind::Moment].into_iter().flat_map(|kind| [(kind, false), (kind, true)])
}

/// `force 20 mN`, `forces up to 3 N`; none of none.
fn sized(sizes: &[f64], one: &str, many: &str, unit: fn(f64) -> unit::Unit) -> Option<String> {
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let least = sizes.iter().copied().fold(largest, f64::min);
    let name = if sizes.len() == 1 { one } else { many };
    let same = largest - least <= 1e-9 * largest;
    let words = if same { "" } else { "up to " };
    (!sizes.is_empty()).then(|| format!("{name} {words}{}", unit::written(largest, unit(largest))))
}

/// Arc lengths and vectors of a profile: evenly, and at its corners.
fn along(profile: &Profile, length: f64, kind: Kind) -> Vec<(f64, Vec3)> {
    let mut places = Vec::new();
    for piece in profile.pieces() {
        let [from, to] = piece.at;
        let [a, b] = match kind {
            Kind::Force => piece.force,
            Kind::Moment => piece.moment,
        };
        let parts = (PLACES * (to - from) / length).ceil().clamp(1.0, PLACES);
        let first = if places.is_empty() { 0 } else { 1 };
        for k in first..=parts as usize {
            let t = k as f64 / parts;
            places.push((from * (1.0 - t) + to * t, a * (1.0 - t) + b * t));
        }
    }
    places
}
