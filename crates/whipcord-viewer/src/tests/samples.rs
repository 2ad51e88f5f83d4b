//! The page knows the protocol as the server writes it: `page/src/samples.ts` is what is written here, and
//! `npm run check` compiles it against the types of the page.

use std::path::Path;
use std::{env, fs};

use crate::protocol::{
    Acting, Answer, Cable, CableState, Camera, Cloud, Command, Compliance, Contact, Course,
    CourseChoice, DesignRequest, Designed, Disk, Form, Frame, FromPage, Grasp, Lens, Load, Marker,
    MetLimit, ModelChoice, Moment, Motor, Obstacle, PlacedObject, PlayRequest, Pose, Pull, Ranges,
    Reach, Request, Scene, Section, Shown, Sight, Slider, Solved, ToPage, Track, Warning, read,
};

fn request() -> Request {
    Request {
        id: 7,
        commands: vec![Command::Tension(1.5), Command::Shortening(-0.002), Command::Motor(0.7)],
        tip_force: [0.1, 0.0, -0.2],
        tip_moment: [0.0, 0.01, 0.0],
        gravity: [0.0, 0.0, -9.81],
        models: vec!["cosserat".to_owned(), "four-bar".to_owned()],
        compliance: true,
        target: Some([0.05, 0.0, 0.1]),
        pull: Some(Pull { arc_length: 0.1, force: [0.0, 0.2, 0.0] }),
        holes: vec![Some(vec![1, 2, 3]), None],
    }
}

fn scenes() -> Vec<Scene> {
    let pose = Pose { position: [0.0, 0.0, 0.1], orientation: [1.0, 0.0, 0.0, 0.0] };
    let forms = vec![
        Form::HalfSpace,
        Form::Sphere { radius: 0.02 },
        Form::Capsule { radius: 0.02, length: 0.1 },
        Form::Box { size: [0.1, 0.2, 0.3] },
        Form::Cylinder { radius: 0.02, length: 0.1 },
        Form::Pipe { radius: 0.02, middle: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]] },
        Form::Superellipsoid { semi_axes: [0.1, 0.2, 0.3], exponents: [0.5, 1.0] },
        Form::Mesh {
            vertices: vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]],
            triangles: vec![[0, 1, 2]],
        },
    ];
    let obstacles = forms.into_iter().map(|form| Obstacle { name: "body".to_owned(), pose, form });
    let round = Scene {
        title: "Arm".to_owned(),
        file: "arm.toml".to_owned(),
        version: "0.0.0".to_owned(),
        length: 0.2,
        stations: vec![0.0, 0.1, 0.2],
        section: Section::Round { outer: vec![0.003; 3], inner: vec![0.0; 3] },
        disks: vec![Disk {
            station: 0,
            radius: 0.01,
            thickness: 0.001,
            holes: vec![[0.008, 0.0]],
            hole_radius: 0.001,
        }],
        cables: vec![Cable {
            name: "pull".to_owned(),
            course: vec![[0.008, 0.0]; 3],
            holes: Some(vec![1]),
            initial_length: 0.2,
        }],
        motors: vec![Motor {
            name: "bend".to_owned(),
            is_angular: true,
            reach: [-3.0, 3.0],
            pulls: vec![(0, 0.01)],
            limit: Some(0.2),
        }],
        sliders: vec![Slider::Motor(0), Slider::Cable(0)],
        base: pose,
        models: vec![
            ModelChoice {
                name: "cosserat".to_owned(),
                hole_to_hole: false,
                jointed: false,
                refusal: None,
            },
            ModelChoice {
                name: "four-bar".to_owned(),
                hole_to_hole: true,
                jointed: false,
                refusal: Some("why".to_owned()),
            },
        ],
        initial: request(),
        ranges: Ranges { tension: 10.0, shortening: 0.02, force: 1.0, moment: 0.1, gravity: 15.0 },
        loads_in_base: true,
        tip_follower: false,
        loads: vec![
            Load::Single {
                arc_length: 0.1,
                force: [0.1, 0.0, 0.0],
                moment: [0.0, 0.0, 0.01],
                follows: true,
            },
            Load::Spread {
                arc_lengths: vec![0.0, 0.2],
                forces: vec![[0.0, 1.0, 0.0]; 2],
                moments: vec![[0.0; 3]; 2],
                follows: false,
            },
            Load::Mass { arc_length: 0.2, mass: 0.05 },
        ],
        other_loads: vec!["a load at a point".to_owned()],
        courses: vec![
            CourseChoice { course: Course::Steps, count: 4, duration: None },
            CourseChoice { course: Course::Motion, count: 101, duration: Some(1.0) },
        ],
        measured: vec![
            vec![Marker {
                seen: Sight::Position { position: [0.0, 0.0, 0.2] },
                arc_length: Some(0.2),
                offset: [0.0, 0.005, 0.0],
            }],
            vec![Marker {
                seen: Sight::Line {
                    camera: 0,
                    origin: [0.0, -1.0, 0.1],
                    direction: [0.0, 1.0, 0.0],
                },
                arc_length: None,
                offset: [0.0; 3],
            }],
        ],
        cameras: vec![
            Camera {
                name: "left".to_owned(),
                pose,
                lens: Lens::Pinhole { focal: [800.0, 810.0], centre: [320.0, 240.0] },
                size: [640.0, 480.0],
                columns: 2,
                ideal: vec![Some([-0.5, -0.5]), None],
            },
            Camera {
                name: "right".to_owned(),
                pose,
                lens: Lens::Orthographic { scale: 2000.0, centre: [320.0, 240.0] },
                size: [640.0, 480.0],
                columns: 1,
                ideal: vec![],
            },
        ],
        obstacles: obstacles.collect(),
        warnings: vec![warning()],
    };
    let bar = Section::Rectangle { width: vec![0.01; 3], height: vec![0.001; 3] };
    vec![
        Scene { section: bar, ..round.clone() },
        Scene { section: Section::Unknown, ..round.clone() },
        round,
    ]
}

fn warning() -> Warning {
    Warning { message: "what".to_owned(), help: "do".to_owned() }
}

fn frame() -> Frame {
    let solved = Solved {
        model: "cosserat".to_owned(),
        positions: vec![[0.0, 0.0, 0.0], [0.0, 0.0, 0.1]],
        orientations: vec![[1.0, 0.0, 0.0, 0.0]; 2],
        strains: vec![[1.5, 0.0, 0.2, 0.001, 0.0, -0.001]],
        moments: Some(vec![[0.01, 0.0, 0.002]]),
        cables: vec![CableState {
            tension: Some(1.5),
            length: 0.19,
            initial_length: 0.2,
            shortening: 0.001,
            slack: false,
            span_tensions: vec![1.5, 1.4],
        }],
        contacts: vec![Contact {
            obstacle: 0,
            arc_length: 0.1,
            point: [0.0, 0.0, 0.1],
            normal: [1.0, 0.0, 0.0],
            force: Some(0.3),
            friction: Some([0.0, 0.05, 0.0]),
            sticks: true,
        }],
        grasps: vec![Grasp {
            obstacle: 0,
            contacts: 1,
            sliding: 0,
            normal_force: 0.3,
            force: [-0.3, -0.05, 0.0],
            moment: [0.0, 0.0, 0.001],
            slip_margin: Some(0.4),
        }],
        objects: vec![PlacedObject {
            obstacle: 0,
            pose: Pose { position: [0.0, 0.0, 0.2], orientation: [1.0, 0.0, 0.0, 0.0] },
        }],
        residual: 1e-12,
        iterations: 3,
        stability: Some(0.9),
        unstable: false,
        solve_time: 2e-5,
        driven_by: None,
        compliance: Some(Compliance::Known {
            values: [0.1, 0.01, 0.001],
            directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }),
        warnings: vec![warning()],
    };
    let geometric = Solved {
        model: "four-bar".to_owned(),
        moments: None,
        cables: vec![CableState {
            tension: None,
            length: 0.19,
            initial_length: 0.2,
            shortening: 0.001,
            slack: true,
            span_tensions: vec![],
        }],
        contacts: vec![],
        grasps: vec![],
        objects: vec![],
        stability: None,
        driven_by: Some("cosserat".to_owned()),
        compliance: Some(Compliance::Unknown { message: "why".to_owned() }),
        warnings: vec![],
        ..solved.clone()
    };
    let failed = Answer::Failed { model: "cosserat-disks".to_owned(), message: "why".to_owned() };
    Frame {
        id: 7,
        time: 1e-3,
        answers: vec![
            Answer::Solved(Box::new(solved)),
            Answer::Solved(Box::new(geometric)),
            failed,
        ],
        reach: Some(Reach::Found {
            reached: false,
            commands: request().commands,
            distance: 0.002,
            limits: vec![MetLimit { slider: Some(1), words: "which".to_owned() }],
        }),
        cables: None,
    }
}

fn cloud() -> Cloud {
    Cloud {
        id: 8,
        voxel: 0.01,
        points: vec![[0.0, 0.0, 0.2]],
        dexterity: vec![0.1],
        dimension: 3,
        measure: 0.5,
        complete: true,
    }
}

#[test]
fn the_page_has_the_types_of_the_server() {
    let from_page = vec![
        FromPage::Solve(request()),
        FromPage::Survey(request()),
        FromPage::EndSurvey,
        FromPage::Play(PlayRequest { course: Course::Motion, request: request() }),
        FromPage::EndPlay,
        FromPage::Design(DesignRequest {
            request: request(),
            cable: 0,
            tension: true,
            places: vec![[0.0, 0.0, 0.2]],
        }),
        FromPage::EndDesign,
    ];
    let mut to_page: Vec<ToPage> =
        scenes().into_iter().map(|scene| ToPage::Scene(Box::new(scene))).collect();
    to_page.push(ToPage::Broken { message: "why".to_owned() });
    to_page.push(ToPage::Frame(frame()));
    let failed = Reach::Failed { message: "why".to_owned() };
    to_page.push(ToPage::Frame(Frame { reach: Some(failed), ..frame() }));
    to_page.push(ToPage::Cloud(cloud()));
    let acting = Acting {
        tip_force: [0.1, 0.0, 0.0],
        tip_moment: [0.0; 3],
        tip_follower: false,
        gravity: [0.0, 0.0, -9.81],
        loads: scenes()[0].loads.clone(),
    };
    let moment = Moment { time: 0.5, answers: frame().answers, acting: Some(acting) };
    for (complete, message) in [(false, None), (true, Some("why".to_owned()))] {
        let (course, moments) = (Course::Motion, vec![moment.clone()]);
        to_page.push(ToPage::Track(Track { id: 9, course, from: 16, moments, complete, message }));
    }
    let [first, ..] = &frame().answers[..] else { panic!() };
    if let Some(scene) = scenes().pop() {
        to_page.push(ToPage::Beside { number: 1, scene: Box::new(scene), answer: first.clone() });
    }
    let shapes = vec![Some(first.clone()), None];
    to_page.push(ToPage::Shown(Shown { time: 0.5, shapes, measured: vec![[0.0, 0.0, 0.1]] }));
    to_page.push(ToPage::NoCloud { id: 8, message: "why".to_owned() });
    to_page.push(ToPage::Designed(Designed {
        id: 10,
        holes: vec![1, 2],
        commands: request().commands,
        error: 0.001,
        largest: 0.002,
        proven: true,
    }));
    to_page.push(ToPage::NoDesign { id: 10, message: "why".to_owned() });
    let cables = scenes()[0].cables.clone();
    to_page.push(ToPage::Frame(Frame { cables: Some(cables), ..frame() }));
    to_page.push(ToPage::Error { message: "why".to_owned() });
    let [from, to] = [
        serde_json::to_string_pretty(&from_page).unwrap(),
        serde_json::to_string_pretty(&to_page).unwrap(),
    ];
    let text = format!(
        "// Written by the test `samples` of the crate, with UPDATE_SAMPLES=1: what page and server say to each other.\n\n\
         import type {{ FromPage, ToPage }} from \"./protocol\";\n\n\
         export const fromPage: FromPage[] = {from};\n\n\
         export const toPage: ToPage[] = {to};\n"
    );
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("page/src/samples.ts");
    if env::var_os("UPDATE_SAMPLES").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap();
    assert_eq!(
        written.replace("\r\n", "\n"),
        text,
        "run with UPDATE_SAMPLES=1, then `npm run check`"
    );
    // And what is written is read.
    for message in from_page {
        assert_eq!(read(&serde_json::to_string(&message).unwrap()), Ok(message));
    }
    let back: Vec<ToPage> = serde_json::from_str(&to).unwrap();
    assert_eq!(back, to_page);
}
