//! Estimates of what a robot is from what was seen of it.

mod columns;
mod coverage;
mod estimates;
mod refusals;
mod shared;
mod synthetic;
