//! Laws of several stretches against the same law written by hand over complex numbers, whose imaginary part is the
//! derivative.

use nalgebra::Complex;
use qcar_dsl::check::Checked;
use qcar_dsl::compile::check;
use qcar_dsl::compile::derive;
use qcar_dsl::diagnostic::{Code, Report, Severity};
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::show::{Stage, show};
use qcar_model::{Entry, Matrix, Model as _};

use super::common::{assert_close, text};

type C = Complex<f64>;

/// A mass on a bushing with two travels that share one limit, beside a mass that only the rates couple.
fn bushing() -> String {
    let direction = |own: &str, other: &str| {
        format!(
            "direction {own} {{
                motion ground;
                mass body = m;
                link bushing: body - ground {{
                    force = k*s*(1 + (s^2 + {other}.bushing.stretch^2)/limit^2) + c*(2*v + {other}.bushing.rate);
                }}
                output body.position;
                output bushing.force;
            }}"
        )
    };
    format!(
        "axle bushing {{
            known param m: kg = 3;
            param k: N/m = 400 in 1..1e5;
            param c: N s/m = 8 in 1..100;
            param limit: m = 0.05 in 0.01..1;
            {} {}
        }}",
        direction("z", "x"),
        direction("x", "z")
    )
}

/// `dx/dt` and `y` by hand: states z, x, vz, vx; parameters m, k, c, limit; the ground rests.
fn by_hand(p: [C; 4], x: [C; 4]) -> ([C; 4], [C; 4]) {
    let [m, k, c, limit] = p;
    let [s_z, s_x, v_z, v_x] = x;
    let square = (s_z * s_z + s_x * s_x) / (limit * limit);
    let force = |s: C, v: C, other: C| k * s * (square + 1.0) + c * (v * 2.0 + other);
    let (f_z, f_x) = (force(s_z, v_z, v_x), force(s_x, v_x, v_z));
    ([v_z, v_x, -f_z / m, -f_x / m], [s_z, f_z, s_x, f_x])
}

const P: [f64; 4] = [3.0, 400.0, 8.0, 0.05];
const X: [f64; 4] = [0.02, -0.035, 0.4, 0.7];
const STEP: f64 = 1e-30;

/// The derivatives of rates and outputs by a state or, behind them, a parameter.
fn change(place: usize) -> ([f64; 4], [f64; 4]) {
    let stepped = |values: [f64; 4], first: usize| {
        std::array::from_fn(|i| C::new(values[i], if first + i == place { STEP } else { 0.0 }))
    };
    let (rates, outputs) = by_hand(stepped(P, 4), stepped(X, 0));
    (rates.map(|z| z.im / STEP), outputs.map(|z| z.im / STEP))
}

#[test]
fn a_law_of_two_stretches_has_the_derivatives_of_both() {
    let checked = check(text(&bushing()), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    assert!(checked.warnings().diagnostics.is_empty(), "{}", checked.warnings());
    let compiled = derive(checked);
    let evaluator = Evaluator::new(&compiled);
    let about = evaluator.about();
    let names: Vec<&str> = about.states.iter().map(|state| state.name.as_ref()).collect();
    assert_eq!(names, ["z_body", "x_body", "vz_body", "vx_body"]);

    let u = vec![0.0; about.inputs.len()];
    let (mut constants, mut dx, mut y) = (vec![0.0; about.constants], [0.0; 4], [0.0; 4]);
    evaluator.prepare(&P, &mut constants);
    evaluator.derivative(&constants, &X, &u, &mut dx);
    evaluator.outputs(&constants, &X, &u, &mut y);
    let (rates, outputs) = by_hand(P.map(C::from), X.map(C::from));
    assert_close("rates", &dx, &rates.map(|z| z.re), 1e-13, 0.0);
    assert_close("outputs", &y, &outputs.map(|z| z.re), 1e-13, 0.0);

    let mut entries = vec![0.0; about.matrices.len()];
    evaluator.matrices(&P, &X, &u, &mut entries);
    let entry = |matrix, row, column| {
        let wanted = Entry { matrix, row, column };
        let place = about.matrices.iter().position(|entry| *entry == wanted);
        place.map_or(0.0, |place| entries[place])
    };
    let mut slopes = vec![0.0; about.parameter_jacobian.len()];
    evaluator.parameter_jacobian(&P, &X, &u, &mut slopes);
    let slope = |is_output, row, parameter| {
        let wanted = (is_output, row, parameter);
        let place = about.parameter_jacobian.iter().position(|entry| *entry == wanted);
        place.map_or(0.0, |place| slopes[place])
    };
    for place in 0..4u16 {
        let (rates, outputs) = change(usize::from(place));
        assert_close(
            "A",
            &[0, 1, 2, 3].map(|row| entry(Matrix::A, row, place)),
            &rates,
            1e-13,
            0.0,
        );
        assert_close(
            "C",
            &[0, 1, 2, 3].map(|row| entry(Matrix::C, row, place)),
            &outputs,
            1e-13,
            0.0,
        );
        let (rates, outputs) = change(usize::from(4 + place));
        assert_close(
            "∂f/∂p",
            &[0, 1, 2, 3].map(|row| slope(false, row, place)),
            &rates,
            1e-13,
            0.0,
        );
        assert_close(
            "∂h/∂p",
            &[0, 1, 2, 3].map(|row| slope(true, row, place)),
            &outputs,
            1e-13,
            0.0,
        );
    }
    insta::assert_snapshot!("coupled_equations", show(&compiled, Stage::Equations));
    let printed = compiled.model.text().to_string();
    let again = check(text(&printed), &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"));
    assert_eq!(derive(again).programs, compiled.programs);
}

/// Two masses whose links have these laws.
fn pair(left: &str, right: &str) -> Result<Checked, Report> {
    let model = format!(
        "axle pair {{
            known param m: kg = 3;
            param k: N/m = 400 in 1..1e5;
            param c: N s/m = 8 in 1..100;
            direction z {{
                motion ground;
                mass a = m;
                mass b = m;
                link left: a - ground {{ {left} }}
                link right: b - ground {{ {right} }}
                output a.position;
                output b.position;
            }}
        }}"
    );
    check(text(&model), &|_, _| Err(String::new()))
}

/// What is wrong with them.
fn codes(left: &str, right: &str) -> Vec<Code> {
    let Err(report) = pair(left, right) else {
        return vec![];
    };
    let errors = report.diagnostics.iter().filter(|own| own.severity == Severity::Error);
    errors.map(|own| own.code).collect()
}

/// Forces that are slopes of one energy, and rates that are resisted together, are passive; all else is to be called
/// active.
#[test]
fn coupled_laws_are_judged_together() {
    let sound = (
        "force = k*s + 0.5*k*right.stretch;",
        "force = k*s + 0.5*k*left.stretch; damper c;",
    );
    assert_eq!(codes(sound.0, sound.1), []);
    let both = (
        "spring k; force = c*(v + right.rate);",
        "spring k; force = c*(v + left.rate);",
    );
    assert_eq!(codes(both.0, both.1), []);
    let one_sided = ("force = k*s + 0.5*k*right.stretch;", "spring k; damper c;");
    assert_eq!(codes(one_sided.0, one_sided.1), [Code::LawGivesEnergy]);
    assert_eq!(codes(&format!("active; {}", one_sided.0), one_sided.1), []);
    let unlike = (
        "force = k*s + 0.5*k*right.stretch;",
        "force = k*s - 0.5*k*left.stretch; damper c;",
    );
    assert_eq!(codes(unlike.0, unlike.1), [Code::LawGivesEnergy]);
    let pushing = (
        "spring k; force = c*(v + 3*right.rate);",
        "spring k; force = c*(v + 3*left.rate);",
    );
    assert_eq!(codes(pushing.0, pushing.1), [Code::LawGivesEnergy]);
}

/// A linear model whose laws use other stretches has no symmetric impedance, so that its responses come from its
/// matrices.
#[test]
fn a_coupled_model_is_not_called_linear() {
    let is_linear = |left: &str, right: &str| {
        let checked = pair(left, right).unwrap_or_else(|report| panic!("{report}"));
        derive(checked).about.linear
    };
    assert!(is_linear("force = k*s + c*v;", "force = k*s;"));
    assert!(!is_linear(
        "force = k*s + 0.5*k*right.stretch;",
        "force = k*s + 0.5*k*left.stretch; damper c;"
    ));
}

#[test]
fn what_a_link_does_not_have_is_said_so() {
    assert_eq!(
        codes("force = k*s + 0.5*k*right.length;", "spring k;"),
        [Code::UnknownQuantity]
    );
    assert_eq!(
        codes("force = k*s + c*right.stretch;", "spring k;"),
        [Code::UnitsDiffer]
    );
}
