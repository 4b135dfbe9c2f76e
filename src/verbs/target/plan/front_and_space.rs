//! Further questions: the front, and the solution space.

use qcar_runtime::target::{DesignVariable, Sense};
use toml::Spanned;

use super::Planner;

impl Planner<'_, '_> {
    /// The metrics of the front.
    pub(super) fn fronts(&mut self) -> Vec<(usize, Sense)> {
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
        let mut fronts: Vec<(usize, Sense)> = Vec::new();
        for (name, sense, key) in all {
            let Some(metric) = self.metric(name, key) else { continue };
            if fronts.iter().any(|(other, _)| *other == metric) {
                let found = format!("`{}` for the second time", name.get_ref());
                self.wrong(name, key, &found, "each metric once", "remove one, or name another");
            }
            fronts.push((metric, sense));
        }
        fronts
    }

    /// The probability and the planes of the solution space.
    pub(super) fn space(&mut self, variables: &[DesignVariable]) -> (f64, Vec<[usize; 2]>) {
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
                .map(|name| self.variable_of(&Spanned::new(pair.span(), name.clone()), "space.cuts", variables));
            if let [Some(a), Some(b)] = places {
                cuts.push([a, b]);
            }
        }
        (probability, cuts)
    }
}
