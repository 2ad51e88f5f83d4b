//! Spans that are alike but for a turn about the backbone.
//!
//! On a robot of evenly spaced disks and a uniform rod most spans are: without load they then bend
//! alike too, and one has to be solved for all of them.

use core::ops::Range;

use whipcord_numerics::{UnitQuaternion, Vec3};

use super::between_disks::Span;
use crate::section::Section;
use crate::statics::grid::Grid;

/// An earlier span that this one is when it is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RepeatedSpan {
    pub of: usize,
    /// About the z axis.
    pub turn: UnitQuaternion,
}

/// Lengths and stiffnesses that differ by less than this part are the same.
const ROUNDING: f64 = 1e-13;

/// The first span that each one is like, if any comes before it.
pub(super) fn find(
    spans: &[Span],
    grid: &Grid,
    steps: &[Range<usize>],
) -> Vec<Option<RepeatedSpan>> {
    let mut repeated_spans: Vec<Option<RepeatedSpan>> = Vec::with_capacity(spans.len());
    for k in 0..spans.len() {
        let mut first = (0..k).filter(|&of| repeated_spans[of].is_none());
        let repeated = first.find_map(|of| {
            let turn = turn_between(&spans[of], &spans[k])?;
            let turned = turn != UnitQuaternion::IDENTITY;
            rods_alike(grid, steps[of].clone(), steps[k].clone(), turned)
                .then_some(RepeatedSpan { of, turn })
        });
        repeated_spans.push(repeated);
    }
    repeated_spans
}

/// The turn that takes the holes of one span to those of the other.
fn turn_between(one: &Span, other: &Span) -> Option<UnitQuaternion> {
    if one.passages.len() != other.passages.len() {
        return None;
    }
    let pairs = one.passages.iter().zip(&other.passages);
    if pairs.clone().any(|(a, b)| (a.reach - b.reach).abs() > ROUNDING) {
        return None;
    }
    let holes = || pairs.clone().flat_map(|(a, b)| [(a.near, b.near), (a.far, b.far)]);
    let reach = holes().map(|(hole, _)| hole.norm()).fold(0.0, f64::max);
    let same = |turn: &UnitQuaternion| {
        holes().all(|(a, b)| (turn.rotate(a) - b).max_abs() <= ROUNDING * reach)
    };
    if same(&UnitQuaternion::IDENTITY) {
        return Some(UnitQuaternion::IDENTITY);
    }
    let (from, to) = holes().find(|(hole, _)| hole.norm() == reach)?;
    let angle = to.y.atan2(to.x) - from.y.atan2(from.x);
    let turn = UnitQuaternion::exp(Vec3::new(0.0, 0.0, angle));
    same(&turn).then_some(turn)
}

/// Whether the rod is the same in both spans, and where one is turned the same all round.
fn rods_alike(grid: &Grid, one: Range<usize>, other: Range<usize>, turned: bool) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs();
    let steps = one.clone().zip(other.clone());
    one.len() == other.len()
        && steps.clone().all(|(a, b)| near(grid.steps[a].length, grid.steps[b].length))
        && steps.clone().all(|(a, b)| {
            (0..5).all(|node| {
                let section = |k: usize| &grid.shooting.at(k, node, 0).0.section;
                sections_alike(section(a), section(b)) && (!turned || round(section(a)))
            })
        })
}

fn sections_alike(a: &Section, b: &Section) -> bool {
    let near = |a: Vec3, b: Vec3| (a - b).max_abs() <= ROUNDING * a.max_abs();
    near(a.compliance.shear, b.compliance.shear)
        && near(a.compliance.bending, b.compliance.bending)
        && near(a.rest_curvature, b.rest_curvature)
        && a.beside == b.beside
}

fn round(section: &Section) -> bool {
    let u = section.rest_curvature;
    section.isotropic && u.x == 0.0 && u.y == 0.0
}
