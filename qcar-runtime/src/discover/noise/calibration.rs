//! How a calibrated sensor may be wrong, and by how much.

/// A way in which a sensor may be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// What it is.
    pub form: Form,
    /// Standard deviation of its coefficient before any measurement.
    pub sigma: f64,
}

/// The form of an error over frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Gain: the Chebyshev polynomial of this degree in the logarithm of frequency, 1 being its amplitude.
    Gain(usize),
    /// Phase, rad, in the same polynomials.
    Phase(usize),
    /// A delay, s.
    Delay,
    /// What the sensor of a time history reads at zero, relative to the RMS value of what it reads.
    Offset,
}

/// Prior of a sensor: 0.7 % of gain in all, its half in what varies with frequency; 0.2° of phase and 50 µs of delay; a
/// tenth of what is read for the offset of a history.
///
/// Thesis section 3.4 has capacitive accelerometers; their data sheets give 0.5 to 1 % of gain and the phase of a
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

/// The most that a calibration is wrong by, in standard deviations of its prior. What is beyond is a fault of the sensor:
/// a gap, which has to be explained.
///
/// Two sensors that are compared may both be wrong, so that a ratio of them is allowed twice as much.
pub const STRAINED: f64 = 2.0;
