//! The Cosserat rod with continuous cables: against the literature and closed forms, against a second
//! formulation, and what must hold for any robot. One module for each subject, in one binary: to run one
//! of them, `cargo test -p whipcord --test mechanics cosserat::MODULE::`.

mod backbones;
mod benchmarks;
mod bent_rods;
mod branches;
mod closed_forms;
mod columns;
mod compliance;
mod contradictions;
mod distributed;
mod dual_numbers;
mod follower;
mod friction;
mod lengths;
mod load_properties;
mod one_equilibrium;
mod properties;
mod refusals;
mod second_formulation;
mod stability;
mod strong_loads;
mod study;
mod tendons;
