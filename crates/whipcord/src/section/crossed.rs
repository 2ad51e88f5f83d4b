//! A cross-section of a robot with the cables that cross it, in equilibrium with their tensions alone.

use whipcord_numerics::Vec3;

use super::crossing::{BodyWrench, Crossing};
use super::equilibrium::equilibrium;
use super::of_robot::section_at;
use super::properties::{Section, Stiffness};
use crate::error::SolveError;
use crate::robot::Robot;

/// A cross-section of a Cosserat rod without loads, and the cables that run through it.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossedSection {
    section: Section,
    crossings: Vec<Crossing>,
    cables: Vec<usize>,
}

impl CrossedSection {
    /// At an arc length in m that is no end of a cable.
    ///
    /// # Errors
    /// [`SolveError::Missing`] where the stiffness is not given and section, Young's modulus or shear modulus is not either.
    pub fn of(robot: &Robot, arc_length: f64) -> Result<Self, SolveError> {
        let section = section_at(robot, arc_length, arc_length)?;
        let routes = robot.routes().iter().enumerate();
        let (cables, crossings) = routes
            .filter(|(_, route)| route.end() > arc_length)
            .map(|(cable, route)| {
                let point = route.at(arc_length);
                (cable, Crossing::new(point.offset, point.slope))
            })
            .unzip();
        Ok(Self { section, crossings, cables })
    }

    /// Whether stiffness, rest curvature and cables are those of another one but for a small part of each.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        /// That part.
        const PART: f64 = 1e-6;
        let near = |a: Vec3, b: Vec3| (a - b).norm() <= PART * a.norm().max(b.norm());
        let (a, b) = (&self.section, &other.section);
        let Stiffness { shear, bending } = a.stiffness;
        let crossings = self.crossings.iter().zip(&other.crossings);
        self.cables == other.cables
            && near(shear, b.stiffness.shear)
            && near(bending, b.stiffness.bending)
            && a.compliance.shear.to_array().map(|of| of == 0.0)
                == b.compliance.shear.to_array().map(|of| of == 0.0)
            && near(a.rest_curvature, b.rest_curvature)
            && a.beside == b.beside
            && crossings.into_iter().all(|(a, b)| {
                // A slope is a part of the tangent.
                near(a.offset, b.offset) && near(a.slope + Vec3::Z, b.slope + Vec3::Z)
            })
    }

    /// The cables that cross the section, with their offsets from the backbone in m.
    pub fn cables(&self) -> impl Iterator<Item = (usize, Vec3)> + '_ {
        self.cables.iter().copied().zip(self.crossings.iter().map(|crossing| crossing.offset))
    }

    /// The equilibrium under the tensions in N of all cables of the robot: writes the stretch of each cable that crosses the section and what it exerts under 1 N, force and
    /// moment in the frame of the section, beside what is there already for the others, and returns the strains `v` and `u`. `None` where a cable would be compressed to nothing.
    pub fn pulls(
        &self,
        tensions: &[f64],
        stretches: &mut [f64],
        pulls: &mut [[Vec3; 2]],
    ) -> Option<[Vec3; 2]> {
        let mut strain = self.section.rest_strain();
        // There are seldom more cables than that.
        let mut few = [0.0; 16];
        let mut many = Vec::new();
        let own: &mut [f64] = match few.get_mut(..self.cables.len()) {
            Some(few) => few,
            None => {
                many.resize(self.cables.len(), 0.0);
                &mut many
            }
        };
        own.iter_mut().zip(&self.cables).for_each(|(own, &cable)| *own = tensions[cable]);
        let none = BodyWrench::default();
        equilibrium(&self.section, &self.crossings, own, none, &mut strain).ok()?;
        for (&cable, crossing) in self.cables.iter().zip(&self.crossings) {
            let (BodyWrench { linear, angular }, stretch) = crossing.pull(&strain);
            stretches[cable] = stretch;
            pulls[cable] = [linear, angular];
        }
        Some([strain.linear, strain.angular])
    }
}
