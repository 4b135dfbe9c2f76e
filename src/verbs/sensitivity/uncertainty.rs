//! Uncertainty of a subject's parameters: the errors of its fit, tolerances of its parts, and the temperature.

use std::collections::BTreeMap;
use std::str::FromStr;

use qcar_runtime::ensemble::{Estimate, Posterior};
use qcar_runtime::error::InputError;
use qcar_runtime::sensitivity::{Chance, ParameterUncertainty, size};

use super::subject::Subject;
use crate::failure::flag;

/// The stated uncertainty. Parameters are given by their positions; none is tied to another.
#[derive(Clone, Debug, Default)]
pub(crate) struct UncertaintySources {
    /// True if the errors of the fit are included.
    pub fit: bool,
    /// Parameters with their relative tolerances: uniform distributions.
    pub tolerances: BTreeMap<usize, f64>,
    /// Parameters with their relative changes per kelvin.
    pub per_kelvin: BTreeMap<usize, f64>,
    /// Range of the temperature relative to that of the values, K.
    pub temperatures: [f64; 2],
}

/// Two temperatures, K, as `-30..50`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Temperatures(pub [f64; 2]);

impl FromStr for Temperatures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once("..");
        let ends = ends.and_then(|(low, high)| Some([low.trim().parse().ok()?, high.trim().parse().ok()?]));
        let ends = ends.filter(|[low, high]: &[f64; 2]| low < high && low.is_finite() && high.is_finite());
        ends.map(Temperatures).ok_or_else(|| {
            format!("expected two temperatures in kelvin, the lower first, such as -30..50, found `{text}`")
        })
    }
}

/// Smallest value of a drawn parameter relative to its estimate; smaller values are not physical.
const LEAST: f64 = 1e-3;

impl UncertaintySources {
    /// The uncertain parameters.
    pub fn places(&self, subject: &Subject) -> Vec<usize> {
        let all = 0..subject.values.as_slice().len();
        all.filter(|place| {
            self.error(subject, *place) > 0.0
                || self.tolerances.contains_key(place)
                || self.per_kelvin.contains_key(place)
        })
        .collect()
    }

    /// The parameters with a standard error of the fit.
    pub fn fitted(&self, subject: &Subject) -> Vec<usize> {
        let all = 0..subject.values.as_slice().len();
        all.filter(|place| self.error(subject, *place) > 0.0).collect()
    }

    /// The standard error of a parameter from the fit; zero if it is unknown.
    fn error(&self, subject: &Subject, place: usize) -> f64 {
        let leads = subject.values.leader(place) == place;
        let name = &subject.model.about().parameters[place].name;
        let error = subject.errors.deviations.get(&**name).filter(|_| self.fit && leads);
        error.copied().unwrap_or(0.0)
    }

    fn correlation(&self, subject: &Subject, places: [usize; 2]) -> f64 {
        let [a, b] = places.map(|place| subject.model.about().parameters[place].name.to_string());
        subject.errors.correlations.get(&(a, b)).copied().unwrap_or(0.0)
    }

    /// The uncertainty of these parameters to first order; `None` if all are certain.
    pub fn uncertainty(&self, subject: &Subject, places: &[usize]) -> Option<ParameterUncertainty> {
        let of = |known: &BTreeMap<usize, f64>| -> Vec<f64> {
            places
                .iter()
                .map(|place| known.get(place).copied().unwrap_or(0.0))
                .collect()
        };
        let relative = |&place: &usize| self.error(subject, place) / size(&subject.values, place);
        let errors: Vec<f64> = places.iter().map(relative).collect();
        let (tolerances, per_kelvin) = (of(&self.tolerances), of(&self.per_kelvin));
        let mut all = errors.iter().chain(&tolerances).chain(&per_kelvin);
        if all.all(|own| *own == 0.0) {
            return None;
        }
        let mut uncertainty = ParameterUncertainty::none(places.len());
        uncertainty.add_errors(&errors, |i, j| self.correlation(subject, [places[i], places[j]]));
        uncertainty.add_tolerances(&tolerances);
        uncertainty.add_temperature(&per_kelvin, self.temperatures);
        Some(uncertainty)
    }

    /// The uncertainty as random draws.
    ///
    /// # Errors
    /// Fails if the correlations of the fit contradict each other.
    pub fn chance(&self, subject: &Subject) -> Result<Chance, InputError> {
        let places = self.fitted(subject);
        let fit = match places.is_empty() {
            true => None,
            false => Some((self.posterior(subject, &places)?, places)),
        };
        Ok(Chance {
            fit,
            tolerances: pairs_of(&self.tolerances),
            per_kelvin: pairs_of(&self.per_kelvin),
            temperatures: self.temperatures,
        })
    }

    fn posterior(&self, subject: &Subject, places: &[usize]) -> Result<Posterior, InputError> {
        let estimate = |&place: &usize| {
            let value = subject.values.as_slice()[place];
            Estimate {
                name: subject.model.about().parameters[place].name.to_string(),
                value,
                stderr: self.error(subject, place),
                range: range(value),
            }
        };
        let pairs = (0..places.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let correlations: Vec<_> = pairs
            .map(|(a, b)| (a, b, self.correlation(subject, [places[a], places[b]])))
            .collect();
        let posterior = Posterior::new(places.iter().map(estimate).collect(), &correlations);
        posterior.map_err(|error| {
            let expected = "correlations that a distribution has";
            flag(&subject.name, error, expected, "repeat the fit with `qcar fit --out`").into()
        })
    }
}

fn pairs_of(known: &BTreeMap<usize, f64>) -> Vec<(usize, f64)> {
    known.iter().map(|(place, part)| (*place, *part)).collect()
}

/// Keeps positive values positive.
fn range(value: f64) -> (f64, f64) {
    match value {
        value if value > 0.0 => (LEAST * value, f64::INFINITY),
        value if value < 0.0 => (f64::NEG_INFINITY, LEAST * value),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    use super::Temperatures;

    #[test]
    fn temperatures_are_two_numbers_in_order() {
        assert_eq!("-30..50".parse(), Ok(Temperatures([-30.0, 50.0])));
        for wrong in ["50..-30", "40", "a..b", "0..inf", ""] {
            assert!(wrong.parse::<Temperatures>().is_err(), "{wrong}");
        }
    }
}
