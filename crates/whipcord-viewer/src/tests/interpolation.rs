//! The page interpolates an exported recording as `grid.rs` does, which the export is held against solves with:
//! `page/src/interpolation.json` is what is computed here, and the unit tests of the page compute it again.

use std::path::Path;
use std::{env, fs};

use serde::{Deserialize, Serialize};
use whipcord::{Twist, UnitQuaternion, Vec3};

use crate::convert::pose;
use crate::grid::{Grid, Weights};
use crate::protocol::{Command, Pose, Ranges};

#[derive(Debug, Serialize, Deserialize)]
struct Interpolation {
    mixes: Vec<Mix>,
    paths: Vec<Shape>,
}

/// The frames that an answer is interpolated from.
#[derive(Debug, Serialize, Deserialize)]
struct Mix {
    axes: Vec<Vec<f64>>,
    initial: Vec<Command>,
    commands: Vec<Command>,
    /// Frames without a solution.
    unsolved: Vec<usize>,
    weights: Option<Weights>,
}

/// What strains, linear and angular, add up to.
#[derive(Debug, Serialize, Deserialize)]
struct Shape {
    base: Pose,
    strains: Vec<[[f64; 3]; 2]>,
    lengths: Vec<f64>,
    poses: Vec<Pose>,
}

const RANGES: Ranges =
    Ranges { tension: 10.0, shortening: 0.02, force: 1.0, moment: 1.0, gravity: 1.0 };

fn mix(grid: &Grid, initial: &[Command], commands: Vec<Command>, unsolved: Vec<usize>) -> Mix {
    Mix {
        axes: grid.axes.iter().map(|axis| axis.values.clone()).collect(),
        initial: initial.to_vec(),
        weights: grid.around(&commands, |frame| !unsolved.contains(&frame)),
        commands,
        unsolved,
    }
}

fn mixes() -> Vec<Mix> {
    use Command::{Shortening, Tension};
    let one = [Tension(3.3)];
    let several = [Tension(3.3), Shortening(0.004), Tension(0.0)];
    // More than have room: the last sliders do not move.
    let many: Vec<_> = (0..7).map(|k| Tension(f64::from(k))).collect();
    let grids: [(&[Command], usize); 4] =
        [(&one, 4000), (&several, 500), (&several, 9), (&many, 9)];
    let mut all = Vec::new();
    for (initial, most) in grids {
        let grid = Grid::new(initial, |k| RANGES.reach(initial[k]), most);
        for at in [0.0, 0.31, 0.34, 0.97] {
            let fractions: Vec<f64> =
                (0..initial.len()).map(|k| (at + 0.21 * k as f64).fract()).collect();
            all.push(mix(&grid, initial, grid.between(&fractions), vec![]));
        }
        all.push(mix(&grid, initial, initial.to_vec(), vec![]));
        // Where one of the outer frames has no solution, and where one of the nearest has none.
        let commands = grid.between(&vec![0.45; initial.len()]);
        let nearest = grid.around(&commands, |_| true).unwrap();
        let heavy = nearest.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
        let light = nearest.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
        for unsolved in [light, heavy] {
            all.push(mix(&grid, initial, commands.clone(), vec![unsolved]));
        }
    }
    // Beyond the ends of a slider.
    for beyond in [-1.0, 11.0] {
        let grid = Grid::new(&one, |k| RANGES.reach(one[k]), 4000);
        all.push(mix(&grid, &one, vec![Tension(beyond)], vec![]));
    }
    all
}

fn paths() -> Vec<Shape> {
    let turned = whipcord::Pose {
        position: Vec3::new(0.1, -0.2, 0.3),
        rotation: UnitQuaternion::exp(Vec3::new(0.4, -0.9, 1.3)),
    };
    let curved = |k: f64| [[0.01 * k, -0.02, 1.0 + 0.01 * k], [3.0 * k, 20.0 - k, -4.0 * k * k]];
    let straight = [[0.0, 0.0, 1.0], [0.0; 3]];
    let slight = [[0.0, 0.0, 1.0], [0.02, -0.3, 0.01]];
    let shapes = [
        (whipcord::Pose::IDENTITY, vec![straight, slight, curved(1.0)]),
        (turned, (0..5).map(|k| curved(f64::from(k))).collect()),
    ];
    let shapes = shapes.into_iter().map(|(base, strains)| {
        let lengths: Vec<f64> = (0..strains.len()).map(|k| 0.01 + 0.013 * k as f64).collect();
        let twists = strains
            .iter()
            .map(|&[linear, angular]| Twist { linear: linear.into(), angular: angular.into() });
        let poses = whipcord::Shape::of_strains(base, &twists.collect::<Vec<_>>(), &lengths).poses;
        Shape { base: pose(&base), strains, lengths, poses: poses.iter().map(pose).collect() }
    });
    shapes.collect()
}

#[test]
fn the_page_interpolates_as_the_export_is_tried() {
    let now = Interpolation { mixes: mixes(), paths: paths() };
    let weights = |mix: &Mix| mix.weights.as_ref().map_or(0, Vec::len);
    assert!(now.mixes.iter().any(|mix| weights(mix) == 0));
    assert!(now.mixes.iter().any(|mix| weights(mix) >= 64));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("page/src/interpolation.json");
    if env::var_os("UPDATE_SAMPLES").is_some() {
        fs::write(&path, serde_json::to_string(&now).unwrap() + "\n").unwrap();
    }
    let written: Interpolation = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    // Sines are not the same on all machines to the last bit.
    let [now, written] = [&now, &written].map(|one| numbers(&serde_json::to_value(one).unwrap()));
    assert_eq!(now.len(), written.len(), "run with UPDATE_SAMPLES=1, then `npm test`");
    for (a, b) in now.iter().zip(&written) {
        assert!((a - b).abs() < 1e-12, "{a} {b}: run with UPDATE_SAMPLES=1, then `npm test`");
    }
}

/// All numbers in their order, and a mark for what is none.
fn numbers(value: &serde_json::Value) -> Vec<f64> {
    match value {
        serde_json::Value::Number(number) => number.as_f64().into_iter().collect(),
        serde_json::Value::Array(values) => values.iter().flat_map(numbers).collect(),
        serde_json::Value::Object(values) => values.values().flat_map(numbers).collect(),
        _ => vec![-1e9],
    }
}
