//! The results of a simulation as text, JSON and CSV.

use std::collections::BTreeMap;
use std::path::Path;

use qcar_runtime::compare::Summary;
use qcar_runtime::error::InputError;
use qcar_runtime::model::About;
use qcar_runtime::simulate::Ride;
use qcar_signals::mdf::write::Channel;
use serde::Serialize;

use super::Cleat;
use super::comparison::{Compared, Difference, Sizes};
use super::figure;
use super::names::FileNames;
use super::records::{Record, RecordError};
use crate::files::put;
use crate::histories::History;
use crate::json;
use crate::table::{Table, noted_below, number};
use crate::units;

/// Unit of peaks and after-shakes.
const ACCELERATION: &str = "m/s^2";

/// Results of all runs.
pub(super) struct Result<'a> {
    /// Name of the campaign.
    pub campaign: &'a str,
    /// Name of the model.
    pub model: &'a str,
    /// Notices on the samples and the campaign.
    pub notices: &'a [String],
    /// Parameters that still have their start values.
    pub at_start: Vec<String>,
    /// Cleat runs; `None` without any.
    pub cleats: Option<&'a Compared>,
    /// Sweeps and time histories.
    pub records: &'a [Record],
}

/// The result as JSON, see `docs/json.md`.
#[derive(Serialize)]
struct Json<'a> {
    campaign: &'a str,
    model: &'a str,
    at_start: &'a [String],
    runs: &'a [Difference],
    summary: Option<&'a BTreeMap<String, Sizes>>,
    records: Vec<&'a RecordError>,
    notices: Vec<&'a String>,
}

impl Result<'_> {
    pub fn json(&self) -> String {
        json::line(&Json {
            campaign: self.campaign,
            model: self.model,
            at_start: &self.at_start,
            runs: self.cleats.map_or(&[], |cleats| &cleats.runs),
            summary: self.cleats.map(|cleats| &cleats.summary),
            records: self.errors().collect(),
            notices: self
                .notices
                .iter()
                .chain(self.cleats.map_or(&[][..], |cleats| &cleats.notices))
                .collect(),
        })
    }

    pub fn text(&self) -> String {
        let cleats = self.cleats.map(text);
        let records = (!self.records.is_empty()).then(|| self.records_text());
        let parts: Vec<String> = cleats.into_iter().chain(records).collect();
        format!("{}{}", parts.join("\n"), notes(self.notices, &self.at_start))
    }

    /// A table of the cleats, one of the records, and an empty line between them.
    pub fn csv(&self) -> String {
        let cleats = self.cleats.map(csv);
        let records = (!self.records.is_empty()).then(|| self.records_csv());
        let parts: Vec<String> = cleats.into_iter().chain(records).collect();
        parts.join("\n")
    }

    fn errors(&self) -> impl Iterator<Item = &RecordError> {
        self.records.iter().flat_map(|record| &record.errors)
    }

    fn records_text(&self) -> String {
        let headings = [
            "run",
            "role",
            "channel",
            "quantity",
            "unit",
            "measured_rms",
            "rms_error",
            "nrms_%",
        ];
        let mut table = Table::new(headings);
        for own in self.errors() {
            let names = [
                own.run.clone(),
                own.role.into(),
                own.channel.clone(),
                own.quantity.into(),
                units::name(own.unit).into(),
            ];
            let [measured, error] = [own.measured_rms, own.rms_error].map(|rms| number(units::value(rms, own.unit), 4));
            let numbers = [measured, error, percent(own.nrms)];
            table.row(names.into_iter().chain(numbers).collect());
        }
        table.text()
    }

    fn records_csv(&self) -> String {
        let row = |own: &RecordError| {
            let unit = units::name(own.unit);
            let names = format!("{},{},{},{},{unit}", own.run, own.role, own.channel, own.quantity);
            let [measured, error] = [own.measured_rms, own.rms_error].map(|rms| units::value(rms, own.unit));
            format!("{names},{measured},{error},{}\n", own.nrms)
        };
        let head = "run,role,channel,quantity,unit,measured_rms,rms_error,nrms\n";
        head.to_string() + &self.errors().map(row).collect::<String>()
    }
}

fn text(of: &Compared) -> String {
    let mut runs = Table::new([
        "run",
        "role",
        "mass",
        "axis",
        "unit",
        "measured_peak",
        "peak_error_%",
        "measured_after_shake",
        "after_shake_error_%",
    ]);
    let shown = |value| units::value(value, ACCELERATION);
    for d in &of.runs {
        let numbers = [
            number(shown(d.measured_peak), 4),
            percent(d.peak_error),
            number(shown(d.measured_after_shake), 3),
            percent(d.after_shake_error),
        ];
        let unit = units::name(ACCELERATION).into();
        let place = [d.run.clone(), d.role.into(), d.mass.clone(), d.axis.clone(), unit];
        runs.row(place.into_iter().chain(numbers).collect());
    }
    let mut sizes = Table::new([
        "mass_axis",
        "peak_median_%",
        "peak_worst_%",
        "after_shake_median_%",
        "after_shake_worst_%",
    ]);
    for (name, size) in &of.summary {
        let cells = [size.peak, size.after_shake].into_iter().flat_map(median_and_worst);
        sizes.row(std::iter::once(name.clone()).chain(cells).collect());
    }
    let notices: String = of
        .notices
        .iter()
        .map(|notice| {
            format!(
                "
note: {notice}
"
            )
        })
        .collect();
    format!(
        "{}
{}{notices}",
        runs.text(),
        sizes.text()
    )
}

/// Notices, and parameters that still have their start values, after an empty line; empty without any.
pub(super) fn notes(notices: &[String], at_start: &[String]) -> String {
    format!("{}{}", noted_below(notices), guess(at_start))
}

fn guess(at_start: &[String]) -> String {
    match at_start {
        [] => String::new(),
        names => format!(
            "\nnote: {} still {}; the simulation is only as good as {}. `qcar fit --out` and `qcar discover --out` estimate what the \
             runs with the role fit determine\n",
            names.join(", "),
            if names.len() == 1 {
                "has the start value of the campaign"
            } else {
                "have the start values of the campaign"
            },
            if names.len() == 1 { "this" } else { "these" },
        ),
    }
}

fn median_and_worst(of: Option<Summary>) -> [String; 2] {
    of.map_or(["-".into(), "-".into()], |s| [percent(s.median), percent(s.worst)])
}

fn percent(part: f64) -> String {
    if part.is_finite() {
        format!("{:.1}", 100.0 * part)
    } else {
        "-".into()
    }
}

/// The errors, a row for each run, mass and axis.
pub(crate) fn csv(of: &Compared) -> String {
    let [measured_peak, simulated_peak, measured_shake, simulated_shake] = [
        "measured_peak",
        "simulated_peak",
        "measured_after_shake",
        "simulated_after_shake",
    ]
    .map(|what| units::heading(what, ACCELERATION));
    let head = format!(
        "run,role,mass,axis,{measured_peak},{simulated_peak},peak_error,{measured_shake},{simulated_shake},after_shake_error\n"
    );
    let shown = |value| units::value(value, ACCELERATION);
    let row = |d: &Difference| {
        let Difference {
            run, role, mass, axis, ..
        } = d;
        let peaks = format!(
            "{},{},{}",
            shown(d.measured_peak),
            shown(d.simulated_peak),
            d.peak_error
        );
        let shakes = format!(
            "{},{},{}",
            shown(d.measured_after_shake),
            shown(d.simulated_after_shake),
            d.after_shake_error
        );
        format!("{run},{role},{mass},{axis},{peaks},{shakes}\n")
    };
    head + &of.runs.iter().map(row).collect::<String>()
}

/// The file of the figure of a run.
pub(super) fn figure_of(name: &str) -> String {
    format!("{name}.svg")
}

/// Writes the figure of a sweep or time history.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(super) fn put_figure(of: &Record, name: &str, folder: &Path) -> std::result::Result<(), InputError> {
    put(folder, &figure_of(name), &figure::record(of).svg())
}

/// Measured and simulated samples as a table of this name.
pub(super) fn beside(record: &Record, name: &str) -> History {
    let samples = record.signals.first().map_or(0, |(_, [measured, _])| measured.len());
    let channels = record
        .signals
        .iter()
        .zip(&record.errors)
        .flat_map(|((_, signals), error)| {
            let channel = |(what, samples): (&str, &Vec<f64>)| Channel {
                name: format!("{}_{}_{what}", error.channel, error.quantity),
                unit: error.unit.into(),
                samples: samples.clone(),
            };
            ["measured", "simulated"].into_iter().zip(signals).map(channel)
        });
    History {
        name: name.into(),
        time: (0..samples)
            .map(|sample| record.start + sample as f64 / record.rate)
            .collect(),
        channels: channels.collect(),
    }
}

/// Writes time, outputs of the model, tyre forces and contact area of each run.
pub(crate) fn histories(about: &About, names: &FileNames, cleats: &[Cleat], rides: &[Ride]) -> Vec<History> {
    let runs = cleats.iter().zip(rides);
    runs.map(|(cleat, ride)| history(about, names.get(&cleat.run.name), ride))
        .collect()
}

pub(super) fn history(about: &About, name: &str, ride: &Ride) -> History {
    let channel = |name: &str, unit: &str, samples: &Vec<f64>| Channel {
        name: name.into(),
        unit: unit.into(),
        samples: samples.clone(),
    };
    let outputs = about.outputs.iter().zip(&ride.outputs);
    let outputs = outputs.map(|(output, samples)| channel(&output.name, &output.unit, samples));
    let tyre = [
        channel("tire_force_z", "N", &ride.force[0]),
        channel("tire_force_x", "N", &ride.force[1]),
        channel("contact_area", "m^2", &ride.area),
    ];
    History {
        name: name.into(),
        time: ride.time.clone(),
        channels: outputs.chain(tyre).collect(),
    }
}
