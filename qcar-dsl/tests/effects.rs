//! Every effect that is shipped reads, prints as itself, and compiles at each of its places in each model.

use std::path::{Path, PathBuf};

use qcar_dsl::check::Checked;
use qcar_dsl::front::check_text;
use qcar_dsl::parse::parse_text;
use qcar_dsl::patch::{Patch, Patched};
use qcar_dsl::source::Source;

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models")
}

fn files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(models().join(folder)).unwrap();
    let mut files: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
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
    Ok(read(&Path::new(from).parent().unwrap().join(path)))
}

fn checked(file: &Path) -> Checked {
    check_text(read(file), &load).unwrap_or_else(|report| panic!("{report}"))
}

fn model(name: &str) -> Checked {
    checked(&models().join(format!("axles/{name}.axle")))
}

fn effect(name: &str) -> Patch {
    let source = read(&models().join(format!("effects/{name}.axle")));
    Patch::read(source).unwrap_or_else(|report| panic!("{report}"))
}

fn patched(patch: &Patch, model: &Checked, place: &str) -> Patched {
    patch
        .apply(model, place, &|_| None)
        .unwrap_or_else(|report| panic!("{}\n{report}", report.sources[0].text))
}

fn effects() -> Vec<Patch> {
    let read = |file: &PathBuf| Patch::read(read(file)).unwrap_or_else(|report| panic!("{report}"));
    files("effects").iter().map(read).collect()
}

#[test]
fn every_effect_prints_as_the_same_tree() {
    for file in files("effects") {
        let first = parse_text(&read(&file), 0);
        assert!(first.mistakes.is_empty(), "{}", file.display());
        let printed = Source {
            name: "printed".into(),
            text: first.file.to_string(),
        };
        let second = parse_text(&printed, 0);
        assert!(
            second.mistakes.is_empty() && first.file == second.file,
            "{}",
            printed.text
        );
        assert_eq!(second.file.to_string(), printed.text);
    }
}

#[test]
fn every_effect_compiles_wherever_it_applies() {
    for file in files("axles") {
        let model = checked(&file);
        for effect in effects() {
            for patched in effect.candidates(&model, &|_| None) {
                let warnings = patched.model.warnings();
                assert!(warnings.diagnostics.is_empty(), "{}\n{warnings}", patched.model.name);
            }
        }
    }
}

#[test]
fn a_patched_model_is_a_file_that_reads_well() {
    let patched = patched(&effect("suspended_mass"), &model("axle_c"), "body");
    insta::assert_snapshot!(patched.text("Evidence: none yet."));
}

/// Where each effect applies, model by model: what a discovery chooses from.
#[test]
fn the_catalogue_applies_where_it_should() {
    let mut table = String::new();
    for file in files("axles") {
        let model = checked(&file);
        table += &format!("{}\n", model.name);
        for effect in effects() {
            let places = effect.places(&model);
            if !places.is_empty() {
                table += &format!("    {}: {}\n", effect.effect().name.text, places.join(", "));
            }
        }
    }
    insta::assert_snapshot!(table);
}

#[test]
fn an_effect_is_tried_in_each_form_that_the_model_allows() {
    let friction = effect("coulomb_friction");
    let forms = |name: &str| -> Vec<Option<String>> {
        let candidates = friction.candidates(&model(name), &|_| None);
        candidates.into_iter().map(|patched| patched.form).collect()
    };
    let named = |form: &str| Some(form.to_string());
    let (inside, across, beside) = ("in_damper", "across_strut", "between_wheel_and_body");
    assert_eq!(forms("axle_c"), [inside, across, beside].map(named));
    assert_eq!(forms("axle_c_rigid_tm"), [inside, beside].map(named));
    assert_eq!(forms("one_mass"), [inside].map(named));
    assert_eq!(friction.places(&model("axle_c")), ["damper"]);
    assert!(friction.in_form("sideways").is_none());
}

#[test]
fn forms_of_one_name_are_refused() {
    let text = "effect e at link l { \"A\" source \"B\"; shows \"C\";
        form a { \"D\" remove l; } form a { remove l; } }";
    let source = Source {
        name: "e.axle".into(),
        text: text.into(),
    };
    let report = Patch::read(source).unwrap_err().to_string();
    assert!(report.contains("`a` is declared twice in effect `e`"), "{report}");
    assert!(
        report.contains("effect `e` has no sentence that says what its form `a` is"),
        "{report}"
    );
}

#[test]
#[ignore]
fn counts() {
    for file in files("axles") {
        let model = checked(&file);
        let mut n = [0, 0];
        for effect in effects() {
            for patched in effect.candidates(&model, &|_| None) {
                n[usize::from(!patched.signals.is_empty())] += 1;
            }
        }
        println!("{} model {} sensor {}", model.name, n[0], n[1]);
    }
}
