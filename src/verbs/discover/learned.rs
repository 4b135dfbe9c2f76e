//! The learned law, as text and as JSON.

use std::collections::BTreeMap;
use std::fmt::Write;

use qcar_runtime::discover::answer::Finding;
use serde::Serialize;

use super::Answer;
use super::finding::{described, share};
use super::law::Law;
use crate::json::Ordered;
use crate::sensor_residuals::BeforeAfter;

/// Learned laws, for residuals that no effect of the catalogue explains.
#[derive(Serialize)]
pub(super) struct Learned<'a> {
    /// Place of the first law.
    at: &'a str,
    /// Share of the excess residual on the held-out runs that all laws explain.
    explained: Option<f64>,
    gap: BTreeMap<&'static str, BeforeAfter>,
    laws: Vec<One<'a>>,
    model_file: Option<String>,
}

#[derive(Serialize)]
struct One<'a> {
    name: &'a str,
    at: &'a str,
    words: &'a str,
    parameters: Ordered<f64>,
    stderr: Ordered<Option<f64>>,
    units: &'a BTreeMap<String, String>,
    effect_file: Option<String>,
}

/// `None` without a learned law.
pub(super) fn learned(of: &Answer) -> Option<Learned<'_>> {
    let (own, model) = (of.discovery.learned.as_ref()?, of.learned.as_ref()?);
    let (before, after) = (&of.discovery.before.misfit, &own.explanation.misfit);
    Some(Learned {
        at: &own.laws.first()?.at,
        explained: own.explained,
        gap: BTreeMap::from([
            ("fit", BeforeAfter::new(before.fit, after.fit)),
            ("held_out", BeforeAfter::new(before.held_out, after.held_out)),
        ]),
        laws: own.laws.iter().zip(&model.laws).map(one).collect(),
        model_file: model.model.file.as_ref().map(|file| file.display().to_string()),
    })
}

fn one<'a>((finding, law): (&'a Finding, &'a Law)) -> One<'a> {
    let parameters = finding.parameters.iter();
    let error = |error: f64| error.is_finite().then_some(error);
    One {
        name: &finding.effect,
        at: &finding.at,
        words: &law.words,
        parameters: parameters.clone().map(|p| (p.0.clone(), p.1)).collect(),
        stderr: parameters.map(|p| (p.0.clone(), error(p.2))).collect(),
        units: &law.units,
        effect_file: law.file.as_ref().map(|file| file.display().to_string()),
    }
}

/// The learned laws; empty without any.
pub(super) fn text(of: &Answer) -> String {
    let (Some(own), Some(model)) = (&of.discovery.learned, &of.learned) else {
        return String::new();
    };
    let places: Vec<String> = own.laws.iter().map(|law| format!("at {}", law.at)).collect();
    let mut out = format!(
        "\nlearned from the data, without a physical cause: {} {}\n",
        if places.len() == 1 {
            format!("a law {}", places[0])
        } else {
            format!("laws {}", places.join(" and "))
        },
        share(own.explained, of.evidence.judging())
    );
    for (finding, law) in own.laws.iter().zip(&model.laws) {
        let _ = writeln!(out, "\n{} at {}: {}", finding.effect, finding.at, law.words);
        out += &described(finding, own.laws.len(), of.evidence.judging(), &law.units);
        if let Some(file) = &law.file {
            let _ = writeln!(out, "effect file: {}", file.display());
        }
    }
    if let Some(file) = &model.model.file {
        let _ = writeln!(out, "model file: {}", file.display());
    }
    out
}
