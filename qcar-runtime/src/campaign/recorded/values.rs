//! The values of a channel in SI.

use std::path::Path;

use qcar_signals::si::{Si, in_si};
use qcar_signals::signal::{Signal, TimeBase};

use super::super::contents::Tap;
use super::super::tap::of_quantity;
use super::super::unit::examples;
use super::even::time;
use crate::error::{InputError, Place, Problem};

/// The samples that a tap makes of a channel, in SI; what is missing stays not a number.
pub(super) fn values(file: &Path, signal: &Signal, base: &TimeBase, tap: &Tap) -> Result<Vec<f64>, InputError> {
    let si = unit(file, signal, tap)?;
    let scale = tap.scale.unwrap_or(1.0);
    let value = |sample: &f64| tap.sign * ((sample * scale + tap.offset) * si.multiply / si.divide);
    let mut values: Vec<f64> = signal.samples.iter().map(value).collect();
    if let Some(span) = tap.zero {
        let zero = mean_of_start(file, signal, base, &values, span)?;
        values.iter_mut().for_each(|value| *value -= zero);
    }
    Ok(values)
}

/// The unit of the scaled values: the declared one, else the file's. Where both are known and differ, somebody is wrong, unless
/// a scale says that the values of the file are not to be taken as they are.
fn unit(file: &Path, signal: &Signal, tap: &Tap) -> Result<Si, InputError> {
    let stated = in_si(&signal.unit).filter(|unit| of_quantity(Some(*unit), tap.si));
    let refuse = |found: String, expected: String, remedy: String| {
        let place = Place::Channel(signal.name.clone(), None);
        Err(Problem::new(file, place, found, expected, remedy).into())
    };
    let Some(declared) = &tap.unit else {
        let found = match signal.unit.as_str() {
            "" => "no unit".to_string(),
            unit => format!("values in \"{unit}\""),
        };
        let remedy = format!(
            "declare the `unit` of the channel `{}` in campaign.toml, with a `scale` where the file holds something else",
            tap.name
        );
        return stated.map_or_else(|| refuse(found, examples(tap.si), remedy), Ok);
    };
    let own = in_si(declared).expect("campaign.toml was checked for its units");
    match stated {
        Some(stated) if tap.scale.is_none() && !same_size(stated, own) => refuse(
            format!("values in \"{}\"", signal.unit),
            format!("values in \"{declared}\" as `unit` of `{}` says", tap.name),
            "correct `unit`, or give the channel a `source` and no `unit` to take that of the file; where the file is wrong, \
             add `scale = 1` to say so"
                .into(),
        ),
        _ => Ok(own),
    }
}

fn same_size(a: Si, b: Si) -> bool {
    (a.multiply * b.divide / (a.divide * b.multiply) - 1.0).abs() < 1e-9
}

fn mean_of_start(file: &Path, signal: &Signal, base: &TimeBase, values: &[f64], span: f64) -> Result<f64, InputError> {
    let inside = |k: &usize| time(base, *k) < time(base, 0) + span;
    let count = (0..values.len()).take_while(inside).count();
    let valid: Vec<f64> = values[..count]
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    if count == values.len() || valid.is_empty() {
        let found = format!("{} values in the first {span} s", valid.len());
        let (expected, remedy) = (
            "a recording that goes on longer than its zero",
            "shorten `zero_span`, or leave `zero` out",
        );
        let place = Place::Channel(signal.name.clone(), None);
        return Err(Problem::new(file, place, found, expected, remedy).into());
    }
    Ok(valid.iter().sum::<f64>() / valid.len() as f64)
}
