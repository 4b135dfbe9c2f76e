//! Nonlinear laws and rolling tyres: equations written out by hand over dual numbers, and finite differences of those.

use proptest::prelude::*;
use qcar_dsl::check::Checked;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{Function, LinkId, Symbol};
use qcar_dsl::model::{CoordinateKind, Quantity, Signal, Term};
use qcar_model::{Contact, Matrix, Model as _};

use super::common::{self, Builder, assert_close};

const PARAMETERS: [&str; 9] = ["m_body", "m_wheel", "k", "c", "v0", "f_c", "sigma", "k_tire", "ratio"];

/// A body on a lever strut with a digressive damper and Dahl friction; the tyre hardens, and rolls with another law.
fn corner() -> Checked {
    let mut b = Builder::new("corner");
    let [m_body, m_wheel, k, c, v0, f_c, sigma, k_tire, ratio] = PARAMETERS.map(|name| b.parameter(name));
    let pad = b.coordinate("z", "pad", CoordinateKind::Road);
    b.gravity("z");
    let (body, wheel) = (b.mass("z", "body", m_body), b.mass("z", "wheel", m_wheel));
    let (body_x, wheel_x) = (b.mass("x", "body", m_body), b.mass("x", "wheel", m_wheel));

    let one = b.number(1.0);
    let l = b.next_link();
    let g = &mut b.model.graph;
    let (s, v, friction) = (
        g.symbol(Symbol::Stretch(l)),
        g.symbol(Symbol::Rate(l)),
        g.symbol(Symbol::Inner(l, 0)),
    );
    let speed = g.call(Function::Abs, v);
    let relative = g.div(speed, v0);
    let below = g.add(one, relative);
    let viscous = g.mul(c, v);
    let digressive = g.div(viscous, below);
    let elastic = g.mul(k, s);
    let damped = g.add(elastic, digressive);
    let force = g.add(damped, friction);
    let saturation = g.div(friction, f_c);
    let sliding = g.mul(speed, saturation);
    let sticking = g.sub(v, sliding);
    let rate = g.mul(sigma, sticking);
    let stretch = [(body, one), (wheel, g.neg(ratio))];
    b.link_with_states("z", "strut", &stretch, vec![Term::Force(force)], &[rate]);

    let tire = b.between(wheel, pad);
    let g = &mut b.model.graph;
    let s = g.symbol(Symbol::Stretch(LinkId(1)));
    let square = g.powi(s, 2);
    let harder = g.add(one, square);
    let elastic = g.mul(k_tire, s);
    let hardening = g.mul(elastic, harder);
    b.link("z", "tire", &tire, vec![Term::Force(hardening)]);
    b.model.links[1].rolling = Some(vec![Term::Spring(k_tire), Term::Damper(c)]);

    let bushing = b.between(wheel_x, body_x);
    b.link("x", "bushing", &bushing, vec![Term::Spring(k), Term::Damper(c)]);
    b.output(Signal::LinkForce(LinkId(0)));
    b.output(Signal::LinkForce(LinkId(1)));
    b.output(Signal::LinkStretch(LinkId(1)));
    b.output(Signal::Motion(body, Quantity::Acceleration));
    b.build()
}

/// A number and its derivative along one direction.
#[derive(Clone, Copy)]
struct Dual(f64, f64);

macro_rules! arithmetic {
    ($($trait:ident $method:ident |$a:ident, $b:ident| $result:expr;)*) => {
        $(impl std::ops::$trait for Dual {
            type Output = Dual;
            fn $method(self, $b: Dual) -> Dual {
                let $a = self;
                $result
            }
        })*
    };
}

arithmetic! {
    Add add |a, b| Dual(a.0 + b.0, a.1 + b.1);
    Sub sub |a, b| Dual(a.0 - b.0, a.1 - b.1);
    Mul mul |a, b| Dual(a.0 * b.0, a.1 * b.0 + a.0 * b.1);
    Div div |a, b| Dual(a.0 / b.0, (a.1 - a.0 / b.0 * b.1) / b.0);
}

impl Dual {
    fn abs(self) -> Dual {
        if self.0 < 0.0 { Dual(-self.0, -self.1) } else { self }
    }
}

/// f then h, written out. Where the tyre rolls, `contact` is its stretch, its rate, and its forces in z and x.
fn equations(p: &[Dual], x: &[Dual], u: &[Dual], contact: Option<[Dual; 4]>) -> Vec<Dual> {
    let &[m_body, m_wheel, k, c, v0, f_c, sigma, k_tire, ratio] = p else {
        panic!()
    };
    let &[
        z_body,
        z_wheel,
        x_body,
        x_wheel,
        vz_body,
        vz_wheel,
        vx_body,
        vx_wheel,
        friction,
    ] = x
    else {
        panic!()
    };
    let &[z_pad, _, gravity] = u else { panic!() };
    let (one, zero) = (Dual(1.0, 0.0), Dual(0.0, 0.0));
    let (s, v) = (z_body - ratio * z_wheel, vz_body - ratio * vz_wheel);
    let strut = k * s + c * v / (one + v.abs() / v0) + friction;
    let (stretch, tire, lift, push) = match contact {
        None => {
            let s = z_wheel - z_pad;
            let force = k_tire * s * (one + s * s);
            (s, force, zero - force, zero)
        }
        Some([s, v, lift, push]) => (s, k_tire * s + c * v, lift, push),
    };
    let bushing = k * (x_wheel - x_body) + c * (vx_wheel - vx_body);
    let a_body = (zero - strut) / m_body - gravity;
    vec![
        vz_body,
        vz_wheel,
        vx_body,
        vx_wheel,
        a_body,
        (ratio * strut + lift) / m_wheel - gravity,
        bushing / m_body,
        (push - bushing) / m_wheel,
        sigma * (v - v.abs() * friction / f_c),
        strut,
        tire,
        stretch,
        a_body,
    ]
}

/// Values and, for each of `p`, `x`, `u` in turn, derivatives.
fn differentiate(p: &[f64], x: &[f64], u: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let all: Vec<f64> = [p, x, u].concat();
    let (n, m) = (p.len(), p.len() + x.len());
    let along = |which: usize| {
        let dual: Vec<Dual> = all
            .iter()
            .enumerate()
            .map(|(i, &v)| Dual(v, f64::from(i == which)))
            .collect();
        equations(&dual[..n], &dual[n..m], &dual[m..], None)
    };
    let columns = (0..all.len())
        .map(|which| along(which).iter().map(|d| d.1).collect())
        .collect();
    (along(0).iter().map(|d| d.0).collect(), columns)
}

/// The Jacobian by x and u as the matrices of the evaluator give it, column after column.
fn matrices(evaluator: &Evaluator, p: &[f64], x: &[f64], u: &[f64]) -> Vec<Vec<f64>> {
    let about = evaluator.about();
    let mut nonzeros = vec![0.0; about.matrices.len()];
    evaluator.matrices(p, x, u, &mut nonzeros);
    let mut columns = vec![vec![0.0; 13]; 12];
    for (entry, &value) in about.matrices.iter().zip(&nonzeros) {
        place(&mut columns, entry.matrix, entry.row, entry.column, value);
    }
    columns
}

fn place(columns: &mut [Vec<f64>], matrix: Matrix, row: u16, column: u16, value: f64) {
    let row = usize::from(row) + if matches!(matrix, Matrix::C | Matrix::D) { 9 } else { 0 };
    let column = usize::from(column) + if matches!(matrix, Matrix::B | Matrix::D) { 9 } else { 0 };
    columns[column][row] = value;
}

fn evaluator() -> Evaluator {
    let evaluator = Evaluator::new(&derive(corner()));
    assert!(!evaluator.about().linear);
    assert!(evaluator.about().responses.is_empty());
    evaluator
}

fn constants(evaluator: &Evaluator, p: &[f64]) -> Vec<f64> {
    let mut constants = vec![0.0; evaluator.about().constants];
    evaluator.prepare(p, &mut constants);
    constants
}

proptest! {
    #![proptest_config(common::cases(100))]

    #[test]
    fn jacobians_are_those_of_dual_numbers(
        p in prop::array::uniform9(0.5..2.0f64),
        x in prop::array::uniform9(-1.0..1.0f64),
        u in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let evaluator = evaluator();
        let constants = constants(&evaluator, &p);
        let (values, columns) = differentiate(&p, &x, &u);
        let mut got = [0.0; 13];
        evaluator.derivative(&constants, &x, &u, &mut got[..9]);
        evaluator.outputs(&constants, &x, &u, &mut got[9..]);
        assert_close("f, h", &got, &values, 1e-12, 1e-3);
        for (got, want) in matrices(&evaluator, &p, &x, &u).iter().zip(&columns[9..]) {
            assert_close("df/dx, df/du", got, want, 1e-11, 1e-3);
        }
        let about = evaluator.about();
        let mut nonzeros = vec![0.0; about.parameter_jacobian.len()];
        evaluator.parameter_jacobian(&p, &x, &u, &mut nonzeros);
        let mut got = vec![vec![0.0; 13]; 9];
        for (&(is_output, row, p), &value) in about.parameter_jacobian.iter().zip(&nonzeros) {
            got[usize::from(p)][usize::from(row) + if is_output { 9 } else { 0 }] = value;
        }
        for (got, want) in got.iter().zip(&columns) {
            assert_close("df/dp", got, want, 1e-11, 1e-3);
        }
    }

    #[test]
    fn sensitivities_are_the_slopes_of_the_matrices(
        p in prop::array::uniform9(0.5..2.0f64),
        x in prop::array::uniform9(-1.0..1.0f64),
        u in prop::array::uniform3(-1.0..1.0f64),
    ) {
        let evaluator = evaluator();
        let about = evaluator.about();
        let mut nonzeros = vec![0.0; about.sensitivities.len()];
        evaluator.sensitivities(&p, &x, &u, &mut nonzeros);
        for which in 0..9 {
            let mut got = vec![vec![0.0; 13]; 12];
            for (&(entry, p), &value) in about.sensitivities.iter().zip(&nonzeros) {
                if usize::from(p) == which {
                    place(&mut got, entry.matrix, entry.row, entry.column, value);
                }
            }
            let step = 1e-5;
            let (mut up, mut down) = (p, p);
            up[which] += step;
            down[which] -= step;
            // The rate changes its sign with the lever's ratio there: no slope.
            prop_assume!((x[4] - up[8] * x[5]) * (x[4] - down[8] * x[5]) > 0.0);
            let (up, down) = (matrices(&evaluator, &up, &x, &u), matrices(&evaluator, &down, &x, &u));
            for ((got, up), down) in got.iter().zip(&up).zip(&down) {
                let want: Vec<f64> = up.iter().zip(down).map(|(up, down)| (up - down) / (2.0 * step)).collect();
                assert_close("dA, dB, dC, dD", got, &want, 1e-6, 1.0);
            }
        }
    }

    #[test]
    fn a_rolling_tyre_pushes_its_wheel(
        p in prop::array::uniform9(0.5..2.0f64),
        x in prop::array::uniform9(-1.0..1.0f64),
        u in prop::array::uniform3(-1.0..1.0f64),
        contact in prop::array::uniform4(-1.0..1.0f64),
    ) {
        let evaluator = evaluator();
        let constants = constants(&evaluator, &p);
        let number = |v: &[f64]| v.iter().map(|&v| Dual(v, 0.0)).collect::<Vec<_>>();
        let want = equations(&number(&p), &number(&x), &number(&u), Some(contact.map(|v| Dual(v, 0.0))));
        let want: Vec<f64> = want.iter().map(|d| d.0).collect();
        let [s, v, lift, push] = contact;
        let mut got = [0.0; 13];
        let contact = Contact { s, v, force: [lift, push] };
        evaluator.rolling_derivative(&constants, &x, &u, &contact, &mut got[..9]);
        evaluator.rolling_outputs(&constants, &x, &u, &contact, &mut got[9..]);
        assert_close("rolling f, h", &got, &want, 1e-12, 1e-3);
        let force = evaluator.contact_force(&constants, &x, s, v);
        assert_close("contact force", &[force], &want[10..11], 1e-12, 1e-3);
    }
}

#[test]
fn a_rolling_tyre_says_where_its_wheel_is() {
    let evaluator = evaluator();
    let contact = evaluator.about().contact.clone().unwrap();
    assert_eq!(contact.link, 1);
    let axes: Vec<_> = contact
        .axes
        .iter()
        .map(|axis| (axis.axis.as_ref(), axis.position, axis.velocity))
        .collect();
    assert_eq!(axes, [("z", 1, 5), ("x", 3, 7)]);
}

#[test]
fn a_tyre_has_a_force_though_nobody_sees_it() {
    let p = [
        586.1, 33.1, 5.1, 24.1, 53.4, 55300.0, 4140.0, 0.625, 0.672, 535e3, 843.0, 644e3, 842.0, 390e3, 561.0, 250e3,
        200.0,
    ];
    let evaluator = Evaluator::new(&derive(common::axle_d()));
    let force = evaluator.contact_force(&constants(&evaluator, &p), &[0.0; 10], -0.02, 0.3);
    assert_close("contact force", &[force], &[-0.02 * 250e3 + 0.3 * 200.0], 1e-14, 0.0);
}
