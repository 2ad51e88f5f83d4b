//! `whipcord compare`.

use std::path::Path;

use crate::support::{BUCKLED_SPANS, Scratch, fail, pushed_rod, robot, settings, succeed, warned};
use whipcord::{Actuation, ModelKind};

/// Of a case that all models take: each once, and the geometric ones again with the lengths of another.
fn runs() -> usize {
    let geometric = |kind: &&ModelKind| kind.natural_actuation() == Actuation::Shortening;
    ModelKind::ALL.len() + ModelKind::ALL.iter().filter(geometric).count()
}

fn files(folder: &Path, extension: &str) -> Vec<std::path::PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .collect();
    files.sort();
    files
}

/// Cells of each row; quotes as in RFC 4180.
fn rows(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut chars = text.chars().peekable();
    while let Some(c) = chars.next() {
        match (c, quoted) {
            ('"', true) if chars.peek() == Some(&'"') => cell.extend(chars.next()),
            ('"', _) => quoted = !quoted,
            (',', false) => row.push(std::mem::take(&mut cell)),
            ('\n', false) => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            (c, _) => cell.push(c),
        }
    }
    assert!(row.is_empty() && cell.is_empty() && !quoted);
    rows
}

#[test]
fn the_papers_table_is_solved_drawn_and_written() {
    let scratch = Scratch::new();
    let out = scratch.path().join("report");
    let text = succeed(&["compare", "examples/table1", "--out", out.to_str().unwrap()]);
    settings(Some(&out)).bind(|| insta::assert_snapshot!("table1", text));

    let csv = files(&out, "csv");
    assert_eq!(csv.len(), 4 + 4 * 3);
    for path in &csv {
        let rows = rows(&std::fs::read_to_string(path).unwrap());
        assert!(rows.len() > 1 && rows.iter().all(|row| row.len() == rows[0].len()));
        assert!(rows.iter().flatten().all(|cell| !["NaN", "inf"].contains(&cell.as_str())));
    }
    let cases = rows(&std::fs::read_to_string(out.join("cases.csv")).unwrap());
    // One arc takes the straight cable alone.
    assert_eq!(cases.len(), 1 + 4 * runs() - 3);
    let rms = cases[0].iter().position(|name| name == "rms_to_first_model").unwrap();
    for row in cases.iter().filter(|row| row[4] == "cosserat-shape") {
        let rms: f64 = row[rms].parse().unwrap();
        assert!(rms > 1e-4 && rms < 3.5e-3, "{row:?}");
    }

    let (svg, png) = (files(&out, "svg"), files(&out, "png"));
    assert_eq!((svg.len(), png.len()), (9, 9));
    for path in png {
        let image = resvg::tiny_skia::Pixmap::decode_png(&std::fs::read(&path).unwrap()).unwrap();
        let first = image.pixels()[0];
        let drawn = image.pixels().iter().filter(|&&pixel| pixel != first).count();
        assert!(drawn > image.pixels().len() / 200, "{} is blank", path.display());
    }
}

#[test]
fn figures_may_be_left_out() {
    let scratch = Scratch::new();
    let out = scratch.path().join("report");
    let plot = scratch.path().join("plot.svg");
    let mut args = vec!["compare", "examples/table1/case-3.toml", "--no-figures"];
    args.extend(["--out", out.to_str().unwrap()]);
    succeed(&args);
    assert_eq!((files(&out, "svg").len(), files(&out, "png").len()), (0, 0));
    assert!(files(&out, "csv").len() > 3);
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(report.contains("<table") && !report.contains("<figure"), "{report}");
    // One that is asked for by its name is drawn.
    args.extend(["--plot", plot.to_str().unwrap()]);
    succeed(&args);
    assert!(plot.is_file() && files(&out, "svg").is_empty());
}

#[test]
fn the_report_needs_no_other_file_and_no_network() {
    let scratch = Scratch::new();
    let out = scratch.path().join("report");
    succeed(&["compare", "examples/table1/case-3.toml", "--out", out.to_str().unwrap()]);
    let html = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"));
    for outside in ["src=", "<link", "<script", "@import", "url(http", "href=\"http", "file:"] {
        assert!(!html.contains(outside), "the report has {outside}");
    }
    let namespaces = ["http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"];
    let mut rest = html.clone();
    for namespace in namespaces {
        rest = rest.replace(namespace, "");
    }
    assert!(!rest.contains("http://") && !rest.contains("https://"));
    assert_eq!(html.matches("<svg").count(), 4);
    let place = |words: &str| html.find(words).unwrap();
    let order =
        ["<h2>Verdict", "Which model for what", "<h2>Answers", "id=\"case-1\"", "id=\"accuracy\""];
    assert!(order.windows(2).all(|two| place(two[0]) < place(two[1])));
    // What the list of contents names is there, once.
    for link in html.split("href=\"#").skip(1) {
        let id = link.split('"').next().unwrap();
        assert_eq!(html.matches(&format!(" id=\"{id}\"")).count(), 1, "{id}");
    }
    assert!(html.contains("RMS<small>mm</small>") && html.contains("tip x<small>mm</small>"));
    for words in ["not public", "Mahapatra", "from hole to hole", "10.07 s", "prefers-color-scheme"]
    {
        assert!(html.contains(words), "the report does not say {words}");
    }
}

#[test]
fn a_refusal_is_shown_and_not_fatal() {
    let scratch = Scratch::new();
    let text = robot("tension = \"1 N\"\n[loads]\ntip_force = [0.05, 0, 0]");
    let file = scratch.write("loaded.toml", &text);
    let out = scratch.file("report");
    let text = succeed(&["compare", &file, "--out", &out]);
    settings(Some(Path::new(&out))).bind(|| insta::assert_snapshot!("refusal", text));
}

#[test]
fn a_robot_without_cables_has_no_table_of_them() {
    let scratch = Scratch::new();
    let html = |text: &str, name: &str| {
        let (file, out) = (scratch.write(name, text), scratch.file(&format!("{name}.report")));
        warned(&["compare", &file, "--out", &out]);
        std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap()
    };
    assert!(!html(&pushed_rod(""), "rod.toml").contains("<h3>Cables"));
    assert!(html(BUCKLED_SPANS, "spans.toml").contains("<h3>Cables"));
}

#[test]
fn what_the_robot_leaves_is_marked() {
    let scratch = Scratch::new();
    let file = scratch.write("spans.toml", BUCKLED_SPANS);
    let out = scratch.file("report");
    let (text, warnings) = warned(&["compare", &file, "--out", &out]);
    assert!(warnings.contains("the equilibrium is unstable (stability -0.4"), "{warnings}");
    settings(Some(Path::new(&out))).bind(|| insta::assert_snapshot!("unstable", text));
    let html = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(html.contains(
        "<li>piecewise-constant-curvature: unstable: the robot leaves this shape (stability -0.1"
    ));
    assert!(html.contains("piecewise-constant-curvature †"));
    let names: Vec<_> = files(Path::new(&out), "csv")
        .iter()
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(
        names,
        [
            "accuracy.csv",
            "cases.csv",
            "distances.csv",
            "spans-cables.csv",
            "spans-disks.csv",
            "spans-stations.csv"
        ]
    );
}

#[test]
fn a_robot_without_cables_is_not_compared_like_for_like() {
    let scratch = Scratch::new();
    let text = robot("");
    let file = scratch.write("rod.toml", text.split("[[cables]]").next().unwrap());
    let text = succeed(&["compare", &file, "--out", &scratch.file("report")]);
    assert!(!text.contains("Cosserat's"), "{text}");
}

#[test]
fn cases_of_one_title_and_name_are_told_apart() {
    let scratch = Scratch::new();
    for folder in ["a", "b"] {
        std::fs::create_dir(scratch.path().join(folder)).unwrap();
    }
    let text = robot("tension = \"1 N\"\nshortening = \"1 %\"");
    let files = ["a/case.toml", "b/case.toml", "b/case-2.toml"].map(|n| scratch.write(n, &text));
    let out = scratch.file("report");
    succeed(&["compare", &files[0], &files[1], &files[2], "--out", &out]);
    let stems = ["case", "case-3", "case-2"];
    // The runs of each case, and the pairs of them.
    for (name, of_each) in [("cases.csv", runs()), ("distances.csv", runs() * (runs() - 1) / 2)] {
        let rows = rows(&std::fs::read_to_string(Path::new(&out).join(name)).unwrap());
        assert_eq!(rows[0][..3], ["case", "file", "stem"]);
        assert_eq!(rows.len(), 1 + 3 * of_each);
        for (i, row) in rows[1..].iter().enumerate() {
            assert_eq!(row[..3], ["Test robot", &files[i / of_each], stems[i / of_each]]);
        }
    }
    let html = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    for (file, stem) in files.iter().zip(stems) {
        assert!(Path::new(&out).join(format!("{stem}-cables.csv")).exists());
        assert_eq!(html.matches(&format!("{file}; numbers in {stem}-*.csv")).count(), 1);
    }
}

#[test]
fn measured_disks_are_compared_with() {
    let scratch = Scratch::new();
    scratch.write("disks.csv", "disk,x,y,z\n1,0,0,0\n5,0,0.02,0.07\n10,0,0.1,0.13\n");
    let text = robot("tension = \"400 gf\"\n[measured]\ndisks = \"disks.csv\"");
    let file = scratch.write("measured.toml", &text);
    let out = scratch.file("report");
    let text = succeed(&["compare", &file, "--out", &out, "--model", "cosserat"]);
    assert!(text.contains("to measured"));
    let cases = rows(&std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap());
    let column = cases[0].iter().position(|name| name == "rms_to_measured").unwrap();
    let rms: f64 = cases[1][column].parse().unwrap();
    assert!(rms > 1e-4 && rms < 0.05);
}

/// RMS distance to the measurement of the first model, and what the report says of it.
fn measured(scratch: &Scratch, lines: &str, table: &str) -> (f64, String) {
    scratch.write("seen.csv", table);
    let text = format!("tension = \"400 gf\"\n[measured]\ndisks = \"seen.csv\"\n{lines}");
    let file = scratch.write("moved.toml", &robot(&text));
    let out = scratch.file("report");
    let text = succeed(&["compare", &file, "--out", &out, "--model", "cosserat"]);
    let cases = rows(&std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap());
    let column = cases[0].iter().position(|name| name == "rms_to_measured").unwrap();
    (cases[1][column].parse().unwrap_or(f64::INFINITY), text)
}

#[test]
fn measurements_are_moved_onto_the_model_where_asked() {
    let scratch = Scratch::new();
    let bare = scratch.write("bare.toml", &robot("tension = \"400 gf\""));
    let text = succeed(&["solve", &bare, "--json"]);
    let object: serde_json::Value = serde_json::from_str(&text).unwrap();
    // In mm, turned by a right angle about z and shifted: (x, y, z) → (−y, x, z) + (100, 20, −30).
    let mut table = String::from("disk,offset_x,x,y,z\n");
    for (i, disk) in object["disks"].as_array().unwrap().iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|k| 1e3 * disk["position"][k].as_f64().unwrap());
        table += &format!("{},0,{},{},{}\n", i + 1, 100.0 - y, 20.0 + x, z - 30.0);
    }
    // A second marker on the base, 10 mm along its x.
    table += "1,10,100,30,-30\n";
    let unit = "unit = \"mm\"\n";
    let (as_it_is, text) = measured(&scratch, unit, &table);
    assert!(as_it_is > 0.05 && !text.contains("moved"), "{as_it_is} {text}");
    let (rigid, text) = measured(&scratch, &format!("{unit}registration = \"rigid\"\n"), &table);
    assert!(rigid < 1e-8, "{rigid}");
    assert!(
        text.contains("measurement moved by 106.3") && text.contains("turned by 90°"),
        "{text}"
    );
    // The least turn that brings the two markers on the base to their places is the one about z.
    let (base, _) = measured(&scratch, &format!("{unit}registration = \"base\"\n"), &table);
    assert!(base < 1e-8, "{base}");
    // One alone says nothing of how the base is turned.
    let one = table.lines().filter(|line| !line.starts_with("1,10")).collect::<Vec<_>>().join("\n");
    let (shifted, text) = measured(&scratch, &format!("{unit}registration = \"base\"\n"), &one);
    assert!(shifted > 0.01 && text.contains("turned by 0°"), "{shifted} {text}");
    // Too few for a motion: the models are shown, and why there is no distance.
    let (none, text) = measured(&scratch, "registration = \"rigid\"\n", "disk,x,y,z\n4,0,0,0.06\n");
    assert!(none.is_infinite() && text.contains("cannot be moved"), "{text}");
}

/// A column of `cases.csv` for the first model.
fn cell(out: &str, name: &str) -> String {
    let cases = rows(&std::fs::read_to_string(Path::new(out).join("cases.csv")).unwrap());
    let column = cases[0].iter().position(|column| column == name).unwrap();
    cases[1][column].clone()
}

/// Three steps, of which the first and the last were measured at the tip, each moved by a known distance.
#[test]
fn all_steps_with_measurements_count() {
    let scratch = Scratch::new();
    let steps = "[[steps]]\ntension = [\"1 N\"]\n[[steps]]\ntension = [\"3 N\"]\n[[steps]]\ntension = [\"2 N\"]\n";
    let bare = scratch.write("bare.toml", &robot(steps));
    let text = succeed(&["solve", &bare, "--json"]);
    let object: serde_json::Value = serde_json::from_str(&text).unwrap();
    let tip = |step: usize| {
        let tip = &object["steps"][step]["disks"][9]["position"];
        [0, 1, 2].map(|axis| tip[axis].as_f64().unwrap())
    };
    let line = |step: usize, [x, y, z]: [f64; 3]| format!("{},10,{x},{y},{z}\n", step + 1);
    let shifted = |step: usize, shift: f64| {
        let [x, y, z] = tip(step);
        line(step, [x + shift, y, z])
    };
    let compare = |table: &str, lines: &str| {
        scratch.write("tips.csv", &format!("step,disk,x,y,z\n{table}"));
        let measured = format!("{steps}[measured]\ndisks = \"tips.csv\"\n{lines}");
        let file = scratch.write("measured.toml", &robot(&measured));
        let out = scratch.file("report");
        let text = succeed(&["compare", &file, "--out", &out, "--model", "cosserat"]);
        let json = succeed(&["compare", &file, "--out", &out, "--model", "cosserat", "--json"]);
        (text, serde_json::from_str::<serde_json::Value>(&json).unwrap(), out)
    };
    // 7 mm and 1 mm: the root mean square is 5 mm.
    let (text, json, out) = compare(&(shifted(0, 7e-3) + &shifted(2, 1e-3)), "");
    let header = text.lines().next().unwrap();
    assert!(header.contains("to measured  steps  points"), "{text}");
    let row = text.lines().find(|line| line.contains("cosserat")).unwrap();
    assert!(row.contains("5.00      2       2"), "{text}");
    assert!((cell(&out, "rms_to_measured").parse::<f64>().unwrap() - 5e-3).abs() < 1e-8);
    assert_eq!([cell(&out, "measured_steps"), cell(&out, "measured_points")], ["2", "2"]);
    let run = &json["cases"][0]["runs"][0];
    assert!((run["error"]["rms"].as_f64().unwrap() - 5e-3).abs() < 1e-8);
    assert_eq!((&run["error"]["steps"], &run["error"]["points"]), (&2.into(), &2.into()));
    assert_eq!(run["stable"], true);
    let markers = std::fs::read_to_string(Path::new(&out).join("measured-measured.csv")).unwrap();
    assert_eq!(rows(&markers).len(), 3);
    let html = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(html.contains("over those in which the disk was measured"), "{html}");
    // The last step was not measured at all.
    let (text, ..) = compare(&shifted(0, 7e-3), "");
    assert!(text.contains("7.00      1       1"), "{text}");
    // One marker in each of three steps fixes one motion for all of them.
    let elsewhere = |step: usize| {
        let [x, y, z] = tip(step);
        line(step, [0.3 - y, x - 0.1, z + 1.0])
    };
    let all = (0..3).map(elsewhere).collect::<String>();
    let (text, ..) = compare(&all, "registration = \"rigid\"\n");
    assert!(
        text.contains("0.00      3       3") && text.contains("measurement moved by"),
        "{text}"
    );
    // One alone does not, and every cell without a number has its reason.
    let (text, json, out) = compare(&elsewhere(0), "registration = \"rigid\"\n");
    let why = "no distance to the measurement: the measurement cannot be moved: a rigid registration needs 2 points";
    assert!(text.contains(why), "{text}");
    assert!(cell(&out, "not_measured").contains("cannot be moved"));
    assert!(json["cases"][0]["runs"][0]["not_compared"].as_str().unwrap().contains("cannot be"));
    let html = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    assert!(html.contains(why));
    // Nor do markers on the base alone.
    let (text, ..) = compare("1,1,0,0,0\n", "");
    assert!(text.contains("only markers on the base were measured"), "{text}");
}

/// A geometric model gets the lengths of the Cosserat shape in each step, and models are compared over all of them.
#[test]
fn models_are_compared_in_all_steps() {
    let scratch = Scratch::new();
    let out = scratch.file("report");
    let rms = |tensions: &[f64]| {
        let steps: String =
            tensions.iter().map(|t| format!("[[steps]]\ntension = [{t}]\n")).collect();
        let file = scratch.write("steps.toml", &robot(&steps));
        let of = ["--model", "cosserat", "--model", "four-bar"];
        let reference = ["--reference", "cosserat:fine", "--json"];
        let object = json(&[&["compare", &file, "--out", &out][..], &of, &reference].concat());
        let runs = object["cases"][0]["runs"].as_array().unwrap().clone();
        let run = runs.into_iter().find(|run| run["model"] == "four-bar").unwrap();
        let table = rows(&std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap());
        let column = table[0].iter().position(|name| name == "rms_to_first_model").unwrap();
        let row = table.iter().find(|row| row[4] == "cosserat-shape").unwrap();
        (run["error"]["rms"].as_f64().unwrap(), row[column].parse::<f64>().unwrap())
    };
    let (weak, strong, both) = (rms(&[1.0]), rms(&[4.0]), rms(&[1.0, 4.0]));
    let mean = |a: f64, b: f64| (0.5 * (a * a + b * b)).sqrt();
    assert!(strong.0 > 1.5 * weak.0);
    assert!((both.0 / mean(weak.0, strong.0) - 1.0).abs() < 1e-6, "{weak:?} {strong:?} {both:?}");
    assert!((both.1 / mean(weak.1, strong.1) - 1.0).abs() < 1e-6, "{weak:?} {strong:?} {both:?}");
}

/// A folder is the list of its files.
#[test]
fn a_folder_and_its_files_are_the_same() {
    let scratch = Scratch::new();
    let folder = scratch.path().join("cases");
    std::fs::create_dir(&folder).unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).unwrap();
        folder.join(name).display().to_string()
    };
    let rod = robot("");
    let rod = rod.split("[[cables]]").next().unwrap();
    let files = [
        // Extended by the next, and not compared.
        write("a.toml", rod),
        write(
            "b.toml",
            "extends = \"a.toml\"\n[[cables]]\nname = \"pull\"\nholes = [4, 4, 4]\nends_at = \"40 mm\"\ntension = 1\n",
        ),
        // No cables, and nobody extends it.
        write("c.toml", &format!("{rod}[loads]\ntip_force = [0.05, 0, 0]\n")),
    ];
    let model = ["--model", "cosserat", "--model", "cosserat-disks"];
    let out = [scratch.file("from-folder"), scratch.file("from-files")];
    let of_folder = folder.display().to_string();
    succeed(&[&["compare", &of_folder, "--out", &out[0]][..], &model].concat());
    let list: Vec<&str> = files.iter().map(String::as_str).collect();
    let text = succeed(&[&["compare"][..], &list, &["--out", &out[1]], &model].concat());
    assert!(text.contains("a.toml is not compared: it has no cables, and others"), "{text}");
    let cases = |out: &str| {
        let cases = rows(&std::fs::read_to_string(Path::new(out).join("cases.csv")).unwrap());
        cases.into_iter().map(|row| row[1..8].to_vec()).collect::<Vec<_>>()
    };
    assert_eq!(cases(&out[0]), cases(&out[1]));
    assert_eq!(cases(&out[0]).len(), 5);
    // A folder of robots without cables alone.
    std::fs::remove_file(&files[1]).unwrap();
    succeed(&[&["compare", &of_folder, "--out", &out[0]][..], &model].concat());
}

#[test]
fn measurements_are_drawn_where_they_are_moved_to() {
    let scratch = Scratch::new();
    let seen = |name: &str, lines: &str, table: &str| {
        scratch.write(&format!("{name}.csv"), table);
        let text = format!("tension = \"400 gf\"\n[measured]\ndisks = \"{name}.csv\"\n{lines}");
        let file = scratch.write(&format!("{name}.toml"), &robot(&text));
        let svg = scratch.file(&format!("{name}.svg"));
        let text = succeed(&["solve", &file, "--plot", &svg]);
        (text, std::fs::read_to_string(svg).unwrap())
    };
    let here = "disk,x,y,z\n1,0,0,0\n4,0.01,0.02,0.05\n8,0.02,0.06,0.12\n";
    let elsewhere = "disk,x,y,z\n1,1,0,0\n4,1.01,0.02,0.05\n8,1.02,0.06,0.12\n";
    let base = "registration = \"base\"\n";
    let (_, as_it_is) = seen("here", "", here);
    assert_eq!(seen("moved", base, elsewhere).1, as_it_is);
    assert_ne!(seen("elsewhere", "", elsewhere).1, as_it_is);
    let (text, _) = seen("few", "registration = \"rigid\"\n", "disk,x,y,z\n4,0,0,0.06\n");
    assert!(
        text.contains("without what was measured") && text.contains("cannot be moved"),
        "{text}"
    );
}

#[test]
fn markers_between_disks_are_compared_with() {
    let scratch = Scratch::new();
    let bare = scratch.write("bare.toml", &robot("tension = \"400 gf\""));
    let text = succeed(&["solve", &bare, "--stations", "9", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut table = String::from("arc_length,x,y,z\n");
    for k in 1..9 {
        let s = &object["shape"]["arc_length"][k];
        let [x, y, z] =
            [0, 1, 2].map(|axis| object["shape"]["position"][k][axis].as_f64().unwrap());
        table += &format!("{s},{},{y},{z}\n", x + 1e-3);
    }
    let (rms, _) = measured(&scratch, "", &table);
    assert!((rms - 1e-3).abs() < 1e-8, "{rms}");
}

#[test]
fn a_case_that_no_model_solves_has_status_1() {
    let scratch = Scratch::new();
    let good = scratch.write("good.toml", &robot("tension = \"1 N\""));
    let bad = scratch.write("bad.toml", &robot("tension = \"1000 kN\""));
    let out = scratch.file("report");
    let message = fail(1, &["compare", &good, &bad, "--out", &out]);
    assert!(message.contains("bad.toml: no model has an answer"), "{message}");
    assert!(message.contains("cosserat:") && message.contains("four-bar:"), "{message}");
    assert!(message.contains("What the other cases gave is in"), "{message}");
    assert!(Path::new(&out).join("report.html").exists());
    assert!(files(Path::new(&out), "svg").iter().all(|path| !path.ends_with("bad-robot.svg")));
    assert!(!Path::new(&out).join("bad-disks.csv").exists());

    let alone = scratch.file("alone");
    let message = fail(1, &["compare", &bad, "--out", &alone]);
    assert!(!message.contains("other cases"), "{message}");
    assert!(!Path::new(&alone).exists());
}

#[test]
fn bad_input_has_status_2() {
    let scratch = Scratch::new();
    let out = scratch.file("report");
    let empty = scratch.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let message = fail(2, &["compare", empty.to_str().unwrap(), "--out", &out]);
    assert!(message.contains("there is no robot file (.toml) in"), "{message}");
    fail(2, &["compare"]);
    let wrong = scratch.write("wrong.toml", "[backbone]\nlength = \"3 N\"\n");
    let message = fail(2, &["compare", &wrong, "missing.toml", "--out", &out]);
    assert!(message.contains("wrong.toml:2:") && message.contains("missing.toml"), "{message}");
    let file = scratch.write("file", "");
    let message = fail(2, &["compare", "examples/table1", "--out", &file]);
    assert!(message.contains("cannot create"), "{message}");
}

fn json(args: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeed(args)).unwrap()
}

#[test]
fn accuracy_is_told_in_json_and_csv_alike() {
    let scratch = Scratch::new();
    let (out, plot) = (scratch.file("report"), scratch.file("error-over-time.svg"));
    let args = ["compare", "examples/table1/case-3.toml", "--out", &out, "--plot", &plot, "--json"];
    let object = json(&[&args[..], &["--reference", "cosserat:fine"]].concat());
    let case = &object["cases"][0];
    assert_eq!((&case["sections"], &case["length"]), (&9.into(), &0.18.into()));
    assert_eq!(case["reference"]["model"], "cosserat");
    assert!(case["reference"]["uncertainty"].as_f64().unwrap() < 1e-9);
    let of = |model: &str, preset: &str| {
        let runs = case["runs"].as_array().unwrap();
        let run = runs.iter().find(|run| run["model"] == model && run["preset"] == preset);
        run.unwrap().clone()
    };
    let error = |run: &serde_json::Value| run["error"]["rms"].as_f64().unwrap();
    assert!(error(&of("cosserat", "usual")) < 1e-7);
    // What the table has as the distance to the Cosserat model.
    assert!((error(&of("cosserat-disks", "usual")) - 0.97e-3).abs() < 5e-6);
    let four_bar = of("four-bar", "usual");
    assert!((error(&four_bar) - 2.88e-3).abs() < 5e-6);
    assert_eq!(four_bar["commands"], "reference");
    assert!(of("constant-curvature", "usual")["failure"].as_str().unwrap().contains("parallel"));
    let topics: Vec<&str> = object["recommendation"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["topic"].as_str().unwrap())
        .collect();
    let first = ["control", "design", "unknown-material", "many-sections"];
    assert_eq!((&topics[..4], &topics[4..]), (&first[..], &["paper"; 3][..]));
    assert_eq!(object["with_many_sections"][0]["sections"], 100);

    let table = rows(&std::fs::read_to_string(Path::new(&out).join("accuracy.csv")).unwrap());
    let column = |name: &str| table[0].iter().position(|cell| cell == name).unwrap();
    let row = table.iter().find(|row| row[column("model")] == "four-bar").unwrap();
    assert_eq!(row[column("rms")].parse::<f64>().unwrap(), error(&four_bar));
    let svg = std::fs::read_to_string(&plot).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("four-bar, strain energy"));
}

#[test]
fn models_and_references_are_chosen() {
    let scratch = Scratch::new();
    let out = scratch.file("report");
    scratch.write("disks.csv", "disk,x,y,z\n1,0,0,0\n5,0,0.02,0.07\n10,0,0.1,0.13\n");
    let lines = "tension = \"400 gf\"\nshortening = \"5.7 %\"\n[measured]\ndisks = \"disks.csv\"";
    let file = scratch.write("measured.toml", &robot(lines));
    let args = ["compare", &file, "--out", &out, "--json", "--model", "four-bar"];
    let object = json(&args);
    let runs = object["cases"][0]["runs"].as_array().unwrap();
    assert!(runs.iter().all(|run| run["model"] == "four-bar" && run["commands"] == "case"));
    assert_eq!(object["cases"][0]["reference"]["name"], "what was measured");
    // As in the table of all answers.
    let cases = rows(&std::fs::read_to_string(Path::new(&out).join("cases.csv")).unwrap());
    let column = cases[0].iter().position(|name| name == "rms_to_measured").unwrap();
    let rms: f64 = cases[1][column].parse().unwrap();
    assert!((runs[0]["error"]["rms"].as_f64().unwrap() - rms).abs() < 1e-12);

    let object = json(&[&args[..], &["--reference", "cosserat"]].concat());
    assert_eq!(object["cases"][0]["reference"]["name"], "cosserat");
    let bare = scratch.write("bare.toml", &robot("shortening = \"5.7 %\""));
    let text = succeed(&["compare", &bare, "--out", &out, "--reference", "measured"]);
    assert!(text.contains("no reference: measured") && !text.contains("Which model"), "{text}");
    let message = fail(2, &["compare", &bare, "--out", &out, "--reference", "four-bar:fine"]);
    assert!(message.contains("four-bar has no resolution to refine"), "{message}");
    let message = fail(2, &["compare", &bare, "--out", &out, "--plot", &bare]);
    assert!(message.contains("is read: write to another file"), "{message}");
}

/// The rods and the four bars with an energy know contact; the others say so. A robot of 9 sections, bent a little against each obstacle, and one that is
/// free.
#[test]
fn robots_touch_what_is_in_their_way() {
    let scratch = Scratch::new();
    let out = scratch.file("report");
    let args =
        ["compare", "--suite", "routing", "--out", &out, "--json", "--reference", "cosserat"];
    let only = ["straight-100-30", "wall-9-30", "ball-9-30", "pipe-9-30"].map(|of| ["--only", of]);
    let models = ["four-bar", "cosserat-disks", "constant-curvature"].map(|name| ["--model", name]);
    let object = json(&[&args[..], &only.concat(), &models.concat()].concat());
    let cases = object["cases"].as_array().unwrap();
    let burdens: Vec<&str> = cases.iter().map(|c| c["tags"]["burden"].as_str().unwrap()).collect();
    assert_eq!(burdens, ["none", "wall", "ball", "pipe"]);
    let recommendation = object["recommendation"].as_array().unwrap();
    let found = recommendation.iter().find(|finding| finding["topic"] == "obstacles").unwrap();
    assert!(["four-bar", "cosserat-disks"].iter().any(|name| found["model"] == *name), "{found}");
    for case in &cases[1..] {
        for run in case["runs"].as_array().unwrap() {
            if run["preset"] == "strain-energy" || run["model"] == "cosserat-disks" {
                let error = run["error"]["rms"].as_f64().unwrap() / 0.18;
                assert!(error < 0.02, "{}: {error}", case["title"]);
            } else {
                let failure = run["failure"].as_str().unwrap();
                let reason = match run["model"].as_str().unwrap() {
                    "four-bar" => "take the objective strain-energy",
                    _ => "contact forces would bend the arc unevenly",
                };
                assert!(failure.contains(reason), "{failure}");
            }
        }
    }
}

#[test]
fn a_suite_is_listed_written_and_tried() {
    let scratch = Scratch::new();
    let text = succeed(&["compare", "--suite", "routing", "--list"]);
    assert_eq!(text.lines().count(), 2 + 140 + 12);
    let folder = scratch.file("suite");
    let text = succeed(&["compare", "--suite", "routing", "--write", &folder]);
    assert!(text.starts_with("152 robot files"), "{text}");
    let file = format!("{folder}/crossing-9-90-loaded.toml");
    let text = succeed(&["check", &file]);
    assert!(text.contains("crossing, 9 sections, 90°, loaded"), "{text}");

    let out = scratch.file("report");
    let args = ["compare", "--suite", "routing", "--out", &out];
    // The one arc takes the straight cables without a load alone, and takes no time. 9 or 90 of 5 routings and,
    // loaded or not, all of 9 sections: but no obstacle, which takes long.
    let only = ["straight-9", "helical-9", "s-shaped-9", "converging-9", "crossing-9"]
        .map(|name| ["--only", name])
        .concat();
    let chosen = ["--model", "constant-curvature", "--reference", "cosserat"];
    let text = succeed(&[&args[..], &only[..], &chosen[..]].concat());
    let row = text.lines().find(|line| line.starts_with("constant-curvature")).unwrap();
    assert!(row.contains(" 4/40 "), "{text}");
    assert!(text.contains("a cable that does not run parallel"), "{text}");
    let html = std::fs::read_to_string(Path::new(&out).join("report.html")).unwrap();
    for words in
        ["by routing", "by bending", "S-shaped", "Case by case", "<svg", "Material unknown"]
    {
        assert!(html.contains(words), "the report does not say {words}");
    }
    let message = fail(2, &[&args[..], &["--only", "spiral"]].concat());
    assert!(message.contains("no case of the suite has spiral in its name"), "{message}");
    fail(2, &["compare", "examples/table1", "--suite", "routing"]);
    fail(2, &["compare", "examples/table1", "--list"]);
}

#[test]
fn a_report_has_a_small_picture_of_each_case_and_says_how_near_the_models_are() {
    let scratch = Scratch::new();
    let out = scratch.path().join("report");
    let cases = ["examples/table1/case-1.toml", "examples/table1/case-3.toml"];
    succeed(&["compare", cases[0], cases[1], "--out", out.to_str().unwrap()]);
    let html = std::fs::read_to_string(out.join("report.html")).unwrap();
    let multiples = html.split("class=\"multiples\"").nth(1).unwrap();
    let multiples = multiples.split("</ul>").next().unwrap();
    assert_eq!(multiples.matches("<svg").count(), 2);
    assert_eq!(multiples.matches("mm RMS").count(), 2);
    assert!(html.contains("of 2 cases with answers of several models"), "{html}");
    assert!(html.contains("Farthest from the reference is "));
    assert_eq!(html.matches("<section class=\"case\"").count(), 2);
    // Names inside pictures are of one picture each.
    let mut names: Vec<&str> =
        html.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let all = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all);
    assert!(html.len() < 1_000_000, "{}", html.len());
}
