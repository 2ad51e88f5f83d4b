//! Words beside places in a chart, where nothing else is.

use crate::svg::Point;

/// A rectangle in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Area {
    /// Around a place.
    pub fn around([x, y]: Point, half: f64) -> Self {
        Self { left: x - half, top: y - half, right: x + half, bottom: y + half }
    }

    /// How much of it lies on another, in px².
    fn on(&self, other: &Self) -> f64 {
        let wide = self.right.min(other.right) - self.left.max(other.left);
        let high = self.bottom.min(other.bottom) - self.top.max(other.top);
        wide.max(0.0) * high.max(0.0)
    }

    /// How much of it lies outside another, in px².
    fn outside(&self, other: &Self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top) - self.on(other)
    }
}

/// Where a word goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed {
    /// Its left end, at half its height.
    pub at: Point,
    /// From the place to the word, where that is not beside it.
    pub leader: Option<[Point; 2]>,
}

/// Directions from a place in the order in which they read best: beside, above and below, aslant.
const DIRECTIONS: [Point; 8] = [
    [1.0, 0.0],
    [-1.0, 0.0],
    [0.0, -1.0],
    [0.0, 1.0],
    [1.0, -1.0],
    [-1.0, -1.0],
    [1.0, 1.0],
    [-1.0, 1.0],
];
/// Distances in px of a word from its place.
const DISTANCES: [f64; 6] = [9.0, 16.0, 26.0, 38.0, 52.0, 70.0];
/// Beyond them, everywhere in the frame so many px apart.
const APART: f64 = 8.0;
/// From so far on a line leads to the word.
const LED: f64 = 16.0;

/// Finds a place for each word, given by where it belongs and its width and height in px: near there, within the
/// frame, and on none of the obstacles and other words as far as there is room.
pub(crate) fn place(words: &[(Point, [f64; 2])], obstacles: &[Area], frame: Area) -> Vec<Placed> {
    let mut taken = obstacles.to_vec();
    let mut placed = Vec::with_capacity(words.len());
    for &(place, size) in words {
        let candidates = DISTANCES.iter().flat_map(|&far| {
            DIRECTIONS.iter().map(move |&direction| (far, candidate(place, size, direction, far)))
        });
        // Rarely needed, and only then made.
        let beyond = std::iter::once_with(|| anywhere(place, size, frame)).flatten();
        let mut best: Option<(f64, f64, Area)> = None;
        for (far, area) in candidates.chain(beyond) {
            let covered =
                taken.iter().map(|other| area.on(other)).sum::<f64>() + area.outside(&frame);
            if best.is_none_or(|(least, ..)| covered < least) {
                best = Some((covered, far, area));
            }
            if covered <= 0.0 {
                break;
            }
        }
        let Some((_, far, area)) = best else { continue };
        let middle = 0.5 * (area.top + area.bottom);
        // To the nearest end of the word.
        let end = [place[0].clamp(area.left, area.right), place[1].clamp(area.top, area.bottom)];
        let leader = (far >= LED).then_some([place, end]);
        taken.push(area);
        placed.push(Placed { at: [area.left, middle], leader });
    }
    placed
}

/// The word so far from its place in a direction.
fn candidate([x, y]: Point, [width, height]: [f64; 2], [dx, dy]: Point, far: f64) -> Area {
    let left = match dx {
        d if d > 0.0 => x + far,
        d if d < 0.0 => x - far - width,
        _ => x - 0.5 * width,
    };
    let top = match dy {
        d if d > 0.0 => y + far,
        d if d < 0.0 => y - far - height,
        _ => y - 0.5 * height,
    };
    Area { left, top, right: left + width, bottom: top + height }
}

/// The word all over the frame, what is nearest to its place first.
fn anywhere(
    [x, y]: Point,
    [width, height]: [f64; 2],
    frame: Area,
) -> impl Iterator<Item = (f64, Area)> {
    let steps = |from: f64, to: f64| 0..=((to - from).max(0.0) / APART) as usize;
    let column = move |i: usize| frame.left + i as f64 * APART;
    let row = move |k: usize| frame.top + k as f64 * APART;
    let (across, down) =
        (steps(frame.left, frame.right - width), steps(frame.top, frame.bottom - height));
    let places = across.flat_map(move |i| down.clone().map(move |k| (column(i), row(k))));
    let mut areas: Vec<(f64, Area)> = places
        .map(|(left, top)| {
            let far = (left + 0.5 * width - x).hypot(top + 0.5 * height - y);
            (far.max(LED), Area { left, top, right: left + width, bottom: top + height })
        })
        .collect();
    areas.sort_by(|a, b| a.0.total_cmp(&b.0));
    areas.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Area = Area { left: 0.0, top: 0.0, right: 400.0, bottom: 300.0 };

    fn areas(words: &[(Point, [f64; 2])], placed: &[Placed]) -> Vec<Area> {
        let area = |(&(_, [width, height]), placed): (&(Point, [f64; 2]), &Placed)| {
            let [left, middle] = placed.at;
            let half = 0.5 * height;
            Area { left, top: middle - half, right: left + width, bottom: middle + half }
        };
        words.iter().zip(placed).map(area).collect()
    }

    #[test]
    fn a_word_stands_beside_its_place_where_there_is_room() {
        let placed = place(&[([100.0, 100.0], [60.0, 12.0])], &[], FRAME);
        assert_eq!(placed, [Placed { at: [109.0, 100.0], leader: None }]);
        // At the right edge it goes to the left.
        let placed = place(&[([390.0, 100.0], [60.0, 12.0])], &[], FRAME);
        assert_eq!(placed, [Placed { at: [321.0, 100.0], leader: None }]);
    }

    #[test]
    fn words_of_one_place_lie_apart_and_within_the_frame() {
        let words = vec![([200.0, 150.0], [90.0, 13.0]); 14];
        let marks = [Area::around([200.0, 150.0], 5.0)];
        let placed = place(&words, &marks, FRAME);
        let areas = areas(&words, &placed);
        for (i, a) in areas.iter().enumerate() {
            assert_eq!(a.outside(&FRAME), 0.0);
            assert_eq!(a.on(&marks[0]), 0.0);
            assert!(areas[..i].iter().all(|b| a.on(b) == 0.0));
        }
        assert!(placed.iter().any(|placed| placed.leader.is_some()));
    }
}
