//! The exponential method against closed forms and against the general method.

use qcar_runtime::solver::{DormandPrince, Driven, ExponentialAdams, PAST, Reason, Settings, System};

const OMEGA: f64 = 60.0;
const ZETA: f64 = 0.05;
/// A mode that an explicit method would have to follow, 1/s.
const FAST: f64 = 1200.0;

/// An oscillator with a quick follower, driven by two forces.
struct Oscillator<F>(F);

impl<F: FnMut(f64, &[f64]) -> Option<[f64; 2]>> Driven<2> for Oscillator<F> {
    fn rate(&self, x: &[f64], force: [f64; 2], dx: &mut [f64]) {
        dx[0] = x[1];
        dx[1] = -OMEGA * OMEGA * x[0] - 2.0 * ZETA * OMEGA * x[1] + force[0];
        dx[2] = FAST * (x[0] - x[2]) + force[1];
    }

    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; 2]> {
        (self.0)(t, x)
    }
}

impl<F: FnMut(f64, &[f64]) -> Option<[f64; 2]>> System for Oscillator<F> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let force = self.force(t, x).expect("the force is smooth");
        self.rate(x, force, dx);
    }
}

/// By the general method, at a tolerance that leaves nothing to be desired.
fn reference(system: &mut impl System, span: (f64, f64), x: &mut [f64]) {
    let settings = Settings {
        relative: 1e-12,
        absolute: vec![1e-13; x.len()],
        longest_step: 1.0,
        most_steps: 1_000_000,
    };
    let report = DormandPrince::new(settings, 0).integrate(system, span, &[], x);
    assert_eq!(report.reason, Reason::End);
}

/// The exponential method from 0 to 0.1 s in so many steps, begun on the exact solution: where it ends.
fn ends<F: FnMut(f64, &[f64]) -> Option<[f64; 2]>>(
    system: &mut Oscillator<F>,
    steps: usize,
    start: [f64; 3],
) -> Vec<f64> {
    let step = 0.1 / steps as f64;
    let mut method = ExponentialAdams::new(system, 3, step, 0).expect("the step is short");
    let mut x = start;
    let past = std::array::from_fn(|point| {
        if point > 0 {
            reference(system, ((point - 1) as f64 * step, point as f64 * step), &mut x);
        }
        system.force(point as f64 * step, &x).expect("the force is smooth")
    });
    method.begin(&x, &past);
    for point in PAST..=steps {
        assert!(method.advance(system, point as f64 * step, 1.0, &[1.0; 3]));
    }
    method.state().to_vec()
}

fn error(found: &[f64], exact: &[f64]) -> f64 {
    found
        .iter()
        .zip(exact)
        .fold(0.0, |worst: f64, (found, exact)| worst.max((found - exact).abs()))
}

/// A spring that hardens: the force depends on the state.
fn hardening(_: f64, x: &[f64]) -> Option<[f64; 2]> {
    Some([-4e5 * x[0].powi(3), 50.0 * x[0] * x[0]])
}

#[test]
fn forces_that_are_polynomials_of_time_are_exact_however_fast_a_mode_is() {
    let polynomial = |t: f64, _: &[f64]| Some([900.0 * t.powi(4) - 40.0 * t, 3.0 - 2e4 * t.powi(3)]);
    let mut system = Oscillator(polynomial);
    let start = [0.01, -0.2, 0.3];
    let mut exact = start;
    reference(&mut system, (0.0, 0.1), &mut exact);
    // In the longer steps the quick mode decays by a factor of e^-12.
    for steps in [50, 10] {
        assert!(error(&ends(&mut system, steps, start), &exact) < 1e-11);
    }
}

#[test]
fn the_error_falls_with_the_sixth_power_of_the_step() {
    let mut system = Oscillator(hardening);
    let start = [0.05, 0.0, 0.0];
    let mut exact = start;
    reference(&mut system, (0.0, 0.1), &mut exact);
    let errors = [100, 200].map(|steps| error(&ends(&mut system, steps, start), &exact));
    let order = (errors[0] / errors[1]).log2();
    assert!((5.5..7.0).contains(&order), "{errors:?}");
}

#[test]
fn a_step_that_is_not_exact_enough_is_not_made() {
    let mut jumps = Oscillator(|t: f64, _: &[f64]| Some([if t > 0.011 { 1e4 } else { 0.0 }, 0.0]));
    let mut nowhere = Oscillator(|_: f64, _: &[f64]| Some([f64::NAN, 0.0]));
    let mut ended = Oscillator(|t: f64, _: &[f64]| (t < 0.011).then_some([0.0, 0.0]));
    let mut method = ExponentialAdams::new(&ended, 3, 2e-3, 0).expect("the step is short");
    let start = [0.01, 0.0, 0.01];
    let tolerance = [1e-6; 3];
    method.begin(&start, &[[0.0; 2]; PAST]);
    assert!(!method.advance(&mut nowhere, 0.010, 1e-6, &tolerance));
    assert!(method.advance(&mut jumps, 0.010, 1e-6, &tolerance));
    let before = method.state().to_vec();
    assert!(!method.advance(&mut jumps, 0.012, 1e-6, &tolerance));
    assert!(!method.advance(&mut ended, 0.012, 1e-6, &tolerance));
    assert_eq!(method.state(), before);
}

#[test]
fn a_system_that_is_no_number_has_no_steps() {
    struct Nowhere;
    impl Driven<1> for Nowhere {
        fn rate(&self, x: &[f64], _: [f64; 1], dx: &mut [f64]) {
            dx[0] = x[0] * f64::NAN;
        }
        fn force(&mut self, _: f64, _: &[f64]) -> Option<[f64; 1]> {
            None
        }
    }
    assert!(ExponentialAdams::new(&Nowhere, 1, 1e-3, 0).is_none());
}

/// Two oscillators that do not feel each other, their states in turn; each is driven by a spring that hardens, the
/// first by a wind, too.
struct Apart;

impl Driven<2> for Apart {
    fn rate(&self, x: &[f64], force: [f64; 2], dx: &mut [f64]) {
        for i in 0..2 {
            let omega = OMEGA * (1 + i) as f64;
            dx[i] = x[2 + i];
            dx[2 + i] = force[i] - omega * omega * x[i];
        }
    }

    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; 2]> {
        Some([-4e5 * x[0].powi(3) + 20.0 * (90.0 * t).sin(), -3e5 * x[1].powi(3)])
    }
}

impl System for Apart {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let force = self.force(t, x).expect("the force is smooth");
        self.rate(x, force, dx);
    }
}

#[test]
fn what_does_not_feel_each_other_goes_on_in_steps_that_are_doubled() {
    let (step, start) = (5e-4, [0.03, -0.02, 0.5, 0.1]);
    let mut x = start;
    let past = std::array::from_fn(|point| {
        if point > 0 {
            reference(&mut Apart, ((point - 1) as f64 * step, point as f64 * step), &mut x);
        }
        Apart.force(point as f64 * step, &x).expect("the force is smooth")
    });
    let mut method = ExponentialAdams::new(&Apart, 4, step, 1).expect("the system is finite");
    method.begin(&x, &past);
    let (mut at, mut stride) = (PAST - 1, 1);
    while at < 200 {
        // As many points are known as two steps of the past less one.
        if method.lengthen() {
            assert_eq!((at, stride), (2 * (PAST - 1), 1));
            stride = 2;
        }
        at += stride;
        assert!(method.advance(&mut Apart, at as f64 * step, 1.0, &[1.0; 4]));
    }
    let mut exact = start;
    reference(&mut Apart, (0.0, 0.1), &mut exact);
    assert!(error(method.state(), &exact) < 2e-7, "{:?} {exact:?}", method.state());
}
