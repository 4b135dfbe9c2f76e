//! The runs of a campaign, the flaws of their samples, and units that the samples contradict.

use std::fmt::Display;
use std::path::Path;

use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Campaign, Role, Run, Test};
use qcar_runtime::error::InputError;
use qcar_runtime::fit::measure::check_sweeps;
use qcar_runtime::simulate::{Cleat, tyre};

use crate::catalogue::{self, Loaded};
use crate::failure::Failure;
use crate::parameters;
use crate::sensors;
use crate::suspect_unit::{Statistics, gravity, suspicion};
use crate::table::{Table, number};
use crate::verbs::{fit, kc};

/// Significant digits.
const DIGITS: usize = 6;

/// True if every fit can use the samples, and the text on the campaign.
pub(super) fn verdict(folder: &Path) -> Result<(bool, String), Failure> {
    let campaign = Campaign::open(folder)?;
    let model = catalogue::of_campaign(&campaign, None, Wanted::Values)?;
    check_values(&campaign, &model)?;
    let findings = campaign.findings()?;
    let mut sentences = campaign.notices.clone();
    sentences.extend(parameters::campaign_out_of_range(model.about(), &campaign));
    sentences.extend(sensors::unknown(model.about(), &campaign));
    for finding in &findings {
        let sentence = finding.to_string();
        // Flaws of measured files are already among the notices.
        if !sentences.contains(&sentence) {
            sentences.push(sentence);
        }
    }
    sentences.extend(suspect_units(&campaign)?);
    // A fit of a linear model refuses such sweeps; that of a nonlinear one compares harmonics where the excitation has them.
    if !model.about().linear {
        sentences.extend(refusals(check_sweeps(&campaign, model.about())));
    }
    let is_dead = findings.iter().any(|finding| finding.fatal);
    let unfit = refusals(fit::check(&campaign, &model));
    let unusable = unusable(&campaign)?;
    let verdict = match (is_dead || !unfit.is_empty(), unusable.is_empty(), sentences.is_empty()) {
        (true, _, _) => "cannot be fitted",
        (false, false, _) => "has runs that cannot be used",
        (false, true, false) => "ok, with warnings",
        (false, true, true) => "ok",
    };
    let well = !is_dead && unfit.is_empty() && unusable.is_empty();
    for sentence in unfit.into_iter().chain(unusable) {
        if !sentences.contains(&sentence) {
            sentences.push(sentence);
        }
    }
    let text: String = sentences.iter().map(|sentence| format!("{sentence}\n")).collect();
    Ok((
        well,
        format!("{}: {verdict}\n{}{text}", folder.display(), runs(&campaign)?),
    ))
}

/// Checks the values of the campaign as the verbs that use them do.
fn check_values(campaign: &Campaign, model: &Loaded) -> Result<(), InputError> {
    let values = parameters::resolve(model.about(), [&*campaign.manifest()], &[])?;
    model.check_inertias(values.as_slice())?;
    let rolls = campaign.runs.iter().any(|run| matches!(run.test, Test::Cleat { .. }));
    if rolls && campaign.vehicle("r_tire").is_some() {
        tyre(campaign)?;
    }
    Ok(())
}

/// What the verbs refuse that use other runs than a fit does.
fn unusable(campaign: &Campaign) -> Result<Vec<String>, InputError> {
    let mut sentences = short_roads(campaign)?;
    if kc::has_curves(campaign) {
        sentences.extend(refusals(kc::gradients(campaign)));
    }
    let is_table = |run: &&Run| matches!(run.test, Test::Dynamometer(_));
    let tables = campaign.runs.iter().filter(is_table);
    sentences.extend(tables.flat_map(|run| refusals(campaign.force_table(run))));
    Ok(sentences)
}

/// The sentences of a refusal, one for each problem.
fn refusals<T>(result: Result<T, impl Display>) -> Vec<String> {
    let refused = result.err().map(|refusal| refusal.to_string());
    refused.iter().flat_map(|text| text.lines()).map(String::from).collect()
}

/// Cleat runs that would leave their roads, which no ride may.
fn short_roads(campaign: &Campaign) -> Result<Vec<String>, InputError> {
    let cleats = campaign.runs.iter().map(|run| Cleat::read(campaign, run));
    let cleats: Vec<Option<Cleat>> = cleats.collect::<Result<_, _>>()?;
    let short = cleats.iter().flatten().filter_map(|cleat| {
        let error = cleat.drive().stays_on_road().err()?;
        Some(format!("{}: {error}; {}", cleat.run.name, error.remedy()))
    });
    Ok(short.collect())
}

/// Sensors whose samples contradict their unit or contain gravity.
fn suspect_units(campaign: &Campaign) -> Result<Vec<String>, InputError> {
    let mut sentences = Vec::new();
    for run in campaign.runs.iter().filter(|run| run.test.sample_rate().is_some()) {
        let history = campaign.history(run)?;
        sentences.extend(history.signals.iter().filter_map(|(channel, samples)| {
            let of_motion = || gravity(channel.unit(), &does(samples)?);
            let what = suspicion(channel.unit(), does(samples)).or_else(of_motion)?;
            Some(format!("{}, `{}`: {what}", run.name, channel.name))
        }));
    }
    Ok(sentences)
}

fn does(samples: &[f64]) -> Option<Statistics> {
    let end = |of: fn(f64, f64) -> f64| samples.iter().copied().reduce(of);
    Some(Statistics {
        mean: samples.iter().sum::<f64>() / samples.len() as f64,
        min: end(f64::min)?,
        max: end(f64::max)?,
    })
}

fn runs(campaign: &Campaign) -> Result<String, InputError> {
    let mut table = Table::new(["run", "kind", "role", "channels", "samples", "rate_Hz", "from_s"]);
    for run in &campaign.runs {
        let role = if run.role == Role::Fit { "fit" } else { "held_out" };
        let mut row = vec![run.name.clone(), kind(run).into(), role.into()];
        row.extend(match run.test.sample_rate() {
            Some(rate) => {
                let history = campaign.history(run)?;
                [history.signals.len(), history.len()]
                    .map(|count| count.to_string())
                    .into_iter()
                    .chain([number(rate, DIGITS), number(history.start, DIGITS)])
                    .collect::<Vec<_>>()
            }
            None => vec!["-".into(); 4],
        });
        table.row(row);
    }
    Ok(table.text())
}

fn kind(run: &Run) -> &'static str {
    match run.test {
        Test::Sweep(_) => "sweep",
        Test::Bounce => "bounce",
        Test::DynamicBounce { .. } => "dynamic bounce",
        Test::Longitudinal => "longitudinal",
        Test::Cleat { .. } => "cleat",
        Test::TimeHistory(_) => "time history",
        Test::Dynamometer(_) => "dynamometer",
    }
}
