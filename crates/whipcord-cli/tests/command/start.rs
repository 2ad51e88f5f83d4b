//! Examples, templates, standard input, completions, manual pages and the width of the help.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{Run, Scratch, command, fail, robot, root, run, succeed};
use serde_json::Value;

/// The files of a folder and of those in it, by their paths with slashes.
fn files_of(folder: &Path) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            found.extend(files_of(&path).into_iter().map(|below| format!("{name}/{below}")));
        } else {
            found.insert(name);
        }
    }
    found
}

/// Runs the command with this on its standard input.
fn fed(args: &[&str], input: &[u8], folder: &Path) -> Run {
    let mut command = command(args);
    command.current_dir(folder).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    // A command that refuses its input closes it.
    let _ = child.stdin.take().unwrap().write_all(input);
    let output = child.wait_with_output().unwrap();
    Run {
        status: output.status.code().expect("the command ends by itself"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

#[test]
fn the_examples_are_those_of_the_repository() {
    let folder = root().join("examples");
    let scratch = Scratch::new();
    let copy = scratch.file("new/copy");
    let told = succeed(&["examples", "--copy", &copy]);
    let names = files_of(&folder);
    assert_eq!(files_of(Path::new(&copy)), names);
    let written: BTreeSet<String> = told.lines().map(str::to_owned).collect();
    let expected =
        names.iter().map(|name| Path::new(&copy).join(name).display().to_string()).collect();
    assert_eq!(written, expected);
    for name in &names {
        let carried = fs::read(Path::new(&copy).join(name)).unwrap();
        assert_eq!(carried, fs::read(folder.join(name)).unwrap(), "{name}");
    }
    // What a copy extends and names is beside it.
    succeed(&["solve", &format!("{copy}/table1/case-3.toml")]);
    let list = succeed(&["examples"]);
    for name in &names {
        let line = list.lines().find(|line| line.starts_with(name.as_str()));
        let title = line.unwrap().strip_prefix(name.as_str()).unwrap().trim();
        if name.ends_with(".toml") {
            assert_eq!(whipcord_io::load(folder.join(name)).unwrap().title, title);
        } else {
            assert_eq!(title, "triangle mesh", "{name}");
        }
    }
}

#[test]
fn examples_overwrite_nothing_unasked() {
    let scratch = Scratch::new();
    let own = scratch.write("helical-finger.toml", "my own\n");
    let folder = scratch.path().to_str().unwrap();
    let message = fail(2, &["examples", "--copy", folder]);
    assert!(
        message.contains("helical-finger.toml would be overwritten; nothing was written"),
        "{message}"
    );
    assert_eq!(files_of(scratch.path()).len(), 1);
    assert_eq!(fs::read_to_string(&own).unwrap(), "my own\n");
    succeed(&["examples", "--copy", folder, "--force"]);
    assert!(fs::read_to_string(&own).unwrap().contains("Helical gripper finger"));
    let message = fail(2, &["examples", "--copy", folder]);
    let others = files_of(scratch.path()).len() - 1;
    assert!(
        message.contains(&format!(
            "composite-finger.toml and {others} other files would be overwritten"
        )),
        "{message}"
    );
    fail(2, &["examples", "--force"]);
}

/// What a person gets if all the keys that a template shows as comments are used.
fn with_all_keys(template: &str) -> String {
    let is_key = |line: &str| {
        let key = line.split(" = ").next().unwrap_or_default();
        line.starts_with('[')
            || (line.contains(" = ") && key.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'))
    };
    template
        .lines()
        .map(|line| match line.strip_prefix("# ").filter(|rest| is_key(rest)) {
            // Friction at the holes is for one model alone.
            Some(key) if !key.contains("--model") => format!("{key}\n"),
            _ => format!("{line}\n"),
        })
        .collect()
}

#[test]
fn templates_are_taken_without_warnings() {
    for (kind, bend) in [
        ("arm", 50.0..60.0),
        ("helical", 30.0..60.0),
        ("tapered", 50.0..60.0),
        ("gripper", 150.0..200.0),
    ] {
        let scratch = Scratch::new();
        let file = scratch.file("robot.toml");
        let told = succeed(&["new", &file, "--kind", kind]);
        assert!(told.starts_with(&format!("{file}\n")), "{told}");
        succeed(&["check", &file, "--deny-warnings"]);
        // Tension and shortening of a template ask for about the same shape.
        let [by_tension, by_shortening] = ["tension", "shortening"].map(|actuation| {
            let solved = succeed(&["solve", &file, "--deny-warnings", "--actuation", actuation]);
            assert_eq!(solved.contains("ball"), kind == "gripper", "{solved}");
            let angle = solved.lines().find_map(|line| line.strip_prefix("bend ")).unwrap();
            angle.trim().split('°').next().unwrap().parse::<f64>().unwrap()
        });
        assert!(bend.contains(&by_tension), "{kind} bends by {by_tension}°");
        assert!((by_shortening / by_tension - 1.0).abs() < 0.15, "{kind}: {by_shortening}°");
        let text = fs::read_to_string(&file).unwrap();
        let all = scratch.write("all.toml", &with_all_keys(&text));
        let checked = run(&["check", &all]);
        assert_eq!(checked.status, 0, "{}", checked.stderr);
        assert!(checked.stdout.contains("gravity") && checked.stdout.contains("turned by 90°"));
        let solved = run(&["solve", &all]);
        assert_eq!(solved.status, 0, "{kind}: {}", solved.stderr);
    }
}

#[test]
fn a_template_overwrites_nothing_unasked() {
    let scratch = Scratch::new();
    let file = scratch.write("robot.toml", "my own\n");
    let message = fail(2, &["new", &file, "--kind", "arm"]);
    assert!(message.contains("robot.toml exists") && message.contains("--force"), "{message}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "my own\n");
    succeed(&["new", &file, "--kind", "arm", "--force"]);
    succeed(&["check", &file]);
    fail(2, &["new", &scratch.file("robot.txt"), "--kind", "arm"]);
    fail(2, &["new", &scratch.file("none/robot.toml"), "--kind", "arm"]);
    let message = fail(2, &["new", &scratch.file("leg.toml"), "--kind", "leg"]);
    assert!(message.contains("arm, helical, tapered, gripper"), "{message}");
}

#[test]
fn nothing_is_asked_without_a_terminal() {
    let scratch = Scratch::new();
    let run = fed(&["new", "robot.toml"], b"arm\n\n\n\n\n\n", scratch.path());
    assert_eq!((run.status, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("give --kind arm|helical|tapered|gripper"), "{}", run.stderr);
    assert!(files_of(scratch.path()).is_empty());
}

#[test]
fn a_robot_is_read_from_standard_input() {
    let scratch = Scratch::new();
    let text = robot("tension = \"2 N\"");
    let file = scratch.write("robot.toml", &text);
    for args in [vec!["solve", "-", "--csv"], vec!["stiffness", "-"], vec!["check", "-"]] {
        let mut of_file = args.clone();
        of_file[1] = &file;
        let piped = fed(&args, text.as_bytes(), scratch.path());
        assert_eq!((piped.status, piped.stderr.as_str()), (0, ""), "{args:?}");
        assert_eq!(piped.stdout.replace("<stdin>", &file), succeed(&of_file), "{args:?}");
    }
    // Keys are set, and files beside it are those of the current folder.
    let set = [
        "solve",
        "-",
        "--csv",
        "--set",
        "cables.pull.tension=3 N",
        "--set",
        "backbone.length=160 mm",
    ];
    let other = robot("tension = \"3 N\"").replace("180 mm", "160 mm");
    let other = fed(&["solve", "-", "--csv"], other.as_bytes(), scratch.path());
    assert_eq!(fed(&set, b"extends = 'robot.toml'\n", scratch.path()).stdout, other.stdout);
    let named = fed(&["check", "-", "--json"], text.as_bytes(), scratch.path());
    let json: Value = serde_json::from_str(&named.stdout).unwrap();
    assert_eq!(json["files"][0]["path"], "<stdin>");
}

#[test]
fn what_standard_input_cannot_be_is_refused() {
    let scratch = Scratch::new();
    let refused = |args: &[&str], input: &[u8], why: &[&str]| {
        let run = fed(args, input, scratch.path());
        assert_eq!((run.status, run.stdout.as_str()), (2, ""), "{args:?}");
        for words in why {
            assert!(run.stderr.contains(words), "{words:?} is not in {}", run.stderr);
        }
    };
    let bad = robot("tension = \"2 mm\"");
    refused(&["solve", "-"], bad.as_bytes(), &["<stdin>:15:11: error: `mm` is a unit of length"]);
    refused(&["solve", "-"], b"", &["<stdin>:1:1: error: the file has no [backbone]"]);
    refused(&["solve", "-"], &[b'#'; (1 << 20) + 1], &["<stdin>", "more than 1048576 bytes"]);
    refused(&["check", "-"], b"title = '\xff'", &["not UTF-8 text: byte 9 is 0xFF"]);
    let unread = "there is no file of this name, and standard input is not read here";
    refused(&["solve", "-"], b"extends = '-'", &["<stdin>:1:11: error: cannot read `-`", unread]);
    refused(&["solve", "-"], b"extends = '<stdin>'", &["`extends` goes round in a circle"]);
    refused(&["view", "-", "--no-open"], b"", &[unread]);
    let file = scratch.write("robot.toml", &robot("tension = 1"));
    let twice = "standard input (-) can be read only once";
    refused(&["check", "-", &file, "-"], b"", &[twice]);
    refused(&["compare", "-", "-"], b"", &[twice]);
}

#[test]
fn results_of_standard_input_have_a_plain_name() {
    let scratch = Scratch::new();
    let text = robot("tension = \"2 N\"\nshortening = \"2 %\"");
    let args = ["compare", "-", "--model", "four-bar", "--out", "out"];
    let run = fed(&args, text.as_bytes(), scratch.path());
    assert_eq!(run.status, 0, "{}", run.stderr);
    let names = files_of(&scratch.path().join("out"));
    assert!(names.iter().any(|name| name.starts_with("stdin")), "{names:?}");
    assert!(!names.iter().any(|name| name.contains(['<', '>'])), "{names:?}");
}

#[test]
fn shells_complete_verbs_options_and_models() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = succeed(&["completions", shell]);
        for word in ["whipcord", "stiffness", "deny-warnings", "completions"] {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
        // The other two know no values of options.
        if ["bash", "zsh", "fish"].contains(&shell) {
            assert!(script.contains("pseudo-rigid-body"), "{shell}");
        }
    }
    assert!(fail(2, &["completions", "tcsh"]).contains("bash"));
}

/// What bash offers after these words.
#[cfg(target_os = "linux")]
fn offered(words: &[&str]) -> BTreeSet<String> {
    let scratch = Scratch::new();
    let script = scratch.write("whipcord.bash", &succeed(&["completions", "bash"]));
    let last = words.len() - 1;
    let ask = format!(
        "source '{script}' && COMP_WORDS=({}) COMP_CWORD={last} && \
         _whipcord whipcord '{}' '{}' && printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        words.join(" "),
        words[last],
        words[last - 1],
    );
    let output = Command::new("bash").args(["--norc", "-c", &ask]).output().expect("bash starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

#[cfg(target_os = "linux")]
#[test]
fn bash_completes() {
    let set = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<BTreeSet<_>>();
    assert_eq!(offered(&["whipcord", "st"]), set(&["stiffness"]));
    assert_eq!(
        offered(&["whipcord", "solve", "--model", "cos"]),
        set(&["cosserat", "cosserat-disks"])
    );
    assert_eq!(offered(&["whipcord", "new", "--kind", "h"]), set(&["helical"]));
    assert_eq!(offered(&["whipcord", "examples", "--co"]), set(&["--copy"]));
}

#[test]
fn there_is_a_manual_page_for_each_verb() {
    let scratch = Scratch::new();
    let folder = scratch.file("man1");
    let told = succeed(&["man", &folder]);
    let names = files_of(Path::new(&folder));
    assert_eq!(told.lines().count(), names.len());
    let main = fs::read_to_string(format!("{folder}/whipcord.1")).unwrap();
    assert_eq!(succeed(&["man"]), main);
    // The verbs as the help lists them.
    let help = succeed(&["--help"]);
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let verbs = list.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let verbs: Vec<&str> = verbs.filter(|verb| !verb.is_empty() && *verb != "help").collect();
    assert!(verbs.len() >= 15, "{verbs:?}");
    for verb in verbs {
        let page = fs::read_to_string(format!("{folder}/whipcord-{verb}.1")).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(".SH SYNOPSIS"), "{page}");
        assert!(main.contains(&format!("whipcord\\-{verb}(1)")), "{main}");
    }
    assert!(names.contains("whipcord-camera-locate.1"), "{names:?}");
}

#[test]
fn help_is_wrapped_to_the_terminal() {
    // Without a terminal its width is that of the environment.
    let page = |columns: &str| {
        let output = command(&["solve", "--help"]).env("COLUMNS", columns).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let widest = |page: &str| page.lines().map(|line| line.chars().count()).max().unwrap();
    let (narrow, wide) = (page("60"), page("200"));
    assert!(widest(&narrow) <= 60, "{narrow}");
    assert!((90..=100).contains(&widest(&wide)), "{wide}");
}
