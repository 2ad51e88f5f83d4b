//! The second variation within a span: quadratic forms of its steps, and of the chords that end in it.

use whipcord_numerics::{Mat3, Vec3};

use super::chord::Chord;
use super::layout::Mesh;
use super::variation::Sample;
use crate::section::Tangent;
use crate::statics::quadratic_form::Sample as Section;
use crate::statics::quadratic_form::{
    Element, SLOPES, WEIGHTS, element, negative_eigenvalues, pivot, symmetric,
};

/// Below this part of the greatest a compliance is none.
const NO_COMPLIANCE: f64 = 1e-12;

/// `b` of a piece of cable that is held.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Border {
    pub lock: usize,
    pub near: Vec3,
    pub far: Vec3,
    pub way: Vec3,
}

/// One step: the rod's form on (start, middle, end), and its borders by `ν`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Step {
    pub rod: Element,
    /// Blocks of (ηᵢ, ν).
    pub borders: [Mat3; 3],
    /// Block of (ν, ν).
    pub corner: Mat3,
}

/// What is held as a border of a form within a span: of (η near, η here, ν, δd).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Carried {
    pub near: Vec3,
    pub here: Vec3,
    pub force: Vec3,
    pub way: Vec3,
}

/// The chords of one span that end at one place: blocks on (ζ near, ζ far, δd), all in the frame of the near disk.
#[derive(Clone, Debug, Default)]
pub(super) struct Tie {
    /// The number of steps before that place: at an anchor, or at last at the far disk.
    pub node: usize,
    pub near: Mat3,
    pub far: Mat3,
    pub way: Mat3,
    pub near_far: Mat3,
    pub near_way: Mat3,
    pub far_way: Mat3,
    /// Its pieces that are held.
    pub borders: core::ops::Range<usize>,
    /// How the cross-section there is turned.
    pub turn: Mat3,
}

/// The inverse of the block of a force and a way,
///
/// ```text
/// | F  I |⁻¹   | force   across |    F = force ≤ 0, of rank two where a piece is one step of a rod that neither stretches nor
/// | I  W |   = | solved  way    |    shears;  W = way ≥ 0, zero where no cable ends
/// ```
///
/// so that neither can be eliminated before the other, and `I − F W` can always be inverted where
/// the signs are these; and how many of its directions are negative, three of which are those of the force.
pub(super) struct Pair {
    pub force: Mat3,
    pub across: Mat3,
    pub solved: Mat3,
    pub way: Mat3,
    pub negative: usize,
}

/// What a force and a way leave of a form whose cables end at one place once they are eliminated: on (η near, η here), and what
/// loads on them become there.
pub(super) struct Tied {
    pub near: Mat3,
    pub here: Mat3,
    pub near_here: Mat3,
    pub near_force: Mat3,
    pub here_force: Mat3,
    pub near_way: Mat3,
    pub here_way: Mat3,
    pub pair: Pair,
}

/// A form on (η near, η here, ν).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Form {
    pub near: Mat3,
    pub here: Mat3,
    pub force: Mat3,
    pub near_here: Mat3,
    pub near_force: Mat3,
    pub here_force: Mat3,
}

/// Puts what is held at a place where cables end to what is carried there.
pub(super) fn put(tie: &Tie, borders: &[Border], within: &mut [Carried]) {
    for border in &borders[tie.borders.clone()] {
        if let Some(carried) = within.get_mut(border.lock) {
            carried.near += border.near;
            carried.here += border.far;
            carried.way += border.way;
        }
    }
}

pub(super) fn step(mesh: &Mesh, k: usize, triple: &[Sample]) -> Option<Step> {
    let h = mesh.grid.steps[k].length;
    let section = |q: usize| &mesh.grid.shooting.at(k, 2 * q, 0).0.section;
    let mut sections = [Section::default(); 3];
    for (q, (out, sample)) in sections.iter_mut().zip(triple).enumerate() {
        let tangent = Tangent::at(section(q), &[], &[], &sample.strain).ok()?;
        let Sample { strain, wrench, rotation, .. } = *sample;
        *out = Section { strain, wrench, tangent, rotation };
    }
    let rod = element(h, &sections, |q| section(q).bending_stiffness());
    let mut out = Step { rod, ..Step::default() };
    for (q, sample) in sections.iter().enumerate() {
        let weight = WEIGHTS[q] * h;
        let frame = sample.rotation.to_matrix();
        let to_body = frame.transpose();
        let (compliance, coupling) = sample.tangent.force_compliance();
        let by_slope = frame * coupling.transpose() * to_body;
        for i in 0..3 {
            out.borders[i] += by_slope * (-weight * SLOPES[q][i] / h);
        }
        let push = Mat3::skew(sample.wrench.linear);
        let by_turn = push * compliance - Mat3::skew(sample.strain.linear);
        out.borders[q] += frame * by_turn * to_body * weight;
        out.corner += to_body.transpose() * compliance * to_body * -weight;
    }
    Some(out)
}

impl Step {
    /// The step's form with its middle eliminated.
    pub fn without_middle(&self, shift: f64) -> (Form, usize) {
        let block = |i: usize, j: usize| self.rod.energy[i][j] - self.rod.metric[i][j] * shift;
        let (middle, below) = pivot(symmetric(block(1, 1)));
        let by = |i: usize| block(i, 1) * middle;
        let (start, end) = (by(0), by(2));
        let force = self.borders[1].transpose() * middle;
        let form = Form {
            near: symmetric(block(0, 0) - start * block(1, 0)),
            here: symmetric(block(2, 2) - end * block(1, 2)),
            force: symmetric(self.corner - force * self.borders[1]),
            near_here: block(0, 2) - start * block(1, 2),
            near_force: self.borders[0] - start * self.borders[1],
            here_force: self.borders[2] - end * self.borders[1],
        };
        (form, below)
    }
}

impl Form {
    /// This form, where there is one yet, and those of the next steps, with all nodes between them eliminated, and what is
    /// carried to the end.
    pub fn along(
        before: Option<Self>,
        steps: &[Step],
        shift: f64,
        (within, schur): (&mut [Carried], &mut [f64]),
        negative: &mut usize,
    ) -> Option<Self> {
        let mut form = before;
        for step in steps {
            let (next, below) = step.without_middle(shift);
            *negative += below;
            form = Some(match form {
                None => next,
                Some(before) => {
                    let (joined, between, below) = before.then(&next);
                    *negative += below;
                    if within.iter().any(|carried| carried.here != Vec3::ZERO) {
                        before.carry(&next, &between, within, schur);
                    }
                    joined
                }
            });
        }
        form
    }

    /// This form and that of the next step, with the node between them eliminated; the inverse of its block, and how many of its
    /// directions are negative.
    pub fn then(&self, next: &Self) -> (Self, Mat3, usize) {
        let (between, below) = pivot(symmetric(self.here + next.near));
        let force = self.here_force + next.near_force;
        let near = self.near_here * between;
        let far = next.near_here.transpose() * between;
        let form = Self {
            near: symmetric(self.near - near * self.near_here.transpose()),
            here: symmetric(next.here - far * next.near_here),
            force: symmetric(self.force + next.force - force.transpose() * (between * force)),
            near_here: -(near * next.near_here),
            near_force: self.near_force - near * force,
            here_force: next.here_force - far * force,
        };
        (form, between, below)
    }

    /// What is carried over the node between this form and that of the next step.
    pub fn carry(&self, next: &Self, between: &Mat3, within: &mut [Carried], schur: &mut [f64]) {
        let held = within.len();
        let force = self.here_force + next.near_force;
        for i in 0..held {
            let at = *between * within[i].here;
            for j in 0..held {
                schur[i * held + j] -= at.dot(within[j].here);
            }
        }
        for carried in within {
            let at = *between * carried.here;
            carried.near -= self.near_here * at;
            carried.force -= force.transpose() * at;
            carried.here = -(next.near_here.transpose() * at);
        }
    }

    /// With the chords that end here put to it, and the force and the way to here eliminated together.
    pub fn tie(&self, tie: &Tie) -> Tied {
        let pair = Pair::of(symmetric(self.force), symmetric(tie.way));
        let near_force = self.near_force * pair.force + tie.near_way * pair.solved;
        let here_force = self.here_force * pair.force + tie.far_way * pair.solved;
        let near_way = self.near_force * pair.across + tie.near_way * pair.way;
        let here_way = self.here_force * pair.across + tie.far_way * pair.way;
        Tied {
            near: self.near + tie.near
                - near_force * self.near_force.transpose()
                - near_way * tie.near_way.transpose(),
            here: self.here + tie.far
                - here_force * self.here_force.transpose()
                - here_way * tie.far_way.transpose(),
            near_here: self.near_here + tie.near_far
                - near_force * self.here_force.transpose()
                - near_way * tie.far_way.transpose(),
            near_force,
            here_force,
            near_way,
            here_way,
            pair,
        }
    }
}

impl Pair {
    pub fn of(force: Mat3, way: Mat3) -> Self {
        let size = |block: &Mat3| block.rows.iter().map(|row| row.max_abs()).fold(0.0, f64::max);
        // A force without compliance is all reaction: it counts among the three that are negative.
        let reaction = NO_COMPLIANCE * size(&force).max(f64::MIN_POSITIVE);
        let below = negative_eigenvalues(&(force - Mat3::IDENTITY * reaction));
        let (solved, _) = pivot(Mat3::IDENTITY - force * way);
        let across = Mat3::IDENTITY + way * solved * force;
        let by_way = symmetric(-(solved * force));
        // The inverse of what is left of W has its signs.
        let rounding = NO_COMPLIANCE * size(&by_way);
        let below_way = negative_eigenvalues(&(by_way + Mat3::IDENTITY * rounding));
        let negative = below + below_way;
        Self { force: -(way * solved), across, solved, way: by_way, negative }
    }
}

impl Tied {
    /// Eliminates force and way of what is carried; what is left on (η near, η here), force and way as they were.
    pub fn eliminate(&self, within: &mut [Carried], schur: &mut [f64]) {
        let held = within.len();
        let Pair { force, across, solved, way, .. } = &self.pair;
        for i in 0..held {
            let by = |a: &Carried| {
                (*force * a.force + *across * a.way, *solved * a.force + *way * a.way)
            };
            let (at_force, at_way) = by(&within[i]);
            for j in 0..held {
                schur[i * held + j] -= at_force.dot(within[j].force) + at_way.dot(within[j].way);
            }
        }
        for carried in within {
            carried.near -= self.near_force * carried.force + self.near_way * carried.way;
            carried.here -= self.here_force * carried.force + self.here_way * carried.way;
        }
    }
}

impl Tie {
    /// Adds a piece of cable.
    pub fn add(&mut self, near: Vec3, far: Vec3, turn: &Mat3, chord: &Chord, tension: f64) {
        let t = chord.along;
        let stiff = (Mat3::IDENTITY - Mat3::outer(t, t)) * (tension / chord.length);
        // δc = δd + Q(η × h₁) − η × h₀.
        let by_near = Mat3::skew(near);
        let by_far = *turn * Mat3::skew(far) * turn.transpose() * -1.0;
        self.way += stiff;
        self.near_way += by_near.transpose() * stiff;
        self.far_way += by_far.transpose() * stiff;
        self.near_far += by_near.transpose() * stiff * by_far;
        // t·(η × (η × h)) = (t·η)(h·η) − (t·h)|η|².
        let second =
            |t: Vec3, h: Vec3| (symmetric(Mat3::outer(t, h)) - Mat3::IDENTITY * t.dot(h)) * tension;
        self.near += by_near.transpose() * stiff * by_near - second(t, near);
        self.far += by_far.transpose() * stiff * by_far + second(t, *turn * far);
    }
}
