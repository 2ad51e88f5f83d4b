//! Motions, for C.

#![allow(unsafe_code, reason = "functions of the C interface take pointers")]

use whipcord_motion::CableMotion;

use crate::pointer::{flags, give, numbers, store};
use crate::robot::{POSE, RobotFile, pose_values, poses_values};
use crate::simulation::MovingRobot;
use crate::status::{Failure, Status, guard, guarded};

fn given<T>(handle: Option<T>) -> Result<T, Failure> {
    handle.ok_or_else(|| Failure::null("simulation"))
}

/// The motion of a robot from the commands and loads of its file, with the options of `[motion]`. `*simulation` is then to be freed by
/// `whipcord_simulation_free`; after a failure it is NULL.
///
/// # Safety
/// `simulation` leads to memory for a pointer or is NULL, which is an error.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_new(
    robot: Option<&RobotFile>,
    simulation: *mut *mut MovingRobot,
) -> Status {
    guard(|| {
        // SAFETY: the caller promises it.
        unsafe {
            give(simulation, "simulation", || {
                MovingRobot::new(robot.ok_or_else(|| Failure::null("robot"))?)
            })
        }
    })
}

/// Frees a simulation; NULL is ignored.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_simulation_free(simulation: Option<Box<MovingRobot>>) {
    guarded((), || drop(simulation));
}

/// Commands every cable by its tension in N from now on. The commands before are kept where this fails.
///
/// # Safety
/// `tensions` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_set_tensions(
    simulation: Option<&mut MovingRobot>,
    tensions: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let simulation = given(simulation)?;
        let cables = simulation.file().robot.cables().len();
        // SAFETY: the caller promises it.
        simulation.set_tensions(unsafe { numbers(tensions, count, cables, "tensions")? })
    })
}

/// Commands every cable by its shortening in m from now on. The commands before are kept where this fails.
///
/// # Safety
/// `shortenings` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_set_shortenings(
    simulation: Option<&mut MovingRobot>,
    shortenings: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let simulation = given(simulation)?;
        let cables = simulation.file().robot.cables().len();
        // SAFETY: the caller promises it.
        simulation.set_shortenings(unsafe { numbers(shortenings, count, cables, "shortenings")? });
        Ok(())
    })
}

/// Commands each cable in its own way from now on: by its tension in N where its flag is 0, by its shortening in m where it is 1. The commands
/// before are kept where this fails.
///
/// # Safety
/// `commands` and `by_shortening` are NULL or lead to `count` numbers and `count` bytes.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_set_commands(
    simulation: Option<&mut MovingRobot>,
    commands: *const f64,
    by_shortening: *const u8,
    count: usize,
) -> Status {
    guard(|| {
        let simulation = given(simulation)?;
        let cables = simulation.file().robot.cables().len();
        // SAFETY: the caller promises it.
        let (commands, by_shortening) = unsafe {
            (
                numbers(commands, count, cables, "commands")?,
                flags(by_shortening, count, cables, "by_shortening")?,
            )
        };
        simulation.set_commands(commands, by_shortening)
    })
}

/// Commands every motor from now on: its angle in rad, or its travel in m. The commands before are kept where this fails.
///
/// # Safety
/// `commands` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_set_motors(
    simulation: Option<&mut MovingRobot>,
    commands: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let simulation = given(simulation)?;
        let motors = simulation.file().robot.motors().len();
        // SAFETY: the caller promises it.
        simulation.set_motors(unsafe { numbers(commands, count, motors, "commands")? })
    })
}

/// Takes a step of `dt` seconds. After the first steps it allocates nothing. After a failure the state is that before the step.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_simulation_step(
    simulation: Option<&mut MovingRobot>,
    dt: f64,
) -> Status {
    guard(|| given(simulation)?.step(dt))
}

/// Time in s since the start; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_simulation_time(simulation: Option<&MovingRobot>) -> f64 {
    simulation.map_or(0.0, |simulation| simulation.state().time)
}

/// Number of nodes along the backbone; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_simulation_node_count(simulation: Option<&MovingRobot>) -> usize {
    simulation.map_or(0, |simulation| simulation.state().poses.len())
}

/// The pose of the tip in the world: x, y, z in m, quaternion w, x, y, z.
///
/// # Safety
/// `pose` is NULL or leads to memory for 7 numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_tip_pose(
    simulation: Option<&MovingRobot>,
    pose: *mut f64,
) -> Status {
    guard(|| {
        let tip = given(simulation)?.state().tip();
        // SAFETY: the caller promises it.
        unsafe { store(pose, POSE, pose_values(tip).into_iter(), "pose") }
    })
}

/// The poses of all nodes from the base on, 7 numbers each.
///
/// # Safety
/// `poses` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_node_poses(
    simulation: Option<&MovingRobot>,
    poses: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let nodes = &given(simulation)?.state().poses;
        // SAFETY: the caller promises it.
        unsafe { store(poses, count, poses_values(nodes), "poses") }
    })
}

/// The tension of each cable in N.
///
/// # Safety
/// `tensions` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_tensions(
    simulation: Option<&MovingRobot>,
    tensions: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let cables = &given(simulation)?.state().cables;
        let of = |cable: &CableMotion| cable.tension;
        // SAFETY: the caller promises it.
        unsafe { store(tensions, count, cables.iter().map(of), "tensions") }
    })
}

/// The length in m of each cable inside the robot.
///
/// # Safety
/// `lengths` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_simulation_lengths(
    simulation: Option<&MovingRobot>,
    lengths: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let cables = &given(simulation)?.state().cables;
        let of = |cable: &CableMotion| cable.length;
        // SAFETY: the caller promises it.
        unsafe { store(lengths, count, cables.iter().map(of), "lengths") }
    })
}
