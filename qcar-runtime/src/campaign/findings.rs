//! Flaws of measured samples, found before a fit.

use qcar_signals::resample::Grid;

use super::contents::{Campaign, Run, Test};
use super::finding::Finding;
use super::history::History;
use super::reading::MissingChannel;
use super::samples::of_samples;
use crate::error::{InputError, Place, Problem};

// Comparison of the left and right sensors of a place.
mod sides;

/// Result of comparing the sensors of both sides of a sweep.
fn of_sides(run: &Run, history: &History) -> Vec<Finding> {
    match run.test {
        Test::Sweep(_) => sides::of_sides(run, history),
        _ => Vec::new(),
    }
}

impl Campaign {
    /// Flaws of the samples of every time history.
    ///
    /// # Errors
    /// Fails as [`Campaign::history`] does.
    pub fn findings(&self) -> Result<Vec<Finding>, InputError> {
        let mut all = Vec::new();
        for run in self.runs.iter().filter(|run| run.test.sample_rate().is_some()) {
            all.extend(match run.plain {
                true => self.of_plain(run)?,
                false => self.of_recorded(run)?,
            });
        }
        Ok(all)
    }

    /// Flaws in the file of a run, and differences between its sensors.
    pub(super) fn of_recorded(&self, run: &Run) -> Result<Vec<Finding>, InputError> {
        let own = self.recorded(run).map(|recorded| recorded.findings.clone());
        let history = self.history(run)?;
        Ok(own.into_iter().flatten().chain(of_sides(run, &history)).collect())
    }

    fn of_plain(&self, run: &Run) -> Result<Vec<Finding>, InputError> {
        let history = self.history(run)?;
        let grid = Grid {
            start: history.start,
            rate: history.sample_rate,
            count: history.len(),
        };
        let signals = history.signals.iter();
        let of = |(channel, samples): &(super::Channel, Vec<f64>)| {
            of_samples(run, (&channel.name, channel.unit()), samples, grid)
        };
        Ok(signals.flat_map(of).chain(of_sides(run, &history)).collect())
    }

    /// Problems of all recorded runs together: channels that no file has, and dead channels that a fit needs.
    pub(super) fn problems_of_recorded(&self) -> Vec<Problem> {
        let unheard = self
            .mappings
            .iter()
            .filter(|mapping| !mapping.shared && self.is_in_no_run(&mapping.name));
        let unheard = unheard.filter_map(|mapping| Some(self.missing(&mapping.name).next()?.1.problem.clone()));
        let findings = self.recorded.iter().flat_map(|recorded| &recorded.findings);
        let dead = findings
            .filter(|finding| finding.fatal)
            .map(|finding| self.dead(finding));
        unheard.chain(dead).collect()
    }

    /// True if no run has a sensor that a measured file could contain.
    fn is_in_no_run(&self, name: &str) -> bool {
        let mut plain = self
            .runs
            .iter()
            .filter(|run| run.plain && run.test.sample_rate().is_some());
        plain.next().is_none() && !self.recorded.iter().any(|recorded| recorded.has(name))
    }

    /// True if a sensor was missing in some file.
    pub(super) fn is_missed(&self, name: &str) -> bool {
        self.missing(name).next().is_some()
    }

    fn dead(&self, finding: &Finding) -> Problem {
        let (run, name) = (&finding.run, &finding.channel);
        let place = Place::Channel(name.clone(), None);
        let remedy =
            format!("leave it out of the run with `without = [\"{name}\"]`, or repair the sensor and measure again");
        Problem::new(self.folder.join(run), place, &finding.what, "a usable signal", remedy)
    }

    /// Sentences on channels that a run lacks although another of its kind has them, or that no run has.
    pub(super) fn gaps_of_recorded(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        for mapping in &self.mappings {
            let mut missing = self.missing(&mapping.name);
            match missing.next() {
                Some((_, first)) if self.is_in_no_run(&mapping.name) => sentences.push(first.problem.to_string()),
                Some(first) => {
                    let lacking = std::iter::once(first)
                        .chain(missing)
                        .filter(|(run, _)| self.has_relative(run, &mapping.name));
                    sentences.extend(
                        lacking.map(|(_, missing)| format!("{}; other runs of the kind have it", missing.problem)),
                    );
                }
                None => {}
            }
        }
        sentences
    }

    /// True if a run of the same kind has a sensor.
    fn has_relative(&self, run: &str, name: &str) -> bool {
        let kind = |name: &str| {
            let run = self.runs.iter().find(|run| run.name == name);
            run.map(|run| std::mem::discriminant(&run.test))
        };
        let mut others = self.recorded.iter().filter(|other| kind(&other.run) == kind(run));
        others.any(|other| other.has(name))
    }

    /// The runs whose file has no channel for a sensor.
    fn missing<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (&'a str, &'a MissingChannel)> {
        self.recorded.iter().flat_map(move |recorded| {
            let own = recorded.missing.iter().filter(move |missing| missing.name == name);
            own.map(|missing| (recorded.run.as_str(), missing))
        })
    }
}
