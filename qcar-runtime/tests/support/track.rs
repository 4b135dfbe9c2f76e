//! The cleats of the test track and a second's drive over one, for rides in tests and benchmarks.

use qcar_runtime::road::{Road, Shape};
use qcar_runtime::simulate::Drive;

/// The thesis's cleat of a height (m), with the length of those on the test track.
pub fn cleat(height: f64) -> Road {
    Road::from_shape(
        &Shape::Cleat {
            height,
            descent: 0.4,
            blend: 0.17,
        },
        1.5,
    )
    .expect("a road")
}

/// A second at 1 kHz, at a speed in m/s.
pub fn drive(road: &Road, speed: f64) -> Drive<'_> {
    Drive {
        road,
        speed,
        sample_rate: 1000.0,
        samples: 1001,
    }
}
