//! Snapshots of each stage of each shipped model, as a user sees it.

use std::path::Path;

use qcar_dsl::compile::compile;
use qcar_dsl::disk::compile_file;
use qcar_dsl::schedule::Compiled;
use qcar_dsl::show::{Stage, show};
use qcar_dsl::source::Source;

/// A generated module longer than this, in bytes, is pinned by its outline and the hash of its text.
const LONG: usize = 26_000;

#[test]
fn every_stage_of_every_model_is_pinned() {
    for (name, compiled) in shipped() {
        for stage in Stage::ALL {
            let text = show(&compiled, stage);
            let pinned = if stage == Stage::Rust && text.len() > LONG {
                outline(&text)
            } else {
                text
            };
            insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
                insta::assert_snapshot!(format!("{name}-{}", stage.name()), pinned);
            });
        }
    }
}

#[test]
fn the_model_stage_reads_back_as_the_same_model() {
    for (name, compiled) in shipped() {
        let source = Source {
            name: name.into(),
            text: show(&compiled, Stage::Model),
        };
        let again = compile(source, &|_, path| Err(format!("{path} is not needed")));
        let again = again.unwrap_or_else(|report| panic!("{report}"));
        assert!(
            show(&again, Stage::Rust) == show(&compiled, Stage::Rust),
            "{name} reads back differently"
        );
    }
}

#[test]
fn brackets_of_the_latex_stage_close() {
    for (name, compiled) in shipped() {
        let text = show(&compiled, Stage::Latex).replace("\\{", "").replace("\\}", "");
        for pair in [["{", "}"], ["\\left", "\\right"], ["\\begin", "\\end"]] {
            let [open, close] = pair.map(|word| text.matches(word).count());
            assert_eq!(open, close, "{name}: {pair:?}");
        }
    }
}

fn shipped() -> impl Iterator<Item = (&'static str, Compiled)> {
    models::all().iter().map(|shipped| {
        let from_disk = compile_file(Path::new(""), shipped.file).expect("a shipped model can be read");
        (shipped.name, from_disk.compiled.expect("a shipped model compiles"))
    })
}

/// The documentation and the function signatures of a module, and its `FINGERPRINT`.
fn outline(text: &str) -> String {
    let is_head = |line: &&str| {
        let line = line.trim_start();
        ["///", "pub ", "impl ", "static ", "struct "]
            .iter()
            .any(|head| line.starts_with(head))
    };
    text.lines().filter(is_head).map(|line| format!("{line}\n")).collect()
}
