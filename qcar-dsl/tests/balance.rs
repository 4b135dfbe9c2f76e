//! The equations hold: whatever a model computes of itself obeys its laws, Newton, and the balance of its nodes, and
//! each velocity is the slope of its position along the motion. No derivation is repeated here.

use proptest::prelude::*;
use qcar_dsl::check::Checked;
use qcar_dsl::compile::derive;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::expr::{CoordinateId, Expr, LinkId, Symbol};
use qcar_dsl::model::{CoordinateKind, Quantity, Signal, Term};
use qcar_model::Model as _;

use super::common::random::plan;
use super::common::{self, Builder, assert_close};

/// What a random model shows: of each coordinate and each link.
struct Seen {
    motion: Vec<[f64; 3]>,
    force: Vec<f64>,
    stretch: Vec<f64>,
}

/// The outputs at one instant.
fn see(model: &Checked, evaluator: &Evaluator, p: &[f64], x: &[f64], u: &[f64]) -> Seen {
    let about = evaluator.about();
    let (mut constants, mut y) = (vec![0.0; about.constants], vec![0.0; about.outputs.len()]);
    evaluator.prepare(p, &mut constants);
    evaluator.outputs(&constants, x, u, &mut y);
    let mut seen = Seen {
        motion: vec![[f64::NAN; 3]; model.coordinates.len()],
        force: vec![f64::NAN; model.links.len()],
        stretch: vec![f64::NAN; model.links.len()],
    };
    for (output, value) in model.outputs.iter().zip(y) {
        match output.signal {
            Signal::Motion(c, quantity) => seen.motion[c.0 as usize][quantity as usize] = value,
            Signal::Point(..) => {}
            Signal::LinkForce(l) => seen.force[l.0 as usize] = value,
            Signal::LinkStretch(l) => seen.stretch[l.0 as usize] = value,
        }
    }
    seen
}

fn judge(model: &Checked, p: &[f64]) {
    let compiled = derive(model.clone());
    let (evaluator, vectors) = (Evaluator::new(&compiled), &compiled.vectors);
    let about = evaluator.about();
    let x: Vec<f64> = (0..about.states.len()).map(|i| (1.0 + i as f64).sin()).collect();
    let u: Vec<f64> = (0..about.inputs.len()).map(|i| (2.0 + 3.0 * i as f64).cos()).collect();
    let at = |symbol| vectors.input(symbol);
    let now = see(model, &evaluator, p, &x, &u);
    let inner = |symbol| x[vectors.state(symbol).unwrap()];
    let gravity = u[at(Symbol::Gravity(0)).unwrap()];
    let force = |i: u16| at(Symbol::Force(i)).map_or(0.0, |place| u[place]);
    let parameter = |e: Expr| {
        model.graph.evaluate(e, &|symbol| match symbol {
            Symbol::Parameter(i) => p[i as usize],
            other => panic!("{other:?}"),
        })
    };

    let mut balance = vec![0.0; model.coordinates.len()];
    for (i, input) in (0..).zip(&model.forces) {
        for &(c, coefficient) in &input.on {
            balance[c.0 as usize] += parameter(coefficient) * force(i);
        }
    }
    for (l, link) in model.links.iter().enumerate() {
        let along = |order: usize| -> f64 {
            link.stretch
                .iter()
                .map(|&(c, coefficient)| parameter(coefficient) * now.motion[c.0 as usize][order])
                .sum()
        };
        let [s, v, a] = [0, 1, 2].map(along);
        let law = |e: Expr| {
            model.graph.evaluate(e, &|symbol| match symbol {
                Symbol::Parameter(i) => p[i as usize],
                Symbol::Stretch(_) => s,
                Symbol::Rate(_) => v,
                Symbol::Force(i) => force(i),
                state => inner(state),
            })
        };
        let terms = link.law.terms.iter().map(|&term| match term {
            Term::Spring(k) => parameter(k) * s,
            Term::Damper(c) => parameter(c) * v,
            Term::Inerter(b) => parameter(b) * a,
            Term::Force(e) => law(e),
        });
        assert_close("law", &[now.force[l], now.stretch[l]], &[terms.sum(), s], 1e-9, 1e-2);
        for &(c, coefficient) in &link.stretch {
            balance[c.0 as usize] -= parameter(coefficient) * now.force[l];
        }
    }
    for (c, coordinate) in model.coordinates.iter().enumerate() {
        let inertia = match coordinate.kind {
            CoordinateKind::Mass(inertia) => parameter(inertia) * (now.motion[c][2] + gravity),
            CoordinateKind::Node => 0.0,
            _ => continue,
        };
        assert!(
            (balance[c] - inertia).abs() < 1e-8,
            "{}: {} is not {inertia}",
            coordinate.name,
            balance[c]
        );
    }

    // A little later: what is prescribed moves on as its velocity and acceleration say.
    let mut constants = vec![0.0; about.constants];
    let mut dx = vec![0.0; x.len()];
    evaluator.prepare(p, &mut constants);
    evaluator.derivative(&constants, &x, &u, &mut dx);
    let road = [Symbol::Position, Symbol::Velocity, Symbol::Acceleration].map(|of| at(of(CoordinateId(0))));
    let du = |order: usize| road[order + 1].map_or(0.0, |place| u[place]);
    let step = 1e-5;
    let mut later = u.clone();
    for order in 0..2 {
        later[road[order].unwrap()] += step * du(order);
    }
    let moved: Vec<f64> = x.iter().zip(&dx).map(|(x, dx)| x + step * dx).collect();
    let after = see(model, &evaluator, p, &moved, &later);
    for c in 0..model.coordinates.len() {
        for order in 0..2 {
            let slope = (after.motion[c][order] - now.motion[c][order]) / step;
            let want = now.motion[c][order + 1];
            if !want.is_nan() {
                let close = (slope - want).abs() < 1e-4 * want.abs().max(1.0);
                assert!(close, "{}: {slope} is not {want}", model.coordinates[c].name);
            }
        }
    }
}

proptest! {
    #![proptest_config(common::cases(100))]

    #[test]
    fn random_models_obey_their_laws(plan in plan()) {
        let (model, p) = plan.build_with_groups();
        judge(&model, &p);
    }
}

/// A damper between two rubbers without mass: one force goes through all three.
#[test]
fn a_damper_between_two_springs_is_one_force() {
    let mut b = Builder::new("strut");
    let [m, k1, c, k2] = ["m", "k1", "c", "k2"].map(|name| b.parameter(name));
    let road = b.coordinate("z", "road", CoordinateKind::Road);
    let mass = b.mass("z", "mass", m);
    let [upper, lower] = ["upper", "lower"].map(|name| b.coordinate("z", name, CoordinateKind::Node));
    for (name, top, bottom, term) in [
        ("top", mass, upper, Term::Spring(k1)),
        ("damper", upper, lower, Term::Damper(c)),
        ("bottom", lower, road, Term::Spring(k2)),
    ] {
        let stretch = b.between(top, bottom);
        b.link("z", name, &stretch, vec![term]);
    }
    b.output(Signal::LinkForce(LinkId(1)));
    b.output(Signal::Motion(lower, Quantity::Position));
    let evaluator = Evaluator::new(&derive(b.build()));
    let about = evaluator.about();
    let names: Vec<&str> = about.states.iter().map(|state| state.name.as_ref()).collect();
    assert_eq!(names, ["z_mass", "vz_mass", "z_upper_offset"]);

    let p @ [m, k1, c, k2] = [2.0, 30.0, 4.0, 50.0];
    let (x, u) = ([0.3, -0.2, 0.1], [0.05, 0.7]);
    let (mut constants, mut dx, mut y) = (vec![0.0; about.constants], [0.0; 3], [0.0; 2]);
    evaluator.prepare(&p, &mut constants);
    evaluator.derivative(&constants, &x, &u, &mut dx);
    evaluator.outputs(&constants, &x, &u, &mut y);
    let force = (x[0] - x[2] - u[0]) / (1.0 / k1 + 1.0 / k2);
    assert_close("rates", &dx, &[x[1], -force / m, force / c], 1e-12, 0.0);
    assert_close("outputs", &y, &[force, u[0] + force / k2], 1e-12, 0.0);
}
