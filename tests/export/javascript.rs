//! JavaScript in Node: the functions of a model, the responses of its channels, and what reports say of a model.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use qcar::{catalogue, parameters};
use serde_json::Value;

use crate::programs::{qcar, run, say};

const PARAMS: &str = "tests/data/axle_d.toml";

fn node() -> Option<&'static Path> {
    let node = Path::new("node");
    let found = Command::new(node).arg("--version").output().is_ok();
    if !found {
        say("not checked: exported JavaScript, since Node is absent (apt-get install nodejs)");
    }
    found.then_some(node)
}

/// What an expression of a `model` that was exported gives.
fn computed(node: &Path, model: &str, given: &[&str], expression: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.js");
    let export = ["export", model, "--as", "js", "--out", file.to_str().unwrap()];
    qcar(&[&export, given].concat());
    let program = format!("const model = require('./model.js'); console.log(JSON.stringify({expression}))");
    serde_json::from_str(&run(node, &["--eval", &program], folder.path())).unwrap()
}

/// Relative to the largest of them.
fn agree(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for (own, other) in found.iter().zip(expected) {
        assert!(
            (own - other).abs() <= tolerance * largest,
            "{what}: {own} is not {other}"
        );
    }
}

/// At other values than those that were exported, one of which is followed by another parameter.
#[test]
fn responses_are_those_of_qcar() {
    let Some(node) = node() else { return };
    let changed = ["--set", "k_wheel_z=30000", "--set", "c_tire=300"];
    let frf = [
        "frf",
        "axle_d",
        "--params",
        PARAMS,
        "--frequencies",
        "0.5:30:7",
        "--format",
        "json",
    ];
    let expected: Value = serde_json::from_str(&qcar(&[&frf[..], &changed].concat())).unwrap();
    let channels = expected["channels"].as_object().unwrap();
    let each = "Object.fromEntries(model.about.channels.map(({ name }) =>
        [name, model.response(name, { k_wheel_z: 30000, c_tire: 300 }, FREQUENCIES)]))";
    let frequencies = channels.values().next().unwrap()["frequency"].to_string();
    let found = computed(
        node,
        "axle_d",
        &["--params", PARAMS],
        &each.replace("FREQUENCIES", &frequencies),
    );
    assert_eq!(found.as_object().unwrap().len(), channels.len());
    for (name, expected) in channels {
        for part in ["re", "im"] {
            let numbers = |of: &Value| -> Vec<f64> { serde_json::from_value(of[part].clone()).unwrap() };
            agree(name, &numbers(&found[name]), &numbers(expected), 1e-9);
        }
    }
}

/// All of the language, against the interpreter; `exp` and its like may differ in their last digits.
#[test]
fn every_law_is_that_of_the_interpreter() {
    let Some(node) = node() else { return };
    let file = "models/tests/zoo/laws.axle";
    let model = catalogue::load(file).unwrap();
    let about = model.about();
    let point = |size: f64, count: usize| (1..=count).map(|k| size * (k as f64).sin()).collect::<Vec<f64>>();
    let (x, u) = (point(0.02, about.states.len()), point(0.03, about.inputs.len()));
    let values = parameters::resolve(about, None, &[]).unwrap();
    let p = values.as_slice();
    let mut constants = vec![0.0; about.constants];
    model.prepare(p, &mut constants);
    let mut expected = BTreeMap::new();
    let mut of = |name, size, compute: &dyn Fn(&mut [f64])| {
        let mut found = vec![0.0; size];
        compute(&mut found);
        expected.insert(name, found);
    };
    of("derivative", x.len(), &|dx| model.derivative(&constants, &x, &u, dx));
    of("outputs", about.outputs.len(), &|y| {
        model.outputs(&constants, &x, &u, y)
    });
    of("matrices", about.matrices.len(), &|nonzeros| {
        model.matrices(p, &x, &u, nonzeros)
    });
    of("sensitivities", about.sensitivities.len(), &|nonzeros| {
        model.sensitivities(p, &x, &u, nonzeros)
    });
    let expression = format!(
        "((c, p, x, u) => ({{
            derivative: model.derivative(c, x, u), outputs: model.outputs(c, x, u),
            matrices: model.matrices(p, x, u), sensitivities: model.sensitivities(p, x, u),
            channels: model.about.channels }}))(model.prepare(model.values()), model.values(), {x:?}, {u:?})"
    );
    let found = computed(node, file, &[], &expression);
    for (name, expected) in expected {
        let found: Vec<f64> = serde_json::from_value(found[name].clone()).unwrap();
        agree(name, &found, &expected, 1e-12);
    }
    assert_eq!(
        found["channels"],
        serde_json::json!([]),
        "a nonlinear model has no linear response"
    );
}

#[test]
fn a_parameter_that_the_model_has_not_is_refused() {
    let Some(node) = node() else { return };
    let refused = "(() => { try { model.values({ k_tyre: 1 }); } catch (error) { return error.message; } })()";
    let said = computed(node, "quarter_car", &[], refused);
    assert_eq!(said, "quarter_car has no parameter k_tyre");
}

/// What an expression gives after a script of the reports.
fn in_report(node: &Path, script: &str, expression: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report/js").join(script);
    let text = std::fs::read_to_string(path).unwrap();
    let program = format!("const words = (own) => own; {text}\nconsole.log(JSON.stringify({expression}))");
    let folder = tempfile::tempdir().unwrap();
    serde_json::from_str(&run(node, &["--eval", &program], folder.path())).unwrap()
}

/// A cab on two mounts and a seat at a point of it: its pitch is no part of its own. A lever between wheel and body is.
#[test]
fn drawings_end_at_the_mass_that_turns() {
    let Some(node) = node() else { return };
    let drawn = |points: &str, links: &str, expression: &str| {
        let point = "const P = (name, kind, angle) => ({ name, kind, angle: !!angle, axis: 'z' })";
        let link = "const L = (name, ...ends) => ({ name, axis: 'z', ends: ends.map(([point, share]) => ({ point, share })) })";
        let axle = format!("{{ points: [{points}], links: [{links}] }}");
        let call = format!(
            "(() => {{ {point}; {link}; const {{ place, links }} = axleLayout({axle}, 'z'); return {expression}; }})()"
        );
        in_report(node, "layout.js", &call)
    };
    let ends = "links.map((own) => own.ends.map((end) => end.point).join('-'))";
    let points = "P('frame', 'motion'), P('seat', 'mass'), P('cab', 'mass'), P('pitch', 'mass', true)";
    let links = "L('cushion', ['seat', 1], ['cab', -1], ['pitch', -0.3]), L('front', ['cab', 1], ['pitch', 0.8], ['frame', -1]), \
                 L('rear', ['cab', 1], ['pitch', -0.8], ['frame', -1])";
    let joined = ["seat-cab", "cab-frame", "cab-frame"];
    assert_eq!(drawn(points, links, ends), serde_json::json!(joined));
    let turns = "place.get('cab').turns.map((own) => own.name)";
    assert_eq!(drawn(points, links, turns), serde_json::json!(["pitch"]));
    let points = "P('road', 'road'), P('wheel', 'mass'), P('body', 'mass'), P('rocker', 'mass', true)";
    let links = "L('strut', ['body', 1], ['wheel', -1], ['rocker', -0.1]), L('tyre', ['wheel', 1], ['road', -1])";
    assert_eq!(
        drawn(points, links, ends),
        serde_json::json!(["body-wheel-rocker", "wheel-road"])
    );
}

/// A limit is stated only if it is one of the model.
#[test]
fn limits_are_those_of_the_model() {
    let Some(node) = node() else { return };
    let said = |masses: &str, linear: bool, track: bool| {
        let axle = format!("{{ before: {{ linear: {linear}, points: [{masses}] }} }}");
        in_report(
            node,
            "limits.js",
            &format!("motions({{ axles: {axle}, track: {track} }})"),
        )
    };
    let mass = |name: &str, axis: &str, angle: bool| {
        format!("{{ kind: 'mass', name: '{name}', axis: '{axis}', angle: {angle} }},")
    };
    let both = mass("body", "z", false) + &mass("body", "x", false);
    let whole = "Bodies move along z and x, without pitch and roll; only the rolling tyre couples the directions.";
    assert_eq!(said(&both, true, true), whole);
    assert_eq!(
        said(&both, false, true),
        "Bodies move along z and x, without pitch and roll."
    );
    let cab = mass("cab", "z", false) + &mass("pitch", "z", true);
    assert_eq!(said(&cab, true, false), "Bodies move along z and turn by pitch only.");
}

/// A fit to records has no cost; a fit to transmissibilities has minima that starts found.
#[test]
fn a_report_says_how_the_search_ended() {
    let Some(node) = node() else { return };
    let said = |others: &str, minima: &str| {
        let fit = format!("{{ minima: [{minima}], starts: 16, cost: 2, start_cost: 5 }}");
        in_report(
            node,
            "parameters.js",
            &format!("(() => {{ number = String; return searched({fit}, {others}); }})()"),
        )
    };
    assert_eq!(said("0", ""), " 16 starts found no other minimum.");
    assert_eq!(said("1", ""), " 16 starts found 1 other minimum.");
    let found = " 7 of 16 starts found this minimum, cost 2 (5 at the start values).";
    assert_eq!(said("null", "{ starts: 7 }"), found);
    assert_eq!(said("null", ""), "");
}
