//! Targets as limits of readings of metrics.

use qcar_runtime::metric::Reading;
use qcar_runtime::shown::shown;
use qcar_runtime::target::{Limit, Sense};
use toml::Spanned;

use super::{Planner, Wanted};
use crate::verbs::sensitivity::selection::fits;
use crate::verbs::target::file;

/// A target with its readings.
pub(super) struct Sought<'a> {
    pub target: &'a file::Target,
    pub readings: Vec<Reading>,
}

impl<'a> Planner<'a, '_> {
    /// The targets with their readings.
    pub(super) fn sought(&mut self) -> Vec<Sought<'a>> {
        let mut all = Vec::new();
        let read = self.read;
        for target in &read.file.targets {
            let Some(metric) = self.metric(&target.metric, "target.metric") else {
                continue;
            };
            self.check_target(target);
            let Some(readings) = self.readings_of(target, metric) else {
                continue;
            };
            if readings.is_empty() {
                self.no_run(target);
                continue;
            }
            all.push(Sought { target, readings });
        }
        if read.file.targets.is_empty() {
            let remedy = "add a table [[target]] with metric and at_most or at_least for each";
            self.wrong(&read.file.subject, "target", "no target", "at least one", remedy);
        }
        all
    }

    /// Reports a wish that is not a cost, and a target without a limit.
    fn check_target(&mut self, target: &file::Target) {
        if let Some(wish) = target
            .wish
            .as_ref()
            .filter(|wish| !(*wish.get_ref() > 0.0 && wish.get_ref().is_finite()))
        {
            let found = wish.get_ref().to_string();
            self.wrong(
                wish,
                "target.wish",
                &found,
                "a cost above zero",
                "correct it, or remove it from what must hold",
            );
        }
        if target.at_most.is_none() && target.at_least.is_none() && target.equals.is_none() {
            let found = "neither `at_most` nor `at_least` nor `equals`";
            self.wrong(&target.metric, "target", found, "a limit", "add one of them");
        }
    }

    /// The readings of a metric on the runs that a target names, or on all runs. Reports a name without a run and gives
    /// `None`.
    fn readings_of(&mut self, target: &file::Target, metric: usize) -> Option<Vec<Reading>> {
        let mut readings = self.ground.readings_of(metric);
        let Some(runs) = &target.runs else {
            return Some(readings);
        };
        let named = |reading: &Reading, pattern: &str| {
            reading
                .course
                .is_some_and(|run| fits(pattern, &self.ground.courses()[run].name))
        };
        let missing = runs
            .get_ref()
            .iter()
            .find(|own| !readings.iter().any(|reading| named(reading, own)));
        let Some(missing) = missing else {
            readings.retain(|reading| runs.get_ref().iter().any(|own| named(reading, own)));
            return Some(readings);
        };
        let known: Vec<&str> = self
            .ground
            .courses()
            .iter()
            .map(|course| course.name.as_str())
            .collect();
        let expected = match self.ground.metrics()[metric].what.is_ridden() {
            true => format!("one of {}", known.join(", ")),
            false => format!("no run, since `{}` needs none", target.metric.get_ref()),
        };
        self.wrong(
            runs,
            "target.runs",
            &format!("`{missing}`"),
            &expected,
            "correct the name or remove it",
        );
        None
    }

    fn no_run(&mut self, target: &file::Target) {
        let (found, expected) = ("no run", "names of runs");
        let remedy = "leave the line out for all runs";
        match &target.runs {
            Some(runs) => self.wrong(runs, "target.runs", found, expected, remedy),
            None => {
                let (expected, remedy) = ("a run that has a value of it", "name another metric");
                self.wrong(&target.metric, "target.metric", found, expected, remedy);
            }
        }
    }

    /// The limits of all readings, with their descriptions.
    pub(super) fn limits(&mut self, sought: &[Sought<'a>], today: &[f64]) -> (Vec<Limit>, Vec<Wanted>) {
        let (mut limits, mut wanted): (Vec<Limit>, Vec<Wanted>) = Default::default();
        for Sought { target, readings } in sought {
            for reading in readings {
                let result = self
                    .ground
                    .readings()
                    .iter()
                    .position(|own| own == reading)
                    .expect("all are measured");
                let metric = &self.ground.metrics()[reading.metric];
                let (name, unit) = (metric.name.clone(), metric.unit.clone());
                let run = reading.course.map(|run| self.ground.courses()[run].name.clone());
                let sides = [
                    (&target.at_most, Sense::AtMost, "target.at_most"),
                    (&target.at_least, Sense::AtLeast, "target.at_least"),
                    (&target.equals, Sense::AtMost, "target.equals"),
                    (&target.equals, Sense::AtLeast, "target.equals"),
                ];
                for (amount, sense, key) in sides {
                    let Some(at) = amount else { continue };
                    let Some(value) = self.amount(at.get_ref(), at, key, &unit, today[result]) else {
                        continue;
                    };
                    let limit = Limit {
                        result,
                        sense,
                        value,
                        wish: target.wish.as_ref().map(|wish| *wish.get_ref()),
                        margin: 0.0,
                    };
                    if let Some(other) = limits.iter().find(|other| contradict(other, &limit)) {
                        self.contradiction((at, key), [value, other.value], (&name, run.as_deref(), &unit));
                        continue;
                    }
                    if limits.contains(&limit) {
                        continue;
                    }
                    limits.push(limit);
                    wanted.push(Wanted {
                        metric: name.clone(),
                        run: run.clone(),
                        unit: unit.to_string(),
                    });
                }
            }
        }
        (limits, wanted)
    }

    /// Reports a limit and the value of another one of the same reading that cannot both be met.
    fn contradiction<T>(
        &mut self,
        (at, key): (&Spanned<T>, &str),
        [here, there]: [f64; 2],
        (metric, run, unit): (&str, Option<&str>, &str),
    ) {
        let of = run.map_or(String::new(), |run| format!(" on {run}"));
        let (here, there) = (shown(here, unit), shown(there, unit));
        let found = format!("{here} for `{metric}`{of}, where another target has {there}");
        self.wrong(
            at,
            key,
            &found,
            "targets that can hold together",
            "remove one of them, or make it a wish",
        );
    }
}

/// True if no value can meet both limits of one result.
fn contradict(a: &Limit, b: &Limit) -> bool {
    let [low, high] = match (a.sense, b.sense) {
        (Sense::AtLeast, Sense::AtMost) => [a, b],
        (Sense::AtMost, Sense::AtLeast) => [b, a],
        _ => return false,
    };
    a.result == b.result && a.wish.is_none() && b.wish.is_none() && low.value > high.value
}
