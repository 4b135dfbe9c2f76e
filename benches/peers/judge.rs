//! Differences of the results of other programs from those of qcar, each relative to the largest result for the same
//! parameter and the same output.

use std::collections::BTreeMap;

use qcar_runtime::model::Matrix;

use crate::child::Peer;
use crate::subject::{MODEL, Subject};

/// Largest allowed difference: far larger than rounding, far smaller than a wrong term.
const WRONG: f64 = 1e-6;

/// Results by name, each with its scale.
type Results = BTreeMap<String, (f64, f64)>;

/// The largest difference, as text.
///
/// # Panics
/// If it is larger than rounding explains: then the other program does not do the same work.
pub fn difference(task: &str, peer: &Peer) -> String {
    let want = match task {
        "matrices" => matrices(),
        "response" => response(),
        _ => parameters(),
    };
    let got = found(task, peer.shown(task));
    let compared = |(key, (value, scale)): (&String, &(f64, f64))| {
        let own = got.get(key).copied().unwrap_or_default();
        (own - value).abs() / scale
    };
    let largest = want.iter().map(compared).fold(0.0, f64::max);
    assert!(largest < WRONG, "{} differs by {largest:e} in {task}", peer.name);
    // A result that qcar leaves out is zero, relative to others for the same parameter.
    let scale = |key: &str| {
        want.iter()
            .find(|(own, _)| parameter(own) == parameter(key))
            .map_or(1.0, |own| own.1.1)
    };
    let others = got.iter().filter(|(key, _)| !want.contains_key(*key));
    for (key, value) in others {
        assert!(value.abs() < WRONG * scale(key), "{}: {key} is {value:e}", peer.name);
    }
    format!("{largest:.0e}")
}

/// The third word of the name of a result: the parameter of the derivative.
fn parameter(key: &str) -> Option<&str> {
    key.split(' ').nth(2)
}

/// The results of the other program; contributions to one entry are summed.
fn found(task: &str, lines: Vec<Vec<String>>) -> BTreeMap<String, f64> {
    let numbers = if task == "response" { 2 } else { 1 };
    let mut found = BTreeMap::new();
    for line in lines {
        let (key, values) = line.split_at(line.len() - numbers);
        for (part, value) in values.iter().enumerate() {
            let value: f64 = value.parse().expect("a number");
            *found.entry(format!("{} {part}", key.join(" "))).or_default() += value;
        }
    }
    found
}

/// Rows of accelerations of A and B, side by side, with their Jacobians.
fn matrices() -> Results {
    let (mut subject, about) = (Subject::new(MODEL), MODEL.about());
    subject.linearise();
    let masses = about.states.len() / 2;
    let place = |entry: &qcar_runtime::model::Entry| match entry.matrix {
        Matrix::A => Some((entry.row, entry.column)),
        Matrix::B => Some((entry.row, entry.column + about.states.len() as u16)),
        Matrix::C | Matrix::D => None,
    };
    let key = |entry, parameter: &str| {
        let (row, column) = place(entry)?;
        let row = usize::from(row).checked_sub(masses)?;
        Some(format!("{row} {column} {parameter} 0"))
    };
    let values = about.matrices.iter().zip(&subject.matrices);
    let values = values.filter_map(|(entry, &value)| Some((key(entry, "-")?, value)));
    let slopes = about.sensitivities.iter().zip(&subject.sensitivities);
    let slopes = slopes.filter_map(|((entry, parameter), &value)| {
        let name = &about.parameters[usize::from(*parameter)].name;
        Some((key(entry, name)?, value))
    });
    values
        .chain(slopes)
        .map(|(key, value)| (key, (value, value.abs().max(1e-9))))
        .collect()
}

/// Three of the lines: each relative to the largest of its row.
fn response() -> Results {
    let (mut subject, about) = (Subject::new(MODEL), MODEL.about());
    subject.respond();
    let (layout, lines) = (&about.responses[0], subject.omega.len());
    let values = layout
        .outputs
        .iter()
        .enumerate()
        .map(|(row, output)| (0, row, format!("{output} LINE -")));
    let slopes = layout.jacobian.iter().enumerate().map(|(row, (output, parameter))| {
        let name = &about.parameters[usize::from(*parameter)].name;
        (2, row, format!("{} LINE {name}", layout.outputs[usize::from(*output)]))
    });
    let mut results = Results::new();
    for (first, row, key) in values.chain(slopes) {
        let rows = [0, 1].map(|part| &subject.response[first + part][row * lines..][..lines]);
        let scale = rows
            .iter()
            .copied()
            .flatten()
            .fold(1e-300, |largest: f64, value| largest.max(value.abs()));
        for line in [0, 137, 299] {
            for (part, row) in rows.iter().enumerate() {
                let key = key.replace("LINE", &line.to_string());
                results.insert(format!("{key} {part}"), (row[line], scale));
            }
        }
    }
    results
}

/// The fitted parameters.
fn parameters() -> Results {
    let known = MODEL.about().parameters.iter().zip(Subject::new(MODEL).p);
    let free = known.filter(|(about, _)| !about.known);
    free.map(|(about, value)| (format!("{} 0", about.name), (value, value)))
        .collect()
}
