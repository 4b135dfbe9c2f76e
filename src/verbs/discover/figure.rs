//! The residuals over frequency before and after, in one panel for each sensor.

use qcar_runtime::discover::posterior::Misfit;
use qcar_runtime::transmissibility::Point;

use crate::figure::{Across, Curve, Figure, Panel, Style};

pub(super) fn residuals(title: String, [before, after]: [&Misfit; 2]) -> Figure {
    let mut sensors: Vec<&Point> = before.tiles.iter().map(|tile| &tile.sensor).collect();
    sensors.sort();
    sensors.dedup();
    let panel = |sensor: &Point| Panel {
        title: sensor.place(),
        vertical: "residual in sd, dB".into(),
        curves: vec![
            curve("before", Style::Before, before, sensor),
            curve("after", Style::After, after, sensor),
        ],
    };
    Figure {
        title,
        across: Across::Frequency,
        panels: sensors.into_iter().map(panel).collect(),
    }
}

/// Tiles of the first harmonics of all levels, by frequency.
fn curve(label: &'static str, style: Style, misfit: &Misfit, sensor: &Point) -> Curve {
    let of_sensor = misfit
        .tiles
        .iter()
        .filter(|tile| tile.sensor == *sensor && tile.kind.order() == Some(1));
    let mut points: Vec<(f64, f64)> = of_sensor
        .map(|tile| ((tile.span.0 * tile.span.1).sqrt(), 20.0 * tile.strength.log10()))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|later, earlier| {
        let same = later.0 == earlier.0;
        if same {
            earlier.1 = earlier.1.max(later.1);
        }
        same
    });
    Curve { label, style, points }
}
