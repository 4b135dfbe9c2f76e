//! The dynamic stiffness of a link: its force for a harmonic stretch of unit amplitude.
//!
//! Inner states belong to one link, so they are eliminated here, and the system of coordinates stays symmetric:
//! κ(ω) = k + jωc - ω²b + f_zᵀ (jω - G)⁻¹ (g_s + jω g_v) for a law f(s, v, z) with dz/dt = g(s, v, z).

use crate::check::Checked;
use crate::complex::Complex;
use crate::elimination::Scalar;
use crate::expr::{Differential, Expr, Graph, LinkId, Symbol};
use crate::law;

/// The parts of the dynamic stiffness of a link.
#[derive(Clone, Copy, Debug)]
pub struct Stiffness {
    /// k, N/m
    pub stiffness: Expr,
    /// c, N s/m
    pub damping: Expr,
    /// b, kg
    pub inertance: Expr,
    /// What the inner states add, N/m.
    pub relaxation: Complex,
    /// The sum of all, N/m.
    pub total: Complex,
}

/// The dynamic stiffness of a link whose law is linear.
pub fn of_link(model: &Checked, g: &mut Graph, l: LinkId) -> Stiffness {
    let law = law::standing(model, g, l);
    let relaxation = relaxation(model, g, l, law.force);
    let omega = g.symbol(Symbol::Frequency);
    let square = g.powi(omega, 2);
    let inertia = g.mul(square, law.inertance);
    let local = Complex {
        re: g.sub(law.stiffness, inertia),
        im: g.mul(omega, law.damping),
    };
    let total = local.add(g, relaxation);
    Stiffness {
        stiffness: law.stiffness,
        damping: law.damping,
        inertance: law.inertance,
        relaxation,
        total,
    }
}

fn relaxation(model: &Checked, g: &mut Graph, l: LinkId, force: Expr) -> Complex {
    let inner = &model.links[l.0 as usize].law.inner;
    let omega = g.symbol(Symbol::Frequency);
    let slope = |g: &mut Graph, e, leaf| Differential::by(g, leaf).of(g, e);
    let mut matrix = Vec::with_capacity(inner.len());
    let mut given = Vec::with_capacity(inner.len());
    for (row, state) in inner.iter().enumerate() {
        let by_rate = slope(g, state.rate, Symbol::Rate(l));
        given.push(Complex {
            re: slope(g, state.rate, Symbol::Stretch(l)),
            im: g.mul(omega, by_rate),
        });
        let entries = (0..inner.len()).map(|column| {
            let own = slope(g, state.rate, Symbol::Inner(l, column as u16));
            let zero = g.constant(0.0);
            Complex {
                re: g.neg(own),
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
