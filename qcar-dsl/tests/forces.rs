//! Force inputs between points and in laws, and links that may give energy, against closed forms.

use nalgebra::Complex;
use qcar_dsl::check::check_text;
use qcar_dsl::compile::derive;
use qcar_dsl::diagnostic::{Code, Severity};
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::show::{Stage, show};
use qcar_model::{Model as _, ResponseMut};

use super::common::{assert_close, text};

const OMEGA: [f64; 4] = [1.0, 7.0, 30.0, 200.0];

/// The response of the first output to an excitation, at the defaults.
fn response(model: &str, excitation: &str) -> Vec<Complex<f64>> {
    let checked = check_text(text(model), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    let evaluator = Evaluator::new(&derive(checked));
    let about = evaluator.about();
    let value = |of: &qcar_model::Parameter| match of.default {
        qcar_dsl::model::Default::Value(value) => value,
        other => panic!("{other:?}"),
    };
    let p: Vec<f64> = about.parameters.iter().map(value).collect();
    let place = about.excitations.iter().position(|own| own.name == excitation).unwrap();
    let layout = &about.responses[place];
    let row = layout.outputs.iter().position(|&output| output == 0).unwrap();
    let mut constants = vec![0.0; about.constants];
    evaluator.prepare(&p, &mut constants);
    let n = OMEGA.len();
    let (mut re, mut im) = (vec![0.0; n * layout.outputs.len()], vec![0.0; n * layout.outputs.len()]);
    evaluator.response(
        place,
        &constants,
        &OMEGA,
        ResponseMut {
            re: &mut re,
            im: &mut im,
            jacobian: None,
        },
    );
    (row * n..(row + 1) * n).map(|i| Complex::new(re[i], im[i])).collect()
}

fn close(got: &[Complex<f64>], want: impl Fn(Complex<f64>) -> Complex<f64>) {
    let parts = |values: &[Complex<f64>]| -> Vec<f64> { values.iter().flat_map(|z| [z.re, z.im]).collect() };
    let want: Vec<_> = OMEGA.iter().map(|&omega| want(Complex::new(0.0, omega))).collect();
    assert_close("response", &parts(got), &parts(&want), 1e-11, 0.0);
}

fn pair(more: &str) -> String {
    format!(
        "element delayed(wanted: N, delay: s) {{
            active;
            state z: N;
            rate z = 2*(wanted - z)/delay;
            force = 2*z - wanted;
        }}
        axle pair {{
            known param m: kg = 3;
            param k: N/m = 500 in 1..1e4;
            param c: N s/m = 8 in 1..100;
            let lag = 0.1 s;
            direction z {{
                motion ground;
                mass left = m;
                mass right = m;
                link hold_left: left - ground {{ spring k; damper c; }}
                link hold_right: right - ground {{ spring k; damper c; }}
                {more}
            }}
        }}"
    )
}

/// Two equal masses, each on a spring and damper: what pushes them apart moves each by itself.
#[test]
fn a_force_between_two_points_pushes_them_apart() {
    let alone = |s: Complex<f64>| s * s / (s * s * 3.0 + s * 8.0 + 500.0);
    let shown = "output left.acceleration; output right.acceleration;";
    let model = pair(&format!("force apart on left - right; {shown}"));
    close(&response(&model, "apart"), alone);
    let model = pair(&format!("force apart on right - 0.5*left; {shown}"));
    close(&response(&model, "apart"), |s| alone(s) * -0.5);
}

/// A demand that a link of its own follows with a lag of first order.
#[test]
fn a_law_follows_a_force_input_with_a_lag() {
    let model = pair(
        "force demand; output left.acceleration; output actuator.force;
         link actuator: left - right { state f: N; rate f = (demand - f)/lag; force = -f; }",
    );
    close(&response(&model, "demand"), |s| {
        s * s / (s * s * 3.0 + s * 8.0 + 500.0) / (s * 0.1 + 1.0)
    });
}

/// The force of a link holds what its input does at once: here all of it, since the link has nothing else.
#[test]
fn the_force_of_a_link_shows_its_input() {
    let model = pair(
        "force demand; output actuator.force; output left.acceleration;
         link actuator: left - right { state f: N; rate f = (demand - f)/lag; force = -3*demand - f; }",
    );
    close(&response(&model, "demand"), |s| {
        -(Complex::new(1.0, 0.0) / (s * 0.1 + 1.0) + 3.0)
    });
}

/// Padé's approximation of a damper's force that comes late.
#[test]
fn an_active_element_delays_a_force() {
    let model = pair(
        "output left.acceleration; output right.acceleration;
         force f on left;
         link late: left { delayed(40 N s/m*v, lag); }",
    );
    close(&response(&model, "f"), |s| {
        let late = s * 40.0 * (s * -0.05 + 1.0) / (s * 0.05 + 1.0);
        s * s / (s * s * 3.0 + s * 8.0 + 500.0 + late)
    });
}

fn codes(model: &str) -> Vec<Code> {
    match check_text(text(model), &|_, _| Err(String::new())) {
        Ok(_) => vec![],
        Err(report) => {
            let errors = report.diagnostics.iter().filter(|own| own.severity == Severity::Error);
            errors.map(|own| own.code).collect()
        }
    }
}

/// What gives energy is refused unless the link says `active`, and every other link beside it still is.
#[test]
fn only_what_is_called_active_may_give_energy() {
    let law = |of: &str| {
        pair(&format!(
            "link odd: left - right {{ {of} state f: N; rate f = -f/lag - k*v; force = f; }}"
        ))
    };
    assert_eq!(codes(&law("")), [Code::LawGivesEnergy]);
    assert_eq!(codes(&law("active;")), []);
    let damper = |of: &str| pair(&format!("link odd: left - right {{ {of} damper -c; spring k; }}"));
    assert_eq!(codes(&damper("")), [Code::NegativeDamping]);
    assert_eq!(codes(&damper("active;")), []);
    let both = pair(
        "link odd: left - right { active; damper -c; spring k; }
         link other: left { force = -c*v; }",
    );
    assert_eq!(codes(&both), [Code::LawGivesEnergy]);
    let report = check_text(text(&law("")), &|_, _| Err(String::new())).unwrap_err();
    let refused = report
        .diagnostics
        .iter()
        .find(|own| own.severity == Severity::Error)
        .unwrap();
    assert!(refused.hint.contains("`active;`"), "{report}");
}

/// An input that scales what a link gives: the law is held against what a passive part can do while it is zero.
#[test]
fn a_law_is_judged_while_its_inputs_are_zero() {
    let model = pair("force f; link odd: left - right { force = -f; spring k; }");
    assert_eq!(codes(&model), []);
}

#[test]
fn a_model_with_forces_of_every_kind_reads_back_and_shows_them() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/tests/zoo/forces.axle");
    let read =
        |model: &str| derive(check_text(text(model), &|_, _| Err(String::new())).unwrap_or_else(|r| panic!("{r}")));
    let compiled = read(&std::fs::read_to_string(path).unwrap());
    let printed = compiled.model.text().to_string();
    let again = read(&printed);
    assert_eq!(again.model.text(), printed);
    assert_eq!(again.programs, compiled.programs);
    let units: Vec<(&str, String)> = compiled
        .about
        .inputs
        .iter()
        .map(|input| (input.name.as_ref(), input.unit.to_string()))
        .collect();
    let forces = [
        ("f_wheel", "N"),
        ("lift", "N"),
        ("turn", "N m"),
        ("pull", "N"),
        ("demand", "N"),
    ];
    assert_eq!(
        &units[2..],
        forces.map(|(name, unit)| (name, unit.to_string())),
        "{units:?}"
    );
    for stage in [Stage::Model, Stage::Equations, Stage::Dot, Stage::Latex] {
        insta::assert_snapshot!(format!("forces_{}", stage.name()), show(&compiled, stage));
    }
}

/// A rigid body on two springs, seen at a point ahead of its centre: heave and pitch by hand, the point's equation from
/// both.
#[test]
fn a_point_moves_as_its_coordinates_do() {
    let model = "axle body {
        known param m: kg = 300;
        known param j: kg m^2 = 500;
        param k: N/m = 2e4 in 1e3..1e5;
        param arm: m = 1.3 in 1..2;
        direction z {
            motion ground;
            mass body = m;
            inertia pitch = j;
            point front = body + arm*pitch;
            point rear = body - arm*pitch;
            point nose = front + 0.5*(front - body);
            force f on nose;
            link left: front - ground { spring k; damper 0.01 s*k; }
            link right: rear - ground { spring 2*k; damper 0.02 s*k; }
            output nose.acceleration;
            output pitch.position;
        }
    }";
    close(&response(model, "f"), |s| {
        let (front, rear) = ((s * 0.01 + 1.0) * 2e4, (s * 0.01 + 1.0) * 4e4);
        let arm = 1.3;
        let heave = s * s * 300.0 + front + rear;
        let pitch = s * s * 500.0 + (front + rear) * arm * arm;
        let both = (front - rear) * arm;
        let determinant = heave * pitch - both * both;
        let lever = 1.5 * arm;
        // A unit force at the nose: 1 on heave, `lever` on pitch.
        let body = (pitch - both * lever) / determinant;
        let angle = (heave * lever - both) / determinant;
        s * s * (body + angle * lever)
    });
    let unlike = model.replace("body + arm*pitch", "body + pitch");
    assert_eq!(codes(&unlike), [Code::UnitsDiffer]);
    let constant = model.replace("point rear = body - arm*pitch", "point rear = body - arm");
    assert_eq!(codes(&constant), [Code::StretchHasConstant]);
}
