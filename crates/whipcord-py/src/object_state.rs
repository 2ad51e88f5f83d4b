//! Movable objects in equilibrium.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use whipcord::{ObjectContact, ObjectState, Obstacle, Pose, UnitQuaternion, Vec3, Wrench};

/// Obstacle, point, normal, force, friction, whether it sticks, and gap.
type ContactRow = (usize, [f64; 3], [f64; 3], f64, [f64; 3], bool, f64);
/// Obstacle, position, quaternion, centre of mass, load, imbalance, slip margin, and contacts.
pub type ObjectRow =
    (usize, [f64; 3], [f64; 4], [f64; 3], [f64; 6], [f64; 6], Option<f64>, Vec<ContactRow>);

/// As dictionaries.
pub fn list<'py>(
    py: Python<'py>,
    states: &[ObjectState],
    obstacles: &[Obstacle],
) -> PyResult<Bound<'py, PyList>> {
    let name = |number: usize| obstacles.get(number).map(|obstacle| obstacle.name.as_str());
    let list = PyList::empty(py);
    for state in states {
        let values = PyDict::new(py);
        values.set_item("obstacle", name(state.obstacle))?;
        values.set_item("position", state.pose.position.to_array())?;
        values.set_item("orientation", state.pose.rotation.wxyz())?;
        values.set_item("center_of_mass", state.center_of_mass.to_array())?;
        values.set_item("load", wrench(state.load))?;
        values.set_item("imbalance", wrench(state.imbalance))?;
        values.set_item("slip_margin", state.slip_margin)?;
        let contacts = PyList::empty(py);
        for contact in &state.contacts {
            let values = PyDict::new(py);
            values.set_item("obstacle", name(contact.obstacle))?;
            values.set_item("point", contact.point.to_array())?;
            values.set_item("normal", contact.normal.to_array())?;
            values.set_item("force", contact.force)?;
            values.set_item("friction", contact.friction.to_array())?;
            values.set_item("sticks", contact.sticks)?;
            values.set_item("gap", contact.gap)?;
            contacts.append(values)?;
        }
        values.set_item("contacts", contacts)?;
        list.append(values)?;
    }
    Ok(list)
}

fn wrench(wrench: Wrench) -> [f64; 6] {
    let ([x, y, z], [a, b, c]) = (wrench.force.to_array(), wrench.moment.to_array());
    [x, y, z, a, b, c]
}

fn wrench_of([x, y, z, a, b, c]: [f64; 6]) -> Wrench {
    Wrench { force: Vec3::new(x, y, z), moment: Vec3::new(a, b, c) }
}

/// All numbers of one, for pickles.
pub fn row(state: &ObjectState) -> ObjectRow {
    let contact = |contact: &ObjectContact| {
        let &ObjectContact { obstacle, point, normal, force, friction, sticks, gap } = contact;
        let [point, normal, friction] = [point, normal, friction].map(|vector| vector.to_array());
        (obstacle, point, normal, force, friction, sticks, gap)
    };
    (
        state.obstacle,
        state.pose.position.to_array(),
        state.pose.rotation.wxyz(),
        state.center_of_mass.to_array(),
        wrench(state.load),
        wrench(state.imbalance),
        state.slip_margin,
        state.contacts.iter().map(contact).collect(),
    )
}

/// The object of such numbers.
pub fn of_row(row: ObjectRow) -> ObjectState {
    let (obstacle, position, [w, x, y, z], center_of_mass, load, imbalance, slip_margin, contacts) =
        row;
    let contact = |(obstacle, point, normal, force, friction, sticks, gap): ContactRow| {
        let [point, normal, friction] = [point, normal, friction].map(Vec3::from);
        ObjectContact { obstacle, point, normal, force, friction, sticks, gap }
    };
    ObjectState {
        obstacle,
        pose: Pose {
            position: position.into(),
            rotation: UnitQuaternion { w, v: Vec3::new(x, y, z) },
        },
        center_of_mass: center_of_mass.into(),
        load: wrench_of(load),
        imbalance: wrench_of(imbalance),
        slip_margin,
        contacts: contacts.into_iter().map(contact).collect(),
    }
}
