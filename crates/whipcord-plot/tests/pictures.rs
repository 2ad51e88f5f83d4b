//! What every picture must be: XML that renders, nothing outside its edges, no text over another,
//! the same bytes each time.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helpers too")]

mod common;

use common::{arm, before, catheter, prototype, towards, view};
use proptest::prelude::*;
use resvg::tiny_skia::Pixmap;
use resvg::usvg::{Group, Node, Options, Rect, Tree, roxmltree};
use whipcord::kinematics::PrincipalAxes;
use whipcord::{
    Backbone, Cable, Case, Disks, DistributedLoad, LoadFrame, Loads, ModelKind, PointLoad,
    PointMass, Pose, Profile, Robot, Routing, Section, UnitQuaternion, Vec3,
};
use whipcord_plot::{
    AccuracySeries, Acting, AxisSpec, Chart, Colour, DistanceSeries, Ellipsoid, FigureOptions,
    Layer, Marker, ParetoSeries, PlotError, Quantity, RobotView, Scale, Series, TimingSeries,
    ViewStyle, accuracy_chart, distance_chart, outlined, pareto_chart, png, robot_figure,
    timing_chart,
};

/// The picture, with every text as a path of this name.
fn tree(svg: &str) -> Tree {
    let svg = outlined(svg).unwrap().replace("class=\"text\"", "id=\"text\"");
    Tree::from_str(&svg, &Options::default()).unwrap()
}

/// Boxes of the texts: of their letters and the space of a px around them.
fn texts(group: &Group, found: &mut Vec<Rect>) {
    for node in group.children() {
        match node {
            Node::Group(group) => texts(group, found),
            Node::Path(path) if path.id() == "text" => {
                let letters = path.abs_bounding_box();
                let [left, top] = [letters.left(), letters.top()].map(|low| low - 1.0);
                let [right, bottom] = [letters.right(), letters.bottom()].map(|high| high + 1.0);
                found.push(Rect::from_ltrb(left, top, right, bottom).unwrap());
            }
            _ => {}
        }
    }
}

/// Checks what holds for every picture.
fn check(svg: &str) {
    let document = roxmltree::Document::parse(svg).unwrap();
    for attribute in document.descendants().flat_map(|n| n.attributes()) {
        let value = attribute.value();
        assert!(!value.contains("NaN") && !value.contains("inf"), "{attribute:?}");
    }
    let tree = tree(svg);
    let (width, height) = (tree.size().width(), tree.size().height());
    let drawn = tree.root().abs_stroke_bounding_box();
    let slack = 0.01;
    assert!(drawn.left() >= -slack && drawn.top() >= -slack, "{drawn:?}");
    assert!(drawn.right() <= width + slack, "{drawn:?} {width}");
    assert!(drawn.bottom() <= height + slack, "{drawn:?} {height}");
    let mut boxes = Vec::new();
    texts(tree.root(), &mut boxes);
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[..i] {
            let apart = a.right() <= b.left()
                || b.right() <= a.left()
                || a.bottom() <= b.top()
                || b.bottom() <= a.top();
            assert!(apart, "text over text: {a:?} {b:?}");
        }
    }
}

fn count(svg: &str, class: &str) -> usize {
    let document = roxmltree::Document::parse(svg).unwrap();
    document.descendants().filter(|n| n.attribute("class") == Some(class)).count()
}

/// What the legend says, in its order.
fn legend(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    document
        .descendants()
        .filter(|n| n.attribute("class") == Some("legend"))
        .flat_map(|n| n.descendants().filter(|n| n.has_tag_name("text")))
        .map(|n| n.text().unwrap_or_default().to_owned())
        .collect()
}

fn case_three() -> (Robot, [RobotView; 3]) {
    let robot = prototype(&[1, 2, 3, 4, 4, 4, 4, 3, 2, 1]).unwrap();
    let a =
        view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |s| towards(20.0 * s, 8.7));
    let b =
        view(&robot, "four-bar", ViewStyle::Model(ModelKind::FourBar), |s| towards(21.0 * s, 8.2));
    let views = [before(&robot), a, b];
    (robot, views)
}

#[test]
fn a_robot_has_all_its_parts_in_all_views() {
    let (robot, views) = case_three();
    let measured: Vec<Vec3> = views[1].disks.positions().collect();
    let options = FigureOptions { title: "Case III".into(), measured, ..Default::default() };
    let svg = robot_figure(&robot, &views, &options).unwrap();
    check(&svg);
    assert_eq!(count(&svg, "disk"), 4 * 3 * 10);
    assert_eq!(count(&svg, "view"), 3);
    assert_eq!(
        legend(&svg),
        ["before actuation", "cosserat", "four-bar", "cable pull", "measured"]
    );
    for axis in ["x (mm)", "y (mm)", "z (mm)"] {
        assert_eq!(svg.matches(axis).count(), 2, "{axis}");
    }
    assert_eq!(svg, robot_figure(&robot, &views, &options).unwrap());
    assert!(svg.len() < 300_000, "{}", svg.len());
}

#[test]
fn cables_that_end_midway_end_in_the_picture() {
    let robot = arm().unwrap();
    let bent =
        view(&robot, "cosserat", ViewStyle::Model(ModelKind::Cosserat), |s| towards(3.0 * s, 1.3));
    let svg = robot_figure(&robot, std::slice::from_ref(&bent), &FigureOptions::default()).unwrap();
    check(&svg);
    // 16 sections of two pieces each; three cables end after the eighth.
    assert_eq!(count(&svg, "backbone"), 4 * 32);
    assert_eq!(count(&svg, "cable"), 4 * (3 * 16 + 3 * 32));
    assert_eq!(legend(&svg).len(), 7);
}

#[test]
fn robots_without_holes_and_robots_that_stand_still_are_drawn() {
    let robot = catheter().unwrap();
    let hook = view(&robot, "hook", ViewStyle::Model(ModelKind::Cosserat), |s| Vec3::Y * 500.0 * s);
    check(&robot_figure(&robot, &[before(&robot), hook], &FigureOptions::default()).unwrap());

    let robot = prototype(&[4; 10]).unwrap();
    let still = RobotView { style: ViewStyle::Model(ModelKind::Cosserat), ..before(&robot) };
    check(&robot_figure(&robot, &[before(&robot), still], &FigureOptions::default()).unwrap());

    let bare = Robot::new(
        Backbone::new(0.05),
        Disks { hole_circle_radii: vec![], ..Disks::equally_spaced(0.05, 4, 1.0) },
        vec![],
    )
    .unwrap();
    let alone = view(&bare, "bare", ViewStyle::Model(ModelKind::Cosserat), |_| Vec3::X * 30.0);
    check(&robot_figure(&bare, &[alone], &FigureOptions::default()).unwrap());
}

/// One of each load, dead and following, with gravity along y.
fn all_loads() -> Case {
    let spread = |follower, profile| DistributedLoad { profile, follower };
    let loads = Loads {
        gravity: Some(Vec3::Y * -9.81),
        tip_force: Vec3::new(0.0, 0.05, -0.2),
        tip_moment: Vec3::Z * 3e-3,
        points: vec![
            PointLoad { at: 0.08, force: Vec3::Y * 0.1, follower: true, ..Default::default() },
            PointLoad { at: 0.1, force: Vec3::X * 0.3, moment: Vec3::X, ..Default::default() },
        ],
        distributed: vec![
            spread(
                true,
                Profile::Constant { from: 0.1, to: 0.15, force: Vec3::X, moment: Vec3::ZERO },
            ),
            spread(
                false,
                Profile::Linear {
                    at: vec![0.0, 0.05, 0.18],
                    force: vec![],
                    moment: vec![Vec3::ZERO, Vec3::Y * 0.02, Vec3::X * 0.01],
                },
            ),
        ],
        masses: vec![PointMass { at: 0.05, mass: 0.01 }],
        ..Loads::default()
    };
    Case { loads, ..Case::with_tensions(&[1.0]) }
}

#[test]
fn loads_are_drawn_in_all_views_and_said_in_the_legend() {
    let (robot, [before, bent, _]) = case_three();
    let loads = Acting::on(&all_loads(), &bent.shape);
    let views = [before, bent];
    let options = FigureOptions { loads, ..Default::default() };
    let svg = robot_figure(&robot, &views, &options).unwrap();
    check(&svg);
    for class in ["loads", "gravity"] {
        assert_eq!(count(&svg, class), 4, "{class}");
    }
    assert_eq!(count(&svg, "comb"), 4 * 2);
    assert_eq!(
        legend(&svg)[3..],
        [
            "forces up to 300 mN",
            "force 100 mN, follows the body",
            "moments up to 1 N·m",
            "load 1 N/m, follows the body",
            "line moment up to 20 mN·m/m",
            "mass 10 g",
            "gravity 9.81 m/s²",
        ]
    );
    // Without loads there is nothing of them.
    let idle = Acting::on(&Case::default(), &views[1].shape);
    let bare = robot_figure(&robot, &views, &FigureOptions { loads: idle, ..options }).unwrap();
    assert_eq!((count(&bare, "loads"), legend(&bare).len()), (0, 3));
}

#[test]
fn ellipsoids_are_drawn_in_all_views_with_their_values() {
    let (robot, [before, bent, _]) = case_three();
    let at = bent.shape.tip().position;
    let axes =
        PrincipalAxes { values: [0.0, 2e-3, 12.34e-3], directions: [Vec3::Z, Vec3::Y, Vec3::X] };
    let ellipsoid = |label: &str, quantity| Ellipsoid { label: label.into(), at, axes, quantity };
    let options = FigureOptions {
        ellipsoids: vec![
            ellipsoid("compliance", Quantity::Compliance),
            ellipsoid("manipulability", Quantity::ByShortening),
        ],
        ..Default::default()
    };
    let svg = robot_figure(&robot, &[before, bent], &options).unwrap();
    check(&svg);
    assert_eq!((count(&svg, "ellipsoids"), count(&svg, "values")), (4, 1));
    assert_eq!(
        legend(&svg)[3..],
        [
            "compliance",
            "12.3, 2, 0 mm/N",
            "scale: 5 mm/N drawn 14.7 mm long",
            "manipulability",
            "0.0123, 0.002, 0 mm/mm",
            "scale: 0.005 mm/mm drawn 14.7 mm long",
        ]
    );
    let lost = Ellipsoid { at: Vec3::X * f64::NAN, ..options.ellipsoids[0].clone() };
    let lost = FigureOptions { ellipsoids: vec![lost], ..options };
    assert!(robot_figure(&robot, &[case_three().1[0].clone()], &lost).is_err());
}

/// A load in the frame of the world does not turn with the base; one in that of the base does, and one
/// that follows turns with its section as well.
#[test]
fn loads_point_where_they_act() {
    let turn = UnitQuaternion::exp(Vec3::Y * std::f64::consts::FRAC_PI_2);
    let base = Pose { rotation: turn, ..Pose::IDENTITY };
    let robot = prototype(&[4; 10]).unwrap();
    let shape =
        view(&robot, "", ViewStyle::Model(ModelKind::Cosserat), |_| Vec3::ZERO).shape.moved(base);
    let drawn = |frame, tip_follower, force| {
        let loads = Loads { frame, tip_follower, tip_force: force, ..Loads::default() };
        Acting::on(&Case { loads, base, ..Case::with_tensions(&[0.0]) }, &shape)
    };
    // The base's x is the world's −z.
    let down = drawn(LoadFrame::World, false, -Vec3::Z);
    assert_ne!(drawn(LoadFrame::Base, false, -Vec3::Z), down);
    let turned = view(&robot, "", ViewStyle::Model(ModelKind::Cosserat), |_| Vec3::ZERO);
    let turned =
        RobotView { shape: shape.clone(), disks: turned.disks.clone().moved(base), ..turned };
    let picture = |loads: Acting| {
        let options = FigureOptions { loads, ..Default::default() };
        robot_figure(&robot, std::slice::from_ref(&turned), &options).unwrap()
    };
    let expected = picture(down);
    assert_eq!(picture(drawn(LoadFrame::Base, false, Vec3::X)), expected);
    assert!(picture(drawn(LoadFrame::World, true, Vec3::X)).contains("follows the body"));
}

/// The floor lies under a robot that is mounted high, not at the origin.
#[test]
fn a_raised_robot_fills_its_picture_as_one_on_the_floor_does() {
    let robot = prototype(&[4; 10]).unwrap();
    let bent = view(&robot, "", ViewStyle::Model(ModelKind::Cosserat), |_| towards(0.4, 8.0));
    let floor = |height: f64| -> Vec<f64> {
        let base = Pose { position: Vec3::Z * height, ..Pose::IDENTITY };
        let raised = RobotView {
            shape: bent.shape.clone().moved(base),
            disks: bent.disks.clone().moved(base),
            ..bent.clone()
        };
        let svg = robot_figure(&robot, &[raised], &FigureOptions::default()).unwrap();
        let from = svg.find("class=\"floor\"").unwrap();
        let group = &svg[from..from + svg[from..].find("</g>").unwrap()];
        group.split(['M', 'L', ' ', '"']).filter_map(|word| word.parse().ok()).collect()
    };
    let (low, high) = (floor(0.0), floor(0.4));
    assert!(low.len() > 20 && low.len() == high.len());
    assert!(low.iter().zip(&high).all(|(a, b)| (a - b).abs() < 0.02), "{low:?} {high:?}");
}

#[test]
fn a_picture_from_stations_at_the_disks_alone_is_as_round() {
    let robot = prototype(&[4; 10]).unwrap();
    let dense = view(&robot, "a", ViewStyle::Model(ModelKind::Cosserat), |_| towards(1.5, 8.7));
    let coarse = RobotView { shape: dense.disks.clone(), ..dense.clone() };
    let [dense, coarse] = [dense, coarse]
        .map(|v| tree(&robot_figure(&robot, &[v], &FigureOptions::default()).unwrap()));
    let [a, b] = [&dense, &coarse].map(|t| t.root().abs_stroke_bounding_box());
    assert!((a.right() - b.right()).abs() < 0.1 && (a.top() - b.top()).abs() < 0.1);
}

#[test]
fn long_and_hostile_labels_stay_in_their_places() {
    let (robot, mut views) = case_three();
    views[1].label = "a model <with> \"a\" & very long name, as long as it takes ".repeat(4);
    views[2].label = "漢字 \u{7} \u{fffe} émïle".into();
    let options = FigureOptions { title: "Wörd & <tag> ".repeat(30), ..Default::default() };
    check(&robot_figure(&robot, &views, &options).unwrap());

    let series = DistanceSeries {
        label: views[1].label.clone(),
        disks: vec![(1, 0.0), (2, 1e-3)],
        look: None,
        hollow: false,
    };
    check(&distance_chart(&options.title, &[series]).unwrap());
}

#[test]
fn distances_are_columns_in_millimetres() {
    let series = ["a", "b"].map(|label| DistanceSeries {
        label: label.into(),
        disks: (1..=10).map(|k| (k, 2e-4 * k as f64)).collect(),
        look: None,
        hollow: false,
    });
    let svg = distance_chart("Distances", &series).unwrap();
    check(&svg);
    assert_eq!(legend(&svg), ["a", "b"]);
    assert!(svg.contains("distance (mm)"));
    // The ground, two swatches and the columns.
    assert_eq!(svg.matches("<rect").count(), 1 + 2 + 20);

    let nothing = DistanceSeries {
        label: "same".into(),
        disks: vec![(1, 0.0), (2, 0.0)],
        look: None,
        hollow: false,
    };
    check(&distance_chart("", &[nothing]).unwrap());
    let many = DistanceSeries {
        label: "many".into(),
        disks: (1..=321).map(|k| (k, 1e-9 * k as f64)).collect(),
        look: None,
        hollow: false,
    };
    let svg = distance_chart("", &[many]).unwrap();
    check(&svg);
    assert!(svg.contains("distance (µm)") && svg.contains("class=\"line\""));
}

fn timing(label: &str, base: f64, each: f64) -> TimingSeries {
    let runs = [5, 10, 20, 40, 80, 160, 320]
        .into_iter()
        .flat_map(|n| (0..6).map(move |r| (n, (base + each * n as f64) * (1.0 + 0.01 * r as f64))))
        .collect();
    TimingSeries { label: label.into(), runs, look: None }
}

#[test]
fn timings_have_their_slopes_in_the_legend() {
    let series = [timing("four-bar", 0.0, 3e-7), timing("cosserat", 2e-6, 0.0)];
    let svg = timing_chart("Times", &series, Scale::Linear).unwrap();
    check(&svg);
    assert_eq!(legend(&svg)[0], "four-bar: 0.31 µs per section");
    let svg = timing_chart("Times", &series, Scale::Log).unwrap();
    check(&svg);
    assert_eq!(legend(&svg)[0], "four-bar: slope 1.00");
    let one = TimingSeries { label: "once".into(), runs: vec![(9, 2e-6)], look: None };
    for scale in [Scale::Linear, Scale::Log] {
        let svg = timing_chart("", std::slice::from_ref(&one), scale).unwrap();
        check(&svg);
        assert_eq!(legend(&svg), ["once"]);
    }
}

#[test]
fn errors_of_zero_are_drawn_at_rounding() {
    let errors = vec![(2, 1e-2), (4, 6e-4), (64, 0.0)];
    let series = AccuracySeries { label: "a".into(), errors, look: None };
    let svg = accuracy_chart("Accuracy", &[series], &[2, 4]).unwrap();
    check(&svg);
    assert_eq!(legend(&svg), ["a", "slope −2", "slope −4"]);
}

fn models(count: usize, spread: f64) -> Vec<ParetoSeries> {
    let case = |i: usize, k: usize| {
        let at = (i * 7 % count) as f64 + 0.3 * k as f64;
        [2e-6 * (1.0 + spread * at), 1e-2 / (1.0 + spread * (i as f64 + 0.2 * k as f64))]
    };
    let one = |i: usize| ParetoSeries {
        label: format!("a model of rods, number {i}"),
        cases: (0..5).map(|k| case(i, k)).collect(),
        look: (Colour::nth(i / 2), Marker::nth(i / 2)),
        hollow: i % 2 == 1,
    };
    (0..count).map(one).collect()
}

#[test]
fn names_of_models_lie_apart_however_close_the_models_are() {
    for spread in [0.0, 0.05, 1.0, 20.0] {
        for count in [1, 2, 12] {
            let svg = pareto_chart("Error against time", &models(count, spread)).unwrap();
            check(&svg);
            assert_eq!(svg.matches("a model of rods").count(), count, "{spread}");
        }
    }
    // What is exact is drawn at rounding.
    let exact = ParetoSeries { cases: vec![[1e-6, 0.0]], ..models(1, 1.0).remove(0) };
    check(&pareto_chart("", &[exact]).unwrap());
    let timeless = ParetoSeries { cases: vec![[0.0, 0.1]], ..models(1, 1.0).remove(0) };
    assert!(matches!(pareto_chart("", &[timeless]), Err(PlotError::NotPositive { .. })));
    assert!(matches!(pareto_chart("", &[]), Err(PlotError::Empty { .. })));
}

#[test]
fn png_has_the_size_and_is_not_blank() {
    let series = [timing("four-bar", 0.0, 3e-7)];
    let svg = timing_chart("Times", &series, Scale::Linear).unwrap();
    let size = tree(&svg).size();
    let bytes = png(&svg, 1.5).unwrap();
    let pixels = Pixmap::decode_png(&bytes).unwrap();
    assert_eq!(pixels.width(), (1.5 * size.width()).round() as u32);
    assert_eq!(pixels.height(), (1.5 * size.height()).round() as u32);
    let dark = pixels.pixels().iter().filter(|p| p.red() < 128).count();
    assert!(dark > 2000, "{dark}");
    assert!(pixels.pixels().iter().all(|p| p.alpha() == 255));
    assert_eq!(bytes, png(&svg, 1.5).unwrap());
    // Letters are there: without them there is less ink.
    let silent = svg.replace("<text", "<metadata").replace("</text>", "</metadata>");
    let silent = Pixmap::decode_png(&png(&silent, 1.5).unwrap()).unwrap();
    let less = silent.pixels().iter().filter(|p| p.red() < 128).count();
    assert!(less + 500 < dark, "{less} {dark}");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let (robot, views) = case_three();
    let options = FigureOptions::default();
    let refused = |views: &[RobotView], options: &FigureOptions| {
        robot_figure(&robot, views, options).unwrap_err()
    };
    assert!(matches!(refused(&[], &options), PlotError::Empty { .. }));
    let mut bad = views[1].clone();
    bad.shape.poses[3].position.x = f64::NAN;
    let error = refused(&[bad], &options);
    assert!(matches!(error, PlotError::NotFinite { .. }));
    assert!(error.to_string().contains("cosserat"), "{error}");
    let mut bad = views[1].clone();
    bad.disks.poses.pop();
    assert!(matches!(refused(&[bad.clone()], &options), PlotError::Count { .. }));
    bad.disks.arc_length.pop();
    let error = refused(&[bad], &options).to_string();
    assert!(error.contains("has 9 entries, but needs 10"), "{error}");
    let mut bad = views[1].clone();
    bad.shape.arc_length.swap(3, 4);
    assert!(matches!(refused(&[bad], &options), PlotError::NotIncreasing { .. }));
    let lost = FigureOptions { measured: vec![Vec3::X * f64::INFINITY], ..Default::default() };
    assert!(matches!(refused(&views, &lost), PlotError::NotFinite { .. }));
    let mut endless = all_loads();
    endless.loads.tip_force.x = f64::NAN;
    let endless = Acting::on(&endless, &views[1].shape);
    let endless = FigureOptions { loads: endless, ..Default::default() };
    assert!(matches!(refused(&views, &endless), PlotError::NotFinite { .. }));
    let slim = FigureOptions { width: 20.0, ..Default::default() };
    assert!(matches!(refused(&views, &slim), PlotError::Size { .. }));

    assert!(matches!(distance_chart("", &[]), Err(PlotError::Empty { .. })));
    let nan =
        DistanceSeries { label: "a".into(), disks: vec![(1, f64::NAN)], look: None, hollow: false };
    assert!(matches!(distance_chart("", &[nan]), Err(PlotError::NotFinite { .. })));
    let huge =
        DistanceSeries { label: "a".into(), disks: vec![(1, 1e300)], look: None, hollow: false };
    assert!(matches!(distance_chart("", &[huge]), Err(PlotError::NotFinite { .. })));
    let zero = TimingSeries { label: "a".into(), runs: vec![(5, 0.0)], look: None };
    let error = timing_chart("", &[zero], Scale::Log);
    assert!(matches!(error, Err(PlotError::NotPositive { .. })));
    let none = AccuracySeries { label: "a".into(), errors: vec![(0, 1e-3)], look: None };
    let error = accuracy_chart("", &[none], &[]);
    assert!(matches!(error, Err(PlotError::NotPositive { .. })));

    assert!(matches!(png("<svg", 1.0), Err(PlotError::Svg(_))));
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\"/>";
    for scale in [0.0, -1.0, 1e9, f64::NAN] {
        assert!(matches!(png(svg, scale), Err(PlotError::Size { .. })), "{scale}");
    }
}

/// A bent robot with helical cables.
struct SomeRobot {
    length: f64,
    disks: usize,
    /// Radius of the hole circles relative to the length.
    slender: f64,
    cables: usize,
    bend: f64,
    direction: f64,
    twist: f64,
    elevation: f64,
}

impl SomeRobot {
    fn svg(&self) -> String {
        let Self { length, disks, slender, cables, bend, direction, twist, elevation } = *self;
        let ring = slender * length;
        let backbone = Backbone {
            section: Some(Section::rectangle(0.3 * ring, 0.9 * ring)),
            ..Backbone::new(length)
        };
        let list = (0..cables).map(|k| {
            let routing = Routing::Helix { start_angle: k as f64, turns: 0.3, radius: ring };
            let end = (length * (k + 1) as f64 / cables as f64).min(length);
            Cable { ends_at: Some(end), ..Cable::new(format!("cable {k}"), routing) }
        });
        let plates = Disks::equally_spaced(length, disks, ring).with_holes(8);
        let robot = Robot::new(backbone, plates, list.collect()).unwrap();
        let curvature = |s: f64| {
            (towards(direction + twist * s / length, bend) + Vec3::Z * twist) * (1.0 / length)
        };
        let bent = view(&robot, "model", ViewStyle::Model(ModelKind::Cosserat), curvature);
        let mut case = all_loads();
        let place = |s: f64| s * length / 0.18;
        for point in &mut case.loads.points {
            point.at = place(point.at);
        }
        case.loads.masses[0].at = place(case.loads.masses[0].at);
        case.loads.distributed = vec![DistributedLoad::uniform(length, towards(direction, 1.0))];
        let loads =
            if cables % 2 == 0 { Acting::on(&case, &bent.shape) } else { Acting::default() };
        let options = FigureOptions { elevation, loads, ..Default::default() };
        robot_figure(&robot, &[before(&robot), bent], &options).unwrap()
    }
}

#[test]
fn finer_ticks_stay_in_their_margin() {
    let robot = SomeRobot {
        length: 10_f64.powf(-2.1253958008671674),
        disks: 2,
        slender: 0.02,
        cables: 0,
        bend: 2.0561482393390764,
        direction: 5.940164159964557,
        twist: 4.538262302782928,
        elevation: 0.0,
    };
    check(&robot.svg());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    #[test]
    fn any_robot_makes_a_sound_picture(
        length in -2.5..1.0_f64,
        disks in 2_usize..14,
        slender in 0.02..0.3_f64,
        cables in 0_usize..7,
        bend in 0.0..4.0_f64,
        direction in 0.0..6.3_f64,
        twist in -6.0..6.0_f64,
        elevation in -1.5..1.5_f64,
    ) {
        let length = 10_f64.powf(length);
        check(&SomeRobot { length, disks, slender, cables, bend, direction, twist, elevation }.svg());
    }

    #[test]
    fn any_chart_is_sound(
        points in prop::collection::vec((-3.0..3.0_f64, -8.0..8.0_f64), 1..30),
        offset in -100.0..100.0_f64,
        logs in (any::<bool>(), any::<bool>()),
        names in prop::collection::vec("[ -~]{0,40}", 1..9),
    ) {
        let map = |v: f64, log: bool| if log { 10_f64.powf(v) } else { offset + v };
        let points: Vec<_> =
            points.iter().map(|&(x, y)| [map(x, logs.0), map(y, logs.1)]).collect();
        let axis = |log: bool| if log { AxisSpec::log("a (mm)") } else { AxisSpec::linear("a (mm)") };
        let series = names.iter().enumerate().map(|(i, name)| {
            let errors = points.iter().map(|&[x, y]| [x, y, 0.4 * y.abs()]).collect();
            Series::new(name.clone(), i, vec![
                Layer::Line(points.clone()),
                Layer::Errors(errors),
                Layer::Markers(points.clone()),
            ])
        });
        let chart = Chart {
            title: names[0].clone(),
            x: axis(logs.0),
            y: axis(logs.1),
            series: series.collect(),
            ..Chart::default()
        };
        check(&chart.svg().unwrap());
    }
}

/// Eight whole robots in one place cannot be read.
#[test]
fn many_models_are_lines_over_the_disks_of_the_first() {
    let robot = prototype(&[4; 10]).unwrap();
    let kinds =
        [ModelKind::PseudoRigidBody, ModelKind::FourBar, ModelKind::Cosserat, ModelKind::FourBar];
    let bent = kinds.iter().zip(0..).map(|(&kind, i)| {
        view(&robot, &format!("{kind} {i}"), ViewStyle::Model(kind), |_| {
            towards(0.4, 8.0 + 0.3 * f64::from(i))
        })
    });
    let views: Vec<RobotView> = [before(&robot)].into_iter().chain(bent).collect();
    let svg = robot_figure(&robot, &views, &FigureOptions::default()).unwrap();
    check(&svg);
    // Before actuation and of the first model, in four views.
    assert_eq!(count(&svg, "disk"), 4 * 2 * 10);
    let lines: Vec<&str> =
        svg.lines().filter(|line| line.contains("backbone") && line.contains("stroke=")).collect();
    for kind in kinds {
        let stroke = format!("fill=\"none\" stroke=\"{}\"", Colour::of_model(kind));
        let own: Vec<&&str> = lines.iter().filter(|line| line.contains(&stroke)).collect();
        let times = kinds.iter().filter(|other| **other == kind).count();
        assert_eq!(own.len(), 4 * times, "{kind}");
        let dashed = own.iter().filter(|line| line.contains("stroke-dasharray")).count();
        assert_eq!(dashed, 4 * (times - 1), "{kind}");
    }
    // Two are drawn whole.
    let two = robot_figure(&robot, &views[..3], &FigureOptions::default()).unwrap();
    assert_eq!(count(&two, "disk"), 4 * 3 * 10);
}
