//! What takes energy: a damper may only take, never give. An inerter may be negative as far as the masses around it
//! outweigh it.

use super::Scratch;
use super::extremes::extreme;
use super::kinetic;
use super::sample::{bounds, uniform};
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{Expr, LinkId, Symbol};
use crate::model::{Link, Term};

/// How many points of a nonlinear law are tried.
const TRIALS: u64 = 64;

/// Travel, m or rad, and speed, m/s or rad/s, that a suspension sees.
const TRAVEL: f64 = 0.1;
const SPEED: f64 = 2.0;

/// No damper and no inerter is negative anywhere in the declared ranges, and no law pushes along with the motion.
pub fn links_are_passive(scratch: &Scratch) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, link) in scratch.model.links.iter().enumerate() {
        let rolling = link.rolling.iter().flatten();
        for term in link.law.terms.iter().chain(rolling) {
            found.extend(match *term {
                Term::Damper(c) => negative(scratch, link, c, "damping"),
                Term::Inerter(b) => {
                    negative(scratch, link, b, "inertance").filter(|_| !kinetic::stays_positive(scratch))
                }
                Term::Spring(_) | Term::Force(_) => None,
            });
        }
        let id = LinkId(index as u16);
        found.extend(pushes_along(scratch, link, id));
    }
    found
}

fn negative(scratch: &Scratch, link: &Link, coefficient: Expr, what: &str) -> Option<Diagnostic> {
    let lowest = extreme(scratch, coefficient, f64::min)?;
    let at: Vec<String> = lowest
        .at
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    (lowest.value < 0.0).then(|| structure::negative_damping(link.declared.span, &link.name, what, lowest.value, &at))
}

/// A law without inner states that a faster motion helps on. With inner states, what is stored cannot be told from
/// what is taken.
fn pushes_along(scratch: &Scratch, link: &Link, id: LinkId) -> Option<Diagnostic> {
    let force = scratch.slopes[usize::from(id.0)].force;
    let has_law = link.law.terms.iter().any(|term| matches!(term, Term::Force(_)));
    if !has_law || !link.law.inner.is_empty() {
        return None;
    }
    (0..TRIALS).find_map(|trial| {
        let (s, v) = (TRAVEL * centred(trial, 1), SPEED * centred(trial, 2));
        let at = |v| force_at(scratch, force, trial, s, v);
        let (moving, still) = (at(v)?, at(0.0)?);
        let power = (moving - still) * v;
        let size = (moving.abs() + still.abs()) * v.abs();
        (power < -1e-9 * size).then(|| structure::law_gives_energy(link.declared.span, &link.name, s, v))
    })
}

fn centred(seed: u64, tag: u64) -> f64 {
    2.0 * uniform(seed, tag) - 1.0
}

/// The force at a point; `None` where a parameter has neither range nor default.
fn force_at(scratch: &Scratch, force: Expr, trial: u64, s: f64, v: f64) -> Option<f64> {
    let parameters = &scratch.model.parameters;
    let value = |index: u16| {
        let (low, high) = bounds(scratch.model, &parameters[usize::from(index)])?;
        Some(low + (high - low) * uniform(trial, 100 + u64::from(index)))
    };
    let decided = scratch.graph.symbols([force]).into_iter().all(|symbol| match symbol {
        Symbol::Parameter(index) => value(index).is_some(),
        _ => true,
    });
    let leaf = |symbol| match symbol {
        Symbol::Parameter(index) => value(index).unwrap_or_default(),
        Symbol::Stretch(_) => s,
        _ => v,
    };
    decided.then(|| scratch.graph.evaluate(force, &leaf))
}
