//! The examples in every format, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use roxmltree::Document;
use whipcord::{Actuation, Model, ModelKind, Stations};
use whipcord_export::{ExportError, Exported, Format, Job, export};
use whipcord_io::CaseFile;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn load(name: &str, settings: &[&str]) -> CaseFile {
    let settings: Vec<String> = settings.iter().map(|set| (*set).to_owned()).collect();
    whipcord_io::load_with(examples().join(name), &settings).unwrap()
}

fn exported(
    file: &CaseFile,
    kind: ModelKind,
    format: Format,
    per_span: Option<usize>,
) -> Result<Exported, ExportError> {
    let model = Model::new(kind, Stations::Disks, Actuation::Natural);
    let (title, robot, case) = (file.title.as_str(), &file.robot, &file.case);
    let job = Job { title, robot, case, model: &model, damping: &file.motion.damping, per_span };
    export(&job, format, "robot")
}

fn text(exported: &Exported, file: usize) -> &str {
    core::str::from_utf8(&exported.files[file].bytes).unwrap()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

fn all_examples() -> Vec<String> {
    let mut names = Vec::new();
    for folder in ["", "table1", "contact", "letter", "motor-log"] {
        for entry in std::fs::read_dir(examples().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                names.push(path.strip_prefix(examples()).unwrap().to_str().unwrap().to_owned());
            }
        }
    }
    names.sort();
    names
}

#[test]
fn every_example_is_exported_or_refused_for_what_it_has() {
    let (mut chains, mut refused) = (0, BTreeSet::new());
    for name in all_examples() {
        let file = load(&name, &[]);
        if file.robot.cables().is_empty() {
            continue;
        }
        let made = exported(&file, ModelKind::Cosserat, Format::Mjcf, Some(1));
        let made = match made {
            Ok(made) => made,
            Err(ExportError::Unsupported { what, .. }) => {
                refused.insert(what);
                continue;
            }
            // Steps of these need what only the table of commands of a real robot gives.
            Err(ExportError::Solve { .. }) if name.contains("released") => continue,
            Err(error) => panic!("{name}: {error}"),
        };
        chains += 1;
        let document = Document::parse(text(&made, 0)).unwrap();
        let all = |tag: &str| document.descendants().filter(|n| n.has_tag_name(tag)).count();
        let objects = 7 * all("freejoint");
        let keys: Vec<_> = document.descendants().filter(|n| n.has_tag_name("key")).collect();
        assert!(keys.len() >= 2, "{name}");
        for key in keys {
            let position = numbers(key.attribute("qpos").unwrap());
            assert_eq!(position.len(), all("joint") + objects, "{name}");
            let controls = key.attribute("ctrl").map_or(0, |controls| numbers(controls).len());
            assert_eq!(controls, all("motor") + all("position"), "{name}");
        }
        let sites: BTreeSet<&str> = document
            .descendants()
            .filter(|n| n.has_tag_name("site"))
            .filter_map(|n| n.attribute("name"))
            .collect();
        let used = document.descendants().filter_map(|n| n.attribute("site"));
        assert!(
            used.clone().count() > 0 && used.into_iter().all(|site| sites.contains(site)),
            "{name}"
        );
    }
    assert!(chains > 12, "{chains}");
    let expected = ["a pipe", "friction of a cable", "friction of the backbone against bending"];
    assert_eq!(refused.into_iter().collect::<Vec<_>>(), expected);
}

#[test]
fn names_are_escaped_or_refused() {
    let name = r#"a"<b>&'c"#;
    let mut file = load("table1/case-3.toml", &[&format!("cables[0].name={name:?}")]);
    file.title = "</robot> & more".to_owned();
    let made = exported(&file, ModelKind::CosseratDisks, Format::Mjcf, None).unwrap();
    let document = Document::parse(text(&made, 0)).unwrap();
    let motor = document.descendants().find(|n| n.has_tag_name("motor")).unwrap();
    assert_eq!([motor.attribute("name"), motor.attribute("tendon")], [Some(name); 2]);
    assert_eq!(document.root_element().attribute("model"), Some("</robot> & more"));
    let urdf = exported(&file, ModelKind::CosseratDisks, Format::Urdf, None).unwrap();
    assert!(Document::parse(text(&urdf, 0)).is_ok());
    let step = exported(&file, ModelKind::CosseratDisks, Format::StepPoints, None).unwrap();
    assert!(text(&step, 0).contains(r#"POLYLINE('cable a"<b>&''c',"#));
    let file = load("table1/case-3.toml", &["cables[0].name=\"a\\u0001\""]);
    let refused = exported(&file, ModelKind::CosseratDisks, Format::Mjcf, None);
    assert_eq!(refused.unwrap_err(), ExportError::Name { name: "a\u{1}".to_owned() });
    assert!(exported(&file, ModelKind::CosseratDisks, Format::Gltf, None).is_ok());
}

#[test]
fn what_the_other_program_cannot_do_is_refused_with_a_remedy() {
    let file = load("table1/case-3.toml", &[]);
    let too_many = exported(&file, ModelKind::CosseratDisks, Format::Mjcf, Some(60)).unwrap_err();
    assert!(matches!(too_many, ExportError::TooManyBodies { given: 540, most: 490, .. }));
    assert!(too_many.to_string().contains("smaller --per-span"));
    let huge = exported(&file, ModelKind::CosseratDisks, Format::Vtk, Some(usize::MAX));
    assert!(matches!(huge, Err(ExportError::TooManyBodies { .. })));
    let without = exported(&file, ModelKind::FourBar, Format::Mjcf, None).unwrap_err();
    assert!(without.to_string().contains("--model cosserat-disks"), "{without}");
    assert!(exported(&file, ModelKind::FourBar, Format::Urdf, None).is_ok());
}

#[test]
fn fields_for_paraview_are_those_of_closed_forms() {
    // Without load and with one cable along the backbone: u = τ r/EI to first order in the stretch.
    let settings = ["cables[0].holes=[4,4,4,4,4,4,4,4,4,4]", "backbone.extensible=false"];
    let file = load("table1/case-3.toml", &settings);
    let made = exported(&file, ModelKind::Cosserat, Format::Vtk, None).unwrap();
    let names: Vec<&str> = made.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(
        names,
        ["robot.pvd", "robot/backbone-1.vtp", "robot/cables-1.vtp", "robot/disks-1.vtp"]
    );
    let index = Document::parse(text(&made, 0)).unwrap();
    let listed = index.descendants().filter_map(|n| n.attribute("file"));
    assert_eq!(listed.collect::<Vec<_>>(), names[1..]);
    let fields = |file: usize| -> BTreeMap<String, Vec<f64>> {
        let document = Document::parse(text(&made, file)).unwrap();
        let arrays = document.descendants().filter(|n| n.has_tag_name("DataArray"));
        arrays
            .map(|n| (n.attribute("Name").unwrap().to_owned(), numbers(n.text().unwrap())))
            .collect()
    };
    let backbone = fields(1);
    let tension = file.case.commands[0].tension.unwrap();
    let bending = 1.1e9 * core::f64::consts::PI * 3e-3_f64.powi(4) / 64.0;
    let expected = tension * 0.008 / bending;
    assert_eq!(backbone["Points"].len(), 3 * 9 * 9);
    for (u, m) in backbone["curvature"].chunks(3).zip(backbone["moment"].chunks(3)) {
        let size = u.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((size / expected - 1.0).abs() < 1e-4, "{size} {expected}");
        let moment = m.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((moment / (bending * size) - 1.0).abs() < 1e-9);
    }
    assert_eq!(backbone["offsets"].last(), Some(&81.0));
    assert!(fields(2)["tension"].iter().all(|t| (t - tension).abs() < 1e-12));
    assert_eq!(fields(3)["Points"].len(), 3 * 36 * 10);
}

#[test]
fn steps_friction_and_contacts_have_their_fields() {
    let file = load("rubbing-finger.toml", &[]);
    let made = exported(&file, ModelKind::CosseratDisks, Format::Vtk, Some(2)).unwrap();
    assert_eq!(made.files.len(), 1 + 4 * 3);
    let cables = made.files.iter().find(|file| file.name.ends_with("cables-2.vtp")).unwrap();
    let document = Document::parse(core::str::from_utf8(&cables.bytes).unwrap()).unwrap();
    let tension = document.descendants().find(|n| n.attribute("Name") == Some("tension")).unwrap();
    let tension = numbers(tension.text().unwrap());
    assert!(tension.windows(2).all(|pair| pair[1] <= pair[0]) && tension[9] < 0.97 * tension[0]);
    let file = load("contact/arm-at-wall.toml", &[]);
    let made = exported(&file, ModelKind::Cosserat, Format::Vtk, Some(2)).unwrap();
    let contacts = made.files.iter().find(|file| file.name.contains("contacts")).unwrap();
    let document = Document::parse(core::str::from_utf8(&contacts.bytes).unwrap()).unwrap();
    let force = document.descendants().find(|n| n.attribute("Name") == Some("force")).unwrap();
    assert!(numbers(force.text().unwrap()).iter().any(|component| component.abs() > 1e-3));
    assert!(made.files.iter().any(|file| file.name.contains("obstacles")));
}

/// The fields of the last file of a part.
fn fields_of(made: &Exported, part: &str) -> BTreeMap<String, Vec<f64>> {
    let file = made.files.iter().rfind(|file| file.name.contains(part)).unwrap();
    let document = Document::parse(core::str::from_utf8(&file.bytes).unwrap()).unwrap();
    let arrays = document.descendants().filter(|n| n.has_tag_name("DataArray"));
    let array = |n: roxmltree::Node<'_, '_>| {
        (n.attribute("Name").unwrap().to_owned(), numbers(n.text().unwrap()))
    };
    arrays.map(array).collect()
}

#[test]
fn the_force_in_a_section_is_what_strains_it_and_turns_its_moment() {
    // Dead, following and distributed loads, weight, and cables that end before the tip.
    let examples: [(&str, &[&str]); 4] = [
        ("two-segment-arm.toml", &["loads.tip_force=[0.1, 0.2, -0.3]"]),
        ("two-segment-arm.toml", &["loads.tip_force=[0.1, 0.2, -0.3]", "loads.follower=true"]),
        ("wall-mounted-arm.toml", &[]),
        ("contact/arm-at-wall.toml", &[]),
    ];
    for (name, settings) in examples {
        let file = load(name, settings);
        let made = exported(&file, ModelKind::CosseratDisks, Format::Vtk, Some(16)).unwrap();
        let of = fields_of(&made, "backbone");
        let vectors = |name: &str| -> Vec<[f64; 3]> {
            of[name].chunks(3).map(|v| [v[0], v[1], v[2]]).collect()
        };
        let (points, moments, forces) = (vectors("Points"), vectors("moment"), vectors("force"));
        // M′ = −p′ × F within a span, by differences; ends of spans have one-sided differences of curvature.
        let (mut checked, mut greatest) = (0, 0.0_f64);
        let scale = moments.iter().flatten().fold(0.0, |most: f64, m| most.max(m.abs()));
        let mut end = 0;
        for offset in &of["offsets"] {
            let (first, last) = (end, *offset as usize);
            end = last;
            for k in first + 3..last.saturating_sub(3) {
                let way: [f64; 3] = core::array::from_fn(|i| points[k + 1][i] - points[k - 1][i]);
                let f = forces[k];
                let turned = [
                    way[1] * f[2] - way[2] * f[1],
                    way[2] * f[0] - way[0] * f[2],
                    way[0] * f[1] - way[1] * f[0],
                ];
                for i in 0..3 {
                    let change = moments[k + 1][i] - moments[k - 1][i];
                    greatest = greatest.max((change + turned[i]).abs());
                    checked += 1;
                }
            }
        }
        assert!(checked > 100 && greatest < 1e-3 * scale, "{name} {settings:?} {greatest} {scale}");
    }
}

#[test]
fn steps_under_other_loads_have_keyframes() {
    let mut file = load("three-cable-segment.toml", &["loads.tip_force=[0.2, 0, 0]"]);
    let half = file.case.loads.tip_force * 0.5;
    let lighter = whipcord::Loads { tip_force: half, ..file.case.loads.clone() };
    file.case.before = vec![file.case.commands.clone()];
    file.case.loads_before = vec![lighter];
    let made = exported(&file, ModelKind::CosseratDisks, Format::Mjcf, None).unwrap();
    let document = Document::parse(core::str::from_utf8(&made.files[0].bytes).unwrap()).unwrap();
    let keys = document.descendants().filter(|n| n.has_tag_name("key"));
    let last = |n: roxmltree::Node<'_, '_>| *numbers(n.attribute("ctrl").unwrap()).last().unwrap();
    assert_eq!(keys.map(last).collect::<Vec<_>>(), [0.0, 0.5, 1.0]);
}

#[test]
fn obstacles_are_drawn_where_they_are() {
    let file = load("contact/gripping-finger.toml", &[]);
    let count = file.case.obstacles.len();
    assert!(count > 0);
    let vtk = exported(&file, ModelKind::Cosserat, Format::Vtk, Some(2)).unwrap();
    let numbered = &fields_of(&vtk, "obstacles")["obstacle"];
    assert_eq!(numbered.last(), Some(&(count as f64)));
    let gltf = exported(&file, ModelKind::Cosserat, Format::Gltf, Some(2)).unwrap();
    let step = exported(&file, ModelKind::Cosserat, Format::StepPoints, Some(2)).unwrap();
    for obstacle in &file.case.obstacles {
        let name = format!("obstacle {}", obstacle.name);
        let json = String::from_utf8_lossy(&gltf.files[0].bytes);
        assert!(json.contains(&format!("\"name\":\"{name}\"")), "{name}");
        assert!(text(&step, 0).contains(&format!("POLYLINE('{name}'")), "{name}");
    }
}

#[test]
fn meshes_have_names_metres_and_the_z_axis_upwards() {
    let file = load("two-segment-arm.toml", &[]);
    let made = exported(&file, ModelKind::Cosserat, Format::Gltf, None).unwrap();
    let bytes = &made.files[0].bytes;
    let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], number(8)), (&b"glTF"[..], bytes.len()));
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + number(12)]).unwrap();
    let nodes = json["nodes"].as_array().unwrap();
    let names: Vec<&str> = nodes.iter().map(|node| node["name"].as_str().unwrap()).collect();
    assert_eq!(names.len(), 1 + 15 + 6 + 1);
    assert_eq!(
        [names[0], names[1], names[16], names[22]],
        ["backbone", "disk 1", "cable upper-1", "Two-segment arm"]
    );
    assert_eq!(json["scenes"][0]["nodes"][0], 22);
    // The mesh of the backbone reaches from the base to the tip along z, which the node above turns to y.
    let greatest = json["accessors"][0]["max"][2].as_f64().unwrap();
    assert!((0.2..0.31).contains(&greatest), "{greatest}");
    assert_eq!(nodes[22]["rotation"].as_array().unwrap().len(), 4);
    assert_eq!(json["buffers"][0]["byteLength"], number(20 + number(12)));
}

#[test]
fn curves_for_cad_are_in_millimetres_and_refer_to_what_there_is() {
    let file = load("three-cable-segment.toml", &[]);
    for (kind, splines, polylines) in
        [(ModelKind::Cosserat, 4, 0), (ModelKind::CosseratDisks, 1, 3)]
    {
        let made = exported(&file, kind, Format::StepPoints, None).unwrap();
        let text = text(&made, 0);
        let entities: BTreeMap<&str, &str> = text
            .lines()
            .filter(|line| line.starts_with('#'))
            .map(|line| line.split_once('=').unwrap())
            .collect();
        for (number, entity) in &entities {
            for reference in entity.split(['(', ')', ',']).filter(|part| part.starts_with('#')) {
                assert!(entities.contains_key(reference), "{number} refers to {reference}");
            }
        }
        let count =
            |name: &str| entities.values().filter(|entity| entity.starts_with(name)).count();
        assert_eq!(
            [count("B_SPLINE"), count("POLYLINE"), count("CIRCLE")],
            [splines, polylines, 11]
        );
        let model = Model::new(kind, Stations::Disks, Actuation::Natural);
        let mut prepared = model.prepare(&file.robot, &file.case.loads).unwrap();
        let tip = prepared.solve(&file.case, None).unwrap().disks.tip().position * 1e3;
        let points: Vec<Vec<f64>> = entities
            .values()
            .filter_map(|entity| entity.strip_prefix("CARTESIAN_POINT('disk 11',("))
            .map(|entity| {
                entity.trim_end_matches("));").split(',').map(|c| c.parse().unwrap()).collect()
            })
            .collect();
        for (found, expected) in points[0].iter().zip(tip.to_array()) {
            assert!((found - expected).abs() < 1e-3, "{found} {expected}");
        }
    }
}

#[test]
fn joint_angles_belong_to_the_joints_and_shapes_come_near() {
    let file = load("hysteresis-loop.toml", &[]);
    let made = exported(&file, ModelKind::Cosserat, Format::Urdf, Some(4)).unwrap();
    let document = Document::parse(text(&made, 0)).unwrap();
    let joints = document.descendants().filter(|n| n.attribute("type") == Some("revolute"));
    let names: BTreeSet<&str> = joints.filter_map(|n| n.attribute("name")).collect();
    let angles: serde_json::Value = serde_json::from_str(text(&made, 1)).unwrap();
    assert_eq!(angles["steps"].as_array().unwrap().len(), 9);
    for step in angles["steps"].as_array().unwrap() {
        let keys: BTreeSet<&str> =
            step["joints"].as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, names);
        assert!(step["greatest_distance"].as_f64().unwrap() < 1e-3);
    }
}
