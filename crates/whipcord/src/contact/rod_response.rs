//! How a rod moves with the pushes of its contacts, and with the step that is left.

use whipcord_numerics::Vec3;

use super::loaded_places::LoadedPlaces;
use crate::derivatives::{Derivatives, Motion, OpenChange, unit_wrench};
use crate::statics::command::Command;
use crate::statics::friction::{CondensedHoles, Holes, Passages, Response};

/// A step that turns no cross-section by more than this, in rad, leaves the tangent as it is to this part: Newton's method with the tangent
/// from before it gains so many digits.
const SHORT_STEP: f64 = 2e-3;

/// The holes of a rod whose cables rub.
pub(crate) struct RodHoles<'a> {
    pub state: &'a mut CondensedHoles,
    pub holes: &'a Holes,
    pub commands: &'a [Command],
}

/// The linearised rod.
#[derive(Clone, Debug)]
pub(crate) struct RodResponse {
    derivatives: Derivatives,
    /// Which cables are taut.
    taut: Vec<bool>,
    /// Whether the rod has moved since by a short step, of which the equations are nearly these.
    is_reused: bool,
    /// Newton's step while the wrenches stay as they are.
    closing: Motion,
    /// The nodes that are pushed.
    nodes: LoadedPlaces<usize>,
    /// How everything moves with each component of a wrench on each of these nodes.
    by_push: Vec<Motion>,
    /// Where cables rub.
    open: Option<OpenResponse>,
    /// Whether the tensions of these are eliminated.
    pub is_eliminated: bool,
}

/// The equations of a rod linearised where it stands, and where it stood before its last step: after a short one they serve once more.
#[derive(Clone, Debug, Default)]
pub(crate) struct Linearised {
    /// Where it stands.
    pub here: Option<RodResponse>,
    /// Where it stood before its last step, and by how much that turned a cross-section at most, in rad.
    before_step: Option<(RodResponse, f64)>,
    /// The same, where it has looked around since.
    reusable: Option<(RodResponse, f64)>,
}

impl Linearised {
    /// The rod is moved, or gets another grid.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// The rod looks around.
    pub fn look(&mut self) {
        self.here = None;
        self.reusable = self.before_step.take();
    }

    /// The rod has taken a step that turned no cross-section by more than this.
    pub fn step(&mut self, turn: f64) {
        self.before_step = self.here.take().map(|linear| (linear, turn));
    }

    /// That of before the last step, where it serves once more; see [`RodResponse::reused`].
    pub fn take_reusable(
        &mut self,
        taut: &[bool],
        closing: impl FnOnce(&Derivatives) -> Motion,
    ) -> Option<RodResponse> {
        let (before, turn) = self.reusable.take()?;
        before.reused(turn, taut, closing)
    }
}

/// The response at constant tensions of all strands.
#[derive(Clone, Debug)]
struct OpenResponse {
    closing: OpenChange,
    by_push: Vec<OpenChange>,
    by_strand: Vec<OpenChange>,
}

impl OpenResponse {
    /// A motion at constant tensions, with these changes of the tensions.
    fn completed(&self, motion: &Motion, tensions: Vec<f64>) -> Motion {
        let mut motion = motion.clone();
        for (strand, &tension) in self.by_strand.iter().zip(&tensions) {
            motion.add(tension, &strand.motion);
        }
        Motion { tensions, ..motion }
    }

    /// Lengths and angles by the tensions and by closing the gaps, and by each component of the pushes.
    fn fill(&self, response: &mut Response, by_wrench: &mut Vec<Passages>) {
        let n = self.by_strand.len();
        let columns = || self.by_strand.iter().chain([&self.closing]);
        let rows = |of: usize, into: &mut Vec<f64>| {
            into.clear();
            into.extend((0..n).flat_map(|p| columns().map(move |column| column.outputs[of + p])));
        };
        rows(0, &mut response.lengths);
        rows(n, &mut response.turns);
        by_wrench.clear();
        by_wrench.extend(self.by_push.iter().map(|OpenChange { outputs, .. }| Passages {
            lengths: outputs[..n].to_vec(),
            turns: outputs[n..].to_vec(),
        }));
    }
}

impl RodResponse {
    pub fn new(derivatives: Derivatives, taut: Vec<bool>, closing: Motion) -> Self {
        let (nodes, by_push) = (LoadedPlaces::default(), Vec::new());
        Self {
            derivatives,
            taut,
            is_reused: false,
            closing,
            nodes,
            by_push,
            open: None,
            is_eliminated: false,
        }
    }

    /// That of where the rod stood before a step, for where it stands, which is left by another step; `None` of a rod whose cables rub, after a
    /// step that is not short, after another that did without, and where other cables are taut.
    fn reused(
        self,
        turn: f64,
        taut: &[bool],
        closing: impl FnOnce(&Derivatives) -> Motion,
    ) -> Option<Self> {
        let is_near = turn < SHORT_STEP && !self.is_reused && self.open.is_none();
        (is_near && self.taut == taut).then(|| {
            let closing = closing(&self.derivatives);
            Self { closing, is_reused: true, ..self }
        })
    }

    /// Of a rod whose cables rub.
    pub fn rubbing(derivatives: Derivatives, closing: OpenChange) -> Self {
        let by_strand = derivatives.strand_responses().collect();
        let open = Some(OpenResponse { closing, by_push: Vec::new(), by_strand });
        Self { open, ..Self::new(derivatives, Vec::new(), Motion::default()) }
    }

    /// Eliminates the tensions of the strands of a rod whose cables rub, with pushes at these nodes; `None` where the equations of the
    /// holes are singular.
    pub fn eliminate(&mut self, of_pushes: &[usize], at: RodHoles<'_>) -> Option<()> {
        let Self { derivatives, closing, nodes, by_push, open, .. } = self;
        let open = open.as_mut()?;
        nodes.set(of_pushes);
        let components = nodes.places().iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
        let respond = |(node, i): (usize, usize)| derivatives.open_response(node, unit_wrench(i));
        open.by_push = components.map(respond).collect();
        let RodHoles { state, holes, commands } = at;
        state.linearise(holes, commands, |response, by| open.fill(response, by))?;
        let mut columns = state.columns().iter();
        *closing = open.completed(&open.closing.motion, columns.next()?.clone());
        by_push.clear();
        let pairs = open.by_push.iter().zip(columns);
        by_push.extend(pairs.map(|(push, column)| open.completed(&push.motion, column.clone())));
        self.is_eliminated = true;
        Some(())
    }

    /// How the nodes of pushes move with each component of each of them, by rows, and how with the step that is left.
    pub fn compliance(
        &mut self,
        of_pushes: &[usize],
        compliance: &mut Vec<f64>,
        drift: &mut Vec<f64>,
    ) {
        let Self { derivatives, closing, nodes, by_push, open, .. } = self;
        if open.is_none() && (nodes.set(of_pushes) || by_push.is_empty()) {
            by_push.clear();
            let components = nodes.places().iter().flat_map(|&node| (0..6).map(move |i| (node, i)));
            let respond = |(node, i)| derivatives.contact_response(node, unit_wrench(i));
            by_push.extend(components.map(respond));
        }
        let twist = |motion: &Motion, place: usize| motion.nodes[nodes.places()[place]].twist();
        nodes.compliance(
            |wrench, place| twist(&by_push[wrench], place),
            |place| twist(closing, place),
            compliance,
            drift,
        );
    }

    /// What changes of the pushes add to the dead force behind a node: pushes are no forces of followers.
    pub fn wrench_beyond(&self, node: usize, changes: &[[f64; 6]]) -> Vec3 {
        self.nodes.beyond(node, changes)
    }

    /// The step that is left, with what changes of the pushes do.
    pub fn step(&self, changes: &[[f64; 6]]) -> Motion {
        let mut motion = self.closing.clone();
        // Without pushes nothing was asked of the response to them.
        for (column, change) in self.by_push.iter().zip(self.nodes.totals(changes)) {
            motion.add(change, column);
        }
        motion
    }

    /// The same of a rod whose cables rub, in the cases of the holes that agree with it.
    pub fn step_rubbing(&self, changes: &[[f64; 6]], at: RodHoles<'_>) -> Motion {
        let Some(open) = &self.open else { return self.step(changes) };
        let totals = self.nodes.totals(changes);
        let mut motion = open.closing.motion.clone();
        for (column, change) in open.by_push.iter().zip(&totals) {
            motion.add(*change, &column.motion);
        }
        let RodHoles { state, holes, commands } = at;
        let tensions = state.follow(holes, commands, &totals);
        open.completed(&motion, tensions)
    }
}
