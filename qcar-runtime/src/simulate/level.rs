//! The rest of a ride, once the tyre has come to level ground: a linear axle, and a force that changes smoothly.
//!
//! There the steps of the general method are limited by the stability of the fastest mode. An exponential method has no
//! such limit: it goes from sample to sample, and where it is not exact enough it leaves the motion to the general one.

use super::failure::SimulateError;
use super::gap::AROUND;
use super::recorder::Recorder;
use super::rolling::Rolling;
use super::settings::{Method, Settings, scales};
use crate::model::{About, Contact, Model};
use crate::solver::{Driven, Effort, ExponentialAdams, PAST};
use crate::vectors::{Loops, widest};

/// The exponential method for the rest of a ride.
pub(super) struct Rest {
    adams: ExponentialAdams<2>,
    relative: f64,
    absolute: Vec<f64>,
    /// Ends of steps: every so many samples, s.
    times: Vec<f64>,
}

/// A step is as many samples as fit into so many seconds. Longer ones are not exact enough as the tyre leaves a cleat.
const STEP: f64 = 2e-3;

/// So many steps are left to the general method where the other was not exact enough; then twice as many.
const PATIENCE: usize = 16;

impl Rest {
    /// For a ride that is sampled at `samples`, s. None where the axle is not linear, where steps of a given length were
    /// asked for, or where samples are too far apart or too few.
    pub fn new<M: Model + ?Sized>(
        rolling: &Rolling<'_, M>,
        about: &About,
        settings: &Settings,
        samples: &[f64],
    ) -> Option<Self> {
        let (Method::Adaptive(relative), &[first, second, ..]) = (settings.method, samples) else {
            return None;
        };
        if !rolling.is_linear() {
            return None;
        }
        let period = second - first;
        // A hair more, so that rounding loses no sample.
        let longest = ((STEP / period + 1e-6) as usize).max(1);
        let (stride, adams) = (1..=longest).rev().find_map(|stride| {
            let adams = ExponentialAdams::new(&OnLevel::new(rolling), about.states.len(), stride as f64 * period)?;
            (samples.len() >= stride * AROUND).then_some((stride, adams))
        })?;
        let to_the_last = (samples.len() - 1) % stride;
        let times = samples[to_the_last..].iter().step_by(stride).copied().collect();
        let absolute = scales(about).map(|scale| relative * scale).collect();
        Some(Self {
            adams,
            relative,
            absolute,
            times,
        })
    }

    /// Integrates from `start` to the last sample: by `general`, which takes a span and breaks in it, until the ground
    /// has been level for as many samples as the other method needs; by that one from there on.
    pub fn integrate<M: Model + ?Sized>(
        &mut self,
        recorder: &mut Recorder<'_, M>,
        (start, level): (f64, f64),
        x: &mut [f64],
        general: impl Fn(&mut Recorder<'_, M>, (f64, f64), &[f64], &mut [f64]) -> Result<Effort, SimulateError>,
    ) -> Result<Effort, SimulateError> {
        let (mut effort, mut time, mut patience) = (Effort::default(), start, PATIENCE);
        let last = self.times.len() - 1;
        let mut sample = self.times.partition_point(|&time| time < level.max(start)) + PAST;
        loop {
            sample = sample.min(last);
            let breaks = &self.times[sample.saturating_sub(PAST - 1)..sample];
            effort += general(recorder, (time, self.times[sample]), breaks, x)?;
            let advance = self.advance(recorder, sample, x);
            effort += advance;
            sample += advance.accepted;
            if sample == last {
                return Ok(effort);
            }
            time = self.times[sample];
            sample += patience;
            patience *= 2;
        }
    }

    /// Steps on from a sample as far as the motion is smooth: what that cost.
    fn advance<M: Model + ?Sized>(&mut self, recorder: &mut Recorder<'_, M>, sample: usize, x: &mut [f64]) -> Effort {
        recorder.note_force(self.times[sample], x);
        let Some(past) = recorder.past_forces(&self.times[(sample + 1).saturating_sub(PAST)..=sample]) else {
            return Effort::default();
        };
        self.adams.begin(x, &past);
        let accepted = widest(Steps {
            rest: self,
            recorder,
            sample,
        });
        x.copy_from_slice(self.adams.state());
        // It ends with a step that was refused, or with the last sample.
        let rejected = usize::from(sample + accepted + 1 < self.times.len());
        Effort {
            evaluations: accepted + rejected,
            accepted,
            rejected,
            events: 0,
        }
    }

    /// One step to a time, s; false where it cannot be made.
    #[inline(always)]
    fn step<M: Model + ?Sized>(&mut self, recorder: &mut Recorder<'_, M>, time: f64) -> bool {
        let mut level = OnLevel::new(recorder.rolling());
        let advanced = self.adams.advance(&mut level, time, self.relative, &self.absolute);
        if advanced {
            let contact = level.contact;
            recorder.record_step(time, self.adams.state(), contact);
        }
        advanced
    }
}

/// Steps on from a sample, with the instructions of this machine.
struct Steps<'s, 'r, 'a, M: ?Sized> {
    rest: &'s mut Rest,
    recorder: &'r mut Recorder<'a, M>,
    sample: usize,
}

impl<M: Model + ?Sized> Loops for Steps<'_, '_, '_, M> {
    type Result = usize;

    #[inline(always)]
    fn run(self) -> usize {
        let mut sample = self.sample + 1;
        while sample < self.rest.times.len() && self.rest.step(self.recorder, self.rest.times[sample]) {
            sample += 1;
        }
        sample - self.sample - 1
    }
}

/// An axle whose tyre is on level ground.
struct OnLevel<'r, 'a, M: ?Sized> {
    rolling: &'r Rolling<'a, M>,
    /// The last that was asked for.
    contact: Contact,
}

impl<'r, 'a, M: Model + ?Sized> OnLevel<'r, 'a, M> {
    fn new(rolling: &'r Rolling<'a, M>) -> Self {
        Self {
            rolling,
            contact: Contact::default(),
        }
    }
}

impl<M: Model + ?Sized> Driven<2> for OnLevel<'_, '_, M> {
    fn rate(&self, x: &[f64], force: [f64; 2], dx: &mut [f64]) {
        let contact = Contact {
            force,
            ..Contact::default()
        };
        self.rolling.move_by(&contact, x, dx, &mut []);
    }

    #[inline(always)]
    fn force(&mut self, t: f64, x: &[f64]) -> Option<[f64; 2]> {
        self.contact = self.rolling.level_contact(t, x)?;
        Some(self.rolling.driven(self.contact).force)
    }
}
