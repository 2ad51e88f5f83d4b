//! Estimates of what a robot is from what was seen of it.

mod analyses;
mod columns;
mod coverage;
mod coverage_of_motors;
mod estimates;
mod holes;
mod laboratory;
mod over_determined;
mod refusals;
mod shared;
mod speed;
mod synthetic;
