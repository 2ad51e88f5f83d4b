//! Bounds of what the disks behind a disk add to the cost of a list, whatever holes follow.
//!
//! From each hole of a disk on, a later disk stays in a ball in the frame of the former. The ball of the next disk holds the positions of all spans; that of a later one
//! holds the balls of the next disk's holes, moved by these spans, eq. (2a). The distance of a target from the ball, or from all that is within reach by the lengths of the spans, is the least that the disk adds.

use whipcord::{Pose, Vec3};

use crate::choices::Choices;
use crate::goal::ShapeGoal;
use crate::span_table::SpanTable;

#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    /// Less than zero where no list leads on.
    radius: f64,
    /// How far from the disk itself it can be: the spans one after the other.
    reach: f64,
}

/// What no list leads to.
const NONE: Ball = Ball { centre: Vec3::ZERO, radius: f64::NEG_INFINITY, reach: f64::NEG_INFINITY };

/// Balls of the disks that have a target, from each disk and combination of holes on.
pub(crate) struct TailBound {
    count: usize,
    /// Disk, goal, place and weight of each target; those of later disks come later.
    targets: Vec<(usize, usize, Vec3, f64)>,
    /// Of each disk the first target behind it.
    first: Vec<usize>,
    /// By disks, combinations and targets.
    balls: Vec<Ball>,
}

/// Balls that may be put together, so that bounds take no longer than tables of spans.
const MOST: usize = 50_000_000;
/// Corrections of the middle of a ball towards what is farthest from it.
const CORRECTIONS: usize = 16;
/// What rounding may take from a bound.
const ROUNDING: f64 = 1.0 + 1e-12;

impl TailBound {
    /// `None` where there are too many pairs of holes.
    pub fn new(
        choices: &Choices,
        table: &SpanTable,
        goals: &[ShapeGoal],
        disks: usize,
    ) -> Option<Self> {
        let mut targets: Vec<(usize, usize, Vec3, f64)> = goals
            .iter()
            .enumerate()
            .filter(|(_, goal)| goal.weight > 0.0)
            .flat_map(|(number, goal)| {
                goal.points.iter().map(move |(disk, point)| (*disk, number, *point, goal.weight))
            })
            .filter(|(disk, ..)| *disk > 0 && *disk < disks)
            .collect();
        targets.sort_by_key(|of| of.0);
        let effort = choices.pairs().saturating_mul(disks).saturating_mul(targets.len());
        if effort.saturating_mul(CORRECTIONS) > MOST {
            return None;
        }
        let first = (0..disks).map(|disk| targets.partition_point(|of| of.0 <= disk)).collect();
        let balls = vec![NONE; disks * choices.count * targets.len()];
        let mut bound = Self { count: choices.count, targets, first, balls };
        let mut parts: Vec<Ball> = Vec::new();
        for disk in (0..disks - 1).rev() {
            for &from in choices.at(disk) {
                for target in bound.first[disk]..bound.targets.len() {
                    let (of, goal, ..) = bound.targets[target];
                    parts.clear();
                    for (pair, to) in choices.pairs_after(from, disk + 1) {
                        if !table.is_possible(disk, pair) {
                            continue;
                        }
                        let Some(span) = table.span(goal, disk, pair) else { continue };
                        if of == disk + 1 {
                            let (centre, reach) = (span.position, span.position.norm());
                            parts.push(Ball { centre, radius: 0.0, reach });
                            continue;
                        }
                        let ball = bound.balls[bound.place(disk + 1, to, target)];
                        if ball.radius >= 0.0 {
                            let centre = span.transform(ball.centre);
                            let reach = span.position.norm() + ball.reach;
                            parts.push(Ball { centre, reach, ..ball });
                        }
                    }
                    let at = bound.place(disk, from, target);
                    bound.balls[at] = enclosing(&parts);
                }
            }
        }
        Some(bound)
    }

    const fn place(&self, disk: usize, choice: usize, target: usize) -> usize {
        (disk * self.count + choice) * self.targets.len() + target
    }

    /// What a bound behind a disk takes, in distances.
    pub fn effort(&self, disk: usize) -> usize {
        self.targets.len() - self.first[disk]
    }

    /// The least that all disks behind this one add, with this combination of holes at it and its poses under all goals.
    pub fn least(&self, disk: usize, choice: usize, poses: &[Pose]) -> f64 {
        let first = self.first[disk];
        let at = self.place(disk, choice, first);
        let balls = &self.balls[at..at + self.targets.len() - first];
        let mut sum = 0.0;
        for (ball, (_, goal, point, weight)) in balls.iter().zip(&self.targets[first..]) {
            let pose = &poses[*goal];
            let from_ball = (pose.transform(ball.centre) - *point).norm() - ball.radius;
            let beyond_reach = (pose.position - *point).norm() - ball.reach;
            sum += weight * from_ball.max(beyond_reach).max(0.0).powi(2);
        }
        sum
    }
}

/// A ball that holds some balls, nearly the least: its middle moves towards what is farthest by ever smaller parts, as by Bădoiu and Clarkson (2003).
fn enclosing(parts: &[Ball]) -> Ball {
    let Some(first) = parts.first() else { return NONE };
    let farthest = |centre: Vec3| {
        let away = |part: &Ball| (part.centre - centre).norm() + part.radius;
        let parts = parts.iter().map(|part| (away(part), part.centre));
        parts.fold((f64::NEG_INFINITY, centre), |far, of| if of.0 > far.0 { of } else { far })
    };
    let (mut least, mut greatest) = (first.centre, first.centre);
    for part in parts {
        for axis in 0..3 {
            least[axis] = least[axis].min(part.centre[axis]);
            greatest[axis] = greatest[axis].max(part.centre[axis]);
        }
    }
    let mut centre = (least + greatest) * 0.5;
    let reach = parts.iter().map(|part| part.reach).fold(0.0, f64::max) * ROUNDING;
    let mut best = Ball { centre, radius: f64::INFINITY, reach };
    for correction in 0..=CORRECTIONS {
        let (farthest_part, towards) = farthest(centre);
        if farthest_part < best.radius {
            best = Ball { centre, radius: farthest_part, ..best };
        }
        #[allow(clippy::cast_precision_loss, reason = "few corrections")]
        let part = 1.0 / (correction + 4) as f64;
        centre += (towards - centre) * part;
    }
    Ball { radius: best.radius * ROUNDING, ..best }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_holds_its_parts_and_little_more() {
        let part = |x: f64, y: f64, radius: f64| {
            let centre = Vec3::new(x, y, 0.0);
            Ball { centre, radius, reach: centre.norm() + radius }
        };
        let parts = [part(1.0, 0.0, 0.5), part(-1.0, 0.0, 0.5), part(0.0, 1.0, 0.0)];
        let ball = enclosing(&parts);
        assert!(parts.iter().all(|of| (of.centre - ball.centre).norm() + of.radius <= ball.radius));
        assert!((1.5..1.6).contains(&ball.radius), "{}", ball.radius);
        assert!((ball.reach - 1.5).abs() < 1e-9);
        assert!(enclosing(&[]).radius < 0.0);
    }
}
