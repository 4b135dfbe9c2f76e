//! Both integrators against closed forms: order, dense output, events, jumps, and what they refuse.

use differential_equations::prelude::{ExplicitRungeKutta, IVP};
use qcar_runtime::solver::{After, DormandPrince, Event, Reason, Report, Rk4, Settings, Step, System};

/// A right-hand side as a closure, sampled on its dense output at the given ascending times.
struct Sampled<F> {
    f: F,
    times: Vec<f64>,
    states: Vec<Vec<f64>>,
}

impl<F: FnMut(f64, &[f64], &mut [f64])> System for Sampled<F> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        (self.f)(t, x, dx);
    }

    fn accept(&mut self, step: &Step<'_>) {
        while let Some(&t) = self.times.get(self.states.len()).filter(|t| **t <= step.end) {
            let mut state = step.start_state().to_vec();
            step.at(t, &mut state);
            self.states.push(state);
        }
    }
}

fn sampled<F: FnMut(f64, &[f64], &mut [f64])>(f: F, times: Vec<f64>) -> Sampled<F> {
    Sampled {
        f,
        times,
        states: Vec::new(),
    }
}

fn settings(relative: f64, states: usize, longest_step: f64) -> Settings {
    Settings {
        relative,
        absolute: vec![relative; states],
        longest_step,
        most_steps: 100_000,
    }
}

fn run<F: FnMut(f64, &[f64], &mut [f64])>(
    system: &mut Sampled<F>,
    settings: Settings,
    end: f64,
    x: &mut [f64],
) -> Report {
    DormandPrince::new(settings, 0).integrate(system, (0.0, end), &[], x)
}

const OMEGA: f64 = 7.0;
const ZETA: f64 = 0.1;

/// A damped oscillator at rest, let go from 1.
fn oscillator(_: f64, x: &[f64], dx: &mut [f64]) {
    dx[0] = x[1];
    dx[1] = -OMEGA * OMEGA * x[0] - 2.0 * ZETA * OMEGA * x[1];
}

fn oscillator_exact(t: f64) -> f64 {
    let damped = OMEGA * (1.0 - ZETA * ZETA).sqrt();
    (-ZETA * OMEGA * t).exp() * ((damped * t).cos() + ZETA * OMEGA / damped * (damped * t).sin())
}

/// Largest error at the steps' ends and between them, with `n` equal steps over a second.
fn errors(n: usize, adaptive: bool) -> (f64, f64) {
    let h = 1.0 / n as f64;
    let times: Vec<f64> = (1..=4 * n).map(|i| 0.25 * h * i as f64).collect();
    let mut system = sampled(oscillator, times);
    let mut x = [1.0, 0.0];
    let report = if adaptive {
        // With a tolerance that anything meets, only the longest step counts, once the first steps have grown to it.
        let loose = Settings {
            relative: 1e6,
            absolute: vec![1e6; 2],
            longest_step: h,
            most_steps: 10_000,
        };
        DormandPrince::new(loose, 0).integrate(&mut system, (0.0, 1.0), &[], &mut x)
    } else {
        Rk4::new(h, 10_000, 2, 0).integrate(&mut system, (0.0, 1.0), &[], &mut x)
    };
    assert_eq!((report.reason, report.time), (Reason::End, 1.0));
    let error = |i: usize| (system.states[i][0] - oscillator_exact(system.times[i])).abs();
    let worst = |at_end: bool| {
        (0..4 * n)
            .filter(|i| (i % 4 == 3) == at_end)
            .map(error)
            .fold(0.0, f64::max)
    };
    (worst(true), worst(false))
}

fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

#[test]
fn dormand_prince_converges_with_order_five_and_its_dense_output_with_four() {
    let (coarse, fine) = (errors(40, true), errors(80, true));
    assert!(order(coarse.0, fine.0) > 4.8, "{coarse:?} {fine:?}");
    assert!(order(coarse.1, fine.1) > 3.9, "{coarse:?} {fine:?}");
}

#[test]
fn rk4_converges_with_order_four_and_its_dense_output_with_three() {
    let (coarse, fine) = (errors(40, false), errors(80, false));
    assert!(order(coarse.0, fine.0) > 3.9, "{coarse:?} {fine:?}");
    assert!(order(coarse.1, fine.1) > 2.9, "{coarse:?} {fine:?}");
}

#[test]
fn the_tolerance_is_kept_along_the_whole_solution() {
    for relative in [1e-4, 1e-6, 1e-9] {
        let times: Vec<f64> = (1..=1000).map(|i| 0.003 * i as f64).collect();
        let mut system = sampled(oscillator, times);
        let report = run(&mut system, settings(relative, 2, 1.0), 3.0, &mut [1.0, 0.0]);
        assert_eq!(report.reason, Reason::End);
        let error = |(t, x): (&f64, &Vec<f64>)| (x[0] - oscillator_exact(*t)).abs();
        let worst = system.times.iter().zip(&system.states).map(error).fold(0.0, f64::max);
        assert!(worst < 20.0 * relative, "{relative}: {worst}");
    }
}

#[test]
fn the_effort_counts_every_call() {
    let mut calls = 0;
    let count = |_: f64, x: &[f64], dx: &mut [f64]| {
        calls += 1;
        // Swings whose pace changes a hundredfold within each turn: some steps are refused.
        dx[0] = x[0] * 50.0 * (1.0 - 0.99 * x[1].cos()).recip() * x[1].sin() * 0.01;
        dx[1] = 30.0;
    };
    let report = run(
        &mut sampled(count, vec![]),
        settings(1e-6, 2, 1.0),
        1.0,
        &mut [1.0, 0.0],
    );
    let effort = report.effort;
    assert_eq!(effort.evaluations, calls);
    assert!(effort.rejected > 0);
    // One to begin with, one for the first step, twelve for the fastest mode.
    assert_eq!(calls, 14 + 6 * (effort.accepted + effort.rejected));
}

/// A ball that falls on a floor and loses a fifth of its speed there.
struct Ball {
    bounces: Vec<f64>,
    tops: Vec<f64>,
    landed: bool,
}

const G: f64 = 9.81;
const KEEPS: f64 = 0.8;

impl System for Ball {
    fn derivative(&mut self, _: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = x[1];
        dx[1] = -G;
    }

    fn enter(&mut self, _: f64, x: &mut [f64]) {
        if std::mem::take(&mut self.landed) {
            x[1] *= -KEEPS;
        }
    }

    fn events(&self) -> usize {
        2
    }

    fn event_values(&mut self, _: f64, x: &[f64], values: &mut [f64]) {
        values.copy_from_slice(x);
    }

    fn happen(&mut self, event: &Event<'_>) -> After {
        match (event.index, event.rising) {
            (0, false) => {
                self.bounces.push(event.time);
                self.landed = true;
                After::Restart
            }
            (1, false) if event.state[0] > 0.01 => {
                self.tops.push(event.state[0]);
                After::Continue
            }
            _ => After::Continue,
        }
    }
}

fn ball() -> Ball {
    Ball {
        bounces: Vec::new(),
        tops: Vec::new(),
        landed: false,
    }
}

fn assert_bounces(ball: &Ball, x: &[f64]) {
    let fall = (2.0 / G).sqrt();
    let mut time = fall;
    for (n, bounce) in ball.bounces.iter().enumerate() {
        assert!((bounce - time).abs() < 1e-12, "bounce {n}: {bounce} {time}");
        time += 2.0 * fall * KEEPS.powi(n as i32 + 1);
    }
    assert_eq!(ball.bounces.len(), 4);
    for (n, top) in ball.tops.iter().enumerate() {
        assert!((top - KEEPS.powi(2 * (n as i32 + 1))).abs() < 1e-12, "top {n}: {top}");
    }
    let since = 2.5 - ball.bounces[3];
    let height = G * fall * KEEPS.powi(4) * since - 0.5 * G * since * since;
    assert!((x[0] - height).abs() < 1e-11);
}

#[test]
fn a_bouncing_ball_bounces_where_it_must() {
    let (mut adaptive, mut fixed) = (ball(), ball());
    let mut x = [1.0, 0.0];
    let report = DormandPrince::new(settings(1e-8, 2, 0.5), 2).integrate(&mut adaptive, (0.0, 2.5), &[], &mut x);
    assert_eq!(report.reason, Reason::End);
    assert_bounces(&adaptive, &x);
    let mut x = [1.0, 0.0];
    let report = Rk4::new(0.05, 1000, 2, 2).integrate(&mut fixed, (0.0, 2.5), &[], &mut x);
    assert_eq!(report.reason, Reason::End);
    assert_bounces(&fixed, &x);
}

#[test]
fn bounces_without_end_do_not_keep_the_integrators_for_ever() {
    let few = Settings {
        most_steps: 20,
        ..settings(1e-8, 2, 1.0)
    };
    let rest = (2.0 / G).sqrt() * (1.0 + 2.0 * KEEPS / (1.0 - KEEPS));
    let adaptive = |settings| DormandPrince::new(settings, 2).integrate(&mut ball(), (0.0, 9.0), &[], &mut [1.0, 0.0]);
    assert_eq!(adaptive(few).reason, Reason::TooManySteps);
    let adaptive = adaptive(settings(1e-8, 2, 1.0));
    let fixed = Rk4::new(0.1, 500, 2, 2).integrate(&mut ball(), (0.0, 9.0), &[], &mut [1.0, 0.0]);
    assert_eq!([adaptive.reason, fixed.reason], [Reason::Crowded, Reason::TooManySteps]);
    for report in [adaptive, fixed] {
        assert!((report.time - rest).abs() < 1e-3, "{report}");
    }
}

/// A clock hand that stops the run when it has passed a right angle.
struct Hand;

impl System for Hand {
    fn derivative(&mut self, _: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = -x[1];
        dx[1] = x[0];
    }

    fn events(&self) -> usize {
        1
    }

    fn event_values(&mut self, _: f64, x: &[f64], values: &mut [f64]) {
        values[0] = x[0];
    }

    fn happen(&mut self, _: &Event<'_>) -> After {
        After::Stop
    }
}

#[test]
fn an_event_can_end_the_run_and_the_state_is_that_of_the_event() {
    let mut x = [1.0, 0.0];
    let report = DormandPrince::new(settings(1e-10, 2, 1.0), 1).integrate(&mut Hand, (0.0, 9.0), &[], &mut x);
    assert_eq!(report.reason, Reason::Event(0));
    assert!((report.time - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    assert!(x[0].abs() < 1e-15 && (x[1] - 1.0).abs() < 1e-9);
    assert_eq!(report.effort.events, 1);
}

/// `x' = ±1` in turns, the sign taken where a leg begins.
struct Square {
    half_period: f64,
    slope: f64,
}

impl System for Square {
    fn derivative(&mut self, _: f64, _: &[f64], dx: &mut [f64]) {
        dx[0] = self.slope;
    }

    fn enter(&mut self, t: f64, _: &mut [f64]) {
        self.slope = if (t / self.half_period).round() % 2.0 == 0.0 {
            1.0
        } else {
            -1.0
        };
    }
}

#[test]
fn a_right_hand_side_that_jumps_is_integrated_exactly() {
    // Breaks at, before and beyond the ends, and the same one twice, are harmless.
    let breaks = [-0.3, 0.0, 0.3, 0.6, 0.6, 0.9, 1.2, 1.5, 1.8];
    let mut x = [0.0];
    let mut square = Square {
        half_period: 0.3,
        slope: f64::NAN,
    };
    let report = DormandPrince::new(settings(1e-6, 1, 1.0), 0).integrate(&mut square, (0.0, 1.5), &breaks, &mut x);
    assert!((x[0] - 0.3).abs() < 1e-15, "{x:?}");
    assert_eq!((report.reason, report.effort.rejected), (Reason::End, 0));
    let mut x = [0.0];
    let report = Rk4::new(1.0, 100, 1, 0).integrate(&mut square, (0.0, 1.5), &breaks, &mut x);
    assert!((x[0] - 0.3).abs() < 1e-15, "{x:?}");
    assert_eq!((report.reason, report.effort.accepted), (Reason::End, 5));
}

/// A pulse of a hundredth of a second in ten seconds of rest, worth 1.
fn pulse(t: f64, x: &[f64], dx: &mut [f64]) {
    let inside = (t - 5.003) / 0.01;
    dx[0] = if (0.0..1.0).contains(&inside) {
        200.0 * (std::f64::consts::PI * inside).sin().powi(2)
    } else {
        0.0
    };
    dx[1] = -x[1];
}

#[test]
fn the_longest_step_keeps_a_short_pulse_from_being_stepped_over() {
    let end_after = |longest_step| {
        let mut x = [0.0, 1.0];
        let report = run(
            &mut sampled(pulse, vec![]),
            settings(1e-6, 2, longest_step),
            10.0,
            &mut x,
        );
        assert_eq!(report.reason, Reason::End);
        x[0]
    };
    assert_eq!(
        end_after(1e9),
        0.0,
        "this pulse must be one that an unlimited step misses"
    );
    let found = end_after(0.01);
    assert!((found - 1.0).abs() < 1e-3, "{found}");
}

#[test]
fn what_is_not_finite_is_never_accepted_and_stops_with_its_time() {
    type Rhs = fn(f64, &[f64], &mut [f64]);
    let log: Rhs = |t, _, dx| dx[0] = (1.0 - t).sqrt();
    let pole: Rhs = |t, _, dx| dx[0] = if t > 1.0 { f64::INFINITY } else { 0.0 };
    let overflow: Rhs = |t, _, dx| dx[0] = if t > 1.0 { 1e308 } else { 0.0 };
    for (rhs, name) in [(log, "square root"), (pole, "infinity")] {
        let mut x = [0.0];
        let report = run(&mut sampled(rhs, vec![]), settings(1e-6, 1, 10.0), 3.0, &mut x);
        assert!(!report.reason.is_success(), "{name}: {report}");
        assert!(
            (report.time - 1.0).abs() < 1e-6 && x[0].is_finite(),
            "{name}: {report} {x:?}"
        );
        let report = Rk4::new(0.01, 1000, 1, 0).integrate(&mut sampled(rhs, vec![]), (0.0, 3.0), &[], &mut x);
        assert_eq!(report.reason, Reason::NotFinite, "{name}");
        assert!((report.time - 1.0).abs() < 0.011, "{name}: {report}");
    }
    // A state that overflows within its own relative tolerance has an error norm of zero or no norm at all.
    let mut x = [1e308];
    let report = run(&mut sampled(overflow, vec![]), settings(1.0, 1, 10.0), 30.0, &mut x);
    assert!(!report.reason.is_success() && x[0].is_finite(), "{report} {x:?}");
}

#[test]
fn a_start_that_is_not_finite_stops_at_once() {
    let nan = |_: f64, _: &[f64], dx: &mut [f64]| dx[0] = f64::NAN;
    let report = run(&mut sampled(nan, vec![]), settings(1e-6, 1, 1.0), 1.0, &mut [0.0]);
    assert_eq!(
        (report.reason, report.time, report.effort.evaluations),
        (Reason::NotFinite, 0.0, 1)
    );
    let rest = |_: f64, _: &[f64], dx: &mut [f64]| dx[0] = 0.0;
    let report = run(&mut sampled(rest, vec![]), settings(1e-6, 1, 1.0), 1.0, &mut [f64::NAN]);
    assert_eq!(report.reason, Reason::NotFinite);
}

#[test]
fn a_solution_that_ends_stops_where_it_ends() {
    let blow_up = |_: f64, x: &[f64], dx: &mut [f64]| dx[0] = x[0] * x[0];
    let report = run(&mut sampled(blow_up, vec![]), settings(1e-8, 1, 1.0), 2.0, &mut [1.0]);
    assert!(!report.reason.is_success());
    assert!((report.time - 1.0).abs() < 1e-6, "{report}");
}

#[test]
fn a_stiff_problem_stops_with_its_reason() {
    let stiff = |t: f64, x: &[f64], dx: &mut [f64]| dx[0] = -1e9 * (x[0] - t.cos());
    let few = Settings {
        most_steps: 2_000,
        ..settings(1e-6, 1, 1.0)
    };
    let report = run(&mut sampled(stiff, vec![]), few, 1.0, &mut [1.0]);
    assert_eq!(report.reason, Reason::TooManySteps);
    assert_eq!(report.effort.accepted + report.effort.rejected, 2_000);
    assert!(report.to_string().contains("too stiff"), "{report}");
}

#[test]
fn the_fastest_mode_sets_the_pace_before_steps_fail() {
    // Slow swings of a mass on a spring beside a mode that dies within a millisecond.
    let two = |t: f64, x: &[f64], dx: &mut [f64]| {
        dx[0] = x[1];
        dx[1] = -30.0 * x[0] + 0.1 * x[2];
        dx[2] = -2000.0 * (x[2] - t.sin());
    };
    let report = run(
        &mut sampled(two, vec![]),
        settings(1e-6, 3, 1.0),
        2.0,
        &mut [1.0, 0.0, 0.0],
    );
    // An explicit method of this kind damps at most 5.7 a step.
    let fewest = 2.0 * 2000.0 / 5.7;
    assert!(report.effort.rejected < 5, "{:?}", report.effort);
    assert!((report.effort.accepted as f64) < 1.2 * fewest, "{:?}", report.effort);
}

/// An oscillator whose displacement and power are signals.
struct Watched {
    seen: Vec<(f64, [f64; 2])>,
    smooth: usize,
}

impl System for Watched {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let (dx, signals) = dx.split_at_mut(2);
        oscillator(t, x, dx);
        signals.copy_from_slice(&[x[0], x[1] * dx[1]]);
    }

    fn signals(&self) -> usize {
        2
    }

    fn accept(&mut self, step: &Step<'_>) {
        if step.has_rates() {
            self.smooth += 1;
            for part in [0.0, 0.2, 0.5, 0.8, 1.0] {
                let t = step.start + part * (step.end - step.start);
                let mut signals = [0.0; 2];
                step.rates_at(t, 2, &mut signals);
                self.seen.push((t, signals));
            }
        }
    }
}

#[test]
fn signals_come_with_smooth_steps() {
    let mut watched = Watched {
        seen: vec![],
        smooth: 0,
    };
    // The longest step keeps the error far below the tolerance.
    let report =
        DormandPrince::new(settings(1e-5, 2, 0.01), 0).integrate(&mut watched, (0.0, 2.0), &[], &mut [1.0, 0.0]);
    assert_eq!((report.reason, watched.smooth), (Reason::End, report.effort.accepted));
    for (t, [displacement, power]) in watched.seen {
        let h = 1e-6;
        let v = (oscillator_exact(t + h) - oscillator_exact(t - h)) / (2.0 * h);
        let a = -OMEGA * OMEGA * oscillator_exact(t) - 2.0 * ZETA * OMEGA * v;
        assert!((displacement - oscillator_exact(t)).abs() < 1e-6, "at {t}");
        assert!((power - v * a).abs() < 1e-6 * OMEGA.powi(3), "at {t}");
    }
    let mut fixed = Watched {
        seen: vec![],
        smooth: 0,
    };
    let _ = Rk4::new(0.01, 1000, 2, 0).integrate(&mut fixed, (0.0, 2.0), &[], &mut [1.0, 0.0]);
    assert_eq!(fixed.smooth, 0, "a method without an estimate of its error cannot know");
}

/// A mass on a damper that is pushed by a force with a bend, foreseen or not.
struct Bent {
    foreseen: bool,
    ends: Vec<f64>,
}

const BEND: f64 = 0.437;

impl System for Bent {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = (3.0 * t).sin() + 20.0 * (t - BEND).max(0.0) - x[0];
    }

    fn next_kink(&self, _: f64, _: &[f64], _: &[f64], from: f64) -> f64 {
        if self.foreseen && from < BEND {
            BEND
        } else {
            f64::INFINITY
        }
    }

    fn accept(&mut self, step: &Step<'_>) {
        self.ends.push(step.end);
    }
}

#[test]
fn a_step_ends_at_a_bend_that_is_foreseen_and_no_step_fails_over_it() {
    let run = |foreseen| {
        let (mut bent, mut x) = (Bent { foreseen, ends: vec![] }, [0.0]);
        let report = DormandPrince::new(settings(1e-8, 1, 0.2), 0).integrate(&mut bent, (0.0, 1.0), &[], &mut x);
        assert_eq!(report.reason, Reason::End);
        (bent.ends, report.effort, x[0])
    };
    let ((ends, foreseen, x), (_, unforeseen, same)) = (run(true), run(false));
    assert!(ends.contains(&BEND), "{ends:?}");
    assert!(
        foreseen.rejected == 0 && unforeseen.rejected > 0,
        "{foreseen:?} {unforeseen:?}"
    );
    assert!(foreseen.evaluations < unforeseen.evaluations);
    assert!((x - same).abs() < 1e-7);
}

/// A driven wheel hop with a hardening spring and a digressive damper.
fn nonlinear(t: f64, x: &[f64], dx: &mut [f64]) {
    dx[0] = x[1];
    dx[1] = 40.0 * (9.0 * t).sin() - 400.0 * x[0] * (1.0 + 30.0 * x[0] * x[0]) - 30.0 * x[1] / (1.0 + x[1].abs());
}

#[test]
fn a_nonlinear_solution_agrees_with_an_independent_program() {
    let times: Vec<f64> = (1..=200).map(|i| 0.01 * f64::from(i)).collect();
    let independent = IVP::ode_from_fn(
        |t, x: &[f64; 2], dx: &mut [f64; 2]| nonlinear(t, x, dx),
        0.0,
        2.0,
        [0.1, 0.0],
    )
    .t_eval(&times)
    .method(ExplicitRungeKutta::dop853().rtol(1e-11).atol(1e-11))
    .solve()
    .expect("the oracle solves it");
    let mut ours = sampled(nonlinear, times);
    let report = run(&mut ours, settings(1e-8, 2, 1.0), 2.0, &mut [0.1, 0.0]);
    assert_eq!((report.reason, ours.states.len()), (Reason::End, 200));
    for (theirs, ours) in independent.y.iter().zip(&ours.states) {
        assert!(
            (theirs[0] - ours[0]).abs() < 1e-7 && (theirs[1] - ours[1]).abs() < 1e-6,
            "{theirs:?} {ours:?}"
        );
    }
    assert_eq!(independent.y.len(), 200);
}
