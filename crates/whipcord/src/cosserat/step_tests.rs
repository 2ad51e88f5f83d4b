//! Steps in lanes against steps one by one.

use whipcord_numerics::{UnitQuaternion, Vec3};

use super::chain::{Chain, Step, Task};
use super::gap::Gap;
use super::loaded::Trajectory;
use super::state::Node;
use super::target::Target;
use crate::budget::Meter;
use crate::section::Strain;
use crate::section::step_tolerance;
use crate::statics::command::Command;
use crate::statics::grid::Layout;
use crate::statics::grid::{Grid, SHOOTING_NODES};
use crate::statics::loads::AppliedLoads;
use crate::statics::scales::Scales;
use crate::{
    Along, Backbone, Cable, Disks, DistributedLoad, Loads, Material, PointLoad, Profile, Robot,
    Routing, Section as Bar,
};

/// With cables that end one before the other.
fn robot(cables: usize) -> Robot {
    let material =
        Material { young_modulus: Some(1e9), poisson_ratio: Some(0.3), ..Material::default() };
    let outer = Along::At { arc_lengths: vec![0.0, 0.18], values: vec![0.003, 0.002] };
    let section = Bar::Round { outer, inner: Along::Uniform(0.0) };
    let backbone = Backbone { material, section: Some(section), ..Backbone::new(0.18) };
    let disks = Disks::equally_spaced(0.18, 10, 0.008);
    let cable = |i: usize| {
        let start_angle = 2.0 * i as f64;
        let routing = Routing::Helix { start_angle, turns: 0.4, radius: 0.008 };
        let ends_at = Some(0.18 - 0.04 * i as f64);
        Cable { ends_at, ..Cable::new(format!("{i}"), routing) }
    };
    Robot::new(backbone, disks, (0..cables).map(cable).collect()).unwrap()
}

fn follower() -> Loads {
    let point = PointLoad {
        at: 0.12,
        force: Vec3::new(0.02, -0.01, 0.0),
        moment: Vec3::ZERO,
        follower: true,
    };
    let tip_force = Vec3::new(0.05, 0.0, 0.02);
    Loads { tip_force, points: vec![point], ..Loads::default() }
}

/// What steps are shot at that have nodes of their own: nothing is given at the base.
fn target(tensions: &[f64], per_node: usize, load: f64) -> Target<'_> {
    Target {
        tensions,
        per_node,
        base_moment: Vec3::ZERO,
        follower_force: Vec3::ZERO,
        load,
        sample: true,
        step_tolerance: step_tolerance(0.0),
    }
}

/// The loads on a grid of a base that is not turned.
fn gathered(grid: &Grid, loads: &Loads) -> AppliedLoads {
    let mut applied = AppliedLoads::default();
    applied.gather(grid, loads, UnitQuaternion::IDENTITY);
    applied
}

#[test]
fn steps_in_lanes_are_those_of_steps_one_by_one() {
    for (cables, per_node) in [(0, 0), (1, 0), (1, 1), (3, 0), (3, 3)] {
        for steps in [10, 19] {
            let (robot, loads) = (robot(cables), follower());
            let layout = Layout::new(&robot, Vec::new(), &loads);
            let grid = Grid::new(&robot, &layout, steps).unwrap();
            let applied = gathered(&grid, &loads);
            let nodes = SHOOTING_NODES.len() * grid.len();
            let along = |i: usize| [2.1, 1.2, 0.4][i % 3] * (1.0 - 1e-3 * i as f64);
            let tensions: Vec<f64> = match per_node {
                0 => [2.1, 1.2, 0.4][..cables].to_vec(),
                _ => (0..cables * nodes).map(along).collect(),
            };
            let turned = |k: usize| UnitQuaternion::exp(Vec3::new(0.1, 0.03, 0.0) * k as f64);
            let node = |k: usize| Node {
                rotation: turned(k),
                moment: Vec3::new(1e-3, 3e-3, 2e-4) * (k as f64).cos(),
                force: Vec3::new(0.0, 0.01, 0.01),
            };
            let nodes: Vec<Node> = (0..=grid.len()).map(node).collect();
            let target = target(&tensions, per_node, 0.7);
            let mut side_by_side = Trajectory::default();
            side_by_side.seed(&grid, &vec![AT_REST; 3 * grid.len()]);
            let mut one_by_one = side_by_side.clone();
            let (scales, mut gaps) = (Scales::of(&grid, 0.18), Vec::new());
            let at = (&grid, &scales);
            let greatest = side_by_side.shoot_steps(at, &applied, &target, &nodes, &mut gaps);
            side_by_side.sample_steps(&grid, &target).unwrap();
            let mut expected_greatest: f64 = 0.0;
            for (k, gap) in gaps.iter().enumerate() {
                let Node { rotation, moment, force } = nodes[k];
                let target = Target { follower_force: force, ..target };
                let moment = rotation.rotate(moment);
                let (pose, cut) =
                    one_by_one.shoot_step(&grid, &applied, &target, k, rotation, moment).unwrap();
                let next = &nodes[k + 1];
                let expected = Gap::of((&applied, target.load), k, pose, cut, next);
                assert!((gap.end.position - pose.position).max_abs() < 1e-14);
                let [change, other] = [gap.change, expected.change];
                assert!((change.turn - other.turn).max_abs() < 1e-12, "{cables} {k}");
                assert!((change.moment - other.moment).max_abs() < 1e-14);
                assert!((change.force - other.force).max_abs() < 1e-14);
                expected_greatest = expected_greatest.max(expected.size(next, &scales));
            }
            assert!((greatest.unwrap() - expected_greatest).abs() < 1e-11 * expected_greatest);
            let strains = side_by_side.strains().iter().zip(one_by_one.strains());
            for (a, b) in strains {
                assert!((a.linear - b.linear).max_abs() < 1e-12);
                assert!((a.angular - b.angular).max_abs() < 1e-9);
            }
            for (a, b) in side_by_side.samples.iter().zip(&one_by_one.samples) {
                assert!((a.wrench.linear - b.wrench.linear).max_abs() < 1e-13);
                assert!((a.wrench.angular - b.wrench.angular).max_abs() < 1e-13);
                let [p, q] = [a, b].map(|of| of.tangent.compliance()[2]);
                assert!((0..3).all(|i| (p.rows[i] - q.rows[i]).max_abs() < 1e-6));
            }
        }
    }
}

#[test]
fn a_node_that_is_not_a_number_leaves_no_closed_gap() {
    let (robot, loads) = (robot(1), Loads::default());
    let grid = Grid::new(&robot, &Layout::new(&robot, Vec::new(), &loads), 10).unwrap();
    let applied = gathered(&grid, &loads);
    let target = target(&[1.0], 0, 1.0);
    let (scales, mut gaps) = (Scales::of(&grid, 0.18), Vec::new());
    for broken in [f64::NAN, f64::INFINITY] {
        for (force, moment) in [(Vec3::X * broken, Vec3::ZERO), (Vec3::ZERO, Vec3::X * broken)] {
            let mut nodes = vec![Node::default(); grid.len() + 1];
            (nodes[4].force, nodes[4].moment) = (force, moment);
            let mut trajectory = Trajectory::default();
            trajectory.seed(&grid, &vec![AT_REST; 3 * grid.len()]);
            let at = (&grid, &scales);
            let greatest = trajectory.shoot_steps(at, &applied, &target, &nodes, &mut gaps);
            assert!(greatest.is_none_or(f64::is_infinite), "{greatest:?}");
        }
    }
}

/// The step from the base is that of the elimination, but for the order of the rule that carries its columns.
#[test]
fn the_step_from_the_base_is_that_of_the_elimination() {
    let tip_moment = Vec3::new(2e-4, 1e-4, -1e-4);
    let tip_force = Vec3::new(0.05, 0.0, 0.02);
    let loads = Loads { tip_force, tip_moment, ..Loads::default() };
    let (tensions, meter) = ([2.1, 1.2, 0.4], Meter::default());
    let apart = |steps: usize, cables: usize| {
        let robot = robot(cables);
        let layout = Layout::new(&robot, Vec::new(), &loads);
        let grid = Grid::new(&robot, &layout, steps).unwrap();
        let applied = gathered(&grid, &loads);
        let commands: Vec<_> = tensions[..cables].iter().map(|&t| Command::Tension(t)).collect();
        let task = Task {
            grid: &grid,
            loads: &applied,
            commands: &commands,
            length: 0.18,
            tolerance: 1e-9,
            meter: &meter,
        };
        let bent = |k: usize| {
            let s = k as f64 / grid.len() as f64;
            let rotation = UnitQuaternion::exp(Vec3::new(0.4, 0.2, 0.1) * s);
            Node { rotation, moment: Vec3::new(2e-3, 4e-3, 1e-4) * (1.0 - s), ..Node::default() }
        };
        let mut chain = Chain::default();
        chain.state.nodes = (0..=grid.len()).map(bent).collect();
        chain.state.nodes[grid.len()].moment = Vec3::ZERO;
        (chain.state.tensions, chain.state.load) = (tensions[..cables].to_vec(), 1.0);
        let mut trajectory = Trajectory { steps_left: usize::MAX, ..Trajectory::default() };
        trajectory.seed(&grid, &vec![AT_REST; 3 * grid.len()]);
        chain.shoot(&task, &mut trajectory).unwrap();
        assert!(chain.solve_step(&task, Step::Close, &trajectory));
        let expected = chain.step.nodes.clone();
        assert!(chain.solve_from_base(&task, &trajectory.in_lanes, true));
        let greatest = |of: &dyn Fn(usize) -> [f64; 2]| {
            (0..=grid.len()).map(of).fold([0.0_f64; 2], |[a, b], [c, d]| [a.max(c), b.max(d)])
        };
        let found = &chain.step.nodes;
        let [turn, moment] = greatest(&|k| [expected[k].turn.norm(), expected[k].moment.norm()]);
        let [turn_off, moment_off] = greatest(&|k| {
            let (a, b) = (&found[k], &expected[k]);
            [(a.turn - b.turn).norm(), (a.moment - b.moment).norm()]
        });
        (turn_off / turn).max(moment_off / moment)
    };
    for cables in [0, 1, 3] {
        let [coarse, fine] = [40, 80].map(|steps| apart(steps, cables));
        assert!(coarse < 2e-3, "{cables}: {coarse:.1e}");
        assert!(fine < 0.35 * coarse, "{cables}: {fine:.1e} of {coarse:.1e}");
    }
}

const AT_REST: Strain = Strain { linear: Vec3::Z, angular: Vec3::ZERO };

#[test]
fn steps_that_lanes_do_not_take_are_left_to_others() {
    let robot = robot(1);
    let (force, moment) = (Vec3::X, Vec3::X * 1e-3);
    let profile = Profile::Constant { from: 0.0, to: 0.18, force, moment };
    let line = DistributedLoad { profile, follower: false };
    let loads = Loads { distributed: vec![line], ..Loads::default() };
    let layout = Layout::new(&robot, Vec::new(), &loads);
    let grid = Grid::new(&robot, &layout, 10).unwrap();
    let applied = gathered(&grid, &loads);
    let target = target(&[1.0], 0, 1.0);
    let nodes = vec![Node::default(); grid.len() + 1];
    let (scales, mut gaps) = (Scales::of(&grid, 0.18), Vec::new());
    let at = (&grid, &scales);
    let mut trajectory = Trajectory::default();
    assert_eq!(trajectory.shoot_steps(at, &applied, &target, &nodes, &mut gaps), None);
    trajectory.seed(&grid, &vec![AT_REST; 3 * grid.len()]);
    assert_eq!(trajectory.shoot_steps(at, &applied, &target, &nodes, &mut gaps), None);
}
