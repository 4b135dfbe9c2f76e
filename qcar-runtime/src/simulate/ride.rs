//! Rides over a road at constant speed.

use super::car::Car;
use super::exponential::ExponentialStepper;
use super::failure::{SimulateError, positive};
use super::recorder::{RecordedSignals, Recorder};
use super::rolling::Rolling;
use super::sampling::{AntiAlias, Grid};
use super::settings::{Integrator, Settings, judged};
use crate::model::{About, Model};
use crate::progress::{self, OnProgress};
use crate::road::{Road, RoadError};
use crate::solver::{Effort, ExponentialAdams, Reason, System};
use crate::tyre::{Geometry, Tyre};

/// A ride to be simulated.
#[derive(Clone, Copy)]
pub struct Drive<'a> {
    /// The road; at t = 0 the wheel's centre is above x = 0.
    pub road: &'a Road,
    /// Speed, m/s.
    pub speed: f64,
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// Number of samples, the first at t = 0.
    pub samples: usize,
}

/// A simulated ride.
#[derive(Clone, Debug, PartialEq)]
pub struct Ride {
    /// Time of each sample, s.
    pub time: Vec<f64>,
    /// Each output of the model, through [`AntiAlias`](super::AntiAlias).
    pub outputs: Vec<Vec<f64>>,
    /// Force of the tyre on the wheel in z and x, N, at the samples. It is not filtered, so it is exactly zero in the
    /// air.
    pub force: [Vec<f64>; 2],
    /// Area of the tyre's contact, m², at the samples, not filtered. For geometries other than [`Geometry::Area`] it is
    /// that of the equivalent deflection.
    pub area: Vec<f64>,
    /// Times at which the tyre lost contact, s.
    pub lift_offs: Vec<f64>,
    /// Times at which it regained contact, s.
    pub landings: Vec<f64>,
    /// Deflection of the tyre before the obstacle, m.
    pub static_deflection: f64,
    /// The constant force that drives the wheel against its rolling drag, N.
    pub traction: f64,
    /// Effort of the integration.
    pub effort: Effort,
}

/// Simulates rides in parallel. The results do not depend on the number of threads. Reports to `on_progress` after each
/// ride.
///
/// # Errors
/// Each ride fails as [`ride`] does.
pub fn rides<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drives: &[Drive<'_>],
    settings: &Settings,
    on_progress: OnProgress<'_>,
) -> Vec<Result<Ride, SimulateError>> {
    progress::map(drives, on_progress, |drive| ride(car, drive, settings))
}

/// Simulates a ride that begins at rest on the flat ground before the road.
///
/// # Errors
/// Fails if a number of the drive or car is invalid, if the road is too short, if the model has no tyre that can roll
/// or no static equilibrium, or if the integration stops early.
pub fn ride<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    settings: &Settings,
) -> Result<Ride, SimulateError> {
    let kept = RecordedSignals::all(car.model.about());
    let mut journey = Journey::new(car, drive, settings, |grid| (grid, Vec::new()), &kept, None)?;
    journey.finish()?;
    Ok(journey.ride().0)
}

/// The final state of a ride, and the effort of the integration. No signal is recorded.
///
/// # Errors
/// Fails as [`ride`] does.
pub fn end_of_ride<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    settings: &Settings,
) -> Result<(Vec<f64>, Effort), SimulateError> {
    let kept = RecordedSignals::all(car.model.about());
    let unrecorded = |grid: Grid| (grid.without_points(), Vec::new());
    let mut journey = Journey::new(car, drive, settings, unrecorded, &kept, None)?;
    journey.finish()?;
    Ok((journey.x, journey.effort))
}

/// A ride that is being integrated: by the general method near kinks of the force, and by its recorder's exponential method where
/// the force is smooth.
pub(super) struct Journey<'a, M: ?Sized> {
    pub recorder: Recorder<'a, M>,
    pub x: Vec<f64>,
    about: &'a About,
    drive: Drive<'a>,
    integrator: Integrator,
    most_steps: usize,
    /// Present time, at first the time at which the road begins to move the car, and end of the record, s.
    span: (f64, f64),
    effort: Effort,
    /// Effort of the recorder since it took over; `None` before.
    spent: Option<Effort>,
    static_deflection: f64,
}

impl<'a, M: Model + ?Sized> Journey<'a, M> {
    /// A car at rest on flat ground, at the time at which it begins to move. `recorded` reduces the grid of the samples
    /// to the recorded points, and `buffer` is a buffer for them. The exponential method may be that of another ride of
    /// the `same` car.
    pub fn new(
        car: &Car<'a, M>,
        drive: &Drive<'a>,
        settings: &Settings,
        recorded: impl FnOnce(Grid) -> (Grid, Vec<f64>),
        kept: &RecordedSignals,
        same: Option<&ExponentialAdams<2>>,
    ) -> Result<Self, SimulateError> {
        let (tyre, about) = (car.rolling_tyre(), car.model.about());
        drive.check(&tyre)?;
        let grid = Grid::new(drive.sample_rate, drive.samples, oversampling(&tyre));
        let start = drive.start(&tyre).min(grid.start());
        let (rolling, x) = Rolling::at_rest(car, drive.road, drive.speed, start)?;
        let span = (drive.reaches(&tyre).max(start), grid.end());
        let stepper = ExponentialStepper::new(&rolling, about, settings, &grid, same);
        let static_deflection = rolling.deflection(span.0, &x);
        let mut recorder = Recorder::new(rolling, stepper, recorded(grid), about, kept);
        recorder.rest(span.0, &x);
        Ok(Self {
            about,
            drive: *drive,
            integrator: settings.integrator(about, drive.longest_step(&tyre), recorder.events()),
            most_steps: settings.most_steps,
            recorder,
            x,
            span,
            effort: Effort::default(),
            spent: None,
            static_deflection,
        })
    }

    /// Continues by the general method. Returns true if the recorder has taken over, false at the end of the ride.
    ///
    /// # Errors
    /// Fails if the integration stops early.
    pub fn advance(&mut self) -> Result<bool, SimulateError> {
        let span = (self.span, &[][..]);
        let report = self
            .integrator
            .go_on(&mut self.recorder, self.spent.take(), span, &mut self.x);
        (self.span.0, self.effort) = (report.time, report.effort);
        match report.reason {
            Reason::TakenOver => Ok(true),
            _ => judged(self.about, report).map(|_| false),
        }
    }

    /// Number of steps that may still be attempted.
    pub fn steps_left(&self) -> usize {
        self.most_steps - self.effort.accepted - self.effort.rejected
    }

    /// Returns the ride from the recorder at a time (s), with the effort that was spent. The state is already stored.
    pub fn hand_back(&mut self, (time, spent): (f64, Effort)) {
        (self.span.0, self.spent) = (time, Some(spent));
    }

    /// Continues alone after the recorder has taken over.
    pub fn go_on(&mut self) {
        let most_steps = self.steps_left();
        let ended = self.recorder.go_on(&mut self.x, most_steps);
        self.hand_back(ended);
    }

    /// Continues alone to the end.
    ///
    /// # Errors
    /// Fails if the integration stops early.
    pub fn finish(&mut self) -> Result<(), SimulateError> {
        while self.advance()? {
            self.go_on();
        }
        Ok(())
    }

    /// The recorded ride, and the buffer of its tape for another ride.
    pub fn ride(mut self) -> (Ride, Vec<f64>) {
        self.recorder.finish();
        let [vertical, longitudinal, area] = self.recorder.contact();
        let time = |i: usize| i as f64 / self.drive.sample_rate;
        let ride = Ride {
            time: (0..self.drive.samples).map(time).collect(),
            outputs: self.recorder.outputs(),
            force: [vertical, longitudinal],
            area,
            lift_offs: std::mem::take(&mut self.recorder.lift_offs),
            landings: std::mem::take(&mut self.recorder.landings),
            static_deflection: self.static_deflection,
            traction: self.recorder.rolling().traction,
            effort: self.effort,
        };
        (ride, self.recorder.into_buffer())
    }
}

/// Smallest number of samples, while an obstacle passes through the contact patch, that resolves an impact.
const SAMPLES_PER_PATCH: f64 = 4.0;

impl Drive<'_> {
    pub(super) fn check(&self, tyre: &Tyre) -> Result<(), SimulateError> {
        let speed = positive("the speed", self.speed, "m/s")?;
        let rate = positive("the sample rate", self.sample_rate, "Hz")?;
        positive("the number of samples", self.samples as f64, "")?;
        self.stays_on_road()?;
        let passage = tyre.patch() / speed;
        let least = SAMPLES_PER_PATCH / passage;
        if rate < least {
            Err(SimulateError::TooFewSamples {
                rate,
                speed,
                passage,
                least,
            })
        } else {
            Ok(())
        }
    }

    /// Refuses a ride that would leave the road.
    ///
    /// # Errors
    /// [`RoadError::TooShort`].
    pub fn stays_on_road(&self) -> Result<(), RoadError> {
        let duration = self.samples.saturating_sub(1) as f64 / self.sample_rate;
        self.road.check_reaches(self.speed * duration)
    }

    /// Time at which the whole circle of the tyre is before the first point of the road, s.
    pub(super) fn start(&self, tyre: &Tyre) -> f64 {
        (self.road.extent()[0] - tyre.radius()) / self.speed
    }

    /// Time at which the circle of the tyre may first reach uneven ground, s; a car at rest does not move before. On a
    /// road that is level everywhere it is the start of the ride.
    pub(super) fn reaches(&self, tyre: &Tyre) -> f64 {
        let vertices = self.road.vertices();
        let uneven = vertices.windows(2).find(|pair| pair[0][1] != pair[1][1]);
        // However high the road is further on, the circle at rest does not reach it before this position.
        let clearance = tyre.radius() - tyre.static_deflection() - (self.road.bounds().highest - vertices[0][1]);
        let reach = (tyre.radius().powi(2) - clearance.max(0.0).powi(2)).sqrt();
        uneven.map_or(f64::NEG_INFINITY, |pair| (pair[0][0] - reach) / self.speed)
    }

    /// Longest step that cannot skip a feature of the road, s.
    ///
    /// For a circle it is the time for a quarter of its static patch. A point contact responds to an obstacle only
    /// while it is on it, so several steps must fall on the shortest obstacle.
    pub(super) fn longest_step(&self, tyre: &Tyre) -> f64 {
        let length = match tyre.geometry() {
            Geometry::Point => shortest_obstacle(self.road).min(tyre.patch()),
            Geometry::Area | Geometry::Radial => tyre.patch(),
        };
        0.25 * length / self.speed
    }
}

/// A point contact jumps at a vertical step of the road, and the accelerations with it.
pub(super) fn oversampling(tyre: &Tyre) -> usize {
    match tyre.geometry() {
        Geometry::Point => AntiAlias::JUMPING,
        Geometry::Area | Geometry::Radial => AntiAlias::CONTINUOUS,
    }
}

/// Length of the shortest uneven part of a road, m, without vertical steps, at which the solver stops anyway.
fn shortest_obstacle(road: &Road) -> f64 {
    let (mut start, mut shortest) = (None, f64::INFINITY);
    for pair in road.vertices().windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let level = from[1] == to[1];
        if level {
            shortest = start
                .take()
                .map_or(shortest, |start: f64| shortest.min(from[0] - start));
        } else if from[0] < to[0] {
            start.get_or_insert(from[0]);
        }
    }
    shortest
}
