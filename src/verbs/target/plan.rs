//! From the file to a task: names become places, texts become numbers in SI.

use qcar_runtime::error::{InputError, Problem};
use qcar_runtime::metric::{Ground, Reading};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::target::{Coupling, Knob, Limit, Move, Sense};
use toml::Spanned;

use super::file::{self, Amount, Meant, Read};
use crate::failure::Failure;
use crate::verbs::sensitivity::chosen::{self, fits};
use crate::verbs::sensitivity::refused;
use crate::verbs::sensitivity::subject::Subject;

/// All that a task is made of.
pub(super) struct Plan {
    pub knobs: Vec<Knob>,
    /// Unit of each.
    pub units: Vec<String>,
    pub moves: Vec<Move>,
    pub limits: Vec<Limit>,
    pub couplings: Vec<Coupling>,
    /// What each limit and, behind them, each coupling is.
    pub wanted: Vec<Wanted>,
    /// Results that are means of readings over the runs.
    pub means: Vec<Vec<usize>>,
    /// Metrics of the front with their results.
    pub aims: Vec<Aim>,
    /// Values of all results today.
    pub today: Vec<f64>,
    pub probability: f64,
    pub cuts: Vec<[usize; 2]>,
    pub generations: usize,
}

/// A limit in words.
pub(super) struct Wanted {
    /// `body_x.peak`, or the coupling.
    pub metric: String,
    /// Of what is ridden.
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

/// Whoever reads the file, and what was wrong so far.
struct Planner<'a, 'g> {
    read: &'a Read,
    subject: &'a Subject,
    ground: &'a mut Ground<'g>,
    problems: Vec<Problem>,
}

impl Plan {
    /// Reads what the file wants of a subject.
    ///
    /// # Errors
    /// All problems of the file together; metrics that cannot be measured today.
    pub fn of(read: &Read, subject: &Subject, ground: &mut Ground<'_>) -> Result<Self, Failure> {
        let mut planner = Planner {
            read,
            subject,
            ground,
            problems: Vec::new(),
        };
        let (knobs, units, mut moves) = planner.knobs();
        let couplings = planner.couplings(&knobs, &mut moves);
        let sought = planner.sought();
        let fronts = planner.fronts();
        let (probability, cuts) = planner.space(&knobs);
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
        let mut today = measured.clone();
        today.extend(
            means
                .iter()
                .map(|of| of.iter().map(|&at| measured[at]).sum::<f64>() / of.len() as f64),
        );
        let metrics = planner.ground.metrics();
        let aims = fronts.iter().enumerate().map(|(at, (metric, sense))| Aim {
            metric: metrics[*metric].name.clone(),
            unit: metrics[*metric].unit.into(),
            result: measured.len() + at,
            sense: *sense,
        });
        Ok(Self {
            aims: aims.collect(),
            couplings: couplings.into_iter().map(|(_, own)| own).collect(),
            knobs,
            units,
            moves,
            limits,
            wanted,
            means,
            today,
            probability,
            cuts,
            generations: read
                .file
                .front
                .as_ref()
                .and_then(|front| front.generations)
                .unwrap_or(40),
        })
    }
}

/// A target with the readings that it is of.
struct Sought<'a> {
    target: &'a file::Target,
    readings: Vec<Reading>,
}

/// Makes the ground measure all that is sought, each once; for each metric of the front the places of its readings.
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
        self.problems.push(self.read.problem(at, key, found, expected, remedy));
    }

    fn values(&self) -> &'a Values {
        &self.subject.values
    }

    /// What may move, with its unit and what it moves.
    fn knobs(&mut self) -> (Vec<Knob>, Vec<String>, Vec<Move>) {
        let (mut knobs, mut units, mut moves): (Vec<Knob>, Vec<String>, Vec<Move>) = Default::default();
        for own in &self.read.file.parameters {
            let Some(place) = self.parameter(&own.name, "parameter.name") else {
                continue;
            };
            if knobs.iter().any(|knob| knob.name == *own.name.get_ref()) {
                self.wrong(
                    &own.name,
                    "parameter.name",
                    "a parameter for the second time",
                    "each parameter once",
                    "remove one",
                );
                continue;
            }
            let Some((knob, unit)) = self.knob(own, place) else {
                continue;
            };
            moves.push(Move {
                knob: knobs.len(),
                parameter: place,
                factor: 1.0,
                constant: 0.0,
            });
            knobs.push(knob);
            units.push(unit);
        }
        if self.read.file.parameters.is_empty() {
            let remedy = "add a table [[parameter]] with name and range for each that may";
            self.wrong(
                &self.read.file.subject,
                "parameter",
                "no parameter that may move",
                "at least one",
                remedy,
            );
        }
        (knobs, units, moves)
    }

    fn parameter(&mut self, name: &Spanned<String>, key: &str) -> Option<usize> {
        let read = self.read;
        let problem = |found: &str, expected: &str, remedy: &str| read.problem(name, key, found, expected, remedy);
        let found = chosen::parameter(self.subject.model.about(), self.values(), name.get_ref(), problem);
        found.map_err(|error| self.problems.extend(error.problems)).ok()
    }

    fn knob(&mut self, own: &file::Parameter, place: usize) -> Option<(Knob, String)> {
        let (unit, today) = (
            self.subject.model.about().parameters[place].unit.to_string(),
            self.values().as_slice()[place],
        );
        let [lower, upper] = self.range(&own.range, place, &unit)?;
        let step = match &own.step {
            Some(at) => Some(self.step(at, &unit, (today, upper - lower))?),
            None => None,
        };
        let cost = own.cost.as_ref().map_or(1.0, |cost| *cost.get_ref());
        if let Some(at) = own.cost.as_ref().filter(|_| !(cost >= 0.0 && cost.is_finite())) {
            self.wrong(
                at,
                "parameter.cost",
                &cost.to_string(),
                "a cost of zero or more",
                "correct the cost",
            );
            return None;
        }
        let name = own.name.get_ref().clone();
        Some((
            Knob {
                name,
                lower,
                upper,
                today,
                step,
                cost,
            },
            unit,
        ))
    }

    fn step(&mut self, at: &Spanned<Amount>, unit: &str, (today, span): (f64, f64)) -> Option<f64> {
        let step = self.amount(at.get_ref(), at, "parameter.step", unit, today)?;
        if step > 0.0 && step <= span {
            return Some(step);
        }
        let found = format!("{step} {unit}");
        self.wrong(
            at,
            "parameter.step",
            &found,
            "a step above zero that fits into the range",
            "correct the step",
        );
        None
    }

    /// The ends of a range in which the model is valid and has masses.
    fn range(&mut self, at: &Spanned<[Amount; 2]>, place: usize, unit: &str) -> Option<[f64; 2]> {
        const KEY: &str = "parameter.range";
        let (model, values) = (&self.subject.model, self.values());
        let [low, high] = at.get_ref();
        let today = values.as_slice()[place];
        let lower = self.amount(low, at, KEY, unit, today)?;
        let upper = self.amount(high, at, KEY, unit, today)?;
        let found = format!("{lower} to {upper} {unit}");
        if lower >= upper {
            self.wrong(at, KEY, &found, "a lower value and a higher one", "correct the range");
            return None;
        }
        let valid = model.about().parameters[place].range;
        if let Some((least, most)) = valid.filter(|(least, most)| lower < *least || upper > *most) {
            let name = &model.about().name;
            let expected = format!("a range within {least} to {most} {unit}, for which model `{name}` is valid");
            self.wrong(
                at,
                KEY,
                &found,
                &expected,
                "narrow the range, or widen that of the model",
            );
            return None;
        }
        for end in [lower, upper] {
            let mut moved = values.clone();
            moved.set(place, end);
            if let Err(error) = model.check_inertias(moved.as_slice()) {
                let found = format!("{end} {unit}, where {error}");
                self.wrong(
                    at,
                    KEY,
                    &found,
                    "a range in which all masses are above zero",
                    "narrow the range",
                );
                return None;
            }
        }
        Some([lower, upper])
    }

    fn amount<T>(&mut self, own: &Amount, at: &Spanned<T>, key: &str, unit: &str, today: f64) -> Option<f64> {
        match own.of(unit) {
            Ok(Meant::Value(value)) => Some(value),
            Ok(Meant::OfToday(part)) => Some(part * today),
            Err(found) => {
                let expected = format!("a number in {unit}, a quantity of that kind, or percent of today's value");
                self.wrong(at, key, &found, &expected, "correct the value or its unit");
                None
            }
        }
    }

    /// What must hold between parameters: those that follow are moved, sums are limits.
    fn couplings(&mut self, knobs: &[Knob], moves: &mut Vec<Move>) -> Vec<(String, Coupling)> {
        let mut couplings = Vec::new();
        for own in &self.read.file.couplings {
            match own {
                file::Coupling {
                    parameter: Some(parameter),
                    follows: Some(follows),
                    sum: None,
                    at_most: None,
                    ..
                } => {
                    let followed = self.parameter_knob(follows, "coupling.follows", knobs);
                    let place = self.parameter(parameter, "coupling.parameter");
                    let (Some(knob), Some(place)) = (followed, place) else {
                        continue;
                    };
                    if moves.iter().any(|own| own.parameter == place) {
                        let found = "a parameter that moves already";
                        self.wrong(
                            parameter,
                            "coupling.parameter",
                            found,
                            "one that follows nothing else",
                            "remove one of both",
                        );
                        continue;
                    }
                    let ratio = self.values().as_slice()[place] / knobs[knob].today;
                    let factor = own.factor.unwrap_or(ratio);
                    let leader = (&knobs[knob], moves[knob].parameter);
                    if let Err((found, expected)) = self.can_follow(place, leader, factor) {
                        let remedy = "correct the factor, or narrow the range of what it follows";
                        self.wrong(parameter, "coupling.parameter", &found, &expected, remedy);
                        continue;
                    }
                    moves.push(Move {
                        knob,
                        parameter: place,
                        factor,
                        constant: 0.0,
                    });
                }
                file::Coupling {
                    parameter: None,
                    follows: None,
                    sum: Some(sum),
                    at_most: Some(most),
                    factor: None,
                } => {
                    if !most.is_finite() || !sum.get_ref().values().all(|factor| factor.is_finite()) {
                        let (found, expected) =
                            ("a number that is not finite", "finite factors and a finite `at_most`");
                        self.wrong(sum, "coupling.sum", found, expected, "correct the numbers");
                        continue;
                    }
                    let mut factors = vec![0.0; knobs.len()];
                    for (name, factor) in sum.get_ref() {
                        let named = Spanned::new(sum.span(), name.clone());
                        if let Some(knob) = self.parameter_knob(&named, "coupling.sum", knobs) {
                            factors[knob] = *factor;
                        }
                    }
                    let words: Vec<String> = sum
                        .get_ref()
                        .iter()
                        .map(|(name, factor)| format!("{factor} {name}"))
                        .collect();
                    couplings.push((words.join(" + "), Coupling { factors, most: *most }));
                }
                _ => {
                    let at = &self.read.file.subject;
                    let expected = "`parameter` and `follows`, or `sum` and `at_most`";
                    self.wrong(
                        at,
                        "coupling",
                        "a [[coupling]] of another kind",
                        expected,
                        "docs/targets.md shows both",
                    );
                }
            }
        }
        couplings
    }

    /// Checks a parameter that is a factor times a knob, at both ends of its range; else what was found and expected.
    fn can_follow(&self, place: usize, (knob, leader): (&Knob, usize), factor: f64) -> Result<(), (String, String)> {
        let (model, about) = (&self.subject.model, self.subject.model.about());
        let own = &about.parameters[place];
        if !factor.is_finite() {
            return Err((
                format!("`{}` at {factor} times `{}`", own.name, knob.name),
                "a finite factor".into(),
            ));
        }
        for end in [knob.lower, knob.upper] {
            let value = factor * end;
            let found = format!("`{}` at {value} {} where `{}` is {end}", own.name, own.unit, knob.name);
            if let Some((least, most)) = own.range.filter(|(least, most)| value < *least || value > *most) {
                let valid = format!(
                    "{least} to {most} {}, for which model `{}` is valid",
                    own.unit, about.name
                );
                return Err((found, valid));
            }
            let mut moved = self.values().clone();
            moved.set(leader, end);
            moved.set(place, value);
            if let Err(error) = model.check_inertias(moved.as_slice()) {
                return Err((format!("{found}: {error}"), "masses above zero".into()));
            }
        }
        Ok(())
    }

    /// The knob of a parameter that may move.
    fn parameter_knob(&mut self, name: &Spanned<String>, key: &str, knobs: &[Knob]) -> Option<usize> {
        let found = knobs.iter().position(|knob| knob.name == *name.get_ref());
        if found.is_none() {
            let words = format!("`{}`", name.get_ref());
            self.wrong(
                name,
                key,
                &words,
                "a parameter that may move",
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
                .push(chosen::unknown(self.ground, name.get_ref(), problem));
        }
        found
    }

    /// The targets with their readings.
    fn sought(&mut self) -> Vec<Sought<'a>> {
        let mut all = Vec::new();
        let read = self.read;
        for target in &read.file.targets {
            let Some(metric) = self.metric(&target.metric, "target.metric") else {
                continue;
            };
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
            if target.at_most.is_none() && target.at_least.is_none() {
                let found = "neither `at_most` nor `at_least`";
                self.wrong(&target.metric, "target", found, "a limit", "add one of both");
            }
            let mut readings = self.ground.readings_of(metric);
            if let Some(runs) = &target.runs {
                let named = |reading: &Reading, pattern: &str| {
                    reading
                        .course
                        .is_some_and(|run| fits(pattern, &self.ground.courses()[run].name))
                };
                let missing = runs
                    .get_ref()
                    .iter()
                    .find(|own| !readings.iter().any(|reading| named(reading, own)));
                if let Some(missing) = missing.cloned() {
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
                    continue;
                }
                readings.retain(|reading| runs.get_ref().iter().any(|own| named(reading, own)));
            }
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

    /// The limits of all readings, and what they are.
    fn limits(&mut self, sought: &[Sought<'a>], today: &[f64]) -> (Vec<Limit>, Vec<Wanted>) {
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
                let (name, unit) = (metric.name.clone(), metric.unit);
                let run = reading.course.map(|run| self.ground.courses()[run].name.clone());
                let sides = [
                    (&target.at_most, Sense::AtMost, "target.at_most"),
                    (&target.at_least, Sense::AtLeast, "target.at_least"),
                ];
                for (amount, sense, key) in sides {
                    let Some(at) = amount else { continue };
                    let Some(value) = self.amount(at.get_ref(), at, key, unit, today[result]) else {
                        continue;
                    };
                    let limit = Limit {
                        result,
                        sense,
                        value,
                        wish: target.wish.as_ref().map(|wish| *wish.get_ref()),
                    };
                    if let Some(other) = limits.iter().find(|other| contradict(other, &limit)) {
                        let of = run.as_ref().map_or(String::new(), |run| format!(" on {run}"));
                        let found = format!(
                            "{value} {unit} for `{name}`{of}, where another target has {} {unit}",
                            other.value
                        );
                        self.wrong(
                            at,
                            key,
                            &found,
                            "targets that can hold together",
                            "remove one of both, or make it a wish",
                        );
                        continue;
                    }
                    limits.push(limit);
                    wanted.push(Wanted {
                        metric: name.clone(),
                        run: run.clone(),
                        unit: unit.into(),
                    });
                }
            }
        }
        (limits, wanted)
    }

    /// The metrics of the front.
    fn fronts(&mut self) -> Vec<(usize, Sense)> {
        let read = self.read;
        let Some(front) = &read.file.front else {
            return Vec::new();
        };
        let smallest = front
            .smallest
            .iter()
            .map(|name| (name, Sense::AtMost, "front.smallest"));
        let largest = front.largest.iter().map(|name| (name, Sense::AtLeast, "front.largest"));
        let all: Vec<_> = smallest.chain(largest).collect();
        if !(2..=3).contains(&all.len()) {
            let found = format!("{} metrics", all.len());
            self.wrong(
                &read.file.subject,
                "front",
                &found,
                "two or three metrics",
                "name them in `smallest` or `largest`",
            );
        }
        all.into_iter()
            .filter_map(|(name, sense, key)| Some((self.metric(name, key)?, sense)))
            .collect()
    }

    /// The probability and the planes of the solution space.
    fn space(&mut self, knobs: &[Knob]) -> (f64, Vec<[usize; 2]>) {
        const USUAL: f64 = 0.95;
        let read = self.read;
        let Some(space) = &read.file.space else {
            return (USUAL, Vec::new());
        };
        let probability = space.probability.as_ref().map_or(USUAL, |own| *own.get_ref());
        if let Some(at) = space
            .probability
            .as_ref()
            .filter(|_| !(0.5..=0.999).contains(&probability))
        {
            let found = probability.to_string();
            self.wrong(
                at,
                "space.probability",
                &found,
                "a probability from 0.5 to 0.999",
                "correct it",
            );
        }
        let mut cuts = Vec::new();
        for pair in &space.cuts {
            let places = pair
                .get_ref()
                .each_ref()
                .map(|name| self.parameter_knob(&Spanned::new(pair.span(), name.clone()), "space.cuts", knobs));
            if let [Some(a), Some(b)] = places {
                cuts.push([a, b]);
            }
        }
        (probability, cuts)
    }
}

/// True of two limits of one result that no value can meet.
fn contradict(a: &Limit, b: &Limit) -> bool {
    let [low, high] = match (a.sense, b.sense) {
        (Sense::AtLeast, Sense::AtMost) => [a, b],
        (Sense::AtMost, Sense::AtLeast) => [b, a],
        _ => return false,
    };
    a.result == b.result && a.wish.is_none() && b.wish.is_none() && low.value > high.value
}
