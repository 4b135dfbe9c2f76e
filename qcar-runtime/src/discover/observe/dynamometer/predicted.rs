//! Predicts the force of a link on a dynamometer: the force in the middle of a travel sine, in extension and
//! compression.
//!
//! A law without inner states is evaluated at its speed. A law with inner states is moved through whole cycles until
//! its force repeats. The steps are implicit: friction before it slips and a compliant end are stiff. They are shortest
//! after a reversal, where friction takes hold within a fraction of the travel.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};

use crate::campaign::Axis;
use crate::discover::observe::{Evidence, Free, PredictError, Prediction, Stimulus};
use crate::model::{About, InputKind, Matrix, Model, Quantity};
use crate::response::parameters::Values;
use crate::solver::radau::{Linearised, States, Tangent, advance};

/// Most cycles: enough for states that decay within fourteen of them. A force that still changes after them counts as
/// NaN, so that a fit rejects these parameters.
const CYCLES: usize = 200;
/// Relative change of the force from cycle to cycle that counts as a repetition.
const REPEATS: f64 = 1e-6;
/// Size of a state that counts as small, in its unit.
const SMALL: f64 = 1e-7;
/// Steps from a reversal to the middle of the travel, and from there to the next reversal. The force of a friction that
/// slips within a stroke is then within 1e-5 of its closed form.
const STEPS: [usize; 2] = [60, 24];
/// Power of the share of the steps to which the angle after a reversal is proportional.
const GRADING: i32 = 4;

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
    /// Size of each free parameter, which scales its slopes to changes of the force.
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
        let mut states = States {
            x: DVector::zeros(states),
            by_parameter: DMatrix::zeros(states, self.moved.len()),
        };
        if states.x.is_empty() {
            return self.reading(speed, &states);
        }
        // Start at the end of travel before the middle at which the force is read.
        let middle = if speed > 0.0 { 0.0 } else { PI };
        let mut last = self.follow(&after_reversal(middle), speed, &mut states);
        let again = cycle(middle);
        for _ in 0..CYCLES {
            let next = self.follow(&again, speed, &mut states);
            if next.repeats(&last, &self.sizes) {
                return next;
            }
            last = next;
        }
        last.force = f64::NAN;
        last
    }

    /// Moves the link through these angles of the sine, and reads the force at the last one, where it moves at `speed`
    /// (m/s); NaN if a step fails.
    fn follow(&mut self, angles: &[f64], speed: f64, states: &mut States) -> Reading {
        let scale = vec![SMALL; states.x.len()];
        let omega = self.omega;
        let mut times = angles.windows(2).map(|pair| (pair[0] / omega, pair[1] / omega));
        let succeeds = times.all(|span| advance(self, span, &scale, states));
        let mut reading = self.reading(speed, states);
        if !succeeds {
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

    /// The force in the middle of the travel for these states.
    fn reading(&mut self, speed: f64, states: &States) -> Reading {
        self.set(0.0, speed, 0.0);
        let x = states.x.as_slice();
        let mut force = [0.0];
        self.model.outputs(&self.constants, x, &self.u, &mut force);
        self.model.matrices(self.p, x, &self.u, &mut self.nonzeros);
        self.model
            .parameter_jacobian(self.p, x, &self.u, &mut self.by_parameter);
        let mut slopes = vec![0.0; self.moved.len()];
        let about = self.model.about();
        for (entry, value) in about.matrices.iter().zip(&self.nonzeros) {
            if entry.matrix == Matrix::C {
                for (k, slope) in slopes.iter_mut().enumerate() {
                    *slope += value * states.by_parameter[(usize::from(entry.column), k)];
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
}

impl Linearised for Bench<'_> {
    fn linearise(&mut self, t: f64, x: &DVector<f64>) -> Tangent {
        self.set_angle(self.omega * t);
        let states = x.len();
        let mut tangent = Tangent {
            rate: DVector::zeros(states),
            by_state: DMatrix::zeros(states, states),
        };
        let rate = tangent.rate.as_mut_slice();
        self.model.derivative(&self.constants, x.as_slice(), &self.u, rate);
        self.model.matrices(self.p, x.as_slice(), &self.u, &mut self.nonzeros);
        for (entry, value) in self.model.about().matrices.iter().zip(&self.nonzeros) {
            if entry.matrix == Matrix::A {
                tangent.by_state[(usize::from(entry.row), usize::from(entry.column))] += value;
            }
        }
        tangent
    }

    fn by_parameter(&mut self, t: f64, x: &DVector<f64>) -> DMatrix<f64> {
        self.set_angle(self.omega * t);
        self.model
            .parameter_jacobian(self.p, x.as_slice(), &self.u, &mut self.by_parameter);
        let mut slopes = DMatrix::zeros(x.len(), self.moved.len());
        for (&(is_output, row, parameter), value) in
            self.model.about().parameter_jacobian.iter().zip(&self.by_parameter)
        {
            for (k, moved) in self.moved.iter().enumerate() {
                if !is_output && moved.contains(&usize::from(parameter)) {
                    slopes[(usize::from(row), k)] += value;
                }
            }
        }
        slopes
    }
}

/// Angles of the steps from the reversal before the middle of the travel to this middle.
fn after_reversal(middle: f64) -> Vec<f64> {
    let share = |step: usize| (step as f64 / STEPS[0] as f64).powi(GRADING);
    (0..=STEPS[0])
        .map(|step| middle - PI / 2.0 * (1.0 - share(step)))
        .collect()
}

/// Angles of the steps of a cycle that begins and ends in the middle of the travel.
fn cycle(middle: f64) -> Vec<f64> {
    let mut angles = Vec::new();
    for middle in [middle, middle + PI] {
        let step = PI / 2.0 / STEPS[1] as f64;
        angles.extend((0..STEPS[1]).map(|k| middle + k as f64 * step));
        angles.extend(after_reversal(middle + PI));
    }
    // The middle between both parts is the end of one and the beginning of the other.
    angles.dedup();
    angles
}

impl Reading {
    fn repeats(&self, last: &Reading, sizes: &[f64]) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= REPEATS * self.force.abs().max(1.0);
        let slopes = self.slopes.iter().zip(&last.slopes).zip(sizes);
        let mut slopes = slopes.map(|((a, b), size)| (a * size, b * size));
        !self.force.is_finite() || close(self.force, last.force) && slopes.all(|(a, b)| close(a, b))
    }
}
