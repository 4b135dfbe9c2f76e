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
    /// Shelf of this number, from 0: a log gain that rises by 1 about a corner frequency, with its minimum phase. The
    /// corner frequencies are evenly spaced over the band in log frequency.
    Shelf(usize),
    /// Phase, rad, the same at all frequencies.
    Phase,
    /// Delay, s.
    Delay,
    /// Zero offset of a sensor in a time history, relative to the RMS of its readings.
    Offset,
}

/// Number of shelves of a calibration curve, a choice: about four in each decade of a rig's band. A shelf rises over
/// about one decade.
pub const SHELVES: usize = 6;

/// Accuracy class of the calibration curves of a campaign's sensors. Class 0 is that of the data sheets below; each
/// further class has √2 times the error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct AccuracyClass(usize);

/// Prior standard deviation of a shelf in class 0: 1 % of gain for all shelves together.
const CALIBRATED: f64 = 0.004;

impl AccuracyClass {
    /// Number of classes: up to 16 % of gain for all shelves together, which is hardly a calibration any more.
    const COUNT: usize = 9;

    /// All classes, the most accurate first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::COUNT).map(Self)
    }

    /// Prior standard deviation of a shelf.
    pub fn shelf(self) -> f64 {
        CALIBRATED * (self.0 as f64 / 2.0).exp2()
    }

    /// Standard deviation of the gain for all shelves together, as a share.
    pub fn gain(self) -> f64 {
        self.shelf() * (SHELVES as f64).sqrt()
    }

    /// Negative log prior of the class, up to a constant. The prior is exponential in the error beyond that of the data
    /// sheets, with the latter as its mean.
    pub fn cost(self) -> f64 {
        self.shelf() / CALIBRATED - 1.0
    }
}

/// Priors of a sensor in addition to its calibration curve: 0.7 % of gain; 0.2° of phase; 50 µs of delay; an offset in
/// time histories of a tenth of the reading.
///
/// Thesis section 3.4 uses capacitive accelerometers. Their data sheets give 0.5 to 1 % of gain and the phase of a
/// first-order filter at several hundred hertz.
pub const SENSOR: [Shape; 4] = [
    Shape {
        form: Form::Gain,
        sigma: 0.007,
    },
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
