//! Notices on a fit.

use qcar_runtime::campaign::{Campaign, Role, Run, Test};
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

/// A sentence for each table of a dynamometer, which a linear fit does not use.
pub(super) fn unused_tables(campaign: &Campaign) -> Vec<String> {
    let is_unused = |run: &&Run| run.role == Role::Fit && matches!(run.test, Test::Dynamometer(_));
    let say = |run: &Run| {
        let name = &run.name;
        format!("{name}: a fit to transmissibilities does not use the table of a dynamometer; --all-runs does")
    };
    campaign.runs.iter().filter(is_unused).map(say).collect()
}
