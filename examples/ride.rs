//! Rides over cleats of three heights: largest acceleration of the body, and time for which the tyre is in the air.
//!
//! ```text
//! cargo run --release --example ride
//! ```

use std::error::Error;
use std::path::Path;

use models::axle_d::{ABOUT, AxleD, output};
use qcar::parameters;
use qcar_runtime::simulate::{Car, Settings, Standard, Variant, ride};
use qcar_runtime::tyre::{Geometry, Rates, Tyre};

/// Rides at 30 km/h.
pub fn main() -> Result<(), Box<dyn Error>> {
    let values = parameters::resolve(&ABOUT, [Path::new("tests/data/axle_d.toml")], &[])?;
    let car = Car {
        model: &AxleD,
        parameters: values.as_slice(),
        tyre: Tyre::new(0.315, 0.018, Geometry::Area, Rates::AtStaticDeflection)?,
        load: 586.0 * 9.81,
        variant: Variant::Complete,
    };
    for height in [0.01, 0.02, 0.03] {
        let cleat = Standard::over(height, 30.0 / 3.6)?;
        let ridden = ride(&car, &cleat.drive(), &Settings::default())?;
        let body = &ridden.outputs[output::Z_BODY_ACCELERATION];
        let hardest = body.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let air: f64 = ridden
            .landings
            .iter()
            .zip(&ridden.lift_offs)
            .map(|(down, up)| down - up)
            .sum();
        println!(
            "{:.0} mm: {hardest:.2} m/s² at the body, {:.1} ms in the air",
            1e3 * height,
            1e3 * air
        );
    }
    Ok(())
}
