//! The largest magnitude of a ratio over frequency, its frequency, and the derivatives of both.

use nalgebra::Complex;

use crate::model::{Model, Signal};
use crate::modes::{damping, dynamics, frequencies, frequency, vibrations};
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
/// Damping ratio below which a peak may lie between two lines, which are 1.4 % apart.
const NARROW: f64 = 0.01;
/// States up to which such modes are searched: the eigenvalues of more take longer than the response at all lines.
const MOST_STATES: usize = 60;
/// Distances from an undamped mode, relative to its frequency, at which a ratio is compared: if the ratio is infinite at
/// the mode, it is ten times as large at the second.
const BESIDE: [f64; 2] = [3e-5, 3e-6];
/// Number of lines in each refinement between the neighbours of the largest, and number of refinements.
const REFINED_LINES: usize = 9;
const REFINEMENTS: usize = 6;

/// The response over the whole band, and the modes whose peaks it may miss, from which the search for the peak of any
/// ratio under this excitation starts.
pub(crate) struct Survey<'m, M: ?Sized> {
    response: Response<'m, M>,
    narrow: Vec<NarrowMode>,
}

/// A mode with little damping.
#[derive(Clone, Copy)]
struct NarrowMode {
    /// Hz.
    frequency: f64,
    /// Its damping ratio.
    damping: f64,
}

/// The survey of a model at these values.
pub(crate) fn survey<'m, M: Model + ?Sized>(model: &'m M, values: &Values, excitation: usize) -> Survey<'m, M> {
    let mut response = Response::new(model, excitation, &spaced(BAND, LINES));
    response.evaluate_values(values.as_slice());
    let narrow = narrow_modes(model, values);
    Survey { response, narrow }
}

fn narrow_modes<M: Model + ?Sized>(model: &M, values: &Values) -> Vec<NarrowMode> {
    if model.about().states.len() > MOST_STATES {
        return Vec::new();
    }
    let modes = frequencies(model, values).into_iter();
    let modes = modes.map(|(frequency, damping)| NarrowMode { frequency, damping });
    let is_narrow =
        |own: &NarrowMode| (0.0..NARROW).contains(&own.damping) && (BAND[0]..BAND[1]).contains(&own.frequency);
    modes.filter(is_narrow).collect()
}

/// The peak of a ratio; `None` if the model cannot give one of its signals. It has derivatives only if they are
/// `wanted`.
pub(crate) fn highest<M: Model + ?Sized>(
    survey: &Survey<'_, M>,
    values: &Values,
    [numerator, denominator]: [&Signal; 2],
    wanted: bool,
) -> Option<Peak> {
    let Survey {
        response: whole,
        narrow,
    } = survey;
    let ratio = |frequency: &[f64], jacobian: bool| {
        let mut response = Response::new(whole.model, whole.excitation, frequency);
        if jacobian {
            response.evaluate(values.as_slice());
        } else {
            response.evaluate_values(values.as_slice());
        }
        between(&response, values, numerator, denominator).ok()
    };
    let at_lines = |frequency: &[f64]| Some(ratio(frequency, false)?.value);
    let is_infinite = |mode: &&NarrowMode| mode.damping == 0.0 && is_pole(mode.frequency, at_lines);
    if let Some(mode) = narrow.iter().find(is_infinite) {
        return Some(Peak::Infinite(mode.frequency));
    }
    let surveyed = between(whole, values, numerator, denominator).ok()?.value;
    let narrow = higher(narrow, &surveyed, at_lines);
    let band = narrow.map_or_else(
        || about_largest(&spaced(BAND, LINES), &surveyed),
        |mode| Some(mode.band()),
    )?;
    let at = position(band, at_lines)?;
    // Large enough for an accurate second derivative of the magnitude, and small enough that this is the one at the
    // peak.
    let step = narrow.map_or(3e-5, |mode| (0.05 * mode.damping).min(3e-5)) * at;
    let near = |at: f64, jacobian: bool| ratio(&[at - step, at, at + step], jacobian);
    let about = near(at, false)?;
    if let Some(frequency) = undamped(whole.model, values, &about, [at, step]) {
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

impl NarrowMode {
    /// Frequencies (Hz) around its peak.
    fn band(&self) -> [f64; 2] {
        [-4.0, 4.0].map(|widths| self.frequency * (1.0 + widths * self.damping))
    }
}

/// True if a ratio is infinite at the frequency of an undamped mode, and not only the motion of parts that it does not
/// contain.
fn is_pole(frequency: f64, ratio: impl Fn(&[f64]) -> Option<Vec<Complex<f64>>>) -> bool {
    let beside = BESIDE.map(|share| frequency * (1.0 + share));
    ratio(&beside).is_some_and(|near| near[1].norm() > 5.0 * near[0].norm())
}

/// The damped mode with the highest peak, if that is above all lines.
fn higher(
    narrow: &[NarrowMode],
    surveyed: &[Complex<f64>],
    ratio: impl Fn(&[f64]) -> Option<Vec<Complex<f64>>>,
) -> Option<NarrowMode> {
    let damped: Vec<NarrowMode> = narrow.iter().copied().filter(|mode| mode.damping > 0.0).collect();
    let frequency: Vec<f64> = damped.iter().map(|mode| mode.frequency).collect();
    let peaks = if damped.is_empty() {
        Vec::new()
    } else {
        ratio(&frequency)?
    };
    let largest = surveyed.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let peaks = peaks.into_iter().map(|value| value.norm()).zip(damped);
    let highest = peaks.max_by(|a, b| a.0.total_cmp(&b.0));
    highest.filter(|(height, _)| *height > largest).map(|(_, mode)| mode)
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

/// The frequency of the largest magnitude of a ratio within a band, to within the last refinement.
fn position(mut band: [f64; 2], ratio: impl Fn(&[f64]) -> Option<Vec<Complex<f64>>>) -> Option<f64> {
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
