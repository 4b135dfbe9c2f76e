//! Cleat runs of a campaign, ready to be simulated.

use std::path::Path;

use crate::campaign::{Campaign, History, Run, Test};
use crate::error::{InputError, Place, Problem};
use crate::road::Road;
use crate::tyre::{Geometry, Rates, Tyre};

use super::ride::Drive;

/// A measured cleat run.
#[derive(Clone, Debug)]
pub struct Cleat {
    /// The run of the campaign.
    pub run: Run,
    /// Speed, m/s.
    pub speed: f64,
    /// The record.
    pub measured: History,
    /// The road.
    pub road: Road,
}

impl Cleat {
    /// Reads a run and its road; `None` if it is no cleat run.
    ///
    /// # Errors
    /// Fails if a file cannot be read, or if its samples are no road.
    pub fn read(campaign: &Campaign, run: &Run) -> Result<Option<Self>, InputError> {
        let Test::Cleat { speed, cleat, .. } = &run.test else {
            return Ok(None);
        };
        Ok(Some(Self {
            run: run.clone(),
            speed: *speed,
            measured: campaign.history(run)?,
            road: road(campaign, cleat)?,
        }))
    }

    /// The whole run.
    pub fn drive(&self) -> Drive<'_> {
        Drive {
            road: &self.road,
            speed: self.speed,
            sample_rate: self.measured.sample_rate,
            samples: self.measured.len(),
        }
    }
}

fn road(campaign: &Campaign, name: &str) -> Result<Road, InputError> {
    let road = campaign.roads.iter().find(|road| road.name == name);
    let samples = campaign.road(road.expect("the campaign was checked for its roads"))?;
    Road::from_samples(&samples.x, &samples.z, &samples.slope).map_err(|error| {
        let (found, expected) = (error.to_string(), error.expected());
        Problem::new(&samples.file, Place::File, found, expected, error.remedy()).into()
    })
}

/// The tyre of a campaign with area contact, and its static load in N.
///
/// # Errors
/// Fails if `[vehicle]` lacks `r_tire`, `static_tire_def` or `static_tire_load`, or if they make no tyre.
pub fn tyre(campaign: &Campaign) -> Result<(Tyre, f64), InputError> {
    tyre_of(&|name| campaign.vehicle(name), &campaign.manifest())
}

/// The same for any vehicle data, from `file`.
///
/// # Errors
/// Fails as [`tyre`] does.
pub fn tyre_of(vehicle: &dyn Fn(&str) -> Option<f64>, file: &Path) -> Result<(Tyre, f64), InputError> {
    let fact = |name: &str, unit: &str| vehicle(name).ok_or_else(|| missing(file, name, unit));
    let radius = fact("r_tire", "m")?;
    let deflection = fact("static_tire_def", "m")?;
    let load = fact("static_tire_load", "N")?;
    let tyre = Tyre::new(radius, deflection, Geometry::Area, Rates::AtStaticDeflection).map_err(|error| {
        let (place, remedy) = (Place::Name("vehicle".into()), "correct r_tire and static_tire_def");
        Problem::new(file, place, error.found(), error.expected(), remedy)
    })?;
    Ok((tyre, load))
}

fn missing(file: &Path, name: &str, unit: &str) -> InputError {
    let (place, remedy) = (Place::Name("vehicle".into()), format!("add `{name} = …` in {unit}"));
    let (found, expected) = (format!("no `{name}`"), "what a rolling tyre needs");
    Problem::new(file, place, found, expected, remedy).into()
}
