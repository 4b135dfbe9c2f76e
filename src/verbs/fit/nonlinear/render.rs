//! The fit of a nonlinear model as text and JSON.

use qcar_runtime::discover::select::Minimum;
use qcar_runtime::fit::profile::ParameterProfile;
use qcar_runtime::fit::report::{Correlation, ParameterFit};
use qcar_runtime::least_squares::Stop;
use serde::Serialize;

use super::Nonlinear;
use crate::json::{self, Ordered};
use crate::sensor_residuals;
use crate::table::{Table, counted, noted, number};
use crate::verbs::fit::{minima, render};

/// Residuals above this number of standard deviations are significant: three of a normal distribution.
const MUCH: f64 = 3.0;

/// The result as JSON.
#[derive(Serialize)]
struct Fitted<'a> {
    campaign: &'a str,
    model: &'a str,
    parameters: Ordered<&'a ParameterFit>,
    all_correlations: Vec<Correlation>,
    profiles: &'a [ParameterProfile],
    gap: ByRole<Option<f64>>,
    left: Vec<SensorResidual>,
    stopped: &'a str,
    converged: bool,
    starts: usize,
    other_minima: Vec<Other<'a>>,
    notices: &'a [String],
    seconds: f64,
}

/// A value for the fitted runs and one for the held-out runs.
#[derive(Serialize)]
struct ByRole<T> {
    fit: T,
    held_out: T,
}

/// A minimum that is less probable than the result.
#[derive(Serialize)]
struct Other<'a> {
    log_odds: f64,
    parameters: Ordered<&'a f64>,
}

/// Residual of a sensor in a kind of run.
#[derive(Serialize)]
struct SensorResidual {
    channel: String,
    kind: &'static str,
    percent: f64,
}

impl Nonlinear {
    pub(super) fn json(&self) -> String {
        let refit = &self.found.explanation.refit;
        let finite = |value: f64| value.is_finite().then_some(value);
        let named = self.parameters.iter().map(|own| (own.name.clone(), own));
        json::line(&Fitted {
            campaign: &self.campaign.name,
            model: &self.model,
            parameters: named.collect(),
            all_correlations: self.correlations(),
            profiles: &self.profiles,
            gap: ByRole {
                fit: finite(self.found.explanation.misfit.fit),
                held_out: finite(self.found.explanation.misfit.held_out),
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

    /// A minimum with the fitted parameters.
    fn other<'a>(&self, of: &'a Minimum) -> Other<'a> {
        let fitted = self.parameters.iter().filter(|own| own.fitted);
        let value = |own: &ParameterFit| Some((own.name.clone(), of.named.get(&own.name)?));
        Other {
            log_odds: of.log_odds,
            parameters: fitted.filter_map(value).collect(),
        }
    }

    /// Correlation of every two parameters that the runs determine.
    pub(crate) fn correlations(&self) -> Vec<Correlation> {
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

    fn left(&self) -> Vec<SensorResidual> {
        let left = sensor_residuals::left(&self.found.evidence, [&self.found.explanation; 2]);
        let own = |left: sensor_residuals::SensorResidual| SensorResidual {
            channel: left.channel,
            kind: left.kind,
            percent: left.after_percent,
        };
        left.into_iter().map(own).collect()
    }

    pub(super) fn text(&self) -> String {
        let (refit, gap) = (&self.found.explanation.refit, &self.found.explanation.misfit);
        let ended = if refit.stop.converged() {
            "converged"
        } else {
            "did not converge"
        };
        let mut out = format!(
            "{} fitted to {}: {ended}, {}\nRMS residual in standard deviations: {} of the fitted runs",
            self.model,
            self.campaign.name,
            refit.stop.sentence(),
            number(gap.fit, 3),
        );
        if gap.held_out.is_finite() {
            out += &format!(", {} of the held-out runs", number(gap.held_out, 3));
        }
        out += "\n";
        let is_fitted = refit.stop != Stop::NothingToFit;
        if is_fitted {
            out += &format!("{}, {}\n", counted(self.starts, "start"), self.other_minima());
        }
        if gap.fit > MUCH {
            let errors = if is_fitted {
                "the standard errors are therefore too small, and "
            } else {
                "these values are wrong, or "
            };
            out += &format!(
                "note: the residuals exceed the noise; {errors}the model lacks something (`qcar discover` looks for it)\n"
            );
        }
        out += &noted(&self.campaign.notices);
        let mut table = Table::new(["channel", "run", "left_%_of_signal"]);
        for left in self.left() {
            table.row(vec![left.channel, left.kind.into(), number(left.percent, 3)]);
        }
        let profiles = match &self.profiles[..] {
            [] => String::new(),
            some => format!("\n{}", render::profiles(some)),
        };
        let minima = match self.minima() {
            none if none.is_empty() => none,
            some => format!("\n{some}"),
        };
        format!(
            "{out}\n{}{minima}{profiles}\n{}",
            render::parameters(&self.parameters),
            table.text()
        )
    }

    /// Probability of each minimum relative to the result, and its parameters.
    fn minima(&self) -> String {
        let fitted = || self.parameters.iter().filter(|own| own.fitted);
        let other = |own: &Minimum| minima::Other {
            figures: vec![number(own.log_odds, 2)],
            values: fitted().map(|of| own.named.get(&of.name).copied()).collect(),
        };
        let others: Vec<_> = self.found.others.iter().map(other).collect();
        minima::text(&[("log odds against it", "0".into())], &self.parameters, &others)
    }

    fn other_minima(&self) -> String {
        match &self.found.others[..] {
            [] => "which found no other minimum".into(),
            [next, others @ ..] => {
                let odds = number(next.log_odds, 2);
                let minima = match others.len() {
                    0 => "1 other minimum".into(),
                    more => format!("{} other minima", 1 + more),
                };
                format!("which found {minima}; the log odds against the next are {odds}")
            }
        }
    }
}
