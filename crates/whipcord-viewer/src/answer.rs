//! Solutions as the page gets them.

use serde::Serialize;
use whipcord::section::section_stiffness;
use whipcord::warning::of_answer;
use whipcord::{Case, ModelPreset, Obstacle, Robot, Shape, Solution, Vec3, Warning};
use whipcord_io::CaseFile;

use crate::convert::{array, pose};
use crate::protocol::{self, Answer, CableState, Compliance, Contact, Grasp, PlacedObject, Solved};

/// Why a model has no answer, as the page shows it.
pub type Refusal = String;

/// What a model found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The answer.
    pub solution: Solution,
    /// How long it took in s.
    pub solve_time: f64,
    /// What was asked of the model.
    pub case: Case,
    /// The model whose cable lengths drove it.
    pub driven_by: Option<ModelPreset>,
}

/// What the page is told of what a model found, or why it found nothing.
pub fn answer(
    file: &CaseFile,
    preset: ModelPreset,
    found: Result<Found, Refusal>,
    compliance: Option<Compliance>,
) -> Answer {
    let solved = found.and_then(|found| {
        solved(file, preset, &found, compliance).ok_or_else(|| {
            "the answer holds a number that is none; please report the robot file".to_owned()
        })
    });
    match solved {
        Ok(solved) => Answer::Solved(Box::new(solved)),
        Err(message) => Answer::Failed { model: preset.name().to_owned(), message },
    }
}

/// A solution as the page gets it; `None` where a number of it is none.
fn solved(
    file: &CaseFile,
    preset: ModelPreset,
    found: &Found,
    compliance: Option<Compliance>,
) -> Option<Solved> {
    let Found { solution, solve_time, driven_by, .. } = found;
    let robot = &file.robot;
    let shape = &solution.shape;
    let diagnostics = &solution.diagnostics;
    let cables = solution.cables.iter().zip(robot.cables()).map(|(cable, given)| CableState {
        shortening: shortening(cable, given),
        tension: cable.tension,
        length: cable.length,
        initial_length: cable.initial_length,
        slack: cable.slack,
        span_tensions: cable.span_tensions.clone(),
    });
    let contacts = solution.contacts.iter().map(|touch| Contact {
        obstacle: touch.obstacle,
        arc_length: touch.arc_length,
        point: array(touch.point),
        normal: array(touch.normal),
        force: touch.force,
        friction: touch.friction.map(array),
        sticks: touch.sticks,
    });
    let solved = Solved {
        model: preset.name().to_owned(),
        positions: shape.positions().map(array).collect(),
        orientations: shape.poses.iter().map(|pose| pose.rotation.wxyz()).collect(),
        strains: strains(shape),
        moments: moments(robot, shape),
        cables: cables.collect(),
        contacts: contacts.collect(),
        grasps: grasps(solution, &file.case.obstacles),
        objects: solution
            .objects
            .iter()
            .map(|state| PlacedObject { obstacle: state.obstacle, pose: pose(&state.pose) })
            .collect(),
        residual: diagnostics.residual,
        iterations: diagnostics.iterations,
        stability: diagnostics.stability,
        unstable: diagnostics.is_unstable(),
        solve_time: *solve_time,
        driven_by: driven_by.map(|model| model.name().to_owned()),
        compliance,
        warnings: warnings(robot, &file.case, solution),
    };
    solved.is_finite().then_some(solved)
}

/// A shape that is no solution of a model of statics, at the stations of the page, as an answer: with these cables, after so many
/// iterations.
pub fn of_shape(
    robot: &Robot,
    model: String,
    shape: &Shape,
    cables: Vec<CableState>,
    iterations: usize,
) -> Answer {
    let solved = Solved {
        model: model.clone(),
        positions: shape.positions().map(array).collect(),
        orientations: shape.poses.iter().map(|pose| pose.rotation.wxyz()).collect(),
        strains: strains(shape),
        moments: moments(robot, shape),
        cables,
        contacts: Vec::new(),
        grasps: Vec::new(),
        objects: Vec::new(),
        residual: 0.0,
        iterations,
        stability: None,
        unstable: false,
        solve_time: 0.0,
        driven_by: None,
        compliance: None,
        warnings: Vec::new(),
    };
    if solved.is_finite() {
        Answer::Solved(Box::new(solved))
    } else {
        let message = "the shape holds a number that is none; please report the robot file";
        Answer::Failed { model, message: message.to_owned() }
    }
}

/// What the robot exerts on each obstacle that it touches, where the model knows forces.
fn grasps(solution: &Solution, obstacles: &[Obstacle]) -> Vec<Grasp> {
    let all = whipcord::Grasp::all(solution, obstacles);
    let known = |grasp: &whipcord::Grasp| {
        let wrench = grasp.wrench?;
        Some(Grasp {
            obstacle: grasp.obstacle,
            contacts: grasp.contacts,
            sliding: grasp.sliding,
            normal_force: grasp.normal_force?,
            force: array(wrench.force),
            moment: array(wrench.moment),
            slip_margin: grasp.slip_margin,
        })
    };
    all.iter().filter_map(known).collect()
}

/// Warnings about an answer, except those that the page has a field for.
fn warnings(robot: &Robot, case: &Case, solution: &Solution) -> Vec<protocol::Warning> {
    let others = of_answer(robot, case, solution).into_iter();
    others
        .filter(|warning| !matches!(warning, Warning::Unstable { .. }))
        .map(|warning| protocol::Warning { message: warning.to_string(), help: warning.help() })
        .collect()
}

/// The shortening in m that leads to this state of a cable: the path is as long as the cable at rest and its stretch.
fn shortening(cable: &whipcord::CableState, given: &whipcord::Cable) -> f64 {
    let stretch = given
        .axial_stiffness
        .map_or(0.0, |stiffness| cable.tension.unwrap_or(0.0) * cable.initial_length / stiffness);
    cable.initial_length - cable.length + stretch
}

pub fn strains(shape: &Shape) -> Vec<[f64; 6]> {
    let each = |whipcord::Twist { linear: v, angular: u }| [u.x, u.y, u.z, v.x, v.y, v.z - 1.0];
    shape.strains().map(each).collect()
}

/// What the moments of the backbone between two stations are of its strains there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MomentLaw {
    /// Bending moments about x and y and torsion in N·m: for shear along x and y, stretch, bending about x and y, and twist.
    pub rows: [[f64; 6]; 3],
    /// Bending about x and y and twist without any moment, in 1/m.
    pub rest: [f64; 3],
}

/// The law between each two stations, by the stiffness in the middle between them; none where that is not known.
pub fn moment_laws(robot: &Robot, arc_lengths: &[f64]) -> Option<Vec<MomentLaw>> {
    let (backbone, disks) = (robot.backbone(), robot.disks());
    let law = |ends: &[f64]| {
        let middle = 0.5 * (ends[0] + ends[1]);
        let stiffness = section_stiffness(robot, middle, middle).ok()?;
        // What does not shear or stretch is infinitely stiff in these, which enters no moment.
        let rows = [stiffness[3], stiffness[4], stiffness[5]];
        let rest = array(backbone.rest_curvature_at(disks, middle));
        Some(MomentLaw { rows, rest })
    };
    arc_lengths.windows(2).map(law).collect()
}

/// The moments of the backbone that belong to the strains of a shape.
pub fn moments(robot: &Robot, shape: &Shape) -> Option<Vec<[f64; 3]>> {
    let laws = moment_laws(robot, &shape.arc_length)?;
    let moment = |(law, strain): (&MomentLaw, whipcord::Twist)| {
        let bent = strain.angular - Vec3::from(law.rest);
        let stretched = strain.linear - Vec3::Z;
        let all = [stretched.to_array(), bent.to_array()].concat();
        law.rows.map(|row| row.iter().zip(&all).map(|(k, e)| k * e).sum::<f64>())
    };
    Some(laws.iter().zip(shape.strains()).map(moment).collect())
}

impl Solved {
    /// Whether all its numbers are numbers: JSON has no others.
    pub fn is_finite(&self) -> bool {
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        self.positions.iter().all(|p| finite(p))
            && self.orientations.iter().all(|q| finite(q))
            && self.strains.iter().all(|e| finite(e))
            && self.moments.iter().flatten().all(|m| finite(m))
            && self.cables.iter().all(|cable| {
                finite(&[cable.length, cable.initial_length, cable.shortening])
                    && cable.tension.is_none_or(f64::is_finite)
                    && finite(&cable.span_tensions)
            })
            && self.contacts.iter().all(|touch| {
                finite(&touch.point)
                    && finite(&touch.normal)
                    && touch.force.is_none_or(f64::is_finite)
                    && touch.friction.is_none_or(|friction| finite(&friction))
            })
            && self.grasps.iter().all(|grasp| {
                finite(&[grasp.normal_force])
                    && finite(&grasp.force)
                    && finite(&grasp.moment)
                    && grasp.slip_margin.is_none_or(f64::is_finite)
            })
            && finite(&[self.residual, self.solve_time])
            && self.stability.is_none_or(f64::is_finite)
            && match &self.compliance {
                Some(Compliance::Known { values, directions }) => {
                    finite(values) && directions.iter().all(|d| finite(d))
                }
                _ => true,
            }
    }
}
