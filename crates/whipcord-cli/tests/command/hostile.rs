//! Files made to take more memory or time than there is, and paths that are unusual.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, SystemTime};

use crate::support::{Scratch, robot, run};

/// Runs the command under a limit of the shell, such as `-v` and a number of KiB of memory.
fn limited(limit: &str, args: &[&OsStr]) -> Output {
    let limit = if limit.is_empty() { String::new() } else { format!("ulimit {limit} &&") };
    let script = format!("ulimit -c 0 && {limit} exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_whipcord")]).args(args);
    command.output().expect("the shell starts")
}

/// What it says when it fails with this status under a limit of memory in MiB.
fn refused_within(mebibytes: u32, status: i32, args: &[&str]) -> String {
    let args: Vec<&OsStr> = args.iter().map(OsStr::new).collect();
    let Output { status: ended, stdout, stderr } =
        limited(&format!("-v {}", 1024 * mebibytes), &args);
    let stderr = String::from_utf8(stderr).unwrap();
    assert_eq!((ended.code(), stdout.as_slice()), (Some(status), &b""[..]), "{ended}: {stderr}");
    stderr
}

/// The checksum of a PNG chunk.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| (c >> 1) ^ (0xedb8_8320 * (c & 1)))
    })
}

fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let named = [&kind[..], content].concat();
    [&u32::try_from(content.len()).unwrap().to_be_bytes()[..], &named, &crc(&named).to_be_bytes()]
        .concat()
}

/// So many bytes 0 as a zlib stream: a literal, and matches of 258 bytes in 13 bits each.
fn zeros(count: usize) -> Vec<u8> {
    let (mut out, mut bits, mut held) = (vec![0x78, 0x01], 0_u64, 0);
    let mut put = |value: u64, width: u32| {
        bits |= value << held;
        held += width;
        while held >= 8 {
            out.push(bits as u8);
            bits >>= 8;
            held -= 8;
        }
    };
    // The last block, in the fixed code; the literal 0; the matches, length 285 and distance 0; the end.
    put(0b011, 3);
    put(0b0000_1100, 8);
    (0..count / 258).for_each(|_| put(0b1010_0011, 13));
    put(0, 7);
    put(0, 7);
    out
}

/// A PNG of one pixel of this size in its header, with chunks before its pixels.
fn png(size: [u32; 2], depth_and_colour: [u8; 2], before: &[u8]) -> Vec<u8> {
    let [width, height] = size.map(u32::to_be_bytes);
    let header = [&width[..], &height, &depth_and_colour, &[0; 3]].concat();
    // One row of one grey pixel, stored.
    let pixel = [0x78, 0x01, 0x01, 0x02, 0x00, 0xfd, 0xff, 0, 9, 0x00, 0x0b, 0x00, 0x0a];
    let parts =
        [chunk(b"IHDR", &header), before.to_vec(), chunk(b"IDAT", &pixel), chunk(b"IEND", &[])];
    [&b"\x89PNG\r\n\x1a\n"[..], &parts.concat()].concat()
}

#[test]
fn a_colour_profile_of_a_gigabyte_takes_no_memory() {
    let scratch = Scratch::new();
    let profile = [&b"huge\0\0"[..], &zeros(1 << 30)].concat();
    let photo = scratch.write("photo.png", &png([1, 1], [8, 0], &chunk(b"iCCP", &profile)));
    let message = refused_within(600, 2, &["measure", &photo]);
    assert!(message.starts_with("error: "), "{message}");
}

#[test]
fn photographs_of_too_many_pixels_are_refused() {
    let scratch = Scratch::new();
    let photo = scratch.write("photo.png", &png([10_000, 10_000], [16, 6], &[]));
    let message = refused_within(600, 2, &["measure", &photo]);
    for part in ["10000×10000 pixels", "64000000", "scale it down"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn thousands_of_cables_are_refused() {
    let scratch = Scratch::new();
    let cables = "[[cables]]\nholes = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n".repeat(19_999);
    let file = scratch.write("robot.toml", &robot(&cables));
    for verb in ["check", "solve"] {
        let message = refused_within(600, 2, &[verb, &file]);
        let parts =
            ["must have at most 100 entries, but has 20000", "give 100 or fewer", "[[cables]]"];
        for part in parts {
            assert!(message.contains(part), "{message}");
        }
    }
    let disks = scratch.write("disks.toml", &robot("").replace("count = 10", "count = 100000"));
    let message = refused_within(600, 2, &["check", &disks]);
    assert!(message.contains("must be at most 2000, but is 100000"), "{message}");
}

/// Time in proportion to their number: with its square these would take more than the limit.
#[test]
fn ten_thousand_steps_take_seconds() {
    let scratch = Scratch::new();
    let steps: String =
        (0..10_000).map(|i| format!("[[steps]]\nshortening = [{}e-3]\n", i % 5)).collect();
    let file = scratch.write("robot.toml", &robot(&steps));
    for format in [&["--csv"][..], &["--json"], &[]] {
        let args = [&["solve", &file, "--model=constant-curvature"], format].concat();
        let args: Vec<&OsStr> = args.iter().map(OsStr::new).collect();
        let output = limited("-t 8", &args);
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{format:?}: {} {message}", output.status);
    }
}

/// A name in no encoding that programs agree on.
fn odd_name(scratch: &Scratch, extension: &str) -> OsString {
    let name = [b"r\xe9sultat \xff".as_slice(), extension.as_bytes()].concat();
    scratch.path().join(OsStr::from_bytes(&name)).into_os_string()
}

#[test]
fn paths_need_not_be_text() {
    let scratch = Scratch::new();
    let file = odd_name(&scratch, ".toml");
    fs::write(&file, robot("tension = 1")).unwrap();
    let csv = odd_name(&scratch, ".csv");
    for (verb, plot) in [("solve", ".svg"), ("solve", ".PNG"), ("stiffness", ".svg")] {
        let plot = odd_name(&scratch, plot);
        let output = limited("", &[OsStr::new(verb), &file, OsStr::new("--plot"), &plot]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), &*message), (Some(0), ""), "{verb}");
        assert!(fs::metadata(&plot).is_ok_and(|found| found.len() > 1000), "{verb}");
    }
    let out = limited("", &[OsStr::new("solve"), &file, OsStr::new("--plot"), &csv]);
    let message = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2));
    assert!(message.contains("the name must end in .svg or .png"), "{message}");
}

/// A link is there so that something else is written, also before that exists.
#[test]
fn what_a_link_leads_to_is_written() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("tension = 1"));
    fs::create_dir(scratch.path().join("results")).unwrap();
    symlink("results/real.svg", scratch.path().join("link.svg")).unwrap();
    let link = scratch.file("link.svg");
    assert_eq!(run(&["solve", &file, "--plot", &link]).status, 0);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(scratch.path().join("results/real.svg").is_file());
}

/// A link to what is not there, and cannot be made there, is named with its target.
#[test]
fn links_to_missing_folders_are_named() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("tension = 1"));
    symlink("results/real.svg", scratch.path().join("link.svg")).unwrap();
    symlink("results", scratch.path().join("link")).unwrap();
    let missing = scratch.file("nowhere/a.svg");
    let folder = scratch.path().display().to_string();
    let refused = |args: &[&str]| {
        let refused = run(args);
        assert_eq!((refused.status, refused.stdout.as_str()), (2, ""), "{}", refused.stderr);
        refused.stderr.replace(&format!("{folder}/"), "")
    };
    assert_eq!(
        refused(&["solve", &file, "--plot", &scratch.file("link.svg")]),
        "error: cannot write link.svg: it is a symbolic link to results/real.svg, and the folder results does not exist\n"
    );
    assert_eq!(
        refused(&["solve", &file, "--plot", &missing]),
        "error: cannot write nowhere/a.svg: the folder nowhere does not exist\n"
    );
    assert_eq!(
        refused(&["compare", &file, "--out", &scratch.file("link")]),
        "error: cannot create link: it is a symbolic link to results, which does not exist: create that folder, or remove the link\n"
    );
    assert_eq!(files(scratch.path()), ["link", "link.svg", "robot.toml"]);
}

fn files(folder: &Path) -> Vec<OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    names
}

/// A process that is killed while it writes cannot remove what it wrote; the next one does.
#[test]
fn the_rest_of_a_killed_process_is_removed() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", &robot("tension = 1"));
    let out = scratch.path().join("out");
    fs::create_dir(&out).unwrap();
    let picture = out.join("picture.svg");
    let args = [OsStr::new("solve"), OsStr::new(&file), OsStr::new("--plot"), picture.as_os_str()];
    // The signal comes when the file grows beyond a block.
    let killed = limited("-f 1", &args);
    assert!(killed.status.signal().is_some(), "{}", killed.status);
    let left = files(&out);
    assert_eq!(left.len(), 1, "{left:?}");
    let old = fs::File::options().write(true).open(out.join(&left[0])).unwrap();
    old.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
    drop(old);
    assert!(limited("", &args).status.success());
    assert_eq!(files(&out), [OsStr::new("picture.svg")]);
}
