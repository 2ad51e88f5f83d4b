//! The C interface of Whipcord: robot files, solves in a control loop, Jacobians, inverse problems and motions.
//!
//! The header `include/whipcord.h` is generated from these files, `include/whipcord.hpp` wraps it for C++17. The page
//! `docs/c-and-cpp.md` has the conventions. Rust programs use the crates below this one.
//!
//! This is the only crate of the workspace with unsafe code: a pointer that comes from C cannot be read otherwise. Only `pointer`
//! reads and writes through pointers; the functions of C (`*_abi`) pass them on. `solver`, `reach`, `simulation` and `robot`, which
//! compute, have no unsafe code.

mod pointer;
mod reach;
mod reach_abi;
mod robot;
mod robot_abi;
mod simulation;
mod simulation_abi;
mod solver;
mod solver_abi;
mod status;
mod values;
mod version;

pub use reach::Reach;
pub use reach_abi::*;
pub use robot::RobotFile;
pub use robot_abi::*;
pub use simulation::MovingRobot;
pub use simulation_abi::*;
pub use solver::Solver;
pub use solver_abi::*;
pub use status::{Failure, Status, whipcord_last_error};
pub use values::{CommandKind, Diagnostics, ReachOutcome, ReachResult, Stability};
pub use version::{ABI_VERSION, whipcord_abi_version, whipcord_version};
