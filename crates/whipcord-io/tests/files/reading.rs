//! What files say is what is read.
use std::path::Path;

use whipcord::robot::BendingFriction;
use whipcord::{
    Actuation, Along, CableCommand, DistributedLoad, Interpolation, LoadFrame, Model, ModelKind,
    PointLoad, PointMass, Pose, Profile, RestCurvature, Robot, Routing, Section, Shortening,
    Statics as _, Stations, Stiffness, UnitQuaternion, Vec3,
};
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_io::{CaseFile, MeasuredDisk, load, parse};

use crate::common::folder;

fn read(text: &str) -> CaseFile {
    parse(text, "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_whole_contract() {
    let file = read(
        r#"
title = "Case III"

[backbone]
length = "180 mm"
diameter = "3 mm"
young_modulus = "1.1 GPa"
poisson_ratio = 0.3
density = "1040 kg/m^3"
rest_curvature = ["0 1/m", "4 1/m", "0 1/m"]

[disks]
count = 10
hole_circle_radius = "8 mm"
holes = 12
mass = "1.2 g"

[[cables]]
name = "pull"
holes = [1, 2, 3, 4, 4, 4, 4, 3, 2, 1]
tension = "400 gf"
shortening = "5.7 %"
interpolation = "pchip"
ends_at = "170 mm"
friction = 0.1
axial_stiffness = "2 kN"

[[cables]]
routing = { kind = "straight", angle = "90 deg", radius = "8 mm" }

[[cables]]
routing = { kind = "helix", start_angle = "0 deg", turns = 0.75, radius = "8 mm" }
shortening = "-2 mm"

[[cables]]
routing = { kind = "linear", start = ["8 mm", "0 mm"], end = ["3 mm", "0 mm"] }

[[cables]]
routing = { kind = "polynomial", x = [0.008, 0.0], y = [0, 0.02] }

[loads]
gravity = ["0", "0", "-9.81 m/s^2"]
tip_force = ["0.05 N", "0 N", "0 N"]
tip_moment = ["0", "0", "1 mN*m"]
follower = true

[[loads.point]]
at = "90 mm"
force = ["0 N", "0.1 N", "0 N"]

[[loads.point]]
at = 0.1
moment = [0, 0, 1]
follower = true

[reference]
source = "Table 1"
time_cosserat = "10 ms"
"#,
    );
    assert_eq!(file.title, "Case III");
    let (robot, case) = (&file.robot, &file.case);
    let backbone = robot.backbone();
    assert_eq!(backbone.length, 0.18);
    assert_eq!(backbone.section, Some(Section::circle(0.003)));
    assert_eq!(backbone.material.young_modulus, Some(1.1e9));
    assert_eq!(backbone.material.poisson_ratio, Some(0.3));
    assert_eq!(backbone.material.shear_modulus, None);
    assert_eq!(backbone.material.density, Some(1040.0));
    assert_eq!(backbone.rest_curvature, RestCurvature::Uniform(Vec3::new(0.0, 4.0, 0.0)));
    assert_eq!(robot.disks().count(), 10);
    assert_eq!(robot.disks().hole_circle_radii, [0.008; 10]);
    assert_eq!(robot.disks().mass, 0.0012);

    let cables = robot.cables();
    let holes = vec![1, 2, 3, 4, 4, 4, 4, 3, 2, 1];
    assert_eq!(cables[0].name, "pull");
    assert_eq!(cables[0].routing, Routing::Holes { holes, interpolation: Interpolation::Pchip });
    assert_eq!(cables[0].ends_at, Some(0.17));
    assert_eq!(cables[0].friction, Some(0.1));
    assert_eq!(cables[0].axial_stiffness, Some(2000.0));
    assert_eq!(case.commands[0].tension, Some(0.4 * 9.80665));
    assert_eq!(case.commands[0].shortening, Some(Shortening::Fraction(0.057)));
    assert_eq!(cables[1].name, "cable-2");
    let quarter = core::f64::consts::FRAC_PI_2;
    assert_eq!(cables[1].routing, Routing::Straight { angle: quarter, radius: 0.008 });
    let helix = Routing::Helix { start_angle: 0.0, turns: 0.75, radius: 0.008 };
    assert_eq!(cables[2].routing, helix);
    assert_eq!(case.commands[2].shortening, Some(Shortening::Length(-0.002)));
    assert_eq!(cables[3].routing, Routing::Linear { start: [0.008, 0.0], end: [0.003, 0.0] });
    let polynomial = Routing::Polynomial { x: vec![0.008, 0.0], y: vec![0.0, 0.02] };
    assert_eq!(cables[4].routing, polynomial);

    let loads = &case.loads;
    assert_eq!(loads.gravity, Some(Vec3::new(0.0, 0.0, -9.81)));
    assert_eq!(loads.tip_force, Vec3::new(0.05, 0.0, 0.0));
    assert_eq!(loads.tip_moment, Vec3::new(0.0, 0.0, 0.001));
    assert!(loads.tip_follower);
    let force = PointLoad { at: 0.09, force: Vec3::new(0.0, 0.1, 0.0), ..Default::default() };
    let moment = PointLoad { at: 0.1, moment: Vec3::Z, follower: true, ..Default::default() };
    assert_eq!(loads.points, [force, moment]);
    assert_eq!(file.reference.unwrap().time_cosserat, Some(0.01));
}

#[test]
fn every_section_and_list() {
    let backbone = |lines: &str| {
        let text = format!("[disks]\ncount = 3\n[backbone]\nlength = 0.3\n{lines}\n");
        read(&text).robot.backbone().clone()
    };
    let tube = Section::tube(0.003, 0.002);
    assert_eq!(backbone("diameter = 3e-3\ninner_diameter = '2 mm'").section, Some(tube));
    let bar = Section::rectangle(0.006, 0.004);
    assert_eq!(backbone("section.width = 0.006\nsection.height = '4 mm'").section, Some(bar));
    let taper =
        Section::Round { outer: Along::PerDisk(vec![0.003, 0.002, 0.001]), inner: 0.0.into() };
    assert_eq!(backbone("diameters = ['3 mm', '2 mm', 0.001]").section, Some(taper));
    assert_eq!(backbone("shear_modulus = '4 GPa'").material.shear_modulus, Some(4e9));
    let funnel = Section::Round {
        outer: Along::At { arc_lengths: vec![0.1, 0.2], values: vec![0.004, 0.003] },
        inner: Along::PerDisk(vec![0.002, 0.0015, 0.001]),
    };
    let lines = "diameters = { at = ['10 cm', 0.2], values = ['4 mm', 0.003] }\ninner_diameter = ['2 mm', 0.0015, '1 mm']";
    assert_eq!(backbone(lines).section, Some(funnel));
    let wedge = Section::Rectangle {
        width: Along::Uniform(0.006),
        height: Along::At { arc_lengths: vec![0.0, 0.3], values: vec![0.004, 0.002] },
    };
    let lines = "section = { width = 0.006, height = ['4 mm', '2 mm'], at = [0, 0.3] }";
    assert_eq!(backbone(lines).section, Some(wedge));
    let curved = backbone("rest_curvature = [[0, 0, 0], ['1 1/m', 0, 0], [0, 0, '1 1/cm']]");
    let list = vec![Vec3::ZERO, Vec3::X, 100.0 * Vec3::Z];
    assert_eq!(curved.rest_curvature, RestCurvature::PerDisk(list));

    let curved = backbone(
        "rest_curvature = { at = [0.1, '10 cm'], values = [[0, 0, 0], [0, '1 1/cm', 0]] }",
    );
    let step = Along::At { arc_lengths: vec![0.1; 2], values: vec![Vec3::ZERO, 100.0 * Vec3::Y] };
    assert_eq!(curved.rest_curvature, step);
    let plain = backbone("");
    assert!(plain.extensible && plain.shearable && plain.shear_correction == 1.0);
    let beam = backbone("extensible = false\nshearable = false\nshear_correction = '90 %'");
    assert!(!beam.extensible && !beam.shearable && beam.shear_correction == 0.9);
    assert_eq!(plain.bending_friction, None);
    let rubbing = backbone("yield_moment = '10 mN*m'\nyield_stiffness = [0.04, '5e4 N*mm^2']");
    let friction = BendingFriction { yield_moment: [0.01; 2], yield_stiffness: Some([0.04, 0.05]) };
    assert_eq!(rubbing.bending_friction, Some(friction));
    let about_y = backbone("yield_moment = [0, '10 N*mm']").bending_friction;
    let friction = BendingFriction { yield_moment: [0.0, 0.01], yield_stiffness: None };
    assert_eq!(about_y, Some(friction));
    let heavy = backbone("linear_density = ['7 g/m', 0.006, '5 g/m']").linear_density;
    assert_eq!(heavy, Some(Along::PerDisk(vec![0.007, 0.006, 0.005])));

    let text = "[backbone]\nlength = '180 mm'\n[disks]\npositions = [0, '60 mm', '180 mm']\nhole_circle_radius = ['8 mm', '7 mm', '6 mm']\nholes = 6\n";
    let robot = read(text).robot;
    assert_eq!(robot.disks().arc_lengths, [0.0, 0.06, 0.18]);
    assert_eq!(robot.disks().hole_circle_radii, [0.008, 0.007, 0.006]);
    assert_eq!(read(text).title, "robot");
}

const BASE: &str = "title = 'base'\n[backbone]\nlength = 0.18\ndiameter = 0.003\ninner_diameter = 0.001\npoisson_ratio = 0.3\n[disks]\ncount = 3\nholes = 12\nhole_circle_radius = 0.008\n[[cables]]\nname = 'a'\nholes = [1, 1]\n[[cables]]\nname = 'b'\nholes = [2, 2]\n";

fn over_base(lines: &str) -> Robot {
    let folder = folder(&[
        ("base.toml", BASE),
        ("robot.toml", &format!("extends = 'base.toml'\n{lines}\n")),
    ]);
    load(folder.path().join("robot.toml")).unwrap_or_else(|error| panic!("{error}")).robot
}

#[test]
fn tables_are_laid_over_one_another() {
    let robot = over_base("[backbone]\nlength = 0.2\n[[cables]]\nname = 'c'\nholes = [3, 3]");
    assert_eq!(robot.backbone().length, 0.2);
    assert_eq!(robot.backbone().section, Some(Section::tube(0.003, 0.001)));
    assert_eq!(robot.disks().arc_lengths, [0.0, 0.1, 0.2]);
    let names: Vec<&str> = robot.cables().iter().map(|cable| cable.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c"]);
}

fn names(robot: &Robot) -> Vec<&str> {
    robot.cables().iter().map(|cable| cable.name.as_str()).collect()
}

fn holes(robot: &Robot, cable: usize) -> &[usize] {
    match &robot.cables()[cable].routing {
        Routing::Holes { holes, .. } => holes,
        other => panic!("{other:?}"),
    }
}

#[test]
fn cables_are_laid_over_those_of_the_same_name() {
    let robot = over_base("[[cables]]\nname = 'b'\nfriction = 0.1\nholes = [3, 3, 3]\n");
    assert_eq!(names(&robot), ["a", "b"]);
    assert_eq!((holes(&robot, 0), holes(&robot, 1)), (&[1, 1][..], &[3, 3, 3][..]));
    assert_eq!(robot.cables()[1].friction, Some(0.1));
    // A routing takes the place of holes, as rivals do everywhere.
    let curve = "routing = { kind = 'straight', angle = 0, radius = 0.008 }";
    let robot = over_base(&format!("[[cables]]\nname = 'a'\n{curve}\n"));
    assert!(matches!(robot.cables()[0].routing, Routing::Straight { .. }));
    assert_eq!(names(&robot), ["a", "b"]);
    // A routing of another kind takes the place of the other's, one without its kind changes it.
    let base = BASE.replace("holes = [1, 1]", curve);
    let turned = |lines: &str| {
        let folder = folder(&[
            ("base.toml", base.as_str()),
            ("robot.toml", &format!("extends = 'base.toml'\n[[cables]]\nname = 'a'\n{lines}\n")),
        ]);
        let robot = load(folder.path().join("robot.toml")).unwrap_or_else(|e| panic!("{e}")).robot;
        robot.cables()[0].routing.clone()
    };
    let straight = |radius| Routing::Straight { angle: 0.0, radius };
    assert_eq!(turned("routing = { radius = 0.007 }"), straight(0.007));
    assert_eq!(turned("routing.radius = 0.006"), straight(0.006));
    let helix = Routing::Helix { start_angle: 0.0, turns: 1.0, radius: 0.005 };
    assert_eq!(turned("routing = { kind = 'helix', turns = 1, radius = 0.005 }"), helix);
    // The order is that of the file below, new ones behind.
    let two = "[[cables]]\nname = 'new'\nholes = [5, 5]\n[[cables]]\nname = 'a'\nends_at = 0.05\n";
    let robot = over_base(two);
    assert_eq!(names(&robot), ["a", "b", "new"]);
    assert_eq!(robot.cables()[0].ends_at, Some(0.05));
    // Some or all of them are taken out.
    let without = over_base("[[cables]]\nname = 'a'\nremove = true\n");
    assert_eq!(names(&without), ["b"]);
    assert_eq!(over_base("cables = []").cables(), []);
    let folder = folder(&[("base.toml", BASE)]);
    let settings = ["cables.a.remove=true".to_owned()];
    let set = whipcord_io::load_with(folder.path().join("base.toml"), &settings).unwrap();
    assert_eq!(names(&set.robot), ["b"]);
    // An entry that is not to be removed is one like others.
    let kept = over_base("[[cables]]\nname = 'a'\nremove = false\n");
    assert_eq!(names(&kept), ["a", "b"]);
}

/// Each file changes what all those below it say together.
#[test]
fn cables_are_laid_over_one_another_along_a_chain() {
    let base =
        "[backbone]\nlength = 0.18\n[disks]\ncount = 3\nholes = 12\nhole_circle_radius = 0.008\n";
    let cables = "[[cables]]\nholes = [1, 1]\n[[cables]]\nholes = [2, 2]\n[[cables]]\nname = 'c'\nholes = [3, 3]\n";
    let chain = |middle: &str, top: &str| {
        let folder = folder(&[
            ("base.toml", format!("{base}{cables}")),
            ("middle.toml", format!("extends = 'base.toml'\n{middle}\n")),
            ("top.toml", format!("extends = 'middle.toml'\n{top}\n")),
        ]);
        load(folder.path().join("top.toml")).unwrap_or_else(|error| panic!("{error}")).robot
    };
    // Cables without a name keep the one that their place gave them.
    let first = "[[cables]]\nname = 'cable-1'\nremove = true";
    let robot = chain(first, "[[cables]]\nname = 'cable-2'\nfriction = 0.2");
    assert_eq!(names(&robot), ["cable-2", "c"]);
    assert_eq!((holes(&robot, 0), robot.cables()[0].friction), (&[2, 2][..], Some(0.2)));
    // One that was taken out is added anew.
    let robot = chain(first, "[[cables]]\nname = 'cable-1'\nholes = [7, 7]");
    assert_eq!(names(&robot), ["cable-2", "c", "cable-1"]);
    // All of them are replaced by way of a file that takes them out.
    let robot = chain("cables = []", "[[cables]]\nname = 'c'\nholes = [8, 8]");
    assert_eq!((names(&robot), holes(&robot, 0)), (vec!["c"], &[8, 8][..]));
}

#[test]
fn disks_of_another_file_are_removed() {
    let base =
        "[backbone]\nlength = 0.18\n[disks]\ncount = 3\nholes = 12\nhole_circle_radius = 0.008\n";
    let cable =
        "[[cables]]\nname = 'a'\nrouting = { kind = 'straight', angle = 0, radius = 0.006 }\n";
    let over = |middle: &str, top: &str| {
        let folder = folder(&[
            ("base.toml", format!("{base}{cable}")),
            ("middle.toml", format!("extends = 'base.toml'\n{middle}\n")),
            ("top.toml", format!("extends = 'middle.toml'\n{top}\n")),
        ]);
        load(folder.path().join("top.toml")).unwrap_or_else(|error| panic!("{error}")).robot
    };
    assert!(over("", "").has_disks());
    assert!(over("", "[disks]\nremove = false").has_disks());
    assert!(!over("", "[disks]\nremove = true").has_disks());
    assert!(!over("disks.remove = true", "").has_disks());
    // Others may follow, of which nothing is left of the first.
    let robot = over("[disks]\nremove = true", "[disks]\npositions = [0, 0.09, 0.12, 0.18]");
    assert_eq!((robot.disks().count(), robot.disks().holes), (4, None));
    let folder = folder(&[("base.toml", format!("{base}{cable}"))]);
    let settings = ["disks.remove=true".to_owned()];
    let set = whipcord_io::load_with(folder.path().join("base.toml"), &settings).unwrap();
    assert!(!set.robot.has_disks());
}

#[test]
fn a_body_without_disks_has_stations() {
    let text = "[backbone]\nlength = '100 mm'\ndiameter = '20 mm'\nmaterial = 'Dragon Skin 30'\n[[cables]]\nname = 'pull'\nrouting = { kind = 'straight', angle = 0, radius = '6 mm' }\ntension = '0.5 N'\n";
    let file = read(text);
    let disks = file.robot.disks();
    assert!(!file.robot.has_disks());
    assert_eq!((disks.count(), disks.arc_lengths.last()), (21, Some(&0.1)));
    // It takes the shape that it has with massless disks at the stations, and with fewer; one straight cable bends it by
    // u = τ r / EI.
    let solve = |text: &str| {
        let file = read(text);
        let model = Model::new(ModelKind::Cosserat, Stations::Disks, Actuation::Natural);
        model.solve(&file.robot, &file.case).unwrap().disks
    };
    let shape = solve(text);
    assert_eq!(solve(&format!("{text}[disks]\ncount = 21\n")), shape);
    let fewer = solve(&format!("{text}[disks]\ncount = 2\n")).tip();
    assert!((fewer.position - shape.tip().position).norm() < 1e-6 * 0.1);
    let stiffness = 593e3 * std::f64::consts::PI * 0.02_f64.powi(4) / 64.0;
    let bend = 0.5 * 0.006 * 0.1 / stiffness;
    assert!((shape.tip().rotation.log().norm() / bend - 1.0).abs() < 1e-6);
    // What is written has no disks either, and is read as the same.
    let table = whipcord_io::describe(None, &file.robot, &file.case).unwrap();
    assert_eq!(table.get("disks"), None);
    let again = read(&whipcord_io::toml(&table));
    assert_eq!(again.robot.disks(), disks);
    assert_eq!(again.robot.cables(), file.robot.cables());
}

#[test]
fn editors_of_every_system_may_write_it() {
    let windows = format!("\u{feff}{}", BASE.replace('\n', "\r\n"));
    assert_eq!(read(&windows).title, "base");
    let error = parse(&windows.replace("0.003", "'3'"), "robot.toml").unwrap_err();
    assert!(error.to_string().starts_with("robot.toml:4:12: error: "), "{error}");
    assert!(!error.to_string().contains('\r'));
}

#[test]
fn a_key_replaces_what_excludes_it() {
    let section = |lines: &str| over_base(lines).backbone().section.clone();
    let taper =
        Section::Round { outer: Along::PerDisk(vec![0.003, 0.002, 0.002]), inner: 0.001.into() };
    assert_eq!(section("backbone.diameters = [0.003, 0.002, 0.002]"), Some(taper));
    let bar = Section::rectangle(0.01, 0.02);
    assert_eq!(section("backbone.section = { width = 0.01, height = 0.02 }"), Some(bar));
    let robot = over_base("[disks]\npositions = [0, 0.01, 0.18]\n[backbone]\nshear_modulus = 1e9");
    assert_eq!(robot.disks().arc_lengths, [0.0, 0.01, 0.18]);
    assert_eq!(robot.backbone().material.shear_modulus, Some(1e9));
    assert_eq!(robot.backbone().material.poisson_ratio, None);
}

#[test]
fn chains_and_folders() {
    let folder = folder(&[
        ("robots/base.toml", BASE),
        (
            "robots/middle.toml",
            "extends = 'base.toml'\ntitle = 'middle'\n[measured]\ndisks = 'data/m.csv'\n",
        ),
        (
            "robots/data/m.csv",
            "# by hand\r\ndisk, x, y, z\r\n3, 0.01, -2e-3, 0.17\r\n\r\n1,0,0,0\r\n",
        ),
        ("case.toml", "extends = 'robots/middle.toml'\nbackbone.length = 0.19\n"),
    ]);
    let file = load(folder.path().join("case.toml")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.title, "middle");
    assert_eq!(file.robot.backbone().length, 0.19);
    assert_eq!(file.robot.cables().len(), 2);
    let measured = file.measured.unwrap();
    assert_eq!(measured.path, folder.path().join("robots/data/m.csv"));
    assert_eq!(measured.disks.len(), 2);
    assert_eq!((measured.disks[0].disk, measured.disks[1].disk), (1, 3));
    assert_eq!(measured.disks[1].position, Vec3::new(0.01, -0.002, 0.17));
}

const STEPS_ROBOT: &str = "[backbone]
length = '20 cm'
[[cables]]
holes = [1, 1, 1]
[[steps]]
tension = ['1 N']
[[steps]]
tension = ['2 N']
[measured]
disks = 'seen.csv'
unit = 'mm'
deviation = '0.3 mm'
[disks]
count = 3
hole_circle_radius = 0.008
holes = 4
";
const STEPS_SEEN: &str = "\
step, disk, arc_length, offset_x, offset_y, x, y, z, deviation, confidence
2, 3, , , , 1.5, -2, 199.7, , 0.9
2, 2, , 0, 8, 1, 2, 3, 0.1, 0.8
2, 2, , , , NaN, nan, , , 0
1, , 150.00001, , , 0, 0, 150, ,
2, 2, , 8, 0, 1, 2, 4, , 0.7
";

#[test]
fn markers_seen_in_several_steps() {
    let folder = folder(&[("case.toml", STEPS_ROBOT), ("seen.csv", STEPS_SEEN)]);
    let file = load(folder.path().join("case.toml")).unwrap_or_else(|error| panic!("{error}"));
    let measured = file.measured.unwrap();
    let seen = |step, place, offset: [f64; 3], position: [f64; 3], deviation| Observation {
        step,
        place,
        offset: Vec3::new(offset[0], offset[1], offset[2]),
        seen: Seen::Position(Vec3::new(position[0], position[1], position[2])),
        deviation: Some(deviation),
    };
    let expected = [
        seen(0, Place::ArcLength(0.15000001), [0.0; 3], [0.0, 0.0, 0.15], 3e-4),
        seen(1, Place::Disk(1), [0.0, 0.008, 0.0], [0.001, 0.002, 0.003], 1e-4),
        seen(1, Place::Disk(1), [0.008, 0.0, 0.0], [0.001, 0.002, 0.004], 3e-4),
        seen(1, Place::Disk(2), [0.0; 3], [0.0015, -0.002, 0.1997], 3e-4),
    ];
    assert_eq!(measured.observations, expected);
    // A disk without an offset, in the last step.
    let tip = MeasuredDisk { disk: 3, position: Vec3::new(0.0015, -0.002, 0.1997) };
    assert_eq!(measured.disks, [tip]);
}

const CAMERAS_ROBOT: &str = "[backbone]
length = '20 cm'
[disks]
count = 3
[measured]
disks = 'seen.csv'
pixel_deviation = 0.3
[[measured.cameras]]
name = 'side'
file = 'side.yml'
[[measured.cameras]]
name = 'top'
file = 'top.json'
";
const SIDE: &str = "%YAML:1.0\n---\nprojection: orthographic\npixels_per_metre: 4000.\nprincipal_point: [ 320., 240. ]\n";
const TOP: &str = r#"{"camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
        "data": [800.0, 0.0, 320.0, 0.0, 810.0, 240.0, 0.0, 0.0, 1.0]}}"#;
const CAMERAS_SEEN: &str =
    "disk,camera,u,v,deviation\n3,top,10.25,20,\n3,\"side\",30,40.5,0.2\n2,side,,,\n";

#[test]
fn markers_seen_by_cameras() {
    let folder = folder(&[
        ("case.toml", CAMERAS_ROBOT),
        ("seen.csv", CAMERAS_SEEN),
        ("side.yml", SIDE),
        ("top.json", TOP),
    ]);
    let file = load(folder.path().join("case.toml")).unwrap_or_else(|error| panic!("{error}"));
    let measured = file.measured.unwrap();
    let seen = |camera, pixel, deviation| Observation {
        step: 0,
        place: Place::Disk(2),
        offset: Vec3::ZERO,
        seen: Seen::Pixel { camera, pixel },
        deviation: Some(deviation),
    };
    let expected = [seen(1, [10.25, 20.0], 0.3), seen(0, [30.0, 40.5], 0.2)];
    assert_eq!(measured.observations, expected);
    assert!(measured.disks.is_empty());
    let names: Vec<&str> = measured.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["side", "top"]);
    let [side, top] = &measured.cameras[..] else { panic!() };
    assert_eq!(side.camera.project(Vec3::new(0.01, 0.02, 1.0)), Ok([360.0, 320.0]));
    assert_eq!(top.camera.project(Vec3::new(0.01, 0.02, 1.0)), Ok([328.0, 256.2]));
}

/// A table that pyarrow wrote.
fn parquet(name: &str) -> Vec<u8> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parquet");
    std::fs::read(data.join(name)).unwrap()
}

#[test]
fn parquet_says_what_csv_says() {
    for (name, robot, csv) in [
        ("steps.parquet", STEPS_ROBOT, STEPS_SEEN),
        ("pixels.parquet", CAMERAS_ROBOT, CAMERAS_SEEN),
    ] {
        let folder = folder(&[
            ("csv.toml", robot.as_bytes()),
            ("parquet.toml", robot.replace("seen.csv", "seen.parquet").as_bytes()),
            ("seen.csv", csv.as_bytes()),
            ("seen.parquet", &parquet(name)[..]),
            ("side.yml", SIDE.as_bytes()),
            ("top.json", TOP.as_bytes()),
        ]);
        let measured = |file: &str| {
            let file = load(folder.path().join(file)).unwrap_or_else(|error| panic!("{error}"));
            file.measured.unwrap()
        };
        let (from_csv, from_parquet) = (measured("csv.toml"), measured("parquet.toml"));
        assert_eq!(from_csv.observations, from_parquet.observations);
        assert_eq!(from_csv.disks, from_parquet.disks);
    }
}

#[test]
fn mistakes_in_parquet_have_their_row_and_column() {
    let robot = STEPS_ROBOT.replace("seen.csv", "seen.parquet");
    let message = |bytes: &[u8]| {
        let folder = folder(&[("case.toml", robot.as_bytes()), ("seen.parquet", bytes)]);
        load(folder.path().join("case.toml")).unwrap_err().to_string()
    };
    // The names of the columns are line 1.
    let text = message(&parquet("wrong.parquet"));
    assert!(text.contains("seen.parquet:3:1") && text.contains("there is no disk 9"), "{text}");
    assert!(
        text.contains("seen.parquet:3:3") && text.contains("`far` is not a finite number"),
        "{text}"
    );
    assert!(text.contains("9,far,0,0"), "{text}");
    let text = message(&parquet("nested.parquet"));
    assert!(text.contains("the column `position` holds lists or tables"), "{text}");
    let text = message(&parquet("zstd.parquet"));
    assert!(text.contains("compressed in a way that is not read"), "{text}");
    assert!(text.contains("compression=\"snappy\""), "{text}");
    // Cut off anywhere.
    let whole = parquet("pixels.parquet");
    for end in (4..whole.len()).step_by(7) {
        assert!(message(&whole[..end]).contains("the Parquet file cannot be read"));
    }
}

#[test]
fn damaged_parquet_is_refused_or_read() {
    let whole = parquet("steps.parquet");
    let robot = STEPS_ROBOT.replace("seen.csv", "seen.parquet");
    for at in (4..whole.len()).step_by(3) {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x55;
        let folder = folder(&[("case.toml", robot.as_bytes()), ("seen.parquet", &damaged[..])]);
        let _ = load(folder.path().join("case.toml"));
    }
}

#[test]
fn every_stiffness() {
    let stiffness = |lines: &str| {
        let text = format!(
            "[disks]\ncount = 3\n[backbone]\nlength = 0.3\nextensible = false\n[backbone.stiffness]\n{lines}\n"
        );
        read(&text).robot.backbone().stiffness.clone().unwrap()
    };
    let given = stiffness(
        "shear = ['3 kN', 2500]\naxial = '8 kN'\nbending = ['4e3 N*mm^2', 0.005]\ntorsion = '30 N·cm²'",
    );
    assert_eq!(given, Stiffness::diagonal([3000.0, 2500.0], 8000.0, [0.004, 0.005], 0.003));

    let given = stiffness(
        "at = [0, '10 cm', '10 cm']\nshear = [3000, 3000]\nbending = [[3, 3], [2, 2], [1, 1]]\ntorsion = [3, '2 N*m^2', 1]",
    );
    let at = |values| Along::At { arc_lengths: vec![0.0, 0.1, 0.1], values };
    let expected = Stiffness::Diagonal {
        shear: Some(Along::Uniform([3000.0; 2])),
        axial: None,
        bending: Along::At {
            arc_lengths: vec![0.0, 0.1, 0.1],
            values: vec![[3.0; 2], [2.0; 2], [1.0; 2]],
        },
        torsion: at(vec![3.0, 2.0, 1.0]),
    };
    assert_eq!(given, expected);

    let row = |i: usize| {
        let entries: Vec<_> = (0..6).map(|j| if i == j { "5.0" } else { "1" }).collect();
        format!("[{}]", entries.join(", "))
    };
    let matrix = format!("[{}]", (0..6).map(row).collect::<Vec<_>>().join(", "));
    let expected = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 5.0 } else { 1.0 }));
    let given = stiffness(&format!("matrix = {matrix}"));
    assert_eq!(given, Stiffness::Matrix(Along::Uniform(expected)));
    let given = stiffness(&format!("matrix = [{matrix}, {matrix}, {matrix}]"));
    assert_eq!(given, Stiffness::Matrix(Along::PerDisk(vec![expected; 3])));
}

#[test]
fn a_stiffness_replaces_the_material_of_the_file_below() {
    let base = "[disks]\ncount = 3\n[backbone]\nlength = 0.3\ndiameter = 0.003\nyoung_modulus = 1e9\npoisson_ratio = 0.3\n";
    let above = "extends = 'base.toml'\n[backbone.stiffness]\nshear = [1, 1]\naxial = 1\nbending = [1, 1]\ntorsion = 1\n";
    let folder = folder(&[("base.toml", base.as_bytes()), ("above.toml", above.as_bytes())]);
    let robot = load(folder.path().join("above.toml")).unwrap().robot;
    assert!(robot.backbone().stiffness.is_some());
    assert_eq!(robot.backbone().material, whipcord::Material::default());
    assert_eq!(robot.backbone().section, Some(Section::circle(0.003)));
}

#[test]
fn distributed_loads_masses_and_base() {
    let with = |lines: &str| {
        read(&format!("[backbone]\nlength = \"200 mm\"\n[disks]\ncount = 3\n{lines}")).case
    };
    let case = with(
        r#"
[base]
position = ["10 mm", 0, "1 m"]
rotation = { axis = [0, 2, 0], angle = "90 deg" }

[loads]
frame = "world"
gravity = [0, 0, "-1 g0"]

[[loads.mass]]
at = "50 mm"
mass = "12 g"

[[loads.distributed]]
force = ["2 mN/mm", "0.5 N/m", 0]

[[loads.distributed]]
from = "20 mm"
to = "120 mm"
moment = [0, 0, "3 mN*m/m"]
follower = true

[[loads.distributed]]
at = [0, "0.1 m", "150 mm"]
force = [[0, 0, 0], ["1 kN/m", 0, 0], [0, "1 N/mm", 0]]
moment = [0, 0.5, 0]
"#,
    );
    let turn = UnitQuaternion::exp(Vec3::Y * 90_f64.to_radians());
    assert_eq!(case.base, Pose { position: Vec3::new(0.01, 0.0, 1.0), rotation: turn });
    assert_eq!(case.loads.frame, LoadFrame::World);
    assert_eq!(case.loads.masses, [PointMass { at: 0.05, mass: 0.012 }]);
    let constant = |from, to, force, moment| Profile::Constant { from, to, force, moment };
    let listed = Profile::Linear {
        at: vec![0.0, 0.1, 0.15],
        force: vec![Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3],
        moment: vec![Vec3::Y * 0.5; 3],
    };
    let dead = |profile| DistributedLoad { profile, follower: false };
    assert_eq!(
        case.loads.distributed,
        [
            dead(constant(0.0, 0.2, Vec3::new(2.0, 0.5, 0.0), Vec3::ZERO)),
            dead(constant(0.02, 0.12, Vec3::ZERO, Vec3::Z * 0.003)).following(),
            dead(listed),
        ]
    );
    // A quaternion of any norm, and the default.
    let quarter = with("[base]\norientation = [3, 0, 3, 0]").base.rotation;
    assert!((quarter.log() - turn.log()).norm() < 1e-15);
    assert_eq!(with("[loads]\ntip_force = [1, 0, 0]").base, Pose::IDENTITY);
}

#[test]
fn steps_say_what_each_cable_does_in_turn() {
    let robot = "[backbone]\nlength = 0.18\n[disks]\ncount = 2\n";
    let cable = |name: &str, own: &str| {
        let routing = "routing = { kind = 'straight', angle = 0, radius = 0.008 }";
        format!("[[cables]]\nname = '{name}'\n{routing}\n{own}\n")
    };
    let cables = cable("a", "") + &cable("b", "");
    let steps = "[[steps]]\ntension = ['2 N', 0]\n[[steps]]\ntension = [1, 3]\nshortening = ['5 %', '-1 mm']\n";
    let file = read(&format!("{robot}{cables}{steps}"));
    let command = |tension, shortening| CableCommand { tension: Some(tension), shortening };
    assert_eq!(file.case.before, [[command(2.0, None), command(0.0, None)]]);
    let (fraction, length) = (Shortening::Fraction(0.05), Shortening::Length(-0.001));
    assert_eq!(file.case.commands, [command(1.0, Some(fraction)), command(3.0, Some(length))]);

    // The steps of a file that extends another replace what the cables say there.
    let own = cable("a", "tension = 7") + &cable("b", "shortening = 0.1");
    let folder = folder(&[
        ("base.toml", &format!("{robot}{own}")),
        ("robot.toml", &format!("extends = 'base.toml'\n{steps}")),
    ]);
    let laid_over = load(folder.path().join("robot.toml")).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(laid_over.case, file.case);
}

/// The same rows, as spreadsheets of different countries write them, and with the columns in another order.
#[test]
fn tables_of_markers_are_read_by_the_names_of_their_columns() {
    let read = |table: &str, keys: &str| {
        let robot = format!(
            "[backbone]\nlength = \"180 mm\"\n[disks]\ncount = 10\n[measured]\ndisks = \"table.csv\"\n{keys}"
        );
        let folder = folder(&[("robot.toml", robot.as_bytes()), ("table.csv", table.as_bytes())]);
        load(folder.path().join("robot.toml")).unwrap().measured.unwrap().observations
    };
    let expected = read("arc_length,x,y,z\n0.09,0.0015,0,0.0895\n0.18,0.003,0,0.1785\n", "");
    assert_eq!(expected.len(), 2);
    for (name, table, keys) in [
        ("order", "z,y,x,arc_length\n0.0895,0,0.0015,0.09\n0.1785,0,0.003,0.18\n", ""),
        ("capitals", "Arc_Length,X,Y,Z\n0.09,0.0015,0,0.0895\n0.18,0.003,0,0.1785\n", ""),
        ("semicolons", "arc_length;x;y;z\r\n0.09;0.0015;0;0.0895\r\n0.18;0.003;0;0.1785\r\n", ""),
        ("decimal commas", "arc_length;x;y;z\n0,09;0,0015;0;0,0895\n0,18;0,003;0;0,1785\n", ""),
        ("tabs", "arc_length\tx\ty\tz\n0.09\t0.0015\t0\t0.0895\n0.18\t0.003\t0\t0.1785\n", ""),
        ("units", "arc_length [m],x [mm],y (mm),z [cm]\n0.09,1.5,0,8.95\n0.18,3,0,17.85\n", ""),
        (
            "a unit of one column",
            "arc_length [m],x,y,z\n0.09,1.5,0,89.5\n0.18,3,0,178.5\n",
            "unit = \"mm\"\n",
        ),
    ] {
        assert_eq!(read(table, keys), expected, "{name}");
    }
}

/// Markers next to the base are no mistake, in whatever unit.
#[test]
fn markers_near_the_base_are_accepted() {
    for (table, keys) in [
        ("arc_length,x,y,z\n0,0,0,0\n1,0,0,1\n", "unit = \"mm\"\n"),
        ("arc_length,x,y,z\n0,500,0,0\n1,500,0,1\n", "unit = \"mm\"\nregistration = \"rigid\"\n"),
        ("disk,arc_length,x,y,z\n,1,0,0,1\n10,,0,0,180\n", "unit = \"mm\"\n"),
        ("arc_length,x,y,z\n0.18,0,0,0.18\n", ""),
    ] {
        let robot = format!(
            "[backbone]\nlength = \"180 mm\"\n[disks]\ncount = 10\n[measured]\ndisks = \"table.csv\"\n{keys}"
        );
        let folder = folder(&[("robot.toml", robot.as_bytes()), ("table.csv", table.as_bytes())]);
        let read = load(folder.path().join("robot.toml"));
        assert!(read.is_ok(), "{table}: {}", read.unwrap_err());
    }
}

/// A helical cable is longer than the backbone, and may be shortened by more than that.
#[test]
fn a_shortening_is_refused_only_beyond_the_length_of_the_cable() {
    let with = |routing: &str, shortening: &str| {
        parse(
            &format!(
                "[backbone]\nlength = 0.1\n[disks]\ncount = 3\n[[cables]]\nrouting = {routing}\nshortening = {shortening}\n"
            ),
            "robot.toml",
        )
    };
    // Ten turns on a circle of 10 mm: 636.2 mm.
    let helix = "{ kind = \"helix\", turns = 10, radius = 0.01 }";
    assert!(with(helix, "0.63").is_ok());
    assert!(with(helix, "0.64").is_err());
    let straight = "{ kind = \"straight\", angle = 0, radius = 0.01 }";
    assert!(with(straight, "0.0999").is_ok());
    assert!(with(straight, "0.1001").is_err());
    assert!(with(straight, "-5").is_ok());
}

/// How far a cable is beside its holes is read, written and read again; a cable along a curve has no holes to be beside.
#[test]
fn cables_beside_the_centres_of_their_holes() {
    let robot = |routing: &str| {
        format!(
            "[backbone]\nlength = 0.1\ndiameter = 0.002\nyoung_modulus = 1e9\npoisson_ratio = 0.3\n\
             [disks]\ncount = 3\nhole_circle_radius = 0.008\nholes = 4\n[[cables]]\nname = 'a'\n{routing}\n\
             hole_angle_offset = '3 deg'\nhole_radius_offset = '-0.2 mm'\n"
        )
    };
    let file = parse(&robot("holes = [1, 2, 2]"), Path::new("robot.toml")).unwrap();
    let off = file.robot.cables()[0].hole_offset;
    assert_eq!([off.angle, off.radius], [3f64.to_radians(), -2e-4]);
    let table = whipcord_io::describe(None, &file.robot, &file.case).unwrap();
    let again = parse(&whipcord_io::toml(&table), Path::new("robot.toml")).unwrap();
    assert_eq!(again.robot.cables()[0].hole_offset, off);
    let curve = robot("routing = { kind = 'straight', angle = 0.0, radius = 0.008 }");
    let error = parse(&curve, Path::new("robot.toml")).unwrap_err().to_string();
    assert!(error.contains("hole_angle_offset") && error.contains("routing"), "{error}");
}
