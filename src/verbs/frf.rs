//! `qcar frf`: the frequency response of every channel and its parameter Jacobian.

use std::collections::BTreeMap;
use std::str::FromStr;

use clap::Args;
use nalgebra::Complex;
use qcar_dsl::response::Wanted;
use qcar_runtime::error::InputError;
use qcar_runtime::model::{About, Channel, Model};
use qcar_runtime::modes::frequencies;
use qcar_runtime::response::Response;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::{Ratio, between};
use qcar_runtime::response::signal::driver;
use qcar_runtime::response::unit::unit;
use qcar_runtime::spelling;
use serde::Serialize;

use crate::catalogue;
use crate::failure::{Failure, flag};
use crate::json::{self, Ordered};
use crate::lines::missed;
use crate::parameters;
use crate::stability::unstable;
use crate::table::{Table, noted, noted_below, number};
use crate::terminal::{aside, prose};
use crate::units;
use crate::verbs::{ModelArguments, TableFormat, each_once};

/// Print the frequency response of the channels of a model
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar frf quarter_car --channels pad_to_body --frequencies 0.5:30:60\n  qcar frf axle_a --params models/campaigns/axle_a_rig --format csv"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Only these channels
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    channels: Vec<String>,
    /// First and last frequency in Hz and the number of lines, spaced logarithmically
    #[arg(long, value_name = "FROM:TO:LINES", default_value = "0.5:30:300")]
    frequencies: Frequencies,
    /// Output format; JSON includes the parameter Jacobian
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// Logarithmically spaced frequencies.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frequencies {
    from: f64,
    to: f64,
    lines: usize,
}

impl FromStr for Frequencies {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(':').collect();
        let &[from, to, lines] = parts.as_slice() else {
            return Err("expected FROM:TO:LINES, such as 0.5:30:300".into());
        };
        let hertz = |text: &str| {
            let value = text.parse::<f64>().ok().filter(|f| f.is_finite() && *f > 0.0);
            value.ok_or_else(|| format!("expected a frequency above 0 Hz, found `{text}`"))
        };
        let lines = lines.parse().ok().filter(|n| (1..=1_000_000).contains(n));
        let lines = lines.ok_or("expected 1 to 1000000 lines after the second `:`")?;
        let (from, to) = (hertz(from)?, hertz(to)?);
        match lines {
            1 if from != to => Err(format!(
                "expected two lines or more from {from} to {to} Hz, found 1; one line is {from}:{from}:1"
            )),
            1 => Ok(Frequencies { from, to, lines }),
            _ if from < to => Ok(Frequencies { from, to, lines }),
            _ => Err(format!("expected a last frequency above the first, found {from}:{to}")),
        }
    }
}

impl Frequencies {
    /// The frequencies, Hz; the first and the last are exact.
    pub(crate) fn values(&self) -> Vec<f64> {
        let last = self.lines - 1;
        let ratio = self.to / self.from;
        let at = |i: usize| match i {
            0 => self.from,
            i if i == last => self.to,
            i => self.from * ratio.powf(i as f64 / last as f64),
        };
        (0..self.lines).map(at).collect()
    }
}

/// # Errors
/// Fails if a channel is infinite at a frequency, because that is the one of an undamped mode.
fn refuse_resonance(model: &dyn Model, values: &Values, response: &FrequencyResponse) -> Result<(), Failure> {
    /// Relative difference of the frequency of a mode by rounding.
    const ROUNDED: f64 = 1e-9;
    let infinite = response.channels.0.iter().find_map(|(name, channel)| {
        let line =
            (0..channel.re.len()).find(|&line| !channel.re[line].is_finite() || !channel.im[line].is_finite())?;
        Some((name, channel.frequency[line]))
    });
    let Some((name, frequency)) = infinite else {
        return Ok(());
    };
    let mut modes = frequencies(model, values).into_iter();
    if !modes.any(|(own, damping)| damping == 0.0 && (own / frequency - 1.0).abs() < ROUNDED) {
        return Ok(());
    }
    let found = format!("a line at {frequency} Hz, where a mode without damping resonates and `{name}` is infinite");
    let remedy = "move the lines, or give the mode damping";
    Err(flag(
        "--frequencies",
        found,
        "lines beside the frequencies of undamped modes",
        remedy,
    )
    .into())
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let wanted = match arguments.format {
        TableFormat::Json => Wanted::Jacobian,
        TableFormat::Text | TableFormat::Csv => Wanted::Values,
    };
    let model = catalogue::load_wanted(&arguments.model.model, wanted)?;
    let values = parameters::resolve(model.about(), arguments.model.params.as_deref(), &arguments.model.set)?;
    model.check_inertias(values.as_slice())?;
    let frequency = arguments.frequencies.values();
    let channels = chosen(model.about(), &arguments.channels)?;
    let mut excited = ExcitedModel {
        model: &*model,
        values: &values,
        frequency: &frequency,
        wanted,
        responses: BTreeMap::new(),
    };
    let responses = channels.into_iter().map(|channel| excited.respond(channel));
    let response = FrequencyResponse {
        channels: responses.collect::<Result<_, Failure>>()?,
        model: model.about().name.to_string(),
        notices: parameters::out_of_range(model.about(), values.as_slice())
            .into_iter()
            .chain(unstable(&*model, &values))
            .chain(missed(&*model, &values, &frequency))
            .collect(),
    };
    refuse_resonance(&*model, &values, &response)?;
    let values = response.channels.0.iter().map(|(_, channel)| channel);
    parameters::require_finite(
        &model.about().name,
        values.flat_map(|channel| channel.re.iter().chain(&channel.im)),
    )?;
    Ok(match arguments.format {
        TableFormat::Text => prose(&text(&response, &frequency)),
        TableFormat::Json => json::line(&response),
        TableFormat::Csv => {
            aside(&noted(&response.notices));
            csv(&response, &frequency)
        }
    })
}

/// The response of the channels of a model, in its order.
#[derive(Serialize)]
struct FrequencyResponse {
    model: String,
    /// Values outside the ranges of the model and those at which it is unstable, and peaks that the lines miss, as sentences.
    notices: Vec<String>,
    channels: Ordered<ChannelResponse>,
}

/// The ratio of a channel's two signals, and its derivatives by every parameter.
#[derive(Serialize)]
struct ChannelResponse {
    /// Unit of the ratio.
    unit: String,
    /// Frequencies, Hz.
    frequency: Vec<f64>,
    re: Vec<f64>,
    im: Vec<f64>,
    d_re: Ordered<Vec<f64>>,
    d_im: Ordered<Vec<f64>>,
}

/// The channels with these names, or all without names.
///
/// # Errors
/// Fails if the model has no channels, or lacks a name.
pub(crate) fn chosen<'a>(about: &'a About, names: &[String]) -> Result<Vec<&'a Channel>, Failure> {
    let find = |name: &String| about.channels.iter().find(|channel| channel.name == **name);
    let known: Vec<&str> = about.channels.iter().map(|channel| &*channel.name).collect();
    if known.is_empty() {
        let remedy =
            "declare one in the model file, such as `channel pad_to_body = body.acceleration / pad.acceleration;`";
        return Err(flag(
            "MODEL",
            format!("`{}` has no channel", about.name),
            "a model with channels",
            remedy,
        )
        .into());
    }
    let unknown = names.iter().filter(|name| find(name).is_none());
    let expected = format!("channels of `{}`", about.name);
    let problems: Vec<_> = unknown
        .map(|name| {
            let remedy = spelling::choice(name, known.iter().copied());
            flag("--channels", format!("`{name}`"), &expected, &remedy)
        })
        .collect();
    let chosen = match names {
        [] => about.channels.iter().collect(),
        names => each_once(names).into_iter().filter_map(find).collect(),
    };
    Ok(InputError::unless_empty(problems, Some(chosen))?)
}

/// A model under each of its excitations, each evaluated once for all channels.
struct ExcitedModel<'a> {
    model: &'a dyn Model,
    values: &'a Values,
    frequency: &'a [f64],
    wanted: Wanted<'static>,
    responses: BTreeMap<usize, Response<'a, dyn Model + 'a>>,
}

impl<'a> ExcitedModel<'a> {
    fn respond(&mut self, channel: &Channel) -> Result<(String, ChannelResponse), Failure> {
        let about = self.model.about();
        let excitation = excitation(about, channel)?;
        let values = self.values;
        let ratio = between(
            self.response(excitation),
            values,
            &channel.numerator,
            &channel.denominator,
        )
        .map_err(|error| Failure::Input(format!("channel `{}`: {error}", channel.name)))?;
        let response = ChannelResponse {
            unit: unit(about, channel),
            frequency: self.frequency.into(),
            re: ratio.value.iter().map(|value| value.re).collect(),
            im: ratio.value.iter().map(|value| value.im).collect(),
            d_re: self.derivatives(&ratio, |value| value.re),
            d_im: self.derivatives(&ratio, |value| value.im),
        };
        Ok((channel.name.to_string(), response))
    }

    fn response(&mut self, excitation: usize) -> &Response<'a, dyn Model + 'a> {
        let (model, values, frequency, wanted) = (self.model, self.values, self.frequency, self.wanted);
        self.responses.entry(excitation).or_insert_with(|| {
            let mut response = Response::new(model, excitation, frequency);
            if wanted == Wanted::Jacobian {
                response.evaluate(values.as_slice());
            } else {
                response.evaluate_values(values.as_slice());
            }
            response
        })
    }

    /// Derivatives by every parameter that is not tied to another; empty if they are not wanted.
    fn derivatives(&self, ratio: &Ratio, part: fn(&Complex<f64>) -> f64) -> Ordered<Vec<f64>> {
        let about = self.model.about();
        let row = |k: usize| {
            let seen = ratio.jacobian.binary_search_by_key(&k, |(parameter, _)| *parameter);
            let row = match seen {
                Ok(at) => ratio.jacobian[at].1.iter().map(part).collect(),
                Err(_) => vec![0.0; self.frequency.len()],
            };
            (about.parameters[k].name.to_string(), row)
        };
        let leaders = (0..about.parameters.len()).filter(|&k| self.values.leader(k) == k);
        leaders.filter(|_| self.wanted == Wanted::Jacobian).map(row).collect()
    }
}

/// Excitation of a channel: its denominator if that can be prescribed, otherwise the road, otherwise another excitation
/// along its axis.
///
/// # Errors
/// Fails if there is no excitation along that axis.
pub fn excitation(about: &About, channel: &Channel) -> Result<usize, Failure> {
    driver(about, channel).ok_or_else(|| {
        let axis = &channel.denominator.axis;
        let found = format!("nothing drives `{}` along {axis}", channel.name);
        let remedy = "add `road pad;` or `force f on …;` to that direction of the model file";
        flag("MODEL", found, "a road, a prescribed motion or a force", remedy).into()
    })
}

fn text(of: &FrequencyResponse, frequency: &[f64]) -> String {
    let mut headings = vec![format!("frequency_{}", units::name("Hz"))];
    headings.extend(of.channels.0.iter().flat_map(|(name, channel)| {
        let decibels = units::decibels(&channel.unit);
        [format!("{name}_{decibels}"), format!("{name}_deg")]
    }));
    let mut table = Table::with_headings(headings);
    for (line, frequency) in frequency.iter().enumerate() {
        let polar = of.channels.0.iter().flat_map(|(_, channel)| {
            let value = Complex::new(channel.re[line], channel.im[line]);
            [
                number(20.0 * units::value(value.norm(), &channel.unit).log10(), 5),
                number(value.arg().to_degrees(), 5),
            ]
        });
        table.row(
            std::iter::once(number(units::value(*frequency, "Hz"), 5))
                .chain(polar)
                .collect(),
        );
    }
    table.text() + &noted_below(&of.notices)
}

fn csv(of: &FrequencyResponse, frequency: &[f64]) -> String {
    let names = of.channels.0.iter().map(|(name, channel)| {
        let [re, im] = ["re", "im"].map(|part| units::heading(&format!("{name}_{part}"), &channel.unit));
        format!(",{re},{im}")
    });
    let mut out = format!("{}{}\n", units::heading("frequency", "Hz"), names.collect::<String>());
    for (line, frequency) in frequency.iter().enumerate() {
        let cells = of.channels.0.iter().map(|(_, channel)| {
            let [re, im] = [&channel.re, &channel.im].map(|part| units::value(part[line], &channel.unit));
            format!(",{re},{im}")
        });
        let frequency = units::value(*frequency, "Hz");
        out.push_str(&format!("{frequency}{}\n", cells.collect::<String>()));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::Frequencies;

    #[test]
    fn lines_are_spaced_evenly_on_a_logarithmic_scale() {
        let frequencies: Frequencies = "1:100:3".parse().unwrap();
        assert_eq!(frequencies.values(), [1.0, 10.0, 100.0]);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "", "1:2", "0:10:5", "10:1:5", "1:2:0", "a:2:3", "1:inf:3", "1:2:-1", "1:30:1",
        ] {
            assert!(text.parse::<Frequencies>().is_err(), "{text}");
        }
    }
}
