//! Robot files, for C.

#![allow(unsafe_code, reason = "functions of the C interface take pointers")]

use core::ffi::c_char;
use core::ptr;

use crate::pointer::{give, text};
use crate::robot::RobotFile;
use crate::status::{Status, guard, guarded};

/// Reads a robot file, and the files that it names. `*robot` is then to be freed by `whipcord_robot_free`; after a failure it is NULL.
///
/// # Safety
/// `path` is a text that ends with a zero, `robot` leads to memory for a pointer; or they are NULL, which is an error.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_robot_load(
    path: *const c_char,
    robot: *mut *mut RobotFile,
) -> Status {
    guard(|| {
        // SAFETY: the caller promises it.
        unsafe { give(robot, "robot", || RobotFile::load(text(path, "path")?)) }
    })
}

/// Reads the text of a robot file. `name` stands for it in messages, and files that it names are looked for in the folder of `name`; it may be NULL.
///
/// # Safety
/// As `whipcord_robot_load`.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_robot_parse(
    content: *const c_char,
    name: *const c_char,
    robot: *mut *mut RobotFile,
) -> Status {
    guard(|| {
        // SAFETY: the caller promises it.
        unsafe {
            give(robot, "robot", || {
                let name = if name.is_null() { "robot.toml" } else { text(name, "name")? };
                RobotFile::parse(text(content, "content")?, name)
            })
        }
    })
}

/// Frees a robot; NULL is ignored. What was made of it stays.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_free(robot: Option<Box<RobotFile>>) {
    guarded((), || drop(robot));
}

/// The title of the file in UTF-8, valid as long as the robot; NULL for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_title(robot: Option<&RobotFile>) -> *const c_char {
    robot.map_or(ptr::null(), |robot| robot.title.as_ptr())
}

/// Number of cables; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_cable_count(robot: Option<&RobotFile>) -> usize {
    robot.map_or(0, |robot| robot.cables.len())
}

/// Number of disks; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_disk_count(robot: Option<&RobotFile>) -> usize {
    robot.map_or(0, |robot| robot.file.robot.disks().count())
}

/// Number of motors; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_motor_count(robot: Option<&RobotFile>) -> usize {
    robot.map_or(0, |robot| robot.motors.len())
}

/// Length of the backbone in m; 0 for NULL.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_length(robot: Option<&RobotFile>) -> f64 {
    robot.map_or(0.0, |robot| robot.file.robot.backbone().length)
}

/// The name of a cable in UTF-8, valid as long as the robot; NULL where there is no such cable.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_cable_name(
    robot: Option<&RobotFile>,
    cable: usize,
) -> *const c_char {
    robot.and_then(|robot| robot.cables.get(cable)).map_or(ptr::null(), |name| name.as_ptr())
}

/// The name of a motor in UTF-8, valid as long as the robot; NULL where there is no such motor.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_robot_motor_name(
    robot: Option<&RobotFile>,
    motor: usize,
) -> *const c_char {
    robot.and_then(|robot| robot.motors.get(motor)).map_or(ptr::null(), |name| name.as_ptr())
}
