//! What is connected above a level, row by row: of each component its area and moments, and no list of its pixels. So the
//! memory that this takes grows with the rows' length alone, however large the picture and its components are.

use crate::plane::Plane;

/// Pixels above a level that are connected by their sides.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Component {
    /// Number of its first pixel, row by row.
    first: usize,
    /// Pixels.
    pub area: u64,
    /// Whether it reaches the edge of the picture.
    pub at_edge: bool,
    /// Sums over the pixels: of columns, rows, and their products.
    u: u64,
    v: u64,
    uu: u64,
    uv: u64,
    vv: u64,
}

impl Component {
    /// Neighbouring pixels of a row.
    fn of_run([start, end]: [usize; 2], row: usize, [width, height]: [usize; 2]) -> Self {
        // Sums over what is below a number.
        let firsts = |n: u64| n * n.saturating_sub(1) / 2;
        let squares = |n: u64| n * n.saturating_sub(1) * (2 * n).saturating_sub(1) / 6;
        let (from, to, v) = (start as u64, end as u64, row as u64);
        let (area, u) = (to - from, firsts(to) - firsts(from));
        Self {
            first: row * width + start,
            area,
            at_edge: start == 0 || end == width || row == 0 || row + 1 == height,
            u,
            v: area * v,
            uu: squares(to) - squares(from),
            uv: u * v,
            vv: area * v * v,
        }
    }

    fn add(&mut self, other: &Self) {
        self.first = self.first.min(other.first);
        self.at_edge |= other.at_edge;
        let sums =
            [&mut self.area, &mut self.u, &mut self.v, &mut self.uu, &mut self.uv, &mut self.vv];
        let others = [other.area, other.u, other.v, other.uu, other.uv, other.vv];
        sums.into_iter().zip(others).for_each(|(sum, value)| *sum += value);
    }

    /// Column and row of its centroid.
    pub fn centre(&self) -> [f64; 2] {
        [self.u, self.v].map(|sum| sum as f64 / self.area as f64)
    }

    /// Second moments about the centroid, of pixels that are points: along columns, mixed, and along rows.
    pub fn moments(&self) -> [f64; 3] {
        // Whole numbers, so that nothing cancels.
        let moment = |product: u64, a: u64, b: u64| {
            let [product, a, b, area] = [product, a, b, self.area].map(i128::from);
            (area * product - a * b) as f64 / (area * area) as f64
        };
        [
            moment(self.uu, self.u, self.u),
            moment(self.uv, self.u, self.v),
            moment(self.vv, self.v, self.v),
        ]
    }
}

/// All components above the level that `keep` accepts, in the order of their first pixels.
pub(super) fn components(
    plane: &Plane,
    cut: f32,
    keep: impl Fn(&Component) -> bool,
) -> Vec<Component> {
    let size = [plane.width, plane.height];
    let mut kept = Vec::new();
    // Components that the row before has a part of, and its runs of pixels, each with the place of its component there.
    let mut open: Vec<Component> = Vec::new();
    let mut above: Vec<([usize; 2], usize)> = Vec::new();
    let mut joined = Joined::default();
    for (row, values) in plane.values.chunks_exact(plane.width).enumerate() {
        joined.reset(open.len());
        let mut current = Vec::with_capacity(above.len());
        let mut next = 0;
        for run in runs(values, cut) {
            // Runs of the row before that end before this one begins touch none that follows.
            while above.get(next).is_some_and(|([_, end], _)| *end <= run[0]) {
                next += 1;
            }
            let part = Component::of_run(run, row, size);
            let mut touched = above[next..]
                .iter()
                .take_while(|([start, _], _)| *start < run[1])
                .map(|&(_, place)| place);
            let place = match touched.next() {
                None => {
                    open.push(part);
                    joined.push()
                }
                Some(place) => {
                    let place = touched.fold(place, |a, b| joined.join(a, b));
                    let place = joined.root(place);
                    open[place].add(&part);
                    place
                }
            };
            current.push((run, place));
        }
        // Those that have been joined to others are added to them; those without a part in this row have ended.
        for place in (0..open.len()).rev() {
            let root = joined.root(place);
            if root != place {
                let (before, from) = open.split_at_mut(place);
                before[root].add(&from[0]);
            }
        }
        let mut places = vec![None; open.len()];
        let mut still = Vec::with_capacity(current.len());
        for (_, place) in &mut current {
            let root = joined.root(*place);
            *place = *places[root].get_or_insert_with(|| {
                still.push(open[root].clone());
                still.len() - 1
            });
        }
        let ended = (0..open.len()).filter(|&k| joined.root(k) == k && places[k].is_none());
        kept.extend(ended.map(|k| &open[k]).filter(|part| keep(part)).cloned());
        (open, above) = (still, current);
    }
    kept.extend(open.into_iter().filter(|part| keep(part)));
    kept.sort_by_key(|part| part.first);
    kept
}

/// Runs of values above the level: their beginnings and ends, which they do not contain.
fn runs(values: &[f32], cut: f32) -> impl Iterator<Item = [usize; 2]> {
    let mut at = 0;
    core::iter::from_fn(move || {
        let start = at + values[at..].iter().position(|&value| value > cut)?;
        let end = values[start..].iter().position(|&value| value <= cut);
        at = end.map_or(values.len(), |length| start + length);
        Some([start, at])
    })
}

/// Which components have turned out to be one: each has the place of one before it, or its own.
#[derive(Debug, Default)]
struct Joined(Vec<usize>);

impl Joined {
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count);
    }

    fn push(&mut self) -> usize {
        self.0.push(self.0.len());
        self.0.len() - 1
    }

    fn root(&mut self, place: usize) -> usize {
        let mut root = place;
        while self.0[root] != root {
            // Halving the paths keeps them short.
            self.0[root] = self.0[self.0[root]];
            root = self.0[root];
        }
        root
    }

    /// Joins two, and returns where both are from now on.
    fn join(&mut self, a: usize, b: usize) -> usize {
        let (a, b) = (self.root(a), self.root(b));
        let (least, most) = (a.min(b), a.max(b));
        self.0[most] = least;
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixel by pixel from neighbour to neighbour.
    fn flooded(plane: &Plane, cut: f32) -> Vec<Vec<[usize; 2]>> {
        let (width, height) = (plane.width, plane.height);
        let mut seen = vec![false; width * height];
        let mut all = Vec::new();
        for start in 0..width * height {
            let mut members = Vec::new();
            let mut left = vec![start];
            while let Some(i) = left.pop() {
                if seen[i] || plane.values[i] <= cut {
                    continue;
                }
                seen[i] = true;
                let (u, v) = (i % width, i / width);
                members.push([u, v]);
                left.extend((u > 0).then(|| i - 1));
                left.extend((u + 1 < width).then_some(i + 1));
                left.extend((v > 0).then(|| i - width));
                left.extend((v + 1 < height).then_some(i + width));
            }
            all.extend((!members.is_empty()).then_some(members));
        }
        all
    }

    #[test]
    fn components_are_those_that_are_flooded() {
        for (seed, share) in [(1_u32, 0.3), (2, 0.5), (3, 0.6), (4, 0.75)] {
            let mut state = seed;
            let mut noise = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 8) as f32 / (1 << 24) as f32
            };
            let mut plane = Plane::new(37, 29);
            plane.values.iter_mut().for_each(|value| *value = noise());
            let cut = 1.0 - share;
            let parts = components(&plane, cut, |_| true);
            let expected = flooded(&plane, cut);
            assert_eq!(parts.len(), expected.len());
            for (part, members) in parts.iter().zip(&expected) {
                let n = members.len() as f64;
                assert_eq!(part.area, members.len() as u64);
                let at_edge = members.iter().any(|&[u, v]| u % 36 == 0 || v % 28 == 0);
                assert_eq!(part.at_edge, at_edge);
                let mean = [0, 1].map(|k| members.iter().map(|p| p[k] as f64).sum::<f64>() / n);
                let off = |p: &[usize; 2], k: usize| p[k] as f64 - mean[k];
                let moment = |a, b| members.iter().map(|p| off(p, a) * off(p, b)).sum::<f64>() / n;
                let expected = [moment(0, 0), moment(0, 1), moment(1, 1)];
                let pairs = part.centre().into_iter().zip(mean);
                for (a, b) in pairs.chain(part.moments().into_iter().zip(expected)) {
                    assert!((a - b).abs() < 1e-9, "{part:?}: {a} {b}");
                }
            }
            let large = components(&plane, cut, |part| part.area > 3);
            let kept = expected.iter().filter(|members| members.len() > 3).count();
            assert_eq!(large.len(), kept);
        }
    }
}
