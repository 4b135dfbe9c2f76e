//! `qcar inspect`: the channels of a measured file.

use std::path::PathBuf;

use clap::Args;
use qcar_signals::signal::{Scalar, Signal, Value};
use serde::Serialize;

use crate::failure::Failure;
use crate::json;
use crate::table::{Table, counted, number, or_dash};
use crate::terminal::prose;
use crate::units;
use crate::verbs::Format;

// Summary of a channel.
mod summary;
// A file read channel by channel.
mod contents;

pub(super) use contents::{Contents, Look};
pub(super) use summary::ChannelSummary;

/// Significant digits in the text output.
const DIGITS: usize = 6;

/// List the channels of a measured file: units, rates, ranges
///
/// The format is recognised from the content: MDF 3 and 4, RPC III, UFF 58, TDMS, MAT 4 to 7.3, .xlsx, OpenCRG, or
/// text.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar inspect models/campaigns/axle_a_rig/rig/sweep_025.csv.gz\n  qcar inspect models/campaigns/axle_a_rig/rig/sweep_025.csv.gz --format json"
)]
pub struct Arguments {
    /// The file
    file: PathBuf,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let contents = Contents::summary(&arguments.file)?;
    Ok(match arguments.format {
        Format::Text => prose(&text(&contents)),
        Format::Json => json::line(&Inspected::of(&contents)),
    })
}

/// Contents of a file, as JSON.
#[derive(Serialize)]
struct Inspected<'a> {
    format: &'a str,
    channels: Vec<Channel<'a>>,
    values: Vec<Single<'a>>,
    passed_over: Vec<SkippedPart<'a>>,
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
    mean_rate: Option<f64>,
    start: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
    mean: Option<f64>,
    rms: Option<f64>,
    labels: Vec<(f64, &'a str)>,
    unit_warning: Option<&'a str>,
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
struct SkippedPart<'a> {
    name: &'a str,
    place: String,
    why: &'a str,
}

impl<'a> Inspected<'a> {
    fn of<T>(contents: &'a Contents<T>) -> Self {
        let recording = &contents.recording;
        let passed = recording.passed_over.iter().map(|passed| SkippedPart {
            name: &passed.name,
            place: passed.place.to_string(),
            why: &passed.why,
        });
        Inspected {
            format: &recording.format,
            channels: contents.channels().map(Channel::of).collect(),
            values: recording.scalars.iter().map(Single::of).collect(),
            passed_over: passed.collect(),
        }
    }
}

impl<'a> Channel<'a> {
    fn of((signal, summary): (&'a Signal, &'a ChannelSummary)) -> Self {
        Channel {
            name: &signal.name,
            unit: &signal.unit,
            group: &signal.source.group,
            place: signal.source.place.to_string(),
            samples: summary.samples,
            missing: summary.missing,
            rate: summary.rate,
            mean_rate: summary.mean_rate,
            start: summary.start,
            min: summary.min,
            max: summary.max,
            mean: summary.mean,
            rms: summary.rms,
            labels: signal
                .labels
                .iter()
                .map(|(value, text)| (*value, text.as_str()))
                .collect(),
            unit_warning: summary.unit_warning.as_deref(),
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

/// Contents of a file, as text.
pub(super) fn text<T>(contents: &Contents<T>) -> String {
    let recording = &contents.recording;
    let channels = counted(recording.signals.len(), "channel");
    let mut text = format!("{}, {channels}\n", recording.format);
    if !recording.signals.is_empty() {
        text += &format!("\n{}", table(contents));
    }
    let suspicious = contents
        .channels()
        .filter_map(|(signal, summary)| Some((signal, summary.unit_warning.as_ref()?)));
    let warnings: String = suspicious
        .map(|(signal, unit_warning)| format!("{}: {unit_warning}\n", signal.full_name()))
        .collect();
    if !warnings.is_empty() {
        text += &format!("\nunits of the file that should be checked:\n{warnings}");
    }
    if !recording.scalars.is_empty() {
        text += &format!("\n{}", scalars(&recording.scalars));
    }
    if !recording.passed_over.is_empty() {
        text += "\npassed over:\n";
    }
    let passed = recording.passed_over.iter();
    text + &passed
        .map(|passed| format!("{} at {}: {}\n", passed.name, passed.place, passed.why))
        .collect::<String>()
}

fn table<T>(contents: &Contents<T>) -> String {
    let headings = [
        "channel", "group", "unit", "samples", "missing", "rate_Hz", "start_s", "min", "max", "rms", "",
    ];
    let mut table = Table::new(headings);
    for (signal, summary) in contents.channels() {
        let shown = |value: Option<f64>| or_dash(value.map(|value| units::of_file(value, &signal.unit).0), DIGITS);
        table.row(vec![
            signal.name.clone(),
            signal.source.group.clone(),
            units::of_file(0.0, &signal.unit).1.into(),
            summary.samples.to_string(),
            summary.missing.to_string(),
            rate(summary),
            or_dash(summary.start, DIGITS),
            shown(summary.min),
            shown(summary.max),
            shown(summary.rms),
            summary.sparkline.clone(),
        ]);
    }
    table.text()
}

/// The sample rate, or the mean of an uneven one.
fn rate(summary: &ChannelSummary) -> String {
    match (summary.rate, summary.mean_rate) {
        (None, Some(mean)) => format!("~{}", number(mean, 3)),
        (rate, _) => or_dash(rate, DIGITS),
    }
}

fn scalars(scalars: &[Scalar]) -> String {
    let mut table = Table::new(["value", "unit", "is", "place"]);
    for scalar in scalars {
        let is = match &scalar.value {
            Value::Number(value) => number(units::of_file(*value, &scalar.unit).0, DIGITS),
            Value::Text(text) => format!("`{text}` (a text)"),
            Value::Empty => "empty".into(),
            Value::Formula(formula) => format!("={formula} (never computed)"),
        };
        table.row(vec![
            scalar.name.clone(),
            units::of_file(0.0, &scalar.unit).1.into(),
            is,
            scalar.place.to_string(),
        ]);
    }
    table.text()
}
