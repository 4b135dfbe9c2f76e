//! Roads and obstacles.

use crate::road::{Class, Random, Road, RoadError};
use crate::simulate::{Cleat, Drive, Standard};

/// A road and how it is driven over.
#[derive(Clone, Debug)]
pub struct Course {
    /// Name of the run.
    pub name: String,
    /// The road.
    pub road: Road,
    /// Speed, m/s.
    pub speed: f64,
    /// Sample rate, Hz.
    pub sample_rate: f64,
    /// Number of samples, the first at t = 0.
    pub samples: usize,
    /// True for a road with one obstacle, which causes an impact and an after-shake.
    pub obstacle: bool,
}

/// Default duration of a random road, s: enough for ten periods of a body on its springs.
const DURATION: f64 = 8.0;
const SAMPLE_RATE: f64 = 1000.0;
/// Distance between points of the random road, m.
const SPACING: f64 = 0.03;
/// The default seed of a random road.
pub const SEED: u64 = 1;

impl Course {
    /// A random road of ISO 8608 at a speed (m/s), for a duration (s), by default eight seconds. Its name is
    /// `iso_C_60kmh`, `iso_C7_60kmh` with seed 7, or `iso_C_60kmh_20s` with a given duration.
    ///
    /// # Errors
    /// Fails if the speed is so low that the run ends before the road has risen from flat.
    pub fn random(class: Class, seed: u64, speed: f64, duration: Option<f64>) -> Result<Self, RoadError> {
        let stated = driven(speed, duration);
        let duration = duration.unwrap_or(DURATION);
        let random = Random {
            class,
            seed,
            length: speed * duration + 1.0,
            spacing: SPACING,
        };
        let number = if seed == SEED { String::new() } else { seed.to_string() };
        Ok(Self {
            name: format!("iso_{class:?}{number}_{stated}"),
            road: Road::from_random(&random)?,
            speed,
            sample_rate: SAMPLE_RATE,
            samples: (duration * SAMPLE_RATE) as usize,
            obstacle: false,
        })
    }

    /// A road from its first point at a speed (m/s), to its end or for a duration (s). The name includes both, as in
    /// `belgian_50kmh` and `belgian_50kmh_20s`.
    ///
    /// # Errors
    /// Fails if the road ends before the duration.
    pub fn along(name: &str, road: Road, speed: f64, duration: Option<f64>) -> Result<Self, RoadError> {
        let stated = driven(speed, duration);
        let [first, last] = road.extent();
        let whole = (last - first) / speed;
        let duration = duration.unwrap_or(whole);
        if duration > whole {
            let needed = first + speed * duration;
            return Err(RoadError::TooShort { end: last, needed });
        }
        Ok(Self {
            name: format!("{name}_{stated}"),
            road: road.beginning_at_zero(),
            speed,
            sample_rate: SAMPLE_RATE,
            samples: (duration * SAMPLE_RATE) as usize,
            obstacle: false,
        })
    }

    /// The runs of thesis table 3.3, with names such as `30kmh_20mm`.
    ///
    /// # Errors
    /// Never fails if the shape of the cleat is a road.
    pub fn standard() -> Result<Vec<Self>, RoadError> {
        let course = |own: Standard| {
            let name = format!("{:.0}kmh_{:.0}mm", 3.6 * own.speed, 1e3 * own.height);
            let (speed, sample_rate, samples) = (own.drive().speed, own.drive().sample_rate, own.drive().samples);
            Self {
                name,
                road: own.road,
                speed,
                sample_rate,
                samples,
                obstacle: true,
            }
        };
        Ok(Standard::all()?.into_iter().map(course).collect())
    }

    /// The course of a measured run.
    pub fn measured(cleat: &Cleat) -> Self {
        let drive = cleat.drive();
        Self {
            name: cleat.run.name.clone(),
            road: cleat.road.clone(),
            speed: drive.speed,
            sample_rate: drive.sample_rate,
            samples: drive.samples,
            obstacle: true,
        }
    }

    /// The whole run.
    pub fn drive(&self) -> Drive<'_> {
        Drive {
            road: &self.road,
            speed: self.speed,
            sample_rate: self.sample_rate,
            samples: self.samples,
        }
    }
}

/// Suffix of a course's name: the speed to a thousandth of a km/h, and the duration if it is given.
fn driven(speed: f64, duration: Option<f64>) -> String {
    let speed = (3600.0 * speed).round() / 1e3;
    let duration = duration.map_or_else(String::new, |duration| format!("_{duration}s"));
    format!("{speed}kmh{duration}")
}
