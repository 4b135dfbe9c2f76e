//! The load of a force input, direct and through the laws that use it.

use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::elimination::Scalar;
use crate::derive::stiffness::Stiffness;
use crate::derive::vectors::ExcitationSource;
use crate::expr::Graph;

/// The force on each coordinate for a unit force input, without motion.
pub(super) type Load = Vec<(usize, Complex)>;

/// The entry of a force input.
pub(super) fn by_source(inputs: &[(u16, Complex)], source: ExcitationSource) -> Option<Complex> {
    let found = inputs
        .iter()
        .find(|(input, _)| ExcitationSource::Force(*input) == source);
    found.map(|&(_, value)| value)
}

/// `Σ value(coordinate) force`
pub(super) fn through_load(g: &mut Graph, values: &[Complex], load: &[(usize, Complex)]) -> Complex {
    let zero = Complex::zero(g);
    load.iter().fold(zero, |sum, &(c, force)| {
        let share = values[c].mul(g, force);
        sum.add(g, share)
    })
}

/// The direct force of an input, minus that of the laws that use it.
pub(super) fn load(model: &Checked, g: &mut Graph, links: &[Stiffness], input: u16) -> Load {
    let pushed = model.forces[input as usize].on.iter();
    let mut load: Load = pushed
        .map(|&(c, share)| (c.0 as usize, Complex::real(g, share)))
        .collect();
    for (link, parts) in model.links.iter().zip(links) {
        let Some(force) = by_source(&parts.inputs, ExcitationSource::Force(input)) else {
            continue;
        };
        for &(c, coefficient) in &link.stretch {
            let push = force.scale(g, coefficient).neg(g);
            match load.iter_mut().find(|(other, _)| *other == c.0 as usize) {
                Some((_, sum)) => *sum = sum.add(g, push),
                None => load.push((c.0 as usize, push)),
            }
        }
    }
    load
}
