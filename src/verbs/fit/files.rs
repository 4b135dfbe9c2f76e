//! A fit as files.

use std::fmt::Write;
use std::path::Path;

use nalgebra::Complex;
use qcar_runtime::error::InputError;
use qcar_runtime::fit::Level;
use qcar_runtime::fit::observation::Observation;
use qcar_runtime::fit::report::ParameterFit;
use qcar_runtime::response::ratio::Ratios;
use qcar_runtime::response::unit::unit;

use super::{Fitted, render};
use crate::figure::{Across, Curve, Figure, Panel, Style};
use crate::files::put;
use crate::units;

/// Writes values, curves and a figure.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(crate) fn write(of: &Fitted, folder: &Path) -> Result<(), InputError> {
    let compared = compare(of);
    put(folder, "fit.json", &render::json(of))?;
    put(
        folder,
        "parameters.toml",
        &parameters(&of.fit.model, &of.campaign.name, &of.fit.parameters),
    )?;
    put(folder, "transmissibility.csv", &csv(&compared))?;
    put(folder, "transmissibility.svg", &figure(of, &compared).svg())
}

/// A parameter file for `--params`.
pub(super) fn parameters(model: &str, campaign: &str, of: &[ParameterFit]) -> String {
    let mut out = format!("# {model} fitted to {campaign}\n\n[parameters]\n");
    for parameter in of.iter().filter(|parameter| parameter.tied_to.is_none()) {
        let error = parameter
            .stderr
            .map_or(String::new(), |error| format!(", standard error {error:.2e}"));
        let _ = writeln!(
            out,
            "{} = {:?} # {}{error}",
            parameter.name, parameter.value, parameter.unit
        );
    }
    out
}

/// A measured ratio with those of the model before and after the fit, line by line.
pub(crate) struct Compared<'a> {
    /// The run.
    pub level: &'a Level,
    /// Measured ratio.
    pub observation: &'a Observation,
    /// SI unit of the ratio.
    pub unit: String,
    /// The model at the start values.
    pub before: Vec<Complex<f64>>,
    /// The fitted model.
    pub after: Vec<Complex<f64>>,
}

/// Every measured ratio with those of the model.
pub(crate) fn compare(of: &Fitted) -> Vec<Compared<'_>> {
    let (before, after) = (of.start(), of.values());
    let [mut first, mut last] = [&before, &after].map(|values| Ratios::new(&*of.model, values));
    let modelled = |ratios: &mut Ratios<'_, _>, level: &Level, observation: &Observation| {
        let signals = [&observation.channel.numerator, &observation.channel.denominator];
        let ratio = ratios.ratio(level.excitation, signals, &observation.frequency);
        ratio.expect("the fit has found both signals").value
    };
    let all = of
        .levels
        .iter()
        .flat_map(|level| level.observations.iter().map(move |observation| (level, observation)));
    all.map(|(level, observation)| Compared {
        level,
        observation,
        unit: unit(of.model.about(), &observation.channel),
        before: modelled(&mut first, level, observation),
        after: modelled(&mut last, level, observation),
    })
    .collect()
}

fn csv(of: &[Compared]) -> String {
    let frequency = units::heading("frequency", "Hz");
    let mut out = format!(
        "run,channel,unit,{frequency},measured_re,measured_im,coherence,before_re,before_im,after_re,after_im\n"
    );
    for Compared {
        level,
        observation,
        unit,
        before,
        after,
    } in of
    {
        let shown = units::name(unit);
        for (line, frequency) in observation.frequency.iter().enumerate() {
            let frequency = units::value(*frequency, "Hz");
            let _ = write!(out, "{},{},{shown},{frequency}", level.name, observation.channel.name);
            let cells = [observation.value[line], before[line], after[line]].map(|value| {
                let [re, im] = [value.re, value.im].map(|part| units::value(part, unit));
                format!("{re},{im}")
            });
            let [measured, before, after] = cells;
            let _ = writeln!(out, ",{measured},{},{before},{after}", observation.coherence[line]);
        }
    }
    out
}

/// Magnitudes of the first run, a panel for each channel.
pub(super) fn figure(of: &Fitted, compared: &[Compared]) -> Figure {
    let first = of.levels.first().map_or("", |level| level.name.as_str());
    let shown = compared.iter().filter(|compared| compared.level.name == first);
    Figure {
        title: format!("{} fitted to {}, {first}", of.fit.model, of.campaign.name),
        across: Across::Frequency,
        panels: shown.map(panel).collect(),
    }
}

fn panel(of: &Compared) -> Panel {
    let curve = |label, style, values: &[Complex<f64>]| {
        let points = of
            .observation
            .frequency
            .iter()
            .zip(values)
            .map(|(f, value)| (*f, 20.0 * units::value(value.norm(), &of.unit).log10()));
        Curve {
            label,
            style,
            points: points.collect(),
        }
    };
    Panel {
        title: of.observation.channel.name.to_string(),
        vertical: units::decibels(&of.unit),
        curves: vec![
            curve("measured", Style::Measured, &of.observation.value),
            curve("before", Style::Before, &of.before),
            curve("after", Style::After, &of.after),
        ],
    }
}
