//! Derivatives of a ride by the parameters of its car: forward sensitivities.
//!
//! Along each direction of the parameters the variational equation `dS/dt = ∂f/∂x S + ∂f/∂p d` is integrated with the
//! motion, under the same error control. Its right-hand side is a central difference of `f` along `(S, d)`: internal
//! differentiation (Bock, "Recent advances in parameter identification techniques for ODE", 1983). It needs only the
//! equations of a model; its error is about 1e-9. The force of an [area](crate::tyre::Geometry::Area) tyre is
//! continuous at kinks, and when the tyre leaves and regains the ground, so the sensitivities do not jump there.
//!
//! The force of a [point](crate::tyre::Geometry::Point) contact jumps at events `g(t, x) = 0` (`simulate/held`), and so
//! do the sensitivities, by `(f⁻ - f⁺) dt/dε` with the shift of the event `dt/dε = -(∂g/∂x S) / (dg/dt)` (Rozenvasser,
//! "General sensitivity equations of discontinuous systems", Autom. Remote Control 28, 1967). An output that jumps has
//! an impulse `(y⁻ - y⁺) dt/dε` in its derivative, which the filter spreads over the samples.

// Difference quotients of the equations of motion.
mod displaced;

use displaced::{Displaced, Here, STEP};

use super::car::Car;
use super::failure::SimulateError;
use super::held::EVENTS;
use super::ride::{Drive, oversampling};
use super::rolling::Rolling;
use super::sampling::{Grid, Tape};
use super::settings::{Method, Settings, scales};
use crate::model::Model;
use crate::solver::{self, After, DormandPrince, Event, Step, System};

/// A ride, and its derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent {
    /// Each output of the model, through [`AntiAlias`](super::AntiAlias), then the vertical force of the tyre on the
    /// wheel, N, at the samples and not filtered.
    pub signals: Vec<Vec<f64>>,
    /// For each direction the derivative of each signal.
    pub slopes: Vec<Vec<Vec<f64>>>,
}

/// Simulates a ride as [`ride`](super::ride()) does, with its derivatives along `directions`, each of which has an
/// entry for every parameter: the derivative by ε of a ride whose parameters are `p + ε direction`.
///
/// # Errors
/// As [`ride`](super::ride()), and if a car displaced along a direction has no static equilibrium.
pub fn tangent<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    settings: &Settings,
    directions: &[Vec<f64>],
) -> Result<Tangent, SimulateError> {
    let (tyre, about) = (car.rolling_tyre(), car.model.about());
    drive.check(&tyre)?;
    let grid = Grid::new(drive.sample_rate, drive.samples, oversampling(&tyre));
    let start = drive.start(&tyre).min(grid.start());
    let span = (drive.reaches(&tyre).max(start), grid.end());
    let steps = |direction: &Vec<f64>| [STEP, -STEP].map(|step| along(car.parameters, direction, step));
    let neighbours: Vec<[Vec<f64>; 2]> = directions.iter().map(steps).collect();
    let (rolling, mut states) = Rolling::at_rest(car, drive.road, drive.speed, start)?;
    let mut moved = Vec::with_capacity(directions.len());
    for [forward, backward] in &neighbours {
        let beside = |parameters| Rolling::at_rest(&Car { parameters, ..*car }, drive.road, drive.speed, start);
        let ((forward, x), (backward, y)) = (beside(forward)?, beside(backward)?);
        states.extend(x.iter().zip(y).map(|(x, y)| (x - y) / (2.0 * STEP)));
        moved.push([forward, backward]);
    }
    let mut varied = PerturbedModels::new(rolling, moved, about.states.len(), about.outputs.len(), grid);
    varied.rest(span.0, &states);
    let longest_step = drive.longest_step(&tyre);
    let (Method::Adaptive(relative) | Method::Fixed(relative)) = settings.method;
    let scales: Vec<f64> = scales(about).map(|scale| relative * scale).collect();
    let settings = solver::Settings {
        relative,
        absolute: scales.repeat(1 + directions.len()),
        longest_step,
        most_steps: settings.most_steps,
    };
    let report = DormandPrince::new(settings, EVENTS).integrate(&mut varied, span, &[], &mut states);
    if report.reason.is_success() {
        Ok(varied.tangent())
    } else {
        let model = about.name.to_string();
        Err(SimulateError::Stopped { model, report })
    }
}

fn along(from: &[f64], direction: &[f64], step: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(from, d)| from + step * d).collect()
}

/// A rolling model, and for each direction the models with parameters one step forward and one step backward.
struct PerturbedModels<'a, M: ?Sized> {
    rolling: Rolling<'a, M>,
    displaced: Displaced<'a, M>,
    /// Number of states of the model.
    states: usize,
    outputs: usize,
    tape: Tape,
    /// The event of a point contact that has just happened.
    crossed: Option<usize>,
    /// Impulses in the derivatives of the outputs, with their times, s: a row of all signals each.
    impulses: Vec<(f64, Vec<f64>)>,
    /// Buffers for a state with its sensitivities, and for the rates and signals of a point.
    state: Vec<f64>,
    rates: Vec<f64>,
}

impl<'a, M: Model + ?Sized> PerturbedModels<'a, M> {
    fn new(
        rolling: Rolling<'a, M>,
        moved: Vec<[Rolling<'a, M>; 2]>,
        states: usize,
        outputs: usize,
        grid: Grid,
    ) -> Self {
        let ways = 1 + moved.len();
        Self {
            tape: Tape::new(grid, ways * (outputs + 1)),
            crossed: None,
            impulses: Vec::new(),
            state: vec![0.0; ways * states],
            rates: vec![0.0; ways * (states + outputs + 1)],
            displaced: Displaced::new(&rolling, moved),
            rolling,
            states,
            outputs,
        }
    }

    /// Records a car that is at rest until a time, s.
    fn rest(&mut self, until: f64, state: &[f64]) {
        let mut rates = std::mem::take(&mut self.rates);
        self.derivative(until, state, &mut rates);
        self.tape.record_rest(until, rates[state.len()..].iter().copied());
        self.rates = rates;
    }

    fn tangent(mut self) -> Tangent {
        for (time, impulses) in std::mem::take(&mut self.impulses) {
            self.tape.add_impulse(time, impulses.into_iter());
        }
        let signals = |way: usize| -> Vec<Vec<f64>> {
            let first = way * (self.outputs + 1);
            let outputs = (first..first + self.outputs).map(|signal| self.tape.filtered(signal));
            outputs
                .chain([self.tape.plain(first + self.outputs).to_vec()])
                .collect()
        };
        Tangent {
            signals: signals(0),
            slopes: (1..=self.displaced.moved.len()).map(signals).collect(),
        }
    }
}

/// A point contact at an event: rates and outputs just before or just after it.
struct Side {
    rate: Vec<f64>,
    outputs: Vec<f64>,
}

impl<M: Model + ?Sized> PerturbedModels<'_, M> {
    fn side(&self, t: f64, x: &[f64]) -> Side {
        let mut side = Side {
            rate: vec![0.0; self.states],
            outputs: vec![0.0; self.outputs],
        };
        self.rolling.motion(t, x, &mut side.rate, &mut side.outputs);
        side
    }

    /// For each direction the derivative of the time of an event by ε; zero for a motion that only touches it.
    fn shifts(&self, event: usize, t: f64, z: &[f64]) -> Vec<f64> {
        let (x, sensitivities) = z.split_at(self.states);
        let value = |rolling: &Rolling<'_, M>, s: &[f64], step: f64| {
            let beside = along(x, s, step);
            rolling.held_events(t, &beside).map_or(0.0, |[values, _]| values[event])
        };
        let rate = self.rolling.held_events(t, x).map_or(0.0, |[_, rates]| rates[event]);
        let ways = self.displaced.moved.iter().zip(sensitivities.chunks_exact(self.states));
        let shift = |([up, down], s): (&[Rolling<'_, M>; 2], &[f64])| {
            let slope = (value(up, s, STEP) - value(down, s, -STEP)) / (2.0 * STEP);
            if rate == 0.0 { 0.0 } else { -slope / rate }
        };
        ways.map(shift).collect()
    }

    /// Holds a point contact from here to its next event. The sensitivities jump if an event has brought it here.
    fn hold(&mut self, t: f64, z: &mut [f64]) {
        let crossing = self.crossed.take().map(|event| {
            let (x, shifts) = (&z[..self.states], self.shifts(event, t, z));
            (self.side(t, x), shifts)
        });
        let held = self.rolling.held_at(t, &z[..self.states]);
        let all = self.displaced.moved.iter_mut().flatten().chain([&mut self.rolling]);
        all.for_each(|rolling| rolling.held = held);
        let Some((before, shifts)) = crossing else {
            return;
        };
        let (x, sensitivities) = z.split_at_mut(self.states);
        let after = self.side(t, x);
        let mut impulses = vec![0.0; self.outputs + 1];
        for (s, shift) in sensitivities.chunks_exact_mut(self.states).zip(&shifts) {
            for ((s, before), after) in s.iter_mut().zip(&before.rate).zip(&after.rate) {
                *s += (before - after) * shift;
            }
            let jumps = before.outputs.iter().zip(&after.outputs);
            impulses.extend(jumps.map(|(before, after)| (before - after) * shift).chain([0.0]));
        }
        self.impulses.push((t, impulses));
    }
}

impl<M: Model + ?Sized> System for PerturbedModels<'_, M> {
    #[inline(always)]
    fn derivative(&mut self, t: f64, z: &[f64], dz: &mut [f64]) {
        let (x, sensitivities) = z.split_at(self.states);
        let (rates, signals) = dz.split_at_mut(z.len());
        let (rate, rates) = rates.split_at_mut(self.states);
        let (signal, signals) = signals.split_at_mut(self.outputs + 1);
        let (outputs, force) = signal.split_at_mut(self.outputs);
        let touch = self.rolling.touch(t, x);
        let contact = touch.as_ref().map(|touch| self.rolling.contact(Some(touch), x));
        let driven = self.rolling.driven(contact.unwrap_or_default());
        self.rolling.move_by(&driven, x, rate, outputs);
        force[0] = contact.map_or(0.0, |contact| contact.force[0]);
        let here = Here {
            rolling: &self.rolling,
            t,
            x,
            touch: touch.as_ref(),
            given: self.rolling.inputs_of(contact),
        };
        self.displaced.slopes(&here, sensitivities, (rates, signals));
    }

    fn signals(&self) -> usize {
        self.rates.len() - self.state.len()
    }

    fn enter(&mut self, t: f64, z: &mut [f64]) {
        self.hold(t, z);
    }

    fn next_kink(&self, t: f64, z: &[f64], dz: &[f64], from: f64) -> f64 {
        self.rolling.next_kink(t, &z[..self.states], &dz[..self.states], from)
    }

    fn accept(&mut self, step: &Step<'_>) {
        let first = self.state.len();
        while let Some(t) = self.tape.next(step.end) {
            let mut rates = std::mem::take(&mut self.rates);
            if step.has_rates() {
                step.rates_at(t, first, &mut rates[first..]);
            } else {
                let mut state = std::mem::take(&mut self.state);
                step.at(t, &mut state);
                self.derivative(t, &state, &mut rates);
                self.state = state;
            }
            self.tape.record(rates[first..].iter().copied());
            self.rates = rates;
        }
    }

    /// The tyre loses or regains contact; a point contact reaches the end of its piece of road.
    fn events(&self) -> usize {
        EVENTS
    }

    fn event_values(&mut self, t: f64, z: &[f64], values: &mut [f64]) {
        let x = &z[..self.states];
        match self.rolling.held_events(t, x) {
            Some([held, _]) => values.copy_from_slice(&held),
            None => {
                let grounded = self.rolling.touch(t, x).is_some();
                values.copy_from_slice(&[if grounded { 1.0 } else { -1.0 }, -1.0]);
            }
        }
    }

    fn happen(&mut self, event: &Event<'_>) -> After {
        self.crossed = self.rolling.held.map(|_| event.index);
        After::Restart
    }
}
