//! Metrics of a parameter set: of its rides, its transmissibilities and its modes.

use thiserror::Error;

use crate::campaign::RoleNames;
use crate::compare::{CompareError, Weighting, Windows, onset, sizes};
use crate::model::{About, Model, Quantity, Signal, SignalKind, StateKind};
use crate::modes;
use crate::resonance::{self, Peak, Survey};
use crate::response::parameters::Values;
use crate::roles::{RoleError, Roles};
use crate::simulate::{RecordedSignals, Ride};

/// A group of metrics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Metric {
    /// Largest acceleration of each mass and axis in the impact.
    Peak,
    /// Root mean square of each acceleration in the after-shake.
    AfterShake,
    /// Vibration dose of each acceleration over the whole ride, weighted by ISO 2631-1.
    Dose,
    /// Highest magnitude of each channel and its frequency.
    Transmissibility,
    /// Natural frequencies and damping ratios.
    Modes,
}

impl Metric {
    /// True for metrics of rides.
    pub fn of_rides(self) -> bool {
        matches!(self, Self::Peak | Self::AfterShake | Self::Dose)
    }
}

/// Name and unit of a metric.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// For example `body_z.peak`.
    pub name: String,
    /// SI unit.
    pub unit: String,
}

/// A channel whose transmissibility is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// Name.
    pub name: String,
    /// Unit of the ratio.
    pub unit: String,
    /// Position of the excitation in the model.
    pub excitation: usize,
    /// The numerator.
    pub numerator: Signal,
    /// The denominator.
    pub denominator: Signal,
}

/// Reason why a model lacks the chosen metrics.
#[derive(Clone, Debug, Error, PartialEq)]
#[expect(missing_docs, reason = "the message says it")]
pub enum MetricsError {
    #[error(transparent)]
    Role(#[from] RoleError),
    #[error(
        "model `{model}` has no acceleration of a mass among its outputs; add one such as `output body.acceleration;`"
    )]
    NoAcceleration { model: String },
}

/// The chosen metrics of a model, in the order of their columns.
pub struct Metrics<'a, M: ?Sized> {
    model: &'a M,
    chosen: Vec<Metric>,
    ratios: Vec<Ratio>,
    accelerations: Vec<Acceleration>,
    /// Position of the acceleration that responds to a cleat first.
    first: usize,
}

struct Acceleration {
    /// Position among the outputs.
    output: usize,
    /// For example `body_z`.
    name: String,
    weighting: Weighting,
}

impl<'a, M: Model + ?Sized> Metrics<'a, M> {
    /// The metrics of a model in the `chosen` groups.
    ///
    /// # Errors
    /// Fails if metrics of rides are chosen for a model without a tyre or without an acceleration among its outputs.
    pub fn new(model: &'a M, chosen: &[Metric], ratios: Vec<Ratio>) -> Result<Self, MetricsError> {
        let about = model.about();
        let rides = chosen.iter().any(|metric| metric.of_rides());
        let roles = rides.then(|| Roles::of(about, &RoleNames::default())).transpose()?;
        let accelerations = roles.iter().flat_map(|roles| accelerations(about, &roles.axis));
        let accelerations: Vec<_> = accelerations.collect();
        if rides && accelerations.is_empty() {
            let model = about.name.to_string();
            return Err(MetricsError::NoAcceleration { model });
        }
        let feels = |roles: &Roles| {
            let mut feeling = roles.feeling().map(|mass| format!("{mass}_{}", roles.axis));
            feeling.find_map(|name| accelerations.iter().position(|own| own.name == name))
        };
        Ok(Self {
            model,
            chosen: chosen.to_vec(),
            ratios,
            first: roles.as_ref().and_then(feels).unwrap_or(0),
            accelerations,
        })
    }

    /// Columns of the metrics of a parameter set, which need no ride.
    pub fn columns_of_sets(&self) -> Vec<Column> {
        let of = |metric: &Metric| match metric {
            Metric::Transmissibility => self.ratios.iter().flat_map(Ratio::columns).collect(),
            Metric::Modes => (1..=most_modes(self.model.about())).flat_map(of_mode).collect(),
            Metric::Peak | Metric::AfterShake | Metric::Dose => Vec::new(),
        };
        self.chosen.iter().flat_map(of).collect()
    }

    /// Columns of the metrics of each ride.
    pub fn columns_of_rides(&self) -> Vec<Column> {
        let of = |metric: &Metric| {
            let (what, unit) = match metric {
                Metric::Peak => ("peak", "m/s^2"),
                Metric::AfterShake => ("after_shake", "m/s^2"),
                Metric::Dose => ("vdv", "m/s^1.75"),
                Metric::Transmissibility | Metric::Modes => return Vec::new(),
            };
            let column = |own: &Acceleration| column(format!("{}.{what}", own.name), unit);
            self.accelerations.iter().map(column).collect()
        };
        self.chosen.iter().flat_map(of).collect()
    }

    /// The values of [`Metrics::columns_of_sets`]; NaN for a mode without oscillation, and for the height of the peak of
    /// an undamped mode.
    pub fn of_set(&self, values: &Values) -> Vec<f64> {
        let of = |metric: &Metric| match metric {
            Metric::Transmissibility => self.peaks(values),
            Metric::Modes => self.modes(values),
            Metric::Peak | Metric::AfterShake | Metric::Dose => Vec::new(),
        };
        self.chosen.iter().flat_map(of).collect()
    }

    /// The signals of a ride that the metrics need.
    pub fn kept(&self) -> RecordedSignals {
        let is_measured = |output: usize| self.accelerations.iter().any(|own| own.output == output);
        RecordedSignals {
            outputs: (0..self.model.about().outputs.len()).map(is_measured).collect(),
            force: false,
            area: false,
        }
    }

    /// The values of [`Metrics::columns_of_rides`] for a ride with samples at `rate` (Hz).
    ///
    /// # Errors
    /// Fails if the wheel does not respond to the cleat, or if the ride ends too early.
    pub fn of_ride(&self, ride: &Ride, rate: f64) -> Result<Vec<f64>, CompareError> {
        let record = |own: &Acceleration| &ride.outputs[own.output];
        let Some(first) = self.accelerations.get(self.first) else {
            return Ok(Vec::new());
        };
        let onset = onset(record(first))?;
        let sizes = |own: &Acceleration| sizes(record(own), onset, rate, &Windows::default());
        let sizes = self.accelerations.iter().map(sizes).collect::<Result<Vec<_>, _>>()?;
        let of = |metric: &Metric| -> Vec<f64> {
            match metric {
                Metric::Peak => sizes.iter().map(|[peak, _]| *peak).collect(),
                Metric::AfterShake => sizes.iter().map(|[_, after_shake]| *after_shake).collect(),
                Metric::Dose => self.doses(ride, rate),
                Metric::Transmissibility | Metric::Modes => Vec::new(),
            }
        };
        Ok(self.chosen.iter().flat_map(of).collect())
    }

    /// The vibration dose of each acceleration. Accelerations with the same weighting are filtered together.
    fn doses(&self, ride: &Ride, rate: f64) -> Vec<f64> {
        let mut doses = vec![0.0; self.accelerations.len()];
        for weighting in [Weighting::Wk, Weighting::Wd] {
            let all = self.accelerations.iter().enumerate();
            let own: Vec<_> = all.filter(|(_, own)| own.weighting == weighting).collect();
            let records: Vec<&[f64]> = own.iter().map(|(_, own)| ride.outputs[own.output].as_slice()).collect();
            let found = weighting.doses(&records, rate);
            own.iter()
                .zip(found)
                .for_each(|((place, _), dose)| doses[*place] = dose);
        }
        doses
    }

    /// Magnitude and frequency of the peak of each ratio. Ratios under one excitation share a response.
    fn peaks(&self, values: &Values) -> Vec<f64> {
        let mut surveys: Vec<(usize, Survey<'_, M>)> = Vec::new();
        let mut found = Vec::new();
        for ratio in &self.ratios {
            if surveys.iter().all(|(excitation, _)| *excitation != ratio.excitation) {
                let survey = resonance::survey(self.model, values, ratio.excitation);
                surveys.push((ratio.excitation, survey));
            }
            let survey = surveys.iter().find(|(excitation, _)| *excitation == ratio.excitation);
            let (_, survey) = survey.expect("it has just been put there");
            let peak = resonance::highest(survey, values, [&ratio.numerator, &ratio.denominator], false);
            found.extend(match peak {
                Some(Peak::Finite(peak)) => peak.value,
                Some(Peak::Infinite(frequency)) => [f64::NAN, frequency],
                None => [f64::NAN; 2],
            });
        }
        found
    }

    fn modes(&self, values: &Values) -> Vec<f64> {
        let found = modes::frequencies(self.model, values).into_iter();
        let mut numbers: Vec<f64> = found.flat_map(|(frequency, damping)| [frequency, damping]).collect();
        numbers.resize(2 * most_modes(self.model.about()), f64::NAN);
        numbers
    }
}

impl Ratio {
    fn columns(&self) -> [Column; 2] {
        [
            column(format!("{}.peak", self.name), &self.unit),
            column(format!("{}.peak_frequency", self.name), "Hz"),
        ]
    }
}

fn column(name: String, unit: &str) -> Column {
    let unit = unit.into();
    Column { name, unit }
}

fn of_mode(number: usize) -> [Column; 2] {
    [
        column(format!("mode.{number}.frequency"), "Hz"),
        column(format!("mode.{number}.damping"), "1"),
    ]
}

/// Largest number of modes: one for each mass that moves, and one for every two inner states.
fn most_modes(about: &About) -> usize {
    let velocities = about.states.iter().filter(|state| state.kind == StateKind::Velocity);
    let inner = about.states.iter().filter(|state| state.kind == StateKind::Inner);
    velocities.count() + inner.count() / 2
}

/// The accelerations of masses, with the weighting of a seat along the axis of the tyre or across it.
fn accelerations(about: &About, vertical: &str) -> impl Iterator<Item = Acceleration> {
    let masses = |signal: &Signal| {
        let here = |mass: &&crate::model::Mass| mass.location == signal.location && mass.axis == signal.axis;
        about.masses.iter().find(here).is_some_and(|mass| !mass.angle)
    };
    let outputs = about.outputs.iter().enumerate();
    let wanted = outputs.filter(move |(_, output)| {
        output.signal.kind == SignalKind::Motion(Quantity::Acceleration) && masses(&output.signal)
    });
    wanted.map(move |(output, own)| Acceleration {
        output,
        name: format!("{}_{}", own.signal.location, own.signal.axis),
        weighting: match own.signal.axis == *vertical {
            true => Weighting::Wk,
            false => Weighting::Wd,
        },
    })
}
