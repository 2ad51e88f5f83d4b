#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;

use whipcord::ModelKind;

use crate::protocol::{Marker, Sight};

use super::*;

fn example(name: &str) -> Arc<CaseFile> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    Arc::new(load(path).unwrap())
}

/// A page without anything in it, whose script is as long as that of the viewer is at most.
fn bare() -> Page {
    let script: &str = " ".repeat(1_200_000).leak();
    let html = "<html><head><script></script><link rel=\"stylesheet\"></head><body></body></html>";
    Page { html, script, style: "" }
}

fn bytes(base64: &str) -> Vec<u8> {
    use base64::Engine as _;
    base64::engine::general_purpose::STANDARD.decode(base64).unwrap()
}

fn floats(base64: &str) -> Vec<f64> {
    let all = bytes(base64);
    all.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap()).into()).collect()
}

/// Where a frame has the tip, and the lengths of its cables.
fn decoded(recording: &Recording, frame: usize) -> (Vec3, Vec<f64>) {
    let (Recording { scene, models, .. }, recorded) = (recording, &recording.models[0]);
    let strains = bytes(&models[0].strains);
    let lengths: Vec<f64> = scene.stations.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let pieces = (0..lengths.len()).map(|piece| {
        let at = 12 * (frame * lengths.len() + piece);
        let [x, y, z, a, b, c]: [f64; 6] = core::array::from_fn(|k| {
            let two = [strains[at + 2 * k], strains[at + 2 * k + 1]];
            f64::from(i16::from_le_bytes(two)) * recorded.scales[k]
        });
        Twist { linear: Vec3::new(x, y, 1.0 + z), angular: Vec3::new(a, b, c) }
    });
    let base = whipcord::Pose { position: scene.base.position.into(), ..Default::default() };
    let tip = Shape::of_strains(base, &pieces.collect::<Vec<_>>(), &lengths).tip();
    let count = scene.cables.len();
    let cables = floats(&recorded.cables)[3 * count * frame..3 * count * (frame + 1)].to_vec();
    (tip.position, cables.chunks(3).map(|cable| cable[1]).collect())
}

/// Whether frames are what a model says without the grid.
fn assert_holds_answers(file: &Arc<CaseFile>, recording: &Recording, preset: ModelPreset) {
    let Recording { scene, axes, models, .. } = recording;
    assert_eq!(models[0].model, preset.name());
    let frames = axes.iter().map(Vec::len).product::<usize>() + 1;
    let valid = bytes(&models[0].valid);
    assert_eq!(valid.len(), frames);
    assert_eq!(valid.iter().filter(|&&valid| valid == 1).count(), models[0].solved);
    let solved: Vec<usize> = (0..frames).filter(|&frame| valid[frame] == 1).collect();
    let [first, .., before, last] = solved[..] else { panic!("{solved:?}") };
    let unsolved = (0..frames).find(|&frame| valid[frame] == 0);
    for frame in [first, solved[solved.len() / 3], before, last].into_iter().chain(unsolved) {
        // Where the last cable changes from frame to frame, and the last frame is that of the file.
        let mut rest = frame;
        let mut commands = scene.initial.commands.clone();
        if frame < frames - 1 {
            for (command, axis) in commands.iter_mut().zip(axes).rev() {
                let value = axis[rest % axis.len()];
                rest /= axis.len();
                *command = command.with_value(value);
            }
        }
        let expected = solve(&mut Bench::new(Arc::clone(file)), scene, preset, commands);
        assert_eq!(expected.is_some(), valid[frame] == 1);
        let Some(expected) = expected else { continue };
        let (tip, lengths) = decoded(recording, frame);
        assert!((tip - expected.shape.tip().position).norm() < 1e-4 * scene.length, "{frame}");
        for (length, cable) in lengths.iter().zip(&expected.cables) {
            assert!((length - cable.length).abs() < 1e-6 * scene.length, "{frame}");
        }
    }
}

#[test]
fn a_robot_with_six_cables_fits_in_a_page() {
    let cable = |k: usize| {
        let (angle, radius) = (60 * k, [9, 7][k % 2]);
        format!(
            "[[cables]]\nname = \"{k}\"\nshortening = \"0 mm\"\n\
             routing = {{ kind = \"straight\", angle = \"{angle} deg\", radius = \"{radius} mm\" }}\n"
        )
    };
    let cables: String = (0..6).map(cable).collect();
    let text = format!("[backbone]\nlength = \"200 mm\"\n[disks]\ncount = 3\n{cables}");
    let file = Arc::new(whipcord_io::parse(&text, "six.toml").unwrap());
    // Most lengths that six cables could be told contradict each other.
    let preset = ModelPreset::usual(ModelKind::FourBar);
    let recording = record(&file, &[preset], None, drop).unwrap();
    assert_eq!(recording.axes.iter().map(Vec::len).collect::<Vec<_>>(), [4; 6]);
    assert_holds_answers(&file, &recording, preset);
    assert!(written(bare(), &recording).unwrap().len() < MOST_BYTES);
}

#[test]
fn cables_that_are_shortened_are_recorded_so() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/table1/case-3.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("\ntension", "\n# tension");
    let file = Arc::new(whipcord_io::parse(&text, &path).unwrap());
    assert!(matches!(scene(&file).initial.commands[..], [Command::Shortening(_)]));
    let preset = ModelPreset::usual(ModelKind::Cosserat);
    let recording = record(&file, &[], None, drop).unwrap();
    let (axis, reach) = (&recording.axes[0], recording.scene.ranges.shortening);
    assert_eq!((axis[0], axis[axis.len() - 1]), (-reach, reach));
    assert_holds_answers(&file, &recording, preset);
}

#[test]
fn touches_are_those_of_the_frames() {
    let file = example("contact/rubbing-wall.toml");
    let scene = scene(&file);
    let preset: ModelPreset = scene.initial.models[0].parse().unwrap();
    let touching = solve(&mut Bench::new(file), &scene, preset, scene.initial.commands.clone());
    let all = [None, touching.clone(), touching];
    let expected = &all[1].as_ref().unwrap().contacts;
    assert!(!expected.is_empty() && expected.iter().all(|touch| touch.friction.is_some()));
    assert!(expected.iter().any(|touch| touch.friction.unwrap().norm() > 1e-3));
    let (counts, packed) = contacts(&all);
    assert_eq!(counts, [0, expected.len() as u8, expected.len() as u8]);
    assert_eq!(packed.len(), 2 * expected.len() * 13 * 4);
    let numbers = floats(&base64(&packed));
    for (numbers, touch) in numbers.chunks(13).zip(expected.iter().chain(expected)) {
        let vectors = [touch.point, touch.normal].map(Vec3::to_array).concat();
        let friction = touch.friction.unwrap().to_array();
        let sticks = if touch.sticks { 1.0 } else { 0.0 };
        let own =
            [&[touch.obstacle as f64, touch.arc_length][..], &vectors, &[touch.force.unwrap()]];
        let own = [&own.concat()[..], &friction, &[sticks]].concat();
        for (found, own) in numbers.iter().zip(&own) {
            assert!((found - own).abs() <= 1e-6 * own.abs(), "{numbers:?} {own:?}");
        }
    }
}

#[test]
fn movable_objects_are_where_the_frames_have_them() {
    let file = example("contact/ball-against-wall.toml");
    let scene = scene(&file);
    let preset: ModelPreset = scene.initial.models[0].parse().unwrap();
    let solved = solve(&mut Bench::new(file), &scene, preset, scene.initial.commands.clone());
    let solved = solved.unwrap();
    let (numbers, packed) = objects(&scene, &[None, Some(solved.clone())]);
    let expected: Vec<usize> = solved.objects.iter().map(|object| object.obstacle).collect();
    assert!(!numbers.is_empty() && numbers == expected);
    let packed = floats(&base64(&packed));
    let (at_rest, moved) = packed.split_at(7 * numbers.len());
    for (k, object) in solved.objects.iter().enumerate() {
        let placed = [scene.obstacles[numbers[k]].pose, pose(&object.pose)];
        for (found, placed) in [at_rest, moved].into_iter().zip(placed) {
            let own = placed.position.iter().chain(&placed.orientation);
            assert!(found[7 * k..].iter().zip(own).all(|(found, own)| (found - own).abs() < 1e-6));
        }
    }
}

#[test]
fn what_is_too_large_for_a_page_is_refused() {
    let file = example("table1/case-3.toml");
    let mut recording =
        record(&file, &[ModelPreset::usual(ModelKind::FourBar)], None, drop).unwrap();
    written(bare(), &recording).unwrap();
    let seen = Sight::Position { position: [1.0 / 3.0; 3] };
    let marker = Marker { seen, arc_length: None, offset: [0.0; 3] };
    recording.scene.measured = vec![vec![marker; 100_000]];
    match written(bare(), &recording).unwrap_err() {
        ViewError::TooLarge { bytes, most: 5_000_000 } => assert!(bytes > 5_000_000, "{bytes}"),
        other => panic!("{other}"),
    }
}

#[test]
fn frames_say_how_far_what_lies_between_them_is_off() {
    let file = example("table1/case-3.toml");
    let mut told = Vec::new();
    let recording = record(&file, &[], None, |progress| told.push(progress)).unwrap();
    let recorded = &recording.models[0];
    assert_eq!((recorded.model.as_str(), recording.axes.len()), ("cosserat", 1));
    assert_eq!(recorded.solved, recording.axes[0].len() + 1);
    assert_eq!(recorded.trials.count, TRIALS);
    // Whoever waits for it hears of each solve.
    let all = recorded.solved + TRIALS;
    assert_eq!(told.iter().map(|t| t.done).collect::<Vec<_>>(), (1..=all).collect::<Vec<_>>());
    assert!(told.iter().all(|progress| progress.all == all));
    // One cable, without loads: its strains are smooth in its tension, and there are many frames.
    let length = file.robot.backbone().length;
    assert!(recorded.trials.greatest < 2e-3 * length, "{:?}", recorded.trials);
    assert!(recorded.trials.median <= recorded.trials.greatest && recorded.trials.median > 0.0);
}

#[test]
fn a_model_that_does_not_take_the_robot_is_refused() {
    let error = record(
        &example("two-segment-arm.toml"),
        &[ModelPreset::usual(ModelKind::ConstantCurvature)],
        None,
        drop,
    )
    .unwrap_err();
    assert!(error.to_string().contains("constant-curvature"), "{error}");
}

#[test]
fn a_model_that_is_named_twice_is_exported_once() {
    let names = [ModelKind::FourBar, ModelKind::Cosserat, ModelKind::FourBar];
    let file = example("table1/case-3.toml");
    let recording = record(&file, &names.map(ModelPreset::usual), None, drop).unwrap();
    let models: Vec<_> = recording.models.iter().map(|one| one.model.as_str()).collect();
    assert_eq!(models, ["four-bar", "cosserat"]);
    assert_eq!(recording.scene.initial.models, models);
}

#[test]
fn one_page_has_all_inside_and_nothing_ends_early() {
    let page = Page {
        html: "<html><head><script type=\"module\" src=\"./viewer.js\"></script><link rel=\"stylesheet\" crossorigin href=\"./viewer.css\"></head><body></body></html>",
        script: "const a = '</script>';",
        style: "p { margin: 0 }",
    };
    let text = one_page(page, "{\"title\":\"</script><b>\"}").unwrap();
    assert!(!text.contains("src=") && !text.contains("href="));
    assert_eq!(text.matches("</script").count(), 2);
    assert!(text.contains("<style>p { margin: 0 }</style>"));
    assert!(text.contains("\\u003c/script>\\u003cb>"));
    for (part, what) in
        [("<head>", "<head>"), ("</body>", "</body>"), ("<link", "<link rel=\"stylesheet\"")]
    {
        let html = String::from(page.html).replace(part, "").leak();
        let error = one_page(Page { html, ..page }, "{}").unwrap_err();
        assert!(matches!(error, ViewError::OtherPage { what: found } if found == what), "{error}");
    }
}

#[test]
fn motors_are_recorded_where_they_move() {
    let cable = |name: &str, angle: u32| {
        format!(
            "[[cables]]\nname = \"{name}\"\n\
             routing = {{ kind = \"straight\", angle = \"{angle} deg\", radius = \"8 mm\" }}\n"
        )
    };
    let text = format!(
        "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\nyoung_modulus = \"1.1 GPa\"\n\
         poisson_ratio = 0.3\n[disks]\ncount = 5\n{}{}{}tension = \"1 N\"\n\
         [[motors]]\nname = \"bend\"\ncables = [\"left\", \"-right\"]\nspool_radius = \"10 mm\"\n\
         stiffness = \"5 N/mm\"\npretension = \"4 N\"\nangle_limits = [\"-60 deg\", \"60 deg\"]\n\
         angle = \"30 deg\"\n",
        cable("left", 0),
        cable("right", 180),
        cable("side", 90),
    );
    let file = Arc::new(whipcord_io::parse(&text, "motor.toml").unwrap());
    let recording = record(&file, &[], None, drop).unwrap();
    assert!(matches!(
        recording.scene.initial.commands[..],
        [Command::Motor(_), Command::Tension(_)]
    ));
    let (axis, sixty) = (&recording.axes[0], core::f64::consts::FRAC_PI_3);
    assert!((axis[0] + sixty).abs() < 1e-12 && (axis[axis.len() - 1] - sixty).abs() < 1e-12);
    assert_holds_answers(&file, &recording, ModelPreset::usual(ModelKind::Cosserat));
    // A command for another kind of slider is refused.
    let mut request = recording.scene.initial.clone();
    request.commands.swap(0, 1);
    assert!(Bench::new(file).case(&request).is_err());
}
