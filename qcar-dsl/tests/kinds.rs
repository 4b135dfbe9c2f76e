//! An effect is tried at one place of each kind. Trying it at every place gives the same.

use std::path::Path;

use qcar_dsl::compile::check;
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

/// Effects and laws that apply at many places.
const WIDESPREAD: [&str; 4] = [
    "effects/hydraulic_mount",
    "effects/sensor_gain",
    "effects/spring_to_ground",
    "laws/elastic_law",
];

fn patch(name: &str) -> Patch {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../models/{name}.axle"));
    let text = std::fs::read_to_string(file).expect("it is shipped");
    let name = name.to_string();
    Patch::read(Source { name, text }).unwrap_or_else(|report| panic!("{report}"))
}

/// A chain of masses on a road or a motion, whose members differ in what is known and what is beside them.
fn chain(seed: usize) -> String {
    let masses = 9 + seed % 3;
    let bit = |at: usize| (seed * 2_654_435_761 + at * 40_503) >> 7 & 7;
    let own = !seed.is_multiple_of(3);
    let of = |at: usize| if own { at.to_string() } else { String::new() };
    let (mut parameters, mut members) = (String::new(), String::new());
    for at in 1..=masses {
        let is_damped = at == 1 || bit(at) != 0;
        if own || at == 1 {
            let known = if seed.is_multiple_of(2) { "known " } else { "" };
            let damping = if is_damped {
                format!("param c{}: N s/m = 30;", of(at))
            } else {
                String::new()
            };
            let at = of(at);
            parameters += &format!("{known}param m{at}: kg = 2; param k{at}: N/m = 4e3; {damping}\n");
        }
        let (below, number) = (at - 1, of(at));
        let mut stiffness = format!("k{number}");
        if bit(at + 50) == 1 {
            parameters += &format!("param k_beside{at}: N/m = 1e3 in 1e2..1e4;\n");
            stiffness += &format!(" + k_beside{at}");
        }
        let damper = if is_damped {
            format!("damper c{number};")
        } else {
            String::new()
        };
        members +=
            &format!("mass q{at} = m{number}; link l{at}: q{at} - q{below} {{ spring {stiffness}; {damper} }}\n");
        if bit(at + 90) == 2 && at > 2 {
            members += &format!("link across{at}: q{at} - q{} {{ spring 2e3 N/m; }}\n", at - 2);
        }
    }
    let driven = if seed.is_multiple_of(4) { "motion" } else { "road" };
    format!("axle chain {{ {parameters} direction z {{ {driven} q0; {members} }} }}")
}

/// The places at which the whole patched model is checked and accepted are those of the kinds that are.
#[test]
fn places_of_one_kind_need_one_check() {
    let effects = WIDESPREAD.map(patch);
    let mut applied = 0;
    for seed in 0..5 {
        let name = "chain.axle".to_string();
        let text = chain(seed);
        let model =
            check(Source { name, text }, &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
        for effect in &effects {
            let mut checked: Vec<String> = effect
                .candidates(&model, &|_| None)
                .into_iter()
                .map(|own| own.place)
                .collect();
            checked.dedup();
            applied += checked.len();
            assert_eq!(
                effect.places(&model),
                checked,
                "{} in {}",
                effect.effect().name.text,
                model.text()
            );
        }
    }
    assert!(applied > 100, "{applied}");
}
