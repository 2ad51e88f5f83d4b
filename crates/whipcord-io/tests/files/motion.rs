//! Motions, read and written.

use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_io::{
    CableCourse, CaseFile, Motion, describe, describe_motion, load, motion_json, parse, toml,
};
use whipcord_motion::{
    BaseMotion, CableDrive, Course, Damping, Drag, Initial, Method, MotionOptions, Simulation,
};

const BACKBONE: &str = "[backbone]\nlength = \"180 mm\"\ndiameter = \"3 mm\"\n";
const REST: &str = "[disks]\ncount = 10\nhole_circle_radius = \"8 mm\"\nholes = 12\n[[cables]]\nname = \"left\"\nholes = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\ntension = \"3 N\"\n[[cables]]\nname = \"right\"\nholes = [7, 7, 7, 7, 7, 7, 7, 7, 7, 7]\n[[motors]]\nname = \"bend\"\ncables = [\"right\"]\nspool_radius = \"10 mm\"\n";
const MOTION: &str = "[motion]\nduration = \"2 s\"\n";

fn robot(damping: &str, tail: &str) -> String {
    format!("{BACKBONE}{damping}{REST}{tail}")
}

fn read(text: &str) -> CaseFile {
    parse(text, "robot.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(tail: &str) -> String {
    match parse(&robot("", tail), "robot.toml") {
        Err(error) => error.to_string(),
        Ok(_) => panic!("taken: {tail}"),
    }
}

fn table(times: &[f64], values: &[f64]) -> Course {
    Course::table(times.to_vec(), values.to_vec()).unwrap()
}

#[test]
fn a_motion_is_read_in_si() {
    let tail = "[motion]\nduration = \"2 s\"\nstep = \"5 ms\"\nmethod = \"robust\"\ntolerance = \"0.1 mm\"\ninitial = \"rest\"\noutput = { every = \"20 ms\" }\n\
                [[motion.commands]]\ncable = \"left\"\ntension = [[0, \"4 N\"], [\"10 ms\", 0], [\"10 ms\", \"500 mN\"]]\n\
                [[motion.commands]]\nmotor = \"bend\"\nangle = [[0, 0], [\"1 s\", \"180 deg\"]]\n\
                [[motion.loads]]\ntip_force = [0, \"50 mN\", 0]\nfactor = [[0, 1], [\"1 s\", 1], [\"1 s\", 0]]\n";
    let file = read(&robot("damping = { time = \"3.5 ms\" }\n", tail));
    let motion = &file.motion;
    assert_eq!((motion.duration, motion.step), (Some(2.0), Some(0.005)));
    assert_eq!((motion.every, motion.tolerance), (Some(0.02), Some(1e-4)));
    assert_eq!(
        (motion.method, motion.initial.clone()),
        (Some(Method::Robust), Some(Initial::Rest))
    );
    assert_eq!(motion.damping, Damping::Time(3.5e-3));
    let tension = table(&[0.0, 0.01, 0.01], &[4.0, 0.0, 0.5]);
    assert_eq!(motion.cables, [(0, CableCourse::Tension(tension))]);
    assert_eq!(motion.motors, [(0, table(&[0.0, 1.0], &[0.0, core::f64::consts::PI]))]);
    assert_eq!(motion.loads[0].loads.tip_force, Vec3::new(0.0, 0.05, 0.0));
    assert_eq!(motion.loads[0].factor, table(&[0.0, 1.0, 1.0], &[1.0, 1.0, 0.0]));
    assert_eq!(motion.rows(), Some((0.02, 4, 100)));
    let options = motion.options();
    assert_eq!((options.method, options.loads.len()), (Method::Robust, 1));
}

#[test]
fn what_is_not_told_over_time_is_that_of_the_case() {
    let file = read(&robot("", MOTION));
    let commands = file.motion.commands(&file.robot, &file.case);
    assert_eq!(commands.cables[0], CableDrive::Tension(Course::constant(3.0)));
    assert_eq!(file.motion.rows(), Some((0.01, 1, 200)));
    assert_eq!(read(&robot("", "")).motion, Motion::default());
    let told =
        "[[motion.commands]]\ncable = \"right\"\nshortening = [[0, \"0 %\"], [1, \"10 %\"]]\n";
    let file = read(&robot("", &format!("{MOTION}{told}")));
    let commands = file.motion.commands(&file.robot, &file.case);
    let by = 0.1 * file.robot.cable_length(1);
    assert_eq!(commands.cables[1], CableDrive::Shortening(table(&[0.0, 1.0], &[0.0, by])));
    assert_eq!(commands.cables[0], CableDrive::Tension(Course::constant(3.0)));
}

#[test]
fn rows_cover_the_duration() {
    let of = |lines: &str| read(&robot("", &format!("[motion]\n{lines}"))).motion.rows().unwrap();
    // Steps of 10 ms that end at the end of 25 ms, and shorter ones that end at the times of the output.
    let (every, steps, rows) = of("duration = 0.025\n");
    assert!((every * 3.0 - 0.025).abs() < 1e-15 && (steps, rows) == (1, 3));
    assert_eq!(of("duration = 1\noutput = { every = 0.025 }\n"), (0.025, 3, 40));
    assert_eq!(of("duration = 0.3\nstep = 0.1\n").2, 3);
}

#[test]
fn what_is_written_is_read_as_the_same() {
    let tails = [
        "",
        "[motion]\nduration = 2\nstep = 0.005\nmethod = \"energy\"\ninitial = \"rest\"\ntolerance = 1e-4\noutput = { every = 0.1 }\n",
        "[motion]\nduration = 2\n[[motion.commands]]\ncable = \"left\"\ntension = 2\n[[motion.commands]]\ncable = \"right\"\nshortening = [[0, \"1 %\"], [1, \"-3 %\"]]\n",
        "[motion]\nduration = 2\n[[motion.commands]]\ncable = \"left\"\nshortening = [[0, 0], [1, \"3 mm\"]]\n[[motion.commands]]\nmotor = \"bend\"\nangle = [[0, 0], [1, 2]]\n[[motion.loads]]\nfactor = [[0, 1], [0, 0]]\nfollower = true\ngravity = [0, 0, -9.81]\ntip_moment = [0, 0, 1e-3]\n[[motion.loads.point]]\nat = 0.09\nforce = [0, 0.1, 0]\n",
        "[motion]\nduration = 2\nelements = 12\ndrag = { across = \"500 mN*s/m^2\" }\n[motion.base]\nvelocity = [0, \"1 cm/s\", [[0, 0], [\"0.5 s\", \"20 mm/s\"]]]\nangular_velocity = [0, \"90 deg/s\", 0]\n",
        "[motion]\nduration = 2\nmodel = \"cosserat-disks\"\n[motion.base]\nfree = true\n",
        "[motion]\nduration = 2\n[motion.initial]\nstrains = [[0, 0, 1, 0, 0.5, 0]]\nvelocities = [[0, 0, 0, 0, 0, 0], [0, 0.25, 0, 0, 0, 0]]\ntensions = [1, 2]\nmotor_outputs = [0.1]\n",
        "[motion]\nduration = 2\n[motion.initial]\nstrains = [[0, 0, 1, 0, 0.5, 0]]\nvelocities = [[0, 0, 0, 0, 0, 0], [0, 0.25, 0, 0, 0, 0]]\npassage_tensions = [[1, 0.5], [2, 2]]\nlengths_beyond = [[0.18, 0.09], [0.17, 0.085]]\n[motion.initial.rates]\nvelocities = [[0, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0]]\nstrains = [[0, 0, 0, 0, 2, 0]]\nmotors = [[1, 2, 3]]\nstep = 0.01\ncommands = [0.5, 1]\nloads = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -9.81]\n",
    ];
    let dampings = [
        "",
        "damping = { time = 0.002 }\n",
        "damping = { matrix = [[5, 0, 0, 0, 0, 0], [0, 5, 0, 0, 0, 0], [0, 0, 9, 0, 0, 0], [0, 0, 0, 1e-5, 0, 0], [0, 0, 0, 0, 1e-5, 0], [0, 0, 0, 0, 0, 8e-6]] }\n",
    ];
    for (tail, damping) in tails.iter().flat_map(|tail| dampings.map(|damping| (tail, damping))) {
        let file = read(&robot(damping, tail));
        let mut table = describe(None, &file.robot, &file.case).unwrap();
        describe_motion(&file.motion, &file.robot, &mut table).unwrap();
        let text = toml(&table);
        assert_eq!(read(&text).motion, file.motion, "{text}");
    }
}

#[test]
fn commands_are_read_from_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("commands.csv", "t [ms],left [N],bend [deg]\n0,4,0\n0,0,0\n500,0,90\n");
    let named = format!("{MOTION}[[motion.commands]]\ncsv = \"commands.csv\"\n");
    write("robot.toml", &robot("", &named));
    let path = folder.path().join("robot.toml");
    let file = load(&path).unwrap();
    let times = [0.0, 0.0, 0.5];
    let tension = CableCourse::Tension(table(&times, &[4.0, 0.0, 0.0]));
    assert_eq!(file.motion.cables, [(0, tension)]);
    assert_eq!(file.motion.motors, [(0, table(&times, &[0.0, 0.0, core::f64::consts::FRAC_PI_2]))]);
    // Written for another folder, it names the same file.
    let below = folder.path().join("below");
    std::fs::create_dir(&below).unwrap();
    let text = file.with_numbers_of(&file.robot, &file.case, Vec3::ZERO, &below).unwrap();
    assert!(text.keeps_text && text.text.contains("csv = \"../commands.csv\""), "{}", text.text);
    for (text, message) in [
        ("left [N]\n1\n", "there is no column t"),
        ("t\n1\n", "no column of a cable or motor"),
        ("t,middle [N]\n0,1\n", "no cable or motor `middle`"),
        ("t,left\n0,1\n", "the column `left` has no unit"),
        ("t,bend [mm]\n0,1\n", "`mm` is no unit of an angle"),
        ("t,left [N]\n1,1\n0,1\n", "has a time before that of the row above"),
        ("t,left [N]\n0,-1\n", "must not be negative"),
        ("t,left [N]\n0,much\n", "`much` is not a finite number"),
    ] {
        write("commands.csv", text);
        let error = load(&path).unwrap_err().to_string();
        assert!(error.contains(message), "{text}{error}");
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let command = |lines: &str| format!("{MOTION}[[motion.commands]]\n{lines}\n");
    for (tail, message) in [
        ("[motion]\nstep = 0.01\n".to_owned(), "duration"),
        ("[motion]\nduration = 0\n".to_owned(), "must be greater than zero"),
        ("[motion]\nduration = \"1 h\"\nstep = \"1 us\"\n".to_owned(), "ten million steps at most"),
        (command("cable = \"middle\"\ntension = 1"), "there is no cable `middle`"),
        (command("motor = \"left\"\nangle = 1"), "there is no motor `left`"),
        (command("cable = \"left\""), "tension"),
        (command("cable = \"left\"\nangle = 1"), "motor"),
        (command("motor = \"bend\"\ntravel = 1"), "has no `travel`"),
        (command("cable = \"left\"\ntension = -1"), "must not be negative"),
        (command("cable = \"left\"\ntension = [[0, -1]]"), "must not be negative"),
        (command("cable = \"left\"\ntension = [[-1, 1]]"), "must not be negative"),
        (command("cable = \"left\"\ntension = [[\"1 N\", \"1 s\"]]"), "must be a time"),
        (command("cable = \"left\"\ntension = [[0, \"1 s\"]]"), "is a time"),
        (command("cable = \"left\"\ntension = [[0, \"1 mm\"]]"), "mm"),
        (command("cable = \"left\"\ntension = [[1, 1], [0, 1]]"), "order of their times"),
        (command("cable = \"left\"\nshortening = [[0, \"1 mm\"], [1, \"1 %\"]]"), "in one list"),
        (
            command(
                "cable = \"left\"\ntension = 1\n[[motion.commands]]\ncable = \"left\"\nshortening = 0",
            ),
            "two commands over time",
        ),
        (
            command(
                "cable = \"right\"\nshortening = 0\n[[motion.commands]]\nmotor = \"bend\"\nangle = 0",
            ),
            "the motor `bend` that pulls it",
        ),
        (format!("{MOTION}[[motion.loads]]\ntip_force = [0, 0, 1]\n"), "factor"),
        (format!("{MOTION}[[motion.loads]]\nfactor = [[0, 1]]\n"), "tip_force"),
        (
            format!(
                "{MOTION}[[motion.loads]]\nfactor = [[0, 1]]\n[[motion.loads.point]]\nat = 1\nforce = [0, 0, 1]\n"
            ),
            "motion.loads[0].point",
        ),
    ] {
        let error = refused(&tail);
        assert!(error.contains(message) && error.contains("robot.toml:"), "{tail}\n{error}");
    }
    let skew = "damping = { matrix = [[5, 1, 0, 0, 0, 0], [0, 5, 0, 0, 0, 0], [0, 0, 9, 0, 0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]] }\n";
    let error = parse(&robot(skew, ""), "robot.toml").unwrap_err().to_string();
    assert!(error.contains("must be symmetric"), "{error}");
}

#[test]
fn surroundings_and_base_are_read() {
    let tail = "[motion]\nduration = 1\nelements = 9\ndrag = { across = \"0.5 N*s/m^2\", along = \"200 mPa*s\" }\n\
                [motion.base]\nvelocity = [0, \"2 cm/s\", [[0, 0], [\"100 ms\", \"0.5 m/s\"]]]\nangular_velocity = [\"180 deg/s\", 0, 0]\n";
    let options = read(&robot("", tail)).motion.options();
    assert_eq!((options.elements, options.drag), (9, Drag { across: 0.5, along: 0.2 }));
    let still = || Course::constant(0.0);
    let base = BaseMotion {
        velocity: [still(), Course::constant(0.02), table(&[0.0, 0.1], &[0.0, 0.5])],
        angular_velocity: [Course::constant(core::f64::consts::PI), still(), still()],
    };
    assert_eq!(options.base, Some(base));
    let plain = read(&robot("", MOTION)).motion.options();
    assert_eq!((plain.elements, plain.base), (MotionOptions::ELEMENTS, None));
    for (tail, message) in [
        ("drag = { across = \"-1 N*s/m^2\" }\n", "must not be negative"),
        ("drag = { across = \"1 N\" }\n", "drag per length"),
        ("base = { velocity = [0, 0] }\n", "3"),
        ("base = { velocity = [0, 0, \"1 m\"] }\n", "speed"),
        ("base = { velocity = [0, 0, 0], csv = \"a.csv\" }\n", "csv"),
        ("base = { csv = \"none.csv\" }\n", "none.csv"),
        ("elements = 0\n", "elements"),
        ("initial = \"sleeping\"\n", "neither `equilibrium` nor `rest`"),
    ] {
        let refused = refused(&format!("{MOTION}{tail}"));
        assert!(refused.contains(message), "{tail}: {refused}");
    }
}

#[test]
fn a_base_is_read_from_a_table_and_a_start_from_a_motion() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write(
        "poses.csv",
        "t [ms],x [mm],y [mm],z [mm],qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n500,1,2,13,0,0,0,2\n",
    );
    write("places.csv", "t,x,y,z\n0,0,0,0\n1,0,0,0.5\n");
    let load_with = |tail: &str| {
        write(
            "robot.toml",
            &robot("damping = { time = 0.01 }\nmaterial = \"spring steel\"\n", tail),
        );
        load(folder.path().join("robot.toml"))
    };
    let of = |name: &str, base: &str| {
        let tail = format!("{base}{MOTION}base = {{ csv = \"{name}\" }}\n");
        load_with(&tail).unwrap().motion.base.unwrap()
    };
    let half_turn = UnitQuaternion::from_wxyz([0.0, 0.0, 0.0, 1.0]).unwrap();
    let to = Pose { position: Vec3::new(1e-3, 2e-3, 0.013), rotation: half_turn };
    let from = Pose { position: Vec3::new(1e-3, 2e-3, 3e-3), rotation: UnitQuaternion::IDENTITY };
    let expected = BaseMotion::through(&[(0.0, from), (0.5, to)]).unwrap();
    assert_eq!(of("poses.csv", ""), expected);
    assert!((expected.angular_velocity[2].after(0.2).abs() - core::f64::consts::TAU).abs() < 1e-12);
    // Positions alone are in the world, in which the base lies on its side.
    let side = "[base]\nrotation = { axis = [1, 0, 0], angle = \"90 deg\" }\n";
    let velocity = of("places.csv", side).velocity;
    assert!((velocity[1].after(0.5) - 0.5).abs() < 1e-12 && velocity[2].after(0.5).abs() < 1e-12);

    let moving = load_with("[motion]\nduration = 0.05\n[[motion.commands]]\ncable = \"left\"\ntension = [[0, 3], [0, 1]]\n").unwrap();
    let commands = moving.motion.commands(&moving.robot, &moving.case);
    let options = moving.motion.options();
    let simulation = Simulation::with_commands(&moving.robot, &moving.case, &commands, options);
    let trajectory = simulation.unwrap().run(&commands, 0.01, 1, 5).unwrap();
    let json = motion_json("first", &moving.robot, &[], &trajectory).unwrap();
    write("first.json", &json.to_string());
    let second = load_with(&format!("{MOTION}initial = \"first.json\"\n")).unwrap();
    let last = trajectory.states.last().unwrap().start();
    assert_eq!(second.motion.initial, Some(Initial::State(Box::new(last))));
    let text =
        second.with_numbers_of(&second.robot, &second.case, Vec3::ZERO, std::path::Path::new("/"));
    assert!(text.unwrap().text.contains("first.json"));
    for (text, message) in [
        ("nonsense", "not JSON"),
        ("{}", "no `states`"),
        ("{\"states\": []}", "no states"),
        ("{\"states\": [{\"velocities\": [[1, 2]]}]}", "no `velocities` of six numbers"),
    ] {
        write("first.json", text);
        let refused = load_with(&format!("{MOTION}initial = \"first.json\"\n")).unwrap_err();
        assert!(refused.to_string().contains(message), "{text}: {refused}");
    }
}
