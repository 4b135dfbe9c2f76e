//! Uncertainty of the parameters, for every design.

use std::collections::BTreeMap;

use toml::Spanned;

use super::Planner;
use crate::verbs::sensitivity::uncertainty::UncertaintySources;
use crate::verbs::sensitivity::{Percent, per_kelvin};
use crate::verbs::target::file::Uncertainty;

impl Planner<'_, '_> {
    /// The uncertainty, and the required probability of each target at the design, if the file states one.
    pub(super) fn uncertainty(&mut self) -> (UncertaintySources, Option<f64>) {
        let usual = Uncertainty::default();
        let own = self.read.file.uncertainty.as_ref().unwrap_or(&usual);
        if let Some(at) = own.fit.as_ref().filter(|at| *at.get_ref())
            && self.subject.errors.deviations.is_empty()
        {
            let (found, expected) = (
                "a subject without a fit",
                "a campaign that is fitted, or a fit's results",
            );
            let remedy = "name one as subject or in `params`, or remove the line";
            self.wrong(at, "uncertainty.fit", found, expected, remedy);
        }
        let percent = |text: &str| text.parse::<Percent>().map(|own| own.0);
        let sources = UncertaintySources {
            fit: own.fit.as_ref().is_none_or(|at| *at.get_ref()),
            tolerances: self.parts(&own.tolerances, "uncertainty.tolerances", percent),
            per_kelvin: self.parts(&own.per_kelvin, "uncertainty.per_kelvin", per_kelvin),
            temperatures: self.temperatures(own),
        };
        (sources, self.sure(own))
    }

    fn parts(
        &mut self,
        of: &BTreeMap<String, Spanned<String>>,
        key: &str,
        part: impl Fn(&str) -> Result<f64, String>,
    ) -> BTreeMap<usize, f64> {
        let mut parts = BTreeMap::new();
        for (name, text) in of {
            let place = self.parameter(&Spanned::new(text.span(), name.clone()), key);
            match part(text.get_ref()) {
                Ok(part) => parts.extend(place.map(|place| (place, part))),
                Err(words) => {
                    let expected = words.split(", found").next().unwrap_or_default();
                    let expected = expected.trim_start_matches("expected ");
                    let found = format!("\"{}\"", text.get_ref());
                    self.wrong(text, key, &found, expected, "correct the value");
                }
            }
        }
        parts
    }

    fn temperatures(&mut self, own: &Uncertainty) -> [f64; 2] {
        let key = "uncertainty.temperature";
        match &own.temperature {
            Some(at) => {
                let [low, high] = *at.get_ref();
                if !(low < high && low.is_finite() && high.is_finite()) {
                    let found = format!("[{low}, {high}]");
                    let expected = "two temperatures in kelvin relative to that of the values, the lower first";
                    self.wrong(at, key, &found, expected, "correct them");
                }
                if own.per_kelvin.is_empty() {
                    let remedy = "add `per_kelvin = { c_wheel_z = \"-0.3 %\" }`, or remove the temperature";
                    self.wrong(
                        at,
                        key,
                        "nothing that depends on it",
                        "`per_kelvin` for at least one parameter",
                        remedy,
                    );
                }
                [low, high]
            }
            None => {
                if let Some(at) = own.per_kelvin.values().next() {
                    let remedy = "add `temperature = [-30, 50]`, in kelvin relative to that of the values";
                    self.wrong(
                        at,
                        "uncertainty.per_kelvin",
                        "no `temperature`",
                        "a range of temperatures",
                        remedy,
                    );
                }
                [0.0; 2]
            }
        }
    }

    fn sure(&mut self, own: &Uncertainty) -> Option<f64> {
        let at = own.probability.as_ref()?;
        let probability = *at.get_ref();
        if !(0.5..=0.999).contains(&probability) {
            let (found, expected) = (probability.to_string(), "a probability from 0.5 to 0.999");
            self.wrong(at, "uncertainty.probability", &found, expected, "correct it");
        }
        Some(probability)
    }
}
