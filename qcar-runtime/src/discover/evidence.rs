//! What a campaign holds, as series of measured values with their uncertainty.
//!
//! Every series knows its run, its sensor and what its values are; every run its role, its level and what drove it.
//! Uncertainty is the noise of a value, independent from line to line. What is common to all lines of a sensor, such as
//! its calibration, is not in it: see [`nuisance`](super::nuisance).

// Swept sines: the first harmonics at each frequency.
pub(super) mod sweep;
// Which frequencies of a record are compared.
mod band;
// What a sensor of a record shows beside the motion.
mod noise;
// From where a model sets out, and where one that drifts is set right.
mod restart;
// Any other excitation: the responses themselves.
mod history;
// A record as means around given instants.
pub mod means;
// Rides over an obstacle: their impact and after-shake.
pub(super) mod cleat;
// Quasi-static K&C cycles.
pub(super) mod travel;
// K&C sines.
mod cycle;

pub use band::Band;
use means::Means;
use nalgebra::Complex;
pub use restart::{Restart, Spread, is_seen};

use super::numbers::Numbers;
use crate::campaign::{Axis, Campaign, Quantity, Role, Side, Test};
use crate::error::{InputError, Place, Problem};
use crate::model::{About, Signal, SignalKind};
use crate::response::signal::output_of;
use crate::road::Road;
use crate::roles::OnRig;
use crate::transmissibility::Point;
use crate::tyre::Tyre;

/// What a campaign holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Evidence {
    /// In the order of the campaign, without those that add nothing.
    pub runs: Vec<Run>,
    /// The series of all runs, run after run.
    pub series: Vec<Series>,
    /// Whether the two sides of a car are measured, and taken for one.
    pub two_sided: bool,
    /// What was left out, and why, as sentences for the engineer.
    pub notices: Vec<String>,
    /// What a search assumes of it.
    pub numbers: Numbers,
}

/// A run of the campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its file, as the campaign calls it.
    pub name: String,
    /// What it may be used for.
    pub role: Role,
    /// How strongly it was driven, in the unit of its test: peak velocity (m/s) of a sweep, RMS of a
    /// history's input, height (m) of an obstacle, largest travel (m) of a K&C cycle.
    pub level: f64,
    /// What drove it.
    pub stimulus: Stimulus,
}

/// What drove a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Stimulus {
    /// A swept sine.
    Sweep {
        /// The sensor that the responses are related to.
        reference: Point,
        /// Its mean signal over the sides.
        signal: Vec<f64>,
        /// Hz.
        rate: f64,
        /// Hz, increasing: where responses were asked for.
        frequency: Vec<f64>,
        /// Amplitude of the reference there, in its unit.
        amplitude: Vec<f64>,
        /// First and last frequency of the sweep, Hz.
        band: (f64, f64),
    },
    /// Anything else, as it was recorded.
    History {
        /// What drove the model.
        inputs: Recordings,
        /// Hz.
        rate: f64,
        /// True where the inputs hold nothing above half the sample rate, false where they are held between samples.
        band_limited: bool,
        /// From where the model sets out, and where it is set right; the first is at the first sample.
        restarts: Vec<Restart>,
        /// How far from there it may have been when the record began.
        spread: Spread,
        /// Which frequencies are compared; all without one.
        band: Option<Band>,
        /// True where the record is made of whole periods of a motion that repeats.
        periodic: bool,
    },
    /// A road under a rolling tyre.
    Cleat(Passage),
    /// A K&C rig that moved the wheel slowly against the body.
    Travel {
        /// What these are in the model.
        on: OnRig,
        /// Along which it moved.
        axis: Axis,
        /// m.
        ends: [f64; 2],
    },
    /// The same as a sine.
    Sine {
        /// What these are in the model.
        on: OnRig,
        /// Along which it moved.
        axis: Axis,
        /// Hz.
        frequency: f64,
    },
}

/// A ride over an obstacle at constant speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// What was driven over.
    pub road: Road,
    /// m/s.
    pub speed: f64,
    /// What rolled.
    pub tyre: Tyre,
    /// Static load of the tyre, N.
    pub load: f64,
    /// How long the evidence lasts, s after the wheel's centre was above x = 0.
    pub duration: f64,
    /// How a ride is sampled and read.
    pub means: Means,
    /// The most steps in which a second of it may be simulated.
    pub most_steps: f64,
}

/// Signals of one record.
#[derive(Clone, Debug, PartialEq)]
pub struct Recordings {
    /// Time of the first sample, s.
    pub start: f64,
    /// Number of samples.
    pub samples: usize,
    /// The sensors with their samples.
    pub signals: Vec<(Point, Vec<f64>)>,
}

/// The least noise of a value, in parts of the signal: that of a converter of twelve bits.
pub(super) const LEAST_NOISE: f64 = 2.4e-4;

/// A record keeps at least this part of its length: what it begins with need not tell what comes later.
const MOST_SHORTENED: usize = 2;

impl Stimulus {
    /// Leaves less of a record through which a model has to be driven, so many times less of a history and half of a
    /// ride whose values stand `at` these times: when it ends now, and by how much fewer of its values are then to be
    /// looked at. Anything else stays.
    fn shorten(&mut self, times: usize, at: &[f64]) -> (f64, usize) {
        match self {
            // Part of a period is no period.
            Stimulus::History { periodic: true, .. } => (f64::INFINITY, times),
            Stimulus::History { inputs, rate, band, .. } => {
                let reach = band.as_ref().map_or(0, Band::half);
                inputs.samples = (inputs.samples / times.min(MOST_SHORTENED) + reach).min(inputs.samples);
                let (length, signals) = (inputs.samples, inputs.signals.iter_mut());
                signals.for_each(|(_, samples)| samples.truncate(length));
                (inputs.start + ((length - reach) as f64 - 0.5) / *rate, 1)
            }
            // The impact and the first of the after-shake have all modes of an axle.
            Stimulus::Cleat(passage) if at.len() > 1 && times > 1 => {
                let last = at[at.len() - 1];
                let end = at[at.len() / 2];
                passage.duration -= last - end;
                (end.next_up(), times.div_ceil(2))
            }
            _ => (f64::INFINITY, times),
        }
    }

    /// What is compared of a signal that was recorded in the run, sample by sample.
    pub fn of_band(&self, signal: &[f64]) -> Vec<f64> {
        match self {
            Stimulus::History {
                band: Some(band),
                periodic,
                ..
            } => band.of(signal, *periodic),
            _ => signal.to_vec(),
        }
    }

    /// Samples at either end of a record that are not compared, since a band reaches beyond them.
    pub fn cut(&self) -> usize {
        match self {
            Stimulus::History {
                band: Some(band),
                periodic: false,
                ..
            } => band.half(),
            _ => 0,
        }
    }

    /// True where what never changes is compared too.
    pub fn holds_rest(&self) -> bool {
        match self {
            Stimulus::History { band: Some(band), .. } => band.holds_rest(),
            _ => true,
        }
    }

    /// The sensor of what drove the run; none measures a road, and a mass that swings out is driven by nothing.
    pub fn reference(&self) -> Option<&Point> {
        match self {
            Stimulus::Sweep { reference, .. } => Some(reference),
            Stimulus::History { inputs, .. } => inputs.signals.first().map(|(sensor, _)| sensor),
            Stimulus::Cleat(_) | Stimulus::Travel { .. } | Stimulus::Sine { .. } => None,
        }
    }
}

/// Values of one kind that one sensor gave in one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Place in [`Evidence::runs`].
    pub run: usize,
    /// The sensor: the mean of all sides of a location.
    pub sensor: Point,
    /// What the values are.
    pub kind: Kind,
    /// Where each value belongs; see [`Kind`].
    pub at: Vec<f64>,
    /// The values; the imaginary part is zero where they are real.
    pub value: Vec<Complex<f64>>,
    /// Standard deviation of the noise of each value: `E|error|²` is its square.
    pub sigma: Vec<f64>,
    /// The part of it that is independent from value to value.
    pub noise: Vec<f64>,
    /// What no calibration and no model gets right, in parts of the signal: the other part, which neighbours have in common.
    pub least_discrepancy: f64,
}

/// What the values of a series are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Responses at `order` times the frequency (Hz) of the excitation at which they stand, over its amplitude there.
    Harmonic(usize),
    /// Samples at a time (s).
    Time,
    /// Means around a time (s) of a passage, as [`Means`] takes them.
    Passage,
    /// Forces at a travel (m), both positive in compression, or forwards.
    Travel,
    /// Half of what the force is larger at that travel while it grows than while it falls.
    Width,
    /// Forces at `order` times the frequency (Hz) of a sine of travel at which they stand, over its amplitude.
    Cycle(usize),
}

impl Kind {
    /// Which harmonic the values are; `None` for other than harmonics.
    pub fn order(self) -> Option<usize> {
        match self {
            Kind::Harmonic(order) | Kind::Cycle(order) => Some(order),
            _ => None,
        }
    }

    /// True where values have an imaginary part.
    pub fn complex(self) -> bool {
        match self {
            Kind::Harmonic(_) | Kind::Cycle(_) => true,
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width => false,
        }
    }

    /// The frequency (Hz) at which a sensor of motion reads a value at `at`, where it has one.
    pub fn frequency(self, at: f64) -> Option<f64> {
        match self {
            Kind::Harmonic(order) => Some(order as f64 * at),
            Kind::Time | Kind::Passage | Kind::Travel | Kind::Width | Kind::Cycle(_) => None,
        }
    }
}

impl Series {
    /// Half a period of the mean frequency of a record, s: of the root of the ratio of the mean squares of its slope and
    /// itself (Rice's formula for a Gaussian process).
    pub fn half_a_period(&self) -> f64 {
        let count = self.at.len() as f64;
        let mean = self.value.iter().map(|value| value.re).sum::<f64>() / count;
        let power: f64 = self.value.iter().map(|value| (value.re - mean).powi(2)).sum();
        let pairs = self.value.windows(2).zip(self.at.windows(2));
        let slope = pairs
            .map(|(y, t)| ((y[1].re - y[0].re) / (t[1] - t[0])).powi(2))
            .sum::<f64>();
        std::f64::consts::PI * (power / slope.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// Keeps every so many-th value.
    pub fn thin(&mut self, step: usize) {
        self.keep((0..self.at.len()).step_by(step));
    }

    fn keep(&mut self, places: impl Iterator<Item = usize> + Clone) {
        self.at = places.clone().map(|k| self.at[k]).collect();
        self.value = places.clone().map(|k| self.value[k]).collect();
        self.sigma = places.clone().map(|k| self.sigma[k]).collect();
        self.noise = places.map(|k| self.noise[k]).collect();
    }

    /// Number of real residuals.
    pub fn residuals(&self) -> usize {
        self.value.len() * if self.kind.complex() { 2 } else { 1 }
    }
}

impl Evidence {
    /// Reads what the runs of a campaign say of a model.
    ///
    /// Sensors at places that the model does not have are left out with a notice, so that all variants of this model
    /// are held against the same evidence.
    ///
    /// # Errors
    /// Where a file cannot be read, a sweep has no pad, or no run says anything.
    pub fn from_campaign(campaign: &Campaign, about: &About) -> Result<Self, InputError> {
        let mut evidence = Evidence {
            runs: Vec::new(),
            series: Vec::new(),
            two_sided: campaign.channels.iter().any(|channel| channel.side == Side::Right),
            notices: Vec::new(),
            numbers: Numbers::default(),
        };
        for run in &campaign.runs {
            evidence.add(campaign, about, run)?;
        }
        if evidence.series.is_empty() {
            let mut remedy = "add a run with sensors at places of the model".to_owned();
            evidence
                .notices
                .iter()
                .for_each(|notice| remedy = format!("{remedy}; {notice}"));
            let found = "no run that says anything of the model";
            return Err(Problem::new(campaign.manifest(), Place::File, found, "measured responses", remedy).into());
        }
        Ok(evidence)
    }

    /// The series of the runs of one role, with their places.
    pub fn of_role(&self, role: Role) -> impl Iterator<Item = (usize, &Series)> {
        let series = self.series.iter().enumerate();
        series.filter(move |(_, series)| self.runs[series.run].role == role)
    }

    /// The sensors of a run, each once.
    pub fn sensors(&self, run: usize) -> Vec<&Point> {
        let mut sensors: Vec<&Point> = Vec::new();
        for series in self.series.iter().filter(|series| series.run == run) {
            if !sensors.contains(&&series.sensor) {
                sensors.push(&series.sensor);
            }
        }
        sensors
    }

    /// The same with this share of every value added to its uncertainty: for a model that is known to lack something.
    pub fn tolerant(&self, share: f64) -> Self {
        let mut tolerant = self.clone();
        for series in &mut tolerant.series {
            let values = series.value.iter().zip(&mut series.sigma);
            values.for_each(|(value, sigma)| *sigma = sigma.hypot(share * value.norm()));
        }
        tolerant
    }

    /// The same for a search among many, in which a ride that takes far longer than others is refused.
    pub fn hurried(&self) -> Self {
        let mut hurried = self.clone();
        for run in &mut hurried.runs {
            if let Stimulus::Cleat(passage) = &mut run.stimulus {
                passage.most_steps = cleat::HURRIED;
            }
        }
        hurried
    }

    /// The same with every so many-th value of each series, for a first look; of a history and a ride their beginning,
    /// since a model has to be driven through whatever it is held against.
    pub fn thinned(&self, step: usize) -> Self {
        let mut thinned = self.clone();
        let shorten = |(run, of): (usize, &mut Run)| {
            let series = self.series.iter().find(|series| series.run == run);
            of.stimulus.shorten(step, series.map_or(&[], |series| &series.at))
        };
        let ends: Vec<(f64, usize)> = thinned.runs.iter_mut().enumerate().map(shorten).collect();
        for series in &mut thinned.series {
            let (end, step) = ends[series.run];
            let inside = series.at.partition_point(|at| *at < end);
            series.keep((0..inside).step_by(step));
        }
        thinned
    }

    /// The same less what its series show beyond what a search predicts, series by series.
    pub fn less(&self, beyond: &[Vec<Complex<f64>>]) -> Self {
        let mut less = self.clone();
        for (series, beyond) in less.series.iter_mut().zip(beyond) {
            series
                .value
                .iter_mut()
                .zip(beyond)
                .for_each(|(value, beyond)| *value -= beyond);
        }
        less
    }

    /// The same with only the runs that `keep` wants.
    pub fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.runs.len()).filter(|&run| keep(run)).collect();
        let place = |run: usize| kept.iter().position(|&k| k == run);
        let series = self.series.iter().filter_map(|series| {
            let run = place(series.run)?;
            Some(Series { run, ..series.clone() })
        });
        Evidence {
            runs: kept.iter().map(|&run| self.runs[run].clone()).collect(),
            series: series.collect(),
            two_sided: self.two_sided,
            notices: self.notices.clone(),
            numbers: self.numbers.clone(),
        }
    }

    fn add(&mut self, campaign: &Campaign, about: &About, run: &crate::campaign::Run) -> Result<(), InputError> {
        match &run.test {
            Test::Sweep(sweep) => self.add_sweep(campaign, about, run, sweep),
            Test::TimeHistory(recording) => self.add_history(campaign, about, run, recording),
            Test::Cleat { .. } => self.add_cleat(campaign, about, run),
            Test::Bounce => self.add_travel(campaign, about, run, Axis::Z),
            Test::Longitudinal => self.add_travel(campaign, about, run, Axis::X),
            Test::DynamicBounce {
                peak_velocity,
                amplitude,
            } => self.add_sine(campaign, about, run, (*amplitude, *peak_velocity)),
        }
    }

    /// Of the sensors of a run, those at places that the model has.
    fn known(&mut self, about: &About, run: &str, points: Vec<Point>) -> Vec<Point> {
        let (known, unknown): (Vec<_>, Vec<_>) = points.into_iter().partition(|point| has(about, point));
        for point in unknown {
            let notice = format!(
                "{run}: the model has no `{}` along {}; that sensor is left out",
                point.location,
                point.axis.name()
            );
            self.notices.push(notice);
        }
        known
    }
}

/// What a sensor measures, in the model's words.
///
/// On a link a displacement is its stretch.
pub fn signal_of(about: &About, point: &Point) -> Signal {
    let link = about
        .links
        .iter()
        .any(|link| link.name == point.location && link.axis == point.axis.name());
    let kind = match point.quantity {
        Quantity::Force => SignalKind::Force,
        Quantity::Displacement if link => SignalKind::Stretch,
        Quantity::Displacement => SignalKind::Motion(crate::model::Quantity::Position),
        Quantity::Velocity => SignalKind::Motion(crate::model::Quantity::Velocity),
        Quantity::Acceleration => SignalKind::Motion(crate::model::Quantity::Acceleration),
    };
    Signal {
        location: point.location.clone().into(),
        axis: point.axis.name().into(),
        kind,
    }
}

/// How many times a motion has been differentiated where a sensor measures it.
pub fn order_of(point: &Point) -> i32 {
    match point.quantity {
        Quantity::Acceleration => 2,
        Quantity::Velocity => 1,
        Quantity::Displacement | Quantity::Force => 0,
    }
}

/// The excitation of the model that a sensor measures, if it measures one.
pub fn excitation_of(about: &About, point: &Point) -> Option<usize> {
    about.excitations.iter().position(|excitation| {
        let force = point.quantity == Quantity::Force;
        excitation.name == point.location && excitation.axis == point.axis.name() && excitation.force == force
    })
}

fn has(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some() || output_of(about, &signal_of(about, point)).is_ok()
}

/// True of a sensor at a motion that drives the model.
fn is_motion(about: &About, point: &Point) -> bool {
    excitation_of(about, point).is_some_and(|place| !about.excitations[place].force)
}
