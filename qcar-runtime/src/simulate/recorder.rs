//! What is recorded of a rolling model.

use super::rolling::Rolling;
use super::sampling::Grid;
use crate::model::Model;
use crate::solver::{After, Event, Step, System};

/// A rolling model with its records.
pub(super) struct Recorder<'a, M: ?Sized> {
    rolling: Rolling<'a, M>,
    grid: Grid,
    /// Each output on the fine grid.
    fine: Vec<Vec<f64>>,
    /// Room for one state and for its outputs.
    room: (Vec<f64>, Vec<f64>),
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

impl<'a, M: Model + ?Sized> Recorder<'a, M> {
    pub fn new(rolling: Rolling<'a, M>, grid: Grid, states: usize, outputs: usize) -> Self {
        let samples = || Vec::with_capacity(grid.samples());
        Self {
            rolling,
            fine: (0..outputs).map(|_| Vec::with_capacity(grid.points())).collect(),
            room: (vec![0.0; states], vec![0.0; outputs]),
            force: [samples(), samples()],
            area: samples(),
            lift_offs: Vec::new(),
            landings: Vec::new(),
            last: (f64::NAN, true),
            grid,
        }
    }

    /// Each output at the samples.
    pub fn outputs(&self) -> Vec<Vec<f64>> {
        self.fine.iter().map(|fine| self.grid.decimate(fine)).collect()
    }
}

impl<M: Model + ?Sized> System for Recorder<'_, M> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.last = (t, self.rolling.derivative(t, x, dx));
    }

    fn enter(&mut self, t: f64, x: &mut [f64]) {
        self.rolling.pass_steps(t, x);
    }

    fn accept(&mut self, step: &Step<'_>) {
        let (x, y) = &mut self.room;
        for (t, is_sample) in self.grid.on(step) {
            step.at(t, x);
            let (touch, contact) = self.rolling.outputs(t, x, y);
            for (fine, y) in self.fine.iter_mut().zip(y.iter()) {
                fine.push(*y);
            }
            if is_sample {
                self.force[0].push(contact.force[0]);
                self.force[1].push(contact.force[1]);
                self.area
                    .push(touch.map_or(0.0, |touch| self.rolling.tyre.area(touch.deflection)));
            }
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
