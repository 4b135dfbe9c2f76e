//! A fit as text and as JSON.

use qcar_runtime::fit::Fit;
use qcar_runtime::fit::bootstrap::Bootstrap;
use qcar_runtime::fit::profile::ParameterProfile;
use qcar_runtime::fit::report::{Bound, ChannelFit, Correlation, LocalMinimum, ParameterFit};
use serde::Serialize;

use super::{Fitted, minima};
use crate::json::{self, Ordered};
use crate::table::{Table, noted, number, or_dash};
use crate::units;

/// Parameters by name, channels run by run.
#[derive(Serialize)]
pub(crate) struct Result<'a> {
    campaign: &'a str,
    model: &'a str,
    parameters: Ordered<&'a ParameterFit>,
    correlations: &'a [Correlation],
    all_correlations: &'a [Correlation],
    channels: &'a [ChannelFit],
    cost: f64,
    start_cost: f64,
    stopped: &'a str,
    converged: bool,
    evaluations: usize,
    starts: usize,
    minima: &'a [LocalMinimum],
    profiles: &'a [ParameterProfile],
    bootstrap: Option<&'a Bootstrap>,
    notices: &'a [String],
    seconds: f64,
}

pub(super) fn json(of: &Fitted) -> String {
    json::line(&result(of))
}

pub(crate) fn result(of: &Fitted) -> Result<'_> {
    let fit = &of.fit;
    Result {
        campaign: &of.campaign.name,
        model: &fit.model,
        parameters: fit
            .parameters
            .iter()
            .map(|parameter| (parameter.name.clone(), parameter))
            .collect(),
        correlations: &fit.correlations,
        all_correlations: &fit.all_correlations,
        channels: &fit.channels,
        cost: fit.cost,
        start_cost: fit.start_cost,
        stopped: fit.stopped_because,
        converged: fit.converged,
        evaluations: fit.evaluations,
        starts: fit.starts,
        minima: &fit.minima,
        profiles: &of.profiles,
        bootstrap: of.bootstrap.as_ref(),
        notices: &of.campaign.notices,
        seconds: of.seconds,
    }
}

pub(super) fn text(of: &Fitted) -> String {
    let sections = [
        summary(of),
        parameters(&of.fit.parameters),
        distinct(&of.fit),
        profiles(&of.profiles),
        of.bootstrap.as_ref().map_or(String::new(), bootstrap),
        correlations(&of.fit.correlations),
        channels(of),
    ];
    sections
        .into_iter()
        .filter(|section| !section.is_empty())
        .collect::<Vec<_>>()
        .join("\n")
}

fn summary(of: &Fitted) -> String {
    let fit = &of.fit;
    let ended = if fit.converged { "converged" } else { "did not converge" };
    let agree = fit.minima.first().map_or(0, |minimum| minimum.starts);
    let mut out = format!(
        "{} fitted to {}: {ended}, {}\ncost {} (at the start values {}), {agree} of {} starts found it, {} evaluations\n",
        fit.model,
        of.campaign.name,
        fit.stopped_because,
        number(fit.cost, 4),
        number(fit.start_cost, 4),
        fit.starts,
        fit.evaluations,
    );
    out += &noted(&of.campaign.notices);
    out
}

pub(super) fn parameters(of: &[ParameterFit]) -> String {
    let mut table = Table::new(["parameter", "unit", "start", "value", "stderr", "stderr_%", "remark"]);
    for parameter in of {
        let shown = |value| units::value(value, &parameter.unit);
        let names = [parameter.name.clone(), units::name(&parameter.unit).into()];
        let values = [parameter.start, parameter.value].map(|value| number(shown(value), 5));
        let percent = parameter.relative_stderr.map(|part| 100.0 * part);
        let errors = [parameter.stderr.map(shown), percent].map(|error| or_dash(error, 2));
        table.row([&names[..], &values, &errors, &[remark(parameter)]].concat());
    }
    table.text() + &how_to_distinguish(of)
}

/// Refers to the verb that finds measurements to separate parameters which the runs determine only in combination.
fn how_to_distinguish(of: &[ParameterFit]) -> String {
    let combined = of.iter().filter(|own| own.is_only_in_combination());
    let names: Vec<&str> = combined.map(|own| &*own.name).collect();
    match names[..] {
        [] => String::new(),
        _ => format!(
            "note: to find the measurement that distinguishes them, use `qcar plan CAMPAIGN --parameters {}`\n",
            names.join(",")
        ),
    }
}

pub(super) fn remark(of: &ParameterFit) -> String {
    let bound = of.at_bound.map(|bound| match bound {
        Bound::Lower => "at the lower end of its range",
        Bound::Upper => "at the upper end of its range",
    });
    match (bound, &of.tied_to, &of.why_no_stderr, of.curve) {
        (Some(bound), ..) => bound.into(),
        (None, Some(other), ..) => format!("as {other}"),
        (None, None, why, Some(curve)) => {
            let why = why
                .as_ref()
                .map_or(String::new(), |why| format!(", {}", why.sentence()));
            format!("no fitted channel depends on it: from the K&C {curve} curve{why}")
        }
        (None, None, Some(why), None) => why.sentence(),
        (None, None, None, None) => String::new(),
    }
}

/// Cost, number of searches and parameters of each minimum.
fn distinct(of: &Fit) -> String {
    let figures = |own: &LocalMinimum| vec![number(own.cost, 4), own.starts.to_string()];
    let Some((best, others)) = of.minima.split_first() else {
        return String::new();
    };
    let fitted = || of.parameters.iter().filter(|own| own.fitted);
    let others = others.iter().map(|own| minima::Other {
        figures: figures(own),
        values: fitted().map(|of| own.parameters.get(&of.name).copied()).collect(),
    });
    let named: Vec<(&str, String)> = ["cost", "starts"].into_iter().zip(figures(best)).collect();
    minima::text(&named, &of.parameters, &others.collect::<Vec<_>>())
}

pub(super) fn profiles(of: &[ParameterProfile]) -> String {
    if of.is_empty() {
        return String::new();
    }
    let mut table = Table::new(["profiled", "unit", "value", "from", "to", "remark"]);
    for own in of {
        let shown = |value: f64| number(units::value(value, &own.unit), 5);
        let end = |end: Option<f64>| end.map_or("open".into(), shown);
        table.row(vec![
            own.name.clone(),
            units::name(&own.unit).into(),
            shown(own.value),
            end(own.interval[0]),
            end(own.interval[1]),
            profile_remark(own),
        ]);
    }
    format!("95 % intervals by profile likelihood\n{}", table.text())
}

fn profile_remark(of: &ParameterProfile) -> String {
    let open = match of.interval {
        [None, None] => "not determined within its range",
        [None, Some(_)] => "no lower end within its range",
        [Some(_), None] => "no upper end within its range",
        [Some(_), Some(_)] => "",
    };
    let lower = of.lower_at.map(|at| {
        let at = number(units::value(at, &of.unit), 5);
        format!("a lower cost was found at {at}: fit with more --starts")
    });
    let words = [Some(open.to_string()).filter(|words| !words.is_empty()), lower];
    words.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

fn bootstrap(of: &Bootstrap) -> String {
    let mut table = Table::new(["parameter", "unit", "value", "from", "to", "stderr", "bias"]);
    for own in &of.parameters {
        let shown = |value: f64| units::value(value, &own.unit);
        let [from, to] = own.interval;
        let ends = [own.value, from, to].map(|value| number(shown(value), 5));
        let spread = [own.stderr, own.bias].map(|value| number(shown(value), 2));
        let names = [own.name.clone(), units::name(&own.unit).into()];
        table.row([&names[..], &ends, &spread].concat());
    }
    let failed = match of.failed {
        0 => String::new(),
        failed => format!(", {failed} of which ended at no minimum and do not count"),
    };
    format!(
        "95 % intervals by {} fits to resamples{failed}\n{}",
        of.resamples,
        table.text()
    )
}

fn correlations(of: &[Correlation]) -> String {
    let line = |c: &Correlation| format!("{} and {}: {}\n", c.between.0, c.between.1, number(c.value, 3));
    match of {
        [] => String::new(),
        some => format!("correlations above 0.9\n{}", some.iter().map(line).collect::<String>()),
    }
}

/// Headings of the table of channels.
pub(super) const CHANNEL_HEADINGS: [&str; 6] = [
    "channel",
    "run",
    "role",
    "in_the_cost",
    "fit_magnitude_%",
    "fit_phase_%",
];

fn channels(of: &Fitted) -> String {
    let mut table = Table::new(CHANNEL_HEADINGS);
    for channel in &of.fit.channels {
        table.row(vec![
            channel.name.clone(),
            channel.run.clone(),
            channel.role.into(),
            if channel.fitted { "yes" } else { "no" }.into(),
            format!("{:.1}", channel.quality.fit_magnitude),
            format!("{:.1}", channel.quality.fit_phase),
        ]);
    }
    table.text()
}
