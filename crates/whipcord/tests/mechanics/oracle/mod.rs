//! A second formulation of the Cosserat rod, which shares no mechanics with the model: the paper's
//! eq. (3) in the state `(p, R, v, u)`, shot at the tip with `v(0)` and `u(0)` as the unknowns.
//!
//! The cables act as loads `A_i (…)` along the rod, which takes `r`, `r′` and `r″`; where a cable is
//! anchored it pulls with `−τ t` and `−τ r × t`, and `v` and `u` jump. The total wrench that the
//! model works with appears nowhere but in these jumps and at the tip. The integrator is Gragg's
//! midpoint rule with extrapolation, Newton's method differentiates by finite differences.

mod elastic;
mod linear;

use whipcord::robot::Route;
use whipcord::{Case, DistributedLoad, Mat3, Profile, Robot, Vec3};

use elastic::{Elastic, Place};
use linear::{Matrix6, Vector6};

/// The shape at one arc length.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub arc_length: f64,
    pub position: Vec3,
    pub rotation: Mat3,
}

/// The equilibrium that the oracle found.
#[derive(Clone, Debug)]
pub struct Answer {
    /// At every arc length that was asked for.
    pub frames: Vec<Frame>,
    pub lengths: Vec<f64>,
    /// What rod and cables transmit at the base, in the base frame, which is the body frame there.
    pub base_force: Vec3,
    pub base_moment: Vec3,
}

impl Answer {
    /// Largest change of a position or a length in m.
    fn change(&self, other: &Self) -> f64 {
        let moved = self.frames.iter().zip(&other.frames);
        let lengths = self.lengths.iter().zip(&other.lengths).map(|(a, b)| (a - b).abs());
        moved.map(|(a, b)| (a.position - b.position).norm()).chain(lengths).fold(0.0, f64::max)
    }
}

/// A rod with its cables and dead loads.
pub struct Oracle<'a> {
    robot: &'a Robot,
    tensions: Vec<f64>,
    /// Per kg.
    gravity: Vec3,
    tip_force: Vec3,
    tip_moment: Vec3,
    /// Arc length, force, moment; between base and tip.
    points: Vec<(f64, Vec3, Vec3)>,
    spread: &'a [DistributedLoad],
    breaks: Vec<f64>,
    /// Steps between two breaks.
    pieces: usize,
}

/// `(p, R, v − e₃, u, ℓ)`: extension and shear are small, and keep their digits this way.
#[derive(Clone, Debug)]
struct State {
    position: Vec3,
    rotation: Mat3,
    strain: Vec3,
    curvature: Vec3,
    lengths: Vec<f64>,
}

/// What is left at the tip of a trial, or that the trial blew up.
type Miss = Option<Vector6>;

const MAX_NEWTON: usize = 25;
/// Of the scales of force and moment.
const MET: f64 = 3e-13;

impl State {
    fn clamped(cables: usize) -> Self {
        Self {
            position: Vec3::ZERO,
            rotation: Mat3::IDENTITY,
            strain: Vec3::ZERO,
            curvature: Vec3::ZERO,
            lengths: vec![0.0; cables],
        }
    }

    /// `self + factor · rate`.
    fn plus(&self, factor: f64, rate: &Self) -> Self {
        let lengths = self.lengths.iter().zip(&rate.lengths);
        Self {
            position: self.position + factor * rate.position,
            rotation: self.rotation + rate.rotation * factor,
            strain: self.strain + factor * rate.strain,
            curvature: self.curvature + factor * rate.curvature,
            lengths: lengths.map(|(a, b)| a + factor * b).collect(),
        }
    }
}

impl<'a> Oracle<'a> {
    /// `outputs` are the arc lengths at which frames are wanted.
    pub fn new(robot: &'a Robot, case: &'a Case, outputs: &[f64]) -> Self {
        let length = robot.backbone().length;
        let loads = &case.loads;
        let gravity = loads.gravity.unwrap_or_default();
        let mut points: Vec<(f64, Vec3, Vec3)> =
            loads.points.iter().map(|p| (p.at, p.force, p.moment)).collect();
        points.extend(loads.masses.iter().map(|m| (m.at, m.mass * gravity, Vec3::ZERO)));
        let disk_weight = robot.disks().mass * gravity;
        points.extend(robot.disks().arc_lengths.iter().map(|&s| (s, disk_weight, Vec3::ZERO)));
        let (mut tip_force, mut tip_moment) = (loads.tip_force, loads.tip_moment);
        for (_, force, moment) in points.iter().filter(|p| p.0 > length * (1.0 - 1e-10)) {
            tip_force += *force;
            tip_moment += *moment;
        }
        points.retain(|p| p.0 > 1e-10 * length && p.0 <= length * (1.0 - 1e-10));

        let mut breaks = vec![0.0, length];
        breaks.extend_from_slice(&robot.disks().arc_lengths);
        breaks.extend(robot.backbone().places());
        breaks.extend_from_slice(outputs);
        breaks.extend(points.iter().map(|p| p.0));
        breaks.extend(loads.distributed.iter().flat_map(|load| load.profile.knots()));
        for route in robot.routes() {
            breaks.push(route.end());
            breaks.extend_from_slice(route.breakpoints());
        }
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|b, a| *b - *a <= 1e-10 * length);
        let tensions = case.commands.iter().map(|c| c.tension.unwrap()).collect();
        Self {
            robot,
            tensions,
            gravity,
            tip_force,
            tip_moment,
            points,
            spread: &case.loads.distributed,
            breaks,
            pieces: 1,
        }
    }

    /// Shoots, raising tensions and loads together from none, and then halves the steps until
    /// neither the base wrench nor any frame moves by more than `tolerance`, relative to the scales.
    pub fn solve(&mut self, tolerance: f64) -> Answer {
        let mut unknown = self.raise_load();
        let mut answer = self.answer(&unknown);
        loop {
            self.pieces *= 2;
            assert!(self.pieces <= 256, "the oracle's steps do not suffice");
            let finer = self.shoot(1.0, unknown, MET).expect("a shot from a converged one");
            let moved: Vector6 = core::array::from_fn(|i| finer[i] - unknown[i]);
            let better = self.answer(&finer);
            let change = better.change(&answer) / self.robot.backbone().length;
            (unknown, answer) = (finer, better);
            if linear::norm(&moved).max(change) <= tolerance {
                return answer;
            }
        }
    }

    fn raise_load(&self) -> Vector6 {
        let mut unknown = [0.0; 6];
        let mut before: Option<(f64, Vector6)> = None;
        let (mut reached, mut step) = (0.0, 0.5);
        while reached < 1.0 {
            let load = f64::min(1.0, reached + step);
            let guess = match before {
                Some((earlier, values)) => {
                    let t = (load - reached) / (reached - earlier);
                    core::array::from_fn(|i| unknown[i] + t * (unknown[i] - values[i]))
                }
                None => unknown,
            };
            match self.shoot(load, guess, if load < 1.0 { 1e-5 } else { MET }) {
                Some(found) => {
                    before = Some((reached, unknown));
                    (unknown, reached) = (found, load);
                    step *= 1.5;
                }
                None => {
                    step *= 0.5;
                    assert!(step > 1e-3, "the oracle gets no further than {reached} of the load");
                }
            }
        }
        unknown
    }

    /// Newton's method on what is left at the tip; `None` when it does not converge.
    fn shoot(&self, load: f64, guess: Vector6, tolerance: f64) -> Option<Vector6> {
        const DIFFERENCE: f64 = 1e-6;
        let mut x = guess;
        let mut miss = self.miss(load, &x)?;
        let mut matrix: Option<Matrix6> = None;
        for _ in 0..MAX_NEWTON {
            let size = linear::norm(&miss);
            if size <= tolerance {
                return Some(x);
            }
            let fresh = matrix.is_none();
            let jacobian = match matrix {
                Some(kept) => kept,
                None => {
                    let mut columns = [[0.0; 6]; 6];
                    for (j, column) in columns.iter_mut().enumerate() {
                        let mut moved = x;
                        moved[j] += DIFFERENCE;
                        let there = self.miss(load, &moved)?;
                        *column = core::array::from_fn(|i| (there[i] - miss[i]) / DIFFERENCE);
                    }
                    linear::from_columns(&columns)
                }
            };
            let change = linear::solve(&jacobian, &miss)?;
            let trial: Vector6 = core::array::from_fn(|i| x[i] - change[i]);
            // A step that leaves the range of a shooting method is a matter of a smaller load step.
            let there = self.miss(load, &trial).filter(|there| linear::norm(there) < 0.9 * size);
            match there {
                Some(there) => {
                    let quick = linear::norm(&there) < 0.05 * size;
                    (x, miss) = (trial, there);
                    matrix = quick.then_some(jacobian);
                }
                None if !fresh => matrix = None,
                // Rounding keeps the last digits from settling.
                None if size <= 100.0 * tolerance => return Some(x),
                None => return None,
            }
        }
        None
    }

    /// Force and moment that count as one unknown.
    fn scales(&self) -> (f64, f64) {
        let length = self.robot.backbone().length;
        let elastic = Elastic::at(self.robot, &Place { at: 0.0, from: 0.0, to: length });
        let moment = elastic.bending.x.max(elastic.bending.y) / length;
        let loads = self.tip_force.norm()
            + self.points.iter().map(|p| p.1.norm()).sum::<f64>()
            + self.tensions.iter().sum::<f64>();
        (loads + moment / length, moment)
    }

    /// Start values of strain and curvature from the unknowns, the wrench that the rod alone
    /// carries at the base.
    fn start(&self, unknown: &Vector6) -> State {
        let (force, moment) = self.scales();
        let first = Place { at: 0.0, from: 0.0, to: self.breaks[1] };
        let elastic = Elastic::at(self.robot, &first);
        let mut state = State::clamped(self.tensions.len());
        for i in 0..3 {
            state.strain[i] = unknown[i] * force / elastic.shear[i];
            state.curvature[i] = elastic.rest[i] + unknown[3 + i] * moment / elastic.bending[i];
        }
        state
    }

    /// What the rod carries at the tip beyond what load and anchored cables apply there.
    fn miss(&self, load: f64, unknown: &Vector6) -> Miss {
        let state = self.march(load, self.start(unknown), |_, _| ())?;
        let n = self.breaks.len();
        let place =
            Place { at: self.breaks[n - 1], from: self.breaks[n - 2], to: self.breaks[n - 1] };
        let elastic = Elastic::at(self.robot, &place);
        let anchored = self.active(&place);
        let (force, moment) = self.pull(load, &place, &anchored, &state);
        let rotation = state.rotation.transpose();
        let force = elastic.shear.scale(state.strain) + force - rotation * (load * self.tip_force);
        let moment = elastic.bending.scale(state.curvature - elastic.rest) + moment
            - rotation * (load * self.tip_moment);
        let (force_scale, moment_scale) = self.scales();
        let (f, m) = (force / force_scale, moment / moment_scale);
        let miss = [f.x, f.y, f.z, m.x, m.y, m.z];
        miss.iter().all(|x| x.is_finite()).then_some(miss)
    }

    fn answer(&self, unknown: &Vector6) -> Answer {
        let start = self.start(unknown);
        let mut frames = Vec::new();
        let first = Place { at: 0.0, from: 0.0, to: self.breaks[1] };
        let elastic = Elastic::at(self.robot, &first);
        let (force, moment) = self.pull(1.0, &first, &self.active(&first), &start);
        let base_force = elastic.shear.scale(start.strain) + force;
        let base_moment = elastic.bending.scale(start.curvature - elastic.rest) + moment;
        let tip = self.march(1.0, start, |arc_length, state: &State| {
            frames.push(Frame { arc_length, position: state.position, rotation: state.rotation });
        });
        Answer { frames, lengths: tip.unwrap().lengths, base_force, base_moment }
    }

    /// Integrates from base to tip and shows `visit` the state at every break; `None` on blow-up.
    fn march(&self, load: f64, start: State, mut visit: impl FnMut(f64, &State)) -> Option<State> {
        let length = self.robot.backbone().length;
        let mut state = start;
        visit(0.0, &state);
        let mut behind: Option<Place> = None;
        for pair in self.breaks.windows(2) {
            let ahead = Place { at: pair[0], from: pair[0], to: pair[1] };
            if let Some(behind) = behind {
                state = self.jump(load, &behind, &ahead, state)?;
            }
            let h = (pair[1] - pair[0]) / self.pieces as f64;
            for i in 0..self.pieces {
                let place = Place { at: pair[0] + i as f64 * h, ..ahead };
                state = self.extrapolated_step(load, &place, h, &state);
                // NaN fails the comparison, too.
                if !(state.curvature.max_abs() * length < 1e3 && state.strain.max_abs() < 10.0) {
                    return None;
                }
            }
            visit(pair[1], &state);
            behind = Some(Place { at: pair[1], ..ahead });
        }
        Some(state)
    }

    /// Gragg's modified midpoint rule with 2, 4, … 10 substeps, extrapolated in `h²` to order 10.
    fn extrapolated_step(&self, load: f64, place: &Place, h: f64, start: &State) -> State {
        const SUBSTEPS: [usize; 5] = [2, 4, 6, 8, 10];
        let rate = |offset: f64, state: &State| {
            self.rate(load, &Place { at: place.at + offset, ..*place }, state)
        };
        let first = rate(0.0, start);
        let mut table: Vec<State> = Vec::with_capacity(SUBSTEPS.len());
        let mut best = start.clone();
        for (k, &n) in SUBSTEPS.iter().enumerate() {
            let d = h / n as f64;
            let mut before = start.clone();
            let mut here = start.plus(d, &first);
            for i in 1..n {
                let next = before.plus(2.0 * d, &rate(d * i as f64, &here));
                before = core::mem::replace(&mut here, next);
            }
            let smooth = before.plus(1.0, &here).plus(d, &rate(h, &here));
            let mut newest = State::clamped(self.tensions.len());
            newest.rotation = Mat3::ZERO;
            newest = newest.plus(0.5, &smooth);
            // Aitken–Neville: `table[j]` holds the entry of the last row that used j extrapolations.
            for (j, entry) in table.iter_mut().enumerate() {
                let ratio = (n as f64 / SUBSTEPS[k - 1 - j] as f64).powi(2);
                let difference = newest.plus(-1.0, entry);
                let improved = newest.plus(1.0 / (ratio - 1.0), &difference);
                *entry = core::mem::replace(&mut newest, improved);
            }
            best = newest.clone();
            table.push(newest);
        }
        best
    }

    /// The right-hand side of eq. (3).
    fn rate(&self, load: f64, place: &Place, state: &State) -> State {
        let s = place.inside();
        let elastic = Elastic::at(self.robot, place);
        let (v, u) = (Vec3::Z + state.strain, state.curvature);
        let (force, moment) =
            (elastic.shear.scale(state.strain), elastic.bending.scale(u - elastic.rest));
        let weight = load * self.linear_density(s) * self.gravity;
        let mut d = -u.cross(force)
            - elastic.shear_rate.scale(state.strain)
            - state.rotation.transpose() * weight;
        let mut c =
            -u.cross(moment) - v.cross(force) - elastic.bending_rate.scale(u - elastic.rest)
                + elastic.bending.scale(elastic.rest_rate);
        let body = state.rotation.transpose();
        for distributed in self.spread {
            let (mut force, mut moment) = density(&distributed.profile, place, s);
            if !distributed.follower {
                (force, moment) = (body * force, body * moment);
            }
            d -= load * force;
            c -= load * moment;
        }
        let mut matrix = linear::diagonal(elastic.shear, elastic.bending);
        let mut lengths = vec![0.0; self.tensions.len()];
        for i in self.active(place) {
            let point = self.route(i).at(s);
            let (r, slope, bend) = (point.offset, point.slope, point.bend);
            let along = u.cross(r) + slope + v;
            let stretch = along.norm();
            lengths[i] = stretch;
            // A = −τ (p̂′)²/‖p′‖³
            let hat = Mat3::skew(along);
            let a = hat * hat * (-load * self.tensions[i] / stretch.powi(3));
            let w = u.cross(along) + u.cross(slope) + bend;
            let aw = a * w;
            d += -aw;
            c += -r.cross(aw);
            let across = Mat3::skew(r);
            let g = -(a * across);
            linear::add_block(&mut matrix, 0, 0, &a);
            linear::add_block(&mut matrix, 0, 3, &g);
            linear::add_block(&mut matrix, 3, 0, &g.transpose());
            linear::add_block(&mut matrix, 3, 3, &-(across * a * across));
        }
        let right = [d.x, d.y, d.z, c.x, c.y, c.z];
        // A singular matrix shows as NaN, which ends the shot.
        let x = linear::solve(&matrix, &right).unwrap_or([f64::NAN; 6]);
        State {
            position: state.rotation * v,
            rotation: state.rotation * Mat3::skew(u),
            strain: Vec3::new(x[0], x[1], x[2]),
            curvature: Vec3::new(x[3], x[4], x[5]),
            lengths,
        }
    }

    /// Strain and curvature behind a place where cables end, turn, or a load acts: the rod's own
    /// wrench changes by what they exert there.
    fn jump(&self, load: f64, behind: &Place, ahead: &Place, state: State) -> Option<State> {
        let length = self.robot.backbone().length;
        let (before, after) = (self.active(behind), self.active(ahead));
        let turns = after.iter().any(|&i| {
            let slope = |place: &Place| self.route(i).at(place.inside()).slope;
            (slope(behind) - slope(ahead)).norm() > 1e-7
        });
        let mut applied = (Vec3::ZERO, Vec3::ZERO);
        for (at, force, moment) in &self.points {
            if (at - ahead.at).abs() <= 1e-10 * length {
                applied = (applied.0 + *force, applied.1 + *moment);
            }
        }
        let (elastic_behind, elastic) =
            (Elastic::at(self.robot, behind), Elastic::at(self.robot, ahead));
        let steps =
            self.robot.backbone().places().iter().any(|s| (s - ahead.at).abs() <= 1e-10 * length);
        if before == after && !turns && !steps && applied.0 == Vec3::ZERO && applied.1 == Vec3::ZERO
        {
            return Some(state);
        }
        let body = state.rotation.transpose();
        let (force, moment) = self.pull(load, behind, &before, &state);
        // Of rod and cables together, beyond the place.
        let force = elastic_behind.shear.scale(state.strain) + force - body * (load * applied.0);
        let moment = elastic_behind.bending.scale(state.curvature - elastic_behind.rest) + moment
            - body * (load * applied.1);
        let mut state = state;
        for _ in 0..50 {
            let (cable_force, cable_moment) = self.pull(load, ahead, &after, &state);
            let f = elastic.shear.scale(state.strain) + cable_force - force;
            let m = elastic.bending.scale(state.curvature - elastic.rest) + cable_moment - moment;
            let mut matrix = linear::diagonal(elastic.shear, elastic.bending);
            for &i in &after {
                let point = self.route(i).at(ahead.inside());
                let along =
                    Vec3::Z + state.strain + state.curvature.cross(point.offset) + point.slope;
                let hat = Mat3::skew(along);
                let a = hat * hat * (-load * self.tensions[i] / along.norm().powi(3));
                let across = Mat3::skew(point.offset);
                linear::add_block(&mut matrix, 0, 0, &a);
                linear::add_block(&mut matrix, 0, 3, &-(a * across));
                linear::add_block(&mut matrix, 3, 0, &(across * a));
                linear::add_block(&mut matrix, 3, 3, &-(across * a * across));
            }
            let change = linear::solve(&matrix, &[f.x, f.y, f.z, m.x, m.y, m.z])?;
            state.strain -= Vec3::new(change[0], change[1], change[2]);
            state.curvature -= Vec3::new(change[3], change[4], change[5]);
            if linear::norm(&change) <= 1e-14 * (1.0 + state.curvature.norm()) {
                return Some(state);
            }
        }
        None
    }

    /// `Σ τ t` and `Σ τ r × t` of these cables.
    fn pull(&self, load: f64, place: &Place, cables: &[usize], state: &State) -> (Vec3, Vec3) {
        let (mut force, mut moment) = (Vec3::ZERO, Vec3::ZERO);
        for &i in cables {
            let point = self.route(i).at(place.inside());
            let along = Vec3::Z + state.strain + state.curvature.cross(point.offset) + point.slope;
            let pull = along * (load * self.tensions[i] / along.norm());
            force += pull;
            moment += point.offset.cross(pull);
        }
        (force, moment)
    }

    fn route(&self, cable: usize) -> &Route {
        &self.robot.routes()[cable]
    }

    /// Cables that reach through the piece.
    fn active(&self, place: &Place) -> Vec<usize> {
        let reaches = |&i: &usize| self.route(i).end() > place.middle();
        (0..self.tensions.len()).filter(reaches).collect()
    }

    fn linear_density(&self, s: f64) -> f64 {
        let backbone = self.robot.backbone();
        let area = backbone.section_at(self.robot.disks(), s).unwrap().area;
        area * backbone.material.density.unwrap_or(0.0)
    }
}

/// Force and moment for each metre at an arc length in the piece.
fn density(profile: &Profile, place: &Place, s: f64) -> (Vec3, Vec3) {
    let middle = place.middle();
    match profile {
        &Profile::Constant { from, to, force, moment } => {
            if (from..to).contains(&middle) {
                (force, moment)
            } else {
                Default::default()
            }
        }
        Profile::Linear { at, force, moment } => {
            let behind = at.partition_point(|&knot| knot <= middle);
            if behind == 0 || behind == at.len() {
                return Default::default();
            }
            let t = (s - at[behind - 1]) / (at[behind] - at[behind - 1]);
            let value = |list: &[Vec3]| {
                list.get(behind).map_or(Vec3::ZERO, |&next| list[behind - 1] * (1.0 - t) + next * t)
            };
            (value(force), value(moment))
        }
    }
}
