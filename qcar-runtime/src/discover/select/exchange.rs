//! Replaces one effect of a set by a rival, or by another of its forms.
//!
//! An effect is preferred to its rivals before later effects are added. The effects still missing at that time bias the
//! choice: unmodelled bending of the body or a sensor delay can favour the wrong effect. So each rival is fitted again
//! together with the later effects.

use rayon::prelude::*;

use super::assembly::{Assembly, Place, Placed};
use super::fidelity::Fidelity;
use super::finite_explanation;
use super::race::{FINE_BUDGET, may_catch_up};
use super::set::Set;
use crate::discover::observe::Evidence;

/// Fitted sets in which one effect is replaced by a rival. A rival is tried if its log posterior was lower by less than
/// the later effects gained, since they may gain as much together with the rival.
pub fn exchanges(set: &Set, sets: &[Set], evidence: &Evidence) -> Vec<Set> {
    let last = set.assembly.effects().len() - 1;
    let rivals = (0..last).flat_map(|place| {
        let chosen = sets.iter().find(|other| starts_with(set, other, place + 1));
        let rivals = sets.iter().filter(move |other| competed(set, other, place));
        chosen
            .into_iter()
            .flat_map(move |chosen| rivals.clone().map(move |rival| (chosen, rival)))
    });
    let open = rivals.filter(|(chosen, rival)| {
        let gained = set.log_posterior() - chosen.log_posterior();
        chosen.log_posterior() - rival.log_posterior() < gained
    });
    let open: Vec<(&Set, &Set)> = open.collect();
    let exchanged = |(chosen, rival)| exchanged(set, chosen, rival, sets, evidence);
    open.into_par_iter().filter_map(exchanged).collect()
}

/// Fitted sets in which one named effect has another form. The best form alone need not be the best beside others, and the
/// optimum of one form is a good start for another: a stop that stiffens, from one that does not. A form that cannot
/// catch up with the present one on a part of the data is not fitted to all of it. The first of `sets` is the base model.
pub fn other_forms(set: &Set, sets: &[Set], evidence: &Evidence) -> Vec<Set> {
    let base = &sets[0].assembly;
    let effects = set.assembly.effects();
    let changed = effects.iter().enumerate().filter(|(_, own)| !own.nuisance);
    let changed: Vec<Vec<Placed>> = changed
        .flat_map(|(place, own)| {
            let forms = base.forms(own).into_iter();
            forms.filter(|form| *form != own.form).map(move |form| {
                let mut others = effects.to_vec();
                others[place].form = form;
                others
            })
        })
        .collect();
    let from = set.assembly.hypothesis().place(&set.explanation.refit);
    let steady = evidence.minus(&set.explanation.refit.unsteady).with_step_limit();
    let medium = Fidelity::of(&steady).medium;
    let Some(present) = set.again(&medium) else {
        return Vec::new();
    };
    let fitted = changed.par_iter().filter_map(|effects| {
        let effects: Vec<&Placed> = effects.iter().collect();
        if sets.iter().any(|known| has_all(known, &effects)) {
            return None;
        }
        let assembly = base.with_all(&effects)?;
        let hypothesis = assembly.hypothesis();
        let refit = hypothesis.fit(&from, &medium, FINE_BUDGET).ok()?;
        if !may_catch_up(&refit, present) {
            return None;
        }
        let from = hypothesis.place(&refit);
        refitted(assembly, &from, set, set.log_prior, evidence)
    });
    fitted.collect()
}

/// True if the other set consists of the first `count` effects of this set.
fn starts_with(set: &Set, other: &Set, count: usize) -> bool {
    let (own, others) = (set.assembly.effects(), other.assembly.effects());
    others.len() == count && own.iter().zip(others).all(|(own, other)| is_same(own, other))
}

/// True if the other set has the same effects before `place` and, at `place` as its last, an effect that this set
/// lacks.
fn competed(set: &Set, other: &Set, place: usize) -> bool {
    let (own, others) = (set.assembly.effects(), other.assembly.effects());
    let begins_alike =
        others.len() == place + 1 && own[..place].iter().zip(others).all(|(own, other)| is_same(own, other));
    begins_alike && !own.iter().any(|own| own.name() == others[place].name())
}

fn is_same(own: &Placed, other: &Placed) -> bool {
    own.name() == other.name() && own.form == other.form
}

/// The set with the last effect of `chosen` replaced by the last effect of `rival`; `None` if that set is known or
/// cannot be fitted.
fn exchanged(set: &Set, chosen: &Set, rival: &Set, sets: &[Set], evidence: &Evidence) -> Option<Set> {
    let later = &set.assembly.effects()[chosen.assembly.effects().len()..];
    let effects: Vec<&Placed> = rival.assembly.effects().iter().chain(later).collect();
    if sets.iter().any(|known| has_all(known, &effects)) {
        return None;
    }
    let assembly = rival.assembly.with_all(&later.iter().collect::<Vec<_>>())?;
    let there = set.assembly.hypothesis().place(&set.explanation.refit);
    let mut from = rival.assembly.hypothesis().place(&rival.explanation.refit);
    for (name, value) in there.named {
        from.named.entry(name).or_insert(value);
    }
    from.discrepancy = there.discrepancy;
    let prior = rival.log_prior + set.log_prior - chosen.log_prior;
    refitted(assembly, &from, rival, prior, evidence)
}

/// A set with these effects, fitted from a place and with the non-steady part of a similar set; `None` if it cannot be
/// fitted.
fn refitted(assembly: Assembly, from: &Place, similar: &Set, log_prior: f64, evidence: &Evidence) -> Option<Set> {
    let hypothesis = assembly.hypothesis();
    let steady = evidence.minus(&similar.explanation.refit.unsteady).with_step_limit();
    let refit = hypothesis.fit(from, &Fidelity::of(&steady).fine, FINE_BUDGET).ok()?;
    let explanation = finite_explanation(&hypothesis, refit, evidence)?;
    Some(Set::new(assembly, explanation, log_prior))
}

fn has_all(known: &Set, effects: &[&Placed]) -> bool {
    let own = known.assembly.effects();
    own.len() == effects.len() && effects.iter().all(|wanted| own.iter().any(|own| is_same(own, wanted)))
}
