//! The model of a study as JavaScript for the report, which computes the measured ratios for other parameter values.

use std::collections::BTreeSet;

use super::gather::Study;
use crate::export::Subject;
use crate::export::javascript::{Ratio, responses};

/// The extended model, otherwise the fitted one, as an expression of JavaScript. `None` for a nonlinear model, whose
/// responses depend on the level.
pub fn program(of: &Study) -> Option<String> {
    let fitted = of.fitted.values();
    let (model, compiled, values) = match &of.after {
        Some(after) => (&after.model, &after.compiled, &after.values),
        None => (&of.fitted.model, &of.compiled, &fitted),
    };
    let about = model.about();
    let ratios = measured(of);
    if !about.linear || ratios.is_empty() {
        return None;
    }
    let values_of = values.as_slice();
    let subject = Subject {
        compiled,
        values: values_of,
    };
    Some(responses(subject, about, values, &ratios))
}

/// The measured ratios, without duplicates.
fn measured(of: &Study) -> Vec<Ratio<'_>> {
    let mut seen = BTreeSet::new();
    let levels = of.fitted.levels.iter();
    let all = levels.flat_map(|level| {
        level
            .observations
            .iter()
            .map(move |own| (level.excitation, &own.channel))
    });
    all.filter(|(_, channel)| seen.insert(channel.name.clone()))
        .map(|(excitation, channel)| Ratio { channel, excitation })
        .collect()
}
