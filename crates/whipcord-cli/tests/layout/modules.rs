//! The arrows between the modules of a crate, read from the text of its sources.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::{rust_files, workspace_root};

/// Robot, case and solution: what every model takes and gives.
const DATA: [&str; 10] = [
    "cancel",
    "case",
    "error",
    "kind",
    "obstacle",
    "parameter",
    "robot",
    "shape",
    "solution",
    "stations",
];
/// The choice between the models.
const CHOICE: [&str; 2] = ["model", "prepared"];
/// One folder each; none may import another.
const MODELS: [&str; 6] = [
    "constant_curvature",
    "cosserat",
    "cosserat_disks",
    "four_bar",
    "piecewise_constant_curvature",
    "pseudo_rigid_body",
];

/// What several models are built on.
const SHARED: &str = "linkage";

/// Crates whose import cycles lie within one folder of modules.
const LAYERED: [&str; 6] = [
    "whipcord",
    "whipcord-design",
    "whipcord-estimation",
    "whipcord-inverse",
    "whipcord-motion",
    "whipcord-study",
];

/// Crates none of whose files import one another, itself or through others.
const FREE_OF_CYCLES: [&str; 5] =
    ["whipcord", "whipcord-design", "whipcord-estimation", "whipcord-inverse", "whipcord-motion"];

/// A module's path from the root of its crate, without `crate`.
type ModulePath = Vec<String>;

/// The modules of a crate, and the modules that each imports.
struct Imports {
    /// The file of each module, relative to the sources.
    files: BTreeMap<ModulePath, String>,
    /// Names that a module re-exports, and what they are names of.
    reexports: BTreeMap<(ModulePath, String), ModulePath>,
    edges: BTreeMap<String, BTreeSet<String>>,
}

impl Imports {
    fn of(source: &Path) -> Self {
        let mut paths = Vec::new();
        rust_files(source, &mut paths);
        let mut files = BTreeMap::new();
        let mut texts = Vec::new();
        for path in paths {
            let file = path.strip_prefix(source).unwrap().to_str().unwrap().replace('\\', "/");
            let mut module: ModulePath =
                file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
            if module.last().is_some_and(|name| name == "mod" || name == "lib") {
                module.pop();
            }
            texts.push((module.clone(), without_tests(&std::fs::read_to_string(&path).unwrap())));
            files.insert(module, file);
        }
        let mut imports = Self { files, reexports: BTreeMap::new(), edges: BTreeMap::new() };
        let mut found = Vec::new();
        for (module, text) in &texts {
            for (path, public) in paths_in(text) {
                let Some(path) = imports.absolute(module, &path) else { continue };
                if public && let Some(name) = path.last() {
                    imports.reexports.insert((module.clone(), name.clone()), path.clone());
                }
                // What the root of the crate re-exports is no import of the root.
                if !(public && module.is_empty()) {
                    found.push((module, path));
                }
            }
        }
        for (module, path) in found {
            let (from, to) = (&imports.files[module], imports.file_of(&path, 0));
            if let Some(to) = to.filter(|to| to != from) {
                imports.edges.entry(from.clone()).or_default().insert(to);
            }
        }
        imports
    }

    /// A path from the root of the crate; `None` where it leads into another crate.
    fn absolute(&self, module: &ModulePath, path: &[String]) -> Option<ModulePath> {
        let mut here = module.clone();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => return Some(path[1..].to_vec()),
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    here.pop();
                    rest = &rest[1..];
                }
            }
            first => {
                here.push(first.to_owned());
                if !self.files.contains_key(&here) {
                    return None;
                }
                rest = &path[1..];
            }
        }
        here.extend_from_slice(rest);
        Some(here)
    }

    /// The file in which a path is defined.
    fn file_of(&self, path: &[String], depth: usize) -> Option<String> {
        let length = (0..=path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        let (module, rest) = path.split_at(length);
        if let Some(name) = rest.first()
            && let Some(target) = self.reexports.get(&(module.to_vec(), name.clone()))
            && target != path
            && depth < 8
        {
            let target = [target.as_slice(), &rest[1..]].concat();
            return self.file_of(&target, depth + 1);
        }
        self.files.get(module).cloned()
    }

    /// The files that a file imports, itself or through others.
    fn reachable(&self, from: &str) -> BTreeSet<String> {
        let mut reached = BTreeSet::new();
        let mut next = vec![from.to_owned()];
        while let Some(file) = next.pop() {
            for to in self.edges.get(&file).into_iter().flatten() {
                if reached.insert(to.clone()) {
                    next.push(to.clone());
                }
            }
        }
        reached
    }
}

/// Source without comments, visibilities with a path, and the test module at its end.
fn without_tests(text: &str) -> String {
    let lines: Vec<&str> =
        text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code)).collect();
    let mut text = lines.join("\n");
    while let Some(start) = text.find("pub(in ")
        && let Some(length) = text[start..].find(')')
    {
        text.replace_range(start..=start + length, "pub");
    }
    match text.find("#[cfg(test)]\nmod tests {") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// Paths that a source names: those of its `use` declarations, with whether they are public, and those
/// that begin with `crate` or `super` elsewhere.
fn paths_in(text: &str) -> Vec<(Vec<String>, bool)> {
    let mut found = Vec::new();
    let mut rest = String::new();
    for statement in text.split_inclusive(';') {
        let declaration = statement.rsplit_once("use ").filter(|(before, _)| {
            let line = before.rsplit('\n').next().unwrap_or_default().trim();
            line.is_empty() || line == "pub" || line.starts_with("pub(") && line.ends_with(')')
        });
        match declaration {
            Some((before, tree)) => {
                let public = before.rsplit('\n').next().unwrap_or_default().contains("pub");
                leaves(tree.trim_end_matches(';'), &[], public, &mut found);
                rest.push_str(before);
            }
            None => rest.push_str(statement),
        }
    }
    for start in ["crate::", "super::"] {
        for (at, _) in rest.match_indices(start) {
            let before = rest[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let end = rest[at..]
                .find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'))
                .map_or(rest.len(), |length| at + length);
            let names = rest[at..end].split("::").filter(|name| !name.is_empty());
            found.push((names.map(str::to_owned).collect(), false));
        }
    }
    found
}

/// The paths of a `use` tree.
fn leaves(tree: &str, prefix: &[String], public: bool, out: &mut Vec<(Vec<String>, bool)>) {
    let tree = tree.trim();
    let names = |part: &str| -> Vec<String> {
        part.split("::")
            .map(|name| name.trim().to_owned())
            .filter(|name| !name.is_empty())
            .collect()
    };
    let Some((head, group)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        out.push(([prefix, &names(path)].concat(), public));
        return;
    };
    let prefix = [prefix, &names(head)].concat();
    let group = group.trim_end().strip_suffix('}').unwrap_or(group);
    let (mut depth, mut start) = (0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                leaves(&group[start..at], &prefix, public, out);
                start = at + 1;
            }
            _ => {}
        }
    }
    if !group[start..].trim().is_empty() {
        leaves(&group[start..], &prefix, public, out);
    }
}

/// The folder of a file, or the file itself where it lies beside the folders.
fn folder(file: &str) -> &str {
    file.split('/').next().unwrap_or(file).trim_end_matches(".rs")
}

fn mechanics() -> Imports {
    let imports = Imports::of(&workspace_root().join("crates/whipcord/src"));
    assert!(imports.edges.len() > 50, "the sources of the mechanics were not read");
    imports
}

#[test]
fn no_model_imports_a_sibling() {
    let imports = mechanics();
    for model in MODELS {
        assert!(imports.files.contains_key(&vec![model.to_owned()]), "{model} is no module");
    }
    for (from, targets) in &imports.edges {
        for to in targets {
            let between = [folder(from), folder(to)];
            let siblings = between[0] != between[1] && between.iter().all(|f| MODELS.contains(f));
            assert!(!siblings, "{from} imports {to}: what two models share belongs to neither");
            let upward = between[0] == SHARED && MODELS.contains(&between[1]);
            assert!(!upward, "{from} imports {to}, which is built on it");
        }
    }
}

#[test]
fn data_import_no_model() {
    let imports = mechanics();
    for file in imports.files.values().filter(|file| DATA.contains(&folder(file))) {
        let reached = imports.reachable(file);
        let is_model = |of: &str| MODELS.contains(&of) || CHOICE.contains(&of);
        let model = reached.iter().find(|to| is_model(folder(to)));
        assert_eq!(model, None, "{file} imports a model, itself or through others");
    }
}

#[test]
fn import_cycles_lie_within_one_folder() {
    for name in LAYERED {
        let imports = Imports::of(&workspace_root().join("crates").join(name).join("src"));
        assert!(imports.edges.len() > 10, "the sources of {name} were not read");
        for file in imports.edges.keys() {
            for other in imports.reachable(file) {
                let cycle =
                    folder(&other) != folder(file) && imports.reachable(&other).contains(file);
                assert!(!cycle, "{name}: {file} and {other} import one another, or through others");
            }
        }
    }
}

#[test]
fn no_import_cycle_between_files() {
    for name in FREE_OF_CYCLES {
        let imports = Imports::of(&workspace_root().join("crates").join(name).join("src"));
        let reached: BTreeMap<&str, BTreeSet<String>> =
            imports.edges.keys().map(|file| (file.as_str(), imports.reachable(file))).collect();
        for (file, others) in &reached {
            // A cycle leads back to where it starts.
            let cycle = others.contains(*file);
            let on_cycle = |other: &&String| {
                *other != file && reached.get(other.as_str()).is_some_and(|r| r.contains(*file))
            };
            let with = others.iter().find(on_cycle);
            assert!(
                !cycle,
                "{name}: {file} and {with:?} import one another, or through others: move what both need into a module of its own"
            );
        }
    }
}

#[test]
fn imports_are_read_from_declarations_and_paths() {
    let text = "pub use a::{b, c::{D, self}};\nuse super::e as f;\npub(in crate::i) fn j() {\nlet x = crate::g::h(1);";
    let found = paths_in(&without_tests(text));
    let paths: Vec<String> = found.iter().map(|(path, _)| path.join("::")).collect();
    assert_eq!(paths, ["a::b", "a::c::D", "a::c::self", "super::e", "crate::g::h"]);
    assert_eq!(found.iter().filter(|(_, public)| *public).count(), 3);
}
