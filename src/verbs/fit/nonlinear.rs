//! The fit of a nonlinear model: to all that a campaign holds, each level as it was driven.
//!
//! The residuals are those of discovery, over their uncertainty, and so are the errors of sensors that go with them.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use qcar_runtime::campaign::Campaign;
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::answer::News;
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::posterior::{Explanation, Setting};
use qcar_runtime::discover::select::{self, Alone, Minimum};
use qcar_runtime::error::InputError;
use qcar_runtime::fit::report::{Bound, Correlation, NoError, ParameterFit};
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::Values;
use serde::Serialize;

use super::{Arguments, Choices, files, plan, render};
use crate::failure::{Failure, flag};
use crate::files::put;
use crate::json::{self, Ordered};
use crate::left;
use crate::progress::Showing;
use crate::table::{Table, number};
use crate::terminal::prose;
use crate::verbs::Format;
use crate::workshop::{Bench, given};

/// Residuals of more standard deviations than this are not chance: three of a normal distribution.
const MUCH: f64 = 3.0;

/// A nonlinear model that was fitted to a campaign.
struct Nonlinear {
    campaign: Campaign,
    model: String,
    evidence: Evidence,
    parameters: Vec<ParameterFit>,
    starts: usize,
    found: Alone,
    seconds: f64,
}

/// Does it.
pub(super) fn run(campaign: Campaign, arguments: &Arguments) -> Result<String, Failure> {
    refuse_channels(&arguments.choices)?;
    let fitted = fit(campaign, &arguments.choices)?;
    if let Some(folder) = &arguments.out {
        fitted.write(folder)?;
    }
    let text = match arguments.format {
        Format::Text => prose(&fitted.text()),
        Format::Json => fitted.json(),
    };
    if fitted.found.explanation.refit.stop.converged() {
        Ok(text)
    } else {
        Err(Failure::Finding(text))
    }
}

/// # Errors
/// Channels, which the cost of a linear fit is made of.
fn refuse_channels(choices: &Choices) -> Result<(), InputError> {
    let expected = "a linear model, whose cost is made of channels";
    let remedy = "leave it out: a nonlinear model is fitted to what every sensor shows";
    let channels =
        (!choices.channels.is_empty()).then(|| flag("--channels", choices.channels.join(","), expected, remedy));
    InputError::unless_empty(channels.into_iter().collect(), Some(()))
}

fn fit(mut campaign: Campaign, choices: &Choices) -> Result<Nonlinear, Failure> {
    let begun = Instant::now();
    let bench = Bench::of_campaign(&campaign, choices.model.as_deref())?;
    let about = bench.model().about().clone();
    let plan = plan(&campaign, &about, choices)?;
    let setting = given(&plan.parameters, &campaign);
    let showing = Showing::new();
    showing.tell(format!("{}: reading", campaign.name));
    let evidence = Evidence::from_campaign(&campaign, &about)?;
    let told = |news: News<'_>| {
        if let News::Doing(what) = news {
            showing.tell(format!("{}: {what}", campaign.name));
        }
    };
    let found = select::alone(Box::new(bench), &setting, &evidence, plan.starts, &told);
    drop(showing);
    let found = found.map_err(|error| Failure::Input(format!("{}: {error}\n", campaign.manifest().display())))?;
    campaign.notices.extend(evidence.notices.iter().cloned());
    Ok(Nonlinear {
        model: about.name.to_string(),
        parameters: parameters(&about, &setting, &found.explanation),
        evidence,
        starts: plan.starts,
        found,
        seconds: begun.elapsed().as_secs_f64(),
        campaign,
    })
}

fn parameters(about: &About, setting: &Setting, of: &Explanation) -> Vec<ParameterFit> {
    let refit = &of.refit;
    let given: BTreeMap<String, f64> = setting.given.iter().map(|own| (own.name.clone(), own.value)).collect();
    let start = Values::resolve(about, &given, &setting.vehicle).unwrap_or_else(|_| refit.values.clone());
    let errors = refit.stderr();
    let parameter = |(place, own): (usize, &qcar_runtime::model::Parameter)| {
        let value = refit.values.as_slice()[place];
        let free = refit.free.iter().position(|free| free.parameter == place);
        let leader = refit.values.leader(place);
        let at_bound = free.and_then(|free| match refit.at_bound[free] {
            0 => None,
            side if side < 0 => Some(Bound::Lower),
            _ => Some(Bound::Upper),
        });
        // What is not known better than that it lies evenly in its range is not seen.
        let width = |free: usize| (refit.free[free].upper - refit.free[free].lower) / 12.0_f64.sqrt();
        let error = free.filter(|&free| errors[free] < width(free)).map(|free| errors[free]);
        let why = match (free, at_bound) {
            _ if leader != place => NoError::Tied,
            (None, _) => NoError::Known,
            (_, Some(_)) => NoError::AtBound,
            _ => NoError::Undetermined,
        };
        ParameterFit {
            name: own.name.to_string(),
            unit: own.unit.to_string(),
            value,
            start: start.as_slice()[place],
            range: free
                .map(|free| (refit.free[free].lower, refit.free[free].upper))
                .or(own.range),
            fitted: free.is_some(),
            stderr: error,
            relative_stderr: error.map(|error| error / value.abs()),
            stderr_parts: None,
            at_bound,
            why_no_stderr: error.is_none().then_some(why),
            tied_to: (leader != place).then(|| about.parameters[leader].name.to_string()),
            curve: None,
        }
    };
    about.parameters.iter().enumerate().map(parameter).collect()
}

/// As JSON.
#[derive(Serialize)]
struct Fitted<'a> {
    campaign: &'a str,
    model: &'a str,
    parameters: Ordered<&'a ParameterFit>,
    all_correlations: Vec<Correlation>,
    gap: Of<Option<f64>>,
    left: Vec<Left>,
    stopped: &'a str,
    converged: bool,
    starts: usize,
    other_minima: Vec<Other<'a>>,
    notices: &'a [String],
    seconds: f64,
}

/// A value for the runs that were fitted, and one for those that no fit has seen.
#[derive(Serialize)]
struct Of<T> {
    fit: T,
    held_out: T,
}

/// A minimum that is less probable than the answer.
#[derive(Serialize)]
struct Other<'a> {
    log_odds: f64,
    parameters: Ordered<&'a f64>,
}

/// What is left of a sensor in a kind of run.
#[derive(Serialize)]
struct Left {
    channel: String,
    kind: &'static str,
    percent: f64,
}

impl Nonlinear {
    fn json(&self) -> String {
        let refit = &self.found.explanation.refit;
        let finite = |value: f64| value.is_finite().then_some(value);
        let named = self.parameters.iter().map(|own| (own.name.clone(), own));
        json::line(&Fitted {
            campaign: &self.campaign.name,
            model: &self.model,
            parameters: named.collect(),
            all_correlations: self.correlations(),
            gap: Of {
                fit: finite(self.found.explanation.gap.fit),
                held_out: finite(self.found.explanation.gap.held_out),
            },
            left: self.left(),
            stopped: refit.stop.sentence(),
            converged: refit.stop.converged(),
            starts: self.starts,
            other_minima: self.found.others.iter().map(|own| self.other(own)).collect(),
            notices: &self.campaign.notices,
            seconds: self.seconds,
        })
    }

    /// A minimum by the parameters that are fitted.
    fn other<'a>(&self, of: &'a Minimum) -> Other<'a> {
        let fitted = self.parameters.iter().filter(|own| own.fitted);
        let value = |own: &ParameterFit| Some((own.name.clone(), of.named.get(&own.name)?));
        Other {
            log_odds: of.log_odds,
            parameters: fitted.filter_map(value).collect(),
        }
    }

    /// Of every two parameters that the runs see.
    fn correlations(&self) -> Vec<Correlation> {
        let refit = &self.found.explanation.refit;
        let name = |k: usize| self.parameters[refit.free[k].parameter].name.clone();
        let seen = |k: &usize| self.parameters[refit.free[*k].parameter].stderr.is_some();
        let between = |a: usize, b: usize| {
            let of = &refit.covariance;
            let value = of[(a, b)] / (of[(a, a)] * of[(b, b)]).sqrt();
            let between = (name(a), name(b));
            value.is_finite().then_some(Correlation { between, value })
        };
        let pairs = (0..refit.free.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        pairs
            .filter(|(a, b)| seen(a) && seen(b))
            .filter_map(|(a, b)| between(a, b))
            .collect()
    }

    fn left(&self) -> Vec<Left> {
        let left = left::left(&self.evidence, [&self.found.explanation; 2]);
        let own = |left: left::Left| Left {
            channel: left.channel,
            kind: left.kind,
            percent: left.after_percent,
        };
        left.into_iter().map(own).collect()
    }

    fn text(&self) -> String {
        let (refit, gap) = (&self.found.explanation.refit, &self.found.explanation.gap);
        let ended = if refit.stop.converged() {
            "converged"
        } else {
            "did not converge"
        };
        let mut out = format!(
            "{} fitted to {}: {ended}, {}\nresidual over its uncertainty: {} of the fitted runs",
            self.model,
            self.campaign.name,
            refit.stop.sentence(),
            number(gap.fit, 3),
        );
        if gap.held_out.is_finite() {
            out += &format!(", {} of those held out", number(gap.held_out, 3));
        }
        out += &format!("\n{} starts, {}\n", self.starts, self.other_minima());
        if gap.fit > MUCH {
            out += "note: the residuals are far above their uncertainty, which the standard errors do not account for: the model \
                    lacks something (`qcar discover` looks for it)\n";
        }
        out.extend(self.campaign.notices.iter().map(|notice| format!("note: {notice}\n")));
        let mut table = Table::new(["channel", "run", "left_%_of_signal"]);
        for left in self.left() {
            table.row(vec![left.channel, left.kind.into(), number(left.percent, 3)]);
        }
        format!("{out}\n{}\n{}", render::parameters(&self.parameters), table.text())
    }

    fn other_minima(&self) -> String {
        match &self.found.others[..] {
            [] => "which met no other minimum".into(),
            [next, others @ ..] => {
                let odds = number(next.log_odds, 2);
                format!(
                    "which met {} other minima, against the next of which the log odds are {odds}",
                    1 + others.len()
                )
            }
        }
    }

    /// Writes values and the answer.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    fn write(&self, folder: &Path) -> Result<(), InputError> {
        let values = files::parameters(&self.model, &self.campaign.name, &self.parameters);
        put(folder, "parameters.toml", &values)?;
        put(folder, "fit.json", &self.json())
    }
}
