//! What is driven over.

use crate::road::{Road, RoadError};
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
}

impl Course {
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
