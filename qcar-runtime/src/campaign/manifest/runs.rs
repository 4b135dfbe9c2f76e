//! The `[[run]]` sections with the keys of each kind of test.

use std::path::Path;

use super::super::contents::{Axis, ChannelMapping, Dynamometer, Recording, Road, Role, Run, Spacing, Sweep, Test};
use super::super::fields::Section;
use super::super::mapping;
use super::super::recorded::{self, Files};
use super::sensors::Sensor;
use super::{CURVE, DYNAMIC_CURVE, FORCES};
use crate::shown::shown;
use crate::spelling;

/// Context for reading the runs.
pub(super) struct RunContext<'a> {
    pub folder: &'a Path,
    pub files: &'a Files,
    /// `None` if they have problems.
    pub roads: Option<&'a [Road]>,
    pub sensors: Option<&'a [Sensor]>,
}

/// Reads a run. Its keys depend on its kind, so no key is refused if the kind is unknown.
pub(super) fn run(section: &Section<'_>, known: &RunContext<'_>) -> Option<Run> {
    let (file, role) = (section.text("file"), section.choice("role", Role::NAMES));
    let (name, without) = (section.optional_text("name"), without(section, known));
    let window = mapping::window(section);
    let (read, columns) = section.choice("kind", KINDS)?;
    let (columns, mapped) = mapping::columns(section, columns)?;
    let mapped = mapped
        || known
            .sensors
            .is_some_and(|sensors| columns.is_empty() && sensors.iter().any(|own| own.mapped));
    let (file, window) = (file?, window?);
    let plain = is_table(&file) && !mapped && window.is_whole() && without.is_empty();
    let test = read(section, known, (!plain).then_some(&file));
    section.finish();
    Some(Run {
        name: name.unwrap_or_else(|| file.clone()),
        file,
        plain,
        window,
        without,
        columns,
        role: role?,
        test: test?,
    })
}

/// Sensors that are not read from a run.
fn without(section: &Section<'_>, known: &RunContext<'_>) -> Vec<String> {
    let without = section.texts("without");
    let names: Vec<&str> = known
        .sensors
        .unwrap_or_default()
        .iter()
        .map(|own| own.channel.name.as_str())
        .collect();
    let unknown = without
        .iter()
        .find(|name| known.sensors.is_some() && !names.contains(&name.as_str()));
    if let Some(unknown) = unknown {
        let remedy = spelling::remedy(unknown, names);
        section.wrong(
            "without",
            format!("\"{unknown}\""),
            "names of channels of the campaign",
            remedy,
        );
    }
    without
}

/// True if a file may be a plain table.
pub(super) fn is_table(file: &str) -> bool {
    file.ends_with(".csv") || file.ends_with(".csv.gz")
}

/// Sample rate of a run, Hz. For a measured `file` it is the highest of its channels unless it is given.
fn sample_rate(section: &Section<'_>, known: &RunContext<'_>, file: Option<&String>) -> Option<f64> {
    let Some(file) = file.filter(|_| !section.has("sample_rate")) else {
        return section.positive("sample_rate", "Hz");
    };
    let mappings: Vec<&ChannelMapping> = known.sensors?.iter().map(|sensor| &sensor.mapping).collect();
    let highest = recorded::highest_rate(known.files, &known.folder.join(file), &mappings);
    highest.map_err(|error| section.adopt(error)).ok()
}

/// Reads a test; its file is given if it is no plain table.
type ReadTest = fn(&Section<'_>, &RunContext<'_>, Option<&String>) -> Option<Test>;

/// The kinds with the columns that a curve of the kind has.
const KINDS: &[(&str, (ReadTest, &[&str]))] = &[
    ("sweep", (sweep, &[])),
    ("bounce", (|_, _, _| Some(Test::Bounce), CURVE)),
    (
        "dynamic_bounce",
        (|section, _, _| dynamic_bounce(section), DYNAMIC_CURVE),
    ),
    ("longitudinal", (|_, _, _| Some(Test::Longitudinal), CURVE)),
    ("cleat", (cleat, &[])),
    ("time_history", (time_history, &[])),
    ("dynamometer", (|section, _, _| dynamometer(section), FORCES)),
];

fn sweep(section: &Section<'_>, known: &RunContext<'_>, file: Option<&String>) -> Option<Test> {
    let (peak_velocity, spacing) = (
        section.positive("peak_velocity", "m/s"),
        section.choice("spacing", Spacing::NAMES),
    );
    let (start, end) = (
        section.positive("start_frequency", "Hz"),
        section.positive("end_frequency", "Hz"),
    );
    let sample_rate = sample_rate(section, known, file);
    let (start_frequency, end_frequency, sample_rate) = (start?, end?, sample_rate?);
    if start_frequency >= end_frequency {
        let expected = format!("above the start, {}", section.written("start_frequency"));
        section.wrong(
            "end_frequency",
            section.written("end_frequency"),
            expected,
            "correct the two frequencies",
        );
    }
    if end_frequency >= sample_rate / 2.0 {
        let expected = format!("below half the sample rate, {}", shown(sample_rate / 2.0, "Hz"));
        section.wrong(
            "end_frequency",
            section.written("end_frequency"),
            expected,
            "correct the frequency or the rate",
        );
    }
    let (peak_velocity, spacing) = (peak_velocity?, spacing?);
    Some(Test::Sweep(Sweep {
        peak_velocity,
        start_frequency,
        end_frequency,
        spacing,
        sample_rate,
    }))
}

fn dynamic_bounce(section: &Section<'_>) -> Option<Test> {
    let (peak_velocity, amplitude) = (
        section.positive("peak_velocity", "m/s"),
        section.positive("amplitude", "m"),
    );
    Some(Test::DynamicBounce {
        peak_velocity: peak_velocity?,
        amplitude: amplitude?,
    })
}

fn dynamometer(section: &Section<'_>) -> Option<Test> {
    let (link, amplitude) = (section.text("link"), section.positive("amplitude", "m"));
    let axis = match section.has("axis") {
        true => section.axis(),
        false => Some(Axis::Z),
    };
    let uncertainty = section.has("uncertainty").then(|| section.positive("uncertainty", "N"));
    Some(Test::Dynamometer(Dynamometer {
        link: link?,
        axis: axis?,
        amplitude: amplitude?,
        uncertainty: match uncertainty {
            Some(stated) => Some(stated?),
            None => None,
        },
    }))
}

fn cleat(section: &Section<'_>, known: &RunContext<'_>, file: Option<&String>) -> Option<Test> {
    let (speed, sample_rate) = (section.positive("speed", "m/s"), sample_rate(section, known, file));
    let cleat = section.text("cleat")?;
    if let Some(roads) = known.roads
        && !roads.iter().any(|road| road.name == cleat)
    {
        let names: Vec<_> = roads.iter().map(|road| format!("\"{}\"", road.name)).collect();
        let expected = match names.as_slice() {
            [] => "the name of a [[road]], of which there is none".to_string(),
            names => format!("the name of a [[road]]: {}", names.join(", ")),
        };
        let remedy = match spelling::nearest(&cleat, roads.iter().map(|road| road.name.as_str())) {
            Some(nearest) => format!("did you mean \"{nearest}\"? Otherwise add the road"),
            None => "correct the name, or add the road".into(),
        };
        section.wrong("cleat", format!("\"{cleat}\""), expected, remedy);
    }
    Some(Test::Cleat {
        speed: speed?,
        sample_rate: sample_rate?,
        cleat,
    })
}

fn time_history(section: &Section<'_>, known: &RunContext<'_>, file: Option<&String>) -> Option<Test> {
    let (sample_rate, band_limited) = (sample_rate(section, known, file), section.boolean("band_limited"));
    let (band, periodic) = (section.range("band"), section.flag("periodic"));
    let (sample_rate, band_limited) = (sample_rate?, band_limited?);
    if let Some((low, high)) = band
        && (low < 0.0 || high >= sample_rate / 2.0)
    {
        section.wrong(
            "band",
            section.written("band"),
            format!(
                "a band from 0 Hz to below half the sample rate, {}",
                shown(sample_rate / 2.0, "Hz")
            ),
            "correct the band, or leave it out to compare all frequencies",
        );
    }
    Some(Test::TimeHistory(Recording {
        sample_rate,
        band_limited,
        band,
        periodic,
    }))
}
