//! Notices on a fit.

use qcar_runtime::campaign::{Campaign, Role, Test};
use qcar_runtime::fit::report::ParameterFit;
use qcar_runtime::fit::{Fit, Level};

/// A sentence if every fitted parameter is at a bound, so that the cost has no minimum within the ranges.
pub(super) fn all_at_bounds(fit: &Fit) -> Option<String> {
    let fitted: Vec<_> = fit.parameters.iter().filter(|own| own.fitted).collect();
    let at_bounds = !fitted.is_empty() && fitted.iter().all(|own| own.at_bound.is_some());
    let names: Vec<&str> = fitted.iter().map(|own| own.name.as_str()).collect();
    at_bounds.then(|| {
        format!(
            "every fitted parameter ends at a bound of its range ({}), so the values are meaningless; check the sensors' units and \
             places, the model, and the ranges",
            names.join(", ")
        )
    })
}

/// A sentence for each run with a recorded excitation and no response.
pub(super) fn silent_runs(campaign: &Campaign, levels: &[Level]) -> Vec<String> {
    let silent = levels.iter().filter(|level| level.observations.is_empty());
    let say = |level: &Level| {
        let file = campaign.folder.join(&level.name);
        let file = file.display();
        format!("{file}: records no motion of the model, so no channel comes from it; check its column names")
    };
    silent.map(say).collect()
}

/// A sentence for each fitted run that a fit to transmissibilities does not use: the table of a dynamometer, or a free
/// decay.
pub(super) fn unused_runs(campaign: &Campaign, levels: &[Level]) -> Vec<String> {
    let fitted = campaign.runs.iter().filter(|run| run.role == Role::Fit);
    let unused = fitted.filter_map(|run| {
        let what = match run.test {
            Test::Dynamometer(_) => "the table of a dynamometer",
            Test::TimeHistory(_) if levels.iter().all(|level| level.name != run.name) => "a record without excitation",
            _ => return None,
        };
        let name = &run.name;
        Some(format!(
            "{name}: a fit to transmissibilities does not use {what}; --all-runs does"
        ))
    });
    unused.collect()
}

/// A sentence if transmissibilities determine some parameters only in combination; further runs may determine them.
pub(super) fn in_combination(fit: &Fit) -> Option<String> {
    fit.parameters.iter().any(ParameterFit::is_only_in_combination).then(|| {
        "the transmissibilities determine some parameters only in combination; with --all-runs, the other runs of the \
         campaign are fitted too and may determine each of them"
            .into()
    })
}
