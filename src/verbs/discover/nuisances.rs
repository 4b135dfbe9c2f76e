//! The nuisance effects that were fitted with the answer, as text and as JSON.

use std::collections::BTreeMap;

use qcar_runtime::discover::answer::Finding;
use serde::Serialize;

use super::Answer;
use super::finding::table;
use crate::effects;
use crate::json::Ordered;

/// A nuisance effect, SI.
#[derive(Serialize)]
pub(super) struct Nuisance<'a> {
    name: &'a str,
    at: &'a str,
    parameters: Ordered<f64>,
    stderr: Ordered<Option<f64>>,
    units: BTreeMap<String, String>,
}

pub(super) fn json(of: &Answer) -> Vec<Nuisance<'_>> {
    of.discovery.nuisances[1].iter().map(|own| nuisance(own, of)).collect()
}

fn nuisance<'a>(of: &'a Finding, answer: &'a Answer) -> Nuisance<'a> {
    let parameters = of.parameters.iter();
    let error = |error: f64| error.is_finite().then_some(error);
    Nuisance {
        name: &of.effect,
        at: &of.at,
        parameters: parameters.clone().map(|own| (own.0.clone(), own.1)).collect(),
        stderr: parameters.map(|own| (own.0.clone(), error(own.2))).collect(),
        units: effects::units(&of.effect, &of.at, &answer.base),
    }
}

/// A paragraph for each; empty without any.
pub(super) fn text(of: &Answer) -> String {
    let paragraph = |own: &Finding| {
        let table = table(own, &effects::units(&own.effect, &own.at, &of.base));
        format!(
            "\nfitted as a nuisance, not part of the answer: {} at {}\n{table}",
            own.effect, own.at
        )
    };
    of.discovery.nuisances[1].iter().map(paragraph).collect()
}
