//! The tyre and the road profile of an FMU that rolls.

use std::collections::BTreeMap;
use std::path::Path;

use qcar_runtime::campaign::RoleNames;
use qcar_runtime::error::InputError;
use qcar_runtime::metric::Course;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road;
use qcar_runtime::simulate::{Car, Drive, Settings, Variant, end_of_ride, tyre_of};
use qcar_runtime::tyre::Tyre;

use crate::catalogue::Loaded;
use crate::export::fmu::OnTyre;
use crate::failure::{Failure, flag};
use crate::parameters::FileExtras;
use crate::roads::{RequestedRoad, check_rolls};

/// Largest number of points of a profile, which are written as C source text.
const POINTS: usize = 200_000;

/// A model at rest before a road, on the tyre of the vehicle in `params` (a campaign or parameter file).
///
/// # Errors
/// Fails if the road cannot be used, if there are no vehicle data, if the tyre of the model does not roll, or if the
/// model has no equilibrium on the tyre.
pub(super) fn on_tyre(
    asked: &RequestedRoad,
    (model, values): (&Loaded, &Values),
    params: Option<&Path>,
) -> Result<OnTyre, Failure> {
    check_rolls(model.about(), &RoleNames::default(), "--road")?;
    let course = asked.course()?;
    let (tyre, load) = vehicle((model, values), params)?;
    let road = profile(&course)?;
    let car = Car {
        model: &**model,
        parameters: values.as_slice(),
        tyre,
        load,
        variant: Variant::Complete,
    };
    let rest = rest(&car, course.speed).map_err(|error| {
        let remedy = "correct the vehicle or the parameters";
        flag("--road", error, "a model in equilibrium on its tyre", remedy)
    })?;
    Ok(OnTyre {
        start: start(&road, &tyre),
        road,
        radius: tyre.radius(),
        deflection: tyre.static_deflection(),
        load,
        speed: course.speed,
        rest,
    })
}

fn vehicle((model, values): (&Loaded, &Values), params: Option<&Path>) -> Result<(Tyre, f64), InputError> {
    let Some(file) = params else {
        let expected = "r_tire, static_tire_def and static_tire_load";
        let remedy = "add --params with a campaign, or a file that has [vehicle]";
        return Err(flag("--road", "no --params", expected, remedy).into());
    };
    let facts: BTreeMap<String, f64> = FileExtras::read(file)?.vehicle;
    let own = |name: &str| {
        let place = model.about().parameters.iter().position(|own| own.name == name)?;
        values.as_slice().get(place).copied()
    };
    let shown = match file.is_dir() {
        true => file.join("campaign.toml"),
        false => file.into(),
    };
    tyre_of(&|name| own(name).or_else(|| facts.get(name).copied()), &shown)
}

/// The part of the road that the ride needs.
fn profile(course: &Course) -> Result<Vec<[f64; 2]>, Failure> {
    let end = course.speed * course.samples as f64 / course.sample_rate;
    let points = course.road.vertices();
    // One point beyond the last that is reached.
    let needed = points.partition_point(|[x, _]| *x <= end) + 1;
    let points = &points[..needed.min(points.len())];
    if points.len() > POINTS {
        let found = format!("a road of {} points", points.len());
        let expected = format!("at most {POINTS} in a unit");
        return Err(flag(
            "--road",
            found,
            &expected,
            "write a duration behind the speed, such as `:20s`",
        )
        .into());
    }
    Ok(points.to_vec())
}

/// Start position: x = 0, or earlier if the whole tyre is not on level ground there.
fn start(road: &[[f64; 2]], tyre: &Tyre) -> f64 {
    let uneven = road.windows(2).find(|two| two[0][1] != two[1][1]);
    uneven.map_or(0.0, |two| (two[0][0] - tyre.radius()).min(0.0))
}

/// The equilibrium on level ground.
fn rest<M: Model + ?Sized>(car: &Car<'_, M>, speed: f64) -> Result<Vec<f64>, String> {
    /// Samples while a point passes through the contact.
    const SAMPLES: f64 = 8.0;
    let level = Road::flat(0.0);
    let drive = Drive {
        road: &level,
        speed,
        sample_rate: SAMPLES * speed / car.tyre.patch(),
        samples: 1,
    };
    let ended = end_of_ride(car, &drive, &Settings::default());
    ended.map(|(rest, _)| rest).map_err(|error| error.to_string())
}
