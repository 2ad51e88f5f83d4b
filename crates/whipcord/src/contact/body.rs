//! How near a part of the robot is to an obstacle.

use whipcord_numerics::{Pose, Vec3};

use crate::obstacle::{Obstacle, Surface};

/// A rigid part of the robot at one of its cross-sections: a ball around the backbone's centre or a
/// flat disk, each with a rounded surface. A rounding makes the normal of a contact continuous even
/// where an edge meets an edge, eq. (1) of `docs/theory/contact.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Radius in m of the flat disk inside; 0 for a ball.
    pub flat: f64,
    /// Radius in m of the rounding around it.
    pub rounding: f64,
}

/// A place of a body that is nearer to an obstacle than its neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance between body and obstacle in m; negative where they overlap.
    pub gap: f64,
    /// Unit normal out of the obstacle.
    pub normal: Vec3,
    /// From the centre of the cross-section to the place on the flat disk, in m.
    pub arm: Vec3,
    /// The same in the axes x and y of the cross-section.
    pub local: [f64; 2],
}

/// What the rim of a body sees of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rim {
    /// The body is a ball or too far away, or its flat inside is nearer.
    Unseen,
    /// The greatest and the least distance of the rim from the obstacle differ by this part of the rim's radius.
    Spread(f64),
}

/// Places at which the rim is looked at first.
const RIM: usize = 12;
/// Distances of the rim that differ by less than this part of its radius differ by rounding.
const ROUNDING: f64 = 1e-12;

/// A disk whose flat inside has less than this part of its radius counts as a ball.
const BALL: f64 = 1e-6;

impl Body {
    /// A disk of this outer radius, whose rim is rounded with half of its thickness.
    #[must_use]
    pub fn disk(outer: f64, half_thickness: f64) -> Self {
        if half_thickness >= (1.0 - BALL) * outer {
            Self { flat: 0.0, rounding: outer }
        } else {
            Self { flat: outer - half_thickness, rounding: half_thickness }
        }
    }

    /// Whether it is nothing but its rounding, so that one place of it is nearest to an obstacle.
    #[must_use]
    pub fn is_ball(&self) -> bool {
        self.flat == 0.0
    }

    /// Radius in m of the ball that it fits in.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.flat + self.rounding
    }

    /// All places that are nearer to an obstacle than their neighbours, and no farther than
    /// `within`, into `found`.
    pub fn nearest(
        &self,
        obstacle: &Obstacle,
        pose: &Pose,
        within: f64,
        found: &mut Vec<Nearest>,
    ) -> Rim {
        found.clear();
        let centre = obstacle.surface(pose.position);
        // The distance changes by no more than the way.
        if centre.distance > self.reach() + within {
            return Rim::Unseen;
        }
        if self.is_ball() {
            found.push(self.at(pose, centre, [0.0, 0.0]));
            return Rim::Unseen;
        }
        let rim = core::array::from_fn::<_, RIM, _>(|k| {
            let local = on_rim(self.flat, angle(k));
            (local, obstacle.surface(place(pose, local)).distance)
        });
        for k in 0..RIM {
            let [before, here, after] = [k + RIM - 1, k, k + 1].map(|i| rim[i % RIM].1);
            // Of a plateau the first.
            if here < before - ROUNDING * self.flat && here <= after {
                self.add(self.track(obstacle, pose, rim[k].0), within, found);
            }
        }
        if found.is_empty() {
            self.add(self.track(obstacle, pose, [0.0, 0.0]), within, found);
        }
        let lowest = rim.iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(rim[0], |place| *place);
        let highest = rim.iter().map(|place| place.1).fold(f64::NEG_INFINITY, f64::max);
        if found.is_empty() {
            // A plateau all around.
            self.add(self.at_place(obstacle, pose, lowest.0), within, found);
        }
        let inside = |place: &Nearest| {
            place.local[0].hypot(place.local[1]) < 0.99 * self.flat
                && place.gap + self.rounding < lowest.1 - ROUNDING * self.flat
        };
        if found.iter().any(inside) {
            return Rim::Unseen;
        }
        Rim::Spread((highest - lowest.1) / self.flat)
    }

    /// A place of the body, wherever others are nearer.
    #[must_use]
    pub fn at_place(&self, obstacle: &Obstacle, pose: &Pose, local: [f64; 2]) -> Nearest {
        self.at(pose, obstacle.surface(place(pose, local)), local)
    }

    /// The place of the rim at an angle from the axis x of the cross-section.
    #[must_use]
    pub fn on_rim(&self, angle: f64) -> [f64; 2] {
        on_rim(self.flat, angle)
    }

    fn add(&self, nearest: Nearest, within: f64, found: &mut Vec<Nearest>) {
        let close = |other: &Nearest| {
            let [dx, dy] = [0, 1].map(|i| nearest.local[i] - other.local[i]);
            dx.hypot(dy) < 0.1 * self.flat
        };
        if nearest.gap <= within && !found.iter().any(close) {
            found.push(nearest);
        }
    }

    /// The place that is nearer than its neighbours, found by going downhill from one: Newton's method on the plate, and
    /// along the rim where it leads out of it, with steps that are shortened until they lead down.
    #[must_use]
    pub fn track(&self, obstacle: &Obstacle, pose: &Pose, from: [f64; 2]) -> Nearest {
        const STEPS: usize = 60;
        const HALVINGS: usize = 40;
        // What is left after a step of Newton's method this short is rounding.
        const SETTLED: f64 = 1e-9;
        // In rad, of a difference along the rim.
        const BESIDE: f64 = 1e-6;
        let axes = [pose.rotation.rotate(Vec3::X), pose.rotation.rotate(Vec3::Y)];
        let see = |[x, y]: [f64; 2]| {
            let surface = obstacle.surface(pose.position + axes[0] * x + axes[1] * y);
            (surface, axes.map(|axis| surface.normal.dot(axis)))
        };
        let mut local = from;
        let (mut surface, mut slope) = see(local);
        if self.is_ball() {
            return self.at(pose, surface, [0.0, 0.0]);
        }
        for _ in 0..STEPS {
            let radius = local[0].hypot(local[1]);
            let outward = if radius > 0.0 { local.map(|x| x / radius) } else { [0.0; 2] };
            let falls_outward = slope[0] * outward[0] + slope[1] * outward[1] < 0.0;
            let on_the_rim = radius >= self.flat * (1.0 - 1e-12) && falls_outward;
            let phi = local[1].atan2(local[0]);
            let step = if on_the_rim {
                let along = |phi: f64, [x, y]: [f64; 2]| {
                    let (sin, cos) = phi.sin_cos();
                    y * cos - x * sin
                };
                let (f, beside) = (along(phi, slope), phi + BESIDE);
                let (_, sloping) = see(on_rim(self.flat, beside));
                let d = (along(beside, sloping) - f) / BESIDE;
                let step = if d > 0.0 { (-f / d).clamp(-0.4, 0.4) } else { -0.3 * f.signum() };
                [if f == 0.0 { 0.0 } else { step }, 0.0]
            } else {
                self.downhill(&see, local, slope)
            };
            let size = step[0].hypot(step[1]) * if on_the_rim { self.flat } else { 1.0 };
            // Rounding sets an end to going downhill.
            if size < 1e-14 * self.flat || size.is_nan() {
                break;
            }
            let mut part = 1.0;
            let lower = (0..HALVINGS).find_map(|_| {
                let next = match on_the_rim {
                    true => on_rim(self.flat, phi + part * step[0]),
                    false => self.inside([local[0] + part * step[0], local[1] + part * step[1]]),
                };
                let (seen, sloping) = see(next);
                part *= 0.5;
                let level = seen.distance <= surface.distance + 1e-15 * self.flat;
                level.then_some((next, seen, sloping))
            });
            let Some((next, seen, sloping)) = lower else { break };
            let moved = (next[0] - local[0]).hypot(next[1] - local[1]);
            (local, surface, slope) = (next, seen, sloping);
            if size < SETTLED * self.flat || moved < 1e-13 * self.flat {
                break;
            }
        }
        self.at(pose, surface, local)
    }

    /// A step of Newton's method on the plate. Along an axis in which the distance does not bend it leads to the rim,
    /// as far as it falls at all.
    fn downhill(
        &self,
        see: &impl Fn([f64; 2]) -> (Surface, [f64; 2]),
        [x, y]: [f64; 2],
        slope: [f64; 2],
    ) -> [f64; 2] {
        // Slopes below are those of rounding.
        const LEVEL: f64 = 1e-13;
        let h = 1e-6 * self.flat;
        let (_, right) = see([x + h, y]);
        let (_, left) = see([x - h, y]);
        let (_, up) = see([x, y + h]);
        let (_, down) = see([x, y - h]);
        let [a, b, c] =
            [right[0] - left[0], 0.5 * (right[1] - left[1] + up[0] - down[0]), up[1] - down[1]]
                .map(|difference| difference / (2.0 * h));
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let root = half.hypot(b);
        let (sin, cos) = (0.5 * b.atan2(half)).sin_cos();
        let mut step = [0.0; 2];
        for (axis, bend) in [([cos, sin], mean + root), ([-sin, cos], mean - root)] {
            let fall = slope[0] * axis[0] + slope[1] * axis[1];
            if fall.abs() > LEVEL {
                let far = -fall / bend.max(fall.abs() / (2.0 * self.flat));
                (step[0], step[1]) = (step[0] + far * axis[0], step[1] + far * axis[1]);
            }
        }
        step
    }

    fn inside(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let radius = x.hypot(y);
        if radius <= self.flat { [x, y] } else { [x, y].map(|x| x * self.flat / radius) }
    }

    fn at(&self, pose: &Pose, surface: Surface, local: [f64; 2]) -> Nearest {
        Nearest {
            gap: surface.distance - self.rounding,
            normal: surface.normal,
            arm: pose.rotation.rotate(Vec3::new(local[0], local[1], 0.0)),
            local,
        }
    }
}

impl Nearest {
    /// From the centre of the cross-section to the point that is nearest, in m.
    #[must_use]
    pub fn lever(&self, rounding: f64) -> Vec3 {
        self.arm - self.normal * rounding
    }

    /// What touches at a pose of the cross-section has slid since that was elsewhere, in m along the surface, eq. (8): the
    /// material point that is at the contact now was elsewhere then.
    #[must_use]
    pub fn slip(&self, from: &Pose, pose: &Pose, rounding: f64) -> Vec3 {
        let lever = self.lever(rounding);
        let point = pose.position + lever;
        let before = from.transform(pose.rotation.conjugate().rotate(lever));
        along(point - before, self.normal)
    }

    /// The unit force along the normal, and its moment about the centre of the cross-section, eq. (2).
    #[must_use]
    pub fn push(&self) -> [f64; 6] {
        wrench_of(self.normal, self.arm)
    }
}

/// A force and its moment about the centre of the cross-section that it has this lever on.
pub(super) fn wrench_of(force: Vec3, lever: Vec3) -> [f64; 6] {
    let moment = lever.cross(force);
    [force.x, force.y, force.z, moment.x, moment.y, moment.z]
}

/// The part of a vector along a surface.
#[must_use]
pub fn along(vector: Vec3, normal: Vec3) -> Vec3 {
    vector - normal * normal.dot(vector)
}

/// Two unit vectors along a surface, at right angles.
#[must_use]
pub fn tangents(normal: Vec3) -> [Vec3; 2] {
    let other = if normal.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
    let first = normal.cross(other);
    let first = first / first.norm();
    [first, normal.cross(first)]
}

fn angle(k: usize) -> f64 {
    k as f64 * (core::f64::consts::TAU / RIM as f64)
}

fn on_rim(radius: f64, angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}

fn place(pose: &Pose, [x, y]: [f64; 2]) -> Vec3 {
    pose.transform(Vec3::new(x, y, 0.0))
}
