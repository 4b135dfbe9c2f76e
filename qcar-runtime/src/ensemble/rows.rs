//! The rows of an ensemble: a parameter set, a ride, and what is measured of both.

use std::ops::Range;

use rayon::prelude::*;

use super::design::Design;
use super::metrics::{Column, Metrics};
use crate::model::Model;
use crate::response::parameters::Values;
use crate::simulate::{Car, Settings, SimulateError, Standard, Variant, ride};
use crate::tyre::Tyre;

/// What every parameter set is driven over.
pub struct Track {
    /// At least one.
    pub rides: Vec<Standard>,
    /// Radius, static deflection and geometry.
    pub tyre: Tyre,
    /// Static load that the tyre carries, N.
    pub load: f64,
    /// What of the model is simulated.
    pub variant: Variant,
}

/// A model at the parameter sets of a design, over the rides of a track, measured.
pub struct Ensemble<'a, M: ?Sized> {
    /// The model.
    pub model: &'a M,
    /// Where nothing varies.
    pub values: Values,
    /// Which sets.
    pub design: Design,
    /// Over which rides, if any.
    pub track: Option<Track>,
    /// What is measured.
    pub metrics: Metrics<'a, M>,
    /// Whether the masses of a set are such.
    pub possible: &'a (dyn Fn(&[f64]) -> Option<String> + Sync),
}

/// The rows of a set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// One after another, each as long as there are columns.
    pub numbers: Vec<f64>,
    /// Why the first of them has no metrics, where one has none.
    pub failure: Option<String>,
}

impl<M: Model + ?Sized> Ensemble<'_, M> {
    /// What a row holds: the numbers of set and ride from 0 on, height and speed of the ride, the parameters that vary, all
    /// metrics, and at the end 1 where they could not be computed (they are NaN then), else 0.
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
        sets.into_par_iter().map(|set| self.of_set(set)).collect()
    }

    fn of_set(&self, set: u64) -> Rows {
        let varied = self.design.set(set);
        let mut values = self.values.clone();
        for (axis, value) in self.design.axes().iter().zip(&varied) {
            values.set(axis.parameter, *value);
        }
        let mut rows = Rows::default();
        let impossible = self.impossible(&varied, &values);
        let of_set = match impossible {
            None => self.metrics.of_set(&values),
            Some(_) => vec![f64::NAN; self.metrics.columns_of_sets().len()],
        };
        for ride in 0..self.rows_of_set() {
            let measured = match &impossible {
                None => self.of_ride(ride, &values),
                Some(reason) => Err(reason.clone()),
            };
            self.row((set, ride), &varied, measured, &of_set, &mut rows);
        }
        rows
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

    /// What is measured of a ride; nothing without a track.
    fn of_ride(&self, place: usize, values: &Values) -> Result<Vec<f64>, String> {
        let Some(track) = &self.track else {
            return Ok(Vec::new());
        };
        let car = Car {
            model: self.model,
            parameters: values.as_slice(),
            tyre: track.tyre,
            load: track.load,
            variant: track.variant,
        };
        let drive = track.rides[place].drive();
        let ride = ride(&car, &drive, &Settings::default()).map_err(|error: SimulateError| error.to_string())?;
        self.metrics
            .of_ride(&ride, drive.sample_rate)
            .map_err(|error| error.to_string())
    }
}
