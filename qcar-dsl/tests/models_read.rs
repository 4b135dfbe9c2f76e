//! Every model that the compiler ships for reads, prints and reads again as the same tree.

use std::path::Path;

use qcar_dsl::check::{check_members, check_tokens};
use qcar_dsl::compile::check;
use qcar_dsl::parse::parse_text;
use qcar_dsl::source::Source;

fn models() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn files(folder: &str) -> Vec<std::path::PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(models().join(folder))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.sort();
    files
}

fn read(path: &Path) -> Source {
    Source {
        name: path.display().to_string(),
        text: std::fs::read_to_string(path).unwrap(),
    }
}

fn load(from: &str, path: &str) -> Result<Source, String> {
    let path = Path::new(from).parent().unwrap().join(path);
    let text = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
    Ok(Source {
        name: path.display().to_string(),
        text,
    })
}

#[test]
fn every_axle_is_accepted() {
    for file in files("axles") {
        let checked = check(read(&file), &load).unwrap_or_else(|report| panic!("{report}"));
        assert!(checked.warnings().diagnostics.is_empty(), "{}", checked.warnings());
    }
}

#[test]
fn every_member_of_the_family_is_accepted() {
    let members = check_members(read(&models().join("families/corner.axle")), &load).unwrap();
    assert!(members.len() > 100);
    for (choices, checked) in members {
        checked.unwrap_or_else(|report| panic!("{choices:?}\n{report}"));
    }
}

#[test]
fn every_file_prints_as_the_same_tree() {
    for file in files("axles").into_iter().chain(files("families")) {
        let first = parse_text(&read(&file), 0);
        assert!(first.mistakes.is_empty());
        let printed = Source {
            name: "printed".into(),
            text: first.file.to_string(),
        };
        let second = parse_text(&printed, 0);
        assert!(second.mistakes.is_empty(), "{}", printed.text);
        assert!(first.file == second.file, "{}", printed.text);
        assert_eq!(second.file.to_string(), printed.text);
    }
}

#[test]
fn the_tokens_of_a_macro_give_the_same_model() {
    let file = read(&models().join("axles/quarter_car.axle"));
    let from_text = check(file.clone(), &load).unwrap();
    let from_tokens = check_tokens(file.text.parse().unwrap(), &load).unwrap();
    assert_eq!(from_tokens.text(), from_text.text());
    let lines = |model: &qcar_dsl::model::Model| -> Vec<String> {
        model.links.iter().map(|link| link.declared.line.clone()).collect()
    };
    assert_eq!(lines(&from_tokens), lines(&from_text));
}

#[test]
fn a_mistake_in_a_macro_becomes_a_compile_error() {
    let tokens = "axle a { direction z { road pad; mass body = m; link l: body - pad { spring k; } } }";
    let errors = check_tokens(tokens.parse().unwrap(), &load).unwrap_err().to_string();
    assert_eq!(errors.matches("compile_error").count(), 2, "{errors}");
    assert!(
        errors.contains("the model has no `m`") && errors.contains("the model has no `k`"),
        "{errors}"
    );
}
