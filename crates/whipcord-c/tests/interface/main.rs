//! The C interface, called as C calls it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(unsafe_code, reason = "functions of the C interface take pointers")]
#![allow(clippy::undocumented_unsafe_blocks, reason = "each passes arrays with their own lengths")]

mod allocation;
mod arguments;
mod common;
mod equality;
mod header;
