//! Which of the taut cables of a rod without load pull independently of one another.
//!
//! Where the backbone does not stretch, two straight cables opposite one another pull against each other
//! to no effect: their lengths leave their common tension open. Of such cables those that pull most are led
//! to their lengths, and the others are let go: they pull no more than they must.

/// Finds cables that pull independently of one another.
#[derive(Clone, Debug, Default)]
pub(crate) struct IndependentCables {
    order: Vec<usize>,
    kept: Vec<usize>,
    basis: Vec<f64>,
    column: Vec<f64>,
}

impl IndependentCables {
    /// Strikes from `free` the cables whose effect is that of others which pull more, and tells whether
    /// there were any. The effect of one unit of tension in cable `j` has the entries `effect(i, j)`, `i`
    /// up to `rows`, all in comparable units. A cable counts when at least this part of its effect is its
    /// own.
    pub fn retain(
        &mut self,
        free: &mut Vec<usize>,
        own: f64,
        tension: impl Fn(usize) -> f64,
        rows: usize,
        effect: impl Fn(usize, usize) -> f64,
    ) -> bool {
        let Self { order, kept, basis, column } = self;
        order.clone_from(free);
        order.sort_by(|&a, &b| tension(b).total_cmp(&tension(a)).then(a.cmp(&b)));
        kept.clear();
        basis.clear();
        for &cable in &*order {
            column.clear();
            column.extend((0..rows).map(|i| effect(i, cable)));
            let size = norm(column);
            // Orthogonalised twice, what is left is so to rounding.
            for _ in 0..2 {
                for unit in basis.chunks_exact(rows) {
                    let along: f64 = unit.iter().zip(&*column).map(|(a, b)| a * b).sum();
                    column.iter_mut().zip(unit).for_each(|(x, a)| *x -= along * a);
                }
            }
            let left = norm(column);
            // What has no effect at all is for others to find out.
            if left > own * size || size == 0.0 {
                kept.push(cable);
                basis.extend(column.iter().map(|x| if left > 0.0 { x / left } else { 0.0 }));
            }
        }
        let struck = kept.len() < free.len();
        if struck {
            free.retain(|cable| kept.contains(cable));
        }
        struck
    }
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_cables_that_pull_alike_those_with_most_tension_stay() {
        // Columns: e₁, e₂, −e₁, e₁ + 2 e₂.
        let effects = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 2.0]];
        let tensions = [1.0, 3.0, 2.0, 0.0];
        let mut free = vec![0, 1, 2, 3];
        let effect = |i: usize, j: usize| effects[j][i];
        let mut independent = IndependentCables::default();
        assert!(independent.retain(&mut free, 1e-9, |j| tensions[j], 2, effect));
        assert_eq!(free, [1, 2]);
        assert!(!independent.retain(&mut free, 1e-9, |j| tensions[j], 2, effect));
        assert_eq!(free, [1, 2]);
    }
}
