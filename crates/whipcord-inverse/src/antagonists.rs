//! Tensions of cables that pull against one another, with what they have in common apart: the common pull hardly bends the robot, so that a proof need not divide it as
//! finely as the rest.
//!
//! Of cables whose offsets cancel, `Σ wᵢ rᵢ = 0` with `wᵢ > 0` all along, each choice of tensions has a cable k whose tension is the least, and
//!
//! ```text
//! τᵢ = loᵢ + c wᵢ + σᵢ,   0 ≤ σᵢ ≤ hiᵢ − loᵢ,   σₖ = 0,   c wᵢ + σᵢ ≤ hiᵢ − loᵢ                (12a)
//! ```

use whipcord::{Robot, Vec3};

/// A part of all tensions within their limits, in coordinates of its own.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// The tensions where all coordinates are zero, in N.
    origin: Vec<f64>,
    /// The tensions by each coordinate.
    pub edges: Vec<Vec<f64>>,
    /// The least and the greatest of each coordinate.
    pub ranges: Vec<[f64; 2]>,
    /// Cables whose common pull is a coordinate.
    groups: Vec<Group>,
}

#[derive(Clone, Debug)]
struct Group {
    /// The coordinate `c`.
    common: usize,
    members: Vec<Member>,
}

#[derive(Clone, Debug)]
struct Member {
    weight: f64,
    /// The coordinate `σᵢ`; none of the cable with the least tension.
    more: Option<usize>,
    /// `hiᵢ − loᵢ`.
    most: f64,
}

/// Cables whose offsets cancel with these weights.
type Antagonists = Vec<(usize, f64)>;

impl Piece {
    /// All pieces of the tensions within these limits.
    pub fn all(robot: &Robot, limits: &[[f64; 2]]) -> Vec<Self> {
        let groups = antagonists(robot);
        let mut pieces = vec![Vec::new()];
        for group in &groups {
            let with = |least: usize| {
                move |piece: &Vec<usize>| -> Vec<usize> {
                    piece.iter().copied().chain([least]).collect()
                }
            };
            pieces = (0..group.len()).flat_map(|k| pieces.iter().map(with(k))).collect();
        }
        pieces.iter().map(|least| Self::of(&groups, least, limits)).collect()
    }

    fn of(groups: &[Antagonists], least: &[usize], limits: &[[f64; 2]]) -> Self {
        let n = limits.len();
        let width = |cable: usize| limits[cable][1] - limits[cable][0];
        let mut piece = Self {
            origin: limits.iter().map(|[lo, _]| *lo).collect(),
            edges: Vec::with_capacity(n),
            ranges: Vec::with_capacity(n),
            groups: Vec::new(),
        };
        let unit = |cable: usize| (0..n).map(|i| f64::from(u8::from(i == cable))).collect();
        for (group, &least) in groups.iter().zip(least) {
            let common = piece.edges.len();
            let mut edge = vec![0.0; n];
            group.iter().for_each(|&(cable, weight)| edge[cable] = weight);
            piece.edges.push(edge);
            let most = group.iter().map(|&(cable, weight)| width(cable) / weight);
            piece.ranges.push([0.0, most.fold(f64::INFINITY, f64::min)]);
            let mut members = Vec::new();
            for (k, &(cable, weight)) in group.iter().enumerate() {
                let more = (k != least).then_some(piece.edges.len());
                if more.is_some() {
                    piece.edges.push(unit(cable));
                    piece.ranges.push([0.0, width(cable)]);
                }
                members.push(Member { weight, more, most: width(cable) });
            }
            piece.groups.push(Group { common, members });
        }
        let is_alone = |cable: &usize| groups.iter().flatten().all(|(of, _)| of != cable);
        for cable in (0..n).filter(is_alone) {
            piece.edges.push(unit(cable));
            piece.ranges.push([0.0, width(cable)]);
        }
        piece
    }

    /// The tensions at coordinates.
    pub fn tensions(&self, at: &[f64], tensions: &mut Vec<f64>) {
        tensions.clone_from(&self.origin);
        for (edge, x) in self.edges.iter().zip(at) {
            tensions.iter_mut().zip(edge).for_each(|(tension, by)| *tension += x * by);
        }
    }

    /// The least of `Σ gₖ (xₖ − centerₖ)` over what of a box is within the limits; `None` where nothing is.
    pub fn least(&self, gradient: &[f64], center: &[f64], half: &[f64]) -> Option<f64> {
        let mut sum: f64 = gradient.iter().zip(half).map(|(g, h)| -g.abs() * h).sum();
        for Group { common, members } in &self.groups {
            let ends = |k: usize| [center[k] - half[k], center[k] + half[k]];
            let [low, high] = common_pull(*common, members, ends)?;
            // Convex in c: it is least at an end or where a tension gets to its limit.
            let at = |c: f64| -> f64 {
                let others = members.iter().filter_map(|Member { weight, more, most }| {
                    let k = (*more)?;
                    let [least, greatest] = ends(k);
                    let x = match gradient[k] < 0.0 {
                        true => greatest.min(most - weight * c).max(least),
                        false => least,
                    };
                    Some(gradient[k] * (x - center[k]))
                });
                gradient[*common] * (c - center[*common]) + others.sum::<f64>()
            };
            let corners = members.iter().filter_map(|Member { weight, more, most }| {
                Some((most - ends((*more)?)[1]) / weight).filter(|c| low < *c && *c < high)
            });
            let least = corners.chain([low, high]).map(at).fold(f64::INFINITY, f64::min);
            let whole = members.iter().filter_map(|member| member.more).chain([*common]);
            sum += least + whole.map(|k| gradient[k].abs() * half[k]).sum::<f64>();
        }
        Some(sum)
    }

    /// Whether anything of a box is within the limits.
    pub fn has_part_of(&self, center: &[f64], half: &[f64]) -> bool {
        let ends = |k: usize| [center[k] - half[k], center[k] + half[k]];
        self.groups
            .iter()
            .all(|Group { common, members }| common_pull(*common, members, ends).is_some())
    }

    /// Writes the rows `A (x − center) ≤ b` of the limits that a box reaches beyond.
    pub fn rows(&self, center: &[f64], half: &[f64], rows: &mut Vec<f64>, limits: &mut Vec<f64>) {
        rows.clear();
        limits.clear();
        let n = center.len();
        for Group { common, members } in &self.groups {
            for Member { weight, more, most } in members {
                let Some(k) = *more else { continue };
                let left = most - weight * center[*common] - center[k];
                if weight * half[*common] + half[k] > left {
                    let first = rows.len();
                    rows.resize(first + n, 0.0);
                    rows[first + common] = *weight;
                    rows[first + k] = 1.0;
                    limits.push(left);
                }
            }
        }
    }
}

/// The least and the greatest common pull that the limits leave of a box, with the ends of its coordinates; `None` where they leave nothing.
fn common_pull(
    common: usize,
    members: &[Member],
    ends: impl Fn(usize) -> [f64; 2],
) -> Option<[f64; 2]> {
    let [low, mut high] = ends(common);
    for Member { weight, more, most } in members {
        let least = more.map_or(0.0, |k| ends(k)[0]);
        high = high.min((most - least) / weight);
    }
    (low <= high).then_some([low, high])
}

/// Two or three cables to the same place whose offsets cancel all along, each cable in one group at most.
fn antagonists(robot: &Robot) -> Vec<Antagonists> {
    /// Places along a cable, and what of an offset may be left.
    const PLACES: usize = 9;
    const PART: f64 = 1e-6;
    let routes = robot.routes();
    let n = routes.len();
    let offset = |cable: usize, place: usize| {
        let end = routes[cable].end();
        routes[cable].at(end * (place as f64 + 0.5) / PLACES as f64).offset
    };
    let cancel = |group: &Antagonists| {
        (0..PLACES).all(|place| {
            let each = || group.iter().map(|&(cable, weight)| offset(cable, place) * weight);
            let size = each().fold(0.0, |most: f64, of| most.max(of.norm()));
            size > 0.0 && each().fold(Vec3::ZERO, |sum, of| sum + of).norm() <= PART * size
        })
    };
    let mut is_taken = vec![false; n];
    let mut groups: Vec<Antagonists> = Vec::new();
    let mut take = |group: Antagonists, is_taken: &mut Vec<bool>| {
        let is_free = group.iter().all(|&(cable, _)| !is_taken[cable]);
        let ends = |&(cable, _): &(usize, f64)| routes[cable].end() == routes[group[0].0].end();
        let is_positive = group.iter().all(|&(_, weight)| weight > 0.0 && weight.is_finite());
        if is_free && is_positive && group.iter().all(ends) && cancel(&group) {
            group.iter().for_each(|&(cable, _)| is_taken[cable] = true);
            groups.push(group);
        }
    };
    for a in 0..n {
        for b in a + 1..n {
            let weight = offset(a, 0).norm() / offset(b, 0).norm();
            take(vec![(a, 1.0), (b, weight)], &mut is_taken);
        }
    }
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                let [ra, rb, rc] = [a, b, c].map(|cable| offset(cable, 0));
                let cross = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
                // ra + β rb + γ rc = 0.
                let area = cross(rb, rc);
                let weights = [-cross(ra, rc) / area, -cross(rb, ra) / area];
                take(vec![(a, 1.0), (b, weights[0]), (c, weights[1])], &mut is_taken);
            }
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks, Routing};

    /// Three cables to the middle and a pair to the tip.
    fn robot() -> Robot {
        let cable = |name: &str, degrees: f64, radius: f64, ends_at: Option<f64>| {
            let routing = Routing::Straight { angle: degrees.to_radians(), radius };
            Cable { ends_at, ..Cable::new(name, routing) }
        };
        let cables = vec![
            cable("a", 0.0, 0.006, Some(0.1)),
            cable("b", 120.0, 0.008, Some(0.1)),
            cable("c", 60.0, 0.008, None),
            cable("d", 250.0, 0.008, Some(0.1)),
            cable("e", 240.0, 0.004, None),
            cable("f", 10.0, 0.008, None),
        ];
        Robot::new(Backbone::new(0.18), Disks::equally_spaced(0.18, 10, 0.008), cables).unwrap()
    }

    #[test]
    fn pieces_cover_all_tensions_and_their_bounds_are_those_of_samples() {
        let limits = [[0.1, 2.0], [0.0, 3.0], [0.2, 4.0], [0.0, 1.0], [0.5, 2.0], [0.0, 1.0]];
        let pieces = Piece::all(&robot(), &limits);
        assert_eq!(pieces.len(), 6);
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 11) as f64 / 9_007_199_254_740_992.0
        };
        let mut tensions = Vec::new();
        for _ in 0..200 {
            let gradient: Vec<f64> = (0..6).map(|_| next() - 0.5).collect();
            for piece in &pieces {
                let center: Vec<f64> =
                    piece.ranges.iter().map(|[a, b]| a + next() * (b - a)).collect();
                let half: Vec<f64> = piece.ranges.iter().map(|[a, b]| 0.3 * (b - a)).collect();
                let least = piece.least(&gradient, &center, &half);
                let mut sampled = f64::INFINITY;
                for _ in 0..200 {
                    // Corners of the box, and points of its edges.
                    let mut part = || (6.0 * next() - 3.0).clamp(-1.0, 1.0);
                    let x: Vec<f64> =
                        center.iter().zip(&half).map(|(c, h)| c + part() * h).collect();
                    piece.tensions(&x, &mut tensions);
                    if tensions.iter().zip(limits).all(|(t, [_, hi])| *t <= hi) {
                        let sum =
                            x.iter().zip(&center).zip(&gradient).map(|((x, c), g)| g * (x - c));
                        sampled = sampled.min(sum.sum());
                    }
                }
                assert!(sampled >= least.unwrap_or(f64::INFINITY) - 1e-12);
            }
            // Each choice of tensions is in one of the pieces at least.
            let wanted: Vec<f64> = limits.iter().map(|[a, b]| a + next() * (b - a)).collect();
            let is_in = |piece: &&Piece| {
                let rows: Vec<f64> =
                    (0..6).flat_map(|i| piece.edges.iter().map(move |edge| edge[i])).collect();
                let mut lu = whipcord_numerics::DenseLu::default();
                if lu.factor(6, &rows).is_err() {
                    return false;
                }
                let mut x: Vec<f64> =
                    wanted.iter().zip(limits).map(|(t, [lo, _])| t - lo).collect();
                lu.solve(&mut x);
                x.iter().zip(&piece.ranges).all(|(x, [a, b])| (a - 1e-9..=b + 1e-9).contains(x))
            };
            assert!(pieces.iter().any(|piece| is_in(&piece)), "{wanted:?}");
        }
    }
}
