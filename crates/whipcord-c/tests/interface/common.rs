//! Handles that free themselves.

use std::ffi::{CStr, CString};
use std::ptr;

use whipcord_c::{
    MovingRobot, Reach, RobotFile, Solver, Status, whipcord_last_error, whipcord_reach_new,
    whipcord_robot_load, whipcord_robot_parse, whipcord_simulation_new, whipcord_solver_new,
};

/// The examples of the repository.
pub fn example(name: &str) -> String {
    format!("{}/../../examples/{name}", env!("CARGO_MANIFEST_DIR"))
}

pub fn c(text: &str) -> CString {
    CString::new(text).unwrap()
}

pub fn message() -> String {
    unsafe { CStr::from_ptr(whipcord_last_error()) }.to_str().unwrap().to_owned()
}

/// What C has as a pointer to a handle; it is freed at the end as the functions for that do.
fn owned<T>(status: Status, handle: *mut T) -> Box<T> {
    assert_eq!(status, Status::Ok, "{}", message());
    unsafe { Box::from_raw(handle) }
}

pub fn load(name: &str) -> Box<RobotFile> {
    let mut robot = ptr::null_mut();
    let status = unsafe { whipcord_robot_load(c(&example(name)).as_ptr(), &raw mut robot) };
    owned(status, robot)
}

pub fn parse(text: &str) -> Box<RobotFile> {
    let mut robot = ptr::null_mut();
    let status = unsafe { whipcord_robot_parse(c(text).as_ptr(), ptr::null(), &raw mut robot) };
    owned(status, robot)
}

pub fn solver(robot: &RobotFile, model: &str) -> Box<Solver> {
    let mut solver = ptr::null_mut();
    let status = unsafe { whipcord_solver_new(Some(robot), c(model).as_ptr(), &raw mut solver) };
    owned(status, solver)
}

pub fn reach(robot: &RobotFile) -> Box<Reach> {
    let mut reach = ptr::null_mut();
    let status = unsafe { whipcord_reach_new(Some(robot), ptr::null(), &raw mut reach) };
    owned(status, reach)
}

pub fn simulation(robot: &RobotFile) -> Box<MovingRobot> {
    let mut simulation = ptr::null_mut();
    let status = unsafe { whipcord_simulation_new(Some(robot), &raw mut simulation) };
    owned(status, simulation)
}

/// A robot whose cables are pulled by motors with backlash.
pub const MOTORS: &str = r#"
title = "Two motors"

[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
density = "1040 kg/m^3"
damping = { time = "3 ms" }

[disks]
count = 10
hole_circle_radius = "8 mm"

[[cables]]
name = "left"
routing = { kind = "straight", angle = "0 deg", radius = "8 mm" }

[[cables]]
name = "right"
routing = { kind = "straight", angle = "90 deg", radius = "8 mm" }

[[motors]]
name = "m1"
cables = ["left"]
spool_radius = "10 mm"
angle = "6 deg"
backlash = "2 deg"

[[motors]]
name = "m2"
cables = ["right"]
spool_radius = "10 mm"
angle = "0 deg"
"#;
