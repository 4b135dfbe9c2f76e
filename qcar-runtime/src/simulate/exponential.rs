//! A faster method for linear axles: an exponential method while the force of the tyre is smooth.
//!
//! The steps of the general method are limited by the stability of the fastest mode, and each takes six evaluations.
//! The exponential method has no such limit and takes one: it steps from sample to sample as long as its polynomials
//! approximate the force, and leaves the rest to the general method.

use super::rolling::Rolling;
use super::sampling::Grid;
use super::settings::{Method, Settings, scales};
use crate::model::{About, Contact, Model};
use crate::solver::{Driven, Effort, ExponentialAdams, PAST};

/// The exponential method, with the past forces that it needs to begin.
pub(super) struct ExponentialStepper {
    adams: ExponentialAdams<2>,
    relative: f64,
    absolute: Vec<f64>,
    /// Ends of the shortest steps, s.
    times: Vec<f64>,
    /// Index of the next of them.
    next: usize,
    /// Number of the shortest steps in one step of the exponential method.
    stride: usize,
    /// Forces at the last times, between which the force is smooth.
    past: Vec<[f64; 2]>,
    /// Position of the wheel's centre at the last time, m.
    centre: [f64; 2],
    /// Number of times to skip before the next attempt if that attempt gains nothing.
    patience: usize,
    effort: Effort,
}

/// Approximate step on uneven ground, s; on level ground it is twice that. If samples are further apart, it is half of
/// their distance, or all of it for a point contact, which steps so on level ground too.
///
/// The error control judges only the force. Free vibrations of a light mass are exact at the steps but interpolated by
/// polynomials between them: with steps of 2 ms this is accurate up to about 100 Hz, and wrong above 200 Hz.
const STEP: f64 = 1e-3;

impl ExponentialStepper {
    /// The stepper of a ride that is recorded on a grid. `None` if the axle is not linear, or if the settings ask for
    /// steps of a given length. The method of another ride of the `same` car with the same step saves a matrix
    /// exponential.
    pub fn new<M: Model + ?Sized>(
        rolling: &Rolling<'_, M>,
        about: &About,
        settings: &Settings,
        grid: &Grid,
        same: Option<&ExponentialAdams<2>>,
    ) -> Option<Self> {
        let (Method::Adaptive(relative), true) = (settings.method, rolling.is_linear()) else {
            return None;
        };
        let times = grid.steps(STEP);
        let step = times.get(1)? - times[0];
        let doublings = usize::from(step < 1.5 * STEP);
        let same = same.filter(|same| same.steps_by(step, doublings)).cloned();
        let new = || ExponentialAdams::new(&Smooth::new(rolling), about.states.len(), step, doublings);
        Some(Self {
            adams: same.or_else(new)?,
            relative,
            absolute: scales(about).map(|scale| relative * scale).collect(),
            next: times.partition_point(|t| rolling.speed * t < rolling.smooth_from),
            times,
            stride: 1,
            past: Vec::with_capacity(PAST),
            centre: [f64::NAN; 2],
            patience: 1,
            effort: Effort::default(),
        })
    }

    /// The next time at which it needs the force, s.
    pub fn next_time(&self) -> f64 {
        self.times.get(self.next).copied().unwrap_or(f64::INFINITY)
    }

    /// Skips the times up to `t`.
    pub fn pass(&mut self, t: f64) {
        while self.next_time() <= t {
            self.next += 1;
            self.past.clear();
        }
    }

    /// Stores the force at time `t`, which the general method has reached.
    pub fn note<M: Model + ?Sized>(&mut self, rolling: &Rolling<'_, M>, t: f64, x: &[f64], force: Option<[f64; 2]>) {
        self.pass(t.next_down());
        if self.next_time() > t {
            return;
        }
        self.next += 1;
        let centre = rolling.centre(t, x);
        if self.past.len() == PAST {
            self.past.remove(0);
        }
        if force.is_none() || rolling.has_kink_between(self.centre, centre) {
            self.past.clear();
        }
        self.past.extend(force);
        self.centre = centre;
    }

    /// Begins at time `t` if enough past forces are known.
    pub fn begin(&mut self, t: f64, x: &[f64]) -> bool {
        let known = self
            .past
            .as_array()
            .filter(|_| self.next > 0 && self.times[self.next - 1] == t);
        let Some(past) = known else {
            return false;
        };
        self.adams.begin(x, past);
        (self.stride, self.effort) = (1, Effort::default());
        true
    }

    /// Takes a step. Returns its end time and contact; `None` if the step is rejected or the ride is over.
    #[inline(always)]
    pub fn step<M: Model + ?Sized>(&mut self, rolling: &Rolling<'_, M>) -> Option<(f64, Contact)> {
        if self.wants_longer(rolling) {
            self.lengthen();
        }
        let time = self.ahead()?;
        let mut smooth = Smooth {
            rolling,
            centre: self.centre,
            contact: Contact::default(),
        };
        let good = self.adams.advance(&mut smooth, time, self.relative, &self.absolute);
        self.count(good.then_some(smooth.centre));
        good.then_some((time, smooth.contact))
    }

    /// True if steps may be twice as long from now on.
    #[inline(always)]
    pub fn wants_longer<M: Model + ?Sized>(&self, rolling: &Rolling<'_, M>) -> bool {
        let left = self.times.len() - self.next;
        self.stride == 1 && left.is_multiple_of(2) && rolling.is_level(self.centre) && self.adams.may_double()
    }

    /// Doubles the step if enough past forces are known.
    pub fn lengthen(&mut self) {
        if self.adams.lengthen() {
            self.stride = 2;
        }
    }

    /// The end of the next step, s; `None` after the last.
    #[inline(always)]
    pub fn ahead(&self) -> Option<f64> {
        self.times.get(self.next + self.stride - 1).copied()
    }

    /// Position of the wheel's centre, m.
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Counts an attempted step. If it is accepted, the wheel's centre is at this position at its end, m.
    #[inline(always)]
    pub fn count(&mut self, centre: Option<[f64; 2]>) {
        self.effort.evaluations += 1;
        match centre {
            Some(centre) => {
                self.effort.accepted += 1;
                (self.next, self.centre) = (self.next + self.stride, centre);
            }
            None => self.effort.rejected += 1,
        }
    }

    /// The exponential method.
    pub fn method(&mut self) -> &mut ExponentialAdams<2> {
        &mut self.adams
    }

    /// Tolerances, relative to each state and absolute.
    pub fn tolerance(&self) -> (f64, &[f64]) {
        (self.relative, &self.absolute)
    }

    /// The state.
    pub fn state(&self) -> &[f64] {
        self.adams.state()
    }

    /// Hands the ride back to the general method. Returns the time, s, and the effort.
    pub fn end(&mut self) -> (f64, Effort) {
        self.past.clear();
        let ended = self.times[self.next - 1];
        if self.effort.accepted < PAST {
            self.next += self.patience;
            self.patience *= 2;
        } else {
            self.patience = 1;
        }
        (ended, self.effort)
    }
}

/// A linear axle under a force that is smooth from a position of the wheel's centre on.
struct Smooth<'r, 'a, M: ?Sized> {
    rolling: &'r Rolling<'a, M>,
    centre: [f64; 2],
    /// The last contact that was computed.
    contact: Contact,
}

impl<'r, 'a, M: Model + ?Sized> Smooth<'r, 'a, M> {
    fn new(rolling: &'r Rolling<'a, M>) -> Self {
        Self {
            rolling,
            centre: [f64::NAN; 2],
            contact: Contact::default(),
        }
    }
}

impl<M: Model + ?Sized> Driven<2> for Smooth<'_, '_, M> {
    fn rate(&self, x: &[f64], force: [f64; 2], dx: &mut [f64]) {
        let contact = Contact {
            force,
            ..Contact::default()
        };
        self.rolling.move_by(&contact, x, dx, &mut []);
    }

    #[inline(always)]
    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; 2]> {
        let before = std::mem::replace(&mut self.centre, self.rolling.centre(t, x));
        if self.rolling.has_kink_between(before, self.centre) {
            return None;
        }
        self.contact = self.rolling.contact_at(t, x)?;
        Some(self.rolling.driven(self.contact).force)
    }
}
