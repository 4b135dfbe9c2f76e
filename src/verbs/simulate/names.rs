//! Names of the files of simulated runs.

use std::collections::HashSet;
use std::iter::once;
use std::path::{Path, PathBuf};

use qcar_runtime::campaign::{Campaign, Run};

use crate::failure::{Failure, flag};

/// The name of each simulated run, and that of its files without extension.
pub(crate) struct FileNames<'a>(Vec<(&'a str, String)>);

impl<'a> FileNames<'a> {
    /// Names that differ, also where a file system ignores case: a name that an earlier run has gets a number, such as
    /// `v20_2`.
    pub fn of(campaign: &'a Campaign) -> Self {
        let mut taken = HashSet::new();
        let mut named = |run: &'a Run| {
            let own = file_name(run);
            let numbered = (2..).map(|number| format!("{own}_{number}"));
            let mut names = once(own.clone()).chain(numbered);
            let free = names.find(|name| taken.insert(name.to_lowercase()));
            (&*run.name, free.expect("there are more numbers than runs"))
        };
        let runs = campaign.runs.iter();
        let simulated = runs.filter(|run| run.test.sample_rate().is_some());
        FileNames(simulated.map(&mut named).collect())
    }

    /// The name of the files of a run of the campaign.
    pub fn get(&self, run: &str) -> &str {
        let own = self.0.iter().find(|(name, _)| *name == run);
        &own.expect("the run is simulated").1
    }

    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(_, name)| &**name)
    }
}

/// The name of the file of a run without folder and extensions, or the name that the campaign gives the run. In the
/// latter a stroke is a letter like any other, as in `sweep at 25 mm/s`; after the name of the file it may say more.
fn file_name(run: &Run) -> String {
    let name = match run.name.strip_prefix(&run.file) {
        Some(rest) => {
            let file = Path::new(&run.file).file_name().unwrap_or_default();
            format!("{}{rest}", file.to_string_lossy())
        }
        None => run.name.clone(),
    };
    let name = name.trim_end_matches(".gz").trim_end_matches(".csv");
    name.replace(['/', '\\'], "_")
}

/// Checks that the files to be written replace no file of the campaign, before any work.
///
/// # Errors
/// Fails with the first that would.
pub(crate) fn spare_records(
    campaign: &Campaign,
    folder: &Path,
    files: impl IntoIterator<Item = String>,
) -> Result<(), Failure> {
    let runs = campaign.runs.iter().map(|run| &run.file);
    let own = runs.chain(campaign.roads.iter().map(|road| &road.file));
    let own: HashSet<PathBuf> = own
        .filter_map(|file| campaign.folder.join(file).canonicalize().ok())
        .collect();
    for file in files {
        let target = folder.join(file);
        if target.canonicalize().is_ok_and(|target| own.contains(&target)) {
            let found = format!(
                "{}, a measured file of the campaign, which would be replaced",
                target.display()
            );
            let (expected, remedy) = ("a folder for results alone", "choose another folder");
            return Err(flag("--out", found, expected, remedy).into());
        }
    }
    Ok(())
}
