//! What a discovery is given to choose from.

use std::collections::BTreeMap;
use std::sync::Arc;

use qcar::catalogue::compiled;
use qcar::effects;
use qcar::workshop::Bench;
use qcar_runtime::discover::candidate::Workshop;

fn forms(model: &str, effect: &str) -> Vec<String> {
    let catalogue = effects::catalogue().map_err(|_| "the catalogue reads").unwrap();
    let model = compiled(model).map_err(|_| "the model compiles").unwrap().model;
    let bench = Bench::new(model, Arc::new(catalogue), Arc::new(BTreeMap::new()));
    let own = bench
        .candidates()
        .into_iter()
        .filter(|candidate| candidate.effect == effect);
    own.filter_map(|candidate| candidate.form).collect()
}

/// Past a strut on the upright, friction is friction between wheel and body: the same is not tried twice.
#[test]
fn forms_that_come_to_the_same_are_tried_once() {
    let (inside, across, beside) = ("in_damper", "across_strut", "between_wheel_and_body");
    assert_eq!(forms("axle_c", "coulomb_friction"), [inside, across]);
    assert_eq!(forms("axle_d", "coulomb_friction"), [inside, across, beside]);
}
