//! Where a parameter enters: the explicit change `e` of the section equations, of the force, of the
//! loads between steps and of the cables' lengths, at constant strain and shape.

use whipcord_numerics::{GAUSS_5, Mat3, Twist, Vec3};

use super::cables::Cables;
use super::effect::Forcing;
use super::friction_change::FrictionChange;
use super::hole_source::{asked, hole_source};
use super::linear::Linear;
use super::mass_change::MassChange;
use super::replay::{AXES, TurnOutput};
use super::setting::{AtRest, Setting};
use super::spread_change::SpreadChange;
use super::step_ends::StepEnds;
use super::stiffness_change::{entry_wrench, stiffness_change};
use crate::parameter::{Parameter, RouteChange};
use crate::robot::{Robot, RobotError};
use crate::section::{BENDING_AXES, BodyWrench, Crossing, Section, Strain};
use crate::shape::Wrench;
use crate::statics::friction::{HoleSource, Holes};
use crate::statics::grid::{Node, SHOOTING_NODES};
use crate::statics::plastic_curvature::PlasticCurvature;

/// A section of the linearised answer.
#[derive(Clone, Copy, Debug)]
struct Place<'a> {
    /// Its step, and where along the backbone.
    k: usize,
    s: f64,
    /// Somewhere within the step.
    inside: f64,
    node: &'a Node,
    crossings: &'a [Crossing],
    strain: Strain,
    pulls: &'a [(BodyWrench, f64)],
    tensions: &'a [f64],
    /// Outputs that hang on the section beside those that are integrated.
    turns: &'a [TurnOutput],
    rotation: Mat3,
}

/// One parameter, with all that its partial derivatives take.
#[derive(Clone, Debug)]
pub(super) struct Partial {
    parameter: Parameter,
    /// By cables, in the order of the grid.
    routes: Vec<Option<RouteChange>>,
    masses: MassChange,
    spread: SpreadChange,
    /// Of the strands' lengths at rest.
    pub rest_lengths: Vec<f64>,
    /// What acts at each section within the steps; empty where nothing does.
    forcing: Vec<Forcing>,
    /// What acts just behind each node, and at the tip in front of it.
    at_nodes: Vec<Forcing>,
    /// With friction against bending: what acts just in front of the end of each step.
    at_ends: Vec<Forcing>,
    /// How the plastic curvature that earlier steps of actuation left changes.
    history: Option<PlasticCurvature>,
    /// Of the outputs at constant strain.
    pub lengths: Vec<f64>,
    /// The wrench that is added at a node, base frame.
    pub added: Option<(usize, Wrench)>,
    /// Change of the length that each cable is to keep, with its own stretch at its tension.
    pub targets: Vec<f64>,
}

impl Partial {
    /// # Errors
    /// [`RobotError`] when robot and case have no such quantity.
    pub fn new(
        setting: &Setting<'_>,
        linear: &Linear,
        parameter: &Parameter,
        (history, ends): (Option<&PlasticCurvature>, Option<&StepEnds>),
    ) -> Result<Self, RobotError> {
        let Setting { robot, case, cables, .. } = *setting;
        parameter.check(robot, case)?;
        let routes: Vec<_> =
            cables.order.iter().map(|&c| RouteChange::new(robot, c, parameter)).collect();
        let mut partial = Self {
            parameter: *parameter,
            rest_lengths: vec![0.0; setting.strands.count()],
            lengths: Vec::new(),
            routes,
            masses: MassChange::default(),
            spread: SpreadChange::new(&case.loads, parameter),
            forcing: Vec::new(),
            at_nodes: Vec::new(),
            at_ends: Vec::new(),
            history: None,
            added: None,
            targets: Vec::new(),
        };
        partial.masses = MassChange::new(setting, parameter);
        partial.change_rest_lengths(setting);
        partial.history = history.cloned();
        partial.lengths = partial.act(setting, linear, ends);
        partial.added = partial.wrench(setting);
        if parameter.grows_with_loads() && setting.of_loads != 1.0 {
            // What the steps before left changes by itself.
            let whole = partial.history.take().map(|history| (history, partial.clone()));
            if let Some((history, with_history)) = whole {
                partial.act(setting, linear, ends);
                partial.take_part(setting.of_loads - 1.0);
                partial.add_acting(&with_history);
                partial.history = Some(history);
            } else {
                partial.take_part(setting.of_loads);
            }
        }
        if !setting.strands.rub() {
            partial.targets =
                (0..partial.routes.len()).map(|place| partial.target(setting, place)).collect();
        }
        Ok(partial)
    }

    /// Takes a part of what acts.
    fn take_part(&mut self, part: f64) {
        let lists = [&mut self.forcing, &mut self.at_nodes, &mut self.at_ends];
        lists.into_iter().flatten().for_each(|forcing| *forcing = forcing.times(part));
        if let Some((_, wrench)) = &mut self.added {
            *wrench = Wrench { force: wrench.force * part, moment: wrench.moment * part };
        }
    }

    /// Adds what acts in another one.
    fn add_acting(&mut self, other: &Self) {
        let sum = |own: &mut Vec<Forcing>, other: &[Forcing]| {
            own.resize(other.len().max(own.len()), Forcing::default());
            own.iter_mut().zip(other).for_each(|(own, other)| *own = own.plus(other));
        };
        sum(&mut self.forcing, &other.forcing);
        sum(&mut self.at_nodes, &other.at_nodes);
        sum(&mut self.at_ends, &other.at_ends);
        if let (Some((_, own)), Some((_, other))) = (&mut self.added, &other.added) {
            own.add(1.0, other);
        }
    }

    /// What acts at a section within a step, by its number along the rod.
    #[inline]
    pub fn forcing(&self, at: usize) -> Forcing {
        self.forcing.get(at).copied().unwrap_or_default()
    }

    /// What acts just behind a node, and at the tip in front of it.
    pub fn at_node(&self, node: usize) -> Forcing {
        self.at_nodes.get(node).copied().unwrap_or_default()
    }

    /// What acts just in front of the end of a step, where that is known.
    pub fn at_end(&self, k: usize) -> Forcing {
        self.at_ends.get(k).copied().unwrap_or_default()
    }

    /// How friction against bending of a section changes.
    pub fn friction_change(
        &self,
        robot: &Robot,
        section: &Section,
        (s, inside): (f64, f64),
    ) -> FrictionChange {
        let mut bending = Vec3::ZERO;
        if let Parameter::Stiffness { row, column } = self.parameter
            && row == column
            && (3..3 + BENDING_AXES).contains(&row)
        {
            bending[row - 3] = 1.0;
        }
        let present = &section.stiffness;
        if let Some(change) = stiffness_change(robot, s, inside, present, &self.parameter) {
            bending += change.bending;
        }
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let rest = backbone.rest_curvature_change(disks, s, inside, &self.parameter);
        let plastic = self.history.as_ref().map_or_else(Default::default, |of| of.at(s, inside));
        FrictionChange::new(robot, &self.parameter, bending, rest, plastic)
    }

    /// Whether anything acts within a step.
    pub fn acts(&self) -> bool {
        !self.forcing.is_empty() || self.routes.iter().any(Option::is_some)
    }

    fn wrench(&self, setting: &Setting<'_>) -> Option<(usize, Wrench)> {
        let loads = &setting.case.loads;
        let (place, force, moment, follower) = match self.parameter {
            Parameter::TipForce { axis } => {
                (setting.grid.len(), AXES[axis], Vec3::ZERO, loads.tip_follower)
            }
            Parameter::TipMoment { axis } => {
                (setting.grid.len(), Vec3::ZERO, AXES[axis], loads.tip_follower)
            }
            Parameter::PointForce { load, axis } => {
                (setting.grid.loads[load], AXES[axis], Vec3::ZERO, loads.points[load].follower)
            }
            Parameter::PointMoment { load, axis } => {
                (setting.grid.loads[load], Vec3::ZERO, AXES[axis], loads.points[load].follower)
            }
            Parameter::PointMass { mass } => {
                let place = setting.grid.loads[loads.points.len() + mass];
                (place, loads.gravity.unwrap_or_default(), Vec3::ZERO, false)
            }
            _ => return None,
        };
        // What is applied to the clamped base bends nothing.
        if place == 0 {
            return None;
        }
        let rotation = if follower { setting.poses[place].rotation } else { setting.turn() };
        let wrench = Wrench { force: rotation.rotate(force), moment: rotation.rotate(moment) };
        Some((place, wrench))
    }

    fn target(&self, setting: &Setting<'_>, place: usize) -> f64 {
        let (asked, compliance) = self.asked(setting, place, self.rest_lengths[place]);
        asked + compliance * setting.tensions[place]
    }

    fn asked(&self, setting: &Setting<'_>, place: usize, rest: f64) -> (f64, f64) {
        let Cables { order, rest_lengths, .. } = setting.cables;
        let cable = order[place];
        asked(&self.parameter, (setting.robot, setting.case), cable, (rest_lengths[place], rest))
    }

    /// What the parameter changes in the equations of the holes.
    pub fn hole_source(&self, setting: &Setting<'_>, holes: &Holes) -> HoleSource {
        let Cables { order, rest_lengths, .. } = setting.cables;
        let cables = order.iter().copied().zip(rest_lengths.iter().copied());
        let is_length = |place: usize| setting.commands[place].is_length();
        let of = (setting.robot, setting.case);
        hole_source(&self.parameter, of, holes, (cables, &self.rest_lengths), is_length)
    }

    /// Whether the strain at rest or a course changes.
    fn changes_rest(&self) -> bool {
        self.changes_rest_curvature() || self.routes.iter().any(Option::is_some)
    }

    const fn changes_rest_curvature(&self) -> bool {
        matches!(
            self.parameter,
            Parameter::RestCurvature { .. } | Parameter::RestCurvatureAt { .. }
        )
    }

    /// Rate of the stretch at rest of a cable at an arc length, and a bound of its magnitude.
    fn rest_stretch(&self, setting: &Setting<'_>, place: usize, s: f64, inside: f64) -> [f64; 2] {
        let robot = setting.robot;
        let route = &robot.routes()[setting.cables.order[place]];
        let point = route.at(s);
        let (backbone, disks) = (robot.backbone(), robot.disks());
        let u = backbone.rest_curvature.at_end(disks, s, inside);
        let du = backbone.rest_curvature_change(disks, s, inside, &self.parameter);
        let (dr, d_slope) =
            self.routes[place].as_ref().map_or_else(Default::default, |change| change.at(route, s));
        let tangent = Vec3::Z + u.cross(point.offset) + point.slope;
        let change = du.cross(point.offset) + u.cross(dr) + d_slope;
        [tangent.dot(change) / tangent.norm(), change.norm()]
    }

    fn change_rest_lengths(&mut self, setting: &Setting<'_>) {
        let steps = if setting.cables.straight.is_some() { 0 } else { setting.grid.steps.len() };
        let kept = setting.cables.rest_changes;
        if let Some(known) = kept.and_then(|kept| kept.get(self.parameter, steps)) {
            self.rest_lengths = known;
            return;
        }
        if self.changes_rest() {
            self.compute_rest_lengths(setting);
        }
        if let Some(kept) = kept {
            kept.insert(self.parameter, steps, &self.rest_lengths);
        }
    }

    fn compute_rest_lengths(&mut self, setting: &Setting<'_>) {
        if let Some(AtRest { grid, linear: linear @ Linear::Spans(spans) }) = setting.at_rest {
            self.act(&Setting { grid, ..*setting }, linear, None);
            let forcing = |k: usize, i: usize, _: usize| self.forcing(linear.per_step() * k + i);
            let holes = |cable: usize, span: usize| self.moved_holes(setting.robot, cable, span);
            self.rest_lengths = spans.lengths_at_rest(grid, setting.strands, &forcing, &holes);
            return;
        }
        // Those of strands follow with the sections.
        if !setting.strands.rub() {
            for place in 0..self.rest_lengths.len() {
                self.rest_lengths[place] = self.rest_length_change(setting, place);
            }
        }
    }

    /// How the ends of a cable's piece in a span move, in the frames of the disks or of the cross-section of its anchor.
    pub fn moved_holes(&self, robot: &Robot, cable: usize, span: usize) -> [Vec3; 2] {
        let Some(change) = &self.routes[cable] else { return [Vec3::ZERO; 2] };
        let (route, disks) = (&robot.routes()[cable], &robot.disks().arc_lengths);
        [disks[span], disks[span + 1].min(route.end())].map(|s| change.at(route, s).0)
    }

    /// By Gauss quadrature in pieces of the steps that are halved until nothing changes beside the bound of the magnitude: the change itself may be
    /// nearly zero, as where a cable runs straight, and is then lost in rounding.
    fn rest_length_change(&self, setting: &Setting<'_>, place: usize) -> f64 {
        const MAX_HALVINGS: usize = 10;
        let reached = setting.grid.steps.iter().filter(|step| place < step.active);
        let total = |pieces: usize| -> [f64; 2] {
            let mut sums = [0.0; 2];
            for step in reached.clone() {
                let h = step.length / pieces as f64;
                for i in 0..pieces {
                    for (node, weight) in GAUSS_5.nodes.iter().zip(GAUSS_5.weights) {
                        let at = step.start + (i as f64 + node) * h;
                        let [rate, bound] = self.rest_stretch(setting, place, at, at);
                        sums[0] += h * weight * rate;
                        sums[1] += h * weight * bound;
                    }
                }
            }
            sums
        };
        let [mut change, _] = total(1);
        for halvings in 1..=MAX_HALVINGS {
            let [finer, bound] = total(1 << halvings);
            let moved = (finer - change).abs();
            change = finer;
            if moved <= 1e-11 * bound {
                break;
            }
        }
        change
    }

    /// Gathers the forcing of all stages; the explicit change of the lengths of cables through the sections.
    fn act(&mut self, setting: &Setting<'_>, linear: &Linear, ends: Option<&StepEnds>) -> Vec<f64> {
        let Setting { grid, .. } = *setting;
        let cables = self.routes.len();
        // Where cables are straight, a course that changes acts by the holes alone.
        let acts = self.changes_rest_curvature()
            || (self.routes.iter().any(Option::is_some) && linear.spans().is_none())
            || self.masses.any()
            || !self.spread.pieces.is_empty()
            || self.history.is_some()
            || matches!(
                self.parameter,
                Parameter::YoungModulus
                    | Parameter::ShearModulus
                    | Parameter::PoissonRatio
                    | Parameter::StiffnessScale(_)
                    | Parameter::SegmentFactor { .. }
                    | Parameter::ShearCorrection
                    | Parameter::Stiffness { .. }
                    | Parameter::YieldMoment { .. }
                    | Parameter::YieldStiffness { .. }
                    | Parameter::Gravity { .. }
            );
        self.forcing.clear();
        self.at_nodes.clear();
        self.at_ends.clear();
        let mut lengths = vec![0.0; setting.strands.outputs()];
        let mut rest = vec![0.0; setting.strands.count()];
        if !acts {
            return lengths;
        }
        // What straight cables do, their holes do at the disks.
        if linear.spans().is_none() && !setting.strands.rub() {
            lengths.clone_from(&self.rest_lengths);
        }
        for (k, step) in grid.steps.iter().enumerate() {
            let inside = step.start + 0.5 * step.length;
            for i in 0..linear.per_step() {
                let at = linear.per_step() * k + i;
                let (place, weight) = linear.place(i);
                let s = step.start + place * step.length;
                let (node, crossings) = linear.node(grid, k, i, step.active);
                let strain = linear.strain(at);
                let pulls = linear.pulls(at, cables, step.active);
                let section = Place {
                    k,
                    s,
                    inside,
                    node,
                    crossings,
                    strain,
                    pulls,
                    tensions: setting.tensions_at(k, linear.shooting_place(i)),
                    turns: linear.turns_at(k, i),
                    rotation: linear.rotation(at),
                };
                let outputs = (&mut lengths[..], &mut rest[..]);
                let out = self.act_at(setting, &section, weight * step.length, outputs);
                self.forcing.push(out);
            }
        }
        for n in 0..=grid.len() {
            let k = n.min(grid.len() - 1);
            let j = if n == k { 0 } else { LAST_NODE };
            let step = &grid.steps[k];
            let (place, inside) = (SHOOTING_NODES[j], step.start + 0.5 * step.length);
            let (node, crossings) = grid.shooting.at(k, j, step.active);
            let stage = linear.at_node(n);
            let section = Place {
                k,
                s: step.start + place * step.length,
                inside,
                node,
                crossings,
                strain: stage.strain,
                pulls: linear.pulls_at_node(n, cables, step.active),
                tensions: setting.tensions_at(k, j),
                turns: &[],
                rotation: stage.rotation,
            };
            let outputs = (&mut lengths[..], &mut rest[..]);
            let out = self.act_at(setting, &section, 0.0, outputs);
            self.at_nodes.push(out);
        }
        self.at_ends.clear();
        for k in 0..ends.map_or(0, |_| grid.len()) {
            let Some(ends) = ends else { break };
            let step = &grid.steps[k];
            let (node, crossings) = grid.shooting.at(k, LAST_NODE, step.active);
            let stage = ends.stage(k);
            let section = Place {
                k,
                s: step.start + step.length,
                inside: step.start + 0.5 * step.length,
                node,
                crossings,
                strain: stage.strain,
                pulls: ends.pulls(k, step.active),
                tensions: setting.tensions_at(k, LAST_NODE),
                turns: &[],
                rotation: stage.rotation,
            };
            let outputs = (&mut lengths[..], &mut rest[..]);
            let out = self.act_at(setting, &section, 0.0, outputs);
            self.at_ends.push(out);
        }
        if linear.spans().is_none() && setting.strands.rub() && self.changes_rest() {
            self.close_rest_lengths(setting, &mut rest, &mut lengths);
            self.rest_lengths = rest;
        }
        lengths
    }

    /// What the steps lack of the lengths at rest of the cables is in their first strands, in those at rest and in others.
    fn close_rest_lengths(&self, setting: &Setting<'_>, rest: &mut [f64], lengths: &mut [f64]) {
        let Setting { strands, grid, .. } = *setting;
        for cable in 0..strands.cables() {
            let mut of_steps = 0.0;
            let mut last = None;
            for link in 0..grid.len() {
                // A cable that does not rub is one strand.
                let strand = strands.at(link, cable).filter(|strand| Some(*strand) != last);
                of_steps += strand.map_or(0.0, |strand| rest[strand]);
                last = strand.or(last);
            }
            let Some(first) = strands.at(0, cable) else { continue };
            let lacks = self.rest_length_change(setting, cable) - of_steps;
            rest[first] += lacks;
            lengths[first] += lacks;
        }
    }

    /// What acts at one section; adds to the lengths.
    fn act_at(
        &self,
        setting: &Setting<'_>,
        section: &Place<'_>,
        weight: f64,
        (lengths, rest): (&mut [f64], &mut [f64]),
    ) -> Forcing {
        let Setting { robot, strands, .. } = *setting;
        let Place { k, s, inside, node, crossings, strain: at, pulls, tensions, turns, .. } =
            *section;
        let (v, u) = (at.linear, at.angular);
        let mut out = Forcing::default();
        let strain = Twist { linear: v - Vec3::Z, angular: u - node.section.rest_curvature };
        if let Parameter::Stiffness { row, column } = self.parameter {
            let wrench = entry_wrench(row, column, strain);
            out.force_balance += wrench.linear;
            out.moment_balance += wrench.angular;
        }
        let present = &node.section.stiffness;
        if let Some(change) = stiffness_change(robot, s, inside, present, &self.parameter) {
            out.force_balance += change.shear.scale(strain.linear);
            out.moment_balance += change.bending.scale(strain.angular);
        }
        let du = robot.backbone().rest_curvature_change(robot.disks(), s, inside, &self.parameter);
        if du != Vec3::ZERO {
            // −K (0, δu*), from the wrench of the strain that the section would have.
            let rest = node.section.rest_strain();
            let moved = Strain { angular: rest.angular + du, ..rest };
            let wrench = node.section.elastic_wrench(&moved);
            out.force_balance -= wrench.linear;
            out.moment_balance -= wrench.angular;
        }
        if node.section.friction().is_some() {
            let change = self.friction_change(robot, &node.section, (s, inside));
            out.moment_balance += change.moment(&node.section, u);
        }
        self.spread.act(&mut out, setting.turn(), section.s, inside, &section.rotation);
        match self.parameter {
            Parameter::Gravity { axis } => {
                let mass = node.distal_mass + setting.carried_beyond(k);
                out.force = mass * setting.turn().rotate(AXES[axis]);
            }
            _ => {
                if self.masses.any() {
                    let gravity = setting.case.loads.gravity.unwrap_or_default();
                    let mass = self.masses.beyond(setting, &self.parameter, k, s);
                    out.force += mass * setting.turn().rotate(gravity);
                }
            }
        }
        let rest_changes = self.changes_rest();
        for (place, (crossing, (pull, stretch))) in crossings.iter().zip(pulls).enumerate() {
            let strand = strands.at(k, place).unwrap_or(place);
            if rest_changes {
                let [rate, _] = self.rest_stretch(setting, place, s, inside);
                let part = weight * rate;
                if strands.rub() {
                    rest[strand] += part;
                } else {
                    lengths[strand] -= part;
                }
            }
            let Some(change) = &self.routes[place] else { continue };
            let route = &robot.routes()[setting.cables.order[place]];
            let (dr, d_slope) = change.at(route, s);
            let t = pull.linear;
            let along = u.cross(dr) + d_slope;
            let rate = t.dot(along);
            let turned = (along - rate * t) / *stretch;
            lengths[strand] += weight * rate;
            for turn in turns.iter().filter(|turn| turn.row % strands.cables() == place) {
                if let Some(output) = strands.output(k, turn.row) {
                    lengths[output] += turn.tangent.dot(along);
                }
            }
            let tension = tensions[place];
            out.force_balance += tension * turned;
            out.moment_balance += tension * (dr.cross(t) + crossing.offset.cross(turned));
        }
        out
    }
}

/// The last place of the shooting grid in a step.
const LAST_NODE: usize = SHOOTING_NODES.len() - 1;
