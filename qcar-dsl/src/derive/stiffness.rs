//! The dynamic stiffness of a link: its force for a harmonic stretch of unit amplitude.
//!
//! Inner states belong to one link, so they are eliminated here, and the system of coordinates stays symmetric: κ(ω) =
//! k + jωc - ω²b + f_zᵀ (jω - G)⁻¹ (g_s + jω g_v) for a law f(s, v, z, u) with dz/dt = g(s, v, z, u). A force input u
//! that the law uses adds φ(ω) = f_u + f_zᵀ (jω - G)⁻¹ g_u.

use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::elimination::Scalar;
use crate::derive::law;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};

/// The parts of the dynamic stiffness of a link.
#[derive(Clone, Debug)]
pub struct Stiffness {
    /// k, N/m
    pub stiffness: Expr,
    /// c, N s/m
    pub damping: Expr,
    /// b, kg
    pub inertance: Expr,
    /// Contribution of the inner states, N/m.
    pub relaxation: Complex,
    /// The sum of all, N/m.
    pub total: Complex,
    /// The force for a unit of each force input in the law, by its position in `Model::forces`, without motion.
    pub inputs: Vec<(u16, Complex)>,
}

/// The dynamic stiffness of a link whose law is linear.
pub fn of_link(model: &Checked, g: &mut Graph, l: LinkId) -> Stiffness {
    let law = law::standing(model, g, l);
    let relaxation = relaxation(model, g, l, law.force);
    let inputs = inputs(model, g, l, law.force);
    let omega = g.symbol(Symbol::Frequency);
    let inertia = g.of(omega.power(2) * law.inertance);
    let local = Complex {
        re: g.of(law.stiffness - inertia),
        im: g.of(omega * law.damping),
    };
    let total = local.add(g, relaxation);
    Stiffness {
        stiffness: law.stiffness,
        damping: law.damping,
        inertance: law.inertance,
        relaxation,
        total,
        inputs,
    }
}

fn relaxation(model: &Checked, g: &mut Graph, l: LinkId, force: Expr) -> Complex {
    let omega = g.symbol(Symbol::Frequency);
    through_states(model, g, l, force, |g, rate| {
        let by_rate = slope(g, rate, Symbol::Rate(l));
        Complex {
            re: slope(g, rate, Symbol::Stretch(l)),
            im: g.of(omega * by_rate),
        }
    })
}

fn inputs(model: &Checked, g: &mut Graph, l: LinkId, force: Expr) -> Vec<(u16, Complex)> {
    let used = model.links[l.0 as usize].law.force_inputs(&model.graph);
    let response = |input| {
        let leaf = Symbol::Force(input);
        let by_states = through_states(model, g, l, force, |g, rate| {
            let driven = slope(g, rate, leaf);
            Complex::real(g, driven)
        });
        let direct = slope(g, force, leaf);
        let direct = Complex::real(g, direct);
        (input, direct.add(g, by_states))
    };
    used.into_iter().map(response).collect()
}

fn slope(g: &mut Graph, e: Expr, leaf: Symbol) -> Expr {
    Differential::by(g, leaf).of(g, e)
}

/// Contribution of the inner states to a force if the rate of each is driven.
fn through_states(
    model: &Checked,
    g: &mut Graph,
    l: LinkId,
    force: Expr,
    drive: impl Fn(&mut Graph, Expr) -> Complex,
) -> Complex {
    let inner = &model.links[l.0 as usize].law.inner;
    let omega = g.symbol(Symbol::Frequency);
    let mut matrix = Vec::with_capacity(inner.len());
    let mut given = Vec::with_capacity(inner.len());
    for (row, state) in inner.iter().enumerate() {
        given.push(drive(g, state.rate));
        let entries = (0..inner.len()).map(|column| {
            let own = slope(g, state.rate, Symbol::Inner(l, column as u16));
            let zero = g.constant(0.0);
            Complex {
                re: g.of(-own),
                im: if row == column { omega } else { zero },
            }
        });
        matrix.push(entries.collect());
    }
    let amplitudes = solve(g, matrix, given);
    let mut sum = Complex::zero(g);
    for (i, amplitude) in amplitudes.into_iter().enumerate() {
        let share = slope(g, force, Symbol::Inner(l, i as u16));
        let term = amplitude.scale(g, share);
        sum = sum.add(g, term);
    }
    sum
}

/// Gauss elimination of a few unknowns.
fn solve(g: &mut Graph, mut a: Vec<Vec<Complex>>, mut b: Vec<Complex>) -> Vec<Complex> {
    let n = b.len();
    for pivot in 0..n {
        let above = a[pivot].clone();
        for row in pivot + 1..n {
            let factor = a[row][pivot].div(g, above[pivot]);
            for (entry, &above) in a[row].iter_mut().zip(&above) {
                let product = factor.mul(g, above);
                *entry = entry.sub(g, product);
            }
            let product = factor.mul(g, b[pivot]);
            b[row] = b[row].sub(g, product);
        }
    }
    for row in (0..n).rev() {
        for column in row + 1..n {
            let product = a[row][column].mul(g, b[column]);
            b[row] = b[row].sub(g, product);
        }
        b[row] = b[row].div(g, a[row][row]);
    }
    b
}
