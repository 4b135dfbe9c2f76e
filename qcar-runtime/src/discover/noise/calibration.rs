//! Forms and priors of the errors of a calibrated sensor.

/// One form of sensor error with its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Form of the error.
    pub form: Form,
    /// Prior standard deviation of its coefficient.
    pub sigma: f64,
}

/// Form of a sensor error over frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Log gain, the same at all frequencies.
    Gain,
    /// Log gain that rises by 1 about a corner frequency, with the phase that belongs to it. Three of them are
    /// spread evenly over the band in log frequency, counted from 0.
    Shelf(usize),
    /// Phase, rad, the same at all frequencies.
    Phase,
    /// Delay, s.
    Delay,
    /// Zero offset of a sensor in a time history, relative to the RMS of its readings.
    Offset,
}

/// Number of shelves of a calibration curve. Each extends over a decade, a band over one to two.
pub const CORNERS: usize = 3;

/// A shelf with its prior: 1 % of gain for all shelves together, as in the data sheets below.
const fn shelf(place: usize) -> Shape {
    Shape {
        form: Form::Shelf(place),
        sigma: 0.006,
    }
}

/// Priors of a sensor: 0.7 % of gain; a smooth calibration curve; 0.2° of phase; 50 µs of delay; an offset in time
/// histories of a tenth of the reading.
///
/// Thesis section 3.4 uses capacitive accelerometers. Their data sheets give 0.5 to 1 % of gain and the phase of a
/// first-order filter at several hundred hertz.
pub const SENSOR: [Shape; 7] = [
    Shape {
        form: Form::Gain,
        sigma: 0.007,
    },
    shelf(0),
    shelf(1),
    shelf(2),
    Shape {
        form: Form::Phase,
        sigma: 0.003,
    },
    Shape {
        form: Form::Delay,
        sigma: 5e-5,
    },
    Shape {
        form: Form::Offset,
        sigma: 0.1,
    },
];

/// Largest calibration error of a fit against noise alone, in prior standard deviations. A larger error is a sensor
/// fault; it must remain in the residual.
///
/// Both sensors of a ratio may have this error, so the ratio may have twice as much.
pub const CALIBRATION_BOUND: f64 = 2.0;
