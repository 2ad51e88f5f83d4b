//! Large photographs of ten dots in a row: whether `whipcord measure` keeps within the memory that the documentation states.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::time::Duration;

use crate::random::Random;
use crate::runner::{limited, watch};

/// What is behind the dots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wall {
    Even,
    /// Strong noise, each channel of each pixel by itself: colours are then looked for in a blurred copy.
    Noisy,
}

/// Bytes per pixel, as in `docs/robot-file.md`, and MiB for the program itself and the file.
const BYTES_PER_PIXEL: usize = 36;
const PROGRAM: usize = 40;

/// A PNG file of 16 bits per channel with an alpha channel, which needs the most memory to decode: red dots on grey.
fn write_dots(path: &Path, [width, height]: [usize; 2], wall: Wall) {
    let file = BufWriter::new(File::create(path).expect("a file"));
    let mut encoder = png::Encoder::new(file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fastest);
    let mut writer = encoder.write_header().expect("a header");
    let mut stream = writer.stream_writer().expect("a stream");
    let pixel = |rgb: [u16; 3]| -> Vec<u8> {
        rgb.iter().chain(&[u16::MAX]).flat_map(|value| value.to_be_bytes()).collect()
    };
    let (grey, red) = (pixel([45_000; 3]), pixel([50_000, 6_000, 6_000]));
    let mut random = Random::new(1, 0, 0);
    let mut noise = || {
        let bits = random.draw();
        pixel([0, 8, 16].map(|shift| 20_000 + 10_000 * (bits >> shift & 3) as u16))
    };
    let radius = width.min(height) / 60;
    for row in 0..height {
        let mut bytes = match wall {
            Wall::Even => grey.repeat(width),
            Wall::Noisy => (0..width).flat_map(|_| noise()).collect(),
        };
        for k in 1..=10 {
            let off = row.abs_diff(k * height / 11);
            if off <= radius {
                let half = (radius * radius - off * off).isqrt();
                let places = 8 * (width / 2 - half)..8 * (width / 2 + half + 1);
                bytes[places].copy_from_slice(&red.repeat(2 * half + 1));
            }
        }
        stream.write_all(&bytes).expect("a row");
    }
    stream.finish().expect("the end");
}

/// The command finds the dots within the memory that is stated.
pub fn measure(size: [usize; 2], wall: Wall, kinds: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("large.png");
    write_dots(&path, size, wall);
    let file = std::fs::metadata(&path).expect("the file").len() as usize;
    let stated = BYTES_PER_PIXEL * size[0] * size[1] / (1 << 20) + file / (1 << 20) + PROGRAM;
    for &kind in kinds {
        let out = |name: &str| File::create(folder.path().join(name)).expect("a file");
        // Addresses are more than memory: what is mapped for threads and files counts as well.
        let mut command = limited(Path::new(env!("CARGO_BIN_EXE_whipcord")), stated as u64 + 500);
        command
            .args(["measure", "--count", "10", "--base", "bottom", "--kind", kind])
            .arg(&path)
            .stdout(out("stdout"))
            .stderr(out("stderr"));
        let watched = watch(&mut command, Duration::from_secs(1800));
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a text");
        let (stdout, stderr) = (read("stdout"), read("stderr"));
        assert!(watched.status.is_some_and(|status| status.success()), "{watched:?}: {stderr}");
        assert!(stdout.contains(&format!("10 {kind} in")), "{stdout}");
        println!(
            "{kind} in {}×{} pixels, {wall:?}: {:.1} s, {} MiB of {stated}",
            size[0],
            size[1],
            watched.time.as_secs_f64(),
            watched.memory
        );
        assert!(watched.memory > 0 && watched.memory <= stated as u64, "{watched:?}");
    }
}
