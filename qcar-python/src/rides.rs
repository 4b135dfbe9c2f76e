//! Rides over a road, each with its own parameters, speed and obstacle.

use ndarray::{Array1, Array2, Array3, ArrayView1, ArrayView2};
use qcar::catalogue::Loaded;
use qcar::stopping;
use qcar_runtime::campaign::RoleNames;
use qcar_runtime::compare::{Alignment, Errors, Windows};
use qcar_runtime::model::{About, Quantity, SignalKind};
use qcar_runtime::progress;
use qcar_runtime::road::{Road, Shape};
use qcar_runtime::roles::Roles;
use qcar_runtime::simulate::{Car, Drive, Method, Ride, Settings, Variant, ride};
use qcar_runtime::tyre::Tyre;

use crate::errors;

/// Common settings of all rides.
pub struct Common {
    /// The tyre.
    pub tyre: Tyre,
    /// Static load on it, N.
    pub load: f64,
    /// Variant of the model.
    pub variant: Variant,
    /// A road for all rides; without one, a cleat of each ride's height.
    pub road: Option<Road>,
    /// Straight part of the cleat's descent, its return to the flat, and the flat road before it, m.
    pub cleat: [f64; 3],
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// Number of samples of each ride.
    pub samples: usize,
    /// Relative tolerance.
    pub tolerance: f64,
}

/// Settings of each ride.
pub struct Each<'a> {
    /// Parameters, SI: (rides, parameters).
    pub p: ArrayView2<'a, f64>,
    /// Heights of the cleats, m.
    pub height: ArrayView1<'a, f64>,
    /// Speeds, m/s.
    pub speed: ArrayView1<'a, f64>,
}

/// Recorded signals and values of rides.
pub struct Recorded {
    /// Outputs: (rides, outputs, samples).
    pub outputs: Array3<f64>,
    /// Force of the tyre along z and x and area of its contact: (rides, 3, samples).
    pub tyre: Array3<f64>,
    /// Largest magnitude of each output in the impact: (rides, outputs).
    pub peak: Array2<f64>,
    /// Root mean square of each output in the after-shake: (rides, outputs).
    pub after_shake: Array2<f64>,
    /// Deflection of the tyre before the obstacle, m: (rides,).
    pub static_deflection: Array1<f64>,
    /// Times at which the tyre lost contact, s, ride by ride.
    pub lift_offs: Vec<Vec<f64>>,
}

/// Simulates all rides in parallel; each is the same as it is alone.
///
/// # Errors
/// Fails with the message of the first ride that cannot be simulated.
pub fn rides(model: &Loaded, common: &Common, each: &Each<'_>) -> Result<Recorded, String> {
    let count = each.p.nrows();
    let (outputs, samples) = (model.about().outputs.len(), common.samples);
    let wheel = wheel(model.about());
    let mut recorded = Recorded {
        outputs: Array3::zeros((count, outputs, samples)),
        tyre: Array3::zeros((count, 3, samples)),
        peak: Array2::from_elem((count, outputs), f64::NAN),
        after_shake: Array2::from_elem((count, outputs), f64::NAN),
        static_deflection: Array1::zeros(count),
        lift_offs: Vec::with_capacity(count),
    };
    let stop = stopping::of_this_work();
    let all: Vec<usize> = (0..count).collect();
    let told = |_, _| stopping::here(stop.as_ref());
    let done = progress::map(&all, &told, |&nth| one(model, common, each, nth));
    for (nth, own) in done.into_iter().enumerate() {
        let own = own.map_err(|error| errors::which("ride", nth, count) + &error)?;
        recorded.take(nth, own, wheel, common.sample_rate);
    }
    Ok(recorded)
}

fn one(model: &Loaded, common: &Common, each: &Each<'_>, nth: usize) -> Result<Ride, String> {
    let words = |error: &dyn std::fmt::Display| error.to_string();
    let speed = each.speed[nth];
    let length = speed * common.samples as f64 / common.sample_rate;
    let [descent, blend, run_in] = common.cleat;
    let height = each.height[nth];
    let road = match &common.road {
        Some(road) => road.clone(),
        None => Road::from_shape(&Shape::Cleat { height, descent, blend }, run_in).map_err(|error| words(&error))?,
    };
    let parameters = each.p.row(nth).to_vec();
    let car = Car {
        model: &**model,
        parameters: &parameters,
        tyre: common.tyre,
        load: common.load,
        variant: common.variant,
    };
    let drive = Drive {
        road: &road.reaching(length),
        speed,
        sample_rate: common.sample_rate,
        samples: common.samples,
    };
    let settings = Settings {
        method: Method::Adaptive(common.tolerance),
        ..Settings::default()
    };
    ride(&car, &drive, &settings).map_err(|error| words(&error))
}

impl Recorded {
    fn take(&mut self, nth: usize, ride: Ride, wheel: Option<usize>, sample_rate: f64) {
        let felt = wheel.and_then(|wheel| Alignment::at_peak(&ride.outputs[wheel], &ride.outputs[wheel]).ok());
        for (output, signal) in ride.outputs.iter().enumerate() {
            self.outputs
                .slice_mut(ndarray::s![nth, output, ..])
                .assign(&ArrayView1::from(signal));
            let errors =
                felt.and_then(|felt| Errors::between(signal, signal, &felt, sample_rate, &Windows::default()).ok());
            if let Some(errors) = errors {
                (self.peak[[nth, output]], self.after_shake[[nth, output]]) = (errors.peaks[1], errors.after_shakes[1]);
            }
        }
        for (row, signal) in [&ride.force[0], &ride.force[1], &ride.area].into_iter().enumerate() {
            self.tyre
                .slice_mut(ndarray::s![nth, row, ..])
                .assign(&ArrayView1::from(signal));
        }
        self.static_deflection[nth] = ride.static_deflection;
        self.lift_offs.push(ride.lift_offs);
    }
}

/// The acceleration that responds to the obstacle first, which determines impact and after-shake.
fn wheel(about: &About) -> Option<usize> {
    let roles = Roles::of(about, &RoleNames::default()).ok()?;
    let of = |mass: &str| {
        about.outputs.iter().position(|output| {
            let signal = &output.signal;
            signal.kind == SignalKind::Motion(Quantity::Acceleration)
                && signal.location == mass
                && signal.axis == roles.axis
        })
    };
    roles.feeling().find_map(of)
}
