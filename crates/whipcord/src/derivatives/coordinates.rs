//! Exact derivatives of models that have generalised coordinates `q` for a rod.
//!
//! The coordinates solve `r(q, τ, p) = 0` with the tangent `H = ∂r/∂q`; the lengths of the cables are `ℓ(q, p)`, places move by
//! `J δq`, and the implicit function theorem gives
//!
//! ```text
//! δq = H⁻¹ f,   f = −Cᵀ δτ + Jᵀ δW − ∂r/∂p δp,   C = ∂ℓ/∂q                              (d8)
//! ```
//!
//! for changes of the tensions, of dead wrenches on the places and of a parameter. Contacts push `δW = K X₀` more when they would
//! move by `X₀` without this ([`super::touching`]), so that
//!
//! ```text
//! δq = H⁻¹ (f + J_cᵀ K J_c H⁻¹ f)                                                       (d9)
//! ```
//!
//! Tensions of the cables that are held follow as those of a rod do ([`crate::statics::hold`]). Where cables rub in their holes, every
//! passage has a tension, and the outputs that the holes' equations take ([`crate::statics::friction`]) are lengths and angles of all
//! passages; else they are the lengths of the cables.

mod adjoint;

use std::sync::Arc;

use whipcord_numerics::{Twist, Vec3, dot};

use super::change::{Change, Place, Places};
use super::linear_system::{KnownPlaces, LinearSystem, ParameterChange, add};
use super::local::local;
use super::sliding_holes::{AnswerHoles, Cause, SlidingHoles};
use super::touching::{ContactGain, Remembered, components};
use crate::error::SolveError;
use crate::kinematics::{Local, Matrix6, OneSided};
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::friction::Carried;
use crate::statics::hold::{Critical, HeldCables, Hold};

/// A cable of an answer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoordinateCable {
    pub command: Command,
    pub is_taut: bool,
    /// What a tension of 1 N adds to its length in m.
    pub compliance: f64,
}

/// An answer, as it is differentiated.
#[derive(Clone, Debug)]
pub(crate) struct SolvedCoordinates {
    pub system: LinearSystem,
    pub places: KnownPlaces,
    pub cables: Vec<CoordinateCable>,
    pub parameters: Vec<ParameterChange>,
    /// Length of the backbone in m.
    pub length: f64,
    /// Whether friction against bending of a joint is about to slide or to stick.
    pub is_bending_about_to_change: bool,
}

/// The contacts that hold an answer.
#[derive(Clone, Debug, Default)]
struct Contacts {
    /// By the number of their places.
    places: Vec<usize>,
    /// `K` by rows.
    gain: Vec<f64>,
    remembered: Remembered,
    are_about_to_change: bool,
}

/// A change at constant tensions.
#[derive(Clone, Debug, Default)]
struct Response {
    coordinates: Vec<f64>,
    /// Of the places.
    twists: Vec<Twist>,
    /// Of the outputs.
    lengths: Vec<f64>,
    base: Wrench,
    /// How the objects move, and what they were held with changes by.
    objects: Vec<f64>,
}

/// The derivatives of one answer of a model with generalised coordinates; frames and signs as [`super::Derivatives`] has them.
#[derive(Clone, Debug)]
pub struct CoordinateDerivatives {
    system: LinearSystem,
    places: Arc<Places>,
    cables: Vec<CoordinateCable>,
    parameters: Vec<ParameterChange>,
    /// By the tension of each cable, or of each passage.
    by_tension: Vec<Response>,
    held: HeldCables,
    /// Where cables rub.
    sliding: Option<Box<SlidingHoles>>,
    contacts: Contacts,
    /// Of an answer whose way was differentiated though no cable rubs: the derivatives of its motion from there on, for what is added to the
    /// robot as it stands.
    moving_on: Option<Box<Self>>,
    length: f64,
    are_cables_about_to_change: bool,
    is_bending_about_to_change: bool,
}

impl CoordinateDerivatives {
    /// Of an answer. `gain` makes `K` of the compliance of the places of its contacts, both by rows.
    ///
    /// # Errors
    /// [`SolveError::NoDerivatives`] where the robot is about to buckle.
    pub(crate) fn of(
        solved: SolvedCoordinates,
        are_about_to_change: bool,
        gain: impl FnOnce(&[f64]) -> Result<ContactGain, Critical>,
    ) -> Result<Self, SolveError> {
        Self::linear(solved, None, are_about_to_change, gain)
            .map_err(|Critical| SolveError::NoDerivatives)
    }

    /// Of an answer whose cables rub in these holes, and how the state that the holes remember changes, as
    /// [`AnswerHoles::carried`] has it, with the motions of the stations as what touches next. `gain` is as in [`Self::of`].
    ///
    /// # Errors
    /// As [`Self::of`].
    pub(crate) fn of_sliding(
        solved: SolvedCoordinates,
        holes: &AnswerHoles<'_>,
        are_about_to_change: bool,
        gain: impl FnOnce(&[f64]) -> Result<ContactGain, Critical>,
    ) -> Result<(Self, Vec<Carried>), SolveError> {
        let derivatives = Self::linear(solved, Some(holes), are_about_to_change, gain)
            .map_err(|Critical| SolveError::NoDerivatives)?;
        let Some(sliding) = &derivatives.sliding else { return Ok((derivatives, Vec::new())) };
        let mut carried = sliding.carried(|cause| derivatives.caused(cause).lengths);
        if !holes.is_last {
            for (cause, carried) in sliding.causes().zip(&mut carried) {
                let mut response = derivatives.caused(cause);
                derivatives.complete(&mut response, Hold::Commands, cause);
                let stations = derivatives.places.stations.iter();
                carried.places =
                    stations.flat_map(|&place| components(response.twists[place])).collect();
                carried.places.extend(response.objects);
            }
        }
        Ok((derivatives, carried))
    }

    /// What a cause changes at constant tensions.
    fn caused(&self, cause: Cause) -> Response {
        let remembered = self.contacts.remembered.of(cause).unwrap_or(&[]);
        match cause {
            Cause::Parameter(p) => {
                let parameter = &self.parameters[p];
                let own = (&parameter.lengths[..], parameter.base);
                self.respond_to(&parameter.force, own, remembered)
            }
            _ if remembered.is_empty() => self.still(),
            _ => {
                let nothing = vec![0.0; self.system.coordinates];
                self.respond_to(&nothing, (&[], Wrench::default()), remembered)
            }
        }
    }

    fn linear(
        solved: SolvedCoordinates,
        holes: Option<&AnswerHoles<'_>>,
        are_about_to_change: bool,
        gain: impl FnOnce(&[f64]) -> Result<ContactGain, Critical>,
    ) -> Result<Self, Critical> {
        let SolvedCoordinates { system, places, cables, parameters, length, .. } = solved;
        let KnownPlaces { stations, disks, contacts: touching, .. } = places;
        let tip = disks.last().copied().unwrap_or(0);
        let mut derivatives = Self {
            system,
            places: Arc::new(Places { stations, disks, tip }),
            cables,
            parameters,
            by_tension: Vec::new(),
            held: HeldCables::default(),
            sliding: None,
            contacts: Contacts { are_about_to_change, ..Contacts::default() },
            moving_on: None,
            length,
            are_cables_about_to_change: false,
            is_bending_about_to_change: solved.is_bending_about_to_change,
        };
        let alone = match holes {
            None => derivatives.length_scale(),
            Some(_) => 0.0,
        };
        if !touching.is_empty() || holes.is_some() {
            let gain = gain(&derivatives.compliance_of(&touching))?;
            let places = touching;
            let gravity: Vec<Vec3> = derivatives.parameters.iter().map(|of| of.gravity).collect();
            let remembered = Remembered::new(&gain, holes).weighing(&gain, &gravity);
            let gain = gain.by_motion;
            derivatives.contacts = Contacts { places, gain, remembered, are_about_to_change };
        }
        let count = derivatives.cables.len();
        let pulls = holes.map_or(count, |answer| answer.holes.count());
        derivatives.by_tension = (0..pulls).map(|i| derivatives.by_tension(i)).collect();
        let outputs = |j: usize| &derivatives.by_tension[j].lengths[..];
        let cables = &derivatives.cables;
        if holes.is_none_or(|answer| !answer.holes.rub()) {
            derivatives.held = HeldCables::new(
                count,
                |i, j| outputs(j)[i],
                |i| cables[i].compliance,
                |i| cables[i].is_taut,
                |i| cables[i].command.is_length(),
            )?;
            derivatives.held.settle(alone);
        }
        if let Some(answer) = holes {
            derivatives.sliding = Some(Box::new(SlidingHoles::new(answer, outputs)?));
        }
        let finite = derivatives.by_tension.iter().all(Response::is_finite);
        if finite { Ok(derivatives) } else { Err(Critical) }
    }

    /// The most that a cable gets longer by under its own tension, in m/N, without contacts.
    fn length_scale(&self) -> f64 {
        let rows = self.system.lengths.chunks_exact(self.system.coordinates.max(1));
        rows.map(|row| dot(row, &self.system.solve(row)).abs()).fold(0.0, f64::max)
    }

    /// How the places at these numbers move with each component of a wrench on each of them, by rows, without contacts.
    fn compliance_of(&self, places: &[usize]) -> Vec<f64> {
        let n = 6 * places.len();
        let mut compliance = vec![0.0; n * n];
        for (j, place) in places.iter().enumerate() {
            for component in 0..6 {
                let moved = self.system.solve(self.system.row(*place, component));
                for (i, other) in places.iter().enumerate() {
                    for a in 0..6 {
                        let row = self.system.row(*other, a);
                        compliance[(6 * i + a) * n + 6 * j + component] = dot(row, &moved);
                    }
                }
            }
        }
        compliance
    }

    /// The change that goes with a generalised force, and with what changes besides at constant coordinates.
    fn respond(&self, force: &[f64], own: (&[f64], Wrench)) -> Response {
        self.respond_to(force, own, &[])
    }

    /// The same, with what the contacts push more for what is remembered.
    fn respond_to(&self, force: &[f64], own: (&[f64], Wrench), remembered: &[f64]) -> Response {
        let system = &self.system;
        let mut force = force.to_vec();
        let mut base = own.1;
        let mut moved = system.solve(&force);
        let mut objects = Vec::new();
        if self.contacts.places.is_empty() {
            objects.extend_from_slice(remembered);
        } else {
            let motion: Vec<f64> =
                self.contacts.rows().map(|(k, a)| dot(system.row(k, a), &moved)).collect();
            let mut pushes: Vec<f64> = self
                .contacts
                .gain
                .chunks_exact(motion.len())
                .map(|row| dot(row, &motion))
                .collect();
            add(&mut pushes, 1.0, remembered);
            objects = pushes.split_off(motion.len());
            for ((place, component), push) in self.contacts.rows().zip(pushes) {
                add(&mut force, push, system.row(place, component));
                base.add(push, &system.at_base(place, component));
            }
            moved = system.solve(&force);
        }
        base.add(1.0, &system.base_of(&force));
        let lengths = system.lengths.chunks_exact(system.coordinates.max(1));
        let mut lengths: Vec<f64> = lengths.map(|row| dot(row, &moved)).collect();
        add(&mut lengths, 1.0, own.0);
        let twists = (0..system.positions.len()).map(|place| {
            let [x, y, z, u, v, w] = core::array::from_fn(|a| dot(system.row(place, a), &moved));
            Twist { linear: Vec3::new(x, y, z), angular: Vec3::new(u, v, w) }
        });
        Response { twists: twists.collect(), lengths, base, coordinates: moved, objects }
    }

    fn by_tension(&self, cable: usize) -> Response {
        let n = self.system.coordinates;
        let pull: Vec<f64> =
            self.system.lengths[cable * n..(cable + 1) * n].iter().map(|c| -c).collect();
        self.respond(&pull, (&[], Wrench::default()))
    }

    fn by_wrench(&self, place: usize, component: usize) -> Response {
        let at_base = self.system.at_base(place, component);
        self.respond(self.system.row(place, component), (&[], at_base))
    }

    /// How the coordinates change with a parameter while the commands are held, and what the parameter changes at constant coordinates of what
    /// friction against bending keeps.
    pub(crate) fn kept_by(&self, parameter: usize) -> (Vec<f64>, &[f64]) {
        let cause = Cause::Parameter(parameter);
        let mut response = self.caused(cause);
        self.complete(&mut response, Hold::Commands, cause);
        (response.coordinates, &self.parameters[parameter].kept)
    }

    /// A change at constant tensions completed by the tensions that keep what is held.
    fn completed(&self, mut response: Response, hold: Hold, cause: Cause) -> Change {
        let [pulls, base] = self.complete(&mut response, hold, cause);
        let Response { twists, lengths, base: at_base, .. } = response;
        let (lengths, tensions) = match &self.sliding {
            Some(sliding) => (sliding.cable_lengths(&lengths), base),
            None => (lengths, pulls),
        };
        let (places, strains) = (self.places.clone(), Vec::new());
        Change { places, twists, strains, base: at_base, lengths, tensions }
    }

    /// The same, and the changes of the tensions, where cables rub of those of all passages and of those below the base.
    fn complete(&self, response: &mut Response, hold: Hold, cause: Cause) -> [Vec<f64>; 2] {
        let outputs = &response.lengths;
        let [pulls, base] = match &self.sliding {
            Some(sliding) => sliding.tensions(hold, outputs, cause),
            None => {
                let target = |i: usize| match cause {
                    Cause::Parameter(p) => self.parameters[p].targets[i],
                    Cause::Command(cable) if cable == i => -1.0,
                    _ => 0.0,
                };
                let right: Vec<f64> = (0..outputs.len()).map(|i| target(i) - outputs[i]).collect();
                [self.held.tensions(hold, &right), Vec::new()]
            }
        };
        for (column, &tension) in self.by_tension.iter().zip(&pulls) {
            response.add(tension, column);
        }
        [pulls, base]
    }

    /// Nothing that changes at constant tensions.
    fn still(&self) -> Response {
        Response {
            coordinates: vec![0.0; self.system.coordinates],
            twists: vec![Twist::default(); self.system.positions.len()],
            lengths: vec![0.0; self.by_tension.first().map_or(0, |column| column.lengths.len())],
            base: Wrench::default(),
            objects: Vec::new(),
        }
    }

    /// As [`super::Derivatives::command`].
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn command(&self, cable: usize) -> Change {
        match self.cables[cable].command {
            Command::Tension(_) if self.sliding.is_none() => self.pulled(cable, Hold::Commands),
            _ => {
                let cause = Cause::Command(cable);
                self.completed(self.caused(cause), Hold::Commands, cause)
            }
        }
    }

    /// [`Self::command`] of every cable.
    #[must_use]
    pub fn commands(&self) -> Vec<Change> {
        (0..self.cables.len()).map(|cable| self.command(cable)).collect()
    }

    /// As [`super::Derivatives::offset`].
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn offset(&self, cable: usize) -> Change {
        match self.sliding {
            Some(_) => {
                let cause = Cause::Offset(cable);
                self.completed(self.caused(cause), Hold::Commands, cause)
            }
            None => self.command(cable),
        }
    }

    fn pulled(&self, cable: usize, hold: Hold) -> Change {
        let mut change = self.completed(self.by_tension[cable].clone(), hold, Cause::Nothing);
        change.tensions[cable] += 1.0;
        change
    }

    /// As [`super::Derivatives::tension`].
    ///
    /// # Panics
    /// When the robot has no cable of this number.
    #[must_use]
    pub fn tension(&self, cable: usize) -> Change {
        if let Some(on) = &self.moving_on {
            return on.tension(cable);
        }
        match self.sliding {
            Some(_) => self.completed(self.still(), Hold::Tensions, Cause::Tension(cable)),
            None => self.pulled(cable, Hold::Tensions),
        }
    }

    /// As [`super::Derivatives::parameter`].
    ///
    /// # Panics
    /// When no parameter has this number.
    #[must_use]
    pub fn parameter(&self, index: usize, hold: Hold) -> Change {
        let cause = Cause::Parameter(index);
        self.completed(self.caused(cause), hold, cause)
    }

    /// As [`super::Derivatives::wrench`].
    ///
    /// # Panics
    /// When there is no such station or disk, or the component is none of 0 to 5.
    #[must_use]
    pub fn wrench(&self, at: Place, component: usize, hold: Hold) -> Change {
        assert!(component < 6, "a wrench has six components, none of which is {component}");
        if let Some(on) = &self.moving_on {
            return on.wrench(at, component, hold);
        }
        self.completed(self.by_wrench(self.places.number(at), component), hold, Cause::Nothing)
    }

    /// As [`super::Derivatives::actuation_jacobian`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn actuation_jacobian(&self, at: Place) -> Vec<Twist> {
        (0..self.cables.len()).map(|cable| self.command(cable).twist(at)).collect()
    }

    /// As [`super::Derivatives::length_by_command`].
    #[must_use]
    pub fn length_by_command(&self) -> Vec<Vec<f64>> {
        let by: Vec<Change> = (0..self.cables.len()).map(|cable| self.command(cable)).collect();
        (0..by.len()).map(|i| by.iter().map(|change| change.lengths[i]).collect()).collect()
    }

    /// As [`super::Derivatives::tension_jacobian`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    #[must_use]
    pub fn tension_jacobian(&self, at: Place) -> Vec<Twist> {
        (0..self.cables.len()).map(|cable| self.tension(cable).twist(at)).collect()
    }

    /// As [`super::Derivatives::length_by_tension`].
    #[must_use]
    pub fn length_by_tension(&self) -> Vec<Vec<f64>> {
        let by: Vec<Change> = (0..self.cables.len()).map(|cable| self.tension(cable)).collect();
        (0..by.len()).map(|i| by.iter().map(|change| change.lengths[i]).collect()).collect()
    }

    /// As [`super::Derivatives::compliance`].
    ///
    /// # Errors
    /// [`SolveError::NoDerivatives`] where the robot is so near to buckling that it is not finite.
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn compliance(&self, at: Place, hold: Hold) -> Result<Matrix6, SolveError> {
        let columns = core::array::from_fn(|component| self.wrench(at, component, hold).twist(at));
        let finite = |twist: &Twist| twist.linear.is_finite() && twist.angular.is_finite();
        if columns.iter().all(finite) {
            Ok(Matrix6::from_columns(&columns))
        } else {
            Err(SolveError::NoDerivatives)
        }
    }

    /// As [`super::Derivatives::stiffness`].
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn stiffness(&self, at: Place, hold: Hold) -> Result<Option<Matrix6>, SolveError> {
        Ok(self.compliance(at, hold)?.inverse(self.length))
    }

    /// As [`super::Derivatives::at`].
    ///
    /// # Errors
    /// As [`Self::compliance`].
    ///
    /// # Panics
    /// When there is no such station or disk.
    pub fn at(&self, place: Place) -> Result<Local, SolveError> {
        let commands = self.cables.iter().map(|cable| &cable.command);
        let jacobians = (self.actuation_jacobian(place), self.length_by_command());
        let caveats = (self.one_sided(), self.are_lengths_dependent(Hold::Commands));
        local(self.length, commands, jacobians, |hold| self.compliance(place, hold), caveats)
    }

    /// What is about to change at the answer.
    #[must_use]
    pub fn one_sided(&self) -> OneSided {
        OneSided {
            contact: self.is_contact_about_to_change(),
            hole: self.is_hole_about_to_change(),
            cable: self.is_cable_about_to_change(),
            bending: self.is_bending_about_to_change(),
        }
    }

    /// As [`crate::Linearization::is_bending_about_to_change`].
    #[must_use]
    pub const fn is_bending_about_to_change(&self) -> bool {
        self.is_bending_about_to_change
    }

    /// Whether a contact of the answer is about to open or to close, to stick or to slide.
    #[must_use]
    pub const fn is_contact_about_to_change(&self) -> bool {
        self.contacts.are_about_to_change
    }

    /// As [`super::Derivatives::moving_on`].
    pub(crate) fn moving_on(self, on: Self) -> Self {
        Self { moving_on: Some(Box::new(on)), ..self }
    }

    /// Notes whether a contact was between two cases on the way, of which something is remembered.
    pub(crate) const fn remember_change(&mut self, was_between: bool) {
        self.contacts.are_about_to_change |= was_between;
    }

    /// Notes which cables are about to go slack or to become taut in the answer.
    pub(crate) fn note_cables(&mut self, solution: &Solution) {
        let commands = self.cables.iter().map(|cable| &cable.command);
        let rub = self.sliding.as_ref().is_some_and(|sliding| sliding.held.rub());
        self.are_cables_about_to_change =
            !rub && Command::are_about_to_change(commands, &solution.cables, self.length);
    }

    /// As [`super::Derivatives::is_cable_about_to_change`].
    #[must_use]
    pub const fn is_cable_about_to_change(&self) -> bool {
        self.are_cables_about_to_change
    }

    /// As [`crate::Linearization::are_lengths_dependent`].
    #[must_use]
    pub fn are_lengths_dependent(&self, hold: Hold) -> bool {
        self.held.are_dependent(hold)
    }

    /// As [`super::Derivatives::is_hole_about_to_change`].
    #[must_use]
    pub fn is_hole_about_to_change(&self) -> bool {
        self.sliding.as_ref().is_some_and(|sliding| sliding.held.is_about_to_change())
    }
}

impl Contacts {
    /// Place and component of each number that a push consists of.
    fn rows(&self) -> impl Iterator<Item = (usize, usize)> {
        self.places.iter().flat_map(|&place| (0..6).map(move |component| (place, component)))
    }
}

impl Response {
    fn add(&mut self, f: f64, other: &Self) {
        if f == 0.0 {
            return;
        }
        for (twist, by) in self.twists.iter_mut().zip(&other.twists) {
            *twist = *twist + *by * f;
        }
        add(&mut self.lengths, f, &other.lengths);
        add(&mut self.coordinates, f, &other.coordinates);
        self.objects.resize(self.objects.len().max(other.objects.len()), 0.0);
        add(&mut self.objects, f, &other.objects);
        self.base.add(f, &other.base);
    }

    fn is_finite(&self) -> bool {
        self.twists.iter().all(|t| t.linear.is_finite() && t.angular.is_finite())
            && self.lengths.iter().all(|length| length.is_finite())
    }
}
