//! Steps along the backbone and what is known of the robot at their quadrature nodes.
//!
//! Disks, stations, cable ends, corners of a routing, places of loads and places at which the backbone's
//! stiffness or rest curvature is given all lie between steps, never inside one, so that the
//! integrators keep their order.

use std::collections::BinaryHeap;
use std::sync::{Arc, OnceLock};

use whipcord_numerics::{GAUSS_3, Vec3};

use crate::case::Loads;
use crate::error::SolveError;
use crate::robot::{Along, Robot, Route, RoutePoint};
use crate::section::of_robot::section_at;
use crate::section::one_cable::Reduced;
use crate::section::{BodyWrench, CableGroup, Crossing, Section};
use crate::statics::one_cable_table::OneCableTable;
use crate::statics::section_runs::SectionRun;
use crate::statics::section_table::Place;
use crate::statics::step_table::StepTable;

/// Places of the nodes in a step at which [`whipcord_numerics::BUTCHER_5`] evaluates.
pub(crate) const SHOOTING_NODES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Weights of these places in [`whipcord_numerics::BUTCHER_5`].
const BOOLE: [f64; 5] = [7.0 / 90.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0];

/// One step from `start` to `start + length`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub start: f64,
    pub length: f64,
    /// The cables that reach through this step are the first so many, longest cable first.
    pub active: usize,
}

/// The robot at one node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    pub section: Section,
    /// Mass of backbone and disks beyond the node in kg.
    pub distal_mass: f64,
}

/// The nodes of all steps at the same places of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nodes {
    per_step: usize,
    cables: usize,
    nodes: Vec<Node>,
    crossings: Vec<Crossing>,
    /// The same in groups.
    groups: Vec<CableGroup>,
    /// By how much quadrature at these nodes gets each cable too long on the rod at rest, in m, in
    /// the order of the grid.
    pub rest_excess: Vec<f64>,
    /// What eq. (9) at a node has beside the tension when nothing but its one cable pulls; `None` where
    /// there are more cables, or the section is not equally stiff about x and y.
    pub one_cable: OneCableTable,
    /// Whether the section at a node, and how cables cross it, is that at the node before it: on a straight robot with straight
    /// cables one is solved for all.
    repeats: Vec<bool>,
    /// Nodes whose sections are solved side by side, ascending.
    pub runs: Arc<[SectionRun]>,
}

impl Nodes {
    /// Fills [`Self::one_cable`], [`Self::repeats`] and [`Self::runs`]; `at` has the places of the nodes in a step.
    fn reduced(mut self, steps: &[Step], at: &[f64]) -> Self {
        let places = (0..steps.len()).flat_map(|k| (0..self.per_step).map(move |j| (k, j)));
        let repeats = places.clone().map(|(k, j)| {
            let before = match j {
                0 => (k.checked_sub(1)?, self.per_step - 1),
                _ => (k, j - 1),
            };
            let active = steps[k].active;
            let (node, crossings) = self.at(k, j, active);
            let (last, last_crossings) = self.at(before.0, before.1, steps[before.0].active);
            // Friction against bending changes with the steps of actuation.
            let is_fixed = node.section.beside.is_none();
            Some(is_fixed && node.section == last.section && crossings == last_crossings)
        });
        self.repeats = repeats.map(Option::unwrap_or_default).collect();
        if self.cables == 0 {
            return self;
        }
        let mut one_cable = OneCableTable::with_capacity(self.per_step * steps.len());
        for (k, j) in places {
            match self.at(k, j, steps[k].active) {
                (Node { section, .. }, [_]) if !section.isotropic => one_cable.push_other(),
                (_, [_]) if self.repeats(k, j) => one_cable.push_same(),
                (Node { section, .. }, [crossing]) => {
                    one_cable.push(&Reduced::of(section, crossing, BodyWrench::default()));
                }
                _ => one_cable.push_other(),
            }
        }
        self.one_cable = one_cable;
        self.runs = self.side_by_side(steps, at).into();
        self
    }

    fn side_by_side(&self, steps: &[Step], at: &[f64]) -> Vec<SectionRun> {
        let count = self.per_step * steps.len();
        SectionRun::all((0..count).map(|node| {
            let (k, j) = (node / self.per_step, node % self.per_step);
            let (Node { section, .. }, crossings) = self.at(k, j, steps[k].active);
            // Where several are the same one is solved for all.
            let is_alone = !self.repeats[node] && self.repeats.get(node + 1) != Some(&true);
            let is_one = self.one_cable.slot(node).is_some() || crossings.is_empty();
            let arc_length = steps[k].start + at[j] * steps[k].length;
            (is_alone && !is_one && section.beside.is_none()).then_some(Place {
                section,
                crossings,
                arc_length,
            })
        }))
    }

    /// Whether the section at a node is one of [`Self::runs`].
    #[inline]
    pub fn is_in_run(&self, node: usize) -> bool {
        self.runs.iter().any(|run| run.nodes.contains(&node))
    }

    /// Whether the section at node `j` of step `k` is that at the node before it.
    #[inline]
    pub fn repeats(&self, k: usize, j: usize) -> bool {
        self.repeats[k * self.per_step + j]
    }

    /// Node `j` of step `k`, and how the first `active` cables cross it.
    #[inline]
    pub fn at(&self, k: usize, j: usize, active: usize) -> (&Node, &[Crossing]) {
        let i = k * self.per_step + j;
        (&self.nodes[i], &self.crossings[i * self.cables..i * self.cables + active])
    }

    /// The first `active` cables at node `j` of step `k` in groups: none of so few that one after the other is faster.
    #[inline]
    pub fn groups(&self, k: usize, j: usize, active: usize) -> &[CableGroup] {
        let first = (k * self.per_step + j) * CableGroup::count(self.cables);
        &self.groups[first..first + CableGroup::count(active)]
    }

    /// The section of a node by its number, and how the first `active` cables cross it.
    #[inline]
    pub fn crossed(&self, node: usize, active: usize) -> (&Section, &[Crossing]) {
        let first = node * self.cables;
        (&self.nodes[node].section, &self.crossings[first..first + active])
    }

    /// Node `j` of step `k`, to be changed.
    pub(super) fn node_mut(&mut self, k: usize, j: usize) -> &mut Node {
        &mut self.nodes[k * self.per_step + j]
    }
}

/// How soft the nodes of a step are at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Softest {
    /// The least of EI and GJ in N·m².
    pub bending: f64,
    /// The greatest compliance of shear and extension in 1/N.
    pub compliance: f64,
}

impl Softest {
    /// Of the nodes of one step.
    fn of(nodes: &[Node]) -> Option<Self> {
        let none = Self { bending: f64::INFINITY, compliance: 0.0 };
        nodes.iter().try_fold(none, |softest, Node { section, .. }| {
            let bending = section.stiffness.bending;
            section.beside.is_none().then(|| Self {
                bending: softest.bending.min(bending.x).min(bending.y).min(bending.z),
                compliance: softest.compliance.max(section.compliance.shear.max_abs()),
            })
        })
    }
}

/// The discretised robot.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub steps: Vec<Step>,
    /// At the Gauss nodes, for quadrature.
    pub gauss: Nodes,
    /// At the Runge–Kutta nodes, for shooting.
    pub shooting: Nodes,
    /// The softest section of each step; `None` where one is coupled or has friction against bending.
    pub softest: Vec<Option<Softest>>,
    /// For each station the number of steps before it.
    pub stations: Vec<usize>,
    /// For each disk the number of steps before it.
    pub disks: Vec<usize>,
    /// For each of [`Loads::places`] the number of steps before it.
    pub loads: Vec<usize>,
    /// For each anchor of the layout the number of steps before it.
    pub anchors: Vec<usize>,
    /// Its steps side by side, made when they are first asked for.
    step_table: OnceLock<Option<StepTable>>,
}

/// What does not depend on how fine the grid is.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub breakpoints: Vec<f64>,
    stations: Vec<f64>,
    loads: Vec<f64>,
    /// Anchors of cables that are not those of the robot.
    anchors: Vec<f64>,
    /// Cables in the order of the grid: the longest first, so that those that reach a step come
    /// before those that do not.
    pub order: Vec<usize>,
    /// Lengths of the cables on the rod at rest in m, in that order.
    pub rest_lengths: Vec<f64>,
}

impl Layout {
    pub fn new(robot: &Robot, stations: Vec<f64>, loads: &Loads) -> Self {
        Self::with_anchors(robot, stations, loads, Vec::new())
    }

    /// The same with steps that end at these anchors of cables that are not those of the robot.
    pub fn with_anchors(
        robot: &Robot,
        stations: Vec<f64>,
        loads: &Loads,
        anchors: Vec<f64>,
    ) -> Self {
        let length = robot.backbone().length;
        let load_places: Vec<f64> = loads.places().collect();
        let mut breakpoints = vec![0.0, length];
        breakpoints.extend_from_slice(&robot.disks().arc_lengths);
        breakpoints.extend_from_slice(&stations);
        breakpoints.extend_from_slice(&load_places);
        breakpoints.extend_from_slice(&anchors);
        breakpoints.extend_from_slice(&robot.backbone().places());
        for route in robot.routes() {
            breakpoints.extend_from_slice(route.breakpoints());
            breakpoints.push(route.end());
        }
        breakpoints.sort_by(f64::total_cmp);
        // Places that differ by rounding only are one place.
        breakpoints.dedup_by(|b, a| *b - *a <= 1e-10 * length);
        let mut order: Vec<usize> = (0..robot.cables().len()).collect();
        order.sort_by(|&a, &b| robot.routes()[b].end().total_cmp(&robot.routes()[a].end()));
        let rest_lengths = order.iter().map(|&c| robot.rest_length(c, &breakpoints)).collect();
        Self { breakpoints, stations, loads: load_places, anchors, order, rest_lengths }
    }

    /// Number of the breakpoint at an arc length.
    fn breakpoint(&self, arc_length: f64) -> usize {
        let after = self.breakpoints.partition_point(|&s| s < arc_length);
        let near = |i: &usize| (self.breakpoints[*i] - arc_length).abs();
        let before = after.saturating_sub(1);
        let last = self.breakpoints.len() - 1;
        [before, after.min(last)]
            .into_iter()
            .min_by(|a, b| near(a).total_cmp(&near(b)))
            .unwrap_or(last)
    }

    /// Arc length at the stations, as they were asked for.
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Whether the loads of a case begin, end and sit where the layout expects it.
    pub fn has_loads_of(&self, loads: &Loads) -> bool {
        loads.places().eq(self.loads.iter().copied())
    }
}

impl Grid {
    /// A grid with at least `steps` steps from base to tip, of about the same length.
    pub fn new(robot: &Robot, layout: &Layout, steps: usize) -> Result<Self, SolveError> {
        Self::refined(robot, layout, steps, 0)
    }

    /// The same grid with every step halved `halvings` times.
    pub fn refined(
        robot: &Robot,
        layout: &Layout,
        steps: usize,
        halvings: usize,
    ) -> Result<Self, SolveError> {
        let ends: Vec<f64> = layout.order.iter().map(|&c| robot.routes()[c].end()).collect();
        let mut grid_steps = Vec::new();
        let mut before = vec![0];
        for (pair, parts) in layout.breakpoints.windows(2).zip(share(robot, layout, steps)) {
            let gap = pair[1] - pair[0];
            let parts = parts << halvings;
            let middle = 0.5 * (pair[0] + pair[1]);
            let active = ends.iter().take_while(|&&end| end > middle).count();
            for i in 0..parts {
                let start = pair[0] + gap * i as f64 / parts as f64;
                grid_steps.push(Step { start, length: gap / parts as f64, active });
            }
            before.push(grid_steps.len());
        }
        let place = |s: &f64| before[layout.breakpoint(*s)];
        let disks: Vec<usize> = robot.disks().arc_lengths.iter().map(place).collect();
        let mut disk_masses = vec![0.0; grid_steps.len() + 1];
        for &k in &disks {
            disk_masses[k] += robot.disks().mass;
        }
        let sections = Sections::of(robot)?;
        let masses = distal_masses(&sections, &grid_steps, &disk_masses);
        let shooting = nodes(&sections, layout, &grid_steps, &masses, &SHOOTING_NODES, &BOOLE)?;
        Ok(Self {
            gauss: nodes(
                &sections,
                layout,
                &grid_steps,
                &masses,
                &GAUSS_3.nodes,
                &GAUSS_3.weights,
            )?
            .reduced(&grid_steps, &GAUSS_3.nodes),
            softest: shooting.nodes.chunks(SHOOTING_NODES.len()).map(Softest::of).collect(),
            shooting,
            stations: layout.stations.iter().map(place).collect(),
            disks,
            loads: layout.loads.iter().map(place).collect(),
            anchors: layout.anchors.iter().map(place).collect(),
            steps: grid_steps,
            step_table: OnceLock::new(),
        })
    }

    /// Its sections step beside step; `None` where one's stiffness is not diagonal.
    pub fn step_table(&self) -> Option<&StepTable> {
        let make = || {
            let steps = self.steps.iter().enumerate();
            let places = steps.flat_map(|(k, step)| {
                SHOOTING_NODES.iter().enumerate().map(move |(j, at)| {
                    let (node, crossings) = self.shooting.at(k, j, step.active);
                    let arc_length = step.start + at * step.length;
                    Place { section: &node.section, crossings, arc_length }
                })
            });
            StepTable::new(&places.collect::<Vec<_>>(), SHOOTING_NODES.len())
        };
        self.step_table.get_or_init(make).as_ref()
    }

    /// Arc lengths in m of the ends of its steps, the base first.
    pub fn ends(&self) -> Vec<f64> {
        let end = self.steps.last().map(|step| step.start + step.length);
        self.steps.iter().map(|step| step.start).chain(end).collect()
    }

    /// The robot at the start (0) or at the end (1) of step `k`, just inside of it.
    pub fn at_end(&self, k: usize, end: usize) -> &Node {
        self.shooting.at(k, end * (SHOOTING_NODES.len() - 1), 0).0
    }

    /// Number of steps.
    pub fn len(&self) -> usize {
        self.steps.len()
    }
}

/// Shares `steps` steps out between the breakpoints, at least one to each interval: the next step
/// always goes where the error of a method of order 6 is expected to be largest.
fn share(robot: &Robot, layout: &Layout, steps: usize) -> Vec<usize> {
    let effort: Vec<f64> =
        layout.breakpoints.windows(2).map(|pair| effort(robot, pair[0], pair[1])).collect();
    let mut parts = vec![1_usize; effort.len()];
    let error = |i: usize, parts: usize| parts as f64 * (effort[i] / parts as f64).powi(7);
    // The bits of numbers that are not negative have their order.
    let rank = |i: usize, parts: usize| (error(i, parts).to_bits(), i);
    let mut intervals: BinaryHeap<_> = (0..effort.len()).map(|i| rank(i, 1)).collect();
    for _ in effort.len()..steps {
        let Some(mut worst) = intervals.peek_mut() else { break };
        let (_, i) = *worst;
        parts[i] += 1;
        *worst = rank(i, parts[i]);
    }
    parts
}

/// A step may twist by this much in the unloaded rod, in rad: the bending stiffness about fixed axes changes
/// with twice the angle.
const TWIST_OF_STEP: f64 = 0.4;
/// Places at which the rest twist is looked up, and the most steps that it asks for.
const PLACES: usize = 64;
const MOST_STEPS: f64 = 512.0;

/// So many steps follow the twist of the unloaded rod.
pub(crate) fn steps_for_twist(robot: &Robot) -> usize {
    let backbone = robot.backbone();
    let at = |k: usize| backbone.length * (k as f64 + 0.5) / PLACES as f64;
    let rate = |k: usize| backbone.rest_curvature_at(robot.disks(), at(k)).z.abs();
    let twist = (0..PLACES).map(rate).sum::<f64>() * backbone.length / PLACES as f64;
    (twist / TWIST_OF_STEP).ceil().min(MOST_STEPS) as usize
}

/// How much happens between two places, as an angle in rad: a bend that goes evenly with the
/// length, how far the cables wind round the backbone, and how much their slant changes. The
/// weights were fitted to the errors of the sections of the paper's robots.
fn effort(robot: &Robot, from: f64, to: f64) -> f64 {
    const BEND: f64 = 1.5;
    const WINDING: f64 = 0.3;
    let (h, middle) = (to - from, 0.5 * (from + to));
    let of_route = |route: &Route| {
        let [a, b] = [from, to].map(|s| route.at(s));
        let radius = a.offset.norm().max(b.offset.norm()).max(1e-9);
        // Slope along and across the offset: constant on a helix.
        let slant = |p: &RoutePoint| {
            let radial = p.offset / p.offset.norm().max(1e-9);
            Vec3::new(p.slope.dot(radial), p.slope.cross(radial).z, 0.0)
        };
        let winding = a.slope.norm().max(b.slope.norm());
        let change = (slant(&b) - slant(&a)).norm();
        h / radius * (WINDING * winding + change)
    };
    let reaching = robot.routes().iter().filter(|route| route.end() > middle);
    BEND * h / robot.backbone().length + reaching.map(of_route).fold(0.0, f64::max)
}

/// The sections of a backbone; one that is the same everywhere is looked up once.
struct Sections<'a> {
    robot: &'a Robot,
    uniform: Option<Section>,
    density: Option<f64>,
}

impl<'a> Sections<'a> {
    fn of(robot: &'a Robot) -> Result<Self, SolveError> {
        let backbone = robot.backbone();
        let is_uniform = backbone.is_uniform();
        let is_even = is_uniform && backbone.linear_density.as_ref().is_none_or(Along::is_uniform);
        let middle = 0.5 * backbone.length;
        let uniform = is_uniform.then(|| section_at(robot, middle, middle)).transpose()?;
        Ok(Self { robot, uniform, density: is_even.then(|| linear_density(robot, middle)) })
    }

    /// At one end or inside of a piece in which nothing jumps; `inside` lies between its ends.
    fn at(&self, s: f64, inside: f64) -> Result<Section, SolveError> {
        self.uniform.clone().map_or_else(|| section_at(self.robot, s, inside), Ok)
    }

    /// Mass of a piece of backbone; exact for a linear taper.
    fn mass_between(&self, from: f64, to: f64) -> f64 {
        let density = |s| self.density.unwrap_or_else(|| linear_density(self.robot, s));
        let at = |i: usize| density(from + GAUSS_3.nodes[i] * (to - from));
        (to - from) * (0..3).map(|i| GAUSS_3.weights[i] * at(i)).sum::<f64>()
    }
}

/// Without a density a backbone has no weight.
fn linear_density(robot: &Robot, s: f64) -> f64 {
    robot.backbone().linear_density_at(robot.disks(), s).unwrap_or(0.0)
}

/// Mass beyond the end of each step; the disk at that end is counted.
fn distal_masses(sections: &Sections<'_>, steps: &[Step], disk_masses: &[f64]) -> Vec<f64> {
    let mut masses = vec![0.0; steps.len()];
    let mut mass = 0.0;
    for (k, step) in steps.iter().enumerate().rev() {
        mass += disk_masses[k + 1];
        masses[k] = mass;
        mass += sections.mass_between(step.start, step.start + step.length);
    }
    masses
}

fn nodes(
    sections: &Sections<'_>,
    layout: &Layout,
    steps: &[Step],
    masses: &[f64],
    places: &[f64],
    weights: &[f64],
) -> Result<Nodes, SolveError> {
    let cables = layout.order.len();
    let mut out = Nodes {
        per_step: places.len(),
        cables,
        nodes: Vec::with_capacity(steps.len() * places.len()),
        crossings: vec![Crossing::default(); steps.len() * places.len() * cables],
        groups: Vec::new(),
        rest_excess: layout.rest_lengths.iter().map(|length| -length).collect(),
        one_cable: OneCableTable::default(),
        repeats: Vec::new(),
        runs: Arc::default(),
    };
    let mut next = 0;
    for (k, step) in steps.iter().enumerate() {
        let end = step.start + step.length;
        for (&c, weight) in places.iter().zip(weights) {
            let s = step.start + c * step.length;
            let section = sections.at(s, step.start + 0.5 * step.length)?;
            let distal_mass = masses[k] + sections.mass_between(s, end);
            for i in 0..step.active {
                let point = sections.robot.routes()[layout.order[i]].at(s);
                let crossing = Crossing::new(point.offset, point.slope);
                let stretch = crossing.tangent(&section.rest_strain()).norm();
                out.rest_excess[i] += weight * step.length * stretch;
                out.crossings[next + i] = crossing;
            }
            out.nodes.push(Node { section, distal_mass });
            next += cables;
        }
    }
    out.groups = out.crossings.chunks(cables.max(1)).flat_map(CableGroup::of).collect();
    Ok(out)
}
