//! From the file to a task: names become positions, texts become numbers in SI.

// The parameters that may change.
mod variables;
// Constraints between parameters.
mod couplings;
// Limits of metrics.
mod limits;
// Uncertainty of the parameters.
mod uncertainty;
// Front and solution space.
mod front_and_space;

use qcar_runtime::error::{InputError, Problem};
use qcar_runtime::mean::mean;
use qcar_runtime::metric::{Ground, Reading};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::sensitivity::Chance;
use qcar_runtime::target::{Axle, Coupling, DesignVariable, Limit, Move, Sense, Task};
use toml::Spanned;

use super::file::{Amount, AmountKind, Read};
use crate::failure::Failure;
use crate::verbs::sensitivity::refused;
use crate::verbs::sensitivity::selection;
use crate::verbs::sensitivity::subject::Subject;
use crate::verbs::sensitivity::uncertainty::UncertaintySources;
use limits::Sought;

/// A task with the names and units of its parts.
pub(super) struct Plan {
    pub variables: Vec<DesignVariable>,
    /// Unit of each design variable.
    pub units: Vec<String>,
    pub moves: Vec<Move>,
    pub limits: Vec<Limit>,
    pub couplings: Vec<Coupling>,
    /// Description of each limit, then of each coupling.
    pub wanted: Vec<Wanted>,
    /// Results that are means of readings over the runs.
    pub means: Vec<Vec<usize>>,
    /// Metrics of the front with their results.
    pub aims: Vec<Aim>,
    /// Present values of all results.
    pub today: Vec<f64>,
    pub probability: f64,
    pub cuts: Vec<[usize; 2]>,
    pub generations: usize,
    pub sources: UncertaintySources,
    /// Required probability of each target at the design, if the file states one.
    pub sure: Option<f64>,
}

/// A limit in words.
pub(super) struct Wanted {
    /// `body_x.peak`, or the coupling.
    pub metric: String,
    /// Name of the run, for a metric of rides.
    pub run: Option<String>,
    pub unit: String,
}

/// A metric of the front.
pub(super) struct Aim {
    pub metric: String,
    pub unit: String,
    pub result: usize,
    pub sense: Sense,
}

/// The reader of the file, with the problems so far.
struct Planner<'a, 'g> {
    read: &'a Read,
    subject: &'a Subject,
    ground: &'a mut Ground<'g>,
    problems: Vec<Problem>,
}

impl Plan {
    /// Reads the task of a file for its subject.
    ///
    /// # Errors
    /// Fails with all problems of the file, or if a metric cannot be computed for the present axle.
    pub fn of(read: &Read, subject: &Subject, ground: &mut Ground<'_>) -> Result<Self, Failure> {
        let mut planner = Planner {
            read,
            subject,
            ground,
            problems: Vec::new(),
        };
        let (variables, units, mut moves) = planner.variables();
        let couplings = planner.couplings(&variables, &mut moves);
        let sought = planner.sought();
        let fronts = planner.fronts();
        let (probability, cuts) = planner.space(&variables);
        let (sources, sure) = planner.uncertainty();
        planner.finish(Some(()))?;
        let Planner { ground, .. } = &mut planner;
        let means = choose(ground, &sought, &fronts);
        let measured = ground
            .measure(&subject.values)
            .map_err(|error| refused(&subject.name, &error))?;
        let (limits, mut wanted) = planner.limits(&sought, &measured);
        planner.finish(Some(()))?;
        wanted.extend(couplings.iter().map(|(words, _)| Wanted {
            metric: words.clone(),
            run: None,
            unit: "1".into(),
        }));
        let averages = means.iter().map(|of| mean(of.iter().map(|&at| measured[at])));
        let today = measured.iter().copied().chain(averages).collect();
        let generations = read.file.front.as_ref().and_then(|front| front.generations);
        Ok(Self {
            aims: aims(planner.ground, &fronts, measured.len()),
            couplings: couplings.into_iter().map(|(_, own)| own).collect(),
            variables,
            units,
            moves,
            limits,
            wanted,
            means,
            today,
            probability,
            cuts,
            sources,
            sure,
            generations: generations.unwrap_or(40),
        })
    }

    /// The designs of the task: the subject with its parameters at values of the design variables.
    pub fn axle<'a>(&self, subject: &Subject, ground: &'a Ground<'a>, chance: Chance) -> Axle<'a> {
        Axle {
            ground,
            values: subject.values.clone(),
            moves: self.moves.clone(),
            variables: self.variables.len(),
            means: self.means.clone(),
            chance,
        }
    }

    /// The task for these designs.
    pub fn task<'a>(&self, designs: &'a Axle<'_>) -> Task<'a> {
        Task {
            designs,
            variables: self.variables.clone(),
            limits: self.limits.clone(),
            couplings: self.couplings.clone(),
        }
    }
}

/// What a front is about: means of metrics, which come after the `measured` readings.
fn aims(ground: &Ground<'_>, fronts: &[(usize, Sense)], measured: usize) -> Vec<Aim> {
    let metrics = ground.metrics();
    let aim = |(at, (metric, sense)): (usize, &(usize, Sense))| Aim {
        metric: metrics[*metric].name.clone(),
        unit: metrics[*metric].unit.to_string(),
        result: measured + at,
        sense: *sense,
    };
    fronts.iter().enumerate().map(aim).collect()
}

/// Sets the readings of the ground without duplicates. Returns the positions of the readings of each metric of the
/// front.
fn choose(ground: &mut Ground<'_>, sought: &[Sought<'_>], fronts: &[(usize, Sense)]) -> Vec<Vec<usize>> {
    let mut readings: Vec<Reading> = Vec::new();
    let mut place = |reading: &Reading| {
        readings.iter().position(|own| own == reading).unwrap_or_else(|| {
            readings.push(reading.clone());
            readings.len() - 1
        })
    };
    sought
        .iter()
        .flat_map(|own| &own.readings)
        .for_each(|reading| _ = place(reading));
    let means = fronts
        .iter()
        .map(|(metric, _)| ground.readings_of(*metric).iter().map(&mut place).collect())
        .collect();
    ground.choose(readings);
    means
}

impl<'a> Planner<'a, '_> {
    fn finish<T>(&mut self, value: Option<T>) -> Result<T, InputError> {
        InputError::unless_empty(std::mem::take(&mut self.problems), value)
    }

    fn wrong<T>(&mut self, at: &Spanned<T>, key: &str, found: &str, expected: &str, remedy: &str) {
        let problem = self.read.problem(at, key, found, expected, remedy);
        // A target applies to several runs, in all of which it is as wrong.
        if !self.problems.contains(&problem) {
            self.problems.push(problem);
        }
    }

    fn values(&self) -> &'a Values {
        &self.subject.values
    }

    fn parameter(&mut self, name: &Spanned<String>, key: &str) -> Option<usize> {
        let read = self.read;
        let problem = |found: &str, expected: &str, remedy: &str| read.problem(name, key, found, expected, remedy);
        let found = selection::parameter(self.subject.model.about(), self.values(), name.get_ref(), problem);
        found.map_err(|error| self.problems.extend(error.problems)).ok()
    }

    fn amount<T>(&mut self, own: &Amount, at: &Spanned<T>, key: &str, unit: &str, today: f64) -> Option<f64> {
        match own.of(unit) {
            Ok(AmountKind::Value(value)) => Some(value),
            Ok(AmountKind::OfToday(part)) => Some(part * today),
            Err(found) => {
                let expected = format!("a number in {unit}, a quantity of that kind, or percent of today's value");
                self.wrong(at, key, &found, &expected, "correct the value or its unit");
                None
            }
        }
    }

    /// The design variable of a parameter that may change.
    fn variable_of(&mut self, name: &Spanned<String>, key: &str, variables: &[DesignVariable]) -> Option<usize> {
        let found = variables.iter().position(|variable| variable.name == *name.get_ref());
        // Where its own table is wrong, this has been said.
        let is_named = self
            .read
            .file
            .parameters
            .iter()
            .any(|own| own.name.get_ref() == name.get_ref());
        if found.is_none() && !is_named {
            let words = format!("`{}`", name.get_ref());
            self.wrong(
                name,
                key,
                &words,
                "a parameter that may change",
                "give it a table [[parameter]] with its range",
            );
        }
        found
    }

    fn metric(&mut self, name: &Spanned<String>, key: &str) -> Option<usize> {
        let found = self
            .ground
            .metrics()
            .iter()
            .position(|metric| metric.name == *name.get_ref());
        if found.is_none() {
            let read = self.read;
            let problem = |found: &str, expected: &str, remedy: &str| read.problem(name, key, found, expected, remedy);
            self.problems
                .push(selection::unknown(self.ground, name.get_ref(), problem));
        }
        found
    }
}
