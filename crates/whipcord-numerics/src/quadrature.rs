/// Nodes and weights of a Gauss–Legendre rule on [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct GaussRule<const N: usize> {
    /// Nodes, ascending.
    pub nodes: [f64; N],
    /// Weights, which add up to 1.
    pub weights: [f64; N],
}

/// Two points, exact for cubics.
pub const GAUSS_2: GaussRule<2> =
    GaussRule { nodes: [0.211_324_865_405_187_1, 0.788_675_134_594_812_9], weights: [0.5, 0.5] };

/// Three points, exact for quintics.
pub const GAUSS_3: GaussRule<3> = GaussRule {
    nodes: [0.112_701_665_379_258_3, 0.5, 0.887_298_334_620_741_7],
    weights: [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0],
};

/// Five points, exact to degree nine.
pub const GAUSS_5: GaussRule<5> = GaussRule {
    nodes: [
        0.046_910_077_030_668_004,
        0.230_765_344_947_158_45,
        0.5,
        0.769_234_655_052_841_5,
        0.953_089_922_969_332,
    ],
    weights: [
        0.118_463_442_528_094_54,
        0.239_314_335_249_683_23,
        64.0 / 225.0,
        0.239_314_335_249_683_23,
        0.118_463_442_528_094_54,
    ],
};

/// Halvings of an interval at most.
const MOST_HALVINGS: usize = 12;

/// The integral of a function over an interval by [`GAUSS_5`], in pieces that are halved until their halves differ from
/// them by so small a part.
///
/// ```
/// use whipcord_numerics::integral;
///
/// assert!((integral(&f64::exp, [0.0, 1.0], 1e-11) - 1.0_f64.exp_m1()).abs() < 1e-14);
/// ```
pub fn integral(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], tolerance: f64) -> f64 {
    let rule = |from: f64, to: f64| {
        let h = to - from;
        let points = GAUSS_5.nodes.iter().zip(GAUSS_5.weights);
        h * points.map(|(&node, weight)| weight * f(from + node * h)).sum::<f64>()
    };
    halved(&rule, [from, to], rule(from, to), tolerance, MOST_HALVINGS)
}

fn halved(
    rule: &impl Fn(f64, f64) -> f64,
    [from, to]: [f64; 2],
    whole: f64,
    tolerance: f64,
    halvings: usize,
) -> f64 {
    let middle = 0.5 * (from + to);
    let (first, second) = (rule(from, middle), rule(middle, to));
    let finer = first + second;
    if halvings == 1 || (finer - whole).abs() <= tolerance * finer.abs() {
        return finer;
    }
    halved(rule, [from, middle], first, tolerance, halvings - 1)
        + halved(rule, [middle, to], second, tolerance, halvings - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral<const N: usize>(rule: &GaussRule<N>, power: i32) -> f64 {
        (0..N).map(|i| rule.weights[i] * rule.nodes[i].powi(power)).sum()
    }

    #[test]
    fn exact_to_the_stated_degree_and_no_further() {
        for power in 0..=10 {
            let exact = 1.0 / f64::from(power + 1);
            assert_eq!((integral(&GAUSS_2, power) - exact).abs() < 1e-15, power <= 3);
            assert_eq!((integral(&GAUSS_3, power) - exact).abs() < 1e-15, power <= 5);
            assert_eq!((integral(&GAUSS_5, power) - exact).abs() < 1e-15, power <= 9);
        }
    }

    /// Pieces are halved where a function bends sharply, and no more than so often where it jumps.
    #[test]
    fn sharp_bends_are_halved() {
        let peak = |x: f64| 1.0 / (1.0 + 1e4 * x * x);
        let exact = 2.0 * 100.0_f64.atan() / 100.0;
        assert!((super::integral(&peak, [-1.0, 1.0], 1e-11) / exact - 1.0).abs() < 1e-13);
        let step = |x: f64| if x < 1.0 / 3.0 { 0.0 } else { 1.0 };
        assert!((super::integral(&step, [0.0, 1.0], 1e-11) - 2.0 / 3.0).abs() < 1e-4);
    }
}
