//! Flaws of the car, the rig, the sensors and the logger that real hardware has and no fitted model describes. They are
//! mild; the seed draws the numbers of each.

use std::f64::consts::TAU;

use crate::random::Random;

/// One kind of flaw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The body bends: it has a mode at 20 to 28 Hz.
    FlexibleBody,
    /// The actuator has a resonance and harmonic distortion.
    Pad,
    /// An accelerometer has a cross-axis sensitivity of 2 to 3 %.
    CrossAxis,
    /// The gain of a sensor varies smoothly with frequency within ±2 %, with the minimum phase that belongs to it.
    Calibration,
    /// The damper warms up and loses a few percent of its damping.
    Heat,
    /// The zero of a sensor drifts.
    Drift,
    /// Mains hum.
    Hum,
    /// The trigger of a cleat record is some ms early or late.
    Jitter,
    /// Left and right differ by 3 to 4 %.
    Sides,
    /// Over a cleat the tyre consists of radial springs.
    Tyre,
    /// Over a cleat the tyre follows elliptical cams, which reach the cleat earlier. This flaw is not mild.
    Cams,
}

impl Flaw {
    /// All mild flaws.
    pub const MILD: [Self; 10] = [
        Self::FlexibleBody,
        Self::Pad,
        Self::CrossAxis,
        Self::Calibration,
        Self::Heat,
        Self::Drift,
        Self::Hum,
        Self::Jitter,
        Self::Sides,
        Self::Tyre,
    ];

    /// The flaw with this name, as `{:?}` prints it.
    pub fn named(name: &str) -> Option<Self> {
        Self::MILD
            .into_iter()
            .chain([Self::Cams])
            .find(|flaw| format!("{flaw:?}") == name)
    }
}

/// The flaws of a campaign. The numbers of a flaw do not depend on which others are present.
#[derive(Clone, Debug, Default)]
pub struct Hardware {
    seed: u64,
    flaws: Vec<Flaw>,
}

/// A free-free mode of the body over its generalised mass (Craig, R. R., Kurdila, A. J.: Fundamentals of structural
/// dynamics, 2nd ed. 2006, chapters 10 and 17). The shape is 1 where the suspension acts.
#[derive(Clone, Copy, Debug)]
pub struct Flexible {
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Share of critical.
    pub damping: f64,
    /// Effective mass: the mass of an attached oscillator with the same effect at the suspension, as share of the
    /// body's mass.
    pub mass_share: f64,
    /// The mode shape at the sensor.
    pub at_sensor: f64,
}

impl Flexible {
    /// Generalised mass over the body's mass: for an effective share μ it is (1 - μ)/μ.
    pub fn generalised(&self) -> f64 {
        (1.0 - self.mass_share) / self.mass_share
    }
}

/// A closed-loop actuator of second order with a nonlinear valve (Merritt, H. E.: Hydraulic control systems, 1967,
/// chapters 5 and 8).
#[derive(Clone, Copy, Debug)]
pub struct Pad {
    /// Resonance, rad/s.
    pub omega: f64,
    /// Share of critical.
    pub damping: f64,
    /// Second and third harmonic of the acceleration, as share of the first, with their phases.
    pub harmonics: [(f64, f64); 2],
}

impl Pad {
    /// Magnitude and phase of the response at an angular frequency.
    pub fn response(&self, omega: f64) -> (f64, f64) {
        let r = omega / self.omega;
        let (re, im) = (1.0 - r * r, 2.0 * self.damping * r);
        (1.0 / re.hypot(im), -im.atan2(re))
    }
}

/// Damping lost to heat. It falls exponentially towards a steady state: the heating is constant and the cooling
/// proportional to the excess temperature (Dixon, J. C.: The shock absorber handbook, 2nd ed. 2007, section 5.20).
#[derive(Clone, Copy, Debug)]
pub struct Heat {
    /// Share of the damping that is lost by the end of a run.
    pub loss: f64,
    /// Time constant as share of a run.
    pub time_constant: f64,
}

impl Heat {
    /// Remaining share of the damping at a time, which is given as a share of the run.
    pub fn left(&self, share: f64) -> f64 {
        let rise = |share: f64| 1.0 - (-share / self.time_constant).exp();
        1.0 - self.loss * rise(share) / rise(1.0)
    }
}

/// Radial springs, each compressed along its own direction (Davis, D. C.: A radial-spring terrain-enveloping tire
/// model, Vehicle System Dynamics 4, 1975), with the measured force over deflection on flat ground.
#[derive(Clone, Copy, Debug)]
pub struct RadialSprings {
    /// Exponent of a spring's force over its compression; 1 in the source.
    pub exponent: f64,
}

/// A tandem of two elliptical cams that follows the road (Schmeitz, A. J. C.: A semi-empirical three-dimensional model
/// of the pneumatic tyre rolling over arbitrarily uneven road surfaces, TU Delft 2004; Pacejka, H. B.: Tire and vehicle
/// dynamics, 3rd ed. 2012, section 10.1.6). Lengths are shares of the free radius.
#[derive(Clone, Copy, Debug)]
pub struct Cams {
    /// Half the length of an ellipse, as share of the free radius.
    pub length: f64,
    /// Half its height, as share of the free radius.
    pub height: f64,
    /// Its exponent.
    pub order: f64,
    /// Distance between the two cams, as share of the contact length.
    pub apart: f64,
}

impl Hardware {
    /// The given flaws, with numbers drawn by a seed.
    pub fn new(seed: u64, flaws: Vec<Flaw>) -> Self {
        Self { seed, flaws }
    }

    fn random(&self, flaw: Flaw, purpose: &str) -> Option<Random> {
        let salt = format!("{flaw:?} {purpose}");
        self.flaws.contains(&flaw).then(|| Random::new(self.seed, &salt))
    }

    /// The body's bending mode.
    pub fn flexible(&self) -> Option<Flexible> {
        self.random(Flaw::FlexibleBody, "").map(|mut random| Flexible {
            omega: TAU * random.uniform(20.0, 28.0),
            damping: random.uniform(0.02, 0.05),
            mass_share: random.uniform(0.015, 0.035),
            at_sensor: random.uniform(0.4, 1.2),
        })
    }

    /// The actuator.
    pub fn pad(&self) -> Option<Pad> {
        self.random(Flaw::Pad, "").map(|mut random| Pad {
            omega: TAU * random.uniform(45.0, 70.0),
            damping: random.uniform(0.3, 0.5),
            harmonics: [(); 2].map(|()| (random.uniform(0.005, 0.015), random.uniform(0.0, TAU))),
        })
    }

    /// Cross-axis sensitivity of a channel.
    pub fn cross_axis(&self, channel: &str) -> f64 {
        self.random(Flaw::CrossAxis, channel)
            .map_or(0.0, |mut random| random.uniform(0.02, 0.03) * sign(&mut random))
    }

    /// Largest deviation of a channel's gain from 1, and the random numbers that shape its curve.
    pub fn calibration(&self, channel: &str) -> Option<(f64, Random)> {
        self.random(Flaw::Calibration, channel).map(|random| (0.02, random))
    }

    /// The damper's loss to heat.
    pub fn heat(&self) -> Option<Heat> {
        self.random(Flaw::Heat, "").map(|mut random| Heat {
            loss: random.uniform(0.02, 0.04),
            time_constant: random.uniform(0.3, 1.0),
        })
    }

    /// Standard deviation of the drift of a channel's zero in half a minute, in units of its noise.
    pub fn drift(&self, channel: &str) -> f64 {
        self.random(Flaw::Drift, channel)
            .map_or(0.0, |mut random| random.uniform(1.0, 3.0))
    }

    /// Amplitude of the hum in a channel, in units of its noise.
    pub fn hum(&self, channel: &str) -> f64 {
        self.random(Flaw::Hum, channel)
            .map_or(0.0, |mut random| random.uniform(0.5, 1.5))
    }

    /// Delay of the trigger of a run, s.
    pub fn jitter(&self, run: u32) -> f64 {
        self.random(Flaw::Jitter, &run.to_string())
            .map_or(0.0, |mut random| random.uniform(-3e-3, 3e-3))
    }

    /// Relative differences of the values of the other side.
    pub fn sides(&self) -> Option<impl FnMut() -> f64 + use<>> {
        let mut random = self.random(Flaw::Sides, "")?;
        Some(move || random.uniform(0.03, 0.04) * sign(&mut random))
    }

    /// The radial springs of the tyre.
    pub fn radial_springs(&self) -> Option<RadialSprings> {
        self.random(Flaw::Tyre, "").map(|mut random| RadialSprings {
            exponent: any_of(&mut random, [(0.75, 0.9), (1.15, 1.35)]),
        })
    }

    /// The cams of the tyre. MF-Swift's defaults are 1, 1, 1.8 and 0.8.
    pub fn cams(&self) -> Option<Cams> {
        self.random(Flaw::Cams, "").map(|mut random| Cams {
            length: random.uniform(0.97, 1.05),
            height: random.uniform(0.95, 1.03),
            order: random.uniform(1.6, 1.9),
            apart: random.uniform(0.78, 0.86),
        })
    }
}

/// Uniform in one of two ranges, each equally probable.
fn any_of(random: &mut Random, ranges: [(f64, f64); 2]) -> f64 {
    let (low, high) = ranges[usize::from(random.uniform(-1.0, 1.0) > 0.0)];
    random.uniform(low, high)
}

fn sign(random: &mut Random) -> f64 {
    random.uniform(-1.0, 1.0).signum()
}
