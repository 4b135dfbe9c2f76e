//! The kind of run of a file.

use std::ops::Range;

use qcar_runtime::campaign::Quantity;
use qcar_runtime::model::About;
use qcar_signals::si::in_si;
use qcar_signals::signal::Signal;

use super::Measured;
use super::guess::{Guess, quantity_of};
use super::sensors::Sensors;
use super::sweep::{SweepParameters, parts, swept};
use crate::table::number;
use crate::units;
use crate::verbs::inspect::{ChannelSummary, Contents};
use crate::verbs::new::records;

/// Significant digits of proposed values.
const DIGITS: usize = 6;
/// A record without a pad is that of an impact if its largest value is at least this multiple of its RMS.
const IMPACT: f64 = 5.0;

/// A run and its recognised kind.
pub(super) struct Proposed {
    file: String,
    kind: Kind,
    /// Highest sample rate of its sensors, Hz.
    rate: Option<f64>,
    /// True if the file states times, evenly spaced or not.
    timed: bool,
    /// The part of a recording with several runs.
    part: Option<Part>,
}

/// A part of a recording that is a run of its own.
struct Part {
    name: String,
    /// Start and end, s, on the clock of the recording.
    from: f64,
    to: f64,
}

enum Kind {
    Sweep(SweepParameters),
    Cleat,
    /// A K&C cycle: names of the displacement and of the force.
    Curve(String, String),
    TimeHistory,
    /// A part between sweeps with another motion of the pad; it is no run.
    Other,
}

impl Part {
    fn description(&self) -> String {
        format!("from {} to {} s", self.from, self.to)
    }
}

impl Proposed {
    /// Channels of a K&C curve, which need no sensor.
    pub fn channels_of_curve(&self) -> impl Iterator<Item = &str> {
        let names = match &self.kind {
            Kind::Curve(displacement, force) => vec![displacement.as_str(), force],
            Kind::Sweep(_) | Kind::Cleat | Kind::TimeHistory | Kind::Other => Vec::new(),
        };
        names.into_iter()
    }

    /// The kind as text.
    pub fn description(&self) -> String {
        let when = self
            .part
            .as_ref()
            .map_or_else(String::new, |part| format!(", {}", part.description()));
        match &self.kind {
            Kind::Sweep(own) => format!(
                "a {} sweep from {} to {} Hz at {}{when}",
                if own.logarithmic { "logarithmic" } else { "linear" },
                number(own.start, DIGITS),
                number(own.end, DIGITS),
                units::with_unit(&number(units::value(own.peak_velocity, "m/s"), DIGITS), "m/s"),
            ),
            Kind::Other => format!("no run{when}: the pad moves but does not sweep"),
            Kind::Cleat => "a run over a cleat: no pad, and one impact".into(),
            Kind::Curve(displacement, force) => format!("a K&C curve, `{force}` over `{displacement}`"),
            Kind::TimeHistory => "a time history".into(),
        }
    }
}

/// Motion of a pad.
pub(super) struct PadMotion {
    /// The sweep, if the whole record is one.
    whole: Option<SweepParameters>,
    /// The parts in which the pad moves, with the sweep of a part that is one, and its start and end, s.
    parts: Vec<(Option<SweepParameters>, (f64, f64))>,
}

impl PadMotion {
    /// True if the channel is assumed to be that of a pad.
    pub fn is_in(signal: &Signal, about: &About) -> bool {
        Guess::of(signal, about).is_ok_and(|guess| guess.drives)
    }

    /// The motion of a channel that is assumed to be that of a pad and has times.
    pub fn of(signal: &Signal, about: &About) -> Option<Self> {
        let guess = Guess::of(signal, about).ok().filter(|guess| guess.drives)?;
        // Rounded or late stamps show a sweep as well as even ones.
        let (rate, start) = (signal.time.mean_rate()?, signal.time.start()?);
        let samples = in_units(signal);
        let swept = |part: Range<usize>| swept(&samples[part], rate, guess.quantity);
        let end = start + samples.len().saturating_sub(1) as f64 / rate;
        let tenth = |sample: usize, round: fn(f64) -> f64| round(10.0 * (start + sample as f64 / rate)) / 10.0;
        let lasts = |part: &Range<usize>| {
            (
                tenth(part.start, f64::floor).max(start),
                tenth(part.end, f64::ceil).min(end),
            )
        };
        let parts = parts(&samples, rate, guess.quantity).into_iter();
        Some(PadMotion {
            whole: swept(0..samples.len()),
            parts: parts.map(|part| (swept(part.clone()), lasts(&part))).collect(),
        })
    }
}

/// The runs of a file: one for each of several sweeps, otherwise one for the whole record. Only a model on a single road
/// is swept or rolls over a cleat.
pub(super) fn propose(file: &Measured, sensors: &Sensors, about: &About) -> Vec<Proposed> {
    let contents = &file.contents;
    let of = |drives: bool| {
        let known = sensors.known.iter().filter(move |sensor| sensor.guess.drives == drives);
        known.filter_map(|sensor| contents.found(contents.recording.find(&sensor.source).ok()?))
    };
    let mut summaries: Vec<&ChannelSummary> = of(true).chain(of(false)).map(|(summary, _)| summary).collect();
    if summaries.is_empty() {
        summaries = contents.channels().map(|(_, summary)| summary).collect();
    }
    let rate = summaries
        .iter()
        .filter_map(|summary| summary.rate)
        .reduce(f64::max)
        .map(whole);
    let timed = summaries.iter().any(|summary| summary.mean_rate.is_some());
    let proposed = |kind: Kind, part: Option<Part>| Proposed {
        file: file.seen.clone(),
        kind,
        rate,
        timed,
        part,
    };
    if records::suit(about) {
        return vec![proposed(curve(contents).unwrap_or(Kind::TimeHistory), None)];
    }
    let pad = of(true).next();
    let driven = pad.and_then(|(_, driven)| driven.as_ref());
    let parts = driven.map_or(&[][..], |driven| &driven.parts);
    if parts.iter().filter(|(swept, _)| swept.is_some()).count() > 1 {
        let one = |(at, (swept, (from, to))): (usize, &(Option<SweepParameters>, (f64, f64)))| {
            let name = format!("{} part {}", file.seen, at + 1);
            let (from, to) = (*from, *to);
            proposed(swept.map_or(Kind::Other, Kind::Sweep), Some(Part { name, from, to }))
        };
        return parts.iter().enumerate().map(one).collect();
    }
    let kind = match pad {
        Some(_) => driven
            .and_then(|driven| driven.whole)
            .map_or(Kind::TimeHistory, Kind::Sweep),
        None if of(false).any(|(summary, _)| is_impact(summary)) => Kind::Cleat,
        None => curve(contents).unwrap_or(Kind::TimeHistory),
    };
    vec![proposed(kind, None)]
}

/// A file without times, with one displacement and one force.
fn curve<T>(contents: &Contents<T>) -> Option<Kind> {
    let timeless = contents.channels().all(|(_, summary)| summary.start.is_none());
    let only = |quantity: Quantity| {
        let signals = contents.recording.signals.iter();
        let mut of = signals.filter(|signal| quantity_of(&signal.unit) == Some(quantity));
        of.next()
            .filter(|_| of.next().is_none())
            .map(|signal| signal.name.clone())
    };
    timeless.then_some(())?;
    Some(Kind::Curve(only(Quantity::Displacement)?, only(Quantity::Force)?))
}

/// A rate from printed times differs a little from its whole number.
fn whole(rate: f64) -> f64 {
    if (rate / rate.round() - 1.0).abs() < 1e-6 {
        rate.round()
    } else {
        rate
    }
}

/// The samples in SI, if the file states their unit, about their mean.
fn in_units(signal: &Signal) -> Vec<f64> {
    let factor = in_si(&signal.unit).map_or(1.0, |si| si.multiply / si.divide);
    let valid = signal.samples.iter().filter(|value| value.is_finite());
    let mean = valid.clone().sum::<f64>() / valid.count().max(1) as f64;
    let value = |value: f64| {
        if value.is_finite() {
            (value - mean) * factor
        } else {
            0.0
        }
    };
    signal.samples.iter().map(value).collect()
}

fn is_impact(summary: &ChannelSummary) -> bool {
    let values = summary.peak().zip(summary.rms);
    values.is_some_and(|(peak, rms)| peak > IMPACT * rms)
}

/// The `[[run]]` sections. The last sweep is held out.
pub(super) fn sections(runs: &[&Proposed]) -> String {
    let is_record = |run: &&&Proposed| matches!(run.kind, Kind::Sweep(_) | Kind::TimeHistory);
    let sweeps = runs.iter().filter(is_record).count();
    let last = runs.iter().rposition(|run| is_record(&run));
    let mut text = "\n# The runs. A part of a recording can be a separate run: give it a `name`, and `from` and `to` in s, or a `trigger`.\n".to_string();
    for (at, run) in runs.iter().enumerate() {
        if let (Kind::Other, Some(part)) = (&run.kind, &run.part) {
            text += &format!(
                "\n# {:?} {}: the pad moves but does not sweep.\n",
                run.file,
                part.description()
            );
            continue;
        }
        let judges = matches!(run.kind, Kind::Cleat) || (sweeps > 1 && last == Some(at));
        let role = match judges {
            true => "\"held_out\" # the fit is checked with it",
            false => "\"fit\" # parameters are fitted to it",
        };
        text += &format!("\n[[run]]\nfile = {:?}\nrole = {role}\n{}", run.file, keys(&run.kind));
        text += &run.part.as_ref().map_or_else(String::new, |part| {
            format!(
                "name = {:?}\nfrom = {:?} # s\nto = {:?}\n",
                part.name, part.from, part.to
            )
        });
        text += &match run.rate {
            _ if matches!(run.kind, Kind::Curve(..)) => String::new(),
            Some(rate) => format!("sample_rate = {rate:?} # Hz, to which all channels are brought\n"),
            None if run.timed => "# sample_rate is not given: it follows from the times of the file\n".into(),
            None => "# sample_rate = # Hz; not stated in the file, give yours\n".into(),
        };
    }
    if runs.iter().any(|run| matches!(run.kind, Kind::Cleat)) {
        text += "\n# The profile of the cleat, with the header line x,z,slope.\n# [[road]]\n# name = \"cleat_20\"\n# file = \"road/cleat_20.csv\"\n";
    }
    text
}

fn keys(kind: &Kind) -> String {
    match kind {
        Kind::Sweep(own) => format!(
            "kind = \"sweep\" # frequencies and velocity as the pad moves, rounded: check them\npeak_velocity = {} # m/s\n\
             start_frequency = {} # Hz\nend_frequency = {} # Hz\nspacing = \"{}\"\n",
            number(own.peak_velocity, DIGITS),
            number(own.start, DIGITS),
            number(own.end, DIGITS),
            if own.logarithmic { "logarithmic" } else { "linear" },
        ),
        Kind::Cleat => {
            "kind = \"cleat\"\n# speed = # m/s, give yours\n# cleat = # the name of a [[road]] below, give yours\n"
                .into()
        }
        Kind::Curve(displacement, force) => format!(
            "kind = \"bounce\" # or \"longitudinal\"\n# Compression is positive, and forces count from the design position: give `sign` and \
             `offset` where that is not so.\ndisplacement = {{ source = {displacement:?} }}\nforce = {{ source = {force:?} }}\n"
        ),
        Kind::TimeHistory => {
            "kind = \"time_history\"\nband_limited = true # false where the inputs are held between samples\n".into()
        }
        Kind::Other => String::new(),
    }
}
