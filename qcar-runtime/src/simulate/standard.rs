//! Standard runs over a cleat, without a measurement, among them those of thesis table 3.3.

use super::ride::Drive;
use crate::road::{Road, RoadError, Shape};

/// A standard run over a cleat, without a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Standard {
    /// Speed, m/s.
    pub speed: f64,
    /// Height of the cleat, m.
    pub height: f64,
    /// The road.
    pub road: Road,
}

/// Speeds, m/s.
const SPEEDS: [f64; 3] = [20.0 / 3.6, 30.0 / 3.6, 40.0 / 3.6];
/// Heights, m.
const HEIGHTS: [f64; 4] = [0.01, 0.02, 0.03, 0.04];
/// Flat road before the cleat, m.
const RUN_IN: f64 = 1.5;

const SAMPLE_RATE: f64 = 1000.0;
/// Shortest duration, s: run-in at the lowest speed, impact of 0.1 s and after-shake of one second.
const DURATION: f64 = 1.5;

impl Standard {
    /// All twelve, each speed with its heights.
    ///
    /// # Errors
    /// Never fails if the shape of the cleat is a road.
    pub fn all() -> Result<Vec<Self>, RoadError> {
        let conditions = SPEEDS
            .iter()
            .flat_map(|&speed| HEIGHTS.iter().map(move |&height| (speed, height)));
        conditions.map(|(speed, height)| Self::over(height, speed)).collect()
    }

    /// A run over a cleat of a height (m) at a speed (m/s).
    ///
    /// # Errors
    /// Fails if the height makes no cleat.
    pub fn over(height: f64, speed: f64) -> Result<Self, RoadError> {
        let road = road(height, speed * duration(speed))?;
        Ok(Self { speed, height, road })
    }

    /// The whole run.
    pub fn drive(&self) -> Drive<'_> {
        Drive {
            road: &self.road,
            speed: self.speed,
            sample_rate: SAMPLE_RATE,
            samples: (duration(self.speed) * SAMPLE_RATE) as usize,
        }
    }
}

/// A slower wheel needs longer for the run-in, s.
fn duration(speed: f64) -> f64 {
    if speed < SPEEDS[0] {
        DURATION + RUN_IN / speed - RUN_IN / SPEEDS[0]
    } else {
        DURATION
    }
}

/// A cleat on a road of a length (m).
fn road(height: f64, length: f64) -> Result<Road, RoadError> {
    // Lengths of the straight part of the descent after the step and of its return to the flat, as on a common test
    // track.
    let (descent, blend) = (0.4, 0.17);
    Ok(Road::from_shape(&Shape::Cleat { height, descent, blend }, RUN_IN)?.reaching(length))
}

#[cfg(test)]
mod tests {
    use super::Standard;

    #[test]
    fn every_road_is_long_enough_for_its_run() {
        let all = Standard::all().unwrap();
        assert_eq!(all.len(), 12);
        for run in all {
            let drive = run.drive();
            let travelled = drive.speed * (drive.samples - 1) as f64 / drive.sample_rate;
            assert!(run.road.check_reaches(travelled).is_ok());
            let highest = run.road.vertices().iter().map(|point| point[1]).fold(0.0, f64::max);
            assert_eq!(highest, run.height);
        }
    }
}
