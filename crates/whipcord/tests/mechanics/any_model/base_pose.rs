//! Where the base is and how it is turned there, for every model.

use crate::common::{fine_options, model_with_forces, paper_robot, straight};
use whipcord::case::Piece;
use whipcord::{
    Actuation, Backbone, Case, DistributedLoad, LoadFrame, Loads, Material, Model, ModelKind,
    PointLoad, PointMass, Pose, Profile, Robot, RobotError, Shape, Shortening, Solution,
    SolveError, Statics, Stations, UnitQuaternion, Vec3,
};

fn robot() -> Robot {
    let bare = paper_robot(vec![straight(0.0), straight(120.0)]);
    let material = Material { density: Some(1040.0), ..bare.backbone().material };
    let backbone = Backbone { material, ..bare.backbone().clone() };
    Robot::new(backbone, bare.disks().clone(), bare.cables().to_vec()).unwrap()
}

fn base() -> Pose {
    Pose {
        position: Vec3::new(0.3, -1.2, 0.7),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, 2.1, -0.8)),
    }
}

/// One of every kind.
fn loads(frame: LoadFrame) -> Loads {
    let profile = Profile::Linear {
        at: vec![0.03, 0.15],
        force: vec![Vec3::X, Vec3::new(0.0, 2.0, -1.0)],
        moment: vec![Vec3::new(0.02, 0.0, 0.1), Vec3::Y * 0.05],
    };
    let point = PointLoad {
        at: 0.1,
        force: Vec3::new(0.1, 0.0, -0.2),
        moment: Vec3::new(0.0, 1e-3, 2e-3),
        follower: false,
    };
    Loads {
        frame,
        gravity: Some(Vec3::new(1.0, -2.0, -9.0)),
        tip_force: Vec3::new(0.05, 0.1, 0.0),
        tip_moment: Vec3::new(1e-3, 0.0, -2e-3),
        points: vec![point, PointLoad { at: 0.05, follower: true, ..point }],
        distributed: vec![
            DistributedLoad { profile: profile.clone(), follower: false },
            DistributedLoad { profile, follower: true },
        ],
        masses: vec![PointMass { at: 0.14, mass: 0.01 }],
        ..Loads::default()
    }
}

/// The same physical loads in a frame that is turned by `turn` in the one they are given in.
fn seen_from(turn: UnitQuaternion, loads: &Loads) -> Loads {
    let seen = |v: Vec3| turn.conjugate().rotate(v);
    let point = |p: &PointLoad| match p.follower {
        true => *p,
        false => PointLoad { force: seen(p.force), moment: seen(p.moment), ..*p },
    };
    let spread = |load: &DistributedLoad| {
        if load.follower {
            return load.clone();
        }
        let pieces: Vec<Piece> = load.profile.pieces().collect();
        let knots = |of: fn(&Piece) -> [Vec3; 2]| {
            let starts = pieces.iter().map(|p| seen(of(p)[0]));
            starts.chain(pieces.last().map(|p| seen(of(p)[1]))).collect()
        };
        let profile = Profile::Linear {
            at: load.profile.knots().collect(),
            force: knots(|p| p.force),
            moment: knots(|p| p.moment),
        };
        DistributedLoad { profile, ..*load }
    };
    Loads {
        frame: loads.frame,
        gravity: loads.gravity.map(seen),
        tip_force: seen(loads.tip_force),
        tip_moment: seen(loads.tip_moment),
        tip_follower: loads.tip_follower,
        points: loads.points.iter().map(point).collect(),
        distributed: loads.distributed.iter().map(spread).collect(),
        masses: loads.masses.clone(),
    }
}

/// Greatest distance in m between a shape and what it is when its base is moved, and difference
/// between the rotation matrices.
fn apart(base: Pose, shape: &Shape, moved: &Shape) -> f64 {
    assert_eq!(shape.arc_length, moved.arc_length);
    let of_pose = |(a, b): (&Pose, &Pose)| {
        let expected = base.position + base.rotation.to_matrix() * a.position;
        let turned = base.rotation.to_matrix() * a.rotation.to_matrix();
        let turn = turned - b.rotation.to_matrix();
        turn.rows.iter().map(|r| r.max_abs()).fold((expected - b.position).norm(), f64::max)
    };
    shape.poses.iter().zip(&moved.poses).map(of_pose).fold(0.0, f64::max)
}

fn cosserat(case: &Case) -> Solution {
    Model::Cosserat(fine_options()).solve(&robot(), case).unwrap()
}

/// What turns with the base leaves nothing else changed: to the last bit where no frame is turned.
#[test]
fn the_answer_moves_with_the_base() {
    let fixed = Case { loads: loads(LoadFrame::Base), ..Case::with_tensions(&[2.0, 1.0]) };
    let on_wall = Case { base: base(), ..fixed.clone() };
    let (a, b) = (cosserat(&fixed), cosserat(&on_wall));
    assert!(apart(base(), &a.shape, &b.shape) < 2e-15);
    assert!(apart(base(), &a.disks, &b.disks) < 2e-15);
    assert_eq!(a.cables, b.cables);
    assert_eq!(a.base_wrench, b.base_wrench);
    assert_eq!(a.diagnostics, b.diagnostics);
    // The sign of the quaternions is that of the base, all along.
    for pair in b.shape.poses.windows(2) {
        let [p, q] = [pair[0].rotation.wxyz(), pair[1].rotation.wxyz()];
        assert!(p.iter().zip(&q).map(|(x, y)| x * y).sum::<f64>() > 0.0);
    }
    assert_eq!(b.disks.poses[0].position, base().position);
}

#[test]
fn models_without_loads_move_with_the_base() {
    let lengths = Case::with_shortenings(&[Shortening::Fraction(0.05), Shortening::Fraction(0.0)]);
    let on_wall = Case { base: base(), ..lengths.clone() };
    let kinds = [ModelKind::FourBar, ModelKind::ConstantCurvature];
    let stations = [Stations::Disks, Stations::Equal(30)];
    for (kind, stations) in kinds.into_iter().flat_map(|kind| stations.clone().map(|s| (kind, s))) {
        let model = Model::new(kind, stations, Actuation::Natural);
        let [a, b] = [&lengths, &on_wall].map(|case| model.solve(&robot(), case).unwrap());
        assert!(apart(base(), &a.shape, &b.shape) < 2e-15);
        assert!(apart(base(), &a.disks, &b.disks) < 2e-15);
        assert_eq!(a.cables, b.cables);
    }
}

/// Loads of the world on a base that is turned are the same loads, seen from it.
#[test]
fn loads_of_the_world_are_turned_into_the_base() {
    let in_world = loads(LoadFrame::World);
    let seen = Loads { frame: LoadFrame::Base, ..seen_from(base().rotation, &in_world) };
    let case = |loads| Case { loads, base: base(), ..Case::with_tensions(&[2.0, 1.0]) };
    let (a, b) = (cosserat(&case(in_world.clone())), cosserat(&case(seen)));
    assert!(apart(Pose::IDENTITY, &a.shape, &b.shape) < 1e-13);
    let (f, g) = (a.base_wrench.unwrap(), b.base_wrench.unwrap());
    assert!((f.force - g.force).norm() < 1e-13 && (f.moment - g.moment).norm() < 1e-13);
    // On a base that is not turned both frames are one.
    let upright = Case { loads: in_world, ..Case::with_tensions(&[2.0, 1.0]) };
    let base_frame = Case { loads: loads(LoadFrame::Base), ..upright.clone() };
    assert_eq!(cosserat(&upright), cosserat(&base_frame));
}

/// Both for the models that take loads at their disks.
#[test]
fn sections_and_their_loads_turn_with_the_base() {
    let at_disks = |frame| {
        let mut loads = loads(frame);
        loads.points[1].at = 0.06;
        loads
    };
    for kind in
        [ModelKind::PiecewiseConstantCurvature, ModelKind::PseudoRigidBody, ModelKind::FourBar]
    {
        let model = model_with_forces(kind, Stations::Equal(30), Actuation::Natural);
        let solve = |case: &Case| model.solve(&robot(), case).unwrap();
        let fixed = Case { loads: at_disks(LoadFrame::Base), ..Case::with_tensions(&[2.0, 1.0]) };
        let on_wall = Case { base: base(), ..fixed.clone() };
        let (a, b) = (solve(&fixed), solve(&on_wall));
        assert!(apart(base(), &a.shape, &b.shape) < 2e-15);
        assert!(apart(base(), &a.disks, &b.disks) < 2e-15);
        assert_eq!((a.cables, a.base_wrench), (b.cables, b.base_wrench));
        let in_world = at_disks(LoadFrame::World);
        let seen = Loads { frame: LoadFrame::Base, ..seen_from(base().rotation, &in_world) };
        let case = |loads| Case { loads, ..on_wall.clone() };
        let (a, b) = (solve(&case(in_world)), solve(&case(seen)));
        assert!(apart(Pose::IDENTITY, &a.shape, &b.shape) < 1e-12);
    }
}

/// A rod that stands out of a wall along the world's x sags under gravity along −z, as much as an
/// upright one bends under gravity across it: `q L⁴/8EI + q L²/2GA`.
#[test]
fn a_rod_out_of_a_wall_sags() {
    let out_of_wall = UnitQuaternion::exp(Vec3::Y * core::f64::consts::FRAC_PI_2);
    let base = Pose { position: Vec3::Z, rotation: out_of_wall };
    let rod = Robot::new(robot().backbone().clone(), robot().disks().clone(), vec![]).unwrap();
    let sag = |g: f64| {
        let loads =
            Loads { frame: LoadFrame::World, gravity: Some(Vec3::Z * -g), ..Loads::default() };
        let case = Case { loads, base, ..Case::default() };
        let tip = Model::Cosserat(fine_options()).solve(&rod, &case).unwrap().disks.tip();
        assert!((tip.position.x - 0.18).abs() < 1e-5 && tip.position.y.abs() < 1e-12);
        // The cross-section's z axis is the tangent.
        assert!(tip.rotation.rotate(Vec3::Z).x > 0.999);
        (1.0 - tip.position.z) / g
    };
    let section = rod.backbone().section_at(rod.disks(), 0.0).unwrap();
    let material = &rod.backbone().material;
    let weight = 1040.0 * section.area;
    let exact = weight * 0.18_f64.powi(4) / (8.0 * 1.1e9 * section.second_moment_x)
        + weight * 0.18_f64.powi(2) / (2.0 * material.shear_modulus().unwrap() * section.area);
    // The square of the load is eliminated; what is left is the rounding of a metre of height.
    let linear = (4.0 * sag(1.0) - sag(2.0)) / 3.0;
    assert!((linear / exact - 1.0).abs() < 1e-8, "{linear} {exact}");
}

#[test]
fn a_base_that_is_no_pose_is_refused() {
    let quaternion = |w| UnitQuaternion { w, v: Vec3::ZERO };
    let nan = Vec3::new(0.0, f64::NAN, 0.0);
    for (base, path) in [
        (Pose { rotation: quaternion(2.0), ..Pose::IDENTITY }, "base.orientation"),
        (Pose { rotation: quaternion(f64::NAN), ..Pose::IDENTITY }, "base.orientation"),
        (Pose { position: nan, ..Pose::IDENTITY }, "base.position[1]"),
        (Pose { position: Vec3::X * 1e7, ..Pose::IDENTITY }, "base.position[0]"),
    ] {
        for kind in ModelKind::ALL {
            let mut case = Case::with_tensions(&[1.0, 1.0]);
            case.commands.iter_mut().for_each(|c| c.shortening = Some(Shortening::Length(0.0)));
            case.base = base;
            let model = Model::new(kind, Stations::Disks, Actuation::Natural);
            match model.solve(&robot(), &case) {
                Err(SolveError::Invalid(RobotError { path: found, .. })) => assert_eq!(found, path),
                other => panic!("{other:?}"),
            }
        }
    }
}
