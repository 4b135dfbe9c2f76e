//! The car of the cleat runs: axle_d with z and x chains on an area tyre.

#[path = "../../qcar-runtime/tests/support/track.rs"]
mod track;

use models::axle_d::AxleD;
use qcar_runtime::model::Model;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::simulate::{Car, Variant};
use qcar_runtime::tyre::{Geometry, Rates, Tyre};

pub use track::{cleat, drive};

/// Radius of the unloaded tyre, m.
pub const RADIUS: f64 = 0.324;
const STATIC_DEFLECTION: f64 = 0.03102;
const LOAD: f64 = 5749.6;

/// A rear axle of a heavy saloon, corner level.
const PARAMETERS: [(&str, f64); 27] = [
    ("m_corner", 586.1),
    ("m_half_vehicle", 1240.0),
    ("m_wheel_other_axle", 38.4),
    ("static_tire_load", LOAD),
    ("static_tire_def", STATIC_DEFLECTION),
    ("m_wheel", 46.7),
    ("m_tm", 5.1),
    ("m_sf", 24.1),
    ("m_pwt", 42.2),
    ("k_wheel_z", 48_360.0),
    ("c_wheel_z", 3432.0),
    ("k_tm", 417_000.0),
    ("c_tm", 651.0),
    ("k_sf_z", 505_700.0),
    ("c_sf_z", 698.0),
    ("k_pwt_z", 323_100.0),
    ("c_pwt_z", 444.0),
    ("mr_spring", 0.625),
    ("mr_damper", 0.672),
    ("k_wheel_x", 512_000.0),
    ("c_wheel_x", 614.0),
    ("k_sf_x", 2_430_000.0),
    ("c_sf_x", 1400.0),
    ("k_pwt_x", 252_800.0),
    ("c_pwt_x", 353.0),
    ("k_tire", 208_200.0),
    ("c_tire", 238.0),
];

/// The value of every parameter.
pub fn parameters() -> Values {
    let given = PARAMETERS
        .iter()
        .map(|&(name, value)| (name.to_owned(), value))
        .collect();
    Values::resolve(AxleD.about(), &given, &Default::default()).expect("every parameter has a value")
}

/// The car on its tyre.
pub fn car(parameters: &Values) -> Car<'_, AxleD> {
    on_tyre(&AxleD, parameters)
}

/// The same car with another implementation of its model.
pub fn on_tyre<'a, M: Model + ?Sized>(model: &'a M, parameters: &'a Values) -> Car<'a, M> {
    let tyre = Tyre::new(RADIUS, STATIC_DEFLECTION, Geometry::Area, Rates::AtStaticDeflection).expect("a tyre");
    Car {
        model,
        parameters: parameters.as_slice(),
        tyre,
        load: LOAD,
        variant: Variant::Complete,
    }
}
