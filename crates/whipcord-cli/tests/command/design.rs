//! `whipcord design`.

use serde_json::Value;

use crate::support::{Scratch, fail, succeed, warned};

const THREE: &str = "examples/table1/case-3.toml";
const ARC: &str = "arc, angle = 60 deg, direction = 30 deg";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The robot file of a design gives the shape that the design says, and its folder has what is manufactured.
#[test]
fn holes_for_an_arc_are_proven_written_and_drawn() {
    let scratch = Scratch::new();
    let (new, folder) = (scratch.file("new.toml"), scratch.file("report"));
    let args = [
        "design",
        THREE,
        "--target",
        ARC,
        "--max-jump",
        "2",
        "-o",
        &new,
        "--report",
        &folder,
        "--set",
        "design.tolerances.samples=50",
        "--json",
    ];
    let design = json(&succeed(&args));
    assert_eq!(design["proven"], true);
    assert_eq!(design["findings"][0]["known"], "optimal_proven");
    // No list is nearer than one that is proven to be the best.
    let bound = design["lower_bound"].as_f64().unwrap() / design["error"].as_f64().unwrap();
    assert!((bound - 1.0).abs() < 1e-6, "{bound}");
    let error = design["error"].as_f64().unwrap();
    assert!(error < design["before"]["error"].as_f64().unwrap() && error < 2e-3, "{error}");
    let checked = design["targets"][0]["check"]["error"].as_f64().unwrap();
    assert!((checked - error).abs() < 1e-6);
    let holes = design["cables"][0]["holes"].as_array().unwrap();
    let holes: Vec<i64> = holes.iter().map(|hole| hole.as_i64().unwrap()).collect();
    assert!(holes.windows(2).all(|pair| {
        let apart = (pair[0] - pair[1]).rem_euclid(12);
        apart.min(12 - apart) <= 2
    }));
    // The file gives that shape again.
    let solved = json(&succeed(&["solve", &new, "--model", "cosserat-disks", "--json"]));
    for point in design["targets"][0]["points"].as_array().unwrap() {
        let disk = point["disk"].as_u64().unwrap() as usize;
        for axis in 0..3 {
            let [said, again] = [&point["position"], &solved["disks"][disk - 1]["position"]]
                .map(|at| at[axis].as_f64().unwrap());
            assert!((said - again).abs() < 1e-6, "disk {disk}");
        }
    }
    succeed(&["check", &new]);
    let path = |name: &str| scratch.path().join("report").join(name);
    let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    assert_eq!(read("holes.csv").lines().count(), 11);
    assert_eq!(read("errors.csv").lines().count(), 10);
    assert_eq!(read("tolerances.csv").lines().count(), 51);
    assert!(read("disks.svg").contains("mm\" viewBox"));
    // The bill of holes is what the drawings have.
    let bill = read("holes.csv");
    for (number, row) in bill.lines().skip(1).enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let place = [cells[4], cells[5]].map(|metres| 1e3 * metres.parse::<f64>().unwrap());
        let dxf = read(&format!("disk-{:02}.dxf", number + 1));
        let svg = read(&format!("disk-{:02}.svg", number + 1));
        for (cut, marked) in [drawn_by_dxf(&dxf), drawn_by_svg(&svg)] {
            // The rim, the hole for the backbone and twelve holes, in mm.
            assert_eq!(cut.len(), 14, "disk {}", number + 1);
            let near = |[x, y, _]: &&[f64; 3]| (x - place[0]).hypot(y - place[1]) < 1e-3;
            assert_eq!(cut[2..].iter().filter(near).count(), 1, "{row}");
            assert!(cut[2..].iter().all(|[x, y, _]| (x.hypot(*y) - 8.0).abs() < 1e-3));
            assert!((cut[1][2] - 1.5).abs() < 1e-3, "the backbone is {}", cut[1][2]);
            assert!(marked.len() == 1 && near(&&marked[0]), "{row} {marked:?}");
        }
    }
    assert_eq!(json(&read("design.json"))["tolerances"]["failed"], 0);
    for name in ["shape.png", "tolerances.png", "errors.png", "disks.dxf", "disk-01.svg"] {
        assert!(path(name).exists(), "{name}");
    }
}

/// Circles of the layers CUT and CABLES of a DXF, `[x, y, radius]`, with its units checked: pairs of a group code and a value, as the reference of the format has them.
fn drawn_by_dxf(text: &str) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let pairs: Vec<(&str, &str)> = lines.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
    let variable = |name: &str| {
        let at = pairs.iter().position(|pair| *pair == ("9", name)).unwrap();
        pairs[at + 1].1
    };
    assert_eq!([variable("$ACADVER"), variable("$INSUNITS")], ["AC1009", "4"]);
    assert_eq!(pairs.last(), Some(&("0", "EOF")));
    // What a layer or a line is called is in a table before.
    let named = |code: &str| {
        let of = pairs.iter().filter(move |pair| pair.0 == code).map(|pair| pair.1);
        of.collect::<std::collections::BTreeSet<&str>>()
    };
    let tables = named("2");
    assert!(named("8").is_subset(&tables) && named("6").is_subset(&tables));
    let on = |layer: &str| {
        let starts = pairs.iter().enumerate().filter(|(_, pair)| **pair == ("0", "CIRCLE"));
        let circles = starts.map(|(at, _)| {
            let end = pairs[at + 1..].iter().position(|pair| pair.0 == "0").unwrap();
            &pairs[at + 1..at + 1 + end]
        });
        let of = circles.filter(|circle| circle.contains(&("8", layer)));
        let number = |circle: &[(&str, &str)], code: &str| {
            circle.iter().find(|pair| pair.0 == code).unwrap().1.parse().unwrap()
        };
        of.map(|circle| ["10", "20", "40"].map(|code| number(circle, code))).collect()
    };
    (on("CUT"), on("CABLES"))
}

/// The same of an SVG whose size is that of its view box in mm; the rim is round the origin, and y is upwards.
fn drawn_by_svg(text: &str) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
    let attribute = |line: &str, name: &str| -> String {
        let from = line.split(&format!(" {name}=\"")).nth(1).unwrap();
        from.split('"').next().unwrap().to_owned()
    };
    let head = text.lines().next().unwrap();
    let size = ["width", "height"].map(|name| attribute(head, name).replace("mm", ""));
    assert_eq!(attribute(head, "viewBox"), format!("0 0 {} {}", size[0], size[1]));
    let on = |layer: &str| -> Vec<[f64; 3]> {
        let group = text.split(&format!("<g id=\"{layer}\"")).nth(1).unwrap();
        let group = group.split("</g>").next().unwrap();
        let circles = group.lines().filter(|line| line.starts_with("<circle"));
        let number = |line: &str, name: &str| attribute(line, name).parse().unwrap();
        circles.map(|line| ["cx", "cy", "r"].map(|name| number(line, name))).collect()
    };
    let (cut, marked) = (on("cut"), on("cables"));
    let [x, y, _] = cut[0];
    let seen = |of: Vec<[f64; 3]>| of.into_iter().map(|[cx, cy, r]| [cx - x, y - cy, r]).collect();
    (seen(cut), seen(marked))
}

#[test]
fn a_routing_is_in_closed_form_or_refused_with_the_tension_that_would_do() {
    let scratch = Scratch::new();
    let new = scratch.file("new.toml");
    let vary = ["--vary", "cables[0].routing"];
    let args = ["design", THREE, "--target", "arc, angle = 40 deg", vary[0], vary[1], "-o", &new];
    let text = succeed(&args);
    assert!(text.contains("closed form"), "{text}");
    // The holes of the disks are of no more use, as a warning says.
    let (solved, warnings) = warned(&["solve", &new, "--json"]);
    assert!(
        solved.contains("\"converged\"") && warnings.contains("`disks.holes` has no effect"),
        "{warnings}"
    );
    let refused = fail(1, &["design", THREE, "--target", "arc, angle = 300 deg", vary[0], vary[1]]);
    assert!(refused.contains("or more brings it in"), "{refused}");
}

/// A limit holds in the file that is written, by the verbs that measure it.
#[test]
fn criteria_are_kept_and_told_and_refused_where_they_are_not() {
    let scratch = Scratch::new();
    let new = scratch.file("new.toml");
    let stiff = "stiffness, disk = 10, direction = x, at_least = 30 N/m";
    let slack = ["--set", "cables[0].tension=0 N"];
    let args = [
        "design",
        THREE,
        slack[0],
        slack[1],
        "--target",
        "0, 0, 180 mm",
        "--vary",
        "backbone.diameter",
        "--criterion",
        stiff,
        "-o",
        &new,
        "--json",
    ];
    let design = json(&succeed(&args));
    let [criterion] = &design["criteria"].as_array().unwrap()[..] else { panic!() };
    let value = criterion["value"].as_f64().unwrap();
    assert!(criterion["met"] == true && (30.0..32.0).contains(&value), "{criterion}");
    // A force at the tip of the new robot moves it as said.
    let pushed = ["solve", &new, "--set", "loads.tip_force=['1 mN', '0 N', '0 N']", "--json"];
    let x = json(&succeed(&pushed))["disks"][9]["position"][0].as_f64().unwrap();
    assert!((1e-3 / x / value - 1.0).abs() < 1e-3, "{x}");
    let all = ["design", THREE, "--target", ARC, "--vary", "cables[0].tension", "--criterion"];
    let with = |text| all.into_iter().chain([text]).collect::<Vec<_>>();
    let refused = fail(1, &with("stiffness, disk = 10, at_least = 9000 N/m"));
    assert!(refused.contains("instead of at least 9.0000e3 N/m"), "{refused}");
    assert!(fail(2, &with("clearance, at_least = 1 mm")).contains("nothing to keep clear of"));
    assert!(fail(2, &with("strength, weight = 1")).contains("no criterion"));
    let words = succeed(&with("tension, at_most = 3 N"));
    assert!(words.contains("wanted at most 3 N"), "{words}");
}

/// Each point of a path has tensions of its own, which are the steps of the file.
#[test]
fn a_path_of_the_tip_is_followed_by_the_steps_of_the_new_file() {
    let scratch = Scratch::new();
    let (new, path) = (scratch.file("new.toml"), scratch.file("path.csv"));
    // Arcs of 180 mm.
    let rows = "1,8,0,179.76\n2,16,0,179.05\n3,24,0,177.86\n";
    std::fs::write(&path, format!("t,x [mm],y [mm],z [mm]\n{rows}")).unwrap();
    let routing = "cables[0].routing";
    let args = ["design", THREE, "--target", &path, "--set", "design.starts=1", "--vary", routing];
    let with =
        |more: &[&'static str]| args.into_iter().chain(more.iter().copied()).collect::<Vec<_>>();
    let mut all = with(&["--vary", "cables[0].tension", "--json", "-o"]);
    all.push(&new);
    let design = json(&succeed(&all));
    assert_eq!(design["targets"].as_array().unwrap().len(), 3);
    assert!(design["error"].as_f64().unwrap() < 2e-3, "{}", design["error"]);
    // The tip of the last step is that of the last target.
    let solved = json(&warned(&["solve", &new, "--json"]).0);
    let position = &design["targets"][2]["points"][0]["position"];
    for axis in 0..3 {
        let [said, again] =
            [position, &solved["disks"][9]["position"]].map(|at| at[axis].as_f64().unwrap());
        assert!((said - again).abs() < 1e-6);
    }
    assert!(fail(2, &with(&[])).contains("tensions of their own"));
}

/// Within a limit of tension the arc is out of reach: the tension is not proven and says what was tried, and no list of holes comes below the bound.
#[test]
fn a_target_out_of_reach_has_a_bound() {
    let target = ["--target", "arc, angle = 60 deg"];
    let limits = ["--set", "limits.tension=['0 N', '1 N']", "--set", "disks.holes=36"];
    let vary = ["--vary", "holes", "--vary", "tension", "--json"];
    let all = ["design", THREE].iter().chain(&target).chain(&limits).chain(&vary);
    let design = json(&succeed(&all.copied().collect::<Vec<_>>()));
    let of = |name: &str| design[name].as_f64().unwrap();
    assert!(of("lower_bound") <= of("error") * (1.0 + 1e-9));
    assert!(of("lower_bound") > 0.8 * of("error"), "{} {}", of("lower_bound"), of("error"));
    let [_, tension] = &design["findings"].as_array().unwrap()[..] else { panic!() };
    assert_eq!((&tension["known"], &tension["proven"]), (&"in_turn".into(), &false.into()));
    // Without holes there is no bound of lists.
    let taper = ["--vary", "backbone.diameters", "--json"];
    let all = ["design", THREE].iter().chain(&target).chain(&taper);
    assert!(json(&succeed(&all.copied().collect::<Vec<_>>()))["lower_bound"].is_null());
}

/// What is far off says why that may be.
#[test]
fn units_that_are_forgotten_and_cables_that_are_not_pulled_are_told() {
    let scratch = Scratch::new();
    let table = scratch.file("mm.csv");
    std::fs::write(&table, "disk,x,y,z\n5,2,0,80\n10,10,0,178\n").unwrap();
    let words = succeed(&["design", THREE, "--target", &table]);
    assert!(words.contains("178.3 m from the base") && words.contains("x [mm]"), "{words}");
    let slack = ["--set", "cables[0].tension=0 N"];
    let words = succeed(&["design", THREE, "--target", ARC, slack[0], slack[1]]);
    assert!(words.contains("no cable is pulled"), "{words}");
}

#[test]
fn what_is_no_design_is_refused() {
    for (args, words) in [
        (&["--target", "spiral, radius = 1 m"][..], "is no curve"),
        (&[], "no target shape"),
        (&["--target", ARC, "--vary", "cables[7].holes"], "there is no cable `7`"),
        (&["--target", "arc, angle = 60 mm"], "`angle`"),
        (&["--target", "measured"], "no disks were measured"),
        (&["--target", "clothoid, start = 0, end = 1e9 1/m"], "winds more than 100 times"),
    ] {
        let all: Vec<&str> = ["design", THREE].into_iter().chain(args.iter().copied()).collect();
        let message = fail(2, &all);
        assert!(message.contains(words), "{args:?}: {message}");
    }
    let unproven =
        ["design", THREE, "--target", ARC, "--vary", "backbone.rest_curvature", "--prove"];
    assert!(fail(1, &unproven).contains("not proven to be the best"));
}

/// A search that is ended by its budget or its time answers with the best so far, and says so.
#[test]
fn a_search_ends_with_the_best_so_far() {
    // Under a load lists are solved as a whole.
    let asked = [
        "design",
        THREE,
        "--target",
        ARC,
        "--vary",
        "holes",
        "--vary",
        "tension",
        "--set",
        "loads.tip_force=[0, 0.05, 0]",
    ];
    let run = |more: &[&str]| json(&succeed(&[&asked[..], more, &["--json"][..]].concat()));
    let few = run(&["--solves", "100"]);
    assert_eq!(few["ended"], "solves");
    assert_eq!(few["proven"], false);
    let by_key = run(&["--set", "design.solves=100"]);
    assert_eq!(few, by_key);
    let some = run(&["--solves", "2000"]);
    let [error, better] = [&few, &some].map(|of| of["error"].as_f64().unwrap());
    assert!(better <= error && error <= few["before"]["error"].as_f64().unwrap());
    let late = run(&["--timeout", "1 ms"]);
    assert_eq!(late["ended"], "time");
    for finding in late["findings"].as_array().unwrap() {
        assert_eq!(finding["known"], "budget_spent");
    }
    let words = succeed(&[&asked[..], &["--solves", "100"][..]].concat());
    assert!(words.contains("--solves 1") && words.contains("found this until then"), "{words}");
    let words = succeed(&[&asked[..], &["--timeout", "1 ms"][..]].concat());
    assert!(words.contains("a longer --timeout looks on"), "{words}");
    // Nothing ends what is done.
    let done = json(&succeed(&["design", THREE, "--target", ARC, "--max-jump", "2", "--json"]));
    assert_eq!(done["ended"], Value::Null);
}
