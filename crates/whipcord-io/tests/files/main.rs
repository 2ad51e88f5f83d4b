//! Robot files and what is said of them: the schema, the messages, the examples and damaged files.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod atlas;
mod common;
mod damaged;
mod design;
mod examples;
mod goal;
mod materials;
mod messages;
mod motion;
mod motors;
mod reading;
mod schema;
mod segments;
mod tables;
