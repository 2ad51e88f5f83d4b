//! Data sets against solves of single rows.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::Field;
use tempfile::tempdir;
use whipcord::{Actuation, Cancel, Model, ModelKind, Solution, Stations};
use whipcord_io::{CaseFile, parse};
use whipcord_sweep::{
    Axis, Output, Plan, Question, RunOptions, Sampling, Summary, SweepError, part_name, run,
};

const ROBOT: &str = r#"
[backbone]
length = "120 mm"
diameter = "1 mm"
young_modulus = "60 GPa"
poisson_ratio = 0.3
[disks]
count = 7
outer_radius = "8 mm"
[[cables]]
name = "a"
routing = { kind = "straight", angle = "0 deg", radius = "6 mm" }
tension = "2 N"
[[cables]]
name = "b"
routing = { kind = "straight", angle = "120 deg", radius = "6 mm" }
tension = "1 N"
"#;

fn file(more: &str) -> CaseFile {
    parse(&format!("{ROBOT}{more}"), "robot.toml").unwrap()
}

fn model(kind: ModelKind) -> Model {
    Model::new(kind, Stations::Disks, Actuation::Natural)
}

fn question(axes: &[&str], sampling: Sampling, outputs: &[Output]) -> Question {
    let axes: Vec<Axis> = axes.iter().map(|axis| axis.parse().unwrap()).collect();
    Question { axes, sampling, outputs: outputs.to_vec(), rows_per_part: Some(4) }
}

fn plan(file: &CaseFile, kind: ModelKind, question: &Question) -> Result<Plan, SweepError> {
    Plan::new(file, &model(kind), question)
}

type Table = Vec<BTreeMap<String, Field>>;

fn read(path: &Path) -> Table {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap();
    rows.map(|row| row.unwrap().into_columns().into_iter().collect()).collect()
}

fn data(folder: &Path, parts: u64) -> Table {
    (0..parts).flat_map(|part| read(&folder.join(part_name(part)))).collect()
}

fn number(row: &BTreeMap<String, Field>, name: &str) -> f64 {
    match row.get(name) {
        Some(Field::Double(value)) => *value,
        other => panic!("{name}: {other:?}"),
    }
}

fn solved(file: &CaseFile, kind: ModelKind) -> Solution {
    let mut prepared = model(kind).prepare(&file.robot, &file.case.loads).unwrap();
    prepared.solve(&file.case, None).unwrap()
}

fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    entries.map(|path| (name(&path), fs::read(&path).unwrap())).collect()
}

#[test]
fn rows_are_those_of_single_solves() {
    let folder = tempdir().unwrap();
    let file = file("");
    let axes =
        ["cables.a.tension=0 N:4 N:3", "loads.tip_force[1]=0,20 mN", "cables[1].tension=1 N,1.5 N"];
    let outputs =
        [Output::Tip, Output::Disks, Output::Tensions, Output::Lengths, Output::Stability];
    let plan =
        plan(&file, ModelKind::Cosserat, &question(&axes, Sampling::Grid, &outputs)).unwrap();
    let summary = run(&plan, folder.path(), &RunOptions::default()).unwrap();
    let expected = Summary { rows: 12, parts: 3, ..Summary::default() };
    assert_eq!(summary, expected);
    let rows = data(folder.path(), 3);
    assert_eq!(rows.len(), 12);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(row["row"], Field::Long(i64::try_from(k).unwrap()));
        assert_eq!(row["stable"], Field::Bool(true));
        assert_eq!(row["error"], Field::Null);
        let a = number(row, "cables.a.tension [N]");
        let b = number(row, "cables[1].tension [N]");
        let force = number(row, "loads.tip_force[1] [mN]");
        let mut file = file.clone();
        file.case.commands[0].tension = Some(a);
        file.case.commands[1].tension = Some(b);
        file.case.loads.tip_force.y = 1e-3 * force;
        let solution = solved(&file, ModelKind::Cosserat);
        let tip = solution.disks.tip();
        let [x, y, z] = tip.position.to_array();
        let near = |name: &str, value: f64| {
            assert!((number(row, name) - value).abs() < 1e-9, "{k} {name}");
        };
        near("tip_x [m]", x);
        near("tip_y [m]", y);
        near("tip_z [m]", z);
        near("tip_qw", tip.rotation.wxyz()[0]);
        near("disk_3_x [m]", solution.disks.poses[3].position.x);
        near("a_tension [N]", a);
        near("b_length [m]", solution.cables[1].length);
    }
}

#[test]
fn numbers_without_units_are_in_si_units_as_in_the_file() {
    let folder = tempdir().unwrap();
    let file = file("[loads]\ntip_force = [\"10 mN\", \"0 N\", \"0 N\"]\n");
    for (k, path) in
        ["cables.a.tension", "cables.a.shortening", "loads.tip_force[1]"].iter().enumerate()
    {
        let axis = format!("{path}=0,0.001");
        let asked = question(&[&axis], Sampling::Grid, &[Output::Tip]);
        let plan = plan(&file, ModelKind::Cosserat, &asked).unwrap();
        let folder = folder.path().join(k.to_string());
        run(&plan, &folder, &RunOptions::default()).unwrap();
        let set = vec![format!("{path}=0.001")];
        if path.ends_with("shortening") {
            let loaded = format!("{ROBOT}[loads]\ntip_force = [0.01, 0, 0]\n");
            let text = loaded.replace("tension = \"2 N\"", "shortening = 0.001");
            let single = parse(&text, "robot.toml").unwrap();
            let tip = solved(&single, ModelKind::Cosserat).disks.tip().position;
            assert!((number(&data(&folder, 1)[1], "tip_x [m]") - tip.x).abs() < 1e-9);
            continue;
        }
        let tip = solved(&file.with_settings(&set).unwrap(), ModelKind::Cosserat).disks.tip();
        let row = &data(&folder, 1)[1];
        assert!((number(row, "tip_x [m]") - tip.position.x).abs() < 1e-9, "{path}");
        assert!((number(row, "tip_y [m]") - tip.position.y).abs() < 1e-9, "{path}");
    }
}

#[test]
fn keys_are_those_of_the_file_with_them() {
    let folder = tempdir().unwrap();
    let file = file("");
    let axes = ["backbone.length=100 mm:140 mm:3", "cables.a.tension=1 N,3 N"];
    for kind in ModelKind::ALL {
        if kind.natural_actuation() != Actuation::Tension {
            continue;
        }
        let folder = folder.path().join(kind.name());
        let plan = plan(&file, kind, &question(&axes, Sampling::Grid, &[Output::Tip])).unwrap();
        run(&plan, &folder, &RunOptions::default()).unwrap();
        for row in data(&folder, 2) {
            let set = [
                format!("backbone.length={} mm", number(&row, "backbone.length [mm]")),
                format!("cables.a.tension={} N", number(&row, "cables.a.tension [N]")),
            ];
            let tip = solved(&file.with_settings(&set).unwrap(), kind).disks.tip().position;
            assert!((number(&row, "tip_x [m]") - tip.x).abs() < 1e-12, "{kind}");
        }
    }
}

#[test]
fn models_that_are_driven_by_lengths_and_motors_are_swept() {
    let folder = tempdir().unwrap();
    let text = file("");
    let of = |kind, axes: &[&str], file: &CaseFile, name: &str| {
        let question = question(axes, Sampling::Grid, &[Output::Tip, Output::Tensions]);
        let plan = plan(file, kind, &question).unwrap();
        let folder = folder.path().join(name);
        let summary = run(&plan, &folder, &RunOptions::default()).unwrap();
        assert_eq!(summary.failed, 0, "{:?}", summary.first_failure);
        data(&folder, plan.parts())
    };
    let lengths = ["cables.a.shortening=0 mm:2 mm:3", "cables.b.shortening=0 %,0.5 %"];
    let rows = of(ModelKind::FourBar, &lengths, &text, "four-bar");
    let mut single = text.clone();
    single.case = whipcord::Case::with_shortenings(&[
        whipcord::Shortening::Length(0.002),
        whipcord::Shortening::Fraction(0.005),
    ]);
    let tip = solved(&single, ModelKind::FourBar).disks.tip().position;
    assert!((number(&rows[5], "tip_x [m]") - tip.x).abs() < 1e-9);
    assert_eq!(rows[5]["a_tension [N]"], Field::Null);
    let motors =
        "[[motors]]\nname = \"m\"\ncables = [\"a\"]\nspool_radius = \"5 mm\"\nangle = \"0 deg\"\n";
    let robot = ROBOT
        .replace("tension = \"2 N\"\n", "")
        .replace("tension = \"1 N\"", "shortening = \"0 mm\"");
    let driven = parse(&format!("{robot}{motors}"), "robot.toml").unwrap();
    let rows = of(ModelKind::Cosserat, &["motors.m.angle=0 deg:20 deg:3"], &driven, "motors");
    let set = driven.with_settings(&["motors.m.angle=20 deg".to_owned()]).unwrap();
    let tip = solved(&set, ModelKind::Cosserat).disks.tip().position;
    assert!(tip.x.abs() > 1e-3 && (number(&rows[2], "tip_x [m]") - tip.x).abs() < 1e-9);
}

#[test]
fn the_jacobian_is_that_of_differences() {
    let folder = tempdir().unwrap();
    let file = file("[loads]\ntip_force = [\"0 N\", \"30 mN\", \"0 N\"]\n");
    let axes = ["cables.a.tension=1.999 N,2 N,2.001 N"];
    let outputs = [Output::Jacobian, Output::Tip];
    let plan =
        plan(&file, ModelKind::CosseratDisks, &question(&axes, Sampling::Grid, &outputs)).unwrap();
    run(&plan, folder.path(), &RunOptions::default()).unwrap();
    let rows = data(folder.path(), 1);
    for c in ["x", "y", "z"] {
        let tip = |row: usize| number(&rows[row], &format!("tip_{c} [m]"));
        let difference = (tip(2) - tip(0)) / 0.002;
        let exact = number(&rows[1], &format!("a_jacobian_{c} [m/N]"));
        assert!(
            (difference - exact).abs() < 1e-5 * (0.01 + exact.abs()),
            "{c}: {difference} {exact}"
        );
    }
}

#[test]
fn shards_and_what_is_resumed_are_the_whole_bit_for_bit() {
    let folder = tempdir().unwrap();
    let file = file("");
    let axes = ["cables.a.tension=0 N:4 N", "cables.b.tension=0 N:4 N"];
    for sampling in [
        Sampling::Random { rows: 26, seed: 1 },
        Sampling::LatinHypercube { rows: 26, seed: 1 },
        Sampling::Sobol { rows: 26, seed: 1 },
    ] {
        let asked = question(&axes, sampling, &[Output::Tip, Output::Stability]);
        let plan = plan(&file, ModelKind::Cosserat, &asked).unwrap();
        let at = |name: &str| folder.path().join(format!("{name}-{}", plan.manifest()["sampling"]));
        run(&plan, &at("whole"), &RunOptions::default()).unwrap();
        for number in 0..3 {
            let options = RunOptions { shard: (number, 3), ..RunOptions::default() };
            run(&plan, &at("shards"), &options).unwrap();
        }
        assert_eq!(bytes(&at("whole")), bytes(&at("shards")));
        // One part is lost, and one was cut off.
        let whole = bytes(&at("whole"));
        fs::remove_file(at("shards").join(part_name(0))).unwrap();
        fs::write(at("shards").join(part_name(3)), &whole[&part_name(3)][..100]).unwrap();
        let again = run(&plan, &at("shards"), &RunOptions::default());
        assert!(matches!(again, Err(SweepError::Begun { .. })));
        let options = RunOptions { resume: true, ..RunOptions::default() };
        assert_eq!(run(&plan, &at("shards"), &options).unwrap().kept, 5);
        assert_eq!(whole, bytes(&at("shards")));
    }
}

#[test]
fn a_row_without_an_answer_says_why() {
    let folder = tempdir().unwrap();
    let file = file("");
    let axes = ["cables.a.tension=1 N,1e5 N"];
    let plan =
        plan(&file, ModelKind::Cosserat, &question(&axes, Sampling::Grid, &[Output::Tip])).unwrap();
    let summary = run(&plan, folder.path(), &RunOptions::default()).unwrap();
    assert_eq!(summary.failed, 1);
    let rows = data(folder.path(), 1);
    assert_eq!(rows[1]["tip_x [m]"], Field::Null);
    assert!(matches!(&rows[1]["error"], Field::Str(why) if !why.is_empty()));
    assert_eq!(summary.first_failure.unwrap().0, 1);
}

#[test]
fn a_table_gives_the_rows() {
    let folder = tempdir().unwrap();
    let file = file("");
    let values = vec![1.0, 2.0, 3.0, 0.5];
    let axes: Vec<Axis> = ["a", "b"]
        .map(|name| Axis {
            path: format!("cables.{name}.tension"),
            unit: "N".to_owned(),
            values: whipcord_sweep::AxisValues::OfTable,
        })
        .to_vec();
    let question = Question {
        axes,
        sampling: Sampling::Table { values },
        outputs: vec![Output::Tensions],
        rows_per_part: None,
    };
    let plan = plan(&file, ModelKind::Cosserat, &question).unwrap();
    run(&plan, folder.path(), &RunOptions::default()).unwrap();
    let rows = data(folder.path(), 1);
    assert_eq!([0, 1].map(|row| number(&rows[row], "b_tension [N]")), [2.0, 0.5]);
}

#[test]
fn a_sweep_that_is_cancelled_is_gone_on_with() {
    let folder = tempdir().unwrap();
    let file = file("");
    let axes = ["cables.a.tension=0 N:4 N:40"];
    let cancel = Cancel::new();
    let model = model(ModelKind::Cosserat).cancelled_by(&cancel);
    let asked = question(&axes, Sampling::Grid, &[Output::Tip]);
    let plan = Plan::new(&file, &model, &asked).unwrap();
    let stop = |done: u64, _| {
        if done >= 12 {
            cancel.cancel();
        }
    };
    let options = RunOptions { progress: Some(&stop), ..RunOptions::default() };
    // Parts that other threads make at that moment may get whole.
    let stopped = run(&plan, folder.path(), &options);
    let done = match stopped {
        Err(SweepError::Stopped { done, rows: 40 }) => done,
        other => panic!("{other:?}"),
    };
    assert!((12..40).contains(&done) && done % 4 == 0, "{done}");
    let plan = self::plan(&file, ModelKind::Cosserat, &asked).unwrap();
    let options = RunOptions { resume: true, ..RunOptions::default() };
    let summary = run(&plan, folder.path(), &options).unwrap();
    assert_eq!((summary.kept, summary.failed), (done / 4, 0));
    assert_eq!(data(folder.path(), 10).len(), 40);
}

#[test]
fn what_cannot_be_swept_says_why() {
    let folder = tempdir().unwrap();
    let whole = file("");
    let new = |file: &CaseFile, kind, axes: &[&str], outputs: &[Output]| {
        plan(file, kind, &question(axes, Sampling::Grid, outputs)).map(|_| ())
    };
    let tip = [Output::Tip];
    let wrong = |axes: &[&str]| match new(&whole, ModelKind::Cosserat, axes, &tip) {
        Err(SweepError::Value { path, reason, .. }) => (path, reason),
        other => panic!("{other:?}"),
    };
    let (path, reason) = wrong(&["cables.a.tension=1 N:2 N:2", "cables.c.tension=1 N:2 N:2"]);
    assert_eq!(path, "cables.c.tension");
    assert!(reason.contains("its entries are"), "{reason}");
    assert!(wrong(&["cables.a.tension=-1 N:2 N:2"]).1.contains("tension"));
    assert!(wrong(&["backbone.length=-1 mm:2 mm:2"]).1.contains("length"));
    assert!(wrong(&["cables.a.tension=1 mm:2 mm:2"]).1.contains("mm"));
    let twice = ["cables.a.tension=1 N,2 N"; 2];
    assert!(matches!(
        new(&whole, ModelKind::Cosserat, &twice, &tip),
        Err(SweepError::Twice { .. })
    ));
    let one = ["cables.a.shortening=1 mm,2 mm"];
    let sampled = Sampling::Sobol { rows: 8, seed: 1 };
    let counted = question(&["cables.a.tension=0 N:1 N:5"], sampled, &tip);
    assert!(matches!(
        plan(&whole, ModelKind::Cosserat, &counted),
        Err(SweepError::Count { count: 5, .. })
    ));
    let jacobian = new(&whole, ModelKind::ConstantCurvature, &one, &[Output::Jacobian]);
    assert!(matches!(jacobian, Err(SweepError::NoJacobian { .. })), "{jacobian:?}");
    let plan = plan(
        &whole,
        ModelKind::Cosserat,
        &question(&["cables.a.tension=1 N,2 N"], Sampling::Grid, &tip),
    )
    .unwrap();
    let shard = RunOptions { shard: (2, 2), ..RunOptions::default() };
    assert!(matches!(run(&plan, folder.path(), &shard), Err(SweepError::Shard { .. })));
    run(&plan, folder.path(), &RunOptions::default()).unwrap();
    let other = self::plan(
        &whole,
        ModelKind::Cosserat,
        &question(&["cables.a.tension=1 N,3 N"], Sampling::Grid, &tip),
    )
    .unwrap();
    let resume = RunOptions { resume: true, ..RunOptions::default() };
    match run(&other, folder.path(), &resume) {
        Err(SweepError::Another { differs, .. }) => assert_eq!(differs, "vary"),
        other => panic!("{other:?}"),
    }
    // A manifest whose text was changed is one of another data set, whatever its hash says.
    let path = folder.path().join(whipcord_sweep::MANIFEST);
    let changed = fs::read_to_string(&path).unwrap().replace("\"rows\": 2", "\"rows\": 3");
    fs::write(&path, changed).unwrap();
    match run(&plan, folder.path(), &resume) {
        Err(SweepError::Another { differs, .. }) => assert_eq!(differs, "rows"),
        other => panic!("{other:?}"),
    }
    fs::write(path, "{").unwrap();
    assert!(matches!(run(&plan, folder.path(), &resume), Err(SweepError::Manifest { .. })));
}
