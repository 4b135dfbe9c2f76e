//! Rides over a road at constant speed.

use super::car::Car;
use super::failure::{SimulateError, positive};
use super::recorder::{Kept, Recorder};
use super::rolling::Rolling;
use super::sampling::{AntiAlias, Grid};
use super::settings::{Integrator, Settings, judged};
use super::shortcut::Shortcut;
use crate::model::{About, Model};
use crate::progress::{self, OnProgress};
use crate::road::Road;
use crate::solver::{Effort, ExponentialAdams, Reason, System};
use crate::tyre::{Geometry, Tyre};

/// A ride that is to be simulated.
#[derive(Clone, Copy)]
pub struct Drive<'a> {
    /// The wheel's centre is above its x = 0 at t = 0.
    pub road: &'a Road,
    /// m/s.
    pub speed: f64,
    /// Hz.
    pub sample_rate: f64,
    /// Number of samples, the first at t = 0.
    pub samples: usize,
}

/// A ride that was simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Ride {
    /// Time of each sample, s.
    pub time: Vec<f64>,
    /// Each output of the model, through [`AntiAlias`](super::AntiAlias).
    pub outputs: Vec<Vec<f64>>,
    /// Force of the tyre on the wheel in z and x, N, as it is at the samples (not filtered: exactly zero in the air).
    pub force: [Vec<f64>; 2],
    /// Area of the tyre's contact, m², as it is at the samples; for another geometry than [`Geometry::Area`], that of
    /// the equivalent deflection.
    pub area: Vec<f64>,
    /// When the tyre lost the ground, s.
    pub lift_offs: Vec<f64>,
    /// When it came back, s.
    pub landings: Vec<f64>,
    /// Deflection of the tyre before the obstacle, m.
    pub static_deflection: f64,
    /// The constant force that drives the wheel against its rolling drag, N.
    pub traction: f64,
    /// What the integration cost.
    pub effort: Effort,
}

/// Simulates each ride, in parallel; the results do not depend on the number of threads. Ride by ride `on_progress` hears how
/// far it is.
///
/// # Errors
/// For each ride as [`ride`].
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
/// A drive or car that makes no sense, a road that is too short, a model without a tyre that rolls, no static
/// equilibrium, and an integration that stops early.
pub fn ride<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    settings: &Settings,
) -> Result<Ride, SimulateError> {
    let kept = Kept::all(car.model.about());
    let mut journey = Journey::new(car, drive, settings, |grid| (grid, Vec::new()), &kept, None)?;
    journey.finish()?;
    Ok(journey.ride().0)
}

/// The state in which a ride ends, and what the integration cost. Nothing is recorded on the way.
///
/// # Errors
/// As [`ride`].
pub fn end_of_ride<M: Model + ?Sized>(
    car: &Car<'_, M>,
    drive: &Drive<'_>,
    settings: &Settings,
) -> Result<(Vec<f64>, Effort), SimulateError> {
    let kept = Kept::all(car.model.about());
    let unrecorded = |grid: Grid| (grid.without_points(), Vec::new());
    let mut journey = Journey::new(car, drive, settings, unrecorded, &kept, None)?;
    journey.finish()?;
    Ok((journey.x, journey.effort))
}

/// A ride on its way: the general method takes it from where its force bends to where that is smooth, and there its recorder
/// takes over.
pub(super) struct Journey<'a, M: ?Sized> {
    pub recorder: Recorder<'a, M>,
    pub x: Vec<f64>,
    about: &'a About,
    drive: Drive<'a>,
    integrator: Integrator,
    most_steps: usize,
    /// Where it is, at first where the road begins to move it, and when the record ends, s.
    span: (f64, f64),
    effort: Effort,
    /// Of the recorder since it took over; none before it does.
    spent: Option<Effort>,
    static_deflection: f64,
}

impl<'a, M: Model + ?Sized> Journey<'a, M> {
    /// A car at rest on flat ground, about to move. What of the grid of the samples `recorded` leaves is recorded, in a room. The
    /// exponential method may be that of another ride of the `same` car.
    pub fn new(
        car: &Car<'a, M>,
        drive: &Drive<'a>,
        settings: &Settings,
        recorded: impl FnOnce(Grid) -> (Grid, Vec<f64>),
        kept: &Kept,
        same: Option<&ExponentialAdams<2>>,
    ) -> Result<Self, SimulateError> {
        let (tyre, about) = (car.rolling_tyre(), car.model.about());
        drive.check(&tyre)?;
        let grid = Grid::new(drive.sample_rate, drive.samples, oversampling(&tyre));
        let start = drive.start(&tyre).min(grid.start());
        let (rolling, x) = Rolling::at_rest(car, drive.road, drive.speed, start)?;
        let span = (drive.reaches(&tyre).max(start), grid.end());
        let shortcut = Shortcut::new(&rolling, about, settings, &grid, same);
        let static_deflection = rolling.deflection(span.0, &x);
        let mut recorder = Recorder::new(rolling, shortcut, recorded(grid), about, kept);
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

    /// Goes on by the general method, and says whether the recorder has taken over; else it is at the end.
    ///
    /// # Errors
    /// Where the integration stops before.
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

    /// So many steps may still be attempted.
    pub fn steps_left(&self) -> usize {
        self.most_steps - self.effort.accepted - self.effort.rejected
    }

    /// The recorder hands it back at a time, s, with the state in its place, and what it has spent.
    pub fn hand_back(&mut self, (time, spent): (f64, Effort)) {
        (self.span.0, self.spent) = (time, Some(spent));
    }

    /// Goes on alone where the recorder has taken over.
    pub fn go_on(&mut self) {
        let most_steps = self.steps_left();
        let ended = self.recorder.go_on(&mut self.x, most_steps);
        self.hand_back(ended);
    }

    /// Goes on alone to the end.
    ///
    /// # Errors
    /// Where the integration stops before.
    pub fn finish(&mut self) -> Result<(), SimulateError> {
        while self.advance()? {
            self.go_on();
        }
        Ok(())
    }

    /// What was recorded, and the room of its tape for another one.
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
        (ride, self.recorder.into_room())
    }
}

/// The fewest samples while an obstacle passes through the contact patch that still show an impact.
const SAMPLES_PER_PATCH: f64 = 4.0;

impl Drive<'_> {
    pub(super) fn check(&self, tyre: &Tyre) -> Result<(), SimulateError> {
        let speed = positive("the speed", self.speed, "m/s")?;
        let rate = positive("the sample rate", self.sample_rate, "Hz")?;
        positive("the number of samples", self.samples as f64, "")?;
        self.road.check_reaches(speed * (self.samples - 1) as f64 / rate)?;
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

    /// When the whole circle of the tyre stands before the first point of the road, s.
    pub(super) fn start(&self, tyre: &Tyre) -> f64 {
        (self.road.extent()[0] - tyre.radius()) / self.speed
    }

    /// When the circle of the tyre may meet ground that is not level any more, s: until then a car at rest rests.
    /// On a road that is level for ever it never does, and nothing is taken for granted.
    pub(super) fn reaches(&self, tyre: &Tyre) -> f64 {
        let vertices = self.road.vertices();
        let uneven = vertices.windows(2).find(|pair| pair[0][1] != pair[1][1]);
        // However high the road rises further on, the circle at rest meets it no earlier than at that height.
        let clearance = tyre.radius() - tyre.static_deflection() - (self.road.bounds().highest - vertices[0][1]);
        let reach = (tyre.radius().powi(2) - clearance.max(0.0).powi(2)).sqrt();
        uneven.map_or(f64::NEG_INFINITY, |pair| (pair[0][0] - reach) / self.speed)
    }

    /// The longest step that cannot pass over any part of the road unseen, s.
    ///
    /// A circle feels what is within its static patch, so a quarter of that; a point feels an obstacle only while it is
    /// on it, so that several steps must fall on the shortest.
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

/// Length of the shortest part of a road that is not level, m; vertical steps aside, where the solver stops by itself.
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
