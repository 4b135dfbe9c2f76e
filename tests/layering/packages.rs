//! What each crate is when it is packed: it says what it is, and holds all that it reads and no data.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// What a registry takes; a crate that comes near it holds data.
const LARGEST: u64 = 10_000_000;

/// Standard output of cargo. Nothing is asked of a registry.
fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .arg("--offline")
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo {}:\n{errors}", arguments.join(" "));
    String::from_utf8(output.stdout).unwrap()
}

/// The packages of the workspace, as cargo reads their manifests: those that are published, and the others.
fn packages() -> (Vec<Value>, Vec<Value>) {
    let metadata = cargo(&["metadata", "--no-deps", "--format-version=1"]);
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    let packages = metadata["packages"].as_array().unwrap().clone();
    packages.into_iter().partition(|package| package["publish"].is_null())
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

fn folder(package: &Value) -> PathBuf {
    let manifest = Path::new(text(package, "manifest_path"));
    manifest.parent().unwrap().to_path_buf()
}

/// The files of a packed crate that lie in its folder, relative to it; cargo makes the others.
fn packed(package: &Value) -> BTreeSet<PathBuf> {
    let list = cargo(&["package", "--list", "--allow-dirty", "-p", text(package, "name")]);
    let files = list.lines().map(PathBuf::from);
    files.filter(|file| folder(package).join(file).exists()).collect()
}

#[test]
fn every_published_crate_says_what_it_is() {
    let (published, own) = packages();
    let names: Vec<&str> = own.iter().map(|package| text(package, "name")).collect();
    assert_eq!(
        names,
        ["qcar-runtime-tests", "qcar-rides", "qcar-blind"],
        "not published"
    );
    let mut readmes = BTreeSet::new();
    for package in &published {
        let name = text(package, "name");
        for key in ["description", "license", "readme"] {
            assert!(!text(package, key).is_empty(), "{name} has no {key}");
        }
        for key in ["keywords", "categories"] {
            let entries = package[key].as_array().unwrap().len();
            assert!((1..=5).contains(&entries), "{name} has {entries} {key}");
        }
        let readme = fs::read_to_string(folder(package).join(text(package, "readme"))).unwrap();
        assert!(readmes.insert(readme), "{name} has the README of another crate");
    }
}

#[test]
fn a_packed_crate_knows_the_others_by_version() {
    for package in &packages().0 {
        let dependencies = package["dependencies"].as_array().unwrap().iter();
        let own = dependencies.filter(|dependency| dependency["path"].is_string() && dependency["kind"] != "dev");
        for dependency in own {
            let (name, of) = (text(package, "name"), text(dependency, "name"));
            assert_ne!(text(dependency, "req"), "*", "{name} says no version of {of}");
        }
    }
}

#[test]
fn a_packed_crate_holds_what_it_reads_and_no_data() {
    for package in &packages().0 {
        let (name, folder, files) = (text(package, "name"), folder(package), packed(package));
        for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"] {
            assert!(files.contains(Path::new(file)), "{name} lacks {file}");
        }
        for data in ["tests", "benches", "campaigns", "recordings"] {
            assert!(!files.iter().any(|file| file.starts_with(data)), "{name} holds {data}");
        }
        for (by, file) in files.iter().flat_map(|file| included(&folder, file)) {
            let by = by.display();
            assert!(
                files.contains(&file),
                "{name}: {by} includes {}, which is not packed",
                file.display()
            );
        }
        let sizes = files.iter().map(|file| fs::metadata(folder.join(file)).unwrap().len());
        let size: u64 = sizes.sum();
        assert!(size < LARGEST, "{name} has {size} bytes");
    }
}

#[test]
fn packed_models_are_all_models() {
    let (published, _) = packages();
    let models = published.iter().find(|package| text(package, "name") == "qcar-models");
    let files = packed(models.unwrap());
    for folder in ["axles", "families", "effects", "laws"] {
        let here = fs::read_dir(Path::new("models").join(folder)).unwrap().count();
        let there = files.iter().filter(|file| file.starts_with(folder)).count();
        assert_eq!((folder, there), (folder, here));
    }
}

/// The files that a source file includes by a path of its own, each with that source file.
fn included(folder: &Path, file: &Path) -> Vec<(PathBuf, PathBuf)> {
    let text = match file.extension().is_some_and(|extension| extension == "rs") {
        true => fs::read_to_string(folder.join(file)).unwrap(),
        false => String::new(),
    };
    let quoted = ["include_str!(\"", "include_bytes!(\""]
        .into_iter()
        .flat_map(|call| text.split(call).skip(1));
    let paths = quoted.filter_map(|rest| Some(rest.split_once('"')?.0));
    paths
        .map(|path| (file.to_path_buf(), plain(&file.with_file_name(path))))
        .collect()
}

/// A path without `..`, as far as it stays below where it begins.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if plain.file_name().is_some() => drop(plain.pop()),
            part => plain.push(part),
        }
    }
    plain
}

/// CHANGELOG.md, the crates, the Python package and the lock files of the other workspaces.
#[test]
fn the_newest_release_has_the_version_of_the_crates() {
    let version = env!("CARGO_PKG_VERSION");
    let read = |file: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
    let changes = read("CHANGELOG.md");
    let mut releases = changes.lines().filter_map(|line| line.strip_prefix("## "));
    assert_eq!(releases.next(), Some("Unreleased"));
    let newest = releases.next().unwrap();
    assert!(
        newest.starts_with(&format!("{version} - ")),
        "{newest} is the newest release"
    );
    let (published, own) = packages();
    for package in published.iter().chain(&own) {
        assert_eq!(text(package, "version"), version, "{}", text(package, "name"));
    }
    let python: toml::Table = toml::from_str(&read("qcar-python/Cargo.toml")).unwrap();
    assert_eq!(python["package"]["version"].as_str(), Some(version));
    for lock in ["qcar-python/Cargo.lock", "fuzz/Cargo.lock"] {
        let locked = read(lock).replace("\r\n", "\n");
        let entry = format!("name = \"qcar-runtime\"\nversion = \"{version}\"\n");
        assert!(locked.contains(&entry), "{lock} has another version of qcar-runtime");
    }
}
