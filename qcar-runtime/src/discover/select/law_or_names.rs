//! Whether a learned law takes the place of named effects.

use super::first_law::FirstLaw;
use super::learn;
use super::probability::probabilities;
use super::set::{Set, best_base, excess, explained_share, leaves_more_than_noise, stated_share};
use crate::discover::answer::{Discovery, Learned, Progress, Verdict};
use crate::discover::numbers::{DOUBTFUL_BELOW, GREATER_PART};
use crate::discover::observe::Evidence;

/// Learns a law if the answer needs one, and replaces the findings by it if it is certainly more probable or explains
/// what they leave. `found` is the position of the set of the answer.
pub fn compare_with_law(
    discovery: &mut Discovery,
    found: usize,
    sets: &[Set],
    law: &mut FirstLaw,
    evidence: &Evidence,
    progress: Progress<'_>,
) {
    let (base, found) = (&sets[best_base(sets)], &sets[found]);
    if is_unexplained(discovery, base, evidence) {
        let first = law.for_base(sets, evidence, progress);
        let learned = learn::learn(base, first, &sets[0], evidence, progress);
        let explains =
            |law: &Set| stated_share(base, law, evidence).is_some_and(|share| share >= evidence.numbers.explained());
        let is_explained = learned.as_ref().is_some_and(explains);
        let learned = learned.map(|learned| learn::summary(base, learned, evidence));
        discovery.take(learned, is_explained);
    } else if discovery.verdict != Verdict::None && is_doubtful(found, base, evidence) {
        // Several effects together can imitate a law that is not in the catalogue.
        let law = law.for_base(sets, evidence, progress);
        let law = law.filter(|law| learn::is_supported(law, base, evidence));
        let is_certain = |law: &Set| probabilities(&[found, law], evidence)[1] > evidence.numbers.certain();
        let law = law.filter(|law| is_certain(law) || explains_instead(law, found, base, evidence));
        let law = law.filter(|law| contradicts(law, found, evidence));
        discovery.prefer(law.map(|law| learn::summary(base, law, evidence)));
    }
}

/// True if something is probably missing that no effect of the catalogue explains: the verdict is `Unknown`, or it is
/// `None` with a probability below one half or with fitted residuals above noise.
fn is_unexplained(discovery: &Discovery, base: &Set, evidence: &Evidence) -> bool {
    let is_improbable = |probability: f64| probability < DOUBTFUL_BELOW;
    match discovery.verdict {
        Verdict::Unknown => true,
        Verdict::None => discovery.probability.is_some_and(is_improbable) || leaves_more_than_noise(base, evidence),
        Verdict::Found | Verdict::Class => false,
    }
}

impl Discovery {
    /// Stores a learned law if the verdict is `Unknown`. A law by which enough of the excess residual `is_explained`
    /// turns the verdict `None` into `Unknown`: something is missing, however small.
    fn take(&mut self, learned: Option<Learned>, is_explained: bool) {
        if is_explained && self.verdict == Verdict::None {
            self.verdict = Verdict::Unknown;
            self.probability = None;
        }
        self.learned = learned.filter(|_| self.verdict == Verdict::Unknown);
    }

    /// Replaces the findings with a law that is more probable; does nothing if `law` is `None`.
    fn prefer(&mut self, law: Option<Learned>) {
        if law.is_some() {
            self.verdict = Verdict::Unknown;
            self.probability = None;
            self.findings.clear();
            self.after = self.before.clone();
            self.nuisances[1] = self.nuisances[0].clone();
            self.learned = law;
        }
    }
}

/// True if a learned law contradicts the named effects: it is at a place without a named effect, or it explains most of
/// the excess residual that they leave. A law that fits only a little better at the same place confirms the effect
/// there, which also has a physical cause.
fn contradicts(law: &Set, found: &Set, evidence: &Evidence) -> bool {
    let named: Vec<&str> = found.named().map(|own| own.at.as_str()).collect();
    let agrees = law.named().all(|own| named.contains(&own.at.as_str()));
    !agrees || explained_share(found, law, evidence) >= GREATER_PART
}

/// True if a learned law explains nearly all of the excess residual, and the named effects leave too much of it to be an
/// explanation. Their evidence may be larger even so, because the discrepancy accounts for the rest.
fn explains_instead(law: &Set, found: &Set, base: &Set, evidence: &Evidence) -> bool {
    explained_share(base, found, evidence) < evidence.numbers.explained()
        && explained_share(base, law, evidence) >= evidence.numbers.certain()
}

/// True if a learned law must be tried against the answer: the answer has several effects, leaves a significant part of
/// the excess residual, or the base model has no excess residual.
fn is_doubtful(found: &Set, base: &Set, evidence: &Evidence) -> bool {
    let explained = explained_share(base, found, evidence);
    found.names().len() > 1
        || explained < evidence.numbers.certain()
        || excess(&base.with_sensors_of(found, evidence), evidence) <= 0.0
}
