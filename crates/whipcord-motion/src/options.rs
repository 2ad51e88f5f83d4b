//! How a motion is computed.

use whipcord::{DistributedLoad, Loads, ModelKind, PointLoad, Profile};
use whipcord_numerics::{Pose, Twist};

use crate::course::Course;
use crate::error::MotionError;

/// How the equations are integrated over time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The singly diagonally implicit Runge–Kutta method of Hairer and Wanner: five stages, order 4, L-stable. Steps with cables that are driven
    /// by their lengths are taken by [`Method::Robust`].
    #[default]
    Accurate,
    /// The midpoint rule with the discrete gradient of the energy: order 2; the energy of rod, cables and gravity is conserved but for what is
    /// damped. It keeps vibrations that are too fast for the step as well. Steps with cables that are driven by their lengths are taken by [`Method::Robust`].
    Energy,
    /// The generalised-α method for equations of first order with ρ = 0.5: order 2, damps vibrations that are too fast for the step.
    Robust,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Accurate, Self::Energy, Self::Robust];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accurate => "accurate",
            Self::Energy => "energy",
            Self::Robust => "robust",
        }
    }

    /// The method of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// Damping of the backbone: moments and forces in a section by the rates of its strains (Kelvin–Voigt).
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Damping {
    /// None.
    #[default]
    None,
    /// This time in s times the stiffness of each section.
    Time(f64),
    /// The same symmetric matrix everywhere, in the order of [`whipcord::robot::StiffnessMatrix`]: N·s and N·m·s by rates of the strains
    /// in 1/s and 1/(m·s).
    Matrix(Box<[[f64; 6]; 6]>),
}

/// Viscous drag of the surroundings on the backbone: force for each metre of it, by velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drag {
    /// Against motion across the backbone in N·s/m².
    pub across: f64,
    /// Against motion along the backbone in N·s/m².
    pub along: f64,
}

/// Velocities and strains to start from, those of a state of the same robot with the same elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Start {
    /// Velocity of each node in its frame: m/s and rad/s. That of the node at the base is the base's own, whatever it is here.
    pub velocities: Vec<Twist>,
    /// Strains `(v, u)` at the points of the elements.
    pub strains: Vec<Twist>,
    /// Tension in N of each cable, with which those that are driven by their lengths start; empty for none.
    pub tensions: Vec<f64>,
    /// Motion of the spool or drive of each motor, behind gear and backlash, in rad or m; empty for zero.
    pub motor_outputs: Vec<f64>,
    /// Position, velocity and integral of the error ([`crate::MotorMotion`]) of each motor, which those with inertia start from; empty where they are at rest at
    /// [`Self::motor_outputs`].
    pub motors: Vec<[f64; 3]>,
    /// Of each cable the tensions in N of its passages ([`crate::State::passage_tensions`]); empty where no cable has friction.
    pub passage_tensions: Vec<Vec<f64>>,
    /// Of each cable the unstretched lengths in m beyond the near holes of its passages ([`crate::State::lengths_beyond`]), which say where it sticks; empty where no cable has
    /// friction.
    pub lengths_beyond: Vec<Vec<f64>>,
    /// The rates that the next step goes on from; `None` where they are not known, so that it begins without them. They count where commands and loads go on as they were.
    pub rates: Option<StartRates>,
}

/// The rates of a state, and the step that they are of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartRates {
    /// Of the velocities of the nodes.
    pub velocities: Vec<Twist>,
    /// Of the strains.
    pub strains: Vec<Twist>,
    /// Of position, velocity and integral of the error of each motor.
    pub motors: Vec<[f64; 3]>,
    /// Length of that step in s.
    pub step: f64,
    /// What each cable was told at the end of that step, a tension in N or a shortening in m.
    pub commands: Vec<f64>,
    /// Sums of all forces and moments on the nodes in that step, then of those that turn with the robot, and gravity.
    pub loads: [f64; 15],
}

/// Where a motion starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Initial {
    /// At rest in equilibrium with the first commands and loads: the equilibrium that the statics finds.
    #[default]
    Equilibrium,
    /// At rest in the shape without commands and loads, which begin to act at the start.
    Rest,
    /// In the shape and with the velocities of a state that was kept, under the first commands and loads. The base is that of the case.
    State(Box<Start>),
}

/// Loads whose size changes over time.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadCourse {
    /// The loads; they have no masses. Gravity over time acts beside that of the case, and its work is that of loads.
    pub loads: Loads,
    /// What all of them are multiplied by.
    pub factor: Course,
}

impl LoadCourse {
    /// Adds the loads times a factor to constant ones, on a backbone of this length in m.
    pub(crate) fn add_to(
        &self,
        loads: &mut Loads,
        factor: f64,
        length: f64,
    ) -> Result<(), MotionError> {
        let of = &self.loads;
        if of.frame != loads.frame {
            return Err(MotionError::Unsupported {
                path: "motion.loads".to_owned(),
                what: "loads over time in another frame than the loads of the case",
                advice: "give both in the frame of the base, or both in that of the world",
            });
        }
        if factor == 0.0 {
            return Ok(());
        }
        if let Some(gravity) = of.gravity {
            loads.gravity = Some(loads.gravity.unwrap_or_default() + gravity * factor);
        }
        loads.points.push(PointLoad {
            at: length,
            force: of.tip_force * factor,
            moment: of.tip_moment * factor,
            follower: of.tip_follower,
        });
        loads.points.extend(of.points.iter().map(|point| PointLoad {
            force: point.force * factor,
            moment: point.moment * factor,
            ..*point
        }));
        loads.distributed.extend(of.distributed.iter().map(|load| {
            let profile = match &load.profile {
                Profile::Constant { from, to, force, moment } => Profile::Constant {
                    from: *from,
                    to: *to,
                    force: *force * factor,
                    moment: *moment * factor,
                },
                Profile::Linear { at, force, moment } => Profile::Linear {
                    at: at.clone(),
                    force: force.iter().map(|v| *v * factor).collect(),
                    moment: moment.iter().map(|v| *v * factor).collect(),
                },
            };
            DistributedLoad { profile, ..load.clone() }
        }));
        Ok(())
    }
}

/// How the base moves: velocities over time along and about its own axes, which turn with it. The motion starts from the base of the case.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseMotion {
    /// Velocity in m/s.
    pub velocity: [Course; 3],
    /// Angular velocity in rad/s.
    pub angular_velocity: [Course; 3],
}

impl BaseMotion {
    /// The motion through poses of the base at times in s that ascend, in any frame that is at rest: from each to the next in a screw motion, with constant
    /// velocity and angular velocity along and about the axes of the base. It begins with the first row and ends with the last one.
    ///
    /// # Errors
    /// [`MotionError::Course`] where the times do not ascend or a number is not finite.
    pub fn through(rows: &[(f64, Pose)]) -> Result<Self, MotionError> {
        let mut times = Vec::with_capacity(2 * rows.len());
        let mut values: [Vec<f64>; 6] = Default::default();
        let mut add = |time: f64, twist: Twist| {
            times.push(time);
            let numbers = twist.linear.to_array().into_iter().chain(twist.angular.to_array());
            for (of, value) in values.iter_mut().zip(numbers) {
                of.push(value);
            }
        };
        for (row, pair) in rows.windows(2).enumerate() {
            let [(from, before), (to, after)] = [pair[0], pair[1]];
            if to <= from {
                let problem = "has a time that is not behind that of the row above: sort the rows by time, each time once";
                return Err(MotionError::Course { row: row + 1, problem });
            }
            let twist = (before.inverse() * after).log() * (1.0 / (to - from));
            if row == 0 {
                add(from, Twist::default());
            }
            add(from, twist);
            add(to, twist);
            if row + 2 == rows.len() {
                add(to, Twist::default());
            }
        }
        if times.is_empty() {
            return Ok(Self::default());
        }
        // Between two rows the velocity jumps: the first of the two values is that before, the second that behind.
        let course = |values: &Vec<f64>| Course::table(times.clone(), values.clone());
        let [x, y, z, a, b, c] = &values;
        Ok(Self {
            velocity: [course(x)?, course(y)?, course(z)?],
            angular_velocity: [course(a)?, course(b)?, course(c)?],
        })
    }
}

impl Default for BaseMotion {
    fn default() -> Self {
        let still = || [0.0; 3].map(Course::constant);
        Self { velocity: still(), angular_velocity: still() }
    }
}

/// Options of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionOptions {
    /// How cables run: [`ModelKind::Cosserat`], along their routing, or [`ModelKind::CosseratDisks`], straight from disk to disk. No other model has a motion.
    pub model: ModelKind,
    /// How the equations are integrated.
    pub method: Method,
    /// Error in m that a step may have, as estimated; steps are divided until they meet it. `None` takes each step as it is.
    pub tolerance: Option<f64>,
    /// Where the motion starts.
    pub initial: Initial,
    /// Least number of elements along the backbone; there are more where disks, cable ends, corners of routings, loads or changes of the
    /// cross-section need them.
    pub elements: usize,
    /// Damping of the backbone.
    pub damping: Damping,
    /// Drag of the surroundings.
    pub drag: Drag,
    /// Loads over time, beside those of the case.
    pub loads: Vec<LoadCourse>,
    /// Motion of the base; `None` is a base at rest.
    pub base: Option<BaseMotion>,
    /// Whether the base is free: nothing holds it from the start on. Drives of cables ride on it.
    pub has_free_base: bool,
    /// Change of the strains (times the length of the backbone where it is one of curvature) at which the iteration of a step of
    /// 10 ms or more ends; less in shorter steps. [`Method::Energy`] iterates down to rounding instead.
    pub iteration_tolerance: f64,
}

impl MotionOptions {
    /// The models that have a motion.
    pub const MODELS: [ModelKind; 2] = [ModelKind::Cosserat, ModelKind::CosseratDisks];
    /// The default of [`Self::elements`].
    pub const ELEMENTS: usize = 6;
    /// The greatest number of elements.
    pub const MOST_ELEMENTS: usize = 2000;

    /// All loads at a time in s, behind a jump at that time: those of a case, and those over time, on a backbone of this length in m.
    ///
    /// # Errors
    /// [`MotionError::Unsupported`] where loads over time have another frame than those of the case.
    pub fn loads_at(&self, constant: &Loads, length: f64, time: f64) -> Result<Loads, MotionError> {
        let mut loads = constant.clone();
        for course in &self.loads {
            course.add_to(&mut loads, course.factor.after(time), length)?;
        }
        Ok(loads)
    }

    pub(crate) fn check(&self) -> Result<(), MotionError> {
        let refuse = |what, value, need| Err(MotionError::Option { what, value, need });
        if let Some(tolerance) = self.tolerance
            && !(tolerance > 0.0 && tolerance.is_finite())
        {
            return refuse("tolerance", tolerance, "it must be a positive length in m");
        }
        if self.elements == 0 || self.elements > Self::MOST_ELEMENTS {
            return refuse(
                "elements",
                self.elements as f64,
                "there must be at least 1 and at most 2000 of them",
            );
        }
        if !(1e-13..=1e-3).contains(&self.iteration_tolerance) {
            return refuse(
                "iteration_tolerance",
                self.iteration_tolerance,
                "it must be from 1e-13 to 1e-3",
            );
        }
        for (what, value) in [("drag.across", self.drag.across), ("drag.along", self.drag.along)] {
            if !(value >= 0.0 && value.is_finite()) {
                return refuse(what, value, "it must be finite and not negative");
            }
        }
        self.damping.check()?;
        if !Self::MODELS.contains(&self.model) {
            return Err(MotionError::Unsupported {
                path: "motion.model".to_owned(),
                what: "a model without dynamics",
                advice: "use `cosserat` or `cosserat-disks`",
            });
        }
        if self.base.is_some() && self.has_free_base {
            return Err(MotionError::Unsupported {
                path: "motion.base".to_owned(),
                what: "a base that is free and led as well",
                advice: "leave out the motion of the base, or hold it",
            });
        }
        for of in &self.loads {
            if !of.loads.masses.is_empty() {
                return Err(MotionError::Unsupported {
                    path: "motion.loads".to_owned(),
                    what: "a mass that changes over time: what comes and goes takes momentum along, which only its own motion tells",
                    advice: "give masses in the loads of the case, or a force in place of the weight",
                });
            }
        }
        Ok(())
    }
}

impl Damping {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`MotionError::Option`] for a time that is negative or not finite, and for a matrix that is not symmetric or has a negative direction.
    pub fn check(&self) -> Result<(), MotionError> {
        match self {
            Self::Time(time) if !(*time >= 0.0 && time.is_finite()) => Err(MotionError::Option {
                what: "damping time",
                value: *time,
                need: "it must be finite and not negative",
            }),
            Self::None | Self::Time(_) => Ok(()),
            Self::Matrix(matrix) => check_matrix(matrix),
        }
    }
}

/// A damping matrix is symmetric and has no negative direction.
fn check_matrix(matrix: &[[f64; 6]; 6]) -> Result<(), MotionError> {
    let refuse = |value, need| Err(MotionError::Option { what: "damping matrix", value, need });
    let size = (0..6).map(|i| matrix[i][i].abs()).fold(0.0, f64::max);
    for i in 0..6 {
        for j in 0..6 {
            let (value, mirror) = (matrix[i][j], matrix[j][i]);
            if !value.is_finite() {
                return refuse(value, "all of its entries must be finite");
            }
            let scale = (matrix[i][i] * matrix[j][j]).abs().sqrt();
            if (value - mirror).abs() > 1e-9 * scale.max(1e-12 * size) {
                return refuse(value, "it must be symmetric");
            }
        }
    }
    // Cholesky's factors of the matrix with a diagonal of 1; a direction without damping is admitted.
    let mut factor = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..=i {
            let scale = (matrix[i][i] * matrix[j][j]).sqrt();
            let entry = if scale > 0.0 { matrix[i][j] / scale } else { matrix[i][j] };
            let rest = entry - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            if i == j {
                if rest.is_nan() || rest < -1e-9 {
                    return refuse(
                        matrix[i][i],
                        "it must have no negative direction: damping takes energy",
                    );
                }
                factor[i][i] = rest.max(0.0).sqrt();
            } else {
                factor[i][j] = if factor[j][j] > 1e-5 { rest / factor[j][j] } else { 0.0 };
            }
        }
    }
    Ok(())
}

impl Default for MotionOptions {
    fn default() -> Self {
        Self {
            model: ModelKind::Cosserat,
            method: Method::default(),
            tolerance: None,
            initial: Initial::default(),
            elements: Self::ELEMENTS,
            damping: Damping::default(),
            drag: Drag::default(),
            loads: Vec::new(),
            base: None,
            has_free_base: false,
            iteration_tolerance: 1e-7,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_cannot_be_are_refused() {
        let options = MotionOptions::default();
        assert!(options.check().is_ok());
        let mut negative = [[0.0; 6]; 6];
        (negative[0][0], negative[1][1]) = (1.0, 1.0);
        (negative[0][1], negative[1][0]) = (2.0, 2.0);
        let mut skew = negative;
        skew[1][0] = 0.0;
        for wrong in [
            MotionOptions { tolerance: Some(0.0), ..options.clone() },
            MotionOptions { elements: 0, ..options.clone() },
            MotionOptions { damping: Damping::Time(-1.0), ..options.clone() },
            MotionOptions { damping: Damping::Matrix(Box::new(negative)), ..options.clone() },
            MotionOptions { damping: Damping::Matrix(Box::new(skew)), ..options.clone() },
            MotionOptions { drag: Drag { across: f64::NAN, along: 0.0 }, ..options.clone() },
            MotionOptions { iteration_tolerance: 1.0, ..options.clone() },
        ] {
            assert!(wrong.check().is_err(), "{wrong:?}");
        }
    }
}
