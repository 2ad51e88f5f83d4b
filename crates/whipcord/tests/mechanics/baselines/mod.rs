//! The baseline models against closed forms, against the rods and against each other.

mod constant_curvature;
mod derivatives;
mod sections;
