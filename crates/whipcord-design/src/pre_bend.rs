//! The rest curvature with which a robot takes a curve under its tensions and loads.

use whipcord::{
    Along, Backbone, Case, Model, ModelKind, Pose, Robot, Solution, Statics as _, Stations, Vec3,
};

use crate::curve::Curve;
use crate::error::DesignError;
use crate::route::distance;

/// A backbone that is bent at rest.
#[derive(Clone, Debug)]
pub struct PreBend {
    /// The robot with this rest curvature.
    pub robot: Robot,
    /// Rest curvature at the places in 1/m: about x, about y, and twist.
    pub rest_curvature: Vec<Vec3>,
    /// Arc lengths of the places in m.
    pub places: Vec<f64>,
    /// Greatest distance in m between the backbone and the curve at the places and between them.
    pub error: f64,
    /// The shape under the case.
    pub solution: Solution,
}

/// Steps of the iteration.
const ITERATIONS: usize = 60;
/// The part of the length by which the distance has to fall to go on.
const CONVERGED: f64 = 1e-9;

/// The rest curvature at equally spaced places, with linear interpolation between them, with which a robot takes a curve under a case: the
/// difference of wanted and actual curvature is added to it until the distance no longer falls, eq. (8). `model` is a model of a rod.
///
/// # Errors
/// [`DesignError::Curve`] for too few places or a curve that is too short, and [`DesignError::Solve`] where the model has no answer.
pub fn rest_curvature_for_curve(
    model: &Model,
    robot: &Robot,
    case: &Case,
    curve: &Curve,
    places: usize,
) -> Result<PreBend, DesignError> {
    let target = Target::new(model, robot, curve, places)?;
    let mut rest: Vec<Vec3> = target.at_places(&target.wanted(&target.frames(None)));
    let mut best: Option<PreBend> = None;
    let mut share = 1.0;
    for _ in 0..ITERATIONS {
        let backbone = Backbone {
            rest_curvature: Along::At { arc_lengths: target.places.clone(), values: rest.clone() },
            ..robot.backbone().clone()
        };
        let bent = target.with_backbone(robot, backbone)?;
        let solved = target.model.solve(&bent, case);
        let error = solved.as_ref().map_or(f64::INFINITY, |solution| target.error(solution));
        let before = best.as_ref().map_or(f64::INFINITY, |best| best.error);
        let length = robot.backbone().length;
        match (solved, &best) {
            (Err(reason), None) => return Err(reason.into()),
            (Ok(solution), _) if error < before => {
                let is_done = before - error <= CONVERGED * length;
                let rest_curvature = rest.clone();
                let places = target.places.clone();
                best = Some(PreBend { robot: bent, rest_curvature, places, error, solution });
                if is_done {
                    break;
                }
            }
            _ => {
                // Too large a step: back to the best, and half as much from there.
                share *= 0.5;
                if share < 1e-3 {
                    break;
                }
            }
        }
        if let Some(best) = &best {
            let missing = target.missing(&best.solution);
            rest = best
                .rest_curvature
                .iter()
                .zip(target.at_places(&missing))
                .map(|(rest, missing)| *rest + missing * share)
                .collect();
        }
    }
    best.ok_or(DesignError::NotConverged {
        what: "rest curvature",
        iterations: ITERATIONS,
        change: f64::INFINITY,
        advice: "give smaller loads, or a curve that is nearer to what the robot does by itself",
    })
}

/// A curve as a model of a rod sees it: at places, and in the middle between each two of them.
pub(crate) struct Target<'a> {
    pub model: Model,
    pub places: Vec<f64>,
    curve: &'a Curve,
    /// Arc lengths of the undeformed backbone at places and between them in m, and their distance.
    stations: Vec<f64>,
    half: f64,
}

impl<'a> Target<'a> {
    pub fn new(
        model: &Model,
        robot: &Robot,
        curve: &'a Curve,
        places: usize,
    ) -> Result<Self, DesignError> {
        curve.check()?;
        let length = robot.backbone().length;
        if !matches!(model.kind(), ModelKind::Cosserat | ModelKind::CosseratDisks) {
            let what = "the curvature of a backbone is that of a rod: use the model cosserat or cosserat-disks";
            return Err(DesignError::Curve { what: what.to_owned() });
        }
        if !(3..=2000).contains(&places) {
            let what = format!("{places} places cannot be: give 3 to 2000");
            return Err(DesignError::Curve { what });
        }
        if curve.length() < length * (1.0 - 1e-12) {
            let what = format!(
                "the curve is {:.4} m long and the backbone {length:.4} m: give a curve at least as long",
                curve.length()
            );
            return Err(DesignError::Curve { what });
        }
        let stations: Vec<f64> = whipcord::equally_spaced(0.0, length, 2 * places - 1).collect();
        #[allow(clippy::cast_precision_loss, reason = "few places")]
        let half = length / (2 * (places - 1)) as f64;
        Ok(Self {
            model: model.at(Stations::At(stations.clone())),
            places: stations.iter().copied().step_by(2).collect(),
            curve,
            stations,
            half,
        })
    }

    /// Frames of the curve at the stations: at the arc lengths that these have in a shape, whose backbone is stretched, or at rest.
    pub fn frames(&self, solution: Option<&Solution>) -> Vec<Pose> {
        let Some(solution) = solution else { return self.curve.frames(&self.stations) };
        let mut along = vec![0.0];
        let mut sum = 0.0;
        for pair in solution.shape.poses.windows(2) {
            let chord = (pair[1].position - pair[0].position).norm();
            let half = 0.5 * (pair[0].rotation.conjugate() * pair[1].rotation).log().norm();
            // Of an arc of a circle.
            sum += if half > 1e-6 { chord * half / half.sin() } else { chord };
            along.push(sum);
        }
        self.curve.frames(&along)
    }

    /// The curvature that these frames have between each two stations, by the undeformed length.
    pub fn wanted(&self, frames: &[Pose]) -> Vec<Vec3> {
        curvatures(frames, self.half)
    }

    pub fn with_backbone(&self, robot: &Robot, backbone: Backbone) -> Result<Robot, DesignError> {
        let changed = Robot::new(backbone, robot.disks().clone(), robot.cables().to_vec())?;
        Ok(changed.with_motors(robot.motors().to_vec())?)
    }

    /// Greatest distance from the curve in m, the base of the robot where the curve begins.
    pub fn error(&self, solution: &Solution) -> f64 {
        let frames = self.frames(Some(solution));
        let points: Vec<Vec3> = frames.iter().map(|frame| frame.position).collect();
        distance(&self.in_base(solution), &points)
    }

    fn in_base(&self, solution: &Solution) -> Vec<Pose> {
        let poses = &solution.shape.poses;
        let to_base = poses[0].inverse();
        poses.iter().map(|pose| to_base * *pose).collect()
    }

    /// Curvature between each two stations of a shape.
    pub fn actual(&self, solution: &Solution) -> Vec<Vec3> {
        curvatures(&solution.shape.poses, self.half)
    }

    /// What the curvature between each two stations lacks.
    pub fn missing(&self, solution: &Solution) -> Vec<Vec3> {
        let actual = self.actual(solution);
        let wanted = self.wanted(&self.frames(Some(solution)));
        wanted.iter().zip(&actual).map(|(wanted, actual)| *wanted - *actual).collect()
    }

    /// Values at the places from those between the stations: the line through the two beside a place, and at the ends beyond them.
    pub fn at_places(&self, between: &[Vec3]) -> Vec<Vec3> {
        let last = between.len() - 1;
        (0..self.places.len())
            .map(|place| match 2 * place {
                0 => between[0] * 1.5 - between[1] * 0.5,
                k if k > last => between[last] * 1.5 - between[last - 1] * 0.5,
                k => (between[k - 1] + between[k]) * 0.5,
            })
            .collect()
    }
}

/// `log(R_kᵀ R_{k+1})/h` between each two of equally spaced poses.
fn curvatures(poses: &[Pose], h: f64) -> Vec<Vec3> {
    let between =
        |pair: &[Pose]| (pair[0].rotation.conjugate() * pair[1].rotation).log() * (1.0 / h);
    poses.windows(2).map(between).collect()
}
