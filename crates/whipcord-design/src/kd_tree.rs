//! The nearest of many places.

use whipcord::Vec3;

/// Places in an order in which the middle of each part divides it by one axis.
#[derive(Clone, Debug)]
pub(crate) struct KdTree {
    places: Vec<Place>,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec3,
    /// By which axis this place divides its part.
    axis: u32,
    number: u32,
}

/// Parts with no more places than this are looked through.
const LEAF: usize = 8;

impl KdTree {
    /// Of these places, which are known by their order.
    pub fn new(places: impl Iterator<Item = Vec3>) -> Self {
        let place = |(number, at): (u32, Vec3)| Place { at, axis: 0, number };
        let mut places: Vec<Place> = (0..).zip(places).map(place).collect();
        divide(&mut places);
        Self { places }
    }

    /// The number of the place nearest to a point and the square of its distance, if that is less than this.
    pub fn nearest(&self, point: Vec3, below: f64) -> Option<(usize, f64)> {
        let mut best = (u32::MAX, below);
        nearest(&self.places, point, &mut best);
        (best.0 < u32::MAX).then_some((best.0 as usize, best.1))
    }
}

fn divide(places: &mut [Place]) {
    if places.len() <= LEAF {
        return;
    }
    let mut least = Vec3::from([f64::INFINITY; 3]);
    let mut greatest = Vec3::from([f64::NEG_INFINITY; 3]);
    for place in &*places {
        for axis in 0..3 {
            least[axis] = least[axis].min(place.at[axis]);
            greatest[axis] = greatest[axis].max(place.at[axis]);
        }
    }
    let extent = greatest - least;
    let axis =
        (1..3).fold(0, |widest, axis| if extent[axis] > extent[widest] { axis } else { widest });
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| a.at[axis].total_cmp(&b.at[axis]));
    #[allow(clippy::cast_possible_truncation, reason = "below 3")]
    let of = axis as u32;
    places[middle].axis = of;
    let (low, high) = places.split_at_mut(middle);
    divide(low);
    divide(&mut high[1..]);
}

fn nearest(places: &[Place], point: Vec3, best: &mut (u32, f64)) {
    let mut look = |place: &Place| {
        let off = place.at - point;
        let square = off.dot(off);
        if square < best.1 {
            *best = (place.number, square);
        }
    };
    if places.len() <= LEAF {
        places.iter().for_each(look);
        return;
    }
    let middle = places.len() / 2;
    let (low, high) = places.split_at(middle);
    let divider = &high[0];
    let beyond = point[divider.axis as usize] - divider.at[divider.axis as usize];
    let (near, far) = if beyond < 0.0 { (low, &high[1..]) } else { (&high[1..], low) };
    look(divider);
    nearest(near, point, best);
    if beyond * beyond < best.1 {
        nearest(far, point, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::random::SplitMix64;

    #[test]
    fn the_nearest_is_that_of_all() {
        let mut random = SplitMix64::of(3, 0);
        let mut point = || Vec3::new(random.next_part(), random.next_part(), random.next_part());
        for count in [0, 1, 7, 30, 500] {
            let places: Vec<Vec3> = (0..count).map(|_| point()).collect();
            let tree = KdTree::new(places.iter().copied());
            for _ in 0..200 {
                let asked = point();
                let squares = places.iter().map(|place| (*place - asked).dot(*place - asked));
                let least = squares.fold(f64::INFINITY, f64::min);
                for below in [f64::INFINITY, 0.01, 1e-4] {
                    let found = tree.nearest(asked, below);
                    assert_eq!(found.map(|of| of.1), (least < below).then_some(least));
                    if let Some((number, square)) = found {
                        assert_eq!((places[number] - asked).dot(places[number] - asked), square);
                    }
                }
            }
        }
    }
}
