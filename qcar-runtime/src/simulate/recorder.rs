//! What is recorded of a rolling model.

use super::rolling::Rolling;
use super::sampling::Grid;
use crate::model::{Contact, Model};
use crate::solver::{After, Event, Step, System};

/// A rolling model with its records.
pub(super) struct Recorder<'a, M: ?Sized> {
    rolling: Rolling<'a, M>,
    grid: Grid,
    /// Each output on the fine grid.
    fine: Vec<Vec<f64>>,
    /// Room for a state, its derivative, and the signals.
    room: [Vec<f64>; 3],
    /// Force of the tyre on the wheel in z and x at the samples, N.
    pub force: [Vec<f64>; 2],
    /// Area of its contact at the samples, m².
    pub area: Vec<f64>,
    /// When the tyre lost the ground, s.
    pub lift_offs: Vec<f64>,
    /// When it came back, s.
    pub landings: Vec<f64>,
    /// Time of the last evaluation, and whether the tyre was on the ground.
    last: (f64, bool),
}

/// The signals behind the outputs: force of the tyre in z and x, and its deflection.
const OF_CONTACT: usize = 3;

impl<'a, M: Model + ?Sized> Recorder<'a, M> {
    pub fn new(rolling: Rolling<'a, M>, grid: Grid, states: usize, outputs: usize) -> Self {
        let samples = || Vec::with_capacity(grid.samples());
        Self {
            rolling,
            fine: (0..outputs).map(|_| Vec::with_capacity(grid.points())).collect(),
            room: [states, states, outputs + OF_CONTACT].map(|n| vec![0.0; n]),
            force: [samples(), samples()],
            area: samples(),
            lift_offs: Vec::new(),
            landings: Vec::new(),
            last: (f64::NAN, true),
            grid,
        }
    }

    /// Records a car that is at rest in state `x` until a time, s.
    pub fn rest(&mut self, until: f64, x: &[f64]) {
        let [_, dx, signals] = &mut self.room;
        observe(&self.rolling, until, x, dx, signals);
        while let Some((_, is_sample)) = self.grid.next(until.next_down()) {
            self.record(is_sample);
        }
    }

    /// Takes down the signals in the room.
    fn record(&mut self, is_sample: bool) {
        let signals = &self.room[2];
        for (fine, y) in self.fine.iter_mut().zip(signals) {
            fine.push(*y);
        }
        if let (true, [.., z, x, deflection]) = (is_sample, &signals[..]) {
            self.force[0].push(*z);
            self.force[1].push(*x);
            self.area.push(self.rolling.tyre.area(*deflection));
        }
    }

    /// Each output at the samples.
    pub fn outputs(&self) -> Vec<Vec<f64>> {
        self.fine.iter().map(|fine| self.grid.decimate(fine)).collect()
    }
}

impl<M: Model + ?Sized> System for Recorder<'_, M> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let (dx, signals) = dx.split_at_mut(x.len());
        self.last = (t, observe(&self.rolling, t, x, dx, signals));
    }

    fn signals(&self) -> usize {
        self.room[2].len()
    }

    fn enter(&mut self, t: f64, x: &mut [f64]) {
        self.rolling.pass_steps(t, x);
    }

    fn accept(&mut self, step: &Step<'_>) {
        let smooth = step.has_signals();
        while let Some((t, is_sample)) = self.grid.next(step.end) {
            let [x, dx, signals] = &mut self.room;
            if smooth {
                step.signals_at(t, signals);
            } else {
                step.at(t, x);
                observe(&self.rolling, t, x, dx, signals);
            }
            self.record(is_sample);
        }
    }

    /// Two: the tyre loses or finds the ground, and a point contact comes to a vertical step.
    fn events(&self) -> usize {
        2
    }

    fn event_values(&mut self, t: f64, x: &[f64], values: &mut [f64]) {
        // A step's last evaluation is that at its end: there the ground need not be looked for again.
        let grounded = if t == self.last.0 {
            self.last.1
        } else {
            self.rolling.touch(t, x).is_some()
        };
        values[0] = if grounded { 1.0 } else { -1.0 };
        values[1] = self.rolling.to_next_step(t, x);
    }

    fn happen(&mut self, event: &Event<'_>) -> After {
        match (event.index, event.rising) {
            (0, true) => self.landings.push(event.time),
            (0, false) => self.lift_offs.push(event.time),
            _ => {}
        }
        After::Restart
    }
}

/// Derivative and signals at time `t`, and whether the tyre is on the ground.
#[inline]
fn observe<M: Model + ?Sized>(
    rolling: &Rolling<'_, M>,
    t: f64,
    x: &[f64],
    dx: &mut [f64],
    signals: &mut [f64],
) -> bool {
    let (outputs, of_contact) = signals.split_at_mut(signals.len() - OF_CONTACT);
    let contact = rolling.motion(t, x, dx, outputs);
    let Contact { s, force, .. } = contact.unwrap_or_default();
    of_contact.copy_from_slice(&[force[0], force[1], -s]);
    contact.is_some()
}
