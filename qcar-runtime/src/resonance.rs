//! The largest magnitude of a ratio over frequency, its frequency, and the derivatives of both.

use nalgebra::Complex;

use crate::model::{Model, Signal};
use crate::modes::{damping, dynamics, frequency, vibrations};
use crate::response::Response;
use crate::response::parameters::Values;
use crate::response::ratio::{Ratio, between};

/// The highest peak of a ratio.
pub(crate) enum Peak {
    /// A peak that has a height.
    Finite(Resonance),
    /// The resonance of an undamped mode, whose height is infinite; its frequency, Hz.
    Infinite(f64),
}

/// A peak, `[magnitude, frequency in Hz]`, and the derivatives of both by the leading parameters, with the positions of
/// these.
pub(crate) struct Resonance {
    pub value: [f64; 2],
    pub slopes: Vec<(usize, [f64; 2])>,
}

/// Band in which peaks are searched, Hz: that of body and wheel modes.
const BAND: [f64; 2] = [0.5, 50.0];
/// Number of lines in the band: closer than the width of a peak with a damping ratio of 0.01.
const LINES: usize = 340;
/// Number of lines in each refinement between the neighbours of the largest, and number of refinements.
const REFINED_LINES: usize = 9;
const REFINEMENTS: usize = 6;

/// The response over the whole band, from which the search for the peak of any ratio under this excitation starts.
pub(crate) fn survey<'m, M: Model + ?Sized>(model: &'m M, values: &Values, excitation: usize) -> Response<'m, M> {
    let mut response = Response::new(model, excitation, &spaced(BAND, LINES));
    response.evaluate_values(values.as_slice());
    response
}

/// The peak of a ratio; `None` if the model cannot give one of its signals. It has derivatives only if they are
/// `wanted`.
pub(crate) fn highest<M: Model + ?Sized>(
    survey: &Response<'_, M>,
    values: &Values,
    [numerator, denominator]: [&Signal; 2],
    wanted: bool,
) -> Option<Peak> {
    let ratio = |frequency: &[f64], jacobian: bool| {
        let mut response = Response::new(survey.model, survey.excitation, frequency);
        if jacobian {
            response.evaluate(values.as_slice());
        } else {
            response.evaluate_values(values.as_slice());
        }
        between(&response, values, numerator, denominator).ok()
    };
    let surveyed = between(survey, values, numerator, denominator).ok()?.value;
    let at = position(&surveyed, |frequency| Some(ratio(frequency, false)?.value))?;
    // Large enough for an accurate second derivative of the magnitude, and small enough that this is the one at the
    // peak.
    let step = 3e-5 * at;
    let near = |at: f64, jacobian: bool| ratio(&[at - step, at, at + step], jacobian);
    let about = near(at, false)?;
    if let Some(frequency) = undamped(survey.model, values, &about, [at, step]) {
        return Some(Peak::Infinite(frequency));
    }
    let [rise, bend] = shape(&about, step);
    let is_inside = at > BAND[0] * 1.001 && at < BAND[1] / 1.001 && bend < 0.0;
    // Near the peak, magnitudes agree to rounding long before the frequency is accurate, so the last steps search for
    // the root of the derivative.
    let at = if is_inside { at - rise / bend } else { at };
    let near = near(at, wanted)?;
    let [_, bend] = shape(&near, step);
    let size: Vec<f64> = near.value.iter().map(|value| value.norm()).collect();
    let slope = |slopes: &[Complex<f64>]| {
        let by = |line: usize| (near.value[line].conj() * slopes[line]).re / size[line];
        let shift = if is_inside {
            -(by(2) - by(0)) / (2.0 * step) / bend
        } else {
            0.0
        };
        [by(1), shift]
    };
    let slopes = near.jacobian.iter();
    Some(Peak::Finite(Resonance {
        value: [size[1], at],
        slopes: slopes.map(|(parameter, slopes)| (*parameter, slope(slopes))).collect(),
    }))
}

/// The frequency of the undamped mode whose resonance is a peak, Hz, given the ratio at the peak and a step to both
/// sides of it; `None` if damping limits its height.
fn undamped<M: Model + ?Sized>(model: &M, values: &Values, about: &Ratio, [at, step]: [f64; 2]) -> Option<f64> {
    let [left, middle, right] = [0, 1, 2].map(|line| about.value[line].norm());
    // The search came closer to the peak than a step. One that is not much higher than its sides is broad by damping,
    // and the eigenvalues need not be computed.
    if middle < 2.0 * left.max(right) {
        return None;
    }
    let frequencies = vibrations(&dynamics(model, values.as_slice())).into_iter();
    let mut undamped = frequencies.filter(|root| damping(*root) == 0.0).map(frequency);
    undamped.find(|own| (own - at).abs() < step)
}

/// The frequency of the largest magnitude of a ratio, given over the whole band, to within the last refinement.
fn position(surveyed: &[Complex<f64>], ratio: impl Fn(&[f64]) -> Option<Vec<Complex<f64>>>) -> Option<f64> {
    let mut band = about_largest(&spaced(BAND, LINES), surveyed)?;
    for _ in 0..REFINEMENTS {
        let frequency = spaced(band, REFINED_LINES);
        band = about_largest(&frequency, &ratio(&frequency)?)?;
    }
    Some((band[0] * band[1]).sqrt())
}

/// First and second derivative of the magnitude at the middle of three frequencies, `step` apart.
fn shape(near: &Ratio, step: f64) -> [f64; 2] {
    let [left, middle, right] = [0, 1, 2].map(|line| near.value[line].norm());
    [
        (right - left) / (2.0 * step),
        (left - 2.0 * middle + right) / (step * step),
    ]
}

/// The frequencies on both sides of the largest magnitude.
fn about_largest(frequency: &[f64], value: &[Complex<f64>]) -> Option<[f64; 2]> {
    let largest = value.iter().map(|value| value.norm()).enumerate();
    let (at, _) = largest.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some([
        frequency[at.saturating_sub(1)],
        frequency[(at + 1).min(frequency.len() - 1)],
    ])
}

fn spaced([from, to]: [f64; 2], lines: usize) -> Vec<f64> {
    let ratio = (to / from).powf(1.0 / (lines - 1) as f64);
    (0..lines).map(|line| from * ratio.powi(line as i32)).collect()
}
