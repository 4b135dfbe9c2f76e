//! Every example of the language reference is a model that the compiler accepts without a warning.

use std::path::Path;

use qcar_dsl::check::check_members;
use qcar_dsl::compile::check;
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

/// The fenced blocks of a language.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let after = text.split(&fence).skip(1);
    after
        .filter_map(|rest| Some(rest.split_once("```")?.0.to_string()))
        .collect()
}

#[test]
fn the_examples_compile() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    let examples = blocks(&std::fs::read_to_string(path).unwrap(), "axle");
    assert!(examples.len() >= 4);
    for text in examples {
        let source = Source {
            name: "docs/language.md".to_string(),
            text,
        };
        let load = |_: &str, _: &str| Err("the example loads no file".to_string());
        let checked = match source.text.starts_with("family") {
            true => check_members(source, &load)
                .unwrap()
                .into_iter()
                .map(|(_, checked)| checked)
                .collect(),
            false => vec![check(source, &load)],
        };
        for checked in checked {
            let checked = checked.unwrap_or_else(|report| panic!("{report}"));
            assert!(checked.warnings().diagnostics.is_empty(), "{}", checked.warnings());
        }
    }
}

#[test]
fn the_effects_apply_to_an_example() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/language.md");
    let text = std::fs::read_to_string(path).unwrap();
    let source = |text: String| Source {
        name: "docs/language.md".to_string(),
        text,
    };
    let load = |_: &str, _: &str| Err("the example loads no file".to_string());
    let family = blocks(&text, "axle")
        .into_iter()
        .find(|text| text.starts_with("family"))
        .unwrap();
    let (_, member) = check_members(source(family), &load).unwrap().remove(0);
    let effects = blocks(&text, "effect");
    assert!(!effects.is_empty());
    for effect in effects {
        let patch = Patch::read(source(effect)).unwrap_or_else(|report| panic!("{report}"));
        let patched = patch.apply(member.as_ref().unwrap(), "damper", &|_| None);
        patched.unwrap_or_else(|report| panic!("{report}"));
    }
}
