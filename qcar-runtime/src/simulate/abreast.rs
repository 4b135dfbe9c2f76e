//! Rides side by side: the general method integrates each of them alone near kinks of the tyre's force, and several
//! rides continue together where their forces are smooth. A ride has the same bits as alone, whichever rides are beside
//! it.

use std::iter::Enumerate;
use std::slice;

use super::batch::Batch;
use super::car::Car;
use super::failure::SimulateError;
use super::recorder::RecordedSignals;
use super::ride::{Drive, Journey, Ride};
use super::settings::Settings;
use crate::model::{LANES, Model};
use crate::solver::ExponentialAdams;

/// Parameters of a car, and the road and speed of its ride.
pub type RideCase<'a> = (&'a [f64], Drive<'a>);

/// Simulates rides of cars that differ from one by their parameters, each as [`ride`](super::ride()) does; `done`
/// receives each with its number as soon as it is complete. Signals that are not `kept` are empty.
///
/// Each ride takes a lane as soon as one is free, so that memory does not grow with their number.
pub fn rides_abreast<'a, M: Model + ?Sized>(
    car: &Car<'a, M>,
    rides: &[RideCase<'a>],
    settings: &Settings,
    kept: &RecordedSignals,
    done: impl FnMut(usize, Result<Ride, SimulateError>),
) {
    let mut abreast = Abreast {
        car,
        settings,
        kept,
        done,
        waiting: rides.iter().enumerate(),
        buffers: Vec::new(),
        last: None,
        batch: None,
        lanes: [const { None }; LANES],
    };
    (0..LANES).for_each(|place| abreast.fill_lane(place, None));
    while abreast.lanes.iter().any(Option::is_some) {
        abreast.go_on();
    }
}

struct Abreast<'r, 'a, M: ?Sized, D> {
    car: &'r Car<'a, M>,
    settings: &'r Settings,
    kept: &'r RecordedSignals,
    done: D,
    waiting: Enumerate<slice::Iter<'r, RideCase<'a>>>,
    /// Buffers of completed records, for further rides.
    buffers: Vec<Vec<f64>>,
    /// Parameters of the last ride that was started, and its exponential method: rides of the same car often follow
    /// each other.
    last: Option<(&'a [f64], ExponentialAdams<2>)>,
    batch: Option<Batch<'a, M>>,
    lanes: [Option<Lane<'a, M>>; LANES],
}

/// A ride, by its number.
type Numbered<'a, M> = (usize, Journey<'a, M>);

/// A ride in the batch.
struct Lane<'a, M: ?Sized> {
    ride: Numbered<'a, M>,
    /// Steps that may still be attempted.
    left: usize,
}

/// If no rides wait and at most this many are left, each continues alone: a step of the batch takes as long for one
/// ride as for eight.
const FEW: usize = 1;

impl<'a, M: Model + ?Sized, D: FnMut(usize, Result<Ride, SimulateError>)> Abreast<'_, 'a, M, D> {
    /// Integrates a ride until its tyre's force is smooth, then puts it into a lane. If the ride ends before, the next
    /// one follows.
    fn fill_lane(&mut self, place: usize, mut coming: Option<Numbered<'a, M>>) {
        while let Some((number, mut journey)) = coming.take().or_else(|| self.next()) {
            match journey.advance() {
                Err(error) => (self.done)(number, Err(error)),
                Ok(false) => {
                    let (ride, buffer) = journey.ride();
                    self.buffers.push(buffer);
                    (self.done)(number, Ok(ride));
                }
                Ok(true) if self.joins(place, &mut journey) => {
                    let left = journey.steps_left();
                    let ride = (number, journey);
                    self.lanes[place] = Some(Lane { ride, left });
                    return;
                }
                Ok(true) => {
                    journey.go_on();
                    coming = Some((number, journey));
                }
            }
        }
    }

    /// The next ride that can begin.
    fn next(&mut self) -> Option<Numbered<'a, M>> {
        loop {
            let (number, (parameters, drive)) = self.waiting.next()?;
            let car = Car {
                parameters,
                ..*self.car
            };
            let buffer = self.buffers.pop().unwrap_or_default();
            let of_car = |last: &&(&[f64], ExponentialAdams<2>)| last.0 == *parameters;
            let same = self.last.as_ref().filter(of_car).map(|last| &last.1);
            let is_new = same.is_none();
            match Journey::new(&car, drive, self.settings, |grid| (grid, buffer), self.kept, same) {
                Ok(mut journey) => {
                    if let Some((stepper, _)) = journey.recorder.stepper().filter(|_| is_new) {
                        self.last = Some((*parameters, stepper.method().clone()));
                    }
                    return Some((number, journey));
                }
                Err(error) => (self.done)(number, Err(error)),
            }
        }
    }

    /// Puts a ride into a lane of the batch if it can join.
    fn joins(&mut self, place: usize, journey: &mut Journey<'a, M>) -> bool {
        let Some((stepper, rolling)) = journey.recorder.stepper() else {
            return false;
        };
        let batch = self.batch.get_or_insert_with(|| Batch::like(stepper, rolling));
        let fits = batch.fits(stepper, rolling);
        if fits {
            batch.load(place, stepper, rolling);
        }
        fits
    }

    /// Steps until a ride has to leave the batch, and fills its lane with the next.
    fn go_on(&mut self) {
        let batch = self.batch.as_mut().expect("a ride is in it");
        let leaving = loop {
            let leaving = step(batch, &mut self.lanes);
            if leaving.contains(&true) {
                break leaving;
            }
        };
        for place in (0..LANES).filter(|&place| leaving[place]) {
            if let Some(ride) = self.leave(place) {
                self.fill_lane(place, Some(ride));
            }
        }
        let riding = self.lanes.iter().flatten().count();
        if self.waiting.len() == 0 && riding <= FEW {
            self.finish_one_by_one();
        }
    }

    /// Takes a ride out of its lane, with its present state.
    fn leave(&mut self, place: usize) -> Option<Numbered<'a, M>> {
        let (number, mut journey) = self.lanes[place].take()?.ride;
        let (stepper, _) = journey.recorder.stepper()?;
        self.batch.as_mut()?.unload(place, stepper, &mut journey.x);
        let ended = stepper.end();
        journey.hand_back(ended);
        Some((number, journey))
    }

    /// Integrates the remaining rides one by one to their ends.
    fn finish_one_by_one(&mut self) {
        for place in 0..LANES {
            let Some(Lane {
                ride: (number, mut journey),
                ..
            }) = self.lanes[place].take()
            else {
                continue;
            };
            if let (Some(batch), Some((stepper, _))) = (&mut self.batch, journey.recorder.stepper()) {
                batch.unload(place, stepper, &mut journey.x);
            }
            journey.go_on();
            let ended = journey.finish();
            (self.done)(number, ended.map(|()| journey.ride().0));
        }
    }
}

/// A step of all rides in a batch. Returns those that have to leave it.
fn step<M: Model + ?Sized>(batch: &mut Batch<'_, M>, lanes: &mut [Option<Lane<'_, M>>; LANES]) -> [bool; LANES] {
    let mut leaving = [false; LANES];
    for (place, lane) in lanes.iter_mut().enumerate() {
        let Some(Lane {
            ride: (_, journey),
            left,
        }) = lane
        else {
            continue;
        };
        let (stepper, rolling) = journey.recorder.stepper().expect("it has joined by one");
        batch.lengthen(place, stepper, rolling);
        match stepper.ahead() {
            Some(time) if *left > 0 => batch.set_time(place, time),
            _ => leaving[place] = true,
        }
    }
    if leaving.contains(&true) {
        return leaving;
    }
    batch.predict();
    let mut smooth = [false; LANES];
    for (place, lane) in lanes.iter_mut().enumerate() {
        if let Some(Lane { ride: (_, journey), .. }) = lane {
            let (stepper, rolling) = journey.recorder.stepper().expect("it has joined by one");
            smooth[place] = batch.find_contact(place, rolling, stepper.centre());
        }
    }
    let good = batch.advance(smooth);
    if lanes
        .iter()
        .flatten()
        .any(|lane| !lane.ride.1.recorder.computes_outputs())
    {
        batch.find_rates();
    }
    for (place, lane) in lanes.iter_mut().enumerate() {
        if let Some(lane) = lane {
            note(batch, place, lane, good[place]);
            leaving[place] = !good[place];
        }
    }
    leaving
}

/// Counts and records the step of a lane.
#[inline]
fn note<M: Model + ?Sized>(batch: &mut Batch<'_, M>, place: usize, lane: &mut Lane<'_, M>, good: bool) {
    let recorder = &mut lane.ride.1.recorder;
    let (stepper, _) = recorder.stepper().expect("it has joined by one");
    stepper.count(good.then(|| batch.centre(place)));
    if good {
        lane.left -= 1;
        let (time, contact) = (batch.time(place), batch.contact(place));
        if recorder.computes_outputs() {
            recorder.record_step(time, batch.state(place), contact);
        } else {
            recorder.record_lane(time, (batch.rates(), place), contact);
        }
    }
}
