//! The lowest vibrations of a large matrix, without its other eigenvalues.
//!
//! Arnoldi's method gives candidates, inverse iteration verifies each of them by its residual, and the argument
//! principle shows that none is missing. For a band of constant width, the work grows with the number of states; that of
//! all eigenvalues grows with its third power.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::eigenvector::eigenvalue;
use super::enclosed::are_known_within;
use super::ritz::ritz_values;
use super::{RIGID, vibrates};
use crate::banded::Ordered;

/// Candidates lie around this number, 1/s: above rigid motions, for which the matrix is singular, and far below all
/// vibrations.
const SHIFT: f64 = 10.0 * TAU * RIGID;

/// Least ratio of two moduli between which the circle passes that encloses the vibrations.
const GAP: f64 = 1.02;

/// Largest residual of an eigenvalue, relative to it.
const RESIDUAL: f64 = 1e-9;

/// Least relative distance of two moduli whose order is certain. It is far above the errors of the eigenvalues, here and
/// in a computation of all, even if two modes nearly coincide.
const APART: f64 = 1e-4;

/// Imaginary part, relative to the modulus, above which an eigenvalue certainly vibrates, and below which it is real.
const VIBRATING: f64 = 1e-3;
const REAL: f64 = 1e-9;

/// The eigenvalues with positive imaginary part of this many vibrations, lowest frequency first. `None` if it is not
/// certain which these are, or if the computation of all eigenvalues is as fast.
pub(super) fn lowest_vibrations(a: &Ordered, count: usize) -> Option<Vec<Complex<f64>>> {
    let steps = 4 * count + 16;
    if 2 * steps > a.order().len() {
        return None;
    }
    let mut near = ritz_values(a, SHIFT, steps);
    near.sort_by(|one, other| one.norm().total_cmp(&other.norm()));
    let rigid = near.iter().take_while(|root| root.norm() < TAU * RIGID).count();
    let inside = up_to_gap(&near, count)?;
    let radius = (near[inside - 1].norm() * near[inside].norm()).sqrt();
    let upper = near[rigid..inside].iter().filter(|root| root.im >= 0.0);
    let verified: Vec<_> = upper.map(|&root| verified(a, root, radius)).collect::<Option<_>>()?;
    let (vibrating, real): (Vec<_>, Vec<_>) = verified.into_iter().partition(vibrates);
    let [mut vibrating, _] = [in_order(vibrating)?, in_order(real)?];
    vibrating.truncate(count);
    let are_all = vibrating.len() == count
        && is_clear_of_rigid(&near, rigid)
        && (rigid == 0 || are_known_within(a, TAU * RIGID, &near))
        && are_known_within(a, radius, &near);
    are_all.then_some(vibrating)
}

/// The number of candidates below the first gap beyond this many vibrations.
fn up_to_gap(near: &[Complex<f64>], count: usize) -> Option<usize> {
    let mut vibrating = near.iter().enumerate().filter(|(_, root)| vibrates(root));
    let (last, _) = vibrating.nth(count.checked_sub(1)?)?;
    (last + 1..near.len()).find(|&next| near[next].norm() > GAP * near[next - 1].norm())
}

/// True if no candidate is near the limit between rigid motions, which come first, and vibrations.
fn is_clear_of_rigid(near: &[Complex<f64>], rigid: usize) -> bool {
    let mut around = near[..rigid].iter().chain(near.get(rigid));
    around.all(|root| !(0.5..2.0).contains(&(root.norm() / (TAU * RIGID))))
}

/// The eigenvalue near a candidate, if it lies within the circle and is of the same kind, a vibration or real.
fn verified(a: &Ordered, candidate: Complex<f64>, radius: f64) -> Option<Complex<f64>> {
    let (root, residual) = eigenvalue(a, candidate);
    let is_of_kind = if candidate.im > 0.0 {
        root.im > VIBRATING * root.norm()
    } else {
        root.im.abs() <= REAL * root.norm()
    };
    (is_of_kind && residual <= RESIDUAL * root.norm() && root.norm() < radius).then_some(root)
}

/// The eigenvalues by their moduli; `None` if two are so close that they may be the same, or that their order is in
/// doubt.
fn in_order(mut roots: Vec<Complex<f64>>) -> Option<Vec<Complex<f64>>> {
    roots.sort_by(|one, other| one.norm().total_cmp(&other.norm()));
    let are_apart = roots
        .windows(2)
        .all(|pair| pair[1].norm() > (1.0 + APART) * pair[0].norm());
    are_apart.then_some(roots)
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::super::vibrations;
    use super::lowest_vibrations;
    use crate::banded::Ordered;
    use crate::random::SplitMix;

    /// A chain of masses: the stiffness and damping of the links below each of them, per unit of mass, and which mass,
    /// or none, is below. The states are all positions, then all velocities.
    struct Chain {
        mass: Vec<f64>,
        links: Vec<(Option<usize>, usize, [f64; 2])>,
    }

    impl Chain {
        /// Each mass on the one before it, the first one on the ground.
        fn upright(length: usize, mut member: impl FnMut(usize) -> [f64; 3]) -> Self {
            let members: Vec<_> = (0..length).map(&mut member).collect();
            let links = members.iter().enumerate();
            Self {
                mass: members.iter().map(|own| own[0]).collect(),
                links: links
                    .map(|(place, own)| (place.checked_sub(1), place, [own[1], own[2]]))
                    .collect(),
            }
        }

        fn matrix(&self) -> Ordered {
            let length = self.mass.len();
            let mut nonzeros: Vec<_> = (0..length).map(|place| (place, length + place, 1.0)).collect();
            let mut add = |row: usize, column: usize, value: f64| {
                let known = nonzeros.iter_mut().find(|own| (own.0, own.1) == (row, column));
                match known {
                    Some(own) => own.2 += value,
                    None => nonzeros.push((row, column, value)),
                }
            };
            for &(below, above, law) in &self.links {
                let ends = [(below, -1.0), (Some(above), 1.0)];
                let ends = ends.into_iter().filter_map(|(at, sign)| Some((at?, sign)));
                for (row, sign) in ends.clone() {
                    for (column, other) in ends.clone() {
                        for (part, value) in law.into_iter().enumerate() {
                            let column = part * length + column;
                            add(length + row, column, -sign * other * value / self.mass[row]);
                        }
                    }
                }
            }
            Ordered::of(2 * length, &nonzeros)
        }
    }

    /// Compares with the computation of all eigenvalues; the number of modes that are certain, of `counts` requests.
    fn certain(chain: &Chain, counts: &[usize]) -> usize {
        let matrix = chain.matrix();
        let all = vibrations(&matrix);
        let found = counts.iter().filter_map(|&count| lowest_vibrations(&matrix, count));
        let are_the_same = |own: Vec<Complex<f64>>| {
            for (place, root) in own.iter().enumerate() {
                let known = all[place];
                assert!(
                    (root - known).norm() < 1e-7 * known.norm(),
                    "mode {place}: {root} {known}"
                );
            }
        };
        found.map(are_the_same).count()
    }

    fn within(random: &mut SplitMix, [low, high]: [f64; 2]) -> f64 {
        low * (high / low).powf(random.uniform())
    }

    /// Equal members, and members that differ by factors, with light and heavy damping.
    #[test]
    fn the_lowest_modes_of_chains_are_those_of_all() {
        let mut random = SplitMix::new(1);
        let mut found = 0;
        for number in 0..150 {
            let length = 30 + 10 * (number % 3);
            let spread = [1.0, 1.5, 10.0][number / 3 % 3];
            let damping = within(&mut random, [0.1, 400.0]);
            let mut vary = |of: f64| of * within(&mut random, [1.0 / spread, spread]);
            let chain = Chain::upright(length, |_| [vary(2.0), vary(4e3), vary(damping)]);
            found += certain(&chain, &[1, 2]);
        }
        assert!(found >= 250, "{found} of 300");
    }

    /// Two chains that are equal up to a small difference, and coupled by weak springs: their modes come in close pairs.
    #[test]
    fn close_modes_are_those_of_all() {
        let mut random = SplitMix::new(2);
        let mut found = 0;
        for number in 0..150 {
            let length = 30;
            let difference = within(&mut random, [1e-9, 0.3]);
            let coupling = within(&mut random, [1e-6, 1e3]);
            let damping = within(&mut random, [0.1, 100.0]);
            let mut pair = Chain::upright(2 * length, |place| match place < length {
                true => [2.0, 4e3, damping],
                false => [2.0 * (1.0 + difference), 4e3, damping * (1.0 + 3.0 * difference)],
            });
            pair.links[length].0 = None;
            let rung = |place: usize| (Some(place), length + place, [coupling, 0.0]);
            pair.links.extend((0..length).step_by(1 + number % 7).map(rung));
            found += certain(&pair, &[1, 2, 3]);
        }
        assert!(found >= 200, "{found} of 450");
    }

    /// A light absorber on a chain, tuned to its first mode: two modes whose frequencies cross as the tuning changes, or
    /// nearly coincide with damping that makes the matrix almost defective.
    #[test]
    fn modes_that_cross_are_those_of_all() {
        let mut random = SplitMix::new(3);
        let mut found = 0;
        for _ in 0..200 {
            let (length, light) = (40, within(&mut random, [1e-6, 0.3]));
            let tuned = (0.5 * std::f64::consts::PI / 40.5 * (4e3_f64 / 2.0).sqrt()).powi(2);
            let stiffness = light * tuned * (1.0 + 0.1 * (random.uniform() - 0.5));
            let damping = stiffness.sqrt() * light.sqrt() * within(&mut random, [1e-3, 1.0]);
            let chain = Chain::upright(length + 1, |place| match place == length {
                true => [light, stiffness, damping],
                false => [2.0, 4e3, 3.0],
            });
            found += certain(&chain, &[1, 2, 3]);
        }
        assert!(found >= 400, "{found} of 600");
    }

    /// A chain without ground moves as a rigid body, and two equal chains have each eigenvalue twice: there the
    /// computation of all decides.
    #[test]
    fn rigid_motions_are_no_modes_and_double_ones_are_left_in_doubt() {
        let mut free = Chain::upright(60, |place| [2.0 + 0.01 * place as f64, 4e3, 30.0]);
        free.links.remove(0);
        assert_eq!(certain(&free, &[1, 2, 5]), 3);
        let mut twins = Chain::upright(80, |_| [2.0, 4e3, 30.0]);
        twins.links[40].0 = None;
        assert_eq!(certain(&twins, &[1, 2, 5]), 0);
    }

    /// The work of a chain with more masses is that of more rows: nothing is left to the computation of all.
    #[test]
    fn long_chains_need_no_other_eigenvalues() {
        for length in [20, 40, 80, 160] {
            let matrix = Chain::upright(length, |_| [2.0, 4e3, 30.0]).matrix();
            let found = lowest_vibrations(&matrix, 1).expect("it is certain")[0];
            let frequency = 2.0 * (4e3_f64 / 2.0).sqrt() * (0.5 * std::f64::consts::PI / (2 * length + 1) as f64).sin();
            assert!((found.norm() / frequency - 1.0).abs() < 1e-9, "{length}: {found}");
        }
    }
}
