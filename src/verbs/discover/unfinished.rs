//! Results of an interrupted search: its current model, parameters and residuals. They have not been checked, and each
//! file says so.

use std::fs;
use std::path::{Path, PathBuf};

use qcar_runtime::discover::answer::Finding;
use qcar_runtime::discover::posterior::Explanation;

use super::{figure, fitted, patched};
use crate::workshop::Bench;

const MARK: &str = "unfinished: the search was stopped before its verdict";
const PARAMETERS: &str = "parameters.toml";
const FIGURE: &str = "gap.svg";
const MODEL: &str = "axle";

/// The folder for these results, if the results of the search go to `out`.
pub(super) fn folder(out: &Path) -> PathBuf {
    out.join("unfinished")
}

/// Names and texts of the files, for the current effects and the explanations without and with them.
pub(super) fn files(
    campaign: &str,
    bench: &Bench,
    findings: &[Finding],
    [before, after]: [&Explanation; 2],
) -> Vec<(String, String)> {
    let heading = format!("{campaign}: {MARK}");
    let model = patched(bench.clone(), findings, &format!("{heading}."));
    let model = model.map(|model| (format!("{}.{MODEL}", model.name), model.text));
    let parameters = fitted::parameters(&heading, after);
    let figure = figure::residuals(heading, [&before.misfit, &after.misfit]).svg();
    let both = [(PARAMETERS.into(), parameters), (FIGURE.into(), figure)];
    model.into_iter().chain(both).collect()
}

/// Removes the files of an earlier, stopped search. All other files stay. A file that cannot be removed stays too; it
/// carries the mark.
pub(super) fn remove(out: &Path) {
    let folder = folder(out);
    let files = fs::read_dir(&folder).into_iter().flatten().flatten();
    for file in files.map(|entry| entry.path()).filter(|file| is_unfinished(file)) {
        let _ = fs::remove_file(file);
    }
    // Fails if the folder contains other files, which must stay.
    let _ = fs::remove_dir(folder);
}

/// Files of these names in that folder that no search has left.
pub(super) fn foreign(out: &Path) -> impl Iterator<Item = PathBuf> {
    let folder = folder(out);
    let files = [PARAMETERS, FIGURE].map(|name| folder.join(name)).into_iter();
    files.filter(|file| !is_unfinished(file))
}

/// True for a file with one of these names that carries the mark.
fn is_unfinished(file: &Path) -> bool {
    let is_model = file.extension().is_some_and(|extension| extension == MODEL);
    let is_named = is_model || [PARAMETERS, FIGURE].iter().any(|name| file.ends_with(name));
    is_named && fs::read_to_string(file).is_ok_and(|text| text.contains(MARK))
}
