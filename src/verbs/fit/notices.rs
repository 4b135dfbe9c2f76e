//! What is odd about a fit, but no error.

use qcar_runtime::campaign::Campaign;
use qcar_runtime::fit::Level;

/// A sentence for each run that records what drives the model and nothing that moves.
pub(super) fn silent_runs(campaign: &Campaign, levels: &[Level]) -> Vec<String> {
    let silent = levels.iter().filter(|level| level.observations.is_empty());
    let say = |level: &Level| {
        let file = campaign.folder.join(&level.name);
        let file = file.display();
        format!("{file}: records nothing that the model moves, so no channel is taken from it; check its column names")
    };
    silent.map(say).collect()
}
