//! The obstacles as the base sees them.

use whipcord_numerics::{Pose, Vec3};

use crate::case::Case;
use crate::obstacle::{Form, Obstacle};

/// Which obstacles count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Present {
    All,
    /// Those that the robot is inserted into.
    Pipes,
    None,
}

/// The obstacles in the frame of a base that may be drawn back along its axis.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    /// As the base sees them where the case has it.
    there: Vec<Obstacle>,
    /// As it sees them where it is.
    obstacles: Vec<Obstacle>,
    present: Present,
    drawn_back: f64,
    /// By how much when the step on the way began.
    began_at: f64,
    /// Where the obstacles were then, as the base sees them where the case has it.
    began: Vec<Pose>,
}

impl Scene {
    pub fn new(case: &Case) -> Self {
        let to_base = case.base.inverse();
        let seen =
            |obstacle: &Obstacle| Obstacle { pose: to_base * obstacle.pose, ..obstacle.clone() };
        let there: Vec<Obstacle> = case.obstacles.iter().map(seen).collect();
        Self {
            began: there.iter().map(|obstacle| obstacle.pose).collect(),
            obstacles: there.clone(),
            there,
            present: Present::All,
            drawn_back: 0.0,
            began_at: 0.0,
        }
    }

    /// Puts an obstacle that moves to where it is, as the base sees it where the case has it.
    pub fn place(&mut self, number: usize, pose: Pose) {
        let forward = Pose { position: Vec3::Z * self.drawn_back, ..Pose::IDENTITY };
        self.obstacles[number].pose = forward * pose;
        self.there[number].pose = pose;
    }

    /// A pose of when the step began, carried along since with an obstacle that moves.
    pub fn carry(&self, number: usize, pose: Pose) -> Pose {
        match self.motion(number) {
            Some([began, there]) => there * (began.inverse() * pose),
            None => pose,
        }
    }

    /// A point likewise.
    pub fn carry_point(&self, number: usize, point: Vec3) -> Vec3 {
        match self.motion(number) {
            Some([began, there]) => there.transform(began.inverse().transform(point)),
            None => point,
        }
    }

    /// Where an obstacle was when the step began, and where it is now, if it moves.
    fn motion(&self, number: usize) -> Option<[Pose; 2]> {
        let Obstacle { pose, movable, .. } = &self.there[number];
        let began = self.began[number];
        (movable.is_some() || *pose != began).then_some([began, *pose])
    }

    /// Takes the friction of all obstacles away, or gives it back.
    pub fn rub(&mut self, does: bool) {
        for (seen, there) in self.obstacles.iter_mut().zip(&self.there) {
            seen.friction = if does { there.friction } else { 0.0 };
        }
    }

    /// Draws the base back by so many metres.
    pub fn draw_back(&mut self, by: f64) {
        self.drawn_back = by;
        let forward = Pose { position: Vec3::Z * by, ..Pose::IDENTITY };
        for (seen, there) in self.obstacles.iter_mut().zip(&self.there) {
            seen.pose = forward * there.pose;
        }
    }

    /// By how many metres the base is drawn back.
    pub fn drawn_back(&self) -> f64 {
        self.drawn_back
    }

    /// A step on the way begins.
    pub fn begin_step(&mut self) {
        self.began_at = self.drawn_back;
        self.began.clear();
        self.began.extend(self.there.iter().map(|obstacle| obstacle.pose));
    }

    /// A pose of when the step began, carried along with the obstacles since.
    pub fn carried(&self, pose: Pose) -> Pose {
        Pose { position: self.carried_point(pose.position), ..pose }
    }

    /// A point likewise.
    pub fn carried_point(&self, point: Vec3) -> Vec3 {
        point + Vec3::Z * (self.drawn_back - self.began_at)
    }

    /// Leaves out all obstacles but these.
    pub fn keep(&mut self, present: Present) {
        self.present = present;
    }

    pub fn count(&self) -> usize {
        self.obstacles.len()
    }

    pub fn get(&self, number: usize) -> &Obstacle {
        &self.obstacles[number]
    }

    /// Direction of the axis of a cylinder or a capsule.
    pub fn axis(&self, number: usize) -> Option<Vec3> {
        let obstacle = self.get(number);
        matches!(obstacle.form, Form::Cylinder { .. } | Form::Capsule { .. })
            .then(|| obstacle.pose.rotation.rotate(Vec3::Z))
    }

    /// The obstacles that count now, with their numbers.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &Obstacle)> {
        let counts = |obstacle: &Obstacle| match self.present {
            Present::All => true,
            Present::Pipes => is_pipe(obstacle),
            Present::None => false,
        };
        self.obstacles.iter().enumerate().filter(move |(_, obstacle)| counts(obstacle))
    }
}

/// What is known of the distance of an obstacle from a point that moves: it changes by no more than the point.
#[derive(Clone, Copy, Debug)]
pub(super) struct DistanceBound<'a> {
    obstacle: &'a Obstacle,
    at: Vec3,
    distance: f64,
}

impl<'a> DistanceBound<'a> {
    /// Of an obstacle of which nothing is known.
    pub fn new(obstacle: &'a Obstacle) -> Self {
        Self { obstacle, at: Vec3::ZERO, distance: f64::NEG_INFINITY }
    }

    /// No less than this is the distance of a point.
    pub fn least(&self, point: Vec3) -> f64 {
        self.distance - (point - self.at).norm()
    }

    /// The distance of a point, from which others are bounded.
    pub fn measure(&mut self, point: Vec3) -> f64 {
        (self.at, self.distance) = (point, self.obstacle.surface(point).distance);
        self.distance
    }
}

/// Whether the robot is inside it, so that it can be inserted.
pub(super) fn is_pipe(obstacle: &Obstacle) -> bool {
    matches!(obstacle.form, Form::Pipe(_))
}
