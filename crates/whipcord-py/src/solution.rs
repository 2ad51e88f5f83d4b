//! The answer.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use whipcord::{
    CableOverlap, CableState, Case, Contact, Diagnostics, Grasp, InternalState, LengthMiss,
    ModelKind, MotorState, NoStability, Obstacle, Part, Pose, Robot, Shape, SlipState,
    UnitQuaternion, Vec3, Wrench,
};

use crate::object_state::{self, ObjectRow};

use crate::convert::{array, flat};
use crate::errors;
use crate::setup::Setup;

/// A converged answer.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Solution {
    pub inner: Arc<whipcord::Solution>,
    /// What it answers.
    pub case: Arc<Case>,
    /// Which step of the case, from 0. The step is taken out of the case only where it is needed: many steps, each with
    /// those before it, would fill the memory.
    pub step: usize,
}

impl Solution {
    pub fn new(solution: whipcord::Solution, case: &Arc<Case>) -> Self {
        Self::of_step(solution, case, case.before.len())
    }

    /// The answer to one of the steps of a case, counted from 0.
    pub fn of_step(solution: whipcord::Solution, case: &Arc<Case>, step: usize) -> Self {
        Self { inner: Arc::new(solution), case: Arc::clone(case), step }
    }

    /// The case that it answers, with the steps before it.
    pub fn answered(&self) -> Arc<Case> {
        match self.case.step(self.step) {
            Some(step) if self.step < self.case.before.len() => Arc::new(step),
            _ => Arc::clone(&self.case),
        }
    }
}

/// What [`Solution::state`] is made of: what pickles hold.
type ShapeState = (Vec<f64>, Vec<f64>, Vec<f64>);
type CableRow = (String, Option<f64>, f64, f64, bool, Vec<f64>, Vec<String>);
type DiagnosticsRow = (
    usize,
    f64,
    (Option<bool>, Option<f64>),
    Option<f64>,
    usize,
    Option<f64>,
    Option<String>,
    Vec<(String, f64)>,
);
/// Obstacle, disk if it is one, arc length, force, gap, point, normal, friction, and whether it sticks.
type TouchRow =
    (usize, Option<usize>, f64, Option<f64>, f64, [f64; 3], [f64; 3], Option<[f64; 3]>, bool);
type State = (
    String,
    ShapeState,
    ShapeState,
    Vec<CableRow>,
    Option<[f64; 6]>,
    DiagnosticsRow,
    Vec<TouchRow>,
    Vec<ObjectRow>,
    Vec<[f64; 2]>,
);

#[pymethods]
impl Solution {
    /// Name of the model.
    #[getter]
    fn model(&self) -> &'static str {
        self.inner.model.name()
    }

    /// (n,) arc lengths in m.
    #[getter]
    fn arc_length<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arc_length(py, &self.inner.shape)
    }

    /// (n, 3) positions in m.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        position(py, &self.inner.shape)
    }

    /// (n, 4) quaternions (w, x, y, z).
    #[getter]
    fn orientation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        orientation(py, &self.inner.shape)
    }

    /// (n, 2) plastic curvature in 1/m; no rows without friction against bending.
    #[getter]
    fn plastic_curvature<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = &self.inner.plastic_curvature;
        array(py, rows.as_flattened().to_vec(), (rows.len(), 2))
    }

    /// (d,) arc lengths of the disks in m.
    #[getter]
    fn disk_arc_length<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arc_length(py, &self.inner.disks)
    }

    /// (d, 3) positions of the disks in m.
    #[getter]
    fn disk_position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        position(py, &self.inner.disks)
    }

    /// (d, 4) quaternions of the disks.
    #[getter]
    fn disk_orientation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        orientation(py, &self.inner.disks)
    }

    /// What became of each cable.
    #[getter]
    fn cables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for cable in &self.inner.cables {
            let state = PyDict::new(py);
            state.set_item("name", &cable.name)?;
            state.set_item("tension", cable.tension)?;
            state.set_item("length", cable.length)?;
            state.set_item("initial_length", cable.initial_length)?;
            state.set_item("slack", cable.slack)?;
            state.set_item("span_tensions", cable.span_tensions.clone())?;
            state.set_item("slip_states", slip_states(cable))?;
            list.append(state)?;
        }
        Ok(list)
    }

    /// Force in N and moment in N·m on the base, in its frame.
    #[getter]
    fn base_wrench(&self) -> Option<[f64; 6]> {
        self.inner.base_wrench.map(|Wrench { force, moment }| {
            let ([x, y, z], [a, b, c]) = (force.to_array(), moment.to_array());
            [x, y, z, a, b, c]
        })
    }

    /// Where it touches obstacles.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        contact_values(py, &self.inner.contacts, &self.case.obstacles)
    }

    /// What it exerts on each obstacle that it touches.
    #[getter]
    fn grasps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        for grasp in Grasp::all(&self.inner, &self.case.obstacles) {
            let values = PyDict::new(py);
            values.set_item("obstacle", &self.case.obstacles[grasp.obstacle].name)?;
            values.set_item("contacts", grasp.contacts)?;
            values.set_item("sliding", grasp.sliding)?;
            values.set_item("normal_force", grasp.normal_force)?;
            values.set_item("force", grasp.wrench.map(|wrench| wrench.force.to_array()))?;
            values.set_item("moment", grasp.wrench.map(|wrench| wrench.moment.to_array()))?;
            values.set_item("slip_margin", grasp.slip_margin)?;
            list.append(values)?;
        }
        Ok(list)
    }

    /// The movable objects where they are in equilibrium.
    #[getter]
    fn objects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        object_state::list(py, &self.inner.objects, &self.case.obstacles)
    }

    /// How it was obtained.
    #[getter]
    fn diagnostics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let of = &self.inner.diagnostics;
        let values = PyDict::new(py);
        values.set_item("iterations", of.iterations)?;
        values.set_item("residual", of.residual)?;
        values.set_item("stability", of.stability)?;
        values.set_item("stability_absent", of.stability_absent.map(NoStability::name))?;
        values.set_item("discretization_error", of.discretization_error)?;
        values.set_item("steps", of.steps)?;
        values.set_item("stability_lost_at", of.stability_lost_at)?;
        values.set_item("length_misses", misses(of))?;
        values.set_item("unstable", of.is_unstable())?;
        values.set_item("stable", of.stable)?;
        Ok(values)
    }

    /// Bend of the tip in rad and its direction.
    #[getter]
    fn bend(&self) -> (f64, f64) {
        self.inner.disks.bend()
    }

    /// RMS distance in m to another answer over the disks, without the first.
    fn rms_distance(&self, other: &Self) -> f64 {
        self.inner.disks.rms_distance(&other.inner.disks)
    }

    /// The shape as the CSV of the command line.
    fn csv(&self, py: Python<'_>) -> PyResult<String> {
        let csv = whipcord_io::shape_csv(&self.inner.shape);
        csv.map_err(|error| errors::input(py, "solution", error.to_string()))
    }

    /// All numbers of it, for pickles.
    fn state(&self) -> State {
        let of = &*self.inner;
        let cables = of.cables.iter().map(|cable| {
            let &CableState { tension, length, initial_length, slack, .. } = cable;
            let spans = cable.span_tensions.clone();
            (cable.name.clone(), tension, length, initial_length, slack, spans, slip_states(cable))
        });
        let d = &of.diagnostics;
        (
            of.model.name().to_owned(),
            shape_state(&of.shape),
            shape_state(&of.disks),
            cables.collect(),
            self.base_wrench(),
            (
                d.iterations,
                d.residual,
                (d.stable, d.stability),
                d.discretization_error,
                d.steps,
                d.stability_lost_at,
                d.stability_absent.map(|reason| reason.name().to_owned()),
                misses(d),
            ),
            of.contacts.iter().map(touch_row).collect(),
            of.objects.iter().map(object_state::row).collect(),
            of.plastic_curvature.clone(),
        )
    }

    /// The answer of such numbers to a case.
    #[staticmethod]
    fn from_state(py: Python<'_>, setup: &Setup, state: State) -> PyResult<Self> {
        let (model, shape, disks, cables, wrench, d, contacts, objects, plastic_curvature) = state;
        let model: ModelKind =
            model.parse().map_err(|_| errors::input(py, "state", format!("no model `{model}`")))?;
        let cables = cables.into_iter().map(|row| {
            let (name, tension, length, initial_length, slack, span_tensions, slip_states) = row;
            let slip_states = slip_states.iter().map(|name| slip_state(name)).collect();
            CableState { name, tension, length, initial_length, slack, span_tensions, slip_states }
        });
        let (iterations, residual, (stable, stability), error, steps, lost_at, why, misses) = d;
        let miss = |(cable, excess): (String, f64)| LengthMiss { cable, excess };
        let solution = whipcord::Solution {
            model,
            shape: shape_of(shape),
            disks: shape_of(disks),
            cables: cables.collect(),
            base_wrench: wrench.map(|[x, y, z, a, b, c]| Wrench {
                force: Vec3::new(x, y, z),
                moment: Vec3::new(a, b, c),
            }),
            plastic_curvature,
            contacts: contacts.into_iter().map(touch_of).collect(),
            objects: objects.into_iter().map(object_state::of_row).collect(),
            internal: InternalState::default(),
            diagnostics: Diagnostics {
                iterations,
                residual,
                stable,
                stability,
                stability_absent: why.as_deref().and_then(NoStability::named),
                discretization_error: error,
                steps,
                stability_lost_at: lost_at,
                length_misses: misses.into_iter().map(miss).collect(),
            },
        };
        Ok(Self::new(solution, &setup.case))
    }
}

/// Cables that miss their lengths, and by how much.
fn misses(of: &Diagnostics) -> Vec<(String, f64)> {
    of.length_misses.iter().map(|miss| (miss.cable.clone(), miss.excess)).collect()
}

impl Solution {
    /// The cables that pass through the obstacles of the case.
    pub fn cable_overlaps<'py>(
        &self,
        py: Python<'py>,
        robot: &Robot,
    ) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        let all = py.detach(|| CableOverlap::all(robot, &self.inner, &self.case.obstacles));
        for overlap in all {
            let values = PyDict::new(py);
            values.set_item("cable", &robot.cables()[overlap.cable].name)?;
            values.set_item("obstacle", &self.case.obstacles[overlap.obstacle].name)?;
            values.set_item("span", overlap.span)?;
            values.set_item("arc_length", overlap.arc_length)?;
            values.set_item("point", overlap.point.to_array())?;
            values.set_item("normal", overlap.normal.to_array())?;
            values.set_item("depth", overlap.depth)?;
            values.set_item("force", overlap.force)?;
            list.append(values)?;
        }
        Ok(list)
    }

    /// What each motor of the robot was told and holds.
    pub fn motors<'py>(&self, py: Python<'py>, robot: &Robot) -> PyResult<Bound<'py, PyList>> {
        let list = PyList::empty(py);
        let case = self.answered();
        let commands = case.motors.last().map_or(&[][..], Vec::as_slice);
        for (motor, state) in
            robot.motors().iter().zip(MotorState::all(robot, commands, &self.inner))
        {
            let values = PyDict::new(py);
            values.set_item("name", &motor.name)?;
            let keys = motor.drive.keys();
            values.set_item(keys.command, state.command)?;
            values.set_item(keys.effort, state.effort)?;
            values.set_item("utilization", state.utilization)?;
            list.append(values)?;
        }
        Ok(list)
    }

    /// (m, 3) points of each cable: at the stations as far as it goes, or in the holes of the disks where
    /// the model has it run straight between them.
    pub fn cable_paths(&self, robot: &Robot) -> Vec<Vec<f64>> {
        let shape = match self.inner.model {
            ModelKind::Cosserat | ModelKind::ConstantCurvature => &self.inner.shape,
            ModelKind::CosseratDisks
            | ModelKind::FourBar
            | ModelKind::PiecewiseConstantCurvature
            | ModelKind::PseudoRigidBody => &self.inner.disks,
        };
        let stations = || shape.arc_length.iter().zip(&shape.poses);
        robot
            .routes()
            .iter()
            .map(|route| {
                let on_it = stations().filter(|(s, _)| **s <= route.end());
                flat(on_it.map(|(&s, pose)| pose.transform(route.at(s).offset)))
            })
            .collect()
    }
}

fn touch_row(touch: &Contact) -> TouchRow {
    let &Contact { obstacle, part, arc_length, point, normal, force, friction, sticks, gap } =
        touch;
    let [point, normal] = [point, normal].map(|vector| vector.to_array());
    let friction = friction.map(|friction| friction.to_array());
    (obstacle, part.disk(), arc_length, force, gap, point, normal, friction, sticks)
}

fn touch_of(row: TouchRow) -> Contact {
    let (obstacle, disk, arc_length, force, gap, point, normal, friction, sticks) = row;
    let part = disk.map_or(Part::Backbone, Part::Disk);
    let (point, normal, friction) = (point.into(), normal.into(), friction.map(Into::into));
    Contact { obstacle, part, arc_length, point, normal, force, friction, sticks, gap }
}

fn slip_states(cable: &CableState) -> Vec<String> {
    cable.slip_states.iter().map(|slip_state| slip_state.name().to_owned()).collect()
}

fn slip_state(name: &str) -> SlipState {
    let all = [SlipState::Pulled, SlipState::Released];
    all.into_iter().find(|slip_state| slip_state.name() == name).unwrap_or(SlipState::Sticks)
}

fn arc_length<'py>(py: Python<'py>, shape: &Shape) -> PyResult<Bound<'py, PyArray1<f64>>> {
    array(py, shape.arc_length.clone(), [shape.arc_length.len()])
}

fn position<'py>(py: Python<'py>, shape: &Shape) -> PyResult<Bound<'py, PyArray2<f64>>> {
    array(py, flat(shape.positions()), [shape.poses.len(), 3])
}

fn orientation<'py>(py: Python<'py>, shape: &Shape) -> PyResult<Bound<'py, PyArray2<f64>>> {
    array(py, quaternions(shape), [shape.poses.len(), 4])
}

fn quaternions(shape: &Shape) -> Vec<f64> {
    shape.poses.iter().flat_map(|pose| pose.rotation.wxyz()).collect()
}

fn shape_state(shape: &Shape) -> ShapeState {
    (shape.arc_length.clone(), flat(shape.positions()), quaternions(shape))
}

fn shape_of((arc_length, positions, quaternions): ShapeState) -> Shape {
    let (positions, _) = positions.as_chunks::<3>();
    let (quaternions, _) = quaternions.as_chunks::<4>();
    let poses = positions.iter().zip(quaternions).map(|(&[x, y, z], &[w, a, b, c])| Pose {
        position: Vec3::new(x, y, z),
        rotation: UnitQuaternion { w, v: Vec3::new(a, b, c) },
    });
    Shape { arc_length, poses: poses.collect() }
}

/// Places where a robot touches obstacles, each by its names.
pub fn contact_values<'py>(
    py: Python<'py>,
    contacts: &[Contact],
    obstacles: &[Obstacle],
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for touch in contacts {
        let values = PyDict::new(py);
        let obstacle = obstacles.get(touch.obstacle);
        values.set_item("obstacle", obstacle.map(|obstacle| obstacle.name.as_str()))?;
        values.set_item("part", touch.part.name())?;
        values.set_item("disk", touch.part.disk())?;
        values.set_item("arc_length", touch.arc_length)?;
        values.set_item("point", touch.point.to_array())?;
        values.set_item("normal", touch.normal.to_array())?;
        values.set_item("force", touch.force)?;
        values.set_item("friction", touch.friction.map(|friction| friction.to_array()))?;
        values.set_item("sticks", touch.sticks)?;
        values.set_item("gap", touch.gap)?;
        list.append(values)?;
    }
    Ok(list)
}
