//! What the robot exerts on each obstacle that it touches.

use whipcord_numerics::Vec3;

use crate::obstacle::Obstacle;
use crate::shape::Wrench;
use crate::solution::{Contact, Solution};

/// All contacts with one obstacle together.
///
/// ```
/// # use whipcord::{Backbone, Cable, Case, Disks, Form, Material, Obstacle, Pose, Robot, Routing, Section, Vec3};
/// use whipcord::{Actuation, Grasp, Model, ModelKind, Shortening, Statics, Stations};
///
/// # let material = Material { young_modulus: Some(1.1e9), poisson_ratio: Some(0.3), ..Default::default() };
/// # let backbone = Backbone { section: Some(Section::circle(0.003)), material, ..Backbone::new(0.18) };
/// # let cable = Cable::new("pull", Routing::Straight { angle: 0.0, radius: 0.008 });
/// # let robot = Robot::new(backbone, Disks::equally_spaced(0.18, 10, 0.008), vec![cable])?;
/// let ball = Obstacle {
///     name: "ball".to_owned(),
///     form: Form::Sphere { radius: 0.03 },
///     pose: Pose { position: Vec3::new(0.05, 0.0, 0.12), ..Pose::IDENTITY },
///     friction: 0.0,
///     movable: None,
/// };
/// let case = Case { obstacles: vec![ball], ..Case::with_shortenings(&[Shortening::Length(0.004)]) };
/// let model = Model::new(ModelKind::Cosserat, Stations::default(), Actuation::Shortening);
/// let solution = model.solve(&robot, &case)?;
/// let grasp = &Grasp::all(&solution, &case.obstacles)[0];
/// // The robot pushes the ball away, and a frictionless ball does not turn about its centre.
/// let wrench = grasp.wrench.unwrap();
/// assert!(wrench.force.x > 0.0 && wrench.moment.norm() < 1e-6);
/// assert_eq!(grasp.slip_margin, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grasp {
    /// The obstacle, by its number in [`crate::Case::obstacles`].
    pub obstacle: usize,
    /// How many contacts there are.
    pub contacts: usize,
    /// How many of them slide, or are about to; without friction all of them are free to.
    pub sliding: usize,
    /// Sum of the normal forces in N: how hard the robot presses. `None` from a model that knows no forces.
    pub normal_force: Option<f64>,
    /// What the robot exerts on the obstacle, moments about the origin of the obstacle's frame, of a movable object where it is in
    /// equilibrium, in the frame that its pose is given in. `None` from a model that knows no forces.
    pub wrench: Option<Wrench>,
    /// `1 − ‖t‖/(μλ)` of the contact that is nearest to sliding, with its normal force λ and its force along the surface t: 0 where
    /// one slides, 1 where none holds on. `None` without friction, and from a model that knows no forces.
    pub slip_margin: Option<f64>,
}

impl Grasp {
    /// Of each of these obstacles that the robot touches in an answer, in their order.
    #[must_use]
    pub fn all(solution: &Solution, obstacles: &[Obstacle]) -> Vec<Self> {
        let placed = solution.placed(obstacles);
        let of_obstacle = |(number, obstacle): (usize, &Obstacle)| {
            let touching = solution.contacts.iter().filter(move |touch| touch.obstacle == number);
            let contacts: Vec<&Contact> = touching.collect();
            (!contacts.is_empty()).then(|| Self::of(number, obstacle, &contacts))
        };
        placed.iter().enumerate().filter_map(of_obstacle).collect()
    }

    fn of(number: usize, obstacle: &Obstacle, contacts: &[&Contact]) -> Self {
        let forces: Option<Vec<(f64, Vec3)>> = contacts
            .iter()
            .map(|touch| Some((touch.force?, touch.friction.unwrap_or_default())))
            .collect();
        let wrench = forces.as_ref().map(|forces| {
            let mut sum = Wrench::default();
            for (touch, &(force, friction)) in contacts.iter().zip(forces) {
                let on_obstacle = -(touch.normal * force + friction);
                sum.force += on_obstacle;
                sum.moment += (touch.point - obstacle.pose.position).cross(on_obstacle);
            }
            sum
        });
        let margin = |&(force, friction): &(f64, Vec3)| {
            let most = obstacle.friction * force;
            if most > 0.0 { (1.0 - friction.norm() / most).clamp(0.0, 1.0) } else { 1.0 }
        };
        let margins = forces.as_ref().filter(|_| obstacle.has_friction());
        Self {
            obstacle: number,
            contacts: contacts.len(),
            sliding: contacts.iter().filter(|touch| !touch.sticks).count(),
            normal_force: forces.as_ref().map(|forces| forces.iter().map(|(force, _)| force).sum()),
            wrench,
            slip_margin: margins.map(|forces| forces.iter().map(margin).fold(1.0, f64::min)),
        }
    }
}
