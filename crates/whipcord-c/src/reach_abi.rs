//! Inverse problems, for C.

#![allow(unsafe_code, reason = "functions of the C interface take pointers")]

use core::ffi::c_char;

use whipcord::Vec3;

use crate::pointer::{give, numbers, store, store_one, text};
use crate::reach::Reach;
use crate::robot::{POSE, RobotFile};
use crate::status::{Failure, Status, guard, guarded};
use crate::values::{CommandKind, ReachResult};

fn given<T>(handle: Option<T>) -> Result<T, Failure> {
    handle.ok_or_else(|| Failure::null("reach"))
}

/// What finds the commands for targets, by a model; NULL is "cosserat". Limits, tolerances and preference are those of the file; the commands are
/// those that the file gives: the motors where there are some, else tensions or shortenings. `*reach` is then to be freed by `whipcord_reach_free`;
/// after a failure it is NULL.
///
/// # Safety
/// `model` is NULL or a text that ends with a zero, `reach` leads to memory for a pointer or is NULL, which is an error.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_new(
    robot: Option<&RobotFile>,
    model: *const c_char,
    reach: *mut *mut Reach,
) -> Status {
    guard(|| {
        // SAFETY: the caller promises it.
        unsafe {
            give(reach, "reach", || {
                let robot = robot.ok_or_else(|| Failure::null("robot"))?;
                let model = if model.is_null() { "cosserat" } else { text(model, "model")? };
                Reach::new(robot, model)
            })
        }
    })
}

/// Frees it; NULL is ignored.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_reach_free(reach: Option<Box<Reach>>) {
    guarded((), || drop(reach));
}

/// Number of commands; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_reach_command_count(reach: Option<&Reach>) -> usize {
    reach.map_or(0, Reach::command_count)
}

/// What a command is, and the number of its cable or motor from 0.
///
/// # Safety
/// `kind` and `number` are NULL, which is an error, or lead to memory for one value each.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_command(
    reach: Option<&Reach>,
    command: usize,
    kind: *mut CommandKind,
    number: *mut usize,
) -> Status {
    guard(|| {
        let reach = given(reach)?;
        let (of, place) = reach.actuator(command).ok_or_else(|| {
            let count = reach.command_count();
            let message = format!("there is no command {command}: there are {count}, from 0 on");
            Failure::new(Status::InvalidArgument, message)
        })?;
        // SAFETY: the caller promises it.
        unsafe {
            store_one(kind, of, "kind")?;
            store_one(number, place, "number")
        }
    })
}

/// Finds the commands that bring the tip to a point in the world, in m. A target that is not reached is no failure: the result says it.
///
/// # Safety
/// `point` is NULL or leads to 3 numbers, `result` is NULL or leads to memory for the structure.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_tip(
    reach: Option<&mut Reach>,
    point: *const f64,
    result: *mut ReachResult,
) -> Status {
    guard(|| {
        let reach = given(reach)?;
        // SAFETY: the caller promises it.
        let of = unsafe { numbers(point, 3, 3, "point")? };
        let found = reach.tip(Vec3::new(of[0], of[1], of[2]))?;
        // SAFETY: the caller promises it.
        unsafe { store_one(result, found, "result") }
    })
}

/// The same for a pose of the tip: x, y, z in m, quaternion w, x, y, z.
///
/// # Safety
/// `pose` is NULL or leads to 7 numbers, `result` is NULL or leads to memory for the structure.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_pose(
    reach: Option<&mut Reach>,
    pose: *const f64,
    result: *mut ReachResult,
) -> Status {
    guard(|| {
        let reach = given(reach)?;
        // SAFETY: the caller promises it.
        let found = reach.pose(unsafe { numbers(pose, POSE, POSE, "pose")? })?;
        // SAFETY: the caller promises it.
        unsafe { store_one(result, found, "result") }
    })
}

/// The same for the target of the file.
///
/// # Safety
/// `result` is NULL or leads to memory for the structure.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_target(
    reach: Option<&mut Reach>,
    result: *mut ReachResult,
) -> Status {
    guard(|| {
        let found = given(reach)?.target_of_file()?;
        // SAFETY: the caller promises it.
        unsafe { store_one(result, found, "result") }
    })
}

/// The commands of the last answer, in N, m or rad.
///
/// # Safety
/// `commands` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_reach_commands(
    reach: Option<&Reach>,
    commands: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let found = given(reach)?.commands()?;
        // SAFETY: the caller promises it.
        unsafe { store(commands, count, found.iter().copied(), "commands") }
    })
}
