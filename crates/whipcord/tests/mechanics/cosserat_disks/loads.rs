//! Every kind of load on the model with cables straight from hole to hole: without cables it is the
//! rod of the other model, with many disks it tends to that model, and closed forms hold.

use crate::common;
use crate::common::ACCURATE;
use crate::common::{helix, paper_backbone, straight};
use whipcord::{
    Backbone, Cable, Case, Disks, DistributedLoad, Loads, Material, Model, ModelKind, PointLoad,
    PointMass, Pose, Profile, Robot, Routing, Solution, Statics as _, UnitQuaternion, Vec3,
};

const LENGTH: f64 = 0.18;

fn solve(kind: ModelKind, robot: &Robot, case: &Case) -> Solution {
    let model = Model::new(kind, Default::default(), Default::default()).with_tolerance(ACCURATE);
    model.solve(robot, case).unwrap_or_else(|error| panic!("{error}\n{case:?}"))
}

fn heavy() -> Backbone {
    let mut backbone = paper_backbone();
    backbone.material = Material { density: Some(1040.0), ..backbone.material };
    backbone
}

fn robot(backbone: Backbone, sections: usize, routings: &[Routing]) -> Robot {
    let disks = Disks::equally_spaced(LENGTH, sections + 1, 0.008);
    let cable = |(i, routing): (usize, &Routing)| Cable::new(format!("c{i}"), routing.clone());
    Robot::new(backbone, disks, routings.iter().enumerate().map(cable).collect()).unwrap()
}

fn constant(from: f64, to: f64, force: Vec3, moment: Vec3) -> DistributedLoad {
    let profile = Profile::Constant { from, to, force, moment };
    DistributedLoad { profile, follower: false }
}

fn growing() -> DistributedLoad {
    let profile = Profile::Linear {
        at: vec![0.01, 0.09, 0.17],
        force: vec![Vec3::ZERO, Vec3::new(0.5, -1.0, 0.3), Vec3::new(-1.0, 0.2, 0.4)],
        moment: vec![Vec3::new(0.02, 0.0, 0.01), Vec3::ZERO, Vec3::new(-0.01, 0.03, 0.02)],
    };
    DistributedLoad { profile, follower: false }
}

fn every_kind() -> Vec<(&'static str, Loads)> {
    let force = Vec3::new(0.06, -0.09, 0.05);
    let moment = Vec3::new(3e-3, 2e-3, -4e-3);
    let point = |follower| PointLoad { at: 0.07, force, moment, follower };
    let tip = |tip_follower| Loads {
        tip_force: force,
        tip_moment: moment,
        tip_follower,
        ..Loads::default()
    };
    let spread = |load: DistributedLoad| Loads { distributed: vec![load], ..Loads::default() };
    let pressed = constant(0.03, 0.13, Vec3::new(1.0, 0.5, -0.4), Vec3::ZERO);
    let twisted = constant(0.03, 0.13, Vec3::ZERO, Vec3::new(0.05, -0.03, 0.06));
    let weight = Some(Vec3::new(3.0, 2.0, -9.0));
    let mass = PointMass { at: 0.11, mass: 0.005 };
    vec![
        ("weight", Loads { gravity: weight, masses: vec![mass], ..Loads::default() }),
        ("tip", tip(false)),
        ("tip, following", tip(true)),
        ("point", Loads { points: vec![point(false)], ..Loads::default() }),
        ("point, following", Loads { points: vec![point(true)], ..Loads::default() }),
        ("force", spread(pressed.clone())),
        ("force, following", spread(pressed.clone().following())),
        ("moment", spread(twisted.clone())),
        ("moment, following", spread(twisted.clone().following())),
        ("linear", spread(growing())),
        ("linear, following", spread(growing().following())),
        (
            "all at once",
            Loads {
                gravity: weight,
                masses: vec![mass],
                points: vec![point(true), point(false)],
                distributed: vec![pressed, twisted.following(), growing().following(), growing()],
                ..tip(true)
            },
        ),
    ]
}

fn farthest(a: &Solution, b: &Solution) -> f64 {
    a.disks.distances(&b.disks).fold(0.0, f64::max)
}

/// The base is turned, so that what belongs to which frame counts.
fn turned(loads: Loads, tensions: &[f64]) -> Case {
    let rotation = UnitQuaternion::exp(Vec3::new(0.3, -0.8, 0.5));
    let base = Pose { position: Vec3::new(0.1, 0.2, -0.1), rotation };
    Case { loads, base, ..Case::with_tensions(tensions) }
}

#[test]
fn without_cables_it_is_the_rod_of_the_other_model() {
    let bare = robot(heavy(), 4, &[]);
    let rest = solve(ModelKind::Cosserat, &bare, &turned(Loads::default(), &[]));
    for (name, loads) in every_kind() {
        let case = turned(loads, &[]);
        let [ours, theirs] =
            [ModelKind::CosseratDisks, ModelKind::Cosserat].map(|kind| solve(kind, &bare, &case));
        assert!(farthest(&theirs, &rest) > 1e-3, "{name} does next to nothing");
        let apart = farthest(&ours, &theirs);
        assert!(apart < 2e-9 * LENGTH, "{name}: {apart:e}");
        let (ours, theirs) = (ours.base_wrench.unwrap(), theirs.base_wrench.unwrap());
        assert!((ours.force - theirs.force).norm() < 1e-8, "{name}: {ours:?} {theirs:?}");
        assert!((ours.moment - theirs.moment).norm() < 1e-9, "{name}: {ours:?} {theirs:?}");
    }
}

#[test]
fn under_every_load_it_tends_to_the_other_model_with_order_two() {
    let routings = [helix(20.0, 0.6), straight(200.0)];
    for (name, loads) in every_kind() {
        let case = turned(loads, &[2.0, 1.0]);
        let error = |sections: usize| {
            let robot = robot(heavy(), sections, &routings);
            let [ours, theirs] = [ModelKind::CosseratDisks, ModelKind::Cosserat]
                .map(|kind| solve(kind, &robot, &case).disks.tip().position);
            (ours - theirs).norm()
        };
        let (coarse, fine) = (error(12), error(24));
        assert!(coarse > 1e-5, "{name}: {coarse:e}");
        let order = (coarse / fine).log2();
        assert!((1.9..2.1).contains(&order), "{name}: {order}");
    }
}

/// A rod that neither stretches nor shears, under a dead moment `m` per length about y: `EI θ″ = −m`
/// with `θ′(L) = 0`, so that `θ = m (L s − s²/2)/EI`.
#[test]
fn a_spread_moment_bends_by_its_closed_form() {
    let rod = Backbone { shearable: false, extensible: false, ..paper_backbone() };
    let bare = robot(rod, 3, &[]);
    let stiffness = common::bending_stiffness(&bare);
    for bend in [0.3, 1.5, 3.0] {
        let density = 2.0 * bend * stiffness / (LENGTH * LENGTH);
        let load = constant(0.0, LENGTH, Vec3::ZERO, density * Vec3::Y);
        let loads = Loads { distributed: vec![load], ..Loads::default() };
        let tip = solve(ModelKind::CosseratDisks, &bare, &Case { loads, ..Case::default() });
        let tip = tip.disks.tip();
        assert!((tip.rotation.log() - bend * Vec3::Y).norm() < 1e-8, "{bend}: {tip:?}");
        let count = 2000;
        let mut end = Vec3::ZERO;
        for i in 0..=count {
            let s = f64::from(i) / f64::from(count);
            let simpson = if i == 0 || i == count { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            let angle = bend * (2.0 * s - s * s);
            end += (simpson * LENGTH / f64::from(3 * count))
                * Vec3::new(angle.sin(), 0.0, angle.cos());
        }
        assert!((tip.position - end).norm() < 1e-10, "{bend}: {tip:?} {end:?}");
    }
}

/// A pressure `w` on one side of a rod in the plane that does not stretch exerts `w (z, −x)` of the
/// tip on the base and the moment `w |p|²/2`, whatever the cables do to its shape.
#[test]
fn a_pressure_exerts_what_it_would_on_the_chord() {
    let rod = Backbone { shearable: false, extensible: false, ..paper_backbone() };
    let pulled = robot(rod, 5, &[straight(0.0), straight(180.0)]);
    for (pressure, tensions) in [(1.0, [0.0, 0.0]), (-2.0, [3.0, 0.5]), (1.5, [0.2, 4.0])] {
        let load = constant(0.0, LENGTH, pressure * Vec3::X, Vec3::ZERO).following();
        let loads = Loads { distributed: vec![load], ..Loads::default() };
        let case = Case { loads, ..Case::with_tensions(&tensions) };
        let solution = solve(ModelKind::CosseratDisks, &pulled, &case);
        let p = solution.disks.tip().position;
        let base = solution.base_wrench.unwrap();
        assert!((base.force - pressure * Vec3::new(p.z, 0.0, -p.x)).norm() < 1e-9, "{base:?}");
        let moment = 0.5 * pressure * p.norm_squared() * Vec3::Y;
        assert!((base.moment - moment).norm() < 1e-10, "{base:?} {moment:?}");
    }
}
