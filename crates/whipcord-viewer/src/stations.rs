//! At which arc lengths a frame gives the shape: at every disk and every end of a cable, and close enough between them
//! for a smooth picture.

use whipcord::{Robot, Shape, equally_spaced};

/// About so many stations make a backbone look smooth at any bend.
const SMOOTH: usize = 24;
/// Places nearer to one another than this, relative to the length, are one.
const ONE_PLACE: f64 = 1e-9;

/// The stations of a robot's frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// Arc lengths in m, ascending.
    pub arc_lengths: Vec<f64>,
    /// Which of them each disk sits at.
    pub disks: Vec<usize>,
    /// Which of them each cable is anchored at.
    pub anchors: Vec<usize>,
}

impl Places {
    /// Those of this robot.
    pub fn of(robot: &Robot) -> Self {
        let disks = &robot.disks().arc_lengths;
        let length = robot.backbone().length;
        let mut marks = disks.clone();
        for route in robot.routes() {
            if marks.iter().all(|mark| (mark - route.end()).abs() > ONE_PLACE * length) {
                marks.push(route.end());
            }
        }
        marks.sort_by(f64::total_cmp);
        let mut arc_lengths = vec![marks[0]];
        for ends in marks.windows(2) {
            let share = SMOOTH as f64 * (ends[1] - ends[0]) / length;
            let pieces = (share.ceil() as usize).max(1);
            arc_lengths.extend(equally_spaced(ends[0], ends[1], pieces + 1).skip(1));
        }
        let nearest = |s: f64| {
            let distance = |i: &usize| (arc_lengths[*i] - s).abs();
            let all = 0..arc_lengths.len();
            all.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        Self {
            disks: disks.iter().map(|&s| nearest(s)).collect(),
            anchors: robot.routes().iter().map(|route| nearest(route.end())).collect(),
            arc_lengths,
        }
    }

    /// A shape at these stations.
    pub fn along(&self, shape: &Shape) -> Shape {
        let poses = self.arc_lengths.iter().map(|&s| shape.at(s)).collect();
        Shape { arc_length: self.arc_lengths.clone(), poses }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord::{Backbone, Cable, Disks, Routing};

    #[test]
    fn disks_and_anchors_are_among_the_stations() {
        let cable = |name: &str, ends_at| Cable {
            ends_at,
            ..Cable::new(name, Routing::Straight { angle: 0.0, radius: 0.01 })
        };
        let cables = vec![cable("whole", None), cable("part", Some(0.035))];
        let disks = Disks::equally_spaced(0.1, 6, 0.01);
        let robot = Robot::new(Backbone::new(0.1), disks, cables).unwrap();
        let places = Places::of(&robot);
        assert!(places.arc_lengths.windows(2).all(|w| w[1] > w[0]));
        assert!((SMOOTH..2 * SMOOTH).contains(&places.arc_lengths.len()));
        let at = |index: &[usize]| index.iter().map(|&i| places.arc_lengths[i]).collect::<Vec<_>>();
        assert_eq!(at(&places.disks), robot.disks().arc_lengths);
        assert_eq!(at(&places.anchors), [0.1, 0.035]);
    }
}
