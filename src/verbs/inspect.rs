//! `qcar inspect`: the channels of a measured file.

use std::path::{Path, PathBuf};

use clap::Args;
use qcar_runtime::bounded;
use qcar_signals::error::ReadError;
use qcar_signals::find::Wanted;
use qcar_signals::read::channels;
use qcar_signals::samples::Samples;
use qcar_signals::signal::{Recording, Scalar, Signal, Value};
use serde::Serialize;

use crate::failure::Failure;
use crate::json;
use crate::table::{Table, number, or_dash};
use crate::terminal::prose;
use crate::verbs::Format;

/// Columns of a sparkline.
const SPARKS: usize = 16;
/// Significant digits of what is printed for people.
const DIGITS: usize = 6;

/// List the channels of a measured file: units, rates, ranges
///
/// The format is recognised from the content: MDF 3 and 4, RPC III, UFF 58, TDMS, MAT 5 to 7.3, .xlsx, OpenCRG, or text.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar inspect models/campaigns/axle_a_rig/rig/sweep_025.csv.gz\n  qcar inspect models/campaigns/axle_a_rig/rig/sweep_025.csv.gz --format json"
)]
pub struct Arguments {
    /// The file
    file: PathBuf,
    /// Output format it
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Does it.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let recording = recording(&arguments.file)?;
    Ok(match arguments.format {
        Format::Text => prose(&text(&recording)),
        Format::Json => json::line(&Inspected::of(&recording)),
    })
}

/// What is in a file.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn recording(file: &Path) -> Result<Recording, Failure> {
    let content = bounded::measured_file(file, "correct the path, or put the file there")?;
    let file = file.into();
    channels(&content, &Wanted::All).map_err(|fault| Failure::Input(ReadError { file, fault }.to_string()))
}

/// What a file holds, as JSON.
#[derive(Serialize)]
struct Inspected<'a> {
    format: &'a str,
    channels: Vec<Channel<'a>>,
    values: Vec<Single<'a>>,
    passed_over: Vec<Passed<'a>>,
}

#[derive(Serialize)]
struct Channel<'a> {
    name: &'a str,
    unit: &'a str,
    group: &'a str,
    place: String,
    samples: usize,
    missing: usize,
    rate: Option<f64>,
    start: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
    mean: Option<f64>,
    rms: Option<f64>,
    labels: Vec<(f64, &'a str)>,
}

#[derive(Serialize)]
struct Single<'a> {
    name: &'a str,
    unit: &'a str,
    place: String,
    number: Option<f64>,
    text: Option<&'a str>,
}

#[derive(Serialize)]
struct Passed<'a> {
    name: &'a str,
    place: String,
    why: &'a str,
}

impl<'a> Inspected<'a> {
    fn of(recording: &'a Recording) -> Self {
        let passed = recording.passed_over.iter().map(|passed| Passed {
            name: &passed.name,
            place: passed.place.to_string(),
            why: &passed.why,
        });
        Inspected {
            format: &recording.format,
            channels: recording.signals.iter().map(Channel::of).collect(),
            values: recording.scalars.iter().map(Single::of).collect(),
            passed_over: passed.collect(),
        }
    }
}

impl<'a> Channel<'a> {
    fn of(signal: &'a Signal) -> Self {
        let valid = || signal.samples.iter().filter(|value| value.is_finite());
        let count = valid().count();
        let mean = |sum: f64| (count > 0).then(|| sum / count as f64);
        Channel {
            name: &signal.name,
            unit: &signal.unit,
            group: &signal.source.group,
            place: signal.source.place.to_string(),
            samples: signal.samples.len(),
            missing: signal.samples.len() - count,
            rate: signal.time.rate(),
            start: signal.time.start(),
            min: valid().reduce(f64::min),
            max: valid().reduce(f64::max),
            mean: mean(valid().sum()),
            rms: mean(valid().map(|value| value * value).sum()).map(f64::sqrt),
            labels: signal
                .labels
                .iter()
                .map(|(value, text)| (*value, text.as_str()))
                .collect(),
        }
    }
}

impl<'a> Single<'a> {
    fn of(scalar: &'a Scalar) -> Self {
        let (number, text) = match &scalar.value {
            Value::Number(number) => (Some(*number), None),
            Value::Text(text) => (None, Some(text.as_str())),
            Value::Empty | Value::Formula(_) => (None, None),
        };
        Single {
            name: &scalar.name,
            unit: &scalar.unit,
            place: scalar.place.to_string(),
            number,
            text,
        }
    }
}

/// What is in a file, for people.
pub(super) fn text(recording: &Recording) -> String {
    let mut text = format!("{}, {} channels\n", recording.format, recording.signals.len());
    if !recording.signals.is_empty() {
        text += &format!("\n{}", table(recording));
    }
    if !recording.scalars.is_empty() {
        text += &format!("\n{}", scalars(recording));
    }
    if !recording.passed_over.is_empty() {
        text += "\npassed over:\n";
    }
    let passed = recording.passed_over.iter();
    text + &passed
        .map(|passed| format!("{} at {}: {}\n", passed.name, passed.place, passed.why))
        .collect::<String>()
}

fn table(recording: &Recording) -> String {
    let headings = [
        "channel", "group", "unit", "samples", "missing", "rate_Hz", "start_s", "min", "max", "rms", "",
    ];
    let mut table = Table::new(headings);
    for signal in &recording.signals {
        let channel = Channel::of(signal);
        table.row(vec![
            channel.name.into(),
            channel.group.into(),
            channel.unit.into(),
            channel.samples.to_string(),
            channel.missing.to_string(),
            or_dash(channel.rate, DIGITS),
            or_dash(channel.start, DIGITS),
            or_dash(channel.min, DIGITS),
            or_dash(channel.max, DIGITS),
            or_dash(channel.rms, DIGITS),
            sparkline(&signal.samples),
        ]);
    }
    table.text()
}

fn scalars(recording: &Recording) -> String {
    let mut table = Table::new(["value", "unit", "is", "place"]);
    for scalar in &recording.scalars {
        let is = match &scalar.value {
            Value::Number(value) => number(*value, DIGITS),
            Value::Text(text) => format!("`{text}` (a text)"),
            Value::Empty => "empty".into(),
            Value::Formula(formula) => format!("={formula} (never computed)"),
        };
        table.row(vec![
            scalar.name.clone(),
            scalar.unit.clone(),
            is,
            scalar.place.to_string(),
        ]);
    }
    table.text()
}

/// The course of a channel in a few characters: the means of as many parts, from the lowest to the highest.
fn sparkline(samples: &Samples) -> String {
    let part = samples.len().div_ceil(SPARKS).max(1);
    let means = (0..samples.len()).step_by(part).map(|from| {
        let valid = samples
            .range(from..samples.len().min(from + part))
            .filter(|value| value.is_finite());
        valid.clone().sum::<f64>() / valid.count() as f64
    });
    let means: Vec<f64> = means.collect();
    let low = means.iter().copied().fold(f64::INFINITY, f64::min);
    let high = means.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let level = |mean: &f64| match mean.is_nan() {
        true => ' ',
        false if high > low => {
            ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'][((mean - low) / (high - low) * 7.0).round() as usize % 8]
        }
        false => '▄',
    };
    means.iter().map(level).collect()
}
