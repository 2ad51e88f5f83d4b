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
}
