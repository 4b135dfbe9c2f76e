//! `--vary`: the varied parameters and their bounds.

use std::collections::BTreeSet;
use std::str::FromStr;

use qcar_runtime::campaign::{Declared, examples};
use qcar_runtime::ensemble::Axis;
use qcar_runtime::error::{InputError, Problem};
use qcar_runtime::model::{About, Parameter};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::spelling;

use crate::failure;
use crate::parameters::quoted;

/// `name=low..high`; the bounds may have a unit or be in percent of the value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Vary {
    name: String,
    ends: [f64; 2],
    unit: Unit,
}

/// Unit of the bounds.
#[derive(Clone, Debug, PartialEq)]
enum Unit {
    /// The unit of the parameter, SI.
    Own,
    /// Another unit of its kind.
    Declared(Declared),
    /// Percent of the value.
    Percent,
}

const EXPECTED: &str = "expected name=low..high, such as k_tire=180..220 N/mm or k_tire=-10%..10%";

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{EXPECTED}, found `{text}`");
        let (name, range) = text.split_once('=').ok_or_else(wrong)?;
        let (low, high) = range.split_once("..").ok_or_else(wrong)?;
        let (ends, unit) = ends(low.trim(), high.trim()).ok_or_else(wrong)?;
        Ok(Vary {
            name: name.trim().into(),
            ends,
            unit,
        })
    }
}

/// Both bounds in one unit: a lower bound without a unit has that of the upper one.
fn ends(low: &str, high: &str) -> Option<([f64; 2], Unit)> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    if let Some(high) = high.strip_suffix('%') {
        let low = low.strip_suffix('%').unwrap_or(low);
        return Some(([number(low)?, number(high)?], Unit::Percent));
    }
    if let Some(high) = number(high) {
        return Some(([number(low)?, high], Unit::Own));
    }
    let (high, unit) = Declared::quantity(high)?;
    let low = match number(low) {
        Some(low) => unit.si(low),
        None => {
            Declared::quantity(low)
                .filter(|(_, own)| own.is_like(&unit.coherent))?
                .0
        }
    };
    Some(([low, high], Unit::Declared(unit)))
}

/// The axes of a design for a model with these values of the other parameters.
///
/// # Errors
/// Fails with all errors at once: names that the model lacks or that appear twice, tied parameters, units of another
/// kind, and bounds that are no range or lie outside that of the model.
pub(super) fn axes(about: &About, values: &Values, wanted: &[Vary]) -> Result<Vec<Axis>, InputError> {
    let mut seen = BTreeSet::new();
    let (mut axes, mut problems) = (Vec::new(), Vec::new());
    for own in wanted {
        match axis(about, values, own) {
            Err(problem) => problems.push(*problem),
            Ok(axis) if seen.insert(axis.parameter) => axes.push(axis),
            Ok(_) => problems.push(wrong(own, "the same name twice", "each once", "leave one of them out")),
        }
    }
    InputError::unless_empty(problems, Some(axes))
}

/// Vehicle data that determine the tyre and its load.
const OF_TYRE: [&str; 3] = ["r_tire", "static_tire_def", "static_tire_load"];

/// Refuses to vary the data of the tyre, which all sets share.
///
/// # Errors
/// Fails if such a datum varies.
pub(super) fn refuse_facts(wanted: &[Vary]) -> Result<(), InputError> {
    match wanted.iter().find(|own| OF_TYRE.contains(&own.name.as_str())) {
        None => Ok(()),
        Some(own) => {
            let remedy = "vary it without --rides, or explore once for each of its values";
            let expected = "a parameter of the model that is not vehicle data";
            Err(wrong(own, "vehicle data with --rides", expected, remedy).into())
        }
    }
}

fn axis(about: &About, values: &Values, own: &Vary) -> Result<Axis, Box<Problem>> {
    let place = about
        .parameters
        .iter()
        .position(|parameter| *parameter.name == own.name);
    let Some(place) = place else {
        let names = about.parameters.iter().map(|parameter| &*parameter.name);
        let expected = format!("a parameter of model `{}`", about.name);
        return Err(wrong(own, "an unknown name", &expected, &spelling::remedy(&own.name, names)).into());
    };
    let parameter = &about.parameters[place];
    let leader = &about.parameters[values.leader(place)].name;
    if *leader != parameter.name {
        let (found, remedy) = (
            format!("a parameter that takes its value from `{leader}`"),
            format!("vary `{leader}`, or set its value with --set {}=…", own.name),
        );
        return Err(wrong(own, &found, "a parameter that is not tied to another", &remedy).into());
    }
    if let Unit::Declared(unit) = &own.unit
        && !unit.is_like(&parameter.unit)
    {
        let found = format!("values in \"{}\"", unit.written);
        let remedy = "correct the unit, or leave it out for values in SI";
        return Err(wrong(own, &found, &examples(&parameter.unit), remedy).into());
    }
    let range = own.range(values.as_slice()[place]);
    check(own, parameter, range)?;
    Ok(Axis {
        parameter: place,
        range,
    })
}

fn check(own: &Vary, parameter: &Parameter, (low, high): (f64, f64)) -> Result<(), Box<Problem>> {
    let written = match &own.unit {
        Unit::Declared(unit) => Some(unit),
        Unit::Own | Unit::Percent => None,
    };
    let shown = |ends: [f64; 2]| quoted(&ends, &parameter.unit, written);
    let found = shown([low, high]);
    if low >= high {
        let expected = "a lower end below the upper one";
        return Err(wrong(own, &found, expected, "write the lower end first").into());
    }
    match parameter.range {
        Some((least, most)) if low < least || high > most => {
            let expected = format!("values from {}, for which the model is declared", shown([least, most]));
            Err(wrong(
                own,
                &found,
                &expected,
                "vary within them, or change `range` in the model",
            )
            .into())
        }
        _ => Ok(()),
    }
}

impl Vary {
    /// The bound in SI. Percents apply to the absolute value.
    fn range(&self, value: f64) -> (f64, f64) {
        let [low, high] = match self.unit {
            Unit::Percent => self.ends.map(|end| value * (100.0 + end) / 100.0),
            Unit::Own | Unit::Declared(_) => self.ends,
        };
        match value < 0.0 && self.unit == Unit::Percent {
            true => (high, low),
            false => (low, high),
        }
    }
}

fn wrong(own: &Vary, found: &str, expected: &str, remedy: &str) -> Problem {
    failure::flag(&format!("--vary {}", own.name), found, expected, remedy)
}

#[cfg(test)]
mod tests {
    use super::{Unit, Vary};

    #[test]
    fn both_ends_are_in_one_unit() {
        let range = |text: &str| text.parse::<Vary>().unwrap().range(200.0);
        assert_eq!(range("k=1e5..2.5e5"), (1e5, 2.5e5));
        assert_eq!(range("k=180..220 N/mm"), (180e3, 220e3));
        assert_eq!(range("k = 180 N/m .. 0.22 N/mm"), (180.0, 220.0));
        assert_eq!(range("k=-10%..20%"), (180.0, 240.0));
        assert_eq!(range("k=-3..-1"), (-3.0, -1.0));
        assert_eq!("k=-10%..20%".parse::<Vary>().unwrap().unit, Unit::Percent);
        assert_eq!("k=-10%..10%".parse::<Vary>().unwrap().range(-100.0), (-110.0, -90.0));
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "k",
            "k=1",
            "k=1..",
            "k=..2",
            "k=1..2 V",
            "k=1 m..2 kg",
            "k=1..inf",
            "k=1%..2",
        ] {
            assert!(text.parse::<Vary>().is_err(), "{text}");
        }
    }
}
