//! The complementarity problem of the holes: the modes of all of them that agree with the solution of their linear problem.
//!
//! The modes are found by block principal pivoting (Júdice and Pires, 1994): all holes that do not agree change their modes at once, as long as this
//! makes them fewer, then the one that agrees least, until they are fewer again. Both may go in circles where several cables act on one another, as near a limit point. Lemke's method
//! then follows a path: each condition gets a term that is proportional to a number `z`, so that the first modes agree for a great
//! `z`, and at a time one hole changes its mode, where its condition is met with equality, until `z` is zero. A path on which `z` grows without end means
//! that Lemke's method has no solution to offer, which is the case beyond a limit point.

use super::holes::Holes;
use super::modes::{Condition, Mode};

/// How often all holes that do not agree change at once without becoming fewer.
const CHANCES: usize = 4;
/// How often a hole changes alone before it goes in a circle.
const CIRCLE: u8 = 3;
/// Pivots of Lemke's method at most: so many for each hole, and so many more.
const MOST_PIVOTS: [usize; 2] = [3, 20];
/// How much the terms of Lemke's method differ from hole to hole, so that no two of them meet their conditions at once: a part of them.
const APART: f64 = 0.5;

/// What the number `z` of Lemke's method adds at a hole, in m: to the conditions of a hole that sticks or a cable that is held, and to the slip of one
/// that slides or the slack of a cable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cover {
    pub stick: f64,
    pub slip: f64,
}

impl Cover {
    /// What it adds to the right-hand side of the row of a hole in this mode.
    pub const fn right_side(self, mode: Mode) -> f64 {
        match mode {
            Mode::Free => 0.0,
            Mode::Sticks | Mode::Held => self.slip,
            Mode::Pulled | Mode::Slack => -self.stick,
            Mode::Released => self.stick,
        }
    }

    /// What it adds to a condition of a hole in this mode.
    const fn on_condition(self, mode: Mode) -> f64 {
        match mode {
            Mode::Free => 0.0,
            Mode::Sticks | Mode::Held => self.stick,
            Mode::Pulled | Mode::Slack => self.slip,
            Mode::Released => -self.slip,
        }
    }
}

/// A linear problem of the holes in modes that are to agree with its solution.
pub(super) trait Complementarity {
    fn modes(&self) -> &[Mode];

    fn set_mode(&mut self, p: usize, mode: Mode);

    /// Solves the linear problem in the modes as they are, with `z = 1` where the terms of Lemke's method are given and else without them; whether
    /// there is a finite solution.
    fn solve(&mut self, covers: Option<&[Cover]>) -> bool;

    /// The conditions of a hole in its mode at the solution, without what `z` adds.
    fn conditions(&self, hole: (usize, usize), p: usize) -> [Option<Condition>; 2];

    fn holes(&self) -> &Holes;

    /// The order of magnitude of the conditions, in m.
    fn unit(&self) -> f64;

    /// Counts the solves so far, and tells whether the solve has ended.
    fn has_ended(&mut self) -> bool;
}

/// How the search for modes ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// All agree.
    Agree,
    /// None were found that agree.
    Disagree,
    /// The path of Lemke's method goes on without end: no modes agree, as beyond a limit point.
    Ray,
    /// The linear problem is singular.
    Singular,
}

/// Memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Pivoting {
    first: Vec<Mode>,
    violated: Vec<(usize, Mode, f64)>,
    /// How often each hole changed alone.
    alone: Vec<u8>,
    covers: Vec<Cover>,
    at_zero: Vec<[Option<Condition>; 2]>,
    at_one: Vec<[Option<Condition>; 2]>,
}

impl Pivoting {
    /// Finds modes that agree, from those that are set, and tells how often modes changed; the linear problem may be solved in these already, and
    /// where nothing else leads to modes that agree it is told whether to follow the path of Lemke's method. Leaves the solution in the modes that were found.
    pub fn find(
        &mut self,
        problem: &mut impl Complementarity,
        is_solved: bool,
        follows: bool,
    ) -> (Outcome, usize) {
        self.first.clear();
        self.first.extend_from_slice(problem.modes());
        self.alone.clear();
        self.alone.resize(self.first.len(), 0);
        let (mut fewest, mut chances, mut changes) = (usize::MAX, CHANCES, 0);
        loop {
            let has_solution = (is_solved && changes == 0) || problem.solve(None);
            if !has_solution {
                return match changes > 0 && follows {
                    true => self.follow(problem, changes),
                    false => (Outcome::Singular, changes),
                };
            }
            self.note_violated(problem);
            let Some(&worst) = self.violated.iter().max_by(|a, b| a.2.total_cmp(&b.2)) else {
                return (Outcome::Agree, changes);
            };
            changes += 1;
            if self.violated.len() < fewest {
                (fewest, chances) = (self.violated.len(), CHANCES);
                self.alone.fill(0);
            } else {
                chances = chances.saturating_sub(1);
            }
            if chances > 0 {
                for &(p, next, _) in &self.violated {
                    problem.set_mode(p, next);
                }
                continue;
            }
            let (p, next, _) = worst;
            self.alone[p] += 1;
            if self.alone[p] > CIRCLE || problem.has_ended() {
                return match follows {
                    true => self.follow(problem, changes),
                    false => (Outcome::Disagree, changes),
                };
            }
            problem.set_mode(p, next);
        }
    }

    fn note_violated(&mut self, problem: &impl Complementarity) {
        self.violated.clear();
        for (hole, p) in problem.holes().all() {
            let is_violated = |condition: &Condition| condition.value < -condition.rounding;
            let conditions = problem.conditions(hole, p).into_iter().flatten().filter(is_violated);
            if let Some(worst) = conditions.min_by(|a, b| a.value.total_cmp(&b.value)) {
                self.violated.push((p, worst.next, -worst.value));
            }
        }
    }

    /// Lemke's method from the first modes.
    fn follow(
        &mut self,
        problem: &mut impl Complementarity,
        mut changes: usize,
    ) -> (Outcome, usize) {
        let n = self.first.len();
        for (p, &mode) in self.first.iter().enumerate() {
            problem.set_mode(p, mode);
        }
        let unit = problem.unit();
        let first = self.first.iter().enumerate();
        self.covers.clear();
        self.covers.extend(first.map(|(p, mode)| {
            // The golden ratio spreads them evenly.
            let size = unit * (1.0 + APART * (p as f64 * 0.618_033_988_749_895).fract());
            match mode {
                Mode::Free => Cover::default(),
                Mode::Sticks | Mode::Held => Cover { stick: size, slip: 0.0 },
                Mode::Pulled | Mode::Slack => Cover { stick: 0.0, slip: size },
                Mode::Released => Cover { stick: 0.0, slip: -size },
            }
        }));
        let (mut z, mut grows) = (f64::INFINITY, false);
        let mut last: Option<usize> = None;
        let mut end = Outcome::Disagree;
        for _ in 0..MOST_PIVOTS[0] * n + MOST_PIVOTS[1] {
            if problem.has_ended() {
                break;
            }
            if !problem.solve(None) {
                return (Outcome::Singular, changes);
            }
            self.at_zero.resize(n, [None; 2]);
            self.at_one.resize(n, [None; 2]);
            for (hole, p) in problem.holes().all() {
                self.at_zero[p] = problem.conditions(hole, p);
            }
            if !problem.solve(Some(&self.covers)) {
                return (Outcome::Singular, changes);
            }
            for (hole, p) in problem.holes().all() {
                self.at_one[p] = problem.conditions(hole, p);
            }
            // Conditions as lines over z.
            let line = |p: usize, which: usize| {
                let at_zero = self.at_zero[p][which]?;
                let at_one = self.at_one[p][which]?;
                let slope =
                    at_one.value + self.covers[p].on_condition(problem.modes()[p]) - at_zero.value;
                Some((at_zero.value, slope, at_zero))
            };
            if let Some(p) = last {
                // Of the hole that changed, what must hold now was met with equality and has to grow.
                let lines = (0..2).filter_map(|which| line(p, which));
                let nearest =
                    lines.min_by(|a, b| (a.0 + z * a.1).abs().total_cmp(&(b.0 + z * b.1).abs()));
                if let Some((_, slope, _)) = nearest {
                    grows = slope > 0.0;
                }
            }
            let mut next: Option<(f64, usize, Mode)> = None;
            for p in 0..n {
                for which in 0..2 {
                    let Some((value, slope, condition)) = line(p, which) else { continue };
                    let value = value + condition.rounding;
                    // Where the line comes to zero in the direction of the path.
                    let falls = if grows { slope < 0.0 } else { slope > 0.0 };
                    if !falls
                        || Some(p) == last
                            && (value + z * slope).abs() <= 1e-9 * (value.abs() + (z * slope).abs())
                    {
                        continue;
                    }
                    let at = -value / slope;
                    // No farther back than to where the path is.
                    let at = if grows { at.max(z) } else { at.min(z) };
                    let is_nearer =
                        next.is_none_or(|(other, ..)| if grows { at < other } else { at > other });
                    if is_nearer {
                        next = Some((at, p, condition.next));
                    }
                }
            }
            match next {
                _ if !grows && next.is_none_or(|(at, ..)| at <= 0.0) => {
                    if !problem.solve(None) {
                        return (Outcome::Singular, changes);
                    }
                    // Rounding may have led the path astray.
                    self.note_violated(problem);
                    if self.violated.is_empty() {
                        return (Outcome::Agree, changes);
                    }
                    break;
                }
                None => {
                    end = Outcome::Ray;
                    break;
                }
                Some((at, p, mode)) => {
                    problem.set_mode(p, mode);
                    changes += 1;
                    (z, last) = (at, Some(p));
                }
            }
        }
        for (p, &mode) in self.first.iter().enumerate() {
            problem.set_mode(p, mode);
        }
        match problem.solve(None) {
            true => (end, changes),
            false => (Outcome::Singular, changes),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statics::friction::holes::Drives;
    use whipcord_numerics::DenseLu;
    use whipcord_numerics::random::SplitMix64;

    /// `x ≥ 0`, `y = M x + q ≥ 0`, `xᵀy = 0`: a hole sticks where `y = 0` and slides where `x = 0`.
    struct Linear {
        matrix: Vec<Vec<f64>>,
        constant: Vec<f64>,
        modes: Vec<Mode>,
        x: Vec<f64>,
        y: Vec<f64>,
        holes: Holes,
    }

    impl Linear {
        fn new(matrix: Vec<Vec<f64>>, constant: Vec<f64>) -> Self {
            let n = constant.len();
            let holes = Holes {
                of_cable: vec![(0..n).collect()],
                coefficients: vec![0.1],
                yielding: vec![0.0; n],
                outside: vec![0.0],
                at_rest: vec![0.0; n],
                length: 1.0,
                compliance: 1.0,
                met: 1e-9,
                drives: Drives::default(),
            };
            let zero = vec![0.0; n];
            let modes = vec![Mode::Pulled; n];
            Self { matrix, constant, modes, x: zero.clone(), y: zero, holes }
        }
    }

    impl Complementarity for Linear {
        fn modes(&self) -> &[Mode] {
            &self.modes
        }

        fn set_mode(&mut self, p: usize, mode: Mode) {
            self.modes[p] = mode;
        }

        fn solve(&mut self, covers: Option<&[Cover]>) -> bool {
            let n = self.constant.len();
            let added = |p: usize| covers.map_or(0.0, |of| of[p].right_side(self.modes[p]));
            let mut rows = vec![0.0; n * n];
            let mut right = vec![0.0; n];
            for p in 0..n {
                match self.modes[p] {
                    Mode::Sticks => {
                        rows[p * n..(p + 1) * n].copy_from_slice(&self.matrix[p]);
                        right[p] = -self.constant[p] - added(p);
                    }
                    _ => {
                        rows[p * n + p] = 1.0;
                        right[p] = added(p);
                    }
                }
            }
            let mut lu = DenseLu::default();
            if lu.factor(n, &rows).is_err() {
                return false;
            }
            lu.solve(&mut right);
            for p in 0..n {
                let product: f64 = self.matrix[p].iter().zip(&right).map(|(m, x)| m * x).sum();
                self.y[p] = product + self.constant[p];
            }
            self.x = right;
            self.x.iter().all(|x| x.is_finite())
        }

        fn conditions(&self, _: (usize, usize), p: usize) -> [Option<Condition>; 2] {
            let (value, next) = match self.modes[p] {
                Mode::Sticks => (self.x[p], Mode::Pulled),
                _ => (self.y[p], Mode::Sticks),
            };
            [Some(Condition { value, rounding: 1e-10, next }), None]
        }

        fn holes(&self) -> &Holes {
            &self.holes
        }

        fn unit(&self) -> f64 {
            1.0
        }

        fn has_ended(&mut self) -> bool {
            false
        }
    }

    fn is_complementary(of: &Linear) {
        for (x, y) in of.x.iter().zip(&of.y) {
            assert!(*x >= -1e-9 && *y >= -1e-9 && (x * y).abs() < 1e-9, "{:?} {:?}", of.x, of.y);
        }
    }

    #[test]
    fn modes_are_found_of_positive_definite_problems() {
        let mut random = SplitMix64::new(7);
        let mut number = || 2.0 * random.next_part() - 1.0;
        for n in [1, 2, 5, 12, 30] {
            for _ in 0..20 {
                let factor: Vec<Vec<f64>> =
                    (0..n).map(|_| (0..n).map(|_| number()).collect()).collect();
                // Not symmetric, but with a positive definite symmetric part.
                let entry = |i: usize, j: usize| {
                    let square: f64 = (0..n).map(|k| factor[i][k] * factor[j][k]).sum();
                    let skew = factor[i][j] - factor[j][i];
                    square + skew + if i == j { 0.1 } else { 0.0 }
                };
                let matrix = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
                let mut problem = Linear::new(matrix, (0..n).map(|_| number()).collect());
                let (outcome, _) = Pivoting::default().find(&mut problem, false, true);
                assert_eq!(outcome, Outcome::Agree);
                is_complementary(&problem);
            }
        }
    }

    /// Murty's example, on which the changes of all holes at once, and of the first one, go in circles.
    #[test]
    fn circles_are_left() {
        let matrix = vec![vec![1.0, 2.0, 0.0], vec![0.0, 1.0, 2.0], vec![2.0, 0.0, 1.0]];
        let mut problem = Linear::new(matrix, vec![-1.0; 3]);
        let (outcome, _) = Pivoting::default().find(&mut problem, false, true);
        assert_eq!(outcome, Outcome::Agree);
        is_complementary(&problem);
        assert!(problem.x.iter().all(|x| (x - 1.0 / 3.0).abs() < 1e-12));
    }

    #[test]
    fn a_problem_without_a_solution_ends_in_a_ray() {
        // y = −x − 1 is negative for every x ≥ 0.
        let mut problem = Linear::new(vec![vec![-1.0]], vec![-1.0]);
        let (outcome, _) = Pivoting::default().find(&mut problem, false, true);
        assert_eq!(outcome, Outcome::Ray);
        // What is not to be followed is not.
        let mut problem = Linear::new(vec![vec![-1.0]], vec![-1.0]);
        let (outcome, _) = Pivoting::default().find(&mut problem, false, false);
        assert_eq!(outcome, Outcome::Disagree);
    }

    #[test]
    fn a_singular_start_is_told() {
        let mut problem = Linear::new(vec![vec![0.0]], vec![-1.0]);
        problem.set_mode(0, Mode::Sticks);
        let (outcome, _) = Pivoting::default().find(&mut problem, false, true);
        assert_eq!(outcome, Outcome::Singular);
    }
}
