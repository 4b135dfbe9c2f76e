//! The rows of an ensemble: a parameter set, a ride, and the metrics.

use std::ops::Range;

use rayon::current_num_threads;
use rayon::prelude::*;

use super::design::Design;
use super::metrics::{Column, Metrics};
use crate::free_motions::growing;
use crate::model::Model;
use crate::response::parameters::Values;
use crate::simulate::{Car, Ride, Settings, SimulateError, Standard, Variant, rides_abreast};
use crate::tyre::Tyre;

/// The rides of every parameter set.
pub struct Track {
    /// Rides, at least one.
    pub rides: Vec<Standard>,
    /// Radius, static deflection and geometry.
    pub tyre: Tyre,
    /// Static load that the tyre carries, N.
    pub load: f64,
    /// Variant of the model.
    pub variant: Variant,
}

/// An ensemble: a model at the parameter sets of a design, over the rides of a track.
pub struct Ensemble<'a, M: ?Sized> {
    /// The model.
    pub model: &'a M,
    /// Values of the parameters that do not vary.
    pub values: Values,
    /// Design.
    pub design: Design,
    /// Rides; `None` without any.
    pub track: Option<Track>,
    /// Metrics.
    pub metrics: Metrics<'a, M>,
    /// Check of the masses of a set.
    pub possible: &'a (dyn Fn(&[f64]) -> Option<String> + Sync),
}

/// The rows of a set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// The rows one after another, each with all columns.
    pub numbers: Vec<f64>,
    /// Why the first row without metrics has none; `None` if all have metrics.
    pub failure: Option<String>,
}

/// A parameter set.
struct Set {
    number: u64,
    /// The values of the axes, and of all parameters.
    varied: Vec<f64>,
    values: Values,
    /// Why it is invalid; `None` for a valid set.
    impossible: Option<String>,
}

/// Number of rides that a thread gets at once; lanes are idle only while the last ones end.
const TOGETHER: usize = 96;

impl<M: Model + ?Sized> Ensemble<'_, M> {
    /// Columns: numbers of set and ride from 0 on, height and speed of the ride, the varied parameters, all metrics,
    /// and at the end 1 if the metrics could not be computed (they are NaN then), otherwise 0.
    pub fn columns(&self) -> Vec<Column> {
        let column = |name: &str, unit: &str| Column {
            name: name.into(),
            unit: unit.into(),
        };
        let ride = [("ride", "1"), ("height", "m"), ("speed", "m/s")].map(|(name, unit)| column(name, unit));
        let parameter = |place: usize| &self.model.about().parameters[place];
        let axes = self.design.axes().iter().map(|axis| parameter(axis.parameter));
        let mut columns = vec![column("design", "1")];
        columns.extend(ride.into_iter().filter(|_| self.track.is_some()));
        columns.extend(axes.map(|own| column(&own.name, &own.unit)));
        columns.extend(self.metrics.columns_of_rides());
        columns.extend(self.metrics.columns_of_sets());
        columns.push(column("failed", "1"));
        columns
    }

    /// Rows of each set.
    pub fn rows_of_set(&self) -> usize {
        self.track.as_ref().map_or(1, |track| track.rides.len())
    }

    /// The rows of some sets in their order, computed in parallel; they do not depend on the number of threads.
    pub fn rows(&self, sets: Range<u64>) -> Vec<Rows> {
        let all = (sets.end - sets.start) as usize;
        let each = all
            .div_ceil(current_num_threads())
            .clamp(1, TOGETHER.div_ceil(self.rows_of_set()));
        let some = (0..all.div_ceil(each)).into_par_iter().map(|part| {
            let first = sets.start + (part * each) as u64;
            self.of_sets(first..sets.end.min(first + each as u64))
        });
        some.flatten_iter().collect()
    }

    fn of_sets(&self, numbers: Range<u64>) -> Vec<Rows> {
        let sets: Vec<Set> = numbers.map(|number| self.set(number)).collect();
        let mut measured = self.ridden(&sets).into_iter();
        let rows = sets.iter().map(|set| {
            let of_set = match set.impossible {
                None => self.metrics.of_set(&set.values),
                Some(_) => vec![f64::NAN; self.metrics.columns_of_sets().len()],
            };
            let mut rows = Rows::default();
            for (ride, measured) in measured.by_ref().take(self.rows_of_set()).enumerate() {
                self.row((set.number, ride), &set.varied, measured, &of_set, &mut rows);
            }
            rows
        });
        rows.collect()
    }

    fn set(&self, number: u64) -> Set {
        let varied = self.design.set(number);
        let mut values = self.values.clone();
        for (axis, value) in self.design.axes().iter().zip(&varied) {
            values.set(axis.parameter, *value);
        }
        Set {
            impossible: self.impossible(&varied, &values),
            number,
            varied,
            values,
        }
    }

    fn impossible(&self, varied: &[f64], values: &Values) -> Option<String> {
        match varied.iter().all(|value| value.is_finite()) {
            true => (self.possible)(values.as_slice()),
            false => Some("no draw lies within the ranges of all parameters".into()),
        }
    }

    fn row(
        &self,
        (set, ride): (u64, usize),
        varied: &[f64],
        measured: Result<Vec<f64>, String>,
        of_set: &[f64],
        into: &mut Rows,
    ) {
        into.numbers.push(set as f64);
        if let Some(track) = &self.track {
            let own = &track.rides[ride];
            into.numbers.extend([ride as f64, own.height, own.speed]);
        }
        into.numbers.extend(varied);
        let failed = measured.is_err();
        match measured {
            Ok(numbers) => into.numbers.extend(numbers),
            Err(reason) => {
                let nothing = self.metrics.columns_of_rides().len();
                into.numbers.extend(std::iter::repeat_n(f64::NAN, nothing));
                into.failure.get_or_insert(reason);
            }
        }
        into.numbers.extend(of_set);
        into.numbers.push(f64::from(u8::from(failed)));
    }

    /// Metrics of each ride of each set; empty without rides.
    fn ridden(&self, sets: &[Set]) -> Vec<Result<Vec<f64>, String>> {
        let each = self.rows_of_set();
        let before = |set: &Set| set.impossible.clone().map_or(Ok(Vec::new()), Err);
        let mut measured: Vec<_> = sets.iter().flat_map(|set| vec![before(set); each]).collect();
        let Some(track) = &self.track else {
            return measured;
        };
        let places: Vec<usize> = (0..measured.len()).filter(|&place| measured[place].is_ok()).collect();
        let ride = |&place: &usize| (sets[place / each].values.as_slice(), track.rides[place % each].drive());
        let rides: Vec<_> = places.iter().map(ride).collect();
        let car = Car {
            model: self.model,
            parameters: self.values.as_slice(),
            tyre: track.tyre,
            load: track.load,
            variant: track.variant,
        };
        let done = |number: usize, ride: Result<Ride, SimulateError>| {
            let rate = rides[number].1.sample_rate;
            let of_ride = |ride| self.metrics.of_ride(&ride, rate).map_err(|error| error.to_string());
            let found = ride.map_err(|error| error.to_string()).and_then(of_ride);
            let set = &sets[places[number] / each];
            measured[places[number]] = found.map_err(|error| self.explained(&set.values, error));
        };
        rides_abreast(&car, &rides, &Settings::default(), &self.metrics.kept(), done);
        measured
    }

    /// Why a ride has no metrics: an error, or the instability that causes it.
    fn explained(&self, values: &Values, error: String) -> String {
        match growing(self.model, values) {
            Some(_) => format!("the model is unstable with these parameters, so its motion grows ({error})"),
            None => error,
        }
    }
}
