//! Power balance: what the inputs deliver, less what the links dissipate, is the growth of the stored energy.

use proptest::prelude::*;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{CoordinateId, Function, LinkId, Symbol};
use qcar_dsl::model::{CoordinateKind, Quantity, Signal, Term};
use qcar_model::Model as _;

use super::common::{self, Builder};

/// Body and wheel on a lever, a node in series, an inerter, a digressive damper and a hardening spring.
fn nonlinear_corner() -> Builder {
    let mut b = Builder::new("nonlinear_corner");
    let [
        m_body,
        m_wheel,
        k,
        c,
        v0,
        k3,
        ratio,
        inertance,
        k_tire,
        c_tire,
        k_rubber,
    ] = [
        "m_body",
        "m_wheel",
        "k",
        "c",
        "v0",
        "k3",
        "ratio",
        "inertance",
        "k_tire",
        "c_tire",
        "k_rubber",
    ]
    .map(|name| b.parameter(name));
    let pad = b.coordinate("z", "pad", CoordinateKind::Road);
    b.gravity("z");
    let (body, wheel) = (b.mass("z", "body", m_body), b.mass("z", "wheel", m_wheel));
    let rubber = b.coordinate("z", "rubber", CoordinateKind::Node);
    b.force("f_wheel", wheel);

    let tire = b.between(wheel, pad);
    b.link(
        "z",
        "tire",
        &tire,
        vec![Term::Spring(k_tire), Term::Damper(c_tire), Term::Inerter(inertance)],
    );

    let one = b.number(1.0);
    let g = &mut b.model.graph;
    let (s, v) = (g.symbol(Symbol::Stretch(LinkId(1))), g.symbol(Symbol::Rate(LinkId(1))));
    let cube = g.powi(s, 3);
    let hardening = g.mul(k3, cube);
    let speed = g.call(Function::Abs, v);
    let relative = g.div(speed, v0);
    let below = g.add(one, relative);
    let viscous = g.mul(c, v);
    let digressive = g.div(viscous, below);
    let (minus, inverse) = (g.neg(ratio), g.sub(ratio, one));
    let strut = [(body, one), (wheel, minus), (pad, inverse)];
    b.link(
        "z",
        "strut",
        &strut,
        vec![Term::Spring(k), Term::Force(hardening), Term::Force(digressive)],
    );

    let upper = b.between(body, rubber);
    b.link("z", "rubber", &upper, vec![Term::Spring(k_rubber)]);
    let lower = b.between(rubber, wheel);
    b.link("z", "series", &lower, vec![Term::Damper(c), Term::Spring(k)]);
    b
}

fn power(p: &[f64; 11], x: &[f64], u: &[f64]) -> (f64, f64) {
    let [
        m_body,
        m_wheel,
        k,
        c,
        v0,
        k3,
        ratio,
        inertance,
        k_tire,
        c_tire,
        k_rubber,
    ] = *p;
    let mut b = nonlinear_corner();
    for l in 0..4 {
        b.output(Signal::LinkForce(LinkId(l)));
    }
    b.output(Signal::Motion(CoordinateId(3), Quantity::Velocity));
    let model = b.build();
    let evaluator = Evaluator::new(&derive(model));
    let about = evaluator.about();
    assert_eq!(about.states.len(), 5);
    assert_eq!(
        about.inputs.iter().map(|i| i.name.as_ref()).collect::<Vec<_>>(),
        ["z_pad", "vz_pad", "az_pad", "f_wheel", "g"]
    );
    let mut constants = vec![0.0; about.constants];
    let (mut dx, mut y) = (vec![0.0; 5], vec![0.0; 5]);
    evaluator.prepare(p, &mut constants);
    evaluator.derivative(&constants, x, u, &mut dx);
    evaluator.outputs(&constants, x, u, &mut y);

    let &[z_body, z_wheel, v_body, v_wheel, z_rubber] = x else {
        panic!()
    };
    let &[_, _, a_body, a_wheel, v_rubber] = dx.as_slice() else {
        panic!()
    };
    let &[z_pad, v_pad, a_pad, f_wheel, gravity] = u else {
        panic!()
    };
    let strut = z_body - ratio * z_wheel + (ratio - 1.0) * z_pad;
    let strut_rate = v_body - ratio * v_wheel + (ratio - 1.0) * v_pad;
    let tire = (z_wheel - z_pad, v_wheel - v_pad, a_wheel - a_pad);
    let stored = m_body * v_body * a_body
        + m_wheel * v_wheel * a_wheel
        + inertance * tire.1 * tire.2
        + k_tire * tire.0 * tire.1
        + (k * strut + k3 * strut.powi(3)) * strut_rate
        + k_rubber * (z_body - z_rubber) * (v_body - v_rubber)
        + k * (z_rubber - z_wheel) * (v_rubber - v_wheel);
    let dissipated = c_tire * tire.1.powi(2)
        + c * strut_rate.powi(2) / (1.0 + strut_rate.abs() / v0)
        + c * (v_rubber - v_wheel).powi(2);
    // The tyre and the lever both stand on the pad; a resisting force pulls the lower end up.
    let delivered = f_wheel * v_wheel - gravity * (m_body * v_body + m_wheel * v_wheel) - y[0] * v_pad
        + y[1] * (ratio - 1.0) * v_pad;
    assert_eq!(y[4], v_rubber);
    (delivered, stored + dissipated)
}

proptest! {
    #![proptest_config(common::cases(200))]

    #[test]
    fn power_is_conserved(
        p in prop::array::uniform11(0.5..2.0f64),
        x in prop::array::uniform5(-1.0..1.0f64),
        u in prop::array::uniform5(-1.0..1.0f64),
    ) {
        let (delivered, used) = power(&p, &x, &u);
        prop_assert!((delivered - used).abs() < 1e-11 * (1.0 + delivered.abs()), "{delivered} {used}");
    }
}
