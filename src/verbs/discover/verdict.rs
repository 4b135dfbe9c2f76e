//! The verdict in words.

use std::cmp::Ordering;

use qcar_runtime::discover::answer::{Finding, Verdict};
use qcar_runtime::discover::numbers::DOUBTFUL_BELOW;
use qcar_runtime::discover::posterior::SensorShare;

use super::Answer;
use crate::table::number;

/// The verdict as a sentence.
pub(crate) fn sentence(of: &Answer) -> String {
    let (found, class) = of.discovery.certain_and_alternatives();
    let remains = if is_partly_explained(of) { "; large residuals remain" } else { "" };
    match of.discovery.verdict {
        Verdict::None => nothing_found(of),
        Verdict::Found => format!("found {}{remains}", listed(found)),
        Verdict::Class if found.is_empty() => format!("these data cannot distinguish {}{remains}", listed(class)),
        Verdict::Class => format!(
            "found {}, and in addition these data cannot distinguish {}{remains}",
            listed(found),
            listed(class)
        ),
        Verdict::Unknown => unexplained(of),
    }
}

/// True if there are findings and they leave more of the signal of some sensor than noise and a usual model error do.
pub(super) fn is_partly_explained(of: &Answer) -> bool {
    let shares = (of.discovery.after.misfit).sensor_shares(&of.evidence, of.evidence.judging());
    let is_large = |share: &SensorShare| share.certainly_missed() > of.evidence.numbers.expected_discrepancy;
    !of.discovery.findings.is_empty() && shares.iter().any(is_large)
}

/// RMS residual in standard deviations above which noise does not explain it. Sensors with errors beyond their data
/// sheets leave less. `LARGE` in the report's `judgement.js` is the same limit.
const LARGE: f64 = 2.0;

/// The verdict `Unknown` as a sentence. If only the held-out runs show that something is missing, it says so: these runs
/// may be of another state of the axle than the fitted ones.
fn unexplained(of: &Answer) -> String {
    let gap = &of.discovery.before.misfit;
    let missing = "something is missing that no effect of the catalogue explains";
    if gap.fit <= LARGE && gap.held_out > LARGE && of.discovery.learned.is_none() {
        let left = number(gap.held_out, 3);
        format!("{missing}: only the held-out runs show it, with residuals of {left} standard deviations")
    } else {
        missing.into()
    }
}

/// The verdict `None` as a sentence. It depends on the held-out runs: if the fitted runs show no effect, the model may
/// still predict others badly.
fn nothing_found(of: &Answer) -> String {
    let gap = &of.discovery.before.misfit;
    let (runs, left) = match gap.held_out.is_finite() {
        true => ("held-out", gap.held_out),
        false => ("fitted", gap.fit),
    };
    if left > LARGE {
        let left = number(left, 3);
        format!("no effect found, but the {runs} runs have residuals of {left} standard deviations")
    } else if is_doubtful(of) {
        "no effect is certain: small residuals above noise remain".into()
    } else {
        "no effect found: noise explains the residuals".into()
    }
}

/// True if the probability of the answer is below one half.
fn is_doubtful(of: &Answer) -> bool {
    of.discovery
        .probability
        .is_some_and(|probability| probability < DOUBTFUL_BELOW)
}

/// Word before the name of a finding: `either` or `or` for an alternative.
pub(crate) fn choice(of: &Answer, place: usize) -> &'static str {
    let found = of.discovery.certain_and_alternatives().0.len();
    match place.cmp(&found) {
        Ordering::Less => "",
        Ordering::Equal => "either ",
        Ordering::Greater => "or ",
    }
}

fn listed(findings: &[Finding]) -> String {
    let names = findings.iter().map(|own| format!("{} at {}", own.effect, own.at));
    names.collect::<Vec<_>>().join(" and ")
}
