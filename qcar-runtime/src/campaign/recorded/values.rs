//! The values of a channel in SI.

use std::path::Path;

use qcar_signals::si::{Si, in_si};
use qcar_signals::signal::{Signal, TimeBase};

use super::super::contents::ChannelMapping;
use super::super::mapping::of_quantity;
use super::super::unit::examples;
use super::even::time;
use crate::error::{InputError, Place, Problem};

/// Conversion of the samples of a channel to SI; missing values stay NaN.
#[derive(Clone, Copy)]
pub(super) struct Scaling {
    scale: f64,
    offset: f64,
    sign: f64,
    si: Si,
    /// Offset subtracted last, SI.
    zero: f64,
}

impl Scaling {
    /// The conversion of a mapping; what the mapping does not give comes from the file.
    pub fn of(file: &Path, signal: &Signal, base: &TimeBase, mapping: &ChannelMapping) -> Result<Self, InputError> {
        let mut scaling = Scaling {
            scale: mapping.scale.unwrap_or(1.0),
            offset: mapping.offset,
            sign: mapping.sign,
            si: unit(file, signal, mapping)?,
            zero: 0.0,
        };
        if let Some(span) = mapping.zero {
            scaling.zero = scaling.mean_of_start(file, signal, base, span)?;
        }
        Ok(scaling)
    }

    /// The value of a sample.
    pub fn value(&self, sample: f64) -> f64 {
        let Scaling {
            scale,
            offset,
            sign,
            si,
            zero,
        } = self;
        sign * ((sample * scale + offset) * si.multiply / si.divide) - zero
    }

    fn mean_of_start(&self, file: &Path, signal: &Signal, base: &TimeBase, span: f64) -> Result<f64, InputError> {
        let inside = |k: &usize| time(base, *k) < time(base, 0) + span;
        let count = (0..signal.samples.len()).take_while(inside).count();
        let values = signal.samples.range(0..count).map(|sample| self.value(sample));
        let valid: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        if count == signal.samples.len() || valid.is_empty() {
            let found = format!("{} values in the first {span} s", valid.len());
            let (expected, remedy) = (
                "a recording longer than `zero_span`",
                "reduce `zero_span`, or remove `zero`",
            );
            let place = Place::Channel(signal.name.clone(), None);
            return Err(Problem::new(file, place, found, expected, remedy).into());
        }
        Ok(valid.iter().sum::<f64>() / valid.len() as f64)
    }
}

/// Unit of the scaled values: the declared one, otherwise that of the file. If both are known and differ, one of them
/// is wrong, unless the mapping has a scale.
fn unit(file: &Path, signal: &Signal, mapping: &ChannelMapping) -> Result<Si, InputError> {
    let stated = in_si(&signal.unit).filter(|unit| of_quantity(Some(*unit), mapping.si));
    let refuse = |found: String, expected: String, remedy: String| {
        let place = Place::Channel(signal.name.clone(), None);
        Err(Problem::new(file, place, found, expected, remedy).into())
    };
    let Some(declared) = &mapping.unit else {
        let found = match signal.unit.as_str() {
            "" => "no unit".to_string(),
            unit => format!("values in \"{unit}\""),
        };
        let remedy = format!(
            "declare the `unit` of the channel `{}` in campaign.toml, and a `scale` if the file has another quantity",
            mapping.name
        );
        return stated.map_or_else(|| refuse(found, examples(mapping.si), remedy), Ok);
    };
    let own = in_si(declared).expect("campaign.toml was checked for its units");
    match stated {
        Some(stated) if mapping.scale.is_none() && !same_size(stated, own) => refuse(
            format!("values in \"{}\"", signal.unit),
            format!("values in \"{declared}\" as `unit` of `{}` says", mapping.name),
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
