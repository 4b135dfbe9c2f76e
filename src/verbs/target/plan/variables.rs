//! Parameters that may change, with their ranges, steps and costs.

use qcar_runtime::shown::shown;
use qcar_runtime::target::{DesignVariable, Move};
use toml::Spanned;

use super::Planner;
use crate::verbs::target::file::{self, Amount};

impl Planner<'_, '_> {
    /// The design variables, with their units and the parameters that they move.
    pub(super) fn variables(&mut self) -> (Vec<DesignVariable>, Vec<String>, Vec<Move>) {
        let (mut variables, mut units, mut moves): (Vec<DesignVariable>, Vec<String>, Vec<Move>) = Default::default();
        for own in &self.read.file.parameters {
            let Some(place) = self.parameter(&own.name, "parameter.name") else {
                continue;
            };
            if variables.iter().any(|variable| variable.name == *own.name.get_ref()) {
                self.wrong(
                    &own.name,
                    "parameter.name",
                    "a parameter for the second time",
                    "each parameter once",
                    "remove one",
                );
                continue;
            }
            let Some((variable, unit)) = self.variable(own, place) else {
                continue;
            };
            moves.push(Move {
                variable: variables.len(),
                parameter: place,
                factor: 1.0,
                constant: 0.0,
            });
            variables.push(variable);
            units.push(unit);
        }
        if self.read.file.parameters.is_empty() {
            let remedy = "add a table [[parameter]] with name and range for each parameter that may change";
            self.wrong(
                &self.read.file.subject,
                "parameter",
                "no parameter that may change",
                "at least one",
                remedy,
            );
        }
        (variables, units, moves)
    }

    fn variable(&mut self, own: &file::Parameter, place: usize) -> Option<(DesignVariable, String)> {
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
            DesignVariable {
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
        let found = shown(step, unit).to_string();
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
        let found = format!("{} to {}", shown(lower, unit), shown(upper, unit));
        if lower >= upper {
            self.wrong(at, KEY, &found, "a lower value and a higher one", "correct the range");
            return None;
        }
        let valid = model.about().parameters[place].range;
        if let Some((least, most)) = valid.filter(|(least, most)| lower < *least || upper > *most) {
            let name = &model.about().name;
            let expected = {
                let (least, most) = (shown(least, unit), shown(most, unit));
                format!("a range within {least} to {most}, for which model `{name}` is valid")
            };
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
                let found = format!("{}, where {error}", shown(end, unit));
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
}
