//! Cables that run straight from the hole of one disk to that of the next.
//!
//! Between two disks the rod carries no cable, and the steps in between have maps by the turn `φ` of the near disk
//! and by the change `ω = (δm, δg)` of what acts in the rod there. With `a` and `b` the near and the far hole as seen from
//! their disks (base frame), `t` the direction of the chord between them and `ℓ` its length, the cables give
//!
//! ```text
//! c = Δ + φ₁ × b − φ₀ × a + (δb − δa),    δℓ = t·c,    δt = (c − t δℓ)/ℓ                              (d6)
//! δg = δG − Σ δ(τ t),    δm = δM − Σ δ(τ a × t)     at the near disk                                    (d7)
//! δG = δg + Σ δ(τ t),    δM = δm + Σ δ(τ b × t)     at the far one
//! ```
//!
//! where `Δ` is the change of the displacement from disk to disk and `(M, G)` acts in rod and cables together. The first
//! line puts `c` in terms of `φ₀`, `ω` and of what acts within the span: (d7) are six equations for `ω`. A cable that ends at an
//! anchor before the far disk has its `Δ` and `φ₁` there, and what acts in the rod grows by `δ(τ t)` and `δ(τ b × t)` at the anchor,
//! which the map of the steps in between takes in. With these
//! eliminated a span has a map of the form that a step has, and [`super::elimination`] does not see the difference.

mod at_nodes;

use core::ops::Range;

use whipcord_numerics::{Mat3, Vec3};

use super::chord::{Chord, ChordChange, Pull, Pulls};
use super::effect::{Effect, Forcing};
use super::elimination::invert;
use super::forward::{Maps, StepMap, set_column};
use super::replay::{AXES, Answer, Replay};
use super::strands::Strands;
use crate::section::Fault;
use crate::shape::Wrench;
use crate::statics::grid::Grid;
use crate::statics::hold::Critical;
use crate::statics::passages::{Anchor, Passage};

/// The cables between two disks.
#[derive(Clone, Debug)]
pub(crate) struct StraightSpan<'a> {
    /// Steps of the grid between the disks.
    pub steps: Range<usize>,
    pub passages: &'a [Passage],
    /// Those that end before the far disk.
    pub anchors: &'a [Anchor],
    /// Tensions of the passages, where cables rub in their holes; else they are those of the cables.
    pub tensions: Option<&'a [f64]>,
}

#[derive(Clone, Debug, Default)]
struct Span {
    steps: Range<usize>,
    /// Its kept nodes, counted from the near disk: both disks, and the nodes between them that are asked for.
    kept: Vec<usize>,
    /// Where they begin among those of all spans.
    first: usize,
    chords: Vec<Chord>,
    /// Inverse of (d7).
    inverse: [[Mat3; 2]; 2],
}

impl Span {
    /// Its kept nodes among those of all spans.
    fn nodes(&self) -> Range<usize> {
        self.first..self.first + self.kept.len()
    }

    /// The chords that are anchored at a node, which is counted from the near disk.
    fn anchored_at(&self, node: usize) -> impl Iterator<Item = &Chord> {
        self.chords.iter().filter(move |chord| chord.is_anchored && self.kept[chord.end] == node)
    }
}

/// All spans of an answer. Of the nodes of the grid those are kept that are asked for, with each disk between two spans once
/// as the end of one, once as the start of the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Spans {
    /// Of the rod without its cables.
    pub replay: Replay,
    spans: Vec<Span>,
    /// Maps of the steps of the rod.
    rod: Vec<StepMap>,
    /// What acts within these steps, by steps, then inputs that are no tensions.
    rod_effects: Vec<Effect>,
    /// Maps of the rod from the disk before to each kept node, by `(φ₀, ω)`.
    along: Vec<StepMap>,
    /// How each kept node moves, and what the rod bears there, by turn, moment and force at the disk before: (d7) solved.
    inside: Vec<StepMap>,
    /// The same by the inputs; by nodes, then inputs.
    inside_effects: Vec<Effect>,
    /// Followers at the end of each step between two disks: what a turn adds to moment and force there.
    followers: Vec<Option<[Mat3; 2]>>,
    inputs: usize,
    cables: usize,
    memory: Memory,
}

/// Memory of [`Spans::compute`].
#[derive(Clone, Debug, Default)]
struct Memory {
    rod: Maps,
    /// What acts within a span, carried to its kept nodes.
    explicit: Vec<Effect>,
    /// What comes of it there.
    inside: Vec<Effect>,
    outputs: Vec<f64>,
}

/// What a dead wrench on a section does to its span, the near disk and what acts there held.
#[derive(Clone, Debug)]
pub(super) struct PlaceWrench {
    pub span: usize,
    pub effect: Effect,
    /// At the kept nodes of the span.
    pub inside: Vec<Effect>,
    /// Of the outputs of the span.
    pub lengths: Vec<f64>,
}

/// Where a cable's hole is in the two disks of a span, and what of this changes.
type HoleShifts<'a> = &'a dyn Fn(&Chord) -> ChordChange;

/// What acts at a stage by an input, by step, stage and input.
type ForcingBy<'a> = &'a dyn Fn(usize, usize, usize) -> Forcing;

/// How an input moves the holes of a cable at both ends of a span, in the frames of the disks; by input, cable and span.
type HolesBy<'a> = &'a dyn Fn(usize, usize, usize) -> [Vec3; 2];

/// An angle so small, in rad, has no direction.
const STRAIGHT: f64 = 1e-9;

const NOTHING: fn(usize) -> Effect = |_| Effect::default();
const HELD: HoleShifts<'static> =
    &|_| ChordChange { tension: 0.0, near: Vec3::ZERO, far: Vec3::ZERO };

impl Spans {
    /// Goes over an answer that is given by the rod's wrenches at the disks ([`Answer::starts`]), and keeps these nodes of
    /// the grid beside the disks.
    pub fn run(
        &mut self,
        answer: &Answer<'_>,
        spans: &mut dyn Iterator<Item = StraightSpan<'_>>,
        tensions: &[f64],
        nodes: &[usize],
    ) -> Result<(), Fault> {
        self.replay.run(answer)?;
        let (mut first, mut count) = (0, 0);
        let mut are_rubbing = false;
        for span in spans {
            are_rubbing |= span.tensions.is_some();
            let Range { start, end } = span.steps;
            if self.spans.len() == count {
                self.spans.push(Span::default());
            }
            let Span { kept, chords, .. } = &mut self.spans[count];
            let between = nodes.iter().filter(|node| (start + 1..end).contains(node));
            kept.clear();
            kept.extend(between.map(|node| node - start));
            kept.extend([0, end - start]);
            kept.extend(span.anchors.iter().map(|anchor| anchor.node - start));
            kept.sort_unstable();
            kept.dedup();
            first += kept.len();
            let chord = |(i, passage): (usize, &Passage)| {
                let anchor = span.anchors.iter().find(|anchor| anchor.passage == i);
                let node = anchor.map_or(end, |anchor| anchor.node);
                let (near, far) = (answer.poses[start], answer.poses[node]);
                let (a, b) = (near.rotation.rotate(passage.near), far.rotation.rotate(passage.far));
                let way = far.position + b - near.position - a;
                let length = way.norm();
                Chord {
                    cable: passage.cable,
                    tension: span.tensions.map_or_else(|| tensions[passage.cable], |own| own[i]),
                    length,
                    end: kept.partition_point(|&at| at < node - start),
                    is_anchored: anchor.is_some(),
                    along: way / length,
                    near: a,
                    far: b,
                    turns: [Vec3::ZERO; 2],
                }
            };
            chords.clear();
            chords.extend(span.passages.iter().enumerate().map(chord));
            let before = first - kept.len();
            (self.spans[count].steps, self.spans[count].first) = (span.steps, before);
            count += 1;
        }
        self.spans.truncate(count);
        if are_rubbing {
            self.turn();
        }
        let follower = |node: usize| {
            let wrench = answer.loads.follower(node);
            let turned = |w: Vec3| Mat3::skew(answer.poses[node].rotation.rotate(w));
            (*wrench != Wrench::default()).then(|| [wrench.moment, wrench.force].map(turned))
        };
        self.followers.clear();
        self.followers.extend((1..=answer.grid.len()).map(follower));
        for span in &self.spans {
            // Those at the disks act between the spans.
            self.followers[span.steps.end - 1] = None;
        }
        Ok(())
    }

    /// The map of a step of the rod without its cables, and what an input that is no tension does within it.
    pub fn rod_step(&self, step: usize, input: usize) -> (&StepMap, Effect) {
        let inputs = self.rod_effects.len() / self.rod.len().max(1);
        (&self.rod[step], self.rod_effects[step * inputs + input])
    }

    /// Fills in how the angles in the holes change with the directions of the chords. At the base cables come along its z axis.
    fn turn(&mut self) {
        for k in 0..self.spans.len() {
            for i in 0..self.spans[k].chords.len() {
                let Chord { cable, along, .. } = self.spans[k].chords[i];
                let before = k.checked_sub(1).and_then(|before| {
                    let place = |chord: &Chord| chord.cable == cable;
                    Some((before, self.spans[before].chords.iter().position(place)?))
                });
                let coming = before.map_or(Vec3::Z, |(k, i)| self.spans[k].chords[i].along);
                let sine = coming.cross(along).norm();
                let slope = if sine > STRAIGHT { -1.0 / sine } else { 0.0 };
                self.spans[k].chords[i].turns[0] = coming * slope;
                if let Some((before, j)) = before {
                    self.spans[before].chords[j].turns[1] = along * slope;
                }
            }
        }
    }

    /// How many spans there are.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// The node of the grid at which a span ends.
    pub fn far_disk(&self, span: usize) -> usize {
        self.spans[span].steps.end
    }

    /// The disk of a node of the grid, where there is one.
    pub fn disk(&self, node: usize) -> Option<usize> {
        let disk = self.spans.partition_point(|span| span.steps.end <= node);
        let at = self.spans.get(disk).map(|span| span.steps.start);
        (at == Some(node) || disk == self.spans.len()).then_some(disk)
    }

    /// Maps of all spans by their starts, the tensions of the cables in the span and `more` inputs, which act in the sections as `forcing` says by
    /// step, stage and input, and move the holes of a cable at both ends of a span as `holes` says by input, cable and
    /// span, in the frames of the disks.
    ///
    /// # Errors
    /// [`Critical`] where a span is about to buckle by itself.
    pub fn compute(
        &mut self,
        grid: &Grid,
        (cables, more, rows): (usize, usize, usize),
        (forcing, holes): (ForcingBy<'_>, HolesBy<'_>),
        maps: &mut Maps,
    ) -> Result<(), Critical> {
        self.cables = cables;
        let mut memory = core::mem::take(&mut self.memory);
        let rod = &mut memory.rod;
        rod.compute(&grid.steps, &self.replay, (0, 0), (0, more), forcing);
        core::mem::swap(&mut self.rod, &mut rod.steps);
        self.rod_effects.clone_from(&rod.effects);
        self.inputs = cables + more;
        maps.prepare(self.spans.len(), cables, more, rows);
        let nodes: usize = self.spans.iter().map(|span| span.kept.len()).sum();
        self.along.clear();
        self.along.reserve(nodes);
        self.inside.clear();
        self.inside.reserve(nodes);
        self.inside_effects.clear();
        self.inside_effects.resize(nodes * self.inputs, Effect::default());
        let found = (0..self.spans.len())
            .try_for_each(|k| self.map(k, (cables, rows), holes, (maps, &mut memory)));
        self.memory = memory;
        found
    }

    /// Map and inputs of one span.
    fn map(
        &mut self,
        k: usize,
        (cables, rows): (usize, usize),
        holes: HolesBy<'_>,
        (maps, memory): (&mut Maps, &mut Memory),
    ) -> Result<(), Critical> {
        self.compose(k);
        self.spans[k].inverse = self.invert(k)?;
        let map = self.by_start(k, &mut maps.length_by_state[k * rows..(k + 1) * rows], memory);
        maps.steps.push(map);
        let Memory { rod, explicit, inside, .. } = memory;
        let first = self.spans[k].steps.start;
        for input in 0..self.inputs {
            let of_input = (k * self.inputs + input) * rows;
            let lengths = &mut maps.length_by_input[of_input..of_input + rows];
            let start = [Vec3::ZERO; 3];
            let effect = match input.checked_sub(cables) {
                None => {
                    let pulled = |chord: &Chord| ChordChange {
                        tension: if chord.cable == input { 1.0 } else { 0.0 },
                        ..ChordChange::default()
                    };
                    self.carry(k, (first, Effect::default()), NOTHING, &pulled, explicit);
                    self.solve(k, start, explicit, &pulled, lengths, inside)
                }
                Some(more) => {
                    let acting = |step: usize| rod.effects_of(step)[more];
                    let moved = |chord: &Chord| self.moved(k, chord, holes(more, chord.cable, k));
                    self.carry(k, (first, Effect::default()), acting, &moved, explicit);
                    self.solve(k, start, explicit, &moved, lengths, inside)
                }
            };
            maps.effects[k * self.inputs + input] = effect;
            for (node, effect) in self.spans[k].nodes().zip(&*inside) {
                self.inside_effects[node * self.inputs + input] = *effect;
            }
        }
        Ok(())
    }

    /// Holes that move in the frames of their disks.
    fn moved(&self, k: usize, chord: &Chord, [near, far]: [Vec3; 2]) -> ChordChange {
        let turned = |node: usize, shift: Vec3| match node.checked_sub(1) {
            Some(step) => self.replay.ends[step].pose.rotation.rotate(shift),
            None => shift,
        };
        let Span { steps, kept, .. } = &self.spans[k];
        let end = steps.start + kept[chord.end];
        ChordChange { tension: 0.0, near: turned(steps.start, near), far: turned(end, far) }
    }

    /// Maps of the rod from the near disk to each kept node of a span.
    fn compose(&mut self, k: usize) {
        let mut at = StepMap::IDENTITY;
        self.along.push(at);
        let Span { steps, kept, .. } = &self.spans[k];
        for (node, step) in (1..).zip(steps.clone()) {
            at = at.then(&self.rod[step]);
            if let Some(follower) = &self.followers[step] {
                at = at.with_follower(follower);
            }
            if kept.contains(&node) {
                for chord in self.spans[k].anchored_at(node) {
                    at = at.with(|near_turn, end| {
                        let (pull, _) = chord.respond(near_turn, end, ChordChange::default());
                        [pull.far, pull.force]
                    });
                }
                self.along.push(at);
            }
        }
    }

    /// What acts from a node of the grid in a span on, carried to each kept node; nothing does before it.
    fn carry(
        &self,
        k: usize,
        (from, start): (usize, Effect),
        acting: impl Fn(usize) -> Effect,
        changes: HoleShifts<'_>,
        out: &mut Vec<Effect>,
    ) {
        let Span { steps, kept, .. } = &self.spans[k];
        let mut at = if from == steps.start { start } else { Effect::default() };
        out.clear();
        out.push(at);
        for (node, step) in (1..).zip(steps.clone()) {
            if step >= from {
                at = self.rod[step].carry(&at).plus(&acting(step));
                if let Some(follower) = &self.followers[step] {
                    at = at.with_follower(follower);
                }
                for chord in self.spans[k].anchored_at(node) {
                    let (pull, _) = chord.respond(Vec3::ZERO, &at, changes(chord));
                    at.moment += pull.far;
                    at.force += pull.force;
                }
            }
            if step + 1 == from {
                at = start;
            }
            if kept.contains(&node) {
                out.push(at);
            }
        }
    }

    /// What the chords exert once the kept nodes have moved so against the near disk, and the outputs of the span.
    fn pulls(
        &self,
        k: usize,
        near_turn: Vec3,
        at: impl Fn(usize) -> Effect,
        changes: HoleShifts<'_>,
        lengths: &mut [f64],
    ) -> Pulls {
        let mut sum = Pulls::default();
        for chord in &self.spans[k].chords {
            let (pull, stretched) = chord.respond(near_turn, &at(chord.end), changes(chord));
            stretched.add_to(chord.cable, self.cables, lengths);
            let Pull { force, near, far } = pull;
            sum.near = [sum.near[0] + near, sum.near[1] + force];
            if !chord.is_anchored {
                sum.far = [sum.far[0] + far, sum.far[1] + force];
            }
        }
        sum
    }

    /// Inverts (d7).
    fn invert(&self, k: usize) -> Result<[[Mat3; 2]; 2], Critical> {
        let along = &self.along[self.spans[k].nodes()];
        let mut columns = [[Mat3::ZERO; 2]; 2];
        for column in 0..6 {
            let mut start = [Vec3::ZERO; 3];
            let axis = AXES[column % 3];
            start[1 + column / 3] = axis;
            let at = |node: usize| along[node].apply(start);
            let of = self.pulls(k, Vec3::ZERO, at, HELD, &mut []);
            for (row, value) in of.near.into_iter().enumerate() {
                let own = if row == column / 3 { axis } else { Vec3::ZERO };
                set_column(&mut columns[row][column / 3], column % 3, own + value);
            }
        }
        invert(columns).ok_or(Critical)
    }

    /// Solves (d7) for a start, given by turn, moment and force, and what acts within: what comes out at the far disk, and
    /// in the rod at each kept node.
    fn solve(
        &self,
        k: usize,
        [turn, moment, force]: [Vec3; 3],
        explicit: &[Effect],
        changes: HoleShifts<'_>,
        lengths: &mut [f64],
        inside: &mut Vec<Effect>,
    ) -> Effect {
        let span = &self.spans[k];
        let along = &self.along[span.nodes()];
        let at = |node: usize, rod| along[node].apply(rod).plus(&explicit[node]);
        let last = along.len() - 1;
        let free = |node: usize| at(node, [turn, Vec3::ZERO, Vec3::ZERO]);
        let [of_moment, of_force] = self.pulls(k, turn, free, changes, &mut []).near;
        let (moment, force) = (moment - of_moment, force - of_force);
        let [[by_moment, by_force], [force_by_moment, force_by_force]] = span.inverse;
        let rod = [
            turn,
            by_moment * moment + by_force * force,
            force_by_moment * moment + force_by_force * force,
        ];
        inside.clear();
        inside.extend((0..along.len()).map(|node| at(node, rod)));
        let mut end = inside[last];
        let [of_moment, of_force] = self.pulls(k, turn, |node| inside[node], changes, lengths).far;
        end.moment += of_moment;
        end.force += of_force;
        end
    }

    /// The map of a span by its start; of the lengths by turn, moment and force, by cables.
    fn by_start(&mut self, k: usize, lengths: &mut [[Vec3; 3]], memory: &mut Memory) -> StepMap {
        let steps = self.spans[k].steps.clone();
        let follows =
            |step: usize| self.rod[step].force.is_some() || self.followers[step].is_some();
        let force = steps.clone().any(follows).then(Default::default);
        let mut map = StepMap { force, ..StepMap::default() };
        let of_rod = StepMap { force: Some(Default::default()), ..StepMap::default() };
        let nodes = self.spans[k].nodes();
        let Memory { explicit, inside, outputs, .. } = memory;
        explicit.clear();
        explicit.resize(nodes.len(), Effect::default());
        self.inside.resize(nodes.end, of_rod);
        outputs.clear();
        outputs.resize(lengths.len(), 0.0);
        for column in 0..9 {
            let mut start = [Vec3::ZERO; 3];
            start[column / 3] = AXES[column % 3];
            outputs.fill(0.0);
            let end = self.solve(k, start, explicit, HELD, outputs, inside);
            map.set(column, &end);
            for (of, by) in lengths.iter_mut().zip(&*outputs) {
                of[column / 3][column % 3] = *by;
            }
            for (node, effect) in nodes.clone().zip(&*inside) {
                self.inside[node].set(column, effect);
            }
        }
        map
    }

    /// What a dead wrench on a node of the grid does to its span, the one behind the node.
    pub fn push(&self, node: usize, wrench: Wrench, rows: usize) -> PlaceWrench {
        let span = self.span_behind(node);
        let start = Effect { moment: -wrench.moment, force: -wrench.force, ..Effect::default() };
        let (mut explicit, mut inside) = (Vec::new(), Vec::new());
        self.carry(span, (node, start), NOTHING, HELD, &mut explicit);
        let (rest, mut lengths) = ([Vec3::ZERO; 3], vec![0.0; rows]);
        let effect = self.solve(span, rest, &explicit, HELD, &mut lengths, &mut inside);
        PlaceWrench { span, effect, inside, lengths }
    }

    fn span_behind(&self, node: usize) -> usize {
        let span = self.spans.partition_point(|span| span.steps.end <= node);
        span.min(self.spans.len() - 1)
    }

    /// Changes of the lengths of the strands, on a rod at rest that bears nothing, by an input.
    pub fn lengths_at_rest(
        &self,
        grid: &Grid,
        strands: &Strands,
        forcing: &dyn Fn(usize, usize, usize) -> Forcing,
        holes: &dyn Fn(usize, usize) -> [Vec3; 2],
    ) -> Vec<f64> {
        let mut rod = Maps::default();
        rod.compute(&grid.steps, &self.replay, (0, 0), (0, 1), forcing);
        let mut lengths = vec![0.0; strands.count()];
        for (k, span) in self.spans.iter().enumerate() {
            let mut end = Effect::default();
            let mut at = vec![end];
            for (node, step) in (1..).zip(span.steps.clone()) {
                end = rod.steps[step].carry(&end).plus(&rod.effects_of(step)[0]);
                if span.kept.contains(&node) {
                    at.push(end);
                }
            }
            let moved = |chord: &Chord| self.moved(k, chord, holes(chord.cable, k));
            for chord in &span.chords {
                let (_, stretched) = chord.respond(Vec3::ZERO, &at[chord.end], moved(chord));
                if let Some(strand) = strands.at(k, chord.cable) {
                    lengths[strand] += stretched.length;
                }
            }
        }
        lengths
    }
}
