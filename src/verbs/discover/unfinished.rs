//! Results of an interrupted search: its current model, its parameters and residuals. Nothing of it has been
//! judged, and each file says so.

use std::fs;
use std::path::{Path, PathBuf};

use qcar_runtime::discover::answer::Finding;
use qcar_runtime::discover::posterior::Explanation;

use super::{figure, patched, render};
use crate::workshop::Bench;

const WORD: &str = "unfinished: the search was stopped before its verdict";
const PARAMETERS: &str = "parameters.toml";
const GAP: &str = "gap.svg";
const MODEL: &str = "axle";

/// Where it is left, of a search whose results go into `out`.
pub(super) fn folder(out: &Path) -> PathBuf {
    out.join("unfinished")
}

/// Names and texts of the files, for the effects that were taken by then and the explanations without and with them.
pub(super) fn files(
    campaign: &str,
    bench: &Bench,
    findings: &[Finding],
    [before, after]: [&Explanation; 2],
) -> Vec<(String, String)> {
    let heading = format!("{campaign}: {WORD}");
    let model = patched(bench.clone(), findings, &format!("{heading}."));
    let model = model.map(|model| (format!("{}.{MODEL}", model.name), model.text));
    let parameters = render::parameters(&heading, after);
    let gap = figure::gap(heading, [&before.gap, &after.gap]).svg();
    let both = [(PARAMETERS.into(), parameters), (GAP.into(), gap)];
    model.into_iter().chain(both).collect()
}

/// Takes away what an earlier search has left, now that the results are whole. All else stays, and so does what cannot be
/// taken away: it says what it is.
pub(super) fn take_away(out: &Path) {
    let folder = folder(out);
    let files = fs::read_dir(&folder).into_iter().flatten().flatten();
    for file in files.map(|entry| entry.path()).filter(|file| was_left(file)) {
        let _ = fs::remove_file(file);
    }
    // Refused where anything else is in it.
    let _ = fs::remove_dir(folder);
}

/// True for a file of such a name that says what it is.
fn was_left(file: &Path) -> bool {
    let is_model = file.extension().is_some_and(|extension| extension == MODEL);
    let is_named = is_model || [PARAMETERS, GAP].iter().any(|name| file.ends_with(name));
    is_named && fs::read_to_string(file).is_ok_and(|text| text.contains(WORD))
}
