//! Channels from variables: structures from Testlab, captures from dSPACE, plain arrays, and structures of these.

use crate::error::{Fault, Place, Read};
use crate::find::Wanted;
use crate::signal::{Recording, Scalar, Signal, Source, TimeBase, Value as Single, evenly};
use crate::units::{in_seconds, is_time, seconds};

use super::value::{Array, Fields, Value, Variable};

/// The channels of a file.
pub(super) fn recording(format: &str, variables: Vec<Variable>, wanted: &Wanted) -> Read<Recording> {
    let mut recording = Recording::new(format);
    let mut arrays = Vec::new();
    for Variable { name, value, place } in variables {
        if value.at(&["y_values", "values"]).is_some() {
            testlab(&mut recording, &name, &value, &place, wanted).map_err(|fault| fault.of(&name))?;
        } else if value.at(&["X"]).is_some() && value.at(&["Y"]).is_some() {
            dspace(&mut recording, &name, value, &place, wanted).map_err(|fault| fault.of(&name))?;
        } else {
            match value {
                Value::Numbers(array) => match (array.len(), array.numbers.as_slice()) {
                    (1, &[number]) => recording.scalars.push(Scalar {
                        name,
                        unit: String::new(),
                        value: Single::Number(number),
                        place,
                    }),
                    (0, _) => recording.pass_over(name, place, "an empty array"),
                    _ => arrays.push((name, array, place)),
                },
                Value::Text(text) => recording.scalars.push(Scalar {
                    name,
                    unit: String::new(),
                    value: Single::Text(text),
                    place,
                }),
                Value::Structs(elements) => structure(&mut recording, &name, elements, &place, wanted)?,
                Value::Cells(_) => recording.pass_over(name, place, "a cell array"),
                Value::Other(what) => recording.pass_over(name, place, what),
            }
        }
    }
    plain(&mut recording, "", arrays, wanted)?;
    Ok(recording)
}

/// Arrays among the fields of a structure, beside one of times; `signals` of Simulink, each with `values` and a
/// `label`, are arrays as well. Structures in a structure are looked at in the same way.
fn structure(
    recording: &mut Recording,
    variable: &str,
    elements: Vec<Fields>,
    place: &Place,
    wanted: &Wanted,
) -> Read<()> {
    let mut arrays = Vec::new();
    let is_one = elements.len() == 1;
    let before = recording.signals.len();
    for (name, value) in elements.into_iter().flatten().filter(|_| is_one) {
        match value {
            Value::Numbers(array) if array.len() > 1 => arrays.push((name, array, place.clone())),
            Value::Structs(of_signals) if name == "signals" => arrays.extend(simulink(of_signals, place)),
            Value::Structs(inner) => structure(recording, &format!("{variable}.{name}"), inner, place, wanted)?,
            _ => {}
        }
    }
    if arrays.iter().any(|(name, array, _)| array.is_vector() && is_time(name)) {
        return plain(recording, variable, arrays, wanted);
    }
    if recording.signals.len() == before {
        let why = "a structure without a vector of times (`time` or `t`) among its fields";
        recording.pass_over(variable, place.clone(), why);
    }
    Ok(())
}

/// The arrays of Simulink's signals. One without a label is named by its number, from 1.
fn simulink(signals: Vec<Fields>, place: &Place) -> Vec<(String, Array, Place)> {
    let array = |(at, fields): (usize, Fields)| {
        let mut signal = Value::Structs(vec![fields]);
        let label = signal.text(&["label"]).filter(|label| !label.trim().is_empty());
        let name = label.map_or(format!("signals({})", at + 1), |label| label.trim().into());
        match signal.take("values") {
            Some(Value::Numbers(array)) if array.len() > 1 => Some((name, array, place.clone())),
            _ => None,
        }
    };
    signals.into_iter().enumerate().filter_map(array).collect()
}

fn missing(place: &Place, what: &str, expected: &str) -> Box<Fault> {
    let remedy = "export the variable again, or as a plain array beside one named `t`";
    Fault::new(place.clone(), format!("no {what}"), expected, remedy)
}

/// `x_values` with start, increment and unit, `y_values` with values, and `function_record` with a name. Values are
/// returned in the unit of the label: the stored value minus the offset, divided by the factor of the transformation.
fn testlab(recording: &mut Recording, variable: &str, value: &Value, place: &Place, wanted: &Wanted) -> Read<()> {
    let quantity = ["y_values", "quantity"];
    let transformation = |name: &str| value.number(&["y_values", "quantity", "unit_transformation", name]);
    let (factor, offset) = (
        transformation("factor").unwrap_or(1.0),
        transformation("offset").unwrap_or(0.0),
    );
    if !(factor.is_finite() && factor != 0.0 && offset.is_finite()) {
        let found = format!("a unit transformation with factor {factor} and offset {offset}");
        return Err(Fault::damaged(
            place.clone(),
            found,
            "finite numbers, the factor not zero",
        ));
    }
    let stored = value.numbers(&["y_values", "values"]);
    let stored = stored.ok_or_else(|| missing(place, "numbers in y_values.values", "an array of numbers"))?;
    let label = |path: &[&str]| value.text(&[path, &["label"]].concat()).unwrap_or("").to_string();
    let time_unit = label(&["x_values", "quantity"]);
    let name = value.text(&["function_record", "name"]).unwrap_or(variable).to_string();
    let Some(per_unit) = seconds(&time_unit) else {
        recording.pass_over(
            name,
            place.clone(),
            format!("a function over `{time_unit}`, not over time"),
        );
        return Ok(());
    };
    let along = |key: &str| value.number(&["x_values", key]);
    let step = along("increment").ok_or_else(|| missing(place, "x_values.increment", "the time step"))?;
    let stored = if wanted.has(variable, &name) { stored } else { &[] };
    let samples: Vec<f64> = stored.iter().map(|stored| (stored - offset) / factor).collect();
    recording.signals.push(Signal {
        name,
        unit: label(&quantity),
        time: evenly(
            along("start_value").unwrap_or(0.0) * per_unit,
            step * per_unit,
            place.clone(),
        )?,
        samples: samples.into(),
        labels: Vec::new(),
        source: Source {
            group: variable.into(),
            place: place.clone(),
        },
    });
    Ok(())
}

/// `X`, of which one element has the times, and `Y`, each element of which is a channel with `Name`, `Data` and `Unit`;
/// `XIndex` is the number of the element of `X`, from 1.
fn dspace(recording: &mut Recording, variable: &str, mut value: Value, place: &Place, wanted: &Wanted) -> Read<()> {
    let mut elements = |name: &str| value.take(name).map(Value::into_elements).unwrap_or_default();
    let times = elements("X")
        .iter()
        .map(|axis| dspace_times(axis, place))
        .collect::<Read<Vec<_>>>()?;
    for mut channel in elements("Y") {
        let name = channel.text(&["Name"]).unwrap_or(variable).to_string();
        let Some(Value::Numbers(Array { numbers: samples, .. })) = channel.take("Data") else {
            return Err(missing(place, "numbers in Y.Data", "samples").of(&name));
        };
        let index = channel
            .number(&["XIndex"])
            .map_or(0, |index| (index as usize).saturating_sub(1));
        let time = times.get(index).cloned().unwrap_or(TimeBase::Unknown);
        if let TimeBase::Times(times) = &time
            && times.len() != samples.len()
        {
            let found = format!("{} samples at {} times", samples.len(), times.len());
            return Err(Fault::damaged(place.clone(), found, "as many samples as times").of(&name));
        }
        let samples = if wanted.has(variable, &name) {
            samples
        } else {
            Vec::new()
        };
        recording.signals.push(Signal {
            name,
            unit: channel.text(&["Unit"]).unwrap_or("").into(),
            time,
            samples: samples.into(),
            labels: Vec::new(),
            source: Source {
                group: variable.into(),
                place: place.clone(),
            },
        });
    }
    Ok(())
}

fn dspace_times(axis: &Value, place: &Place) -> Read<TimeBase> {
    let factor = seconds(axis.text(&["Unit"]).unwrap_or(""));
    match (axis.numbers(&["Data"]), factor) {
        (Some(times), Some(factor)) => times_of(times, factor, "X.Data", place),
        _ => Ok(TimeBase::Unknown),
    }
}

fn times_of(times: &[f64], factor: f64, name: &str, place: &Place) -> Read<TimeBase> {
    let mut times = times.to_vec();
    in_seconds(&mut times, factor);
    TimeBase::from_times(times).map_err(|(at, found)| {
        let remedy = "correct it, or give the variable another name if it holds no times";
        Fault::new(
            place.clone(),
            format!("{found} in element {}", at + 1),
            "times that never decrease",
            remedy,
        )
        .of(name)
    })
}

/// Vectors and the columns of matrices. A vector with the name of a time channel is the time base of all channels of
/// its length. If it is as long as the rows of a matrix, the rows are channels.
fn plain(recording: &mut Recording, group: &str, arrays: Vec<(String, Array, Place)>, wanted: &Wanted) -> Read<()> {
    let mut bases: Vec<(usize, TimeBase)> = Vec::new();
    let mut channels = Vec::new();
    for (name, array, place) in arrays {
        let length = array.len();
        if array.is_vector() && is_time(&name) && bases.iter().all(|(known, _)| *known != length) {
            bases.push((length, times_of(&array.numbers, 1.0, &name, &place)?));
        } else {
            channels.push((name, array, place));
        }
    }
    let base = |length: usize| {
        bases
            .iter()
            .find(|(own, _)| *own == length)
            .map(|(_, base)| base.clone())
    };
    for (name, array, place) in channels {
        for (name, length, samples) in split(&name, array, &|length| base(length).is_some()) {
            let samples = if wanted.has(group, &name) { samples } else { Vec::new() };
            recording.signals.push(Signal {
                name,
                unit: String::new(),
                time: base(length).unwrap_or(TimeBase::Unknown),
                samples: samples.into(),
                labels: Vec::new(),
                source: Source {
                    group: group.into(),
                    place: place.clone(),
                },
            });
        }
    }
    Ok(())
}

/// The channels in an array: the array itself, or its columns or rows, each with its length. In an array of more
/// dimensions, all but the first dimension are columns. An array that was not read is not split.
fn split(name: &str, array: Array, is_timed: &dyn Fn(usize) -> bool) -> Vec<(String, usize, Vec<f64>)> {
    let rows = array.dimensions.first().map_or(1, |&rows| rows as usize).max(1);
    let columns = array.len() / rows;
    if array.is_vector() || array.numbers.is_empty() {
        vec![(name.into(), array.len(), array.numbers)]
    } else if is_timed(columns) && !is_timed(rows) {
        let row = |at: usize| array.numbers.iter().skip(at).step_by(rows).copied().collect();
        (0..rows)
            .map(|at| (format!("{name}[{at},:]"), columns, row(at)))
            .collect()
    } else {
        let columns = array.numbers.chunks_exact(rows).enumerate();
        columns
            .map(|(at, column)| (format!("{name}[:,{at}]"), rows, column.to_vec()))
            .collect()
    }
}
