//! No text makes the compiler panic: neither words at random, nor models and effects with parts cut out, doubled or
//! swapped.

#[path = "../../fuzz/bodies/effect.rs"]
mod effect;
#[path = "../../fuzz/bodies/model.rs"]
mod model;

use proptest::prelude::*;
use qcar_dsl::check::check_members;
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

const WORDS: [&str; 62] = [
    "axle",
    "family",
    "element",
    "effect",
    "from",
    "param",
    "known",
    "let",
    "option",
    "require",
    "if",
    "else",
    "direction",
    "mass",
    "inertia",
    "node",
    "road",
    "motion",
    "gravity",
    "force",
    "on",
    "point",
    "link",
    "output",
    "channel",
    "spring",
    "damper",
    "inerter",
    "state",
    "rate",
    "rolling",
    "angle",
    "in",
    "s",
    "v",
    "k",
    "body",
    "pad",
    "z",
    "N",
    "m",
    "kg",
    "sqrt",
    "abs",
    "{",
    "}",
    "(",
    ")",
    ";",
    ":",
    "=",
    "==",
    "+",
    "-",
    "*",
    "/",
    "^",
    "..",
    "1",
    "2.5e3",
    "\"text\"",
    "∂",
];

const MODEL: &str = r#"
element maxwell(k: N/m, c: N s/m) { "A relaxing branch" state f: N; rate f = k*v - k/c*f; force = f; }
family corner {
    "A corner"
    option top: on | off = on "Whether there is a top mount";
    option arm: yes | no = no;
    require top == on || arm != yes "an arm needs a top mount";
    known param m_corner: kg = 400 in 50..2000 "Static mass";
    param m_wheel: kg = 40 "Unsprung mass";
    param k: N/m = 25 N/mm in 5e3..200e3;
    param k_tire: N/m = k;
    let m_body = m_corner - m_wheel;
    direction z {
        road pad;
        gravity g;
        mass body = m_body "The body";
        mass wheel = m_wheel;
        inertia pitch = 2 kg m^2;
        if top == on { node tm; point seat = tm; } else { point seat = body; }
        force f on wheel;
        link tire: wheel - pad { "Tyre" spring k_tire; rolling { force = k_tire*max(s, 0); } }
        link strut: seat - wheel + 0.1 m*pitch { spring k; damper 100 N s/m; }
        link stop: body - wheel { force = if s < -20 mm && v < 0 { k*(s + 0.02 m) } else { 0 }; }
        if top == on { link mount: body - tm { spring 2*k; maxwell(k, 10 N s/m); } }
        link anti_roll: pitch { spring 100 N m; }
        output body.acceleration;
        output travel = strut.stretch;
        channel pad_to_body = body.acceleration/pad.acceleration;
    }
}
"#;

/// Effects of every kind: on a link, with a mass, in several forms, of a sensor.
const EFFECTS: [&str; 4] = [
    include_str!("../../models/effects/coulomb_friction.axle"),
    include_str!("../../models/effects/tire_belt.axle"),
    include_str!("../../models/effects/bump_stop.axle"),
    include_str!("../../models/effects/sensor_delay.axle"),
];

/// The words and marks of a text.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let length = match first {
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            _ if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        tokens.push(rest[..length].to_string());
        rest = &rest[length..];
    }
    tokens
}

#[test]
fn the_model_to_be_mangled_is_sound() {
    let source = Source {
        name: "model.axle".to_string(),
        text: MODEL.to_string(),
    };
    for (choices, checked) in check_members(source, &|_, _| Err(String::new())).unwrap() {
        checked.unwrap_or_else(|report| panic!("{choices:?}\n{report}"));
    }
}

/// A part taken out, two swapped, or one doubled elsewhere; each with its places.
type Edit = (usize, usize, usize);

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    proptest::collection::vec((0..3usize, 0..1000usize, 0..1000usize), 1..4)
}

fn edited(text: &str, edits: Vec<Edit>) -> String {
    let mut tokens = tokens(text);
    for (edit, a, b) in edits {
        let (a, b) = (a % tokens.len(), b % tokens.len());
        match edit {
            0 => drop(tokens.remove(a)),
            1 => tokens.swap(a, b),
            _ => tokens.insert(a, tokens[b].clone()),
        }
    }
    tokens.concat()
}

#[test]
fn the_effects_to_be_mangled_are_sound_and_apply() {
    for text in EFFECTS {
        let source = Source {
            name: "effect.axle".to_string(),
            text: text.to_string(),
        };
        let patch = Patch::read(source).unwrap_or_else(|report| panic!("{report}"));
        assert!(!patch.places(&effect::bench()).is_empty(), "{text}");
        effect::survives(text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn words_at_random(words in proptest::collection::vec(proptest::sample::select(&WORDS[..]), 0..60)) {
        model::survives(&words.join(" "));
    }

    #[test]
    fn words_inside_a_model(words in proptest::collection::vec(proptest::sample::select(&WORDS[..44]), 0..12)) {
        model::survives(&format!("axle a {{ direction z {{ road pad; mass body = 1 kg; {}; }} }}", words.join(" ")));
        model::survives(&format!("axle a {{ direction z {{ road pad; link l: pad {{ {}; }} }} }}", words.join(" ")));
    }

    #[test]
    fn a_model_with_parts_changed(edits in edits()) {
        model::survives(&edited(MODEL, edits));
    }

    #[test]
    fn an_effect_with_parts_changed(which in 0..EFFECTS.len(), edits in edits()) {
        effect::survives(&edited(EFFECTS[which], edits));
    }

    #[test]
    fn any_characters(text in "\\PC{0,80}") {
        model::survives(&text);
    }
}
