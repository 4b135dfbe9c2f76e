//! What is driven over.

use crate::road::{Class, Random, Road, RoadError};
use crate::simulate::{Cleat, Drive, Standard};

/// A road and how it is driven over.
#[derive(Clone, Debug)]
pub struct Course {
    /// Of the run.
    pub name: String,
    /// What is driven over.
    pub road: Road,
    /// m/s.
    pub speed: f64,
    /// Hz.
    pub sample_rate: f64,
    /// Number of samples, the first at t = 0.
    pub samples: usize,
    /// True of a road with one obstacle, over which there is an impact and an after-shake.
    pub obstacle: bool,
}

/// Of the random road, s: enough for ten periods of a body on its springs.
const DURATION: f64 = 8.0;
const SAMPLE_RATE: f64 = 1000.0;
/// Of the random road, m: it is level until the tyre is on it.
const SPACING: f64 = 0.03;

impl Course {
    /// A random road of ISO 8608, always the same of a class, at a speed (m/s); with a name such as `iso_C_60kmh`.
    ///
    /// # Errors
    /// A speed that is too low for the road to rise from level.
    pub fn random(class: Class, speed: f64) -> Result<Self, RoadError> {
        let length = speed * DURATION + 1.0;
        let random = Random {
            class,
            seed: 1,
            length,
            spacing: SPACING,
        };
        Ok(Self {
            name: format!("iso_{class:?}_{:.0}kmh", 3.6 * speed),
            road: Road::from_random(&random)?,
            speed,
            sample_rate: SAMPLE_RATE,
            samples: (DURATION * SAMPLE_RATE) as usize,
            obstacle: false,
        })
    }

    /// The runs of thesis table 3.3, with names such as `30kmh_20mm`.
    ///
    /// # Errors
    /// None, as long as the shape of the cleat is a road.
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

    /// A run as it was measured.
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
