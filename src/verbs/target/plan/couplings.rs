//! Couplings between parameters.

use std::collections::BTreeMap;

use qcar_runtime::target::{Coupling, DesignVariable, Move};
use toml::Spanned;

use super::Planner;
use crate::verbs::target::file;

impl Planner<'_, '_> {
    /// Reads the couplings: parameters that follow others become moves, sums become limits.
    pub(super) fn couplings(&mut self, variables: &[DesignVariable], moves: &mut Vec<Move>) -> Vec<(String, Coupling)> {
        let mut couplings = Vec::new();
        for own in &self.read.file.couplings {
            match own {
                file::Coupling {
                    parameter: Some(parameter),
                    follows: Some(follows),
                    sum: None,
                    at_most: None,
                    factor,
                } => {
                    let follower = self.follower((parameter, follows), *factor, variables, moves);
                    moves.extend(follower);
                }
                file::Coupling {
                    parameter: None,
                    follows: None,
                    sum: Some(sum),
                    at_most: Some(most),
                    factor: None,
                } => couplings.extend(self.bounded_sum(sum, *most, variables)),
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

    /// The move of a parameter that follows another one, times `factor` or today's ratio. Reports a mistake and gives
    /// `None` if it cannot follow.
    fn follower(
        &mut self,
        (parameter, follows): (&Spanned<String>, &Spanned<String>),
        factor: Option<f64>,
        variables: &[DesignVariable],
        moves: &[Move],
    ) -> Option<Move> {
        let followed = self.variable_of(follows, "coupling.follows", variables);
        let place = self.parameter(parameter, "coupling.parameter");
        let (variable, place) = (followed?, place?);
        if moves.iter().any(|own| own.parameter == place) {
            let found = "a parameter that already follows or changes";
            self.wrong(
                parameter,
                "coupling.parameter",
                found,
                "a parameter that follows no other",
                "remove one of them",
            );
            return None;
        }
        let ratio = self.values().as_slice()[place] / variables[variable].today;
        let factor = factor.unwrap_or(ratio);
        let leader = (&variables[variable], moves[variable].parameter);
        if let Err((found, expected)) = self.can_follow(place, leader, factor) {
            let remedy = "correct the factor, or narrow the range of what it follows";
            self.wrong(parameter, "coupling.parameter", &found, &expected, remedy);
            return None;
        }
        Some(Move {
            variable,
            parameter: place,
            factor,
            constant: 0.0,
        })
    }

    /// The limit of a sum of parameters, with its description. Reports a mistake and gives `None` if a number is not
    /// finite.
    fn bounded_sum(
        &mut self,
        sum: &Spanned<BTreeMap<String, f64>>,
        most: f64,
        variables: &[DesignVariable],
    ) -> Option<(String, Coupling)> {
        if !most.is_finite() || !sum.get_ref().values().all(|factor| factor.is_finite()) {
            let (found, expected) = ("a number that is not finite", "finite factors and a finite `at_most`");
            self.wrong(sum, "coupling.sum", found, expected, "correct the numbers");
            return None;
        }
        let mut factors = vec![0.0; variables.len()];
        for (name, factor) in sum.get_ref() {
            let named = Spanned::new(sum.span(), name.clone());
            if let Some(variable) = self.variable_of(&named, "coupling.sum", variables) {
                factors[variable] = *factor;
            }
        }
        let terms: Vec<String> = sum
            .get_ref()
            .iter()
            .map(|(name, factor)| format!("{factor} {name}"))
            .collect();
        Some((terms.join(" + "), Coupling { factors, most }))
    }

    /// Checks a parameter that is a factor times a design variable at both ends of its range. Fails with what was found
    /// and what was expected.
    fn can_follow(
        &self,
        place: usize,
        (variable, leader): (&DesignVariable, usize),
        factor: f64,
    ) -> Result<(), (String, String)> {
        let (model, about) = (&self.subject.model, self.subject.model.about());
        let own = &about.parameters[place];
        if !factor.is_finite() {
            return Err((
                format!("`{}` at {factor} times `{}`", own.name, variable.name),
                "a finite factor".into(),
            ));
        }
        for end in [variable.lower, variable.upper] {
            let value = factor * end;
            let found = format!(
                "`{}` at {value} {} where `{}` is {end}",
                own.name, own.unit, variable.name
            );
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
}
