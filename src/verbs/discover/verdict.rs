//! The verdict in words.

use qcar_runtime::campaign::Role;
use qcar_runtime::discover::answer::{Finding, Probable, Verdict};
use qcar_runtime::discover::numbers::{DOUBTFUL_BELOW, GREATER_PART, LARGE};
use qcar_runtime::discover::posterior::SensorShare;

use super::Answer;
use crate::sensor_residuals::{channel, runs};
use crate::table::number;

/// The verdict as a sentence.
pub(crate) fn sentence(of: &Answer) -> String {
    let (found, class) = of.discovery.certain_and_alternatives();
    let remains = largest_residual(of).map_or_else(String::new, |share| remaining(&share));
    match of.discovery.verdict {
        Verdict::None => nothing_found(of),
        Verdict::Found => format!("found {}{remains}", listed(found)),
        Verdict::Class if found.is_empty() => format!("these data cannot distinguish {}{remains}", distinct(&class)),
        Verdict::Class => format!(
            "found {}, and in addition these data cannot distinguish {}{remains}",
            listed(found),
            distinct(&class)
        ),
        Verdict::Unknown => unexplained(of),
    }
}

/// What is left of a sensor, as the end of a sentence.
fn remaining(share: &SensorShare<'_>) -> String {
    let percent = number(100.0 * share.missed(), 2);
    format!(
        "; {percent} % of {} in {} remains",
        channel(share.sensor),
        runs(share.kind)
    )
}

/// True if there are findings and they leave large residuals.
pub(super) fn is_partly_explained(of: &Answer) -> bool {
    !of.discovery.findings.is_empty() && largest_residual(of).is_some()
}

/// The sensor with the largest share of its signal that the findings miss, of those that they miss more of than noise and
/// a usual model error; `None` without such a sensor.
fn largest_residual(of: &Answer) -> Option<SensorShare<'_>> {
    let misfit = &of.discovery.after.misfit;
    let shares = misfit.judged_sensor_shares(&of.evidence);
    let large = shares.into_iter().filter(|share| share.is_large(&of.evidence.numbers));
    large.max_by(|a, b| a.missed().total_cmp(&b.missed()))
}

/// The verdict `Unknown` as a sentence. If only the held-out runs show that something is missing, it says so: these runs
/// may be of another state of the axle than the fitted ones. If neither shows large residuals, nothing certain is missing.
fn unexplained(of: &Answer) -> String {
    let gap = &of.discovery.before.misfit;
    if let Some(own) = nearly_certain(of) {
        let [probability, needed] = [own.probability, of.evidence.numbers.certain()].map(|value| number(value, 3));
        return format!(
            "something is missing, most probably {} at {}: a probability of {probability}, where a name needs {needed}",
            own.effect, own.at
        );
    }
    let missing = "something is missing that no effect of the catalogue explains";
    let predicts_badly = gap.held_out > LARGE;
    if gap.fit <= LARGE && predicts_badly && of.discovery.learned.is_none() {
        let left = number(gap.held_out, 3);
        format!("{missing}: only the held-out runs show it, with residuals of {left} standard deviations")
    } else if gap.fit <= LARGE && !predicts_badly {
        "small residuals above noise remain that no effect of the catalogue explains".into()
    } else {
        missing.into()
    }
}

/// The most probable effect, if no law was learned, and if it explains most of the residual and falls short of the
/// required probability only.
fn nearly_certain(of: &Answer) -> Option<&Probable> {
    let first = of.discovery.candidates.first()?;
    let is_probable = (DOUBTFUL_BELOW..of.evidence.numbers.certain()).contains(&first.probability);
    let explains = first.explained.is_some_and(|share| share >= GREATER_PART);
    Some(first).filter(|_| of.discovery.learned.is_none() && is_probable && explains)
}

/// The verdict `None` as a sentence. It depends on the held-out runs: if the fitted runs show no effect, the model may
/// still predict others badly. Residuals far above noise may be a small part of the signal, as of any model.
fn nothing_found(of: &Answer) -> String {
    let gap = &of.discovery.before.misfit;
    let (runs, role, left) = match gap.held_out.is_finite() {
        true => ("held-out", Role::HeldOut, gap.held_out),
        false => ("fitted", Role::Fit, gap.fit),
    };
    if left > LARGE {
        let left = number(left, 3);
        let shares = gap.sensor_shares(&of.evidence, role);
        let most = shares.iter().map(SensorShare::missed).fold(0.0, f64::max);
        if most <= of.evidence.numbers.expected_discrepancy {
            let percent = number(100.0 * most, 2);
            return format!(
                "no effect found: the residuals of the {runs} runs are {left} times noise, and at most {percent} % of \
                 any signal"
            );
        }
        format!("no effect found, but the {runs} runs have residuals of {left} standard deviations")
    } else if of.discovery.probability.is_none() {
        "no effect is certain: noise explains the residuals of the held-out runs".into()
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

/// Words before the name of a finding: `either` or `or` for the first one of an alternative, `with` for the others.
pub(crate) fn choice(findings: &[Finding], place: usize) -> &'static str {
    let before = place.checked_sub(1).and_then(|before| findings[before].alternative);
    match (before, findings[place].alternative) {
        (_, None) => "",
        (None, _) => "either ",
        (before, own) if before == own => "with ",
        _ => "or ",
    }
}

/// The alternatives of a class.
fn distinct(alternatives: &[&[Finding]]) -> String {
    let together = alternatives
        .iter()
        .map(|own| own.iter().map(placed).collect::<Vec<_>>().join(" with "));
    let is_plain = alternatives.iter().all(|own| own.len() == 1);
    together
        .collect::<Vec<_>>()
        .join(if is_plain { " and " } else { ", and " })
}

/// The names of effects with their places.
pub(super) fn listed(findings: &[Finding]) -> String {
    findings.iter().map(placed).collect::<Vec<_>>().join(" and ")
}

fn placed(finding: &Finding) -> String {
    format!("{} at {}", finding.effect, finding.at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A friction and what is left beside it, in two forms each: four effects are not four alternatives.
    #[test]
    fn effects_of_one_alternative_are_told_together() {
        let finding = |effect: &str, alternative| Finding {
            effect: effect.into(),
            at: "damper".into(),
            form: None,
            alternative,
            parameters: Vec::new(),
            evidence: 0.0,
            explained: None,
            rivals: Vec::new(),
        };
        let all = [
            finding("bump_stop", None),
            finding("coulomb_friction", Some(0)),
            finding("free_play", Some(0)),
            finding("elasto_slip_friction", Some(1)),
            finding("sensor_delay", Some(1)),
            finding("lugre_friction", Some(2)),
        ];
        let words: Vec<&str> = (0..all.len()).map(|place| choice(&all, place)).collect();
        assert_eq!(words, ["", "either ", "with ", "or ", "with ", "or "]);
        assert_eq!(
            distinct(&[&all[1..3], &all[3..5]]),
            "coulomb_friction at damper with free_play at damper, and elasto_slip_friction at damper with sensor_delay \
             at damper"
        );
        assert_eq!(
            distinct(&[&all[1..2], &all[3..4]]),
            "coulomb_friction at damper and elasto_slip_friction at damper"
        );
    }
}
