//! How an answer was obtained, and whether it is stable.

use crate::length_miss::LengthMiss;

/// Why an answer has no stability value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoStability {
    /// The options leave it out.
    NotAsked,
    /// The model has no energy whose minimum an equilibrium could be.
    NoEnergy,
    /// Loads that turn with the robot have no energy.
    Followers,
    /// Dead moments have no energy where the sections that bear them can turn.
    DeadMoments,
    /// A cable that rubs slides, or is about to: which way it goes hangs on the disturbance.
    Sliding,
    /// The tangent is singular to rounding, or its least eigenvalue is beyond any stiffness of the robot.
    Undetermined,
    /// It touches obstacles, and friction or a movable object is among what holds it.
    Touching,
}

impl NoStability {
    /// As in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NotAsked => "not-asked",
            Self::NoEnergy => "no-energy",
            Self::Followers => "followers",
            Self::DeadMoments => "dead-moments",
            Self::Sliding => "sliding",
            Self::Undetermined => "undetermined",
            Self::Touching => "touching",
        }
    }

    /// The reason of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let all = [
            Self::NotAsked,
            Self::NoEnergy,
            Self::Followers,
            Self::DeadMoments,
            Self::Sliding,
            Self::Undetermined,
            Self::Touching,
        ];
        all.into_iter().find(|reason| reason.name() == name)
    }

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::NotAsked => "stability not asked for",
            Self::NoEnergy => "stability not defined by this model",
            Self::Followers => "stability not defined under loads that follow the backbone",
            Self::DeadMoments => "stability not defined: a dead moment has no potential in space",
            Self::Sliding => "stability not computed with friction: a cable slides, or is about to",
            Self::Undetermined => "stability not determined: the tangent is singular",
            Self::Touching => "stability not computed where friction or movable objects hold it",
        }
    }
}

/// How an answer was obtained.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnostics {
    /// Newton iterations of the global problem; 0 where there was none to solve.
    pub iterations: usize,
    /// What is left of the equations that were solved, relative to their scale.
    pub residual: f64,
    /// Whether the equilibrium is stable: whether the robot comes back to it after a small disturbance. Taut cables
    /// that are driven by their length hold it, those driven by their tension let go. `None` where that is not known:
    /// [`Self::stability_absent`] says why.
    pub stable: Option<bool>,
    /// Least eigenvalue of the tangent stiffness relative to the backbone's own stiffness: 1 for a
    /// bare rod without load, 0 where it buckles, negative at an unstable equilibrium. `None` where it was not asked
    /// for, see [`crate::StabilityAnalysis`], or not known.
    pub stability: Option<f64>,
    /// Why it is not known whether the equilibrium is stable; `None` where it is.
    pub stability_absent: Option<NoStability>,
    /// Estimated error of the stations' positions in m, from a solution with half the steps;
    /// `None` where the steps were prescribed.
    pub discretization_error: Option<f64>,
    /// Integration steps, or sections, from base to tip.
    pub steps: usize,
    /// Fraction of the loads, raised from nothing, at which the robot left the shape it had: it
    /// buckled or snapped through. Of the tensions where no load acts and the cables buckle spans. An answer that is stable all the same lies beyond. `None` where
    /// it did not come to that, or where a neighbouring answer led here.
    pub stability_lost_at: Option<f64>,
    /// Cables whose prescribed lengths contradict each other, and how much longer each is in this least-squares answer
    /// ([`crate::over_determined`]); empty where the lengths are met.
    pub length_misses: Vec<LengthMiss>,
}

/// What is known of the stability of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Verdict {
    pub is_stable: bool,
    /// Where it was computed.
    pub least_eigenvalue: Option<f64>,
}

impl Verdict {
    /// An equilibrium that is stable and not near critical, whose least eigenvalue was not computed.
    pub const STABLE: Self = Self { is_stable: true, least_eigenvalue: None };

    pub fn of_eigenvalue(least: f64) -> Self {
        Self { is_stable: least >= -Diagnostics::NEUTRAL, least_eigenvalue: Some(least) }
    }
}

impl Diagnostics {
    /// Stability this close to zero is that of a neutral direction, as a buckled round rod has one
    /// around its axis.
    pub const NEUTRAL: f64 = 1e-6;

    /// An equilibrium whose stability is less is almost unstable.
    pub const NEAR_CRITICAL: f64 = 0.05;

    /// With what is known of the stability.
    pub(crate) fn with_stability(self, verdict: Result<Verdict, NoStability>) -> Self {
        Self {
            stable: verdict.ok().map(|verdict| verdict.is_stable),
            stability: verdict.ok().and_then(|verdict| verdict.least_eigenvalue),
            stability_absent: verdict.err(),
            ..self
        }
    }

    /// Whether the answer is an equilibrium that the robot leaves at the slightest disturbance.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.stable == Some(false)
    }
}
