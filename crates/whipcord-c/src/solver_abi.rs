//! Solves, for C.

#![allow(unsafe_code, reason = "functions of the C interface take pointers")]

use core::ffi::c_char;

use whipcord::{CableState, Vec3};

use crate::pointer::{flags, give, numbers, store, store_one, text};
use crate::robot::{POSE, RobotFile, pose_values, poses_values};
use crate::solver::Solver;
use crate::status::{Failure, Status, guard, guarded};
use crate::values::Diagnostics;

fn given<T>(handle: Option<T>) -> Result<T, Failure> {
    handle.ok_or_else(|| Failure::null("solver"))
}

/// A solver for a robot by a model, such as "cosserat"; NULL is "cosserat". It starts with the commands and loads of the file. It does not
/// need the robot any more. `*solver` is then to be freed by `whipcord_solver_free`; after a failure it is NULL.
///
/// # Safety
/// `model` is NULL or a text that ends with a zero, `solver` leads to memory for a pointer or is NULL, which is an error.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_new(
    robot: Option<&RobotFile>,
    model: *const c_char,
    solver: *mut *mut Solver,
) -> Status {
    guard(|| {
        // SAFETY: the caller promises it.
        unsafe {
            give(solver, "solver", || {
                let robot = robot.ok_or_else(|| Failure::null("robot"))?;
                let model = if model.is_null() { "cosserat" } else { text(model, "model")? };
                Solver::new(robot, model)
            })
        }
    })
}

/// Frees a solver; NULL is ignored.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_solver_free(solver: Option<Box<Solver>>) {
    guarded((), || drop(solver));
}

/// Goes back to the commands and loads of the file, and forgets the last solution: the next solve is one from cold.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_solver_reset(solver: Option<&mut Solver>) -> Status {
    guard(|| {
        given(solver)?.reset();
        Ok(())
    })
}

/// What each solve may spend at most: Newton iterations, and integration steps of all shapes that are tried. Work is counted, not time.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_solver_set_budget(
    solver: Option<&mut Solver>,
    iterations: usize,
    integration_steps: usize,
) -> Status {
    guard(|| {
        given(solver)?.set_budget(iterations, integration_steps);
        Ok(())
    })
}

/// Estimated error of positions and lengths as a part of the length of the backbone, from 1e-13 to 0.01; 1e-6 is what a solver begins with. Models
/// whose sections are their discretisation have none to choose, and ignore it. It allocates memory. The last solution stays.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_solver_set_tolerance(
    solver: Option<&mut Solver>,
    tolerance: f64,
) -> Status {
    guard(|| given(solver)?.set_tolerance(tolerance))
}

/// Commands every cable by its tension in N. The commands before are kept where this fails.
///
/// # Safety
/// `tensions` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_set_tensions(
    solver: Option<&mut Solver>,
    tensions: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let solver = given(solver)?;
        let cables = solver.file().robot.cables().len();
        // SAFETY: the caller promises it.
        solver.set_tensions(unsafe { numbers(tensions, count, cables, "tensions")? })
    })
}

/// Commands every cable by its shortening in m. The commands before are kept where this fails.
///
/// # Safety
/// `shortenings` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_set_shortenings(
    solver: Option<&mut Solver>,
    shortenings: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let solver = given(solver)?;
        let cables = solver.file().robot.cables().len();
        // SAFETY: the caller promises it.
        solver.set_shortenings(unsafe { numbers(shortenings, count, cables, "shortenings")? });
        Ok(())
    })
}

/// Commands each cable in its own way: by its tension in N where its flag is 0, by its shortening in m where it is 1. The commands before are
/// kept where this fails.
///
/// # Safety
/// `commands` and `by_shortening` are NULL or lead to `count` numbers and `count` bytes.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_set_commands(
    solver: Option<&mut Solver>,
    commands: *const f64,
    by_shortening: *const u8,
    count: usize,
) -> Status {
    guard(|| {
        let solver = given(solver)?;
        let cables = solver.file().robot.cables().len();
        // SAFETY: the caller promises it.
        let (commands, by_shortening) = unsafe {
            (
                numbers(commands, count, cables, "commands")?,
                flags(by_shortening, count, cables, "by_shortening")?,
            )
        };
        solver.set_commands(commands, by_shortening)
    })
}

/// Commands every motor: its angle in rad, or its travel in m. Cables without a motor keep their commands. The commands before are kept where this fails.
///
/// # Safety
/// `commands` is NULL or leads to `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_set_motors(
    solver: Option<&mut Solver>,
    commands: *const f64,
    count: usize,
) -> Status {
    guard(|| {
        let solver = given(solver)?;
        let motors = solver.file().robot.motors().len();
        // SAFETY: the caller promises it.
        solver.set_motors(unsafe { numbers(commands, count, motors, "commands")? })
    })
}

/// Sets force in N and moment in N·m at the tip, in the frame that the file gives its loads in; NULL is none. All other loads stay.
///
/// # Safety
/// `force` and `moment` are NULL or lead to 3 numbers each.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_set_tip_load(
    solver: Option<&mut Solver>,
    force: *const f64,
    moment: *const f64,
) -> Status {
    guard(|| {
        let solver = given(solver)?;
        let vector = |pointer: *const f64, what: &str| -> Result<Vec3, Failure> {
            if pointer.is_null() {
                return Ok(Vec3::ZERO);
            }
            // SAFETY: the caller promises it.
            let of = unsafe { numbers(pointer, 3, 3, what)? };
            Ok(Vec3::new(of[0], of[1], of[2]))
        };
        let (force, moment) = (vector(force, "force")?, vector(moment, "moment")?);
        solver.set_tip_load(force, moment);
        Ok(())
    })
}

/// Solves for the commands and loads at hand. The first solve starts from the robot without load, and goes through the steps of the file;
/// each other one starts from the solution before, and without obstacles and friction allocates nothing once the solver has its memory, but by "four-bar". After a failure the solution
/// before is kept, and so are the new commands. `WHIPCORD_STATUS_BUDGET_SPENT` comes with a solution, the best shape so far.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub extern "C" fn whipcord_solver_solve(solver: Option<&mut Solver>) -> Status {
    guard(|| given(solver)?.solve())
}

/// The pose of the tip in the world: x, y, z in m, quaternion w, x, y, z.
///
/// # Safety
/// `pose` is NULL or leads to memory for 7 numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_tip_pose(
    solver: Option<&Solver>,
    pose: *mut f64,
) -> Status {
    guard(|| {
        let tip = given(solver)?.solution()?.disks.tip();
        // SAFETY: the caller promises it.
        unsafe { store(pose, POSE, pose_values(tip).into_iter(), "pose") }
    })
}

/// The poses of all disks from the base on, 7 numbers each as in `whipcord_solver_tip_pose`.
///
/// # Safety
/// `poses` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_disk_poses(
    solver: Option<&Solver>,
    poses: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let disks = &given(solver)?.solution()?.disks.poses;
        // SAFETY: the caller promises it.
        unsafe { store(poses, count, poses_values(disks), "poses") }
    })
}

/// The tension of each cable in N. `WHIPCORD_STATUS_UNAVAILABLE` by a model that computes none.
///
/// # Safety
/// `tensions` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_tensions(
    solver: Option<&Solver>,
    tensions: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let solved = given(solver)?.tensions()?;
        // SAFETY: the caller promises it.
        unsafe { store(tensions, count, solved, "tensions") }
    })
}

/// The length in m of each cable inside the robot.
///
/// # Safety
/// `lengths` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_lengths(
    solver: Option<&Solver>,
    lengths: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let cables = &given(solver)?.solution()?.cables;
        let of = |cable: &CableState| cable.length;
        // SAFETY: the caller promises it.
        unsafe { store(lengths, count, cables.iter().map(of), "lengths") }
    })
}

/// For each cable 1 where it is slack, else 0.
///
/// # Safety
/// `slack` is NULL or leads to memory for `count` bytes.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_slack(
    solver: Option<&Solver>,
    slack: *mut u8,
    count: usize,
) -> Status {
    guard(|| {
        let cables = &given(solver)?.solution()?.cables;
        let of = |cable: &CableState| u8::from(cable.slack);
        // SAFETY: the caller promises it.
        unsafe { store(slack, count, cables.iter().map(of), "slack") }
    })
}

/// How the solution was obtained.
///
/// # Safety
/// `diagnostics` is NULL or leads to memory for the structure.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_diagnostics(
    solver: Option<&Solver>,
    diagnostics: *mut Diagnostics,
) -> Status {
    guard(|| {
        let of = given(solver)?.diagnostics()?;
        // SAFETY: the caller promises it.
        unsafe { store_one(diagnostics, of, "diagnostics") }
    })
}

/// The Jacobian of the tip at the last solution, before commands are set anew: 6 rows of one column for each cable, row by row. The rows are the
/// velocity of the tip's point in m and its angular velocity in rad, in the world, for each N or m of the command of the
/// cable. Without obstacles and friction it allocates nothing once the solver has its memory, but by "four-bar".
///
/// # Safety
/// `jacobian` is NULL or leads to memory for `count` numbers.
// SAFETY: no other symbol has this name.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn whipcord_solver_tip_jacobian(
    solver: Option<&mut Solver>,
    jacobian: *mut f64,
    count: usize,
) -> Status {
    guard(|| {
        let columns = given(solver)?.jacobian()?;
        let number = |i: usize| {
            let (row, column) = (i / columns.len(), columns[i % columns.len()]);
            let part = if row < 3 { column.linear } else { column.angular };
            part.to_array()[row % 3]
        };
        // SAFETY: the caller promises it.
        unsafe { store(jacobian, count, (0..6 * columns.len()).map(number), "jacobian") }
    })
}
