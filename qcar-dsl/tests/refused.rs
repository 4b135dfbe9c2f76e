//! Every diagnostic of the catalogue has a model that is refused for it, or warned about, and its rendering is pinned.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use qcar_dsl::compile::check;
use qcar_dsl::diagnostic::{Code, Report, Severity};
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refused")
}

fn source(path: &str) -> Result<Source, String> {
    let text = std::fs::read_to_string(folder().join(path)).map_err(|_| "there is no such file".to_string())?;
    Ok(Source {
        name: path.to_string(),
        text,
    })
}

fn report(code: Code) -> Report {
    let source = source(&format!("{}.axle", code.name())).unwrap();
    if let Some(rest) = source.text.strip_prefix("// patch at ") {
        let place = rest.lines().next().unwrap().to_string();
        return report_of_effect(source, &place);
    }
    match check(source, &|_, path| self::source(path)) {
        Ok(checked) => checked.warnings().clone(),
        Err(report) => report,
    }
}

/// Of an effect in its file, or else of its application to the model that is kept for it.
fn report_of_effect(source: Source, place: &str) -> Report {
    let model = check(self::source("models/strut.axle").unwrap(), &|_, path| {
        self::source(path)
    })
    .unwrap();
    let patched = Patch::read(source).and_then(|patch| patch.apply(&model, place, &|_| None));
    patched.expect_err("the effect is refused")
}

#[test]
fn every_diagnostic_has_its_model_and_reads_well() {
    let mut missing = Vec::new();
    for &code in Code::ALL {
        let report = report(code);
        match report.diagnostics.iter().any(|diagnostic| diagnostic.code == code) {
            true => insta::assert_snapshot!(code.name(), report.to_string()),
            false => missing.push(format!("{} is not among the findings:\n{report}", code.name())),
        }
    }
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

#[test]
fn every_model_belongs_to_a_diagnostic() {
    let known: BTreeSet<String> = Code::ALL.iter().map(|code| code.name().to_string()).collect();
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let models = files.filter(|path| path.extension().is_some_and(|extension| extension == "axle"));
    let names: BTreeSet<String> = models
        .map(|path| path.file_stem().unwrap().to_string_lossy().to_string())
        .collect();
    assert_eq!(names, known);
}

#[test]
fn every_diagnostic_says_what_to_write() {
    for &code in Code::ALL {
        let report = report(code);
        for diagnostic in &report.diagnostics {
            assert!(!diagnostic.hint.is_empty(), "{}", code.name());
            assert!(!diagnostic.labels.is_empty(), "{}", code.name());
            let line = report.compact_line(diagnostic);
            assert!(line.contains(".axle:"), "{line}");
        }
    }
}

#[test]
fn warnings_do_not_refuse() {
    let warned = [
        Code::UnusedOption,
        Code::UnusedElement,
        Code::UnusedLet,
        Code::GravityPullsNothing,
        Code::NoExcitation,
        Code::ParameterUndetermined,
        Code::OnlyInCombination,
    ];
    for &code in Code::ALL {
        let refused = report(code).refuses();
        assert_eq!(refused, !warned.contains(&code), "{}", code.name());
        let severity = report(code)
            .diagnostics
            .iter()
            .find(|d| d.code == code)
            .map(|d| d.severity);
        assert_eq!(severity == Some(Severity::Warning), warned.contains(&code));
    }
}

/// A statement that cannot be read may declare what others use; units are wrong without it, too.
#[test]
fn units_are_looked_at_beside_what_cannot_be_read() {
    let text = r#"axle half {
        "Three mistakes: a parameter without colon and two units"
        known param m: kg "Mass of the body";
        param k N/m = 20 N/mm "Stiffness of the spring";
        param c: N s/m = 1000 "Damping";
        let twice = m + c;
        direction z {
            road pad;
            mass body = m;
            link spring: body - pad { spring k; }
            link damper: body - pad { spring c; }
        }
    }"#;
    let source = Source {
        name: "half.axle".into(),
        text: text.into(),
    };
    let report = check(source, &|_, _| Err(String::new())).unwrap_err();
    let found: Vec<Code> = report.diagnostics.iter().map(|diagnostic| diagnostic.code).collect();
    assert_eq!(found, [Code::Expected, Code::UnitsDiffer, Code::WrongUnit], "{report}");
}
