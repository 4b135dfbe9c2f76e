//! An explicit Runge–Kutta pair of order 5(4) of Dormand and Prince, with dense output and PI step control.
//!
//! J. R. Dormand, P. J. Prince, "A family of embedded Runge–Kutta formulae", J. Comp. Appl. Math. 6 (1980) 19–26: of
//! the two pairs that they recommend, this is RK5(4)7S, which has the larger region of stability. Its limit is a
//! product of step and rate of 5.7, that of the better known 7M is 3.3. Axles with small masses on dampers are stiff
//! enough for this to matter. Dense output and step control after Hairer, Nørsett, Wanner, *Solving Ordinary
//! Differential Equations I*, II.4–II.6.

use super::control::Control;
use super::events::{Crossing, LOOK_AHEAD, Watch};
use super::fastest::{ITERATIONS, fastest_rate};
use super::{After, Effort, Reason, Report, Step, System, all_finite, over_legs, shortest_step};
use crate::vectors::{Loops, widest};

/// Tolerances and limits of the adaptive integrator.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Relative tolerance of every state.
    pub relative: f64,
    /// Absolute tolerance of each state, in its unit.
    pub absolute: Vec<f64>,
    /// Longest step, s: no feature of the right-hand side that lasts longer is missed.
    pub longest_step: f64,
    /// Most attempted steps, accepted or not.
    pub most_steps: usize,
}

/// An adaptive integrator with its workspace.
pub struct DormandPrince {
    settings: Settings,
    /// State at the start and at the end of the step.
    x: Vec<f64>,
    x_end: Vec<f64>,
    stage: Vec<f64>,
    /// Derivatives at the stages, each followed by its signals; the last is the first of the next step.
    k: [Vec<f64>; 7],
    quartic: Vec<f64>,
    /// Mean rate of each state and mean of each signal over the step.
    means: Vec<f64>,
    watch: Watch,
    control: Control,
    effort: Effort,
}

impl DormandPrince {
    /// An integrator for systems of `settings.absolute.len()` states and the given number of event functions.
    pub fn new(settings: Settings, events: usize) -> Self {
        let n = settings.absolute.len();
        let row = || vec![0.0; n];
        Self {
            x: row(),
            x_end: row(),
            stage: row(),
            k: std::array::from_fn(|_| row()),
            quartic: row(),
            means: Vec::new(),
            watch: Watch::new(n, events),
            control: Control::new(settings.longest_step),
            effort: Effort::default(),
            settings,
        }
    }

    /// Integrates from `span.0` to `span.1`, starting at `x`, which becomes the state at the end.
    ///
    /// `breaks` are the ascending times at which the right-hand side jumps.
    pub fn integrate<S: System>(&mut self, system: &mut S, span: (f64, f64), breaks: &[f64], x: &mut [f64]) -> Report {
        self.effort = Effort::default();
        self.control = Control::new(self.settings.longest_step);
        self.resume(system, Effort::default(), span, breaks, x)
    }

    /// Continues where the system took over, with the same step length. The system spent `effort` to reach `span.0` and
    /// `x`, which is added to the earlier effort.
    pub fn resume<S: System>(
        &mut self,
        system: &mut S,
        effort: Effort,
        span: (f64, f64),
        breaks: &[f64],
        x: &mut [f64],
    ) -> Report {
        self.effort += effort;
        widest(Integration {
            by: self,
            system,
            span,
            breaks,
            x,
        })
    }

    #[inline(always)]
    fn run<S: System>(&mut self, system: &mut S, span: (f64, f64), breaks: &[f64], x: &mut [f64]) -> Report {
        self.make_room(system.signals());
        self.x.copy_from_slice(x);
        let shortest = shortest_step(span.0, span.1);
        let (reason, time) = over_legs(span, breaks, |leg| self.leg(system, leg, shortest));
        x.copy_from_slice(&self.x);
        Report {
            reason,
            time,
            effort: self.effort,
        }
    }

    /// Allocates memory for signals after the derivatives.
    fn make_room(&mut self, signals: usize) {
        let rows = self.k.iter_mut().chain([&mut self.quartic, &mut self.means]);
        rows.for_each(|row| row.resize(self.x.len() + signals, 0.0));
    }

    /// Integrates over one smooth leg; returns the stopping reason and time.
    #[inline(always)]
    fn leg<S: System>(&mut self, system: &mut S, (start, end): (f64, f64), shortest: f64) -> (Reason, f64) {
        let mut t = start;
        let mut fresh = true;
        let mut crowd = 0;
        while t < end {
            if std::mem::take(&mut fresh) && !self.begin(system, t, end) {
                return (Reason::NotFinite, t);
            }
            if self.effort.accepted + self.effort.rejected >= self.settings.most_steps {
                return (Reason::TooManySteps, t);
            }
            let (t_end, h) = self.control.next(t, end.min(self.bend(system, t)));
            let error = self.attempt(system, t, t_end, h);
            if !self.control.judge(error, h) {
                self.effort.rejected += 1;
                if self.control.step < shortest {
                    return (
                        if error.is_finite() {
                            Reason::StepTooSmall
                        } else {
                            Reason::NotFinite
                        },
                        t,
                    );
                }
                continue;
            }
            self.effort.accepted += 1;
            let cut = self.settle(system, (t, t_end), h, error);
            let before = std::mem::replace(&mut t, cut.map_or(t_end, |(_, crossing)| crossing.time));
            crowd = if t - before < shortest { crowd + 1 } else { 0 };
            match cut {
                Some((After::Stop, crossing)) => return (Reason::Event(crossing.index), t),
                Some(_) if crowd > MOST_AT_ONCE => return (Reason::Crowded, t),
                Some(_) => fresh = true,
                None if system.takes_over(t, &self.x) => return (Reason::TakenOver, t),
                None => {}
            }
        }
        (Reason::End, t)
    }

    /// Enters a leg: its first slope, and a first step if none is known. False if it is not finite.
    fn begin<S: System>(&mut self, system: &mut S, t: f64, end: f64) -> bool {
        system.enter(t, &mut self.x);
        system.derivative(t, &self.x, &mut self.k[0]);
        self.effort.evaluations += 1;
        if !all_finite(&self.x) || !all_finite(&self.k[0][..self.x.len()]) {
            return false;
        }
        if self.control.step == 0.0 {
            let stable = self.stable_step(system, t);
            self.control.limit(stable);
            self.control.step = self.first_step(system, t, end).max(shortest_step(t, end));
        }
        self.watch
            .begin(system, t, LOOK_AHEAD * self.control.step, &self.x, &self.k[0]);
        true
    }

    /// Latest end of the next step, so that it contains no kink except one at its beginning.
    fn bend<S: System>(&self, system: &S, t: f64) -> f64 {
        let from = t + BEHIND * self.control.step;
        system.next_kink(t, &self.x, &self.k[0][..self.x.len()], from)
    }

    /// The longest step that damps the fastest mode at the start; NaN without one.
    ///
    /// The error control would find it too, but only after failed steps.
    fn stable_step<S: System>(&mut self, system: &mut S, t: f64) -> f64 {
        let [slope, moved_slope, ..] = &mut self.k;
        self.effort.evaluations += ITERATIONS;
        let room = (&mut self.stage[..], &mut moved_slope[..]);
        STABLE / fastest_rate(system, t, (&self.x, slope), &self.settings.absolute, room)
    }

    /// A first step from the sizes of the first and second derivatives (Hairer, Nørsett, Wanner, II.4).
    fn first_step<S: System>(&mut self, system: &mut S, t: f64, end: f64) -> f64 {
        let longest = self.settings.longest_step.min(end - t);
        let (d0, d1) = (self.norm(&self.x), self.norm(&self.k[0]));
        let guess = if d0 < 1e-5 || d1 < 1e-5 { 1e-6 } else { 0.01 * d0 / d1 }.min(longest);
        combine(&mut self.stage, &self.x, guess, [1.0], [&self.k[0]]);
        self.evaluate(system, t + guess, 1);
        combine(&mut self.stage, &self.k[1], -1.0, [1.0], [&self.k[0]]);
        let steepest = d1.max(self.norm(&self.stage) / guess);
        let step = if steepest <= 1e-15 {
            guess.max(1e-6)
        } else {
            (0.01 / steepest).powf(0.2)
        };
        if step.is_finite() {
            step.min(100.0 * guess).min(longest)
        } else {
            guess
        }
    }

    /// RMS of `v`, with each entry relative to the tolerance of its state.
    fn norm(&self, v: &[f64]) -> f64 {
        let scaled = v.iter().zip(&self.x).zip(&self.settings.absolute);
        let sum: f64 = scaled
            .map(|((v, x), a)| (v / (a + self.settings.relative * x.abs())).powi(2))
            .sum();
        (sum / self.x.len().max(1) as f64).sqrt()
    }

    /// `k[stage] = f(t, x)` at the prepared stage.
    fn evaluate<S: System>(&mut self, system: &mut S, t: f64, stage: usize) {
        system.derivative(t, &self.stage, &mut self.k[stage]);
        self.effort.evaluations += 1;
    }

    /// Evaluates the stages up to `x_end`. Returns the error over tolerance, NaN if anything is not finite.
    #[inline(always)]
    fn attempt<S: System>(&mut self, system: &mut S, t: f64, t_end: f64, h: f64) -> f64 {
        combine(&mut self.stage, &self.x, h, A2, [&self.k[0]]);
        self.evaluate(system, t + C[0] * h, 1);
        combine(&mut self.stage, &self.x, h, A3, [&self.k[0], &self.k[1]]);
        self.evaluate(system, t + C[1] * h, 2);
        combine(&mut self.stage, &self.x, h, A4, [&self.k[0], &self.k[1], &self.k[2]]);
        self.evaluate(system, t + C[2] * h, 3);
        combine(
            &mut self.stage,
            &self.x,
            h,
            A5,
            [&self.k[0], &self.k[1], &self.k[2], &self.k[3]],
        );
        self.evaluate(system, t + C[3] * h, 4);
        combine(
            &mut self.stage,
            &self.x,
            h,
            A6,
            [&self.k[0], &self.k[1], &self.k[2], &self.k[3], &self.k[4]],
        );
        self.evaluate(system, t_end, 5);
        combine(
            &mut self.x_end,
            &self.x,
            h,
            A7,
            [&self.k[0], &self.k[2], &self.k[3], &self.k[4], &self.k[5]],
        );
        system.derivative(t_end, &self.x_end, &mut self.k[6]);
        self.effort.evaluations += 1;
        self.measure(h)
    }

    /// RMS of the error estimate over tolerance.
    #[inline(always)]
    fn measure(&mut self, h: f64) -> f64 {
        let n = self.x.len();
        let [k0, _, k2, k3, k4, k5, k6] = self.k.each_ref().map(|k| &k[..n]);
        let (x, x_end, absolute) = (&self.x[..n], &self.x_end[..n], &self.settings.absolute[..n]);
        let scaled = &mut self.stage[..n];
        for i in 0..n {
            let k = [k0[i], k2[i], k3[i], k4[i], k5[i], k6[i]];
            let scale = absolute[i] + self.settings.relative * x[i].abs().max(x_end[i].abs());
            // An infinite state would be hidden by its own tolerance; zero times it is NaN.
            scaled[i] = h * dot(ERROR, k) / scale + 0.0 * (x_end[i] + k6[i]);
        }
        mean_square(scaled).sqrt()
    }

    /// Data for the dense output of an accepted step besides its ends: the quartic term, and means.
    #[inline(always)]
    fn make_dense(&mut self) {
        let n = self.quartic.len();
        let [k0, _, k2, k3, k4, k5, k6] = self.k.each_ref().map(|k| &k[..n]);
        let (quartic, means) = (&mut self.quartic[..n], &mut self.means[..n]);
        for i in 0..n {
            quartic[i] = dot(DENSE, [k0[i], k2[i], k3[i], k4[i], k5[i], k6[i]]);
            means[i] = dot(A7, [k0[i], k2[i], k3[i], k4[i], k5[i]]);
        }
    }

    /// Completes an accepted step, up to the first event that ends it. Returns that event and its consequence.
    #[inline(always)]
    fn settle<S: System>(
        &mut self,
        system: &mut S,
        (t, t_end): (f64, f64),
        h: f64,
        error: f64,
    ) -> Option<(After, Crossing)> {
        self.make_dense();
        let states = [&self.x[..], &self.x_end[..]];
        let slopes = [&self.k[0][..], &self.k[6][..]];
        let step = Step {
            start: t,
            end: t_end,
            length: h,
            states,
            slopes,
            quartic: &self.quartic,
            means: &self.means,
            error: error * self.control.longest / h,
        };
        let cut = self.watch.first_cut(system, &step, &mut self.effort);
        match cut {
            Some((_, crossing)) => {
                system.accept(&step.until(crossing.time));
                self.x.copy_from_slice(&self.watch.state);
            }
            None => {
                system.accept(&step);
                std::mem::swap(&mut self.x, &mut self.x_end);
                self.k.swap(0, 6);
            }
        }
        cut
    }
}

/// `out = x + h Σ a k`.
#[inline(always)]
fn combine<const N: usize>(out: &mut [f64], x: &[f64], h: f64, a: [f64; N], k: [&Vec<f64>; N]) {
    let n = out.len();
    let (x, a, k) = (&x[..n], a.map(|a| a * h), k.map(|k| &k[..n]));
    for i in 0..n {
        out[i] = x[i] + dot(a, std::array::from_fn(|j| k[j][i]));
    }
}

/// A loop over all states with its arguments, for wide vectors.
struct Integration<'a, S> {
    by: &'a mut DormandPrince,
    system: &'a mut S,
    span: (f64, f64),
    breaks: &'a [f64],
    x: &'a mut [f64],
}

impl<S: System> Loops for Integration<'_, S> {
    type Result = Report;

    #[inline(always)]
    fn run(self) -> Report {
        self.by.run(self.system, self.span, self.breaks, self.x)
    }
}

/// In lanes, so that the sums are independent.
#[inline(always)]
fn mean_square(v: &[f64]) -> f64 {
    let (chunks, rest) = v.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for chunk in chunks {
        for (sum, v) in sums.iter_mut().zip(chunk) {
            *sum += v * v;
        }
    }
    let rest: f64 = rest.iter().map(|v| v * v).sum();
    (sums.iter().sum::<f64>() + rest) / v.len().max(1) as f64
}

#[inline(always)]
fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    (1..N).fold(a[0] * b[0], |sum, i| sum + a[i] * b[i])
}

/// Largest number of events at one time; more in succession are a recurring one.
const MOST_AT_ONCE: usize = 4;

/// Share of a step within which a kink counts as passed, since it cannot be predicted more accurately.
const BEHIND: f64 = 0.05;

/// Product of step and rate up to which modes are damped, with a margin to the limit of 5.7.
const STABLE: f64 = 5.2;

// The tableau RK5(4)7S; the second stage has no weight in A7, ERROR and DENSE, and the seventh none in A7.
const C: [f64; 4] = [2.0 / 9.0, 1.0 / 3.0, 5.0 / 9.0, 2.0 / 3.0];
const A2: [f64; 1] = [2.0 / 9.0];
const A3: [f64; 2] = [1.0 / 12.0, 1.0 / 4.0];
const A4: [f64; 3] = [55.0 / 324.0, -25.0 / 108.0, 50.0 / 81.0];
const A5: [f64; 4] = [83.0 / 330.0, -13.0 / 22.0, 61.0 / 66.0, 9.0 / 110.0];
const A6: [f64; 5] = [-19.0 / 28.0, 9.0 / 4.0, 1.0 / 7.0, -27.0 / 7.0, 22.0 / 7.0];
const A7: [f64; 5] = [19.0 / 200.0, 3.0 / 5.0, -243.0 / 400.0, 33.0 / 40.0, 7.0 / 80.0];
/// Fifth-order less fourth-order weights.
const ERROR: [f64; 6] = [
    11.0 / 1250.0,
    -33.0 / 500.0,
    891.0 / 5000.0,
    -33.0 / 250.0,
    -9.0 / 1000.0,
    1.0 / 50.0,
];
/// Weights of the quartic of the dense output: of the family of fourth order, near the one with the least error.
const DENSE: [f64; 6] = [
    -259.0 / 200.0,
    93.0 / 20.0,
    -1377.0 / 400.0,
    -33.0 / 40.0,
    -87.0 / 80.0,
    2.0,
];
