//! Sections that are others turned about the backbone, as those of a helix or of equal spans are, or on the way back, as those of a routing that winds
//! and unwinds are: one is solved for all of them.
//!
//! A section shall be equally stiff about x and y and straight at rest. Where its cables cross it as they cross another one but for a turn `Q` about z, its
//! strain under the same tensions is `(Q v, Q u)` with that of the other one. On the way back slopes across the backbone have the other sign,
//! `r′ = Q D r₁′` with `D = diag(−1, −1, 1)`. As `D (u × r) = (−D u) × r` for offsets `r` across the backbone, the strain is `(Q D v, −Q D u)`, whose cables pull by `Q D t`
//! and have the moments `−Q D (r × t)`; the rod must not be twisted at rest.

use whipcord_numerics::Vec3;

use super::section_table::Place;
use crate::section::{Crossing, Strain};

/// What two crossings may differ by, as parts of the greatest offset, and as slopes: some rounding.
const ALIKE: f64 = 1e-13;
/// Sections of the same key that are compared at most.
const COMPARED: usize = 4;

/// A section that is an earlier one, turned or on the way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TurnedSection {
    /// Among the places, or the nodes of the grid.
    pub node: usize,
    pub of: usize,
    pub turn: Turn,
}

/// `Q`, and whether the section is that on the way back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    pub cos: f64,
    pub sin: f64,
    /// Of slopes across the backbone: -1 on the way back.
    pub slope_sign: f64,
}

impl Turn {
    /// `Q` by a vector.
    #[inline]
    fn turned(self, v: Vec3) -> Vec3 {
        let Self { cos, sin, .. } = self;
        Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    }

    /// `Q` by a slope or the strain of extension and shear, on the way back `Q D` by it.
    #[inline]
    fn slope(self, v: Vec3) -> Vec3 {
        let v = self.turned(v);
        Vec3::new(self.slope_sign * v.x, self.slope_sign * v.y, v.z)
    }

    /// The strain of the section by that of the other one.
    #[inline]
    pub fn strain(self, Strain { linear, angular }: Strain) -> Strain {
        let u = self.turned(angular);
        Strain { linear: self.slope(linear), angular: Vec3::new(u.x, u.y, self.slope_sign * u.z) }
    }

    /// What takes one set of crossings to another, to rounding.
    fn between(of: &[Crossing], to: &[Crossing]) -> Option<Self> {
        let radius = of.iter().fold(0.0, |radius: f64, at| radius.max(at.offset.norm()));
        let (a, b) = of.iter().zip(to).find_map(|(a, b)| {
            // That of the greatest offset turns the others most exactly.
            (a.offset.norm() == radius).then_some((a.radial, b.radial))
        })?;
        let forth =
            Self { cos: a.x * b.x + a.y * b.y, sin: a.x * b.y - a.y * b.x, slope_sign: 1.0 };
        [forth, Self { slope_sign: -1.0, ..forth }].into_iter().find(|turn| {
            of.iter().zip(to).all(|(a, b)| {
                (turn.turned(a.offset) - b.offset).max_abs() <= ALIKE * radius
                    && (turn.slope(a.slope) - b.slope).max_abs() <= ALIKE
            })
        })
    }
}

/// The places whose sections are earlier ones, turned or on the way back, in the order of the rod; all of them have the same number of cables.
pub(crate) fn turned_sections(places: &[Place<'_>]) -> Vec<TurnedSection> {
    // Sections that are none turned, by their keys in ascending order.
    let mut known: Vec<(f64, usize)> = Vec::new();
    let mut turned = Vec::new();
    for (node, place) in places.iter().enumerate() {
        let rest = place.section.rest_curvature;
        if !place.section.isotropic || rest.x != 0.0 || rest.y != 0.0 {
            continue;
        }
        let (key, error) = key(place.crossings);
        let first = known.partition_point(|(of, _)| *of < key - error);
        let near = known[first..].iter().take_while(|(of, _)| *of <= key + error);
        let found = near.take(COMPARED).find_map(|&(_, of)| {
            let other = &places[of];
            if other.section != place.section {
                return None;
            }
            let turn = Turn::between(other.crossings, place.crossings)?;
            (turn.slope_sign > 0.0 || rest.z == 0.0).then_some(TurnedSection { node, of, turn })
        });
        match found {
            Some(found) => turned.push(found),
            None => {
                let behind = known.partition_point(|(of, _)| *of <= key);
                known.insert(behind, (key, node));
            }
        }
    }
    turned
}

/// A number of crossings that neither a turn nor the way changes, and its rounding.
fn key(crossings: &[Crossing]) -> (f64, f64) {
    let (mut key, mut error): (f64, f64) = (0.0, 0.0);
    for (cable, Crossing { offset, slope, .. }) in crossings.iter().enumerate() {
        // Another share of what runs along the offset and across it for each cable.
        let share = 1.0 / (1.0 + cable as f64);
        let (along, across) = (offset.dot(*slope), offset.x * slope.y - offset.y * slope.x);
        key += share * (along + 0.5 * across);
        error += ALIKE * offset.norm() * (1.0 + slope.norm());
    }
    (key.abs(), error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::{BodyWrench, Section, Stiffness, equilibrium};

    const TURNS: [f64; 4] = [0.0, 0.3, 2.9, -1.4];

    fn section(bending: Vec3, rest: Vec3) -> Section {
        Section::new(Stiffness { shear: Vec3::new(50.0, 50.0, 130.0), bending }, rest)
    }

    /// Two cables at so much of a span, and all of them turned.
    fn crossings(share: f64, angle: f64) -> Vec<Crossing> {
        let (sin, cos) = angle.sin_cos();
        let turn = Turn { cos, sin, slope_sign: 1.0 };
        let at = |from: Vec3, to: Vec3| {
            let offset = from + (to - from) * share;
            Crossing::new(turn.turned(offset), turn.turned((to - from) * (1.0 / 0.02)))
        };
        vec![
            at(Vec3::new(0.007, 0.0, 0.0), Vec3::new(0.006, 0.003, 0.0)),
            at(Vec3::new(-0.003, 0.006, 0.0), Vec3::new(-0.008, 0.001, 0.0)),
        ]
    }

    fn find(section: &Section, all: &[Vec<Crossing>]) -> Vec<TurnedSection> {
        let places: Vec<Place<'_>> = all
            .iter()
            .enumerate()
            .map(|(k, crossings)| Place { section, crossings, arc_length: k as f64 })
            .collect();
        turned_sections(&places)
    }

    #[test]
    fn equal_spans_that_are_turned_are_found() {
        let round = section(Vec3::new(2.0, 2.0, 1.6), Vec3::new(0.0, 0.0, 3.0));
        let shares = [0.1, 0.5, 0.9];
        let all: Vec<_> =
            TURNS.iter().flat_map(|turn| shares.map(|share| crossings(share, *turn))).collect();
        let turned = find(&round, &all);
        assert_eq!(turned.len(), 9);
        for TurnedSection { node, of, turn } in turned {
            assert_eq!(of, node % 3);
            let (sin, cos) = TURNS[node / 3].sin_cos();
            assert!((turn.cos - cos).abs() < 1e-15 && (turn.sin - sin).abs() < 1e-15);
            assert!(turn.slope_sign > 0.0);
        }
    }

    #[test]
    fn strains_are_those_of_the_sections_themselves() {
        let round = section(Vec3::new(2.0e-3, 2.0e-3, 1.6e-3), Vec3::ZERO);
        let back = crossings(0.3, 1.1)
            .iter()
            .map(|at| Crossing::new(at.offset, Vec3::new(-at.slope.x, -at.slope.y, 0.0)))
            .collect();
        let all = [crossings(0.3, 0.0), crossings(0.3, -2.0), back];
        let turned = find(&round, &all);
        assert_eq!(turned.iter().map(|of| of.turn.slope_sign).collect::<Vec<_>>(), [1.0, -1.0]);
        let solve = |crossings: &[Crossing]| {
            let mut strain = round.rest_strain();
            equilibrium(&round, crossings, &[2.0, 0.7], BodyWrench::default(), &mut strain)
                .unwrap();
            strain
        };
        for TurnedSection { node, of, turn } in turned {
            let (strain, expected) = (turn.strain(solve(&all[of])), solve(&all[node]));
            assert!((strain.linear - expected.linear).max_abs() < 1e-12, "{node}");
            assert!((strain.angular - expected.angular).max_abs() < 1e-9, "{node}");
            assert!(expected.angular.x.abs() > 0.1 && expected.angular.z.abs() > 0.1);
        }
        // A twist at rest has another sign on the way back.
        let twisted = section(Vec3::new(2.0, 2.0, 1.6), Vec3::new(0.0, 0.0, 3.0));
        assert_eq!(find(&twisted, &all).len(), 1);
    }

    #[test]
    fn what_differs_is_not_taken_for_another_section_turned() {
        let round = section(Vec3::new(2.0, 2.0, 1.6), Vec3::ZERO);
        let mut other = crossings(0.5, 0.7);
        other[1].slope.x += 1e-9;
        assert!(find(&round, &[crossings(0.5, 0.0), other]).is_empty());
        let at_rest = crossings(0.5, 0.0);
        let mirrored = at_rest.iter().map(|at| {
            let flip = |v: Vec3| Vec3::new(v.x, -v.y, v.z);
            Crossing::new(flip(at.offset), flip(at.slope))
        });
        let mirrored = mirrored.collect();
        assert!(find(&round, &[crossings(0.5, 0.0), mirrored]).is_empty());
        let all = [crossings(0.5, 0.0), crossings(0.5, 0.7)];
        assert_eq!(find(&round, &all).len(), 1);
        // Another bending stiffness about x and y, or a bend at rest.
        assert!(find(&section(Vec3::new(2.0, 2.1, 1.6), Vec3::ZERO), &all).is_empty());
        assert!(find(&section(Vec3::new(2.0, 2.0, 1.6), Vec3::X), &all).is_empty());
    }
}
