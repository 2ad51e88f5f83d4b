//! Block elimination of the linear system of a stage: the middle nodes element by element, then a block-tridiagonal system of the ends. The node
//! at the base is held.

use whipcord_numerics::Twist;

use crate::block::Block;
use crate::element::NODES;

/// The matrix of one element: `[a][b]` are the rows of node `a` and the columns of node `b`.
pub(crate) type ElementMatrix = [[Block; NODES]; NODES];

/// The matrix in elements, and its factors in their place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    /// Matrices of the elements, whose sum is the matrix of all nodes.
    pub elements: Vec<ElementMatrix>,
    /// Of each element, behind the factorisation.
    factors: Vec<Factors>,
}

/// What is left of an element.
#[derive(Clone, Copy, Debug, Default)]
struct Factors {
    /// Inverse of the middle's block.
    middle: Block,
    /// The rows of both ends in the column of the middle, times that inverse.
    to_ends: [Block; 2],
    /// Inverse of the block of the right end, after all that comes before.
    end: Block,
    /// The row of the right end in the column of the left one, times the inverse of that one's block.
    from_left: Block,
}

/// The matrix cannot be factored: a block of this node is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SingularNode;

impl Elimination {
    pub fn new(elements: usize) -> Self {
        Self {
            elements: vec![ElementMatrix::default(); elements],
            factors: vec![Factors::default(); elements],
        }
    }

    /// Factors the matrix.
    pub fn factor(&mut self) -> Result<(), SingularNode> {
        let mut left: Option<Block> = None;
        for e in 0..self.elements.len() {
            let matrix = &mut self.elements[e];
            let factors = &mut self.factors[e];
            factors.middle = matrix[1][1].inverse().ok_or(SingularNode)?;
            for (row, end) in [(0, 0), (2, 1)] {
                // Nothing is eliminated from the row of the base, which is held.
                if row == 0 && e == 0 {
                    continue;
                }
                let multiplier = matrix[row][1].times(&factors.middle);
                for column in [0, 2] {
                    if column == 0 && e == 0 {
                        continue;
                    }
                    let above = matrix[1][column];
                    matrix[row][column].subtract_product(&multiplier, &above);
                }
                factors.to_ends[end] = multiplier;
            }
            let mut pivot = matrix[2][2];
            if let Some(before) = left {
                // The block of the left end is the sum of both elements that meet there.
                let inverse = before.plus(&matrix[0][0]).inverse().ok_or(SingularNode)?;
                self.factors[e - 1].end = inverse;
                let matrix = &self.elements[e];
                let multiplier = matrix[2][0].times(&inverse);
                pivot.subtract_product(&multiplier, &matrix[0][2]);
                self.factors[e].from_left = multiplier;
            }
            left = Some(pivot);
        }
        if let (Some(last), Some(factors)) = (left, self.factors.last_mut()) {
            factors.end = last.inverse().ok_or(SingularNode)?;
        }
        Ok(())
    }

    /// Overwrites a right-hand side, one twist for each node, by the solution; that of the base is zero.
    pub fn solve(&self, x: &mut [Twist]) {
        let less = |a: Twist, b: Twist| a - b;
        x[0] = Twist::default();
        for (e, factors) in self.factors.iter().enumerate() {
            let middle = x[2 * e + 1];
            if e > 0 {
                x[2 * e] = less(x[2 * e], factors.to_ends[0].apply(&middle));
            }
            x[2 * e + 2] = less(x[2 * e + 2], factors.to_ends[1].apply(&middle));
            if e > 0 {
                let left = x[2 * e];
                x[2 * e + 2] = less(x[2 * e + 2], factors.from_left.apply(&left));
            }
        }
        for (e, factors) in self.factors.iter().enumerate().rev() {
            let mut right = x[2 * e + 2];
            if let Some(next) = self.elements.get(e + 1) {
                right = less(right, next[0][2].apply(&x[2 * e + 4]));
            }
            x[2 * e + 2] = factors.end.apply(&right);
        }
        for (e, factors) in self.factors.iter().enumerate() {
            let matrix = &self.elements[e];
            let mut middle = less(x[2 * e + 1], matrix[1][2].apply(&x[2 * e + 2]));
            if e > 0 {
                middle = less(middle, matrix[1][0].apply(&x[2 * e]));
            }
            x[2 * e + 1] = factors.middle.apply(&middle);
        }
    }

    /// The same with the transposed matrix: first with that of the upper factor, then with that of the lower one.
    pub fn solve_transposed(&self, x: &mut [Twist]) {
        x[0] = Twist::default();
        for (e, factors) in self.factors.iter().enumerate() {
            x[2 * e + 1] = factors.middle.apply_transposed(&x[2 * e + 1]);
        }
        for (e, factors) in self.factors.iter().enumerate() {
            let matrix = &self.elements[e];
            let mut right = x[2 * e + 2] - matrix[1][2].apply_transposed(&x[2 * e + 1]);
            if let Some(next) = self.elements.get(e + 1) {
                right = right - next[1][0].apply_transposed(&x[2 * e + 3]);
            }
            if e > 0 {
                right = right - matrix[0][2].apply_transposed(&x[2 * e]);
            }
            x[2 * e + 2] = factors.end.apply_transposed(&right);
        }
        for (e, factors) in self.factors.iter().enumerate().rev() {
            let right = x[2 * e + 2];
            if e > 0 {
                x[2 * e] = x[2 * e] - factors.from_left.apply_transposed(&right);
            }
        }
        for (e, factors) in self.factors.iter().enumerate() {
            let mut middle = x[2 * e + 1] - factors.to_ends[1].apply_transposed(&x[2 * e + 2]);
            if e > 0 {
                middle = middle - factors.to_ends[0].apply_transposed(&x[2 * e]);
            }
            x[2 * e + 1] = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use whipcord_numerics::{DenseLu, Mat3, Vec3};

    fn entry(k: usize) -> f64 {
        ((k * k + 3 * k) as f64 * 0.37).sin()
    }

    fn flat(block: &Block) -> [[f64; 6]; 6] {
        core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let part = match (i < 3, j < 3) {
                    (true, true) => &block.a,
                    (true, false) => &block.b,
                    (false, true) => &block.c,
                    (false, false) => &block.d,
                };
                part.rows[i % 3][j % 3]
            })
        })
    }

    /// Against dense elimination with pivots.
    #[test]
    fn it_solves_what_dense_elimination_solves() {
        for elements in [1, 2, 5] {
            let mut elimination = Elimination::new(elements);
            let mut k = 0;
            let mut mat = |diagonal: f64| {
                k += 9;
                let row = |i: usize| Vec3::new(entry(k + i), entry(k + i + 1), entry(k + i + 2));
                Mat3::from_rows(row(0), row(3), row(6)) + Mat3::IDENTITY * diagonal
            };
            for matrix in &mut elimination.elements {
                for a in 0..NODES {
                    for b in 0..NODES {
                        let size = if a == b { 5.0 } else { 0.0 };
                        matrix[a][b] =
                            Block { a: mat(size), b: mat(0.0), c: mat(0.0), d: mat(size) };
                    }
                }
            }
            let n = 12 * elements;
            let mut dense = vec![0.0; n * n];
            for (e, matrix) in elimination.elements.iter().enumerate() {
                for a in 0..NODES {
                    for b in 0..NODES {
                        let (row, column) = (2 * e + a, 2 * e + b);
                        if row == 0 || column == 0 {
                            continue;
                        }
                        let block = flat(&matrix[a][b]);
                        for i in 0..6 {
                            for j in 0..6 {
                                dense[(6 * (row - 1) + i) * n + 6 * (column - 1) + j] +=
                                    block[i][j];
                            }
                        }
                    }
                }
            }
            let mut transposed = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    transposed[i * n + j] = dense[j * n + i];
                }
            }
            let mut x: Vec<Twist> = (0..2 * elements + 1)
                .map(|i| Twist {
                    linear: Vec3::new(entry(i), entry(i + 7), entry(i + 9)),
                    angular: Vec3::new(entry(i + 2), entry(i + 5), entry(i + 4)),
                })
                .collect();
            let right: Vec<f64> = x[1..]
                .iter()
                .flat_map(|t| [t.linear.to_array(), t.angular.to_array()].concat())
                .collect();
            let mut b = right.clone();
            let mut lu = DenseLu::default();
            lu.factor(n, &dense).unwrap();
            lu.solve(&mut b);
            elimination.factor().unwrap();
            let mut of_transposed = x.clone();
            elimination.solve(&mut x);
            elimination.solve_transposed(&mut of_transposed);
            let mut c = right.clone();
            lu.factor(n, &transposed).unwrap();
            lu.solve(&mut c);
            for (x, expected) in [(x, b), (of_transposed, c)] {
                let got = x[1..]
                    .iter()
                    .flat_map(|t| [t.linear.to_array(), t.angular.to_array()].concat());
                assert_eq!(x[0], Twist::default());
                for (got, expected) in got.zip(expected) {
                    assert!((got - expected).abs() < 1e-12, "{elements}: {got} {expected}");
                }
            }
        }
    }
}
