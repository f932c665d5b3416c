//! The house's plan, checked: which crate may see which, and what only some may use.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Who may see whom; a crate that is missing here has no place in the house yet.
const PLAN: [(&str, &[&str]); 8] = [
    ("asami-math", &[]),
    ("asami-dataset", &["asami-math"]),
    ("asami-raycast", &["asami-math"]),
    ("asami-sim", &["asami-dataset", "asami-math", "asami-raycast"]),
    ("asami-scans", &["asami-dataset", "asami-math"]),
    ("asami-learners", &["asami-dataset", "asami-math", "asami-scans"]),
    ("asami-gap", &["asami-dataset", "asami-math", "asami-scans", "asami-sim"]),
    ("asami", &["asami-dataset", "asami-gap", "asami-learners", "asami-math", "asami-sim"]),
];

/// Drawers into which anything would fit.
const DRAWERS: [&str; 6] = ["utils", "util", "common", "core", "helpers", "misc"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of a package of ours.
fn folder(package: &str) -> PathBuf {
    match package.strip_prefix("asami-") {
        None => root().to_owned(),
        Some("raycast") => root().join("sim/raycast"),
        Some(name) => root().join(name),
    }
}

/// Every manifest of the workspace: package name and the asami packages of any kind of dependency.
fn manifests() -> BTreeMap<String, BTreeSet<String>> {
    let workspace: toml::Table = read(&root().join("Cargo.toml"));
    let members = workspace["workspace"]["members"].as_array().expect("members").iter();
    let folders = members.map(|member| root().join(member.as_str().expect("a path"))).chain([root().to_owned()]);
    folders.map(|folder| sees(&read(&folder.join("Cargo.toml")))).collect()
}

fn read(path: &Path) -> toml::Table {
    std::fs::read_to_string(path).expect("a manifest").parse().expect("TOML")
}

fn sees(manifest: &toml::Table) -> (String, BTreeSet<String>) {
    let name = manifest["package"]["name"].as_str().expect("a name").to_owned();
    let own = ["dependencies", "dev-dependencies", "build-dependencies"].map(|kind| manifest.get(kind));
    let by_target = manifest.get("target").and_then(|target| target.as_table());
    let by_target = by_target
        .into_iter()
        .flat_map(|targets| targets.values())
        .flat_map(|target| ["dependencies", "dev-dependencies", "build-dependencies"].map(|kind| target.get(kind)));
    let tables = own.into_iter().chain(by_target).flatten().filter_map(|table| table.as_table());
    let ours = tables.flat_map(|table| table.iter()).map(|(key, value)| {
        // A renamed dependency carries its package's name.
        value.get("package").and_then(|package| package.as_str()).unwrap_or(key).to_owned()
    });
    (name, ours.filter(|name| name.starts_with("asami")).collect())
}

fn forbidden(found: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let plan: BTreeMap<&str, &[&str]> = PLAN.into_iter().collect();
    let mut wrong = Vec::new();
    for (name, seen) in found {
        match plan.get(name.as_str()) {
            None => wrong.push(format!("{name} is not in the plan")),
            Some(may) => wrong.extend(
                seen.iter().filter(|other| !may.contains(&other.as_str())).map(|other| format!("{name} sees {other}")),
            ),
        }
    }
    wrong
}

#[test]
fn every_arrow_is_in_the_plan() {
    let found = manifests();
    assert_eq!(found.len(), PLAN.len(), "the plan is out of date: {:?}", found.keys());
    assert_eq!(forbidden(&found), Vec::<String>::new());
}

#[test]
fn a_forbidden_arrow_is_seen_in_any_kind_of_dependency() {
    for kind in ["dependencies", "dev-dependencies", "build-dependencies", "target.'cfg(unix)'.dependencies"] {
        let text = format!("[package]\nname = 'asami-learners'\n[{kind}]\nworld = {{ package = 'asami-sim' }}\n");
        let found = BTreeMap::from([sees(&text.parse().expect("TOML"))]);
        assert_eq!(forbidden(&found), ["asami-learners sees asami-sim"], "{kind}");
    }
}

#[test]
fn only_the_simulator_uses_the_physics_engine() {
    let users = |part: &str| -> Vec<String> {
        let holds = |name: &str| {
            let manifest = read(&folder(name).join("Cargo.toml"));
            ["dependencies", "dev-dependencies"]
                .iter()
                .filter_map(|kind| manifest.get(*kind)?.as_table())
                .any(|table| table.keys().any(|key| key.starts_with(part)))
        };
        PLAN.iter().map(|(name, _)| (*name).to_owned()).filter(|name| holds(name)).collect()
    };
    assert_eq!(users("rapier3d"), ["asami-sim"]);
    assert_eq!(users("parry3d"), ["asami-raycast"]);
    // Learners neither run in parallel nor print progress: whoever calls them does.
    for part in ["indicatif", "clap"] {
        assert_eq!(users(part), ["asami"], "{part}");
    }
    assert!(!users("rayon").contains(&"asami-learners".to_owned()));
}

#[test]
fn only_the_ray_caster_may_use_unsafe_code() {
    let workspace: toml::Table = read(&root().join("Cargo.toml"));
    assert_eq!(workspace["workspace"]["lints"]["rust"]["unsafe_code"].as_str(), Some("forbid"));
    for (name, _) in PLAN {
        let lints = read(&folder(name).join("Cargo.toml"))["lints"].clone();
        let kept = lints.get("workspace").and_then(toml::Value::as_bool) == Some(true);
        assert_eq!(kept, name != "asami-raycast", "{name}");
    }
}

#[test]
fn there_are_no_drawers() {
    let mut files = Vec::new();
    for part in
        ["src", "math/src", "dataset/src", "sim/src", "sim/raycast", "learners/src", "gap/src", "tests", "benches"]
    {
        collect(&root().join(part), &mut files);
    }
    assert!(files.len() > 50, "the walk found only {} files", files.len());
    for file in files {
        let stem = file.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        assert!(!DRAWERS.contains(&stem), "{} is a drawer", file.display());
    }
}

fn collect(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, into);
        }
        into.push(path);
    }
}

/// Learners and the ground floors get no file, clock or print from the standard library.
#[test]
fn learners_use_no_file_no_clock_and_do_not_print() {
    let mut files = Vec::new();
    collect(&root().join("learners/src"), &mut files);
    collect(&root().join("math/src"), &mut files);
    collect(&root().join("gap/src"), &mut files);
    for file in files.into_iter().filter(|file| file.extension().is_some_and(|extension| extension == "rs")) {
        let text = std::fs::read_to_string(&file).expect("a source");
        for banned in ["std::fs", "std::time", "std::env", "println!", "print!(", "HashMap", "thread_rng", "rand::rng("]
        {
            assert!(!text.contains(banned), "{} uses {banned}", file.display());
        }
    }
}

/// Libraries outlive a change of some folders, planted cases one of fewer (build.rs): nobody may learn, or weigh, by what is
/// in those.
#[test]
fn what_is_kept_is_made_without_what_it_outlives() {
    let gap = root().join("gap/src");
    let mut files = Vec::new();
    collect(&gap, &mut files);
    let is_in = |file: &Path, folders: &[&str]| folders.iter().any(|folder| file.starts_with(gap.join(folder)));
    let sources = |file: &&PathBuf| file.extension().is_some_and(|it| it == "rs") && !file.ends_with("src/lib.rs");
    for (outlived, uses) in [
        (&["answer", "real", "weigh"][..], &["answer::", "real::", "weigh::", "noisy_as("][..]),
        (&["answer", "real"], &["answer::", "real::", "noisy_as("]),
    ] {
        let makers: Vec<&PathBuf> = files.iter().filter(sources).filter(|file| !is_in(file, outlived)).collect();
        assert!(makers.len() > 30, "{}", makers.len());
        for file in makers {
            let text = std::fs::read_to_string(file).expect("a source file");
            for used in uses {
                assert!(!text.contains(used), "{} uses {used}", file.display());
            }
        }
    }
}

/// A library of robots among landmarks outlives a change of how cars are followed (build.rs): beside the name of the other kind of
/// library, and of what can go wrong with it, nobody there may use it.
#[test]
fn what_is_kept_of_robots_among_landmarks_is_made_without_cars() {
    let gap = root().join("gap/src");
    let mut files = Vec::new();
    collect(&gap, &mut files);
    let others = ["drive", "answer", "real"].map(|folder| gap.join(folder));
    files.retain(|file| file.extension().is_some_and(|it| it == "rs") && !file.ends_with("src/lib.rs"));
    files.retain(|file| !others.iter().any(|folder| file.starts_with(folder)));
    assert!(files.len() > 30, "{}", files.len());
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source file");
        let text = text.replace("crate::drive::Drives", "").replace("crate::drive::motion::CannotFollow", "");
        assert!(!text.contains("drive::") && !text.contains("asami_scans"), "{} uses cars", file.display());
    }
}
