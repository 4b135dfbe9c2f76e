//! The classical Runge–Kutta method of fourth order with steps of equal length.

use super::events::{LOOK_AHEAD, Watch};
use super::{After, Effort, Reason, Report, Step, System, all_finite, over_legs};

/// A fixed-step integrator with its workspace.
pub struct Rk4 {
    step: f64,
    most_steps: usize,
    x: Vec<f64>,
    x_end: Vec<f64>,
    /// Derivatives at the stages, and at the end of the step for the dense output.
    k: [Vec<f64>; 5],
    watch: Watch,
    effort: Effort,
}

impl Rk4 {
    /// An integrator for systems of `states` states and `events` event functions.
    ///
    /// No step is longer than `step` (s); each leg between breaks is divided into equal steps. It stops after
    /// `most_steps`, since events may accumulate without end, as those of a ball that comes to rest.
    pub fn new(step: f64, most_steps: usize, states: usize, events: usize) -> Self {
        let row = || vec![0.0; states];
        Self {
            step,
            most_steps,
            x: row(),
            x_end: row(),
            k: std::array::from_fn(|_| row()),
            watch: Watch::new(states, events),
            effort: Effort::default(),
        }
    }

    /// Integrates from `span.0` to `span.1`, starting at `x`, which becomes the state at the end.
    ///
    /// `breaks` are the ascending times at which the right-hand side jumps.
    pub fn integrate<S: System>(&mut self, system: &mut S, span: (f64, f64), breaks: &[f64], x: &mut [f64]) -> Report {
        self.effort = Effort::default();
        let signals = system.signals();
        self.k.iter_mut().for_each(|k| k.resize(x.len() + signals, 0.0));
        self.x.copy_from_slice(x);
        let (reason, time) = over_legs(span, breaks, |leg| self.leg(system, leg));
        x.copy_from_slice(&self.x);
        Report {
            reason,
            time,
            effort: self.effort,
        }
    }

    /// Integrates over one smooth leg; after an event that restarts, the rest is divided anew.
    fn leg<S: System>(&mut self, system: &mut S, (start, end): (f64, f64)) -> (Reason, f64) {
        let mut t = start;
        while t < end {
            self.begin(system, t);
            let from = t;
            let steps = ((end - from) / self.step).ceil().max(1.0);
            let mut done = 0.0;
            while done < steps {
                if self.effort.accepted >= self.most_steps {
                    return (Reason::TooManySteps, t);
                }
                done += 1.0;
                let t_end = if done == steps {
                    end
                } else {
                    from + (end - from) * (done / steps)
                };
                if !self.advance(system, t, t_end - t) {
                    return (Reason::NotFinite, t);
                }
                match self.settle(system, t, t_end) {
                    None => t = t_end,
                    Some((After::Stop, index, time)) => return (Reason::Event(index), time),
                    Some((_, _, time)) => {
                        t = time;
                        break;
                    }
                }
            }
        }
        (Reason::End, t)
    }

    fn begin<S: System>(&mut self, system: &mut S, t: f64) {
        system.enter(t, &mut self.x);
        system.derivative(t, &self.x, &mut self.k[0]);
        self.effort.evaluations += 1;
        self.watch.begin(system, t, LOOK_AHEAD * self.step, &self.x, &self.k[0]);
    }

    /// One step to `x_end` with its slope there. Returns false if it is not finite.
    fn advance<S: System>(&mut self, system: &mut S, t: f64, h: f64) -> bool {
        let derivative = |c: f64, x: &[f64], k: &mut [f64]| system.derivative(t + c * h, x, k);
        step(derivative, h, &self.x, &mut self.k, &mut self.x_end);
        self.effort.evaluations += 4;
        all_finite(&self.x_end) && all_finite(&self.k[4][..self.x.len()])
    }

    /// Completes a step, up to the first event that ends it. Returns its consequence, position and time.
    fn settle<S: System>(&mut self, system: &mut S, t: f64, t_end: f64) -> Option<(After, usize, f64)> {
        self.effort.accepted += 1;
        let states = [&self.x[..], &self.x_end[..]];
        let slopes = [&self.k[0][..], &self.k[4][..]];
        let step = Step {
            start: t,
            end: t_end,
            length: t_end - t,
            states,
            slopes,
            quartic: &[],
            means: &[],
            error: f64::INFINITY,
        };
        let cut = self.watch.first_cut(system, &step, &mut self.effort);
        match &cut {
            Some((_, crossing)) => {
                system.accept(&step.until(crossing.time));
                self.x.copy_from_slice(&self.watch.state);
            }
            None => {
                system.accept(&step);
                std::mem::swap(&mut self.x, &mut self.x_end);
                self.k.swap(0, 4);
            }
        }
        cut.map(|(after, crossing)| (after, crossing.index, crossing.time))
    }
}

/// One step of length `h` from `x`, where the slope is `k[0]`, to `x_end`, where it is `k[4]`. `derivative` gets the
/// part of the step as an argument.
pub(crate) fn step(
    mut derivative: impl FnMut(f64, &[f64], &mut [f64]),
    h: f64,
    x: &[f64],
    k: &mut [Vec<f64>; 5],
    x_end: &mut [f64],
) {
    for (stage, c) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
        for ((out, x), k) in x_end.iter_mut().zip(x).zip(&k[stage - 1]) {
            *out = x + c * h * k;
        }
        derivative(c, x_end, &mut k[stage]);
    }
    let [k0, k1, k2, k3, k_end] = k;
    for (i, out) in x_end.iter_mut().enumerate() {
        *out = x[i] + h / 6.0 * (k0[i] + 2.0 * k1[i] + 2.0 * k2[i] + k3[i]);
    }
    derivative(1.0, x_end, k_end);
}
