//! Predicts the force of a link on a dynamometer: the force in the middle of a travel sine, in extension and
//! compression.
//!
//! A law without inner states is evaluated at its speed. A law with inner states is moved through whole cycles until
//! its force repeats. The sensitivities of the states are integrated with them (`dS/dt = ∂f/∂x S + ∂f/∂p`).

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::campaign::Axis;
use crate::discover::observe::{Evidence, Free, PredictError, Prediction, Stimulus};
use crate::model::{About, InputKind, Matrix, Model, Quantity};
use crate::response::parameters::Values;
use crate::solver::{DormandPrince, Settings, System};

/// Most cycles: enough for states that decay within fourteen of them. A force that still changes after them counts as
/// NaN, so that a fit rejects these parameters.
const CYCLES: usize = 200;
/// Relative change of the force from cycle to cycle that counts as a repetition.
const REPEATS: f64 = 1e-6;
/// Relative tolerance of the states.
const RELATIVE: f64 = 1e-8;
/// Absolute tolerance of the states, in their units.
const ABSOLUTE: f64 = 1e-7;
/// Fewest integration steps of a cycle.
const STEPS: f64 = 40.0;
/// Most integration steps of one cycle; beyond them the force counts as NaN.
const MOST_STEPS: usize = 50_000;

pub fn forces(
    model: &dyn Model,
    values: &Values,
    free: &[Free],
    evidence: &Evidence,
    run: usize,
) -> Result<Vec<Prediction>, PredictError> {
    let of_run = &evidence.runs[run];
    let Stimulus::Dynamometer { link, axis, amplitude } = &of_run.stimulus else {
        return Ok(Vec::new());
    };
    let alone = place(model.about(), link, axis).and_then(|place| model.alone(place));
    let alone = alone.ok_or_else(|| PredictError::NoLink {
        model: model.about().name.to_string(),
        link: link.clone(),
        axis: axis.name().into(),
        run: of_run.name.clone(),
    })?;
    let mut bench = Bench::new(alone, values, free);
    let all = evidence.series.iter().enumerate();
    let of_series = |(place, speeds): (usize, &[f64])| {
        let read: Vec<Reading> = speeds.iter().map(|&speed| bench.read(speed, *amplitude)).collect();
        let slope = |k: usize| read.iter().map(|own| Complex::from(own.slopes[k])).collect();
        Prediction {
            series: place,
            value: read.iter().map(|own| Complex::from(own.force)).collect(),
            slopes: (0..free.len()).map(slope).collect(),
            delay: None,
            by_drive: Vec::new(),
            by_initial_states: Vec::new(),
        }
    };
    let series = all.filter(|(_, series)| series.run == run);
    Ok(series
        .map(|(place, series)| (place, &series.at[..]))
        .map(of_series)
        .collect())
}

fn place(about: &About, link: &str, axis: &Axis) -> Option<usize> {
    let is_it = |own: &crate::model::Link| own.name == link && own.axis == axis.name();
    about.links.iter().position(is_it)
}

/// A force and its derivatives by the free parameters.
struct Reading {
    force: f64,
    slopes: Vec<f64>,
}

/// A link on the dynamometer, with its parameters.
struct Bench<'a> {
    model: &'a dyn Model,
    p: &'a [f64],
    constants: Vec<f64>,
    /// For each free parameter, the positions of all parameters tied to it, itself included.
    moved: Vec<Vec<usize>>,
    /// Size of each free parameter, which scales its sensitivities to the size of the states.
    sizes: Vec<f64>,
    u: Vec<f64>,
    nonzeros: Vec<f64>,
    by_parameter: Vec<f64>,
    /// Angular frequency (rad/s) of the sine.
    omega: f64,
    /// Amplitude (m) of the sine.
    amplitude: f64,
}

impl<'a> Bench<'a> {
    fn new(model: &'a dyn Model, values: &'a Values, free: &[Free]) -> Self {
        let (about, p) = (model.about(), values.as_slice());
        let mut constants = vec![0.0; about.constants];
        model.prepare(p, &mut constants);
        let size = |free: &Free| match p[free.parameter] {
            0.0 => (free.upper - free.lower).min(1.0),
            value => value.abs(),
        };
        Self {
            model,
            p,
            constants,
            moved: free.iter().map(|free| values.tied_to(free.parameter)).collect(),
            sizes: free.iter().map(size).collect(),
            u: vec![0.0; about.inputs.len()],
            nonzeros: vec![0.0; about.matrices.len()],
            by_parameter: vec![0.0; about.parameter_jacobian.len()],
            omega: 0.0,
            amplitude: 0.0,
        }
    }

    /// The force at `speed` (m/s), in the middle of a sine with `amplitude` (m).
    fn read(&mut self, speed: f64, amplitude: f64) -> Reading {
        (self.omega, self.amplitude) = (speed.abs() / amplitude, amplitude);
        let states = self.model.about().states.len();
        let size = states * (1 + self.moved.len());
        if states == 0 {
            return self.reading(speed, &[]);
        }
        let mut x = vec![0.0; size];
        let mut integrator = DormandPrince::new(
            Settings {
                relative: RELATIVE,
                absolute: vec![ABSOLUTE; size],
                longest_step: TAU / self.omega / STEPS,
                most_steps: MOST_STEPS,
            },
            0,
        );
        // Start at the end of travel before the middle at which the force is read.
        let period = TAU / self.omega;
        let middle = if speed > 0.0 { 0.0 } else { PI / self.omega };
        let mut last = self.integrate(&mut integrator, (middle - period / 4.0, middle), &mut x);
        for _ in 0..CYCLES {
            let next = self.integrate(&mut integrator, (middle, middle + period), &mut x);
            if next.repeats(&last, &self.sizes) {
                return next;
            }
            last = next;
        }
        last.force = f64::NAN;
        last
    }

    /// Integrates a part of the motion that ends in the middle of the travel, and reads the force there; NaN if the
    /// integration fails.
    fn integrate(&mut self, by: &mut DormandPrince, (start, end): (f64, f64), x: &mut [f64]) -> Reading {
        let quarter = PI / 2.0 / self.omega;
        // Friction laws have a kink where the motion reverses.
        let reversals: Vec<f64> = (-1..8)
            .map(|k| f64::from(2 * k + 1) * quarter)
            .filter(|at| (start..end).contains(at))
            .collect();
        let report = by.integrate(self, (start, end), &reversals, x);
        let speed = self.omega * self.amplitude * (self.omega * end).cos();
        let mut reading = self.reading(speed, x);
        if !report.reason.is_success() {
            reading.force = f64::NAN;
        }
        reading
    }

    /// Sets the inputs of the link at an angle of the sine.
    fn set_angle(&mut self, angle: f64) {
        let (sin, cos) = angle.sin_cos();
        let speed = self.omega * self.amplitude * cos;
        self.set(
            self.amplitude * sin,
            speed,
            -self.omega * self.omega * self.amplitude * sin,
        );
    }

    fn set(&mut self, position: f64, velocity: f64, acceleration: f64) {
        for (input, u) in self.model.about().inputs.iter().zip(&mut self.u) {
            *u = match input.kind {
                InputKind::Motion(_, Quantity::Position) => position,
                InputKind::Motion(_, Quantity::Velocity) => velocity,
                InputKind::Motion(_, Quantity::Acceleration) => acceleration,
                InputKind::Force(_) | InputKind::Gravity => 0.0,
            };
        }
    }

    /// The force in the middle of the travel for these states and sensitivities.
    fn reading(&mut self, speed: f64, x: &[f64]) -> Reading {
        self.set(0.0, speed, 0.0);
        let states = self.model.about().states.len();
        let mut force = [0.0];
        self.model.outputs(&self.constants, &x[..states], &self.u, &mut force);
        self.differentiate(&x[..states]);
        let mut slopes = vec![0.0; self.moved.len()];
        let about = self.model.about();
        for (entry, value) in about.matrices.iter().zip(&self.nonzeros) {
            if entry.matrix == Matrix::C {
                for (k, slope) in slopes.iter_mut().enumerate() {
                    *slope += value * x[states * (1 + k) + usize::from(entry.column)] / self.sizes[k];
                }
            }
        }
        for (&(is_output, _, parameter), value) in about.parameter_jacobian.iter().zip(&self.by_parameter) {
            for (moved, slope) in self.moved.iter().zip(&mut slopes) {
                if is_output && moved.contains(&usize::from(parameter)) {
                    *slope += value;
                }
            }
        }
        Reading {
            force: force[0],
            slopes,
        }
    }

    fn differentiate(&mut self, x: &[f64]) {
        self.model.matrices(self.p, x, &self.u, &mut self.nonzeros);
        self.model
            .parameter_jacobian(self.p, x, &self.u, &mut self.by_parameter);
    }
}

impl System for Bench<'_> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.set_angle(self.omega * t);
        let states = self.model.about().states.len();
        let (own, rates) = (&x[..states], &mut dx[..states]);
        self.model.derivative(&self.constants, own, &self.u, rates);
        dx[states..].fill(0.0);
        self.differentiate(own);
        let about = self.model.about();
        for (entry, value) in about.matrices.iter().zip(&self.nonzeros) {
            if entry.matrix == Matrix::A {
                let (row, column) = (usize::from(entry.row), usize::from(entry.column));
                for k in 1..=self.moved.len() {
                    dx[states * k + row] += value * x[states * k + column];
                }
            }
        }
        for (&(is_output, row, parameter), value) in about.parameter_jacobian.iter().zip(&self.by_parameter) {
            for (k, moved) in self.moved.iter().enumerate() {
                if !is_output && moved.contains(&usize::from(parameter)) {
                    dx[states * (1 + k) + usize::from(row)] += value * self.sizes[k];
                }
            }
        }
    }
}

impl Reading {
    fn repeats(&self, last: &Reading, sizes: &[f64]) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= REPEATS * self.force.abs().max(1.0);
        let slopes = self.slopes.iter().zip(&last.slopes).zip(sizes);
        let mut slopes = slopes.map(|((a, b), size)| (a * size, b * size));
        !self.force.is_finite() || close(self.force, last.force) && slopes.all(|(a, b)| close(a, b))
    }
}
