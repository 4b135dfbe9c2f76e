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
    /// Log gain: the Chebyshev polynomial of this degree in log frequency, with amplitude 1.
    Gain(usize),
    /// Phase, rad, in the same polynomials.
    Phase(usize),
    /// Delay, s.
    Delay,
    /// Zero offset of a sensor in a time history, relative to the RMS of its readings.
    Offset,
}

/// Priors of a sensor: about 0.7 % of gain, half of it varying with frequency; 0.2° of phase; 50 µs of delay; an offset
/// in time histories of a tenth of the reading.
///
/// Thesis section 3.4 uses capacitive accelerometers. Their data sheets give 0.5 to 1 % of gain and the phase of a
/// first-order filter at several hundred hertz.
pub const SENSOR: [Shape; 7] = [
    Shape {
        form: Form::Gain(0),
        sigma: 0.007,
    },
    Shape {
        form: Form::Gain(1),
        sigma: 0.0035,
    },
    Shape {
        form: Form::Gain(2),
        sigma: 0.0025,
    },
    Shape {
        form: Form::Gain(3),
        sigma: 0.0015,
    },
    Shape {
        form: Form::Phase(0),
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
