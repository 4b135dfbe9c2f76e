//! Obstacles from a description: cleat, half-sine, plank, pothole.

use super::RoadError;

/// An obstacle on a flat road; lengths and heights in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The cleat of thesis section 3.6.1: a vertical step up, a straight descent, and a return to the flat whose
    /// curvature is zero at both of its ends.
    Cleat {
        /// Height of the step.
        height: f64,
        /// Length of the straight part of the descent.
        descent: f64,
        /// Length of the return.
        blend: f64,
    },
    /// Half a period of a sine.
    HalfSine {
        /// Height in the middle.
        height: f64,
        /// Length.
        length: f64,
    },
    /// A rectangle above the road.
    Plank {
        /// Height of both steps.
        height: f64,
        /// Length.
        length: f64,
    },
    /// A rectangle below the road.
    Pothole {
        /// Depth of both steps.
        depth: f64,
        /// Length.
        length: f64,
    },
}

/// Largest distance of a chord from the curve that it replaces, m.
const SAGITTA: f64 = 1e-7;
/// Length of flat road after the obstacle, m.
const RUN_OUT: f64 = 10.0;

impl Shape {
    /// The points of the road with the obstacle at `run_in`.
    pub(super) fn points(&self, run_in: f64) -> Result<Vec<[f64; 2]>, RoadError> {
        positive("run-in", run_in)?;
        let outline = match *self {
            Self::Cleat { height, descent, blend } => cleat(
                positive("height of the cleat", height)?,
                positive("descent of the cleat", descent)?,
                positive("blend of the cleat", blend)?,
            ),
            Self::HalfSine { height, length } => half_sine(
                positive("height of the half-sine", height)?,
                positive("length of the half-sine", length)?,
            ),
            Self::Plank { height, length } => rectangle(
                positive("height of the plank", height)?,
                positive("length of the plank", length)?,
            ),
            Self::Pothole { depth, length } => rectangle(
                -positive("depth of the pothole", depth)?,
                positive("length of the pothole", length)?,
            ),
        };
        let end = outline[outline.len() - 1][0] + run_in;
        let obstacle = outline.iter().map(|&[x, z]| [x + run_in, z]);
        Ok(std::iter::once([0.0, 0.0])
            .chain(obstacle)
            .chain([[end + RUN_OUT, 0.0]])
            .collect())
    }
}

fn positive(name: &'static str, value: f64) -> Result<f64, RoadError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(RoadError::Shape {
            name,
            expected: "a positive number of metres",
            value,
        })
    }
}

/// The slope of the return goes from that of the descent to zero as `1 - 3u² + 2u³`, whose mean is one half.
fn cleat(height: f64, descent: f64, blend: f64) -> Vec<[f64; 2]> {
    let slope = height / (descent + blend / 2.0);
    let start = height - slope * descent;
    let curvature = 1.5 * slope / blend;
    let blended = curve(blend, curvature, |x| {
        let u = x / blend;
        start - slope * blend * u * (1.0 - u * u + u * u * u / 2.0)
    });
    let foot = [[0.0, 0.0], [0.0, height]];
    foot.into_iter()
        .chain(blended.into_iter().map(|[x, z]| [descent + x, z]))
        .chain([[descent + blend, 0.0]])
        .collect()
}

fn half_sine(height: f64, length: f64) -> Vec<[f64; 2]> {
    let wave_number = std::f64::consts::PI / length;
    let mut points = curve(length, height * wave_number * wave_number, |x| {
        height * (wave_number * x).sin()
    });
    points.push([length, 0.0]);
    points
}

fn rectangle(height: f64, length: f64) -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [0.0, height], [length, height], [length, 0.0]]
}

/// Points of a curve, without its end, so close that the chords between them are within [`SAGITTA`] of it.
fn curve(length: f64, curvature: f64, height: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let pieces = (length * (curvature / (8.0 * SAGITTA)).sqrt()).ceil().max(1.0);
    (0..pieces as usize)
        .map(|i| length * i as f64 / pieces)
        .map(|x| [x, height(x)])
        .collect()
}
