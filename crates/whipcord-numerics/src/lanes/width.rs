use pulp::{Arch, Scalar, WithSimd};

/// How many lanes are asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Width {
    /// As many as the widest vectors of the processor have, found when the program runs: eight with
    /// AVX-512, four with AVX2, else one.
    #[default]
    Widest,
    /// At most the four of AVX2.
    Avx2,
    /// One: no vectors.
    One,
}

impl Width {
    /// Does the work in the instructions that the processor has.
    #[inline]
    pub fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        match self {
            Self::Widest => Arch::new().dispatch(work),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => match pulp::x86::V3::try_new() {
                Some(simd) => Arch::V3(simd).dispatch(work),
                None => work.with_simd(Scalar::new()),
            },
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 => work.with_simd(Scalar::new()),
            Self::One => work.with_simd(Scalar::new()),
        }
    }

    /// How many lanes that gives on this processor.
    #[must_use]
    pub fn lanes(self) -> usize {
        struct Count;
        impl WithSimd for Count {
            type Output = usize;

            #[inline(always)]
            fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
                S::F64_LANES
            }
        }
        self.dispatch(Count)
    }
}
