//! A sweep or time history, measured and simulated, with a panel for each sensor.

use super::records::Record;
use crate::figure::{Across, Curve, Figure, Panel, Style};
use crate::units;

/// Number of parts of a record; of each, the lowest and the highest value are drawn.
const PARTS: usize = 800;

pub(super) fn record(of: &Record) -> Figure {
    let panels = of.signals.iter().zip(&of.errors).map(|((_, signals), error)| {
        let [measured, simulated] = signals;
        Panel {
            title: error.channel.clone(),
            vertical: format!(
                "{}, {} ({:.1} % NRMS)",
                error.quantity,
                units::name(error.unit),
                100.0 * error.nrms
            ),
            curves: vec![
                curve("measured", Style::Measured, (measured, error.unit), of),
                curve("simulated", Style::After, (simulated, error.unit), of),
            ],
        }
    });
    Figure {
        title: of.run.clone(),
        across: Across::Time,
        panels: panels.collect(),
    }
}

fn curve(label: &'static str, style: Style, (samples, si): (&[f64], &str), of: &Record) -> Curve {
    let length = samples.len().div_ceil(PARTS).max(1);
    let time = |sample: usize| of.start + sample as f64 / of.rate;
    let ends = |(part, samples): (usize, &[f64])| {
        let by_size = |a: &(usize, &f64), b: &(usize, &f64)| a.1.total_cmp(b.1);
        let lowest = samples.iter().enumerate().min_by(by_size);
        let highest = samples.iter().enumerate().max_by(by_size);
        let mut ends: Vec<(usize, f64)> = lowest.into_iter().chain(highest).map(|(k, y)| (k, *y)).collect();
        ends.sort_by_key(|(k, _)| *k);
        ends.dedup();
        ends.into_iter()
            .map(move |(k, y)| (time(part * length + k), units::value(y, si)))
    };
    let points = samples.chunks(length).enumerate().flat_map(ends).collect();
    Curve { label, style, points }
}
