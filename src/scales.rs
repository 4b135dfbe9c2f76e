//! Amplitudes of the parts of a model in a campaign, computed with the model without effects. The ranges of effects are
//! relative to them.
//!
//! A sweep counts with its measured amplitude, line by line; any other record with the RMS of its input. A record
//! without inputs counts as if a force at the mass of each sensor caused its signal. The amplitudes follow from the linear
//! response of the model about rest. A measured force of a link is used directly.

use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};

use qcar_dsl::check::Checked;
use qcar_dsl::compile::derive_wanted;
use qcar_dsl::evaluate::Evaluator;
use qcar_dsl::patch::{Scale, is_push, push, with_all_outputs};
use qcar_dsl::response::Wanted;
use qcar_runtime::campaign::{Quantity as Measured, Role};
use qcar_runtime::discover::Evidence;
use qcar_runtime::discover::observe::{Kind, Run, Series, Stimulus, signal_of};
use qcar_runtime::mean::deviation;
use qcar_runtime::model::{About, Excitation, Link, Model, Quantity, Signal, SignalKind};
use qcar_runtime::response::parameters::Values;
use qcar_runtime::response::ratio::Ratios;
use qcar_runtime::spectrum::transform;
use qcar_runtime::transmissibility::Point;

/// Frequencies at which a record is evaluated. Thirds of an octave are coarse for a resonance, but only the order of
/// magnitude matters.
const BANDS_PER_OCTAVE: f64 = 3.0;

/// Amplitude relative to the largest below which a band of a record without inputs is left out: it may be noise or drift,
/// which would be a large travel at low frequency. A choice; only the order of magnitude matters.
const SMALL: f64 = 0.1;

/// Excitation of a run, as amplitudes of a sensor at frequencies (Hz).
struct RunExcitation<'a> {
    reference: &'a Point,
    frequency: Vec<f64>,
    amplitude: Vec<f64>,
    /// True if the amplitudes act at once, false if one after the other.
    at_once: bool,
}

/// Largest amplitude of each part in the fitted runs, by the name of its reference value. Parts without motion are left
/// out, and so are all parts if the model lacks a value.
pub fn scales(model: &Checked, values: &BTreeMap<String, f64>, evidence: &Evidence) -> BTreeMap<String, f64> {
    let Ok(shown) = with_all_outputs(model) else {
        return BTreeMap::new();
    };
    let shown = Evaluator::new(&derive_wanted(shown, Wanted::Values));
    let Ok(values) = Values::resolve(shown.about(), &BTreeMap::new(), values) else {
        return BTreeMap::new();
    };
    let mut found = BTreeMap::new();
    let fitted = evidence.runs.iter().filter(|run| run.role == Role::Fit);
    let mut ratios = Ratios::new(&shown, &values);
    for driven in fitted.flat_map(driven) {
        if let Some(excitation) = excitation(shown.about(), driven.reference) {
            raise_all(&mut found, &mut ratios, excitation, &driven);
        }
    }
    for free in free(evidence) {
        if let Some(excitation) = pushed(shown.about(), free.reference) {
            raise_all(&mut found, &mut ratios, excitation, &free);
        }
    }
    found.extend(measured(shown.about(), evidence));
    found
}

/// The amplitudes of all parts under an excitation.
fn raise_all(
    found: &mut BTreeMap<String, f64>,
    ratios: &mut Ratios<'_, Evaluator>,
    excitation: usize,
    driven: &RunExcitation<'_>,
) {
    for signal in parts(ratios.about()) {
        for (name, amplitude) in amplitudes(ratios, excitation, driven, &signal) {
            raise(found, name, amplitude);
        }
    }
}

/// Keeps the larger of two amplitudes.
fn raise(found: &mut BTreeMap<String, f64>, name: String, amplitude: f64) {
    if amplitude.is_finite() && amplitude > 0.0 {
        let known = found.entry(name).or_insert(amplitude);
        *known = known.max(amplitude);
    }
}

fn driven(run: &Run) -> Vec<RunExcitation<'_>> {
    match &run.stimulus {
        Stimulus::Sweep {
            reference,
            frequency,
            amplitude,
            ..
        } => vec![RunExcitation {
            reference,
            frequency: frequency.clone(),
            amplitude: amplitude.clone(),
            at_once: false,
        }],
        Stimulus::History { inputs, rate, .. } => {
            let signals = inputs.signals.iter();
            signals
                .map(|(point, samples)| recorded(point, samples, *rate))
                .collect()
        }
        Stimulus::Cleat(_) | Stimulus::Travel { .. } | Stimulus::Sine { .. } | Stimulus::Dynamometer { .. } => vec![],
    }
}

/// Signals of the fitted records without inputs.
fn free(evidence: &Evidence) -> impl Iterator<Item = RunExcitation<'_>> {
    let free = |series: &Series| match &evidence.runs[series.run].stimulus {
        Stimulus::History { inputs, rate, .. } => inputs.signals.is_empty().then_some(*rate),
        _ => None,
    };
    evidence.of_role(Role::Fit).filter_map(move |(_, series)| {
        let rate = free(series)?;
        let samples: Vec<f64> = series.value.iter().map(|value| value.re).collect();
        let mut signal = recorded(&series.sensor, &samples, rate);
        let largest = signal.amplitude.iter().copied().fold(0.0, f64::max);
        let amplitudes = signal.amplitude.iter_mut();
        amplitudes
            .filter(|own| **own < SMALL * largest)
            .for_each(|own| *own = 0.0);
        Some(signal)
    })
}

/// Amplitude of a record in each frequency band.
fn recorded<'a>(reference: &'a Point, samples: &[f64], rate: f64) -> RunExcitation<'a> {
    let lines = transform(samples);
    let (length, spacing) = (samples.len() as f64, rate / samples.len() as f64);
    let mut bands: BTreeMap<i64, f64> = BTreeMap::new();
    for (k, line) in lines.iter().enumerate().skip(1) {
        let band = ((k as f64 * spacing).log2() * BANDS_PER_OCTAVE).round() as i64;
        *bands.entry(band).or_default() += (2.0 * line.norm() / length).powi(2);
    }
    RunExcitation {
        reference,
        frequency: bands
            .keys()
            .map(|band| (*band as f64 / BANDS_PER_OCTAVE).exp2())
            .collect(),
        amplitude: bands.values().map(|square| square.sqrt()).collect(),
        at_once: true,
    }
}

/// Every signal of a part with reference values.
fn parts(about: &About) -> Vec<Signal> {
    let shown = about.outputs.iter().map(|output| output.signal.clone());
    let mut parts: Vec<Signal> = Vec::new();
    for signal in shown {
        let counts = matches!(
            signal.kind,
            SignalKind::Force | SignalKind::Stretch | SignalKind::Motion(Quantity::Acceleration)
        );
        if counts && !parts.contains(&signal) {
            parts.push(signal);
        }
    }
    parts
}

/// Reference values of a signal, differentiated or integrated as needed.
fn orders(kind: SignalKind) -> &'static [(Scale, i32)] {
    match kind {
        SignalKind::Force => &[(Scale::Force, 0)],
        SignalKind::Stretch => &[(Scale::Travel, 0), (Scale::Speed, 1)],
        SignalKind::Motion(_) => &[(Scale::Travel, -2), (Scale::Speed, -1), (Scale::Acceleration, 0)],
    }
}

fn amplitudes(
    ratios: &mut Ratios<'_, Evaluator>,
    excitation: usize,
    driven: &RunExcitation,
    signal: &Signal,
) -> Vec<(String, f64)> {
    let below = signal_of(ratios.about(), driven.reference);
    let Ok(ratio) = ratios.ratio(excitation, [signal, &below], &driven.frequency) else {
        return vec![];
    };
    let lines = ratio.value.iter().zip(&driven.amplitude).zip(&driven.frequency);
    let lines: Vec<(f64, f64)> = lines.map(|((h, a), f)| (h.norm() * a, TAU * f)).collect();
    let of_order = |&(scale, order): &(Scale, i32)| {
        let all = lines.iter().map(|(amplitude, omega)| amplitude * omega.powi(order));
        let all = all.filter(|amplitude| amplitude.is_finite());
        let whole = if driven.at_once {
            all.map(|amplitude| amplitude * amplitude).sum::<f64>().sqrt()
        } else {
            all.fold(0.0, f64::max)
        };
        (scale.name(&signal.axis, &signal.location), whole)
    };
    orders(signal.kind).iter().map(of_order).collect()
}

/// The input that a sensor measures: that at its own place, or the only one along its axis.
fn excitation(about: &About, reference: &Point) -> Option<usize> {
    let along = |own: &Excitation| own.axis == reference.axis.name() && !is_push(&own.name);
    let own = about
        .excitations
        .iter()
        .position(|own| along(own) && own.name == reference.location);
    let mut others = about.excitations.iter().enumerate().filter(|(_, own)| along(own));
    own.or_else(|| {
        others
            .next()
            .filter(|_| others.next().is_none())
            .map(|(place, _)| place)
    })
}

/// The force input at the mass where a sensor is, or at the only mass along its axis.
fn pushed(about: &About, sensor: &Point) -> Option<usize> {
    let (axis, inputs) = (sensor.axis.name(), about.excitations.iter().enumerate());
    let own = push(axis, &sensor.location);
    let mut along = inputs.filter(|(_, input)| input.axis == axis && is_push(&input.name));
    let first = along.clone().find(|(_, input)| input.name == own);
    let only = || along.next().filter(|_| along.next().is_none());
    first.or_else(only).map(|(place, _)| place)
}

/// Measured forces and stretches of links in records. The linear response can be far from them: near a resonance that a
/// stiffening spring or friction limits, the travel is smaller.
fn measured(about: &About, evidence: &Evidence) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    for (_, series) in evidence.of_role(Role::Fit).filter(|(_, own)| own.kind == Kind::Time) {
        let Point {
            location,
            axis,
            quantity,
            ..
        } = &series.sensor;
        let is_it = |link: &&Link| link.name == *location && link.axis == axis.name();
        let scale = match quantity {
            Measured::Force => Scale::Force,
            Measured::Displacement => Scale::Travel,
            Measured::Velocity => Scale::Speed,
            Measured::Acceleration => continue,
        };
        if about.links.iter().any(|link| is_it(&link)) {
            let samples: Vec<f64> = series.value.iter().map(|value| value.re).collect();
            let amplitude = SQRT_2 * deviation(&samples);
            raise(&mut found, scale.name(axis.name(), location), amplitude);
        }
    }
    found
}
