//! Frequency responses and their parameter Jacobians are those of a dense complex solve, and of closed forms.

use nalgebra::Complex;
use proptest::prelude::*;
use qcar_dsl::check::Checked;
use qcar_dsl::compile::{derive, derive_wanted};
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::model::{CoordinateKind, Quantity, Signal, Term};
use qcar_dsl::response::{Wanted, sources};
use qcar_model::{Model as _, ResponseMut};

use super::common::random::{large_plan, plan};
use super::common::reference::{Reference, response};
use super::common::{self, Builder, assert_close, axle_d};

/// Responses and Jacobians of all excitations: values by output and line, slopes by output, parameter and line.
struct Responses {
    value: Vec<Vec<Complex<f64>>>,
    slope: Vec<Vec<Vec<Complex<f64>>>>,
}

fn evaluate(evaluator: &Evaluator, excitation: usize, p: &[f64], omega: &[f64]) -> Responses {
    let about = evaluator.about();
    let layout = &about.responses[excitation];
    let n = omega.len();
    let mut constants = vec![0.0; about.constants];
    evaluator.prepare(p, &mut constants);
    let (mut re, mut im) = (vec![0.0; n * layout.outputs.len()], vec![0.0; n * layout.outputs.len()]);
    let (mut alone_re, mut alone_im) = (re.clone(), im.clone());
    let (mut d_re, mut d_im) = (
        vec![0.0; n * layout.jacobian.len()],
        vec![0.0; n * layout.jacobian.len()],
    );
    evaluator.response(
        excitation,
        &constants,
        omega,
        ResponseMut {
            re: &mut re,
            im: &mut im,
            jacobian: Some((&mut d_re, &mut d_im)),
        },
    );
    evaluator.response(
        excitation,
        &constants,
        omega,
        ResponseMut {
            re: &mut alone_re,
            im: &mut alone_im,
            jacobian: None,
        },
    );
    assert_close("real part", &alone_re, &re, 1e-12, 0.0);
    assert_close("imaginary part", &alone_im, &im, 1e-12, 0.0);
    let zero = Complex::new(0.0, 0.0);
    let mut value = vec![vec![zero; n]; about.outputs.len()];
    let mut slope = vec![vec![vec![zero; n]; p.len()]; about.outputs.len()];
    for (place, &y) in layout.outputs.iter().enumerate() {
        value[usize::from(y)] = (0..n)
            .map(|i| Complex::new(re[place * n + i], im[place * n + i]))
            .collect();
    }
    for (place, &(row, p)) in layout.jacobian.iter().enumerate() {
        let y = usize::from(layout.outputs[usize::from(row)]);
        slope[y][usize::from(p)] = (0..n)
            .map(|i| Complex::new(d_re[place * n + i], d_im[place * n + i]))
            .collect();
    }
    Responses { value, slope }
}

/// The derivative of all matrices by a parameter, by a complex step.
fn change(model: &Checked, p: &[f64], which: usize) -> Reference<f64> {
    const STEP: f64 = 1e-30;
    let p: Vec<_> = p
        .iter()
        .enumerate()
        .map(|(i, &p)| Complex::new(p, if i == which { STEP } else { 0.0 }))
        .collect();
    let r = Reference::new(model, &p);
    let d = |m: nalgebra::DMatrix<Complex<f64>>| m.map(|x| x.im / STEP);
    Reference {
        m: d(r.m),
        c: d(r.c),
        k: d(r.k),
        f: d(r.f),
        s: d(r.s),
        v: d(r.v),
        g: d(r.g),
        pull: r.pull.map(|x| x.im / STEP),
        stretch: d(r.stretch),
        force: r.force.map(d),
        inner: r.inner,
        push: d(r.push),
        force_by_input: d(r.force_by_input),
        rate_by_input: d(r.rate_by_input),
        points: d(r.points),
    }
}

fn parts(values: &[Complex<f64>]) -> Vec<f64> {
    values.iter().flat_map(|value| [value.re, value.im]).collect()
}

/// Slopes are of the size of a response's square where parameters are about 1; `floor` is the fraction of it below
/// which a slope is nothing but rounding errors.
fn judge(model: Checked, p: &[f64], omega: &[f64], floor: f64) {
    judge_some(model, p, omega, floor, 0.0);
}

/// The same where outputs that are not shown may respond by as much as `unseen`, so that rounding errors are of its
/// size.
fn judge_some(model: Checked, p: &[f64], omega: &[f64], floor: f64, unseen: f64) {
    let evaluator = Evaluator::new(&derive(model.clone()));
    let reference = Reference::new(&model, p);
    for (i, source) in sources(&model).into_iter().enumerate() {
        let got = evaluate(&evaluator, i, p, omega);
        for which in 0..p.len() {
            let change = change(&model, p, which);
            for (line, &omega) in omega.iter().enumerate() {
                let want = response(&model, &reference, &change, source, omega);
                let (value, slope): (Vec<_>, Vec<_>) = want.into_iter().unzip();
                let values: Vec<_> = got.value.iter().map(|row| row[line]).collect();
                let slopes: Vec<_> = got.slope.iter().map(|row| row[which][line]).collect();
                assert_close("response", &parts(&values), &parts(&value), 1e-9, 1e-4 * unseen);
                let largest = value.iter().fold(unseen, |m, v| m.max(v.norm()));
                let (what, floor) = (format!("its slope by parameter {which}"), floor * largest * largest);
                assert_close(&what, &parts(&slopes), &parts(&slope), 1e-9, floor);
            }
        }
    }
}

#[test]
fn a_whole_axle_responds_as_its_matrices_say() {
    let p = [
        586.1, 33.1, 5.1, 24.1, 53.4, 55300.0, 4140.0, 0.625, 0.672, 535e3, 843.0, 644e3, 842.0, 390e3, 561.0, 250e3,
        200.0,
    ];
    judge(axle_d(), &p, &[3.0, 10.0, 80.0, 190.0], 0.0);
}

proptest! {
    #![proptest_config(common::cases(48))]

    #[test]
    fn random_models_respond_as_their_matrices_say(plan in plan(), omega in 0.1..3.0f64) {
        let (model, p) = plan.build_with_groups();
        judge(model, &p, &[omega], 1e-4);
    }

    /// A road that rises slowly lifts everything that hangs on it by as much, whatever the levers: a lever's stretch is
    /// blind to a common rise.
    #[test]
    fn a_slow_road_lifts_everything_by_as_much(plan in plan()) {
        let (model, p) = plan.build_with_groups();
        let evaluator = Evaluator::new(&derive(model.clone()));
        let got = evaluate(&evaluator, 0, &p, &[1e-9]);
        for (y, output) in model.outputs.iter().enumerate() {
            if let Signal::Motion(_, Quantity::Position) = output.signal {
                prop_assert!((got.value[y][0] - Complex::new(1.0, 0.0)).norm() < 1e-7);
            }
        }
    }
}

proptest! {
    #![proptest_config(common::cases(4))]

    /// The rounding errors of the dense reference grow with the number of members, which is ten times that of small
    /// models: so does what is nothing but such errors.
    #[test]
    fn large_models_respond_as_their_matrices_say(plan in large_plan(), omega in 0.1..3.0f64) {
        let (model, p) = plan.build_with_groups();
        judge_some(model, &p, &[omega], 1e-3, 1.0);
    }

    /// The derivatives of two outputs come from a solution for each, those of all outputs from the inverse.
    #[test]
    fn derivatives_of_some_outputs_are_those_of_all(plan in large_plan(), omega in 0.1..3.0f64) {
        let (model, p) = plan.build_with_groups();
        let wanted = [0, model.outputs.len() - 1];
        let some = derive_wanted(model.clone(), Wanted::JacobianOf(&wanted.map(|output| output as u16)));
        let [some, all] = [some, derive(model)].map(|own| evaluate(&Evaluator::new(&own), 0, &p, &[omega]));
        let largest = all.value.iter().fold(1.0_f64, |most, row| most.max(row[0].norm()));
        for (y, slopes) in some.slope.iter().enumerate() {
            assert_close("response", &parts(&some.value[y]), &parts(&all.value[y]), 1e-9, 1e-4 * largest);
            let (found, expected) = (slopes.concat(), all.slope[y].concat());
            if wanted.contains(&y) {
                assert_close("its slopes", &parts(&found), &parts(&expected), 1e-9, 1e-3 * largest * largest);
            } else {
                prop_assert!(found.iter().all(|slope| slope.norm() == 0.0));
            }
        }
    }
}

fn quarter_car() -> Checked {
    let mut b = Builder::new("quarter_car");
    let [m_body, m_wheel, k, c, k_tire, c_tire] =
        ["m_body", "m_wheel", "k", "c", "k_tire", "c_tire"].map(|name| b.parameter(name));
    let pad = b.coordinate("z", "pad", CoordinateKind::Road);
    let (body, wheel) = (b.mass("z", "body", m_body), b.mass("z", "wheel", m_wheel));
    let (suspension, tire) = (b.between(body, wheel), b.between(wheel, pad));
    b.link("z", "suspension", &suspension, vec![Term::Spring(k), Term::Damper(c)]);
    b.link("z", "tire", &tire, vec![Term::Spring(k_tire), Term::Damper(c_tire)]);
    b.accelerations(&[body, wheel]);
    b.build()
}

/// Body and wheel over pad as fractions of polynomials in s = jω (thesis section 2.3.1, multiplied out by hand).
#[test]
fn a_quarter_car_transmits_by_its_closed_form() {
    let p @ [m_body, m_wheel, k, c, k_tire, c_tire] = [450.0, 38.0, 28e3, 2.1e3, 220e3, 150.0];
    let omega: Vec<f64> = (0..70).map(|i| 2.0 * 1.07f64.powi(i)).collect();
    let evaluator = Evaluator::new(&derive(quarter_car()));
    let got = evaluate(&evaluator, 0, &p, &omega);
    for (i, &omega) in omega.iter().enumerate() {
        let s = Complex::new(0.0, omega);
        let (suspension, tire) = (s * c + k, s * c_tire + k_tire);
        let body = s * s * m_body + suspension;
        let determinant = body * (s * s * m_wheel + suspension + tire) - suspension * suspension;
        let want = [tire * suspension / determinant, tire * body / determinant].map(|h| -omega * omega * h);
        assert_close(
            "transmissibility",
            &parts(&[got.value[0][i], got.value[1][i]]),
            &parts(&want),
            1e-11,
            0.0,
        );
    }
}

/// A line does not depend on how many lines are asked for with it.
#[test]
fn lines_are_computed_one_by_one() {
    let p = [450.0, 38.0, 28e3, 2.1e3, 220e3, 150.0];
    let omega: Vec<f64> = (0..75).map(|i| 1.0 + i as f64).collect();
    let evaluator = Evaluator::new(&derive(quarter_car()));
    let together = evaluate(&evaluator, 0, &p, &omega);
    for (i, &omega) in omega.iter().enumerate() {
        let alone = evaluate(&evaluator, 0, &p, &[omega]);
        assert_eq!(alone.value[0][0], together.value[0][i]);
        assert_eq!(alone.slope[1][2][0], together.slope[1][2][i]);
    }
}
