//! What a search leaves that is stopped: the model that it has come to, its parameters and its gap. Nothing of it has been
//! judged, and each file says so.

use qcar_runtime::discover::explain::Explanation;
use qcar_runtime::discover::search::Finding;

use super::{figure, patched, render};
use crate::workshop::Bench;

const WORD: &str = "unfinished, the search was stopped before its verdict";

/// Names and texts of the files, for the effects that were taken by then and the explanations without and with them.
pub(super) fn files(
    campaign: &str,
    bench: &Bench,
    findings: &[Finding],
    [before, after]: [&Explanation; 2],
) -> Vec<(String, String)> {
    let heading = format!("{campaign}: {WORD}");
    let model = patched(bench.clone(), findings, &format!("{heading}."));
    let model = model.map(|model| (format!("{}.axle", model.name), model.text));
    let parameters = render::parameters(&heading, after);
    let gap = figure::gap(heading, [&before.gap, &after.gap]).svg();
    let both = [("parameters.toml".into(), parameters), ("gap.svg".into(), gap)];
    model.into_iter().chain(both).collect()
}
