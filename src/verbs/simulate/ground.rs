//! Rides over roads without a measured run: vibration of the masses and load of the tyre.

use std::path::Path;

use qcar_runtime::campaign::Campaign;
use qcar_runtime::compare::{Weighting, rms, vibration_dose};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::mean::deviation;
use qcar_runtime::metric::{Course, WithTravel};
use qcar_runtime::model::{Model, Quantity, Signal, SignalKind};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::{Drive, Ride, Variant, tyre};
use qcar_signals::mdf::write::Channel;
use serde::Serialize;

use super::spectra::Spectra;
use super::{guessed, render, simulate_rides};
use crate::catalogue::Loaded;
use crate::files::put;
use crate::histories::{History, Kind};
use crate::json;
use crate::table::{Table, number};
use crate::units;

const ACCELERATION: &str = "m/s^2";

/// Rides over roads.
pub(super) struct Rolled {
    campaign: String,
    model: String,
    vibration: Vec<Vibration>,
    loads: Vec<Load>,
    /// Notices on the campaign, as sentences.
    notices: Vec<String>,
    /// Parameters that still have their start values.
    at_start: Vec<String>,
    /// Record and sample rate (Hz) of each ride.
    histories: Vec<(History, f64)>,
}

/// The result as JSON, see `docs/json.md`.
#[derive(Serialize)]
struct Json<'a> {
    campaign: &'a str,
    model: &'a str,
    vibration: &'a [Vibration],
    loads: &'a [Load],
    notices: &'a [String],
    at_start: &'a [String],
}

/// Vibration of a mass along an axis.
#[derive(Serialize)]
struct Vibration {
    road: String,
    mass: String,
    axis: String,
    /// Frequency weighting of ISO 2631-1.
    weighting: &'static str,
    /// RMS acceleration, m/s².
    rms: f64,
    /// RMS of the weighted acceleration, m/s².
    weighted_rms: f64,
    /// Crest factor of the weighted acceleration: above 9 the standard requires the dose too.
    crest_factor: f64,
    /// Vibration dose value, m/s^1.75.
    vdv: f64,
}

/// Load of the tyre.
#[derive(Serialize)]
struct Load {
    road: String,
    /// Speed, m/s.
    speed: f64,
    /// Duration, s.
    duration: f64,
    /// RMS of the road height about its mean, m.
    road_rms: f64,
    /// Static load, N.
    static_load: f64,
    /// RMS of the load about its mean, N.
    dynamic_load: f64,
    /// Smallest load, N.
    lowest_load: f64,
    /// Number of times that the tyre lost contact.
    lift_offs: usize,
    /// Largest change of the wheel's height over the body, m; `None` if the model does not determine these.
    suspension_travel: Option<f64>,
}

/// Rolls over each road, from equilibrium on level ground.
///
/// # Errors
/// Fails if a ride cannot be simulated.
pub(super) fn roll(
    campaign: &Campaign,
    model: &Loaded,
    values: &Values,
    courses: &[Course],
    variant: Variant,
) -> Result<Rolled, InputError> {
    model.check_inertias(values.as_slice())?;
    let (tyre, load) = tyre(campaign)?;
    let drives: Vec<Drive<'_>> = courses.iter().map(Course::drive).collect();
    let with_travel = WithTravel::new(&**model, &campaign.roles);
    let ridden = simulate_rides(
        format!("{}: road", campaign.name),
        &with_travel,
        values,
        (tyre, load),
        &drives,
        variant,
    );
    let mut rolled = Rolled {
        campaign: campaign.name.clone(),
        model: model.about().name.to_string(),
        vibration: Vec::new(),
        loads: Vec::new(),
        notices: campaign.notices.clone(),
        at_start: guessed(campaign, model, values),
        histories: Vec::new(),
    };
    for (course, ride) in courses.iter().zip(ridden) {
        let ride = ride.map_err(|error| no_ride(campaign, course, &error.to_string()))?;
        rolled.add(&with_travel, course, &ride, load);
    }
    Ok(rolled)
}

/// The files of a ride: its record, and its spectra as table and figure.
pub(super) fn files(name: &str, kind: Kind) -> [String; 3] {
    let spectra = |extension: &str| format!("{name}_spectra.{extension}");
    [kind.file(name), spectra("csv"), spectra("svg")]
}

fn no_ride(campaign: &Campaign, course: &Course, error: &str) -> Problem {
    let place = Place::Name(format!("road {}", course.name));
    Problem::refused(campaign.manifest(), place, "this road cannot be simulated", error)
}

impl Rolled {
    fn add(&mut self, model: &WithTravel, course: &Course, ride: &Ride, static_load: f64) {
        let about = model.about();
        let accelerations = about.outputs.iter().zip(&ride.outputs).filter(|(output, _)| {
            let kind = SignalKind::Motion(Quantity::Acceleration);
            output.signal.kind == kind && output.unit == ACCELERATION
        });
        for (output, samples) in accelerations {
            self.vibration.push(Vibration::of(course, &output.signal, samples));
        }
        let height: Vec<f64> = ride
            .time
            .iter()
            .map(|time| course.road.height(course.speed * time))
            .collect();
        self.loads.push(Load {
            road: course.name.clone(),
            speed: course.speed,
            duration: course.samples as f64 / course.sample_rate,
            road_rms: deviation(&height),
            static_load,
            dynamic_load: deviation(&ride.force[0]),
            lowest_load: ride.force[0].iter().copied().fold(f64::INFINITY, f64::min),
            lift_offs: ride.lift_offs.len(),
            suspension_travel: model.added().map(|travel| largest_change(&ride.outputs[travel])),
        });
        let mut history = render::history(about, &course.name, ride);
        history.channels.insert(
            0,
            Channel {
                name: "road".into(),
                unit: "m".into(),
                samples: height,
            },
        );
        self.histories.push((history, course.sample_rate));
    }

    /// Writes the record of each ride, and its spectra as table and figure.
    ///
    /// # Errors
    /// Fails if the folder cannot be written to.
    pub fn put(&self, folder: &Path, kind: Kind) -> Result<(), InputError> {
        for (history, rate) in &self.histories {
            history.put(folder, kind)?;
            let spectra = Spectra::of(&history.channels, *rate);
            let [_, table, figure] = files(&history.name, kind);
            put(folder, &table, &spectra.csv())?;
            put(folder, &figure, &spectra.figure(&history.name).svg())?;
        }
        Ok(())
    }

    pub fn json(&self) -> String {
        json::line(&Json {
            campaign: &self.campaign,
            model: &self.model,
            vibration: &self.vibration,
            loads: &self.loads,
            notices: &self.notices,
            at_start: &self.at_start,
        })
    }

    pub fn text(&self) -> String {
        let notes = render::notes(&self.notices, &self.at_start);
        format!("{}\n{}{notes}", self.vibration_table().text(), self.load_table().text())
    }

    fn vibration_table(&self) -> Table {
        let acceleration = |value: f64| number(units::value(value, ACCELERATION), 4);
        let mut vibration = Table::new([
            "road",
            "mass",
            "axis",
            "unit",
            "rms",
            "weighting",
            "weighted_rms",
            "crest_factor",
            "vdv_m/s^1.75",
        ]);
        for own in &self.vibration {
            vibration.row(vec![
                own.road.clone(),
                own.mass.clone(),
                own.axis.clone(),
                units::name(ACCELERATION).into(),
                acceleration(own.rms),
                own.weighting.into(),
                acceleration(own.weighted_rms),
                number(own.crest_factor, 3),
                number(own.vdv, 4),
            ]);
        }
        vibration
    }

    fn load_table(&self) -> Table {
        let [force, length] = ["N", "m"].map(|unit| move |value: f64| number(units::value(value, unit), 4));
        let mut loads = Table::new([
            "road",
            "duration_s",
            "road_rms",
            "travel",
            "unit",
            "dynamic_load",
            "static_load",
            "lowest_load",
            "load_unit",
            "lift_offs",
        ]);
        for own in &self.loads {
            loads.row(vec![
                own.road.clone(),
                number(own.duration, 4),
                length(own.road_rms),
                own.suspension_travel.map_or_else(String::new, length),
                units::name("m").into(),
                force(own.dynamic_load),
                force(own.static_load),
                force(own.lowest_load),
                units::name("N").into(),
                own.lift_offs.to_string(),
            ]);
        }
        loads
    }

    /// A row for each road, mass and axis.
    pub fn csv(&self) -> String {
        let [rms, weighted] = ["rms", "weighted_rms"].map(|what| units::heading(what, ACCELERATION));
        let row = |own: &Vibration| {
            let [rms, weighted] = [own.rms, own.weighted_rms].map(|value| units::value(value, ACCELERATION));
            let Vibration {
                road,
                mass,
                axis,
                weighting,
                crest_factor,
                vdv,
                ..
            } = own;
            format!("{road},{mass},{axis},{rms},{weighting},{weighted},{crest_factor},{vdv}\n")
        };
        let head = format!("road,mass,axis,{rms},weighting,{weighted},crest_factor,vdv [m/s^1.75]\n");
        head + &self.vibration.iter().map(row).collect::<String>()
    }
}

/// The largest change of a signal since its first sample, in its unit.
fn largest_change(samples: &[f64]) -> f64 {
    let changes = samples.iter().map(|sample| (sample - samples[0]).abs());
    changes.fold(0.0, f64::max)
}

impl Vibration {
    fn of(course: &Course, signal: &Signal, samples: &[f64]) -> Self {
        let (weighting, called) = match &*signal.axis {
            "z" => (Weighting::Wk, "Wk"),
            _ => (Weighting::Wd, "Wd"),
        };
        let weighted = weighting.apply(samples, course.sample_rate);
        let weighted_rms = rms(&weighted);
        let largest = weighted.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
        Self {
            road: course.name.clone(),
            mass: signal.location.to_string(),
            axis: signal.axis.to_string(),
            weighting: called,
            rms: rms(samples),
            weighted_rms,
            crest_factor: if weighted_rms > 0.0 {
                largest / weighted_rms
            } else {
                0.0
            },
            vdv: vibration_dose(&weighted, course.sample_rate),
        }
    }
}
