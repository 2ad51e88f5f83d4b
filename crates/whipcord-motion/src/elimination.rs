//! Block elimination of the linear system of a stage: the middle nodes element by element, then the ends within spans of elements whose ends are linked, then a
//! block-tridiagonal system of the ends of spans.

use whipcord_numerics::Twist;

use crate::block::Block;
use crate::element::NODES;

/// The matrix of one element: `[a][b]` are the rows of node `a` and the columns of node `b`.
pub(crate) type ElementMatrix = [[Block; NODES]; NODES];

/// The matrix in elements with links between their ends, and its factors.
///
/// The middle of each element is eliminated first, then the ends within each span from its start on, and at last the starts of the spans from base to tip. Where nothing
/// links ends beyond an element, each element is a span of its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    /// Matrices of the elements, whose sum with the links is the matrix of all nodes.
    pub elements: Vec<ElementMatrix>,
    /// What links the right end of each element with the start of its span beside the elements: rows and columns of both in this order. Empty where nothing does.
    pub links: Vec<Pair>,
    /// For each element the number of the element whose left end is the start of its span.
    span_starts: Vec<usize>,
    /// Whether the base is held: its rows and columns are left out.
    holds_base: bool,
    /// The nodes in the order in which they are eliminated.
    pivots: Vec<Pivot>,
}

/// A node that is eliminated from the rows of its neighbours.
#[derive(Clone, Copy, Debug, Default)]
struct Pivot {
    node: usize,
    /// The nodes that it was connected with when it was eliminated.
    neighbours: [Option<usize>; 2],
    inverse: Block,
    /// Its row in their columns.
    rows: [Block; 2],
    /// Their rows in its column, times the inverse.
    multipliers: [Block; 2],
}

/// What connects two nodes, rows and columns of both.
pub(crate) type Pair = [[Block; 2]; 2];

/// The matrix cannot be factored: a block of this node is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SingularNode;

impl Pivot {
    /// Eliminates a node with this block from both neighbours, whose blocks and connections are `pair`; `rows` is its row in their columns and `columns` their
    /// rows in its column.
    #[inline]
    fn new(
        node: usize,
        neighbours: [Option<usize>; 2],
        block: &Block,
        [rows, columns]: Pair,
        pair: &mut Pair,
    ) -> Result<Self, SingularNode> {
        let inverse = block.inverse().ok_or(SingularNode)?;
        let mut multipliers = [Block::default(); 2];
        for i in 0..2 {
            if neighbours[i].is_none() {
                continue;
            }
            multipliers[i] = columns[i].times(&inverse);
            for j in 0..2 {
                if neighbours[j].is_some() {
                    pair[i][j].subtract_product(&multipliers[i], &rows[j]);
                }
            }
        }
        Ok(Self { node, neighbours, inverse, rows, multipliers })
    }
}

impl Elimination {
    /// A matrix for elements whose spans start at the left ends of these elements. With `is_linked` there may be links.
    pub fn new(span_starts: &[usize], is_linked: bool, holds_base: bool) -> Self {
        let elements = span_starts.len();
        Self {
            elements: vec![ElementMatrix::default(); elements],
            links: vec![Pair::default(); if is_linked { elements } else { 0 }],
            span_starts: span_starts.to_vec(),
            holds_base,
            pivots: Vec::with_capacity(2 * elements + 1),
        }
    }

    /// Holds the base from now on, or lets it go.
    pub const fn hold_base(&mut self, holds: bool) {
        self.holds_base = holds;
    }

    /// Whether the base is held.
    pub const fn holds_base(&self) -> bool {
        self.holds_base
    }

    /// Factors the matrix.
    pub fn factor(&mut self) -> Result<(), SingularNode> {
        let Self { elements, links, span_starts, holds_base, pivots } = self;
        let free = |node: usize| (node > 0 || !*holds_base).then_some(node);
        pivots.clear();
        // Of the end that is reached, after all that comes before its span.
        let mut reached: Option<Block> = None;
        // The span up to the end that is reached.
        let mut span = Pair::default();
        let zero = Block::default();
        for (e, matrix) in elements.iter().enumerate() {
            let [left, middle, right] = [2 * e, 2 * e + 1, 2 * e + 2];
            let mut pair = [[matrix[0][0], matrix[0][2]], [matrix[2][0], matrix[2][2]]];
            let around = [[matrix[1][0], matrix[1][2]], [matrix[0][1], matrix[2][1]]];
            let ends = [free(left), Some(right)];
            pivots.push(Pivot::new(middle, ends, &matrix[1][1], around, &mut pair)?);
            let start = 2 * span_starts[e];
            if start == left {
                span = pair;
            } else {
                let block = span[1][1].plus(&pair[0][0]);
                let around = [[span[1][0], pair[0][1]], [span[0][1], pair[1][0]]];
                let mut longer = [[span[0][0], zero], [zero, pair[1][1]]];
                let ends = [free(start), Some(right)];
                pivots.push(Pivot::new(left, ends, &block, around, &mut longer)?);
                span = longer;
            }
            if let Some(link) = links.get(e) {
                for (of_span, of_link) in
                    span.as_flattened_mut().iter_mut().zip(link.as_flattened())
                {
                    *of_span = of_span.plus(of_link);
                }
            }
            if span_starts.get(e + 1).is_some_and(|next| *next != e + 1) {
                continue;
            }
            let mut end = span;
            if let Some(start) = free(start) {
                let block = reached.map_or(span[0][0], |before| before.plus(&span[0][0]));
                let around = [[zero, span[0][1]], [zero, span[1][0]]];
                pivots.push(Pivot::new(start, [None, Some(right)], &block, around, &mut end)?);
            }
            reached = Some(end[1][1]);
        }
        if let Some(block) = reached {
            let around = [[zero; 2]; 2];
            let tip = 2 * elements.len();
            pivots.push(Pivot::new(tip, [None, None], &block, around, &mut span)?);
        }
        Ok(())
    }

    /// Overwrites a right-hand side, one twist for each node, by the solution; that of a base that is held is zero.
    pub fn solve(&self, x: &mut [Twist]) {
        if self.holds_base {
            x[0] = Twist::default();
        }
        for pivot in &self.pivots {
            let known = x[pivot.node];
            for (neighbour, multiplier) in pivot.neighbours.into_iter().zip(&pivot.multipliers) {
                if let Some(k) = neighbour {
                    x[k] = x[k] - multiplier.apply(&known);
                }
            }
        }
        for pivot in self.pivots.iter().rev() {
            let mut sum = x[pivot.node];
            for (neighbour, row) in pivot.neighbours.into_iter().zip(&pivot.rows) {
                if let Some(k) = neighbour {
                    sum = sum - row.apply(&x[k]);
                }
            }
            x[pivot.node] = pivot.inverse.apply(&sum);
        }
    }

    /// Takes away what the links do on a vector, one twist for each node.
    pub fn take_links(&self, on: &[Twist], out: &mut [Twist]) {
        for (e, link) in self.links.iter().enumerate() {
            let ends = [2 * self.span_starts[e], 2 * e + 2];
            for (row, &to) in link.iter().zip(&ends) {
                for (block, &from) in row.iter().zip(&ends) {
                    out[to] = out[to] - block.apply(&on[from]);
                }
            }
        }
    }

    /// Adds what the transposed links do on a vector, one twist for each node.
    pub fn add_links_transposed(&self, on: &[Twist], out: &mut [Twist]) {
        for (e, link) in self.links.iter().enumerate() {
            let ends = [2 * self.span_starts[e], 2 * e + 2];
            for (row, &from) in link.iter().zip(&ends) {
                for (block, &to) in row.iter().zip(&ends) {
                    out[to] = out[to] + block.apply_transposed(&on[from]);
                }
            }
        }
    }

    /// The same with the transposed matrix: first with that of the upper factor, then with that of the lower one.
    pub fn solve_transposed(&self, x: &mut [Twist]) {
        if self.holds_base {
            x[0] = Twist::default();
        }
        for pivot in &self.pivots {
            let known = pivot.inverse.apply_transposed(&x[pivot.node]);
            x[pivot.node] = known;
            for (neighbour, row) in pivot.neighbours.into_iter().zip(&pivot.rows) {
                if let Some(k) = neighbour {
                    x[k] = x[k] - row.apply_transposed(&known);
                }
            }
        }
        for pivot in self.pivots.iter().rev() {
            let mut sum = x[pivot.node];
            for (neighbour, multiplier) in pivot.neighbours.into_iter().zip(&pivot.multipliers) {
                if let Some(k) = neighbour {
                    sum = sum - multiplier.apply_transposed(&x[k]);
                }
            }
            x[pivot.node] = sum;
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
        let own: [usize; 5] = core::array::from_fn(|e| e);
        let cases: [(&[usize], bool); 6] = [
            (&own[..1], true),
            (&own[..2], true),
            (&own, true),
            (&own, false),
            // Links over two and three elements.
            (&[0, 0, 2, 2, 2, 5], true),
            (&[0, 0, 2, 2, 2, 5], false),
        ];
        for (starts, holds_base) in cases {
            let elements = starts.len();
            let is_linked = starts.iter().enumerate().any(|(e, start)| *start != e);
            let mut elimination = Elimination::new(starts, is_linked, holds_base);
            let held = usize::from(holds_base);
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
            for link in elimination.links.iter_mut().flat_map(|link| link.as_flattened_mut()) {
                *link = Block { a: mat(0.0), b: mat(0.0), c: mat(0.0), d: mat(0.0) };
            }
            let n = 12 * elements + 6 * (1 - held);
            let mut dense = vec![0.0; n * n];
            let mut add = |row: usize, column: usize, block: &Block| {
                if row < held || column < held {
                    return;
                }
                let block = flat(block);
                for i in 0..6 {
                    for j in 0..6 {
                        dense[(6 * (row - held) + i) * n + 6 * (column - held) + j] += block[i][j];
                    }
                }
            };
            for (e, matrix) in elimination.elements.iter().enumerate() {
                for a in 0..NODES {
                    for b in 0..NODES {
                        add(2 * e + a, 2 * e + b, &matrix[a][b]);
                    }
                }
            }
            for (e, link) in elimination.links.iter().enumerate() {
                let ends = [2 * starts[e], 2 * e + 2];
                for a in 0..2 {
                    for b in 0..2 {
                        add(ends[a], ends[b], &link[a][b]);
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
            let right: Vec<f64> = x[held..]
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
                let got = x[held..]
                    .iter()
                    .flat_map(|t| [t.linear.to_array(), t.angular.to_array()].concat());
                assert!(!holds_base || x[0] == Twist::default());
                for (got, expected) in got.zip(expected) {
                    assert!((got - expected).abs() < 1e-12, "{elements}: {got} {expected}");
                }
            }
        }
    }
}
