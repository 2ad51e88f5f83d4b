//! The mechanics against the literature, closed forms, second formulations and other programs, and what must hold for any
//! robot. One binary: to run one module of it, `cargo test -p whipcord --release --test mechanics cosserat::lengths`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by panicking, and a study prints"
)]

mod any_model;
mod baselines;
mod common;
mod contact;
mod cosserat;
mod cosserat_disks;
mod derivatives;
mod four_bar;
mod obstacles;
mod oracle;
