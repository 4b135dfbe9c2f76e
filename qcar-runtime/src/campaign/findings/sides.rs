//! Finds sensors that are wired or mounted wrongly, or have another unit than declared, by comparison with the other
//! side of the car: in a sweep both sides move nearly alike.

use super::super::contents::{Channel, Run, Side};
use super::super::finding::Finding;
use super::super::history::History;

/// Correlation above which two sensors count as equal or opposite.
const ALIKE: f64 = 0.5;
/// Difference of correlations above which a sensor counts as swapped with that of another place.
const CLEARLY: f64 = 0.1;
/// Ratios of units that may be confused: g to m/s², and m to mm or kN to N.
const MISTAKEN: [f64; 2] = [9.80665, 1000.0];
/// Relative tolerance of such a ratio: no axle is so asymmetric.
const UNEVEN: f64 = 0.25;

/// The left and the right sensor of a place.
struct Pair<'a> {
    left: (&'a Channel, &'a [f64]),
    right: (&'a Channel, &'a [f64]),
    correlation: f64,
}

/// Sensors of a sweep that move against the other side, that resemble another place there, or whose amplitude suggests
/// another unit.
pub(super) fn of_sides(run: &Run, history: &History) -> Vec<Finding> {
    let pairs = pairs(history);
    let duration = (history.len() - 1) as f64 / history.sample_rate;
    let finding = |pair: &Pair, what: String| Finding {
        run: run.name.clone(),
        channel: pair.left.0.name.clone(),
        span: (history.start, history.start + duration),
        what,
        fatal: false,
    };
    let mut found: Vec<Finding> = opposite(&pairs)
        .into_iter()
        .map(|pair| finding(pair, against(pair)))
        .collect();
    for (at, pair) in pairs.iter().enumerate() {
        let swapped = pairs[at + 1..].iter().filter(|other| are_swapped(pair, other));
        found.extend(swapped.map(|other| finding(pair, swapped_with(pair, other))));
        found.extend(in_other_units(pair).map(|what| finding(pair, what)));
    }
    found
}

fn pairs(history: &History) -> Vec<Pair<'_>> {
    let of = |side: Side| history.signals.iter().filter(move |(channel, _)| channel.side == side);
    let place = |channel: &Channel| (channel.location.clone(), channel.axis.clone(), channel.quantity);
    let pair = |left: &'_ (Channel, Vec<f64>)| {
        let right = of(Side::Right).find(|(right, _)| place(right) == place(&left.0))?;
        let left = history.signals.iter().find(|(own, _)| own.name == left.0.name)?;
        Some(Pair {
            correlation: correlation(&left.1, &right.1),
            left: (&left.0, left.1.as_slice()),
            right: (&right.0, right.1.as_slice()),
        })
    };
    of(Side::Left).filter_map(pair).collect()
}

/// Pairs whose sides move against each other while most other pairs move together.
fn opposite<'a, 'b>(pairs: &'b [Pair<'a>]) -> Vec<&'b Pair<'a>> {
    let together = pairs.iter().filter(|pair| pair.correlation > ALIKE).count();
    let against: Vec<&Pair> = pairs.iter().filter(|pair| pair.correlation < -ALIKE).collect();
    if against.len() < together { against } else { Vec::new() }
}

fn against(pair: &Pair) -> String {
    format!(
        "moves against `{}` (correlation {:.2}) while other sensors of both sides move together: `sign` of one of them is wrong",
        pair.right.0.name, pair.correlation
    )
}

fn are_swapped(a: &Pair, b: &Pair) -> bool {
    let same_kind = |a: &Channel, b: &Channel| (&a.axis, a.quantity) == (&b.axis, b.quantity);
    let crossed = |a: &Pair, b: &Pair| correlation(a.left.1, b.right.1).abs() > a.correlation.abs() + CLEARLY;
    same_kind(a.left.0, b.left.0) && crossed(a, b) && crossed(b, a)
}

fn swapped_with(a: &Pair, b: &Pair) -> String {
    let names = [a, b].map(|pair| (&pair.left.0.name, &pair.right.0.name));
    format!(
        "resembles `{}` more than `{}`, and `{}` the other way round: two sensors of one side seem to be swapped",
        names[1].1, names[0].1, names[1].0
    )
}

/// Message if both sides differ by the ratio of two units only.
fn in_other_units(pair: &Pair) -> Option<String> {
    let [left, right] =
        [pair.left.1, pair.right.1].map(|samples| about_line(samples).iter().map(|v| v * v).sum::<f64>());
    let ratio = (left / right).sqrt();
    let is_mistaken = |factor: &f64| (ratio.max(1.0 / ratio) / factor - 1.0).abs() < UNEVEN;
    (pair.correlation.abs() > ALIKE && MISTAKEN.iter().any(is_mistaken)).then(|| {
        format!(
            "is {ratio:.3} times as large as `{}`, which moves alike: `unit` or `scale` of one of them seems to be wrong",
            pair.right.0.name
        )
    })
}

/// Correlation of two signals without their linear trends, since an offset or a drift is no motion.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (about_line(a), about_line(b));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

fn about_line(samples: &[f64]) -> Vec<f64> {
    let count = samples.len() as f64;
    let place = |at: usize| at as f64 - (count - 1.0) / 2.0;
    let mean = samples.iter().sum::<f64>() / count;
    let (above, below) = samples
        .iter()
        .enumerate()
        .fold((0.0, 0.0), |(above, below), (at, sample)| {
            (above + place(at) * sample, below + place(at).powi(2))
        });
    let off = |(at, sample): (usize, &f64)| sample - mean - above / below * place(at);
    samples.iter().enumerate().map(off).collect()
}
