//! A link on a dynamometer: its law by itself, with the parameters of the whole model.

use qcar_dsl::compile::{check, derive, derive_alone};
use qcar_dsl::evaluate::Evaluator;
use qcar_model::Model as _;

use super::common::text;

/// A top mount without mass, of which nothing is left on the dynamometer, and laws that cannot stand there.
const CORNER: &str = "
axle corner {
    param k: N/m = 25 N/mm in 1 N/mm..100 N/mm;
    param k_top: N/m = 500 N/mm in 50 N/mm..5 kN/mm;
    param c: N s/m = 1500 in 10..9000;
    param v_0: m/s = 0.3 in 0.01..5;
    known param lever: 1 = 0.7;
    direction z {
        motion wheel;
        mass body = 390 kg;
        node top;
        force demand;
        link spring: body - wheel { spring k; }
        link mount: body - top { spring k_top; }
        link damper: top - lever*wheel { damper c; }
        link digressive: body - wheel { force = c*v/(1 + abs(v)/v_0); }
        link actuator: body - wheel { force = -demand; }
        output body.acceleration;
    }
}";

#[test]
fn a_link_alone_is_its_law_with_the_parameters_of_the_model() {
    let model = check(text(CORNER), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    let whole = Evaluator::new(&derive(model.clone()));
    let names = |about: &qcar_model::About| {
        about
            .parameters
            .iter()
            .map(|own| own.name.to_string())
            .collect::<Vec<_>>()
    };
    let p = [25e3, 500e3, 1500.0, 0.3, 0.7];
    let force = |link: &str| {
        let alone = Evaluator::new(&derive_alone(&model, "z", link).unwrap_or_else(|| panic!("{link} stands alone")));
        let about = alone.about();
        assert_eq!(names(about), names(whole.about()));
        assert!(about.states.is_empty() && about.outputs.len() == 1, "{about:?}");
        let mut constants = vec![0.0; about.constants];
        alone.prepare(&p, &mut constants);
        let u: Vec<f64> = about
            .inputs
            .iter()
            .map(|own| if own.name.starts_with('v') { 0.5 } else { 0.01 })
            .collect();
        let mut y = [0.0];
        alone.outputs(&constants, &[], &u, &mut y);
        y[0]
    };
    // Its lever is that of its ends, not of its stretch.
    assert!((force("damper") - 1500.0 * 0.5).abs() < 1e-9);
    assert!((force("mount") - 500e3 * 0.01).abs() < 1e-9);
    assert!((force("digressive") - 1500.0 * 0.5 / (1.0 + 0.5 / 0.3)).abs() < 1e-9);
}

#[test]
fn what_needs_the_rest_of_its_model_does_not_stand_alone() {
    let model = check(text(CORNER), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    for (axis, link) in [("z", "actuator"), ("z", "nothing"), ("x", "damper")] {
        assert!(derive_alone(&model, axis, link).is_none(), "{link} along {axis}");
    }
    let coupled = "
        axle coupled {
            param k: N/m = 300 in 1..1e5;
            known param limit: m = 0.01;
            direction z { motion ground; mass body = 3 kg; link own: body - ground { force = k*s*(1 + (s^2 + x.own.stretch^2)/limit^2); } }
            direction x { motion ground; mass body = 3 kg; link own: body - ground { force = k*s*(1 + (s^2 + z.own.stretch^2)/limit^2); } }
        }";
    let model = check(text(coupled), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    assert!(derive_alone(&model, "z", "own").is_none());
}
