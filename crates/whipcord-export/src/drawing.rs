//! The curves and surfaces of an answer, for formats that draw.

use whipcord::{Along, Case, Pose, Robot, Section, Solution, Vec3};
use whipcord_plot::{ObstacleSurface, Plate, obstacle_surface, plates_of};

use crate::answers::Answers;
use crate::error::ExportError;
use crate::guides::{Guide, guides};
use crate::job::Job;

/// Radius of what has none, as a part of the length of the backbone.
pub const THIN: f64 = 0.002;
/// Room around the robot in which planes are drawn, relative to its greatest extent.
const ROOM: f64 = 0.4;

/// What is drawn of the answers to a case.
#[derive(Clone, Debug)]
pub struct Drawing<'a> {
    robot: &'a Robot,
    /// One for each disk; none for a robot without.
    pub plates: Vec<Plate>,
    /// Where each cable is held.
    held: Vec<Vec<Guide>>,
    /// The answers.
    pub answers: Answers,
}

impl<'a> Drawing<'a> {
    /// Solves the case of a job.
    ///
    /// # Errors
    /// [`ExportError::Solve`] where there is no answer.
    pub fn of(job: &Job<'a>, format: &'static str) -> Result<Self, ExportError> {
        let places = job.curve_places(format)?;
        let held = guides(job.robot, job.model.kind(), &places);
        let answers = job.solve(&places)?;
        Ok(Self { robot: job.robot, plates: plates_of(job.robot), held, answers })
    }

    /// The points of a cable in space, with the number of the station of each.
    pub fn cable(&self, solution: &Solution, cable: usize) -> Vec<(usize, Vec3)> {
        let point = |guide: &Guide| {
            let pose = solution.shape.poses.get(guide.place)?;
            Some((guide.place, pose.transform(guide.offset)))
        };
        self.held[cable].iter().filter_map(point).collect()
    }

    /// The disks with their poses.
    pub fn disks<'b>(&'b self, solution: &'b Solution) -> impl Iterator<Item = (&'b Plate, Pose)> {
        self.plates.iter().zip(solution.disks.poses.iter().copied())
    }

    /// The obstacles of a step by their names, movable ones where they are in its answer.
    pub fn obstacles<'b>(
        &self,
        case: &'b Case,
        solution: &'b Solution,
    ) -> impl Iterator<Item = (&'b str, ObstacleSurface)> {
        let points: Vec<Vec3> = solution.shape.positions().collect();
        let ranges = [0, 1, 2].map(|i| {
            let along = || points.iter().map(|p| p[i]);
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        });
        let extent = ranges.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        let room = [0, 1].map(|k| {
            let out = if k == 0 { -ROOM } else { ROOM };
            Vec3::from(ranges.map(|ends| ends[k] + out * extent))
        });
        case.obstacles.iter().enumerate().map(move |(number, obstacle)| {
            let moved = solution.objects.iter().find(|object| object.obstacle == number);
            let pose = moved.map_or(obstacle.pose, |object| object.pose);
            (obstacle.name.as_str(), obstacle_surface(&obstacle.form, &pose, room))
        })
    }

    /// Half extents of the cross-section along x and y at an arc length in m; `None` where it is round.
    pub fn bar(&self, arc_length: f64) -> Option<[f64; 2]> {
        let half = |along: &Along<f64>| 0.5 * along.at(self.robot.disks(), arc_length);
        match &self.robot.backbone().section {
            Some(Section::Rectangle { width, height }) => Some([half(width), half(height)]),
            _ => None,
        }
    }

    /// Radius in m of the circle around the cross-section, or a thin one where none is given.
    pub fn radius(&self, arc_length: f64) -> f64 {
        let given = self.robot.backbone().outer_radius_at(self.robot.disks(), arc_length);
        if given > 0.0 { given } else { self.thin() }
    }

    /// Radius in m of cables.
    pub fn thin(&self) -> f64 {
        THIN * self.robot.backbone().length
    }
}
