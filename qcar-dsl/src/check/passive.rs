//! Passivity: a damper may only dissipate energy. An inerter may be negative as long as the masses at its ends outweigh
//! it.

use super::Scratch;
use super::extremes::extreme;
use super::kinetic;
use super::sample::{Values, bounds, uniform};
use super::stiffness::dynamic_stiffness;
use crate::diagnostic::{Diagnostic, structure};
use crate::expr::{Expr, LinkId, Symbol};
use crate::model::{Link, Term};

/// Number of points of a nonlinear law that are tried.
pub(super) const TRIALS: u64 = 64;

/// Largest travel, m or rad, and speed, m/s or rad/s, of a suspension.
pub(super) const TRAVEL: f64 = 0.1;
pub(super) const SPEED: f64 = 2.0;

/// Angular frequencies of small vibrations, rad/s, from those of a car's body to those of sound.
const FREQUENCIES: [f64; 6] = [0.1, 1.0, 10.0, 1e2, 1e3, 1e4];

/// Checks that no damper and no inerter is negative in the declared ranges, and that no law pushes in the direction of
/// the motion without force inputs; links that are declared active are exempt.
pub fn links_are_passive(scratch: &Scratch) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let links = scratch.model.links.iter().enumerate();
    for (index, link) in links.filter(|(_, link)| !link.law.active) {
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
        found.extend(match link.law.inner.as_slice() {
            [] => pushes_along(scratch, link, id),
            _ => feeds_vibrations(scratch, link, id),
        });
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

/// A law without inner states whose force pushes in the direction of the motion.
fn pushes_along(scratch: &Scratch, link: &Link, id: LinkId) -> Option<Diagnostic> {
    let has_law = link.law.terms.iter().any(|term| matches!(term, Term::Force(_)));
    if !has_law {
        return None;
    }
    (0..TRIALS).find_map(|trial| {
        let (s, v) = (TRAVEL * centred(trial, 1), SPEED * centred(trial, 2));
        let at = |v| force_at(scratch, id, trial, s, v);
        let (moving, still) = (at(v)?, at(0.0)?);
        let power = (moving - still) * v;
        let size = (moving.abs() + still.abs()) * v.abs();
        (power < -1e-9 * size).then(|| structure::law_gives_energy(link.declared.span, &link.name, s, v))
    })
}

/// A law with inner states that supplies energy to vibrations about rest. At one instant, stored and supplied energy
/// cannot be separated; over a cycle, the imaginary part of the dynamic stiffness gives the dissipation.
fn feeds_vibrations(scratch: &Scratch, link: &Link, id: LinkId) -> Option<Diagnostic> {
    let slopes = &scratch.slopes[usize::from(id.0)];
    let laws: Vec<Expr> = slopes.all();
    (0..TRIALS).find_map(|trial| {
        let parameters = drawn(scratch, &laws, trial)?;
        let leaf = |symbol| parameters(symbol).unwrap_or(0.0);
        let values = Values::new(&scratch.graph, &leaf);
        let feeds = |frequency: &&f64| {
            let stiffness = dynamic_stiffness(slopes, &|e| values.of(e), **frequency);
            stiffness.im < -1e-9 * stiffness.norm()
        };
        let frequency = FREQUENCIES.iter().find(feeds)?;
        Some(structure::law_feeds_vibrations(
            link.declared.span,
            &link.name,
            *frequency,
        ))
    })
}

pub(super) fn centred(seed: u64, tag: u64) -> f64 {
    2.0 * uniform(seed, tag) - 1.0
}

/// The force of a link at a point, with all others at rest; `None` if a parameter has neither range nor default.
fn force_at(scratch: &Scratch, id: LinkId, trial: u64, s: f64, v: f64) -> Option<f64> {
    let force = scratch.slopes[usize::from(id.0)].force;
    let parameters = drawn(scratch, &[force], trial)?;
    let motion = |symbol| match symbol {
        Symbol::Stretch(own) if own == id => s,
        Symbol::Rate(own) if own == id => v,
        _ => 0.0,
    };
    let leaf = |symbol| parameters(symbol).unwrap_or_else(|| motion(symbol));
    Some(scratch.graph.evaluate(force, &leaf))
}

/// Values within their ranges for the parameters of some expressions, and `None` for all other leaves; `None`
/// altogether if a parameter has neither range nor default.
pub(super) fn drawn<'a>(
    scratch: &'a Scratch,
    of: &[Expr],
    trial: u64,
) -> Option<impl Fn(Symbol) -> Option<f64> + use<'a>> {
    let model = scratch.model;
    let range = move |index: u16| bounds(model, &model.parameters[usize::from(index)]);
    let decided = |symbol| !matches!(symbol, Symbol::Parameter(index) if range(index).is_none());
    let value = move |symbol| match symbol {
        Symbol::Parameter(index) => {
            range(index).map(|(low, high)| low + (high - low) * uniform(trial, 100 + u64::from(index)))
        }
        _ => None,
    };
    scratch
        .graph
        .symbols(of.iter().copied())
        .into_iter()
        .all(decided)
        .then_some(value)
}
