//! Vertices of a road from samples: checks, steps, and one segment for many samples on a line.

use super::RoadError;
use crate::proportion::is_alike;

/// Distance from a line below which a point is on it, m: rounding of the arithmetic.
pub(super) const EXACT: f64 = 1e-12;
/// The same for samples, m: the last digit in road files.
pub(super) const RESOLUTION: f64 = 1e-6;
/// Largest difference between the slope of a sample and that of the chord to the next one.
const SLOPE_TOLERANCE: f64 = 0.1;
/// Share of the slopes that must be the same multiple of the rises, within a factor of two, for that to be a unit and not
/// noise: most of them. A step that is scaled to less than the tolerance of a slope does no harm.
const MOST: f64 = 0.5;
/// Largest change of a road, relative to its standard deviation, if a sample is left out.
const ROUGHNESS_LIMIT: f64 = 0.25;

/// The points of a road in samples, with a second point at the x of every vertical step.
pub(super) fn points(x: &[f64], z: &[f64], slope: &[f64]) -> Result<Vec<[f64; 2]>, RoadError> {
    if x.len() != z.len() || x.len() != slope.len() {
        return Err(RoadError::Lengths {
            x: x.len(),
            z: z.len(),
            slope: slope.len(),
        });
    }
    let points: Vec<[f64; 2]> = x.iter().zip(z).map(|(&x, &z)| [x, z]).collect();
    check_points(&points)?;
    check_finite("slope", slope)?;
    let vertices = with_steps(&points, slope)?;
    check_units(&points, slope)?;
    Ok(vertices)
}

pub(super) fn check_points(points: &[[f64; 2]]) -> Result<(), RoadError> {
    if points.len() < 2 {
        return Err(RoadError::TooFew { found: points.len() });
    }
    for (axis, column) in ["x", "z"].into_iter().enumerate() {
        check_finite(column, &points.iter().map(|p| p[axis]).collect::<Vec<_>>())?;
    }
    if let Some(i) = points.windows(2).position(|w| w[1][0] < w[0][0]) {
        return Err(RoadError::NotMonotonic {
            sample: i + 1,
            before: points[i][0],
            x: points[i + 1][0],
        });
    }
    let [first, last] = [points[0][0], points[points.len() - 1][0]];
    if first < last {
        Ok(())
    } else {
        Err(RoadError::NoLength { x: first })
    }
}

fn check_finite(column: &'static str, values: &[f64]) -> Result<(), RoadError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(sample) => Err(RoadError::NotFinite {
            column,
            sample,
            value: values[sample],
        }),
        None => Ok(()),
    }
}

/// Adds the lower end of each step: if the slope leads past the next sample, the road follows it, then steps.
fn with_steps(points: &[[f64; 2]], slope: &[f64]) -> Result<Vec<[f64; 2]>, RoadError> {
    let mut out = vec![points[0]];
    let mut after_step = false;
    for (pair, &slope) in points.windows(2).zip(slope) {
        let [dx, dz] = rise(pair);
        let step = leads_elsewhere(pair, slope);
        if step && after_step {
            return Err(RoadError::SlopeContradictsHeight {
                x: pair[0][0],
                slope,
                rise: dz / dx,
            });
        }
        if step {
            out.push([pair[1][0], pair[0][1] + slope * dx]);
        }
        out.push(pair[1]);
        after_step = step;
    }
    Ok(out)
}

/// True if the slope of a sample leads past the next one, to which the road then steps.
fn leads_elsewhere(pair: &[[f64; 2]], slope: f64) -> bool {
    let [dx, dz] = rise(pair);
    (dz - slope * dx).abs() > SLOPE_TOLERANCE * dx && dx > 0.0
}

fn rise(pair: &[[f64; 2]]) -> [f64; 2] {
    [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]]
}

/// Refuses slopes that are a multiple of the rises of the heights. The tolerance of a single slope is as large as the
/// slopes of a road themselves, so that a unit can be wrong within it. Slopes that are all zero say nothing.
fn check_units(points: &[[f64; 2]], slope: &[f64]) -> Result<(), RoadError> {
    let gradual = points.windows(2).zip(slope);
    let gradual = gradual.filter(|(pair, slope)| !leads_elsewhere(pair, **slope));
    let stated = gradual.map(|(pair, slope)| (rise(pair), *slope));
    let mut factors: Vec<f64> = stated
        .filter(|([dx, _], slope)| slope * dx != 0.0)
        .map(|([dx, dz], slope)| dz / (slope * dx))
        .collect();
    factors.sort_by(f64::total_cmp);
    let Some(&typical) = factors.get(factors.len() / 2) else {
        return Ok(());
    };
    let same = factors.iter().filter(|factor| is_alike(**factor / typical)).count();
    if is_alike(typical) || (same as f64) < MOST * factors.len() as f64 {
        return Ok(());
    }
    Err(RoadError::SlopeInOtherUnit { factor: 1.0 / typical })
}

/// Largest number of points that count as corners, and smallest relative unevenness of their distances.
const MOST_CORNERS: usize = 50;
const UNEVEN: f64 = 1.5;

/// True if the points are corners of a profile of straight pieces instead of samples: few points at uneven distances,
/// whose slopes lead from each to the next within the resolution of such files.
pub(super) fn are_corners(x: &[f64], points: &[[f64; 2]], slope: &[f64]) -> bool {
    let lengths = || {
        x.windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|length| *length > 0.0)
    };
    let (shortest, longest) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
    // If a slope leads elsewhere, the lower end of a step has been added.
    let leads = points.len() == x.len()
        && points.windows(2).zip(slope).all(|(pair, slope)| {
            let [dx, dz] = rise(pair);
            dx == 0.0 || (dz - slope * dx).abs() <= RESOLUTION
        });
    leads && x.len() <= MOST_CORNERS && longest > UNEVEN * shortest
}

/// Refuses samples that are too far apart for the curve between them.
pub(super) fn check_roughness(points: &[[f64; 2]]) -> Result<(), RoadError> {
    let count = points.len() as f64;
    let mean = points.iter().map(|p| p[1]).sum::<f64>() / count;
    let variance = points.iter().map(|p| (p[1] - mean).powi(2)).sum::<f64>() / count;
    let change = points
        .windows(3)
        .map(change_without_the_middle)
        .map(|c| c * c)
        .sum::<f64>()
        / count;
    let share = (change / variance).sqrt();
    if variance > RESOLUTION * RESOLUTION && share > ROUGHNESS_LIMIT {
        return Err(RoadError::Rough {
            share,
            limit: ROUGHNESS_LIMIT,
        });
    }
    Ok(())
}

/// Distance of a point above the line through its neighbours; zero beside a step, which is intended.
fn change_without_the_middle(w: &[[f64; 2]]) -> f64 {
    if w[0][0] == w[1][0] || w[1][0] == w[2][0] {
        return 0.0;
    }
    let share = (w[1][0] - w[0][0]) / (w[2][0] - w[0][0]);
    w[1][1] - (w[0][1] + share * (w[2][1] - w[0][1]))
}

/// Removes points on the line between the remaining ones, within `tolerance` (m) in z.
pub(super) fn simplify(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let mut points = points.to_vec();
    points.dedup();
    let mut kept = vec![points[0]];
    let mut funnel = Funnel::open(points[0]);
    for pair in points.windows(2) {
        if !funnel.holds(pair[1]) {
            kept.push(pair[0]);
            funnel = Funnel::open(pair[0]);
        }
        funnel.narrow(pair[1], tolerance);
    }
    kept.push(points[points.len() - 1]);
    kept
}

/// The slopes of the lines from a kept point that pass within the tolerance of all points since.
struct Funnel {
    from: [f64; 2],
    lowest: f64,
    highest: f64,
}

impl Funnel {
    fn open(from: [f64; 2]) -> Self {
        Self {
            from,
            lowest: f64::NEG_INFINITY,
            highest: f64::INFINITY,
        }
    }

    fn holds(&self, to: [f64; 2]) -> bool {
        let slope = (to[1] - self.from[1]) / (to[0] - self.from[0]);
        self.lowest <= slope && slope <= self.highest
    }

    fn narrow(&mut self, to: [f64; 2], tolerance: f64) {
        let (width, rise) = (to[0] - self.from[0], to[1] - self.from[1]);
        // A step is not continued by a line.
        if width == 0.0 {
            (self.lowest, self.highest) = (f64::INFINITY, f64::NEG_INFINITY);
        } else {
            self.lowest = self.lowest.max((rise - tolerance) / width);
            self.highest = self.highest.min((rise + tolerance) / width);
        }
    }
}
