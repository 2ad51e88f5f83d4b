//! A rod under dead loads, integrated from the base for a given base moment.
//!
//! The force `F(s)` at a cut is known (see [`super::loads`]); with the moment `M(s)` in the base
//! frame the state is `(R, p, M)`:
//!
//! ```text
//! R′ = R û,   p′ = R v,   M′ = −p′ × F      with (v, u) from eqs. (1), (2) at N = RᵀF, Mᵦ = RᵀM   (4)
//! ```
//!
//! The base moment is the only unknown; [`Shot::moment_by`] is the exact derivative of what arrives
//! at the tip with respect to it and to the tensions, from the variational equations of (4):
//!
//! ```text
//! δθ′ = R δu,   δM′ = −(δθ × p′ + R δv) × F,   H (δv, δu) = (Rᵀ(F × δθ), Rᵀ(δM + M × δθ)) − Σ qⱼ δτⱼ   (5)
//! ```

use whipcord_numerics::{BUTCHER_6, Mat3, Pose, UnitQuaternion, Vec3};

use super::grid::Grid;
use super::loads::DeadLoads;
use super::section::{BodyWrench, Strain, Tangent, equilibrium};
use super::unloaded::Fault;

const STAGES: usize = 7;
/// Which of the places of [`super::grid::SHOOTING_NODES`] each stage uses.
const NODE_OF_STAGE: [usize; STAGES] = [0, 1, 3, 1, 2, 2, 4];
/// Stages at the start, in the middle and at the end of a step.
const SAMPLED_STAGES: [usize; 3] = [0, 5, 6];

/// A cross-section of the loaded rod, for the second variation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample {
    pub strain: Strain,
    pub wrench: BodyWrench,
    pub tangent: Tangent,
    /// `K_bt` in N·m².
    pub bending: Vec3,
}

/// One integration from base to tip, and its derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Shot {
    /// Frames at the ends of all steps.
    pub poses: Vec<Pose>,
    /// Cable lengths in m.
    pub lengths: Vec<f64>,
    /// Moment left over at the tip beyond what the loads apply there, base frame, in N·m.
    pub excess: Vec3,
    /// Its derivative by each unknown: base moment (3), then the tensions.
    pub excess_by: Vec<Vec3>,
    /// `∂ℓᵢ` by each unknown, by rows of cables.
    pub lengths_by: Vec<f64>,
    /// Start, middle and end of each step, when asked for.
    pub samples: Vec<Sample>,
    strains: Vec<Strain>,
    columns: Vec<Column>,
    column_slopes: Vec<Column>,
    pulls: Vec<BodyWrench>,
    pulled_strains: Vec<Strain>,
}

/// Variation of rotation and moment with one unknown, in the base frame.
#[derive(Clone, Copy, Debug, Default)]
struct Column {
    turn: Vec3,
    moment: Vec3,
}

#[derive(Clone, Copy, Debug, Default)]
struct State {
    rotation: [f64; 4],
    position: Vec3,
    moment: Vec3,
}

/// How one integration is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim<'a> {
    /// Tensions in N, in the order of the grid.
    pub tensions: &'a [f64],
    /// Moment at the base in N·m.
    pub base_moment: Vec3,
    /// Factor on all loads.
    pub load: f64,
    /// By what derivatives are wanted.
    pub unknowns: Unknowns,
    /// Whether the sections are kept for the second variation.
    pub sample: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknowns {
    None,
    Moment,
    MomentAndTensions,
}

impl Shot {
    /// Starts the sections of the next, warm shot from the strains at the Gauss nodes of the
    /// rod without load.
    pub fn seed(&mut self, grid: &Grid, gauss_strains: &[Strain]) {
        self.strains.clear();
        for k in 0..grid.len() {
            let at = &gauss_strains[3 * k..3 * k + 3];
            self.strains.extend([0, 0, 2, 0, 1, 1, 2].map(|i: usize| at[i]));
        }
    }

    /// Lets the sections of the next shot start from their neighbours instead of the last shot.
    pub fn forget(&mut self) {
        self.strains.clear();
    }

    /// Integrates eqs. (4) and, where asked, (5).
    pub fn fire(&mut self, grid: &Grid, loads: &DeadLoads, aim: &Aim<'_>) -> Result<(), Fault> {
        let cables = aim.tensions.len();
        let columns = match aim.unknowns {
            Unknowns::None => 0,
            Unknowns::Moment => 3,
            Unknowns::MomentAndTensions => 3 + cables,
        };
        self.prepare(grid, cables, columns);
        let mut state = State {
            rotation: UnitQuaternion::IDENTITY.wxyz(),
            position: Vec3::ZERO,
            moment: aim.base_moment - aim.load * loads.moment(0),
        };
        self.poses.push(Pose::IDENTITY);
        let mut last = None;
        for k in 0..grid.len() {
            self.step(grid, loads, aim, k, columns, &mut state, &mut last)?;
            state.moment -= aim.load * loads.moment(k + 1);
            let rotation = renormalized(state.rotation);
            state.rotation = rotation.wxyz();
            self.poses.push(Pose { position: state.position, rotation });
        }
        self.excess = state.moment;
        self.excess_by.clear();
        self.excess_by.extend(self.columns.iter().map(|column| column.moment));
        Ok(())
    }

    fn prepare(&mut self, grid: &Grid, cables: usize, columns: usize) {
        self.poses.clear();
        self.lengths.clear();
        self.lengths.resize(cables, 0.0);
        self.samples.clear();
        if self.strains.len() != STAGES * grid.len() {
            self.strains.clear();
        }
        self.columns.clear();
        self.columns.resize(columns, Column::default());
        for (column, axis) in self.columns.iter_mut().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
            column.moment = axis;
        }
        self.column_slopes.resize(STAGES * columns, Column::default());
        let tensions = columns.saturating_sub(3);
        self.lengths_by.clear();
        self.lengths_by.resize(if tensions > 0 { cables * columns } else { 0 }, 0.0);
        self.pulls.resize(cables, BodyWrench::default());
        self.pulled_strains.resize(cables, Strain::default());
    }

    #[expect(clippy::too_many_arguments, reason = "the state of one sweep, passed step by step")]
    fn step(
        &mut self,
        grid: &Grid,
        loads: &DeadLoads,
        aim: &Aim<'_>,
        k: usize,
        columns: usize,
        state: &mut State,
        last: &mut Option<Strain>,
    ) -> Result<(), Fault> {
        let table = &BUTCHER_6;
        let step = grid.steps[k];
        let (h, active) = (step.length, step.active);
        let tensions = &aim.tensions[..active];
        let mut slopes = [State::default(); STAGES];
        for i in 0..STAGES {
            let stage = advance(state, &slopes[..i], &table.a[i], h);
            let node_index = NODE_OF_STAGE[i];
            let (node, crossings) = grid.shooting.at(k, node_index, active);
            let rotation = renormalized(stage.rotation);
            let r = rotation.to_matrix();
            let force = aim.load * loads.force(k, node);
            let wrench = BodyWrench {
                linear: r.transpose_mul(force),
                angular: r.transpose_mul(stage.moment),
            };
            let arc_length = step.start + table.c[i] * h;
            let slot = STAGES * k + i;
            let mut strain = match (self.strains.get(slot), *last) {
                (Some(&strain), _) => strain,
                (None, Some(strain)) => strain,
                (None, None) => node.section.rest_strain(),
            };
            let tangent = equilibrium(&node.section, crossings, tensions, wrench, &mut strain)
                .map_err(|kind| Fault { kind, arc_length })?;
            match self.strains.get_mut(slot) {
                Some(kept) => *kept = strain,
                None => self.strains.push(strain),
            }
            *last = Some(strain);
            if aim.sample && SAMPLED_STAGES.contains(&i) {
                let bending = node.section.stiffness.bending;
                self.samples.push(Sample { strain, wrench, tangent, bending });
            }
            let velocity = r * strain.linear;
            slopes[i] = State {
                rotation: (rotation * UnitQuaternion { w: 0.0, v: strain.angular * 0.5 }).wxyz(),
                position: velocity,
                moment: force.cross(velocity),
            };
            let weight = table.b[i] * h;
            for (c, crossing) in crossings.iter().enumerate() {
                let (pull, stretch) = crossing.pull(&strain);
                self.pulls[c] = pull;
                self.lengths[c] += weight * stretch;
            }
            if columns > 0 {
                let here = Linearised { rotation: r, force, moment: stage.moment, velocity };
                self.vary(&here, &tangent, i, columns, active, h);
            }
        }
        *state = advance(state, &slopes, &table.b, h);
        for c in 0..columns {
            let start = self.columns[c];
            self.columns[c] =
                combine(start, |j| self.column_slopes[j * columns + c], &table.b, STAGES, h);
        }
        Ok(())
    }

    /// Slopes of all columns at stage `i`, eq. (5).
    fn vary(
        &mut self,
        here: &Linearised,
        tangent: &Tangent,
        i: usize,
        columns: usize,
        active: usize,
        h: f64,
    ) {
        let table = &BUTCHER_6;
        let tensions = columns - 3;
        if tensions > 0 {
            for j in 0..active {
                self.pulled_strains[j] = tangent.solve(self.pulls[j]);
            }
        }
        let weight = table.b[i] * h;
        for c in 0..columns {
            let column = combine(
                self.columns[c],
                |j| self.column_slopes[j * columns + c],
                &table.a[i],
                i,
                h,
            );
            let mut change = tangent.solve(here.wrench_change(&column));
            if c >= 3 && c - 3 < active {
                change = change - self.pulled_strains[c - 3];
            }
            if tensions > 0 {
                for (j, pull) in self.pulls[..active].iter().enumerate() {
                    let rate = pull.linear.dot(change.linear) + pull.angular.dot(change.angular);
                    self.lengths_by[j * columns + c] += weight * rate;
                }
            }
            self.column_slopes[i * columns + c] = here.slope(&column, &change);
        }
    }
}

/// The state around which eq. (5) is linear.
struct Linearised {
    rotation: Mat3,
    force: Vec3,
    moment: Vec3,
    velocity: Vec3,
}

impl Linearised {
    #[inline]
    fn wrench_change(&self, column: &Column) -> BodyWrench {
        BodyWrench {
            linear: self.rotation.transpose_mul(self.force.cross(column.turn)),
            angular: self.rotation.transpose_mul(column.moment + self.moment.cross(column.turn)),
        }
    }

    #[inline]
    fn slope(&self, column: &Column, change: &Strain) -> Column {
        let velocity = column.turn.cross(self.velocity) + self.rotation * change.linear;
        Column { turn: self.rotation * change.angular, moment: self.force.cross(velocity) }
    }
}

#[inline]
fn renormalized([w, x, y, z]: [f64; 4]) -> UnitQuaternion {
    UnitQuaternion { w, v: Vec3::new(x, y, z) }.renormalized()
}

#[inline]
fn advance(start: &State, slopes: &[State], weights: &[f64; STAGES], h: f64) -> State {
    let mut out = *start;
    for (slope, &weight) in slopes.iter().zip(weights) {
        if weight != 0.0 {
            let f = h * weight;
            for i in 0..4 {
                out.rotation[i] += f * slope.rotation[i];
            }
            out.position += f * slope.position;
            out.moment += f * slope.moment;
        }
    }
    out
}

#[inline]
fn combine(
    start: Column,
    slope: impl Fn(usize) -> Column,
    weights: &[f64; STAGES],
    stages: usize,
    h: f64,
) -> Column {
    let mut out = start;
    for j in 0..stages {
        if weights[j] != 0.0 {
            let f = h * weights[j];
            let slope = slope(j);
            out.turn += f * slope.turn;
            out.moment += f * slope.moment;
        }
    }
    out
}
