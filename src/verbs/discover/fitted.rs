//! The parameters of a fit and the zero offsets of its sensors.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::fmt::Write;

use qcar_runtime::discover::posterior::Explanation;
use qcar_runtime::transmissibility::Point;
use serde::Serialize;

use crate::sensor_residuals::channel;
use crate::table::{Table, number, or_dash};
use crate::units;

/// Zero offset of the sensor of a record.
#[derive(Serialize)]
pub(super) struct Offset {
    channel: String,
    quantity: &'static str,
    offset: f64,
    stderr: Option<f64>,
    unit: &'static str,
}

/// Zero offsets of the sensors of records.
pub(super) fn offsets(of: &Explanation) -> Vec<Offset> {
    let offsets = of.refit.offsets().into_iter();
    let offset = |(sensor, offset, stderr): (Point, f64, f64)| Offset {
        channel: channel(&sensor),
        quantity: sensor.quantity.name(),
        offset,
        stderr: stderr.is_finite().then_some(stderr),
        unit: sensor.unit(),
    };
    offsets.map(offset).collect()
}

/// The parameters at a bound of their range, each with the name of the bound.
pub(super) fn at_bound(of: &Explanation) -> impl Iterator<Item = (String, &'static str)> {
    let free = of.refit.free.iter().zip(&of.refit.at_bound);
    free.filter_map(|(free, side)| {
        let name = of.named[free.parameter].0.clone();
        match side.cmp(&0) {
            Ordering::Less => Some((name, "lower")),
            Ordering::Equal => None,
            Ordering::Greater => Some((name, "upper")),
        }
    })
}

/// A parameter file for `--params`, with the zero offsets of the sensors as comments.
pub(super) fn parameters(heading: &str, of: &Explanation) -> String {
    let mut out = format!("# {heading}\n\n[parameters]\n");
    let ends: BTreeMap<String, &str> = at_bound(of).collect();
    for (name, value) in &of.named {
        let end = ends.get(name);
        let remark = end.map_or(String::new(), |end| format!(" # at the {end} end of its range"));
        let _ = writeln!(out, "{name} = {value:?}{remark}");
    }
    for own in offsets(of) {
        let error = own
            .stderr
            .map_or(String::new(), |error| format!(", standard error {error:.2e}"));
        let Offset {
            channel,
            quantity,
            offset,
            unit,
            ..
        } = own;
        let _ = writeln!(out, "# offset of {channel} {quantity}: {offset:.4e} {unit}{error}");
    }
    out
}

/// The zero offsets that exceed two standard errors as a table; `None` without any.
pub(super) fn offsets_table(of: &Explanation) -> Option<String> {
    let mut table = Table::new(["channel", "quantity", "unit", "offset", "stderr"]);
    let is_certain = |own: &Offset| own.stderr.is_none_or(|error| own.offset.abs() > 2.0 * error);
    let certain: Vec<Offset> = offsets(of).into_iter().filter(is_certain).collect();
    if certain.is_empty() {
        return None;
    }
    for own in certain {
        let shown = |value| units::value(value, own.unit);
        let numbers = [number(shown(own.offset), 4), or_dash(own.stderr.map(shown), 2)];
        let names = [own.channel, own.quantity.into(), units::name(own.unit).into()];
        table.row(names.into_iter().chain(numbers).collect());
    }
    Some(table.text())
}
