//! What is damaged: seeds of each kind of file, how they are changed, and what reads them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use whipcord::Robot;
use whipcord_io::{load, load_markers, parse, parse_camera};
use whipcord_vision::Photo;

use crate::document::Item;
use crate::random::Random;
use crate::{tables, text};

/// Files with their names.
type Seeds = Vec<(PathBuf, Vec<u8>)>;

/// A kind of file, and what is done with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A robot file that is read.
    Robot,
    /// A robot file that the command solves.
    Solve,
    Camera,
    Csv,
    Parquet,
    Mesh,
    Photograph,
}

impl Kind {
    pub const ALL: [Self; 7] = [
        Self::Robot,
        Self::Solve,
        Self::Camera,
        Self::Csv,
        Self::Parquet,
        Self::Mesh,
        Self::Photograph,
    ];

    pub fn name(self) -> &'static str {
        ["robot file", "solve", "camera", "CSV table", "Parquet table", "mesh", "photograph"]
            [self as usize]
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Seeds, with their names.
    fn seeds(self) -> &'static Seeds {
        static SEEDS: [OnceLock<Seeds>; 7] = [const { OnceLock::new() }; 7];
        SEEDS[self as usize].get_or_init(|| match self {
            Self::Robot | Self::Solve => robots(),
            Self::Camera => found("crates/whipcord-io/tests/data", &["yml", "json"]),
            Self::Csv => tables(),
            Self::Parquet => found("crates/whipcord-io/tests/data/parquet", &["parquet"]),
            Self::Mesh => meshes(),
            Self::Photograph => photographs(),
        })
    }

    /// A damaged file: its name, which says in which folder it is to lie, and its bytes.
    pub fn mutant(self, seed: u64, index: usize) -> (PathBuf, Vec<u8>) {
        let mut random = Random::new(seed, self as usize, index);
        let (name, bytes) = random.pick(self.seeds()).clone();
        let times = 1 + random.below(3);
        let (mut bytes, mut mild) = (
            bytes,
            random.chance(match self {
                Self::Parquet => 50,
                Self::Robot | Self::Mesh | Self::Photograph => 65,
                Self::Solve | Self::Camera => 85,
                Self::Csv => 92,
            }),
        );
        match self {
            Self::Robot | Self::Solve => {
                let parsed =
                    Item::parse(&String::from_utf8_lossy(&bytes)).filter(|_| random.chance(90));
                if let Some(mut item) = parsed {
                    (0..times).for_each(|_| item.mutate(trees(), mild, &mut random));
                    bytes = item.write().into_bytes();
                } else {
                    mild = false;
                }
                if !mild && random.chance(20) {
                    text::bytes(&mut bytes, &mut random);
                }
            }
            Self::Camera | Self::Csv => {
                let mut content = String::from_utf8_lossy(&bytes).into_owned();
                for _ in 0..if mild { 1 } else { times } {
                    content = match random.below(if mild { 2 } else { 4 }) {
                        0 | 1 => text::numbers(&content, mild, &mut random),
                        _ => text::lines(
                            &content,
                            if self == Self::Csv { ',' } else { ' ' },
                            &mut random,
                        ),
                    };
                }
                bytes = content.into_bytes();
                if !mild && random.chance(30) {
                    text::bytes(&mut bytes, &mut random);
                }
            }
            Self::Mesh
                if name.extension().is_some_and(|e| e == "obj") || bytes.starts_with(b"solid") =>
            {
                let mut content = String::from_utf8_lossy(&bytes).into_owned();
                let keyword =
                    if name.extension().is_some_and(|e| e == "obj") { "v" } else { "vertex" };
                for _ in 0..times {
                    content = match random.below(3) {
                        _ if mild => text::coordinates(&content, keyword, &mut random),
                        0 => text::lines(&content, ' ', &mut random),
                        _ => text::numbers(&content, false, &mut random),
                    };
                }
                bytes = content.into_bytes();
            }
            // Triangles of 50 bytes each after a header of 84: a normal, three corners and two bytes that are not used.
            Self::Mesh if mild => text::floats(&mut bytes, 84, 50, 12..48, &mut random),
            Self::Parquet if mild => bytes = tables::parquet(&mut random),
            Self::Photograph if mild && random.chance(60) => {
                bytes = changed_picture(bytes.starts_with(PNG), &mut random);
            }
            Self::Parquet | Self::Mesh | Self::Photograph => {
                let times = if mild { 1 } else { times };
                // Of what is generated nothing but the damage is wrong.
                if self == Self::Parquet && random.chance(50) {
                    bytes = tables::parquet(&mut random);
                }
                (0..times).for_each(|_| text::bytes(&mut bytes, &mut random));
                // Else hardly anything of a picture would be read.
                if bytes.starts_with(PNG) && random.chance(80) {
                    bytes = with_checksums(&bytes);
                }
            }
        }
        (name, bytes)
    }

    /// Reads the file and says whether it was taken. `scratch` is a folder to write to.
    pub fn read(self, name: &Path, bytes: &[u8], scratch: &Path) -> bool {
        let written = |extension: &str| {
            let path = scratch.join("mutant").with_extension(extension);
            fs::write(&path, bytes).expect("the mutant is written");
            path
        };
        match self {
            Self::Robot | Self::Solve => match parse(&String::from_utf8_lossy(bytes), name) {
                Ok(file) => {
                    assert_eq!(file.case.commands.len(), file.robot.cables().len());
                    true
                }
                Err(error) => {
                    assert!(error.to_string().contains("help: "), "{error}");
                    false
                }
            },
            Self::Camera => parse_camera(name, &String::from_utf8_lossy(bytes)).is_ok(),
            Self::Csv => load_markers(written("csv"), measured_robot()).is_ok(),
            Self::Parquet => {
                written("parquet");
                let robot = "[backbone]\nlength = 0.2\n[disks]\ncount = 3\nhole_circle_radius = 0.008\nholes = 4\n\
                             [[cables]]\nholes = [1, 1, 1]\n[[steps]]\ntension = [1]\n[[steps]]\ntension = [2]\n\
                             [measured]\ndisks = \"mutant.parquet\"\nunit = \"mm\"\n";
                parse(robot, scratch.join("robot.toml")).is_ok()
            }
            Self::Mesh => {
                let extension = name.extension().and_then(|e| e.to_str()).unwrap_or("stl");
                let file = written(extension);
                let robot = format!(
                    "[backbone]\nlength = 0.3\n[disks]\ncount = 3\n[[obstacles]]\nkind = \"mesh\"\nfile = \"{}\"\nunit = \"mm\"\n",
                    file.file_name().and_then(|name| name.to_str()).unwrap_or_default()
                );
                parse(&robot, scratch.join("robot.toml")).is_ok()
            }
            Self::Photograph => match Photo::decode(bytes) {
                Ok(photo) => {
                    assert!(photo.pixels().iter().flatten().all(|light| light.is_finite()));
                    true
                }
                Err(_) => false,
            },
        }
    }
}

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files of a folder of the workspace with these extensions, in the order of their names.
fn found(folder: &str, extensions: &[&str]) -> Seeds {
    let folder = root().join(folder);
    let entries = fs::read_dir(&folder).expect("the folder is there");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.retain(|path| {
        path.extension().is_some_and(|e| extensions.iter().any(|other| e == *other))
    });
    let all: Vec<_> =
        paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("a seed"))).collect();
    assert!(!all.is_empty(), "no seeds in {}", folder.display());
    all
}

fn robots() -> Seeds {
    let folders = ["examples", "examples/contact", "examples/table1"];
    let mut all: Vec<_> = folders.iter().flat_map(|folder| found(folder, &["toml"])).collect();
    // Keys that no example has.
    let beside = root().join("examples/beside.toml");
    for text in [
        "title = 'all'\n[backbone]\nlength = 0.3\ndiameters = [0.003, '2 mm', 0.001]\ninner_diameter = '0.5 mm'\n\
         young_modulus = 1e9\nshear_modulus = '400 MPa'\nrest_curvature = [[0, 0, 1], ['0', '4 1/m', 0], [0, 0, 0]]\n\
         [disks]\npositions = [0, '10 cm', 0.3]\nhole_circle_radius = [0.01, 0.009, 0.008]\nholes = 6\n[[cables]]\n\
         holes = [6, 1]\ninterpolation = 'fourier'\nends_at = 0.05\nfriction = '10 %'\naxial_stiffness = '2 kN'\n\
         shortening = '-1 mm'\n[[cables]]\nrouting = { kind = 'polynomial', x = [0.01, 0.1], y = [0, 1e-3] }\n\
         [[cables]]\nrouting = { kind = 'linear', start = [0.01, 0], end = ['1 in', '0'] }\n[loads]\n\
         gravity = [0, 0, '-1 g0']\nfollower = true\n[[loads.point]]\nat = 0.1\nmoment = ['1 N*mm', 0, 0]\n",
        "[backbone]\nlength = 0.3\nsection = { width = [0.003, '2 mm'], height = 1e-3, at = [0, 0.3] }\n\
         young_modulus = '70 GPa'\nrest_curvature = { at = [0, '1 cm', 0.3], values = [[0, 0, 1], [0, 1, 0], [0, 0, 0]] }\n\
         linear_density = { at = [0, 0.2, 0.3], values = ['7 g/m', 0.005, 0] }\nshearable = false\n[disks]\ncount = 3\n\
         hole_circle_radius = 0.01\n[[cables]]\nrouting = { kind = 'straight', angle = '90 deg', radius = '8 mm' }\n\
         [[steps]]\ntension = [1]\n[[steps]]\ntension = ['200 mN']\n",
    ] {
        all.push((beside.clone(), text.as_bytes().to_vec()));
    }
    all
}

/// The trees of all robot files, from which parts are taken.
fn trees() -> &'static [Item] {
    static TREES: OnceLock<Vec<Item>> = OnceLock::new();
    TREES.get_or_init(|| {
        let texts = Kind::Robot.seeds().iter().map(|(_, bytes)| String::from_utf8_lossy(bytes));
        texts.filter_map(|text| Item::parse(&text)).collect()
    })
}

/// What the markers of tables are on.
fn measured_robot() -> &'static Robot {
    static ROBOT: OnceLock<Robot> = OnceLock::new();
    ROBOT
        .get_or_init(|| load(root().join("examples/table1/case-1.toml")).expect("an example").robot)
}

fn tables() -> Seeds {
    let row = |k: usize| format!("{k},{},{},0.9\n", 100.5 + k as f64, 200 - 3 * k);
    let rows: String = (1..=9).map(row).collect();
    let pixels = format!("disk,u,v,confidence\n{rows}");
    let along = "# made by hand\narc_length,offset_x,offset_y,offset_z,u,v,camera,step\n\
                 0.01,0,0,1e-3,10,20,left,1\n0.1,0,0.002,0,30.25,41,left,1\n";
    let space = "step,disk,x,y,z,deviation\n1,2,0.1,0,nan,1e-4\n1,3,0.1,0.2,0.3,1e-4\n2,2,,,,\n";
    [pixels.as_str(), along, space].map(|text| (PathBuf::new(), text.as_bytes().to_vec())).to_vec()
}

/// A cube as text and in binary, and the example.
fn meshes() -> Seeds {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2].map(|c| 10.0 * c as f64);
    let faces = [
        [0, 2, 3],
        [0, 3, 1],
        [4, 5, 7],
        [4, 7, 6],
        [0, 1, 5],
        [0, 5, 4],
        [2, 6, 7],
        [2, 7, 3],
        [0, 4, 6],
        [0, 6, 2],
        [1, 3, 7],
        [1, 7, 5],
    ];
    let mut obj: String = (0..8).map(corner).map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let (mut ascii, mut binary) = ("solid cube\n".to_owned(), vec![b'b'; 80]);
    binary.extend(12_u32.to_le_bytes());
    for face in faces {
        obj += &format!("f {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1);
        ascii += "facet normal 0 0 0\nouter loop\n";
        binary.extend([0; 12]);
        for [x, y, z] in face.map(corner) {
            ascii += &format!("vertex {x} {y} {z}\n");
            binary.extend([x, y, z].map(|c| c as f32).iter().flat_map(|c| c.to_le_bytes()));
        }
        ascii += "endloop\nendfacet\n";
        binary.extend([0, 0]);
    }
    ascii += "endsolid cube\n";
    let mut all = found("examples/contact", &["stl"]);
    all.push(("cube.obj".into(), obj.into_bytes()));
    all.push(("cube.stl".into(), ascii.into_bytes()));
    all.push(("binary.stl".into(), binary));
    all
}

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// A picture of another size and with other pixels.
fn changed_picture(is_png: bool, random: &mut Random) -> Vec<u8> {
    let [width, height] = [1 + random.below(64), 1 + random.below(64)];
    let step = 1 + random.below(250);
    let rgb: Vec<u8> = (0..width * height * 3).map(|i| (i * step % 251) as u8).collect();
    let photo = Photo::of_rgb8(width, height, &rgb).expect("a picture");
    if is_png { photo.to_png() } else { photo.to_jpeg() }.expect("a file")
}

fn photographs() -> Seeds {
    let rgb: Vec<u8> = (0..48 * 32 * 3).map(|i| (i * 7 % 251) as u8).collect();
    let photo = Photo::of_rgb8(48, 32, &rgb).expect("a picture");
    let (png, jpeg) = (photo.to_png().expect("PNG"), photo.to_jpeg().expect("JPEG"));
    // Exif data with an orientation, as telephones store it, and a colour profile that is none.
    let exif = b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    let mut on_its_side = jpeg[..2].to_vec();
    on_its_side.extend([0xff, 0xe1, 0, (exif.len() + 8) as u8]);
    on_its_side.extend(b"Exif\0\0");
    on_its_side.extend(exif);
    on_its_side.extend(&jpeg[2..]);
    let profile = [&b"p\0\0\x78\x01\x01\x02\x00\xfd\xff"[..], &[0; 6]].concat();
    let header = PNG.len() + 25;
    let with_chunks = [
        &png[..header],
        &chunk(b"iCCP", &profile),
        &chunk(b"eXIf", exif),
        &chunk(b"tEXt", b"Comment\0made by hand"),
        &png[header..],
    ]
    .concat();
    [png, jpeg, on_its_side, with_chunks].map(|bytes| (PathBuf::new(), bytes)).to_vec()
}

fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    [&(content.len() as u32).to_be_bytes()[..], kind, content, &[0; 4]].concat()
}

/// A PNG with the right checksum of each chunk that is whole.
fn with_checksums(bytes: &[u8]) -> Vec<u8> {
    let mut out = bytes.to_vec();
    let mut at = PNG.len();
    while let Some(length) = out.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(named) = at.checked_add(8 + length).and_then(|end| out.get(at + 4..end)) else {
            break;
        };
        let crc = !named.iter().fold(!0_u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
        });
        let place = at + 8 + length;
        let Some(old) = out.get_mut(place..place + 4) else { break };
        old.copy_from_slice(&crc.to_be_bytes());
        at = place + 4;
    }
    out
}
