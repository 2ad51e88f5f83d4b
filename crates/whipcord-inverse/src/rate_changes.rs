//! How the derivatives of an evaluation change with the unknowns, and where they lead to second order.

use whipcord::derivatives::Place;
use whipcord::{Pose, SolveError, Twist, UnitQuaternion, Vec3};

use crate::evaluation::Evaluation;
use crate::forward::Forward;

/// The changes of the motions of an evaluation, by differences of exact derivatives.
#[derive(Clone, Debug)]
pub(crate) struct RateChanges {
    /// With unknown l at `[l]`: of the motions by each unknown, of the places one after the other.
    by: Vec<Vec<Numbers>>,
}

/// A twist: the linear part, then the angular one.
type Numbers = [f64; 6];

/// What is foretold at unknowns beside an evaluation.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foretold {
    /// Of all disks; those of the places are foretold.
    pub poses: Vec<Pose>,
    /// Of the places, by each unknown.
    pub motions: Vec<Vec<Twist>>,
    sums: Vec<Numbers>,
}

/// The step of the differences, in changes that bend the robot by half a turn: under loads, where the shape beside is corrected by its derivatives, these have an error that goes with
/// the square of it.
const STEP: f64 = 1e-2;

impl RateChanges {
    /// At an evaluation, of the first of its places, from one more beside it for each unknown within the bounds. `None` where the model has no exact derivatives or no answer there.
    ///
    /// # Errors
    /// [`SolveError::Cancelled`].
    pub fn at(
        evaluation: &Evaluation,
        unknowns: &[f64],
        bounds: &[[f64; 2]],
        places: &[Place],
        forward: &mut Forward,
    ) -> Result<Option<Self>, SolveError> {
        if !forward.is_exact {
            return Ok(None);
        }
        let mut by = Vec::with_capacity(unknowns.len());
        let mut moved = unknowns.to_vec();
        for (l, &[least, greatest]) in bounds.iter().enumerate() {
            // To the side with more room, where the step does not fit on the other.
            let (above, below) = (greatest - unknowns[l], unknowns[l] - least);
            let whole = STEP * forward.scales[l];
            let step =
                if above >= whole || above >= below { above.min(whole) } else { -below.min(whole) };
            if step == 0.0 {
                by.push(vec![Numbers::default(); unknowns.len() * places.len()]);
                continue;
            }
            moved.copy_from_slice(unknowns);
            moved[l] += step;
            let changes = moved.iter().zip(unknowns).map(|(moved, x)| moved - x);
            let near = evaluation.extrapolated(changes, forward.is_on_few_steps());
            let beside = match forward.evaluate(&moved, places, Some(&near)) {
                Ok(beside) => beside,
                Err(error @ SolveError::Cancelled { .. }) => return Err(error),
                Err(_) => return Ok(None),
            };
            let rate = |(there, here): (&Twist, &Twist)| {
                let (there, here) = (numbers(there), numbers(here));
                core::array::from_fn(|i| (there[i] - here[i]) / step)
            };
            let of = beside.rates.motions.iter().zip(&evaluation.rates.motions);
            let of = of.flat_map(|(there, here)| there.iter().zip(here).take(places.len()));
            by.push(of.map(rate).collect());
        }
        Ok(Some(Self { by }))
    }

    /// What they foretell at unknowns that differ from those of the evaluation by `changes`:
    ///
    /// ```text
    /// mₖ(δ) = mₖ + Σ δₗ ∂mₖ/∂xₗ,   moved by Σ δₖ (mₖ + mₖ(δ))/2
    /// ```
    pub fn foretell(
        &self,
        evaluation: &Evaluation,
        places: &[Place],
        changes: &[f64],
        into: &mut Foretold,
    ) {
        let rates = &evaluation.rates.motions;
        into.sums.clear();
        into.sums.extend(rates.iter().flat_map(|of| &of[..places.len()]).map(numbers));
        for (of_unknown, change) in self.by.iter().zip(changes) {
            for (sums, rates) in into.sums.iter_mut().zip(of_unknown) {
                sums.iter_mut().zip(rates).for_each(|(sum, rate)| *sum += change * rate);
            }
        }
        into.motions.resize_with(rates.len(), Vec::new);
        into.motions.iter_mut().for_each(|of| of.resize(places.len(), Twist::default()));
        for (motion, [x, y, z, u, v, w]) in into.motions.iter_mut().flatten().zip(&into.sums) {
            *motion = Twist { linear: Vec3::new(*x, *y, *z), angular: Vec3::new(*u, *v, *w) };
        }
        into.poses.clone_from(&evaluation.solution.disks.poses);
        let tip = into.poses.len().saturating_sub(1);
        for (place, of) in places.iter().enumerate() {
            let number = match *of {
                Place::Disk(disk) => disk,
                Place::Tip => tip,
                Place::Station(_) => continue,
            };
            let from = evaluation.solution.disks.poses.get(number);
            let Some((pose, from)) = into.poses.get_mut(number).zip(from) else { continue };
            let mut moved = Twist::default();
            for ((here, there), change) in rates.iter().zip(&into.motions).zip(changes) {
                moved.linear += (0.5 * change) * (here[place].linear + there[place].linear);
                moved.angular += (0.5 * change) * (here[place].angular + there[place].angular);
            }
            pose.position = from.position + moved.linear;
            pose.rotation = UnitQuaternion::exp(moved.angular) * from.rotation;
        }
    }
}

fn numbers(Twist { linear, angular }: &Twist) -> Numbers {
    [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::CommandedBy;
    use crate::limits::{CableLimits, Limits};
    use crate::solver::InverseSolver;
    use whipcord::{Backbone, Cable, Case, Disks, Loads, Material, Model, ModelKind, Robot};
    use whipcord::{PointLoad, Routing, Section};

    const LENGTH: f64 = 0.18;

    fn robot() -> Robot {
        let material = Material {
            young_modulus: Some(1.1e9),
            poisson_ratio: Some(0.3),
            ..Material::default()
        };
        let section = Some(Section::circle(0.003));
        let backbone = Backbone { section, material, ..Backbone::new(LENGTH) };
        let helix = |name: &str, start_angle: f64, turns: f64| {
            Cable::new(name, Routing::Helix { start_angle, turns, radius: 0.008 })
        };
        let cables = vec![
            helix("a", 0.0, 0.75),
            helix("b", 2.0, -0.5),
            Cable::new("c", Routing::Straight { angle: 4.0, radius: 0.008 }),
        ];
        Robot::new(backbone, Disks::equally_spaced(LENGTH, 10, 0.008), cables).unwrap()
    }

    /// How far tip and a disk are from where they are foretold on a way of such a size, in m, with second derivatives or without.
    fn miss(solver: &mut InverseSolver, size: f64, has_second: bool) -> f64 {
        let places = [Place::Disk(5), Place::Tip];
        let at = [1.2, 1.4, 0.9];
        let bounds = [[0.0, 4.0]; 3];
        let forward = &mut solver.forward;
        let evaluation = forward.evaluate(&at, &places, None).unwrap();
        let found = RateChanges::at(&evaluation, &at, &bounds, &places, forward).unwrap();
        let changes = [0.8 * size, -0.5 * size, 0.6 * size];
        let mut foretold = Foretold::default();
        let mut found = found.unwrap();
        if !has_second {
            found.by.iter_mut().for_each(|of| of.fill(Numbers::default()));
        }
        found.foretell(&evaluation, &places, &changes, &mut foretold);
        let there = [0, 1, 2].map(|k| at[k] + changes[k]);
        let exact = forward.evaluate(&there, &places, None).unwrap();
        let off = |disk: usize| {
            let (a, b) = (&foretold.poses[disk], &exact.solution.disks.poses[disk]);
            let turn = (a.rotation * b.rotation.conjugate()).log().norm();
            (a.position - b.position).norm().max(turn * LENGTH)
        };
        off(5).max(off(9))
    }

    #[test]
    fn what_is_foretold_is_off_by_the_third_power_of_the_way() {
        let model = Model::new(ModelKind::Cosserat, Default::default(), Default::default());
        let limits = CableLimits { tension: [0.0, 4.0], ..CableLimits::default() };
        let limits = Limits::uniform(3, limits);
        let force =
            PointLoad { at: LENGTH, force: Vec3::new(0.1, 0.05, -0.1), ..PointLoad::default() };
        for loads in [Loads::default(), Loads { points: vec![force], ..Loads::default() }] {
            let is_loaded = !loads.is_none();
            let case = Case { loads, ..Case::default() };
            let mut solver =
                InverseSolver::new(&model, &robot(), &case, &limits, CommandedBy::Case).unwrap();
            let [far, near] = [1.6, 0.8].map(|size| miss(&mut solver, size, true));
            let without = miss(&mut solver, 0.8, false);
            assert!(far > 1e-6 && far < 0.02 * LENGTH, "{far}");
            // Eight and more; under loads the first derivatives have an error, too.
            let least = if is_loaded { 4.0 } else { 6.0 };
            assert!(far / near > least, "{is_loaded}: {far} {near}");
            assert!(without > 5.0 * near, "{is_loaded}: {without} {near}");
        }
    }
}
