//! New start values in `campaign.toml`; no other byte of it changes.

use std::ops::Range;

use qcar_runtime::campaign::{Campaign, Declared};
use qcar_runtime::error::{InputError, Place, Problem};
use toml::de::DeTable;

use super::Gradient;
use crate::files::{put, read_text};
use crate::parameters::quoted;

/// Replaces the value of each parameter of the campaign that a gradient determines.
pub(super) fn start_values(campaign: &Campaign, gradients: &[Gradient]) -> Result<(), InputError> {
    let file = campaign.manifest();
    let mut text = read_text(&file)?;
    let mut problems = Vec::new();
    for gradient in gradients.iter().filter(|gradient| gradient.start.is_some()) {
        let name = gradient.parameter.as_deref().unwrap_or_default();
        let exact = gradient.parameter_value.unwrap_or(gradient.value);
        let value: f64 = format!("{exact:.4e}").parse().unwrap_or(exact);
        let stated = value_of(&text, name);
        match campaign.parameter(name).and_then(|parameter| parameter.range) {
            Some((low, high)) if !(low..=high).contains(&value) => {
                let place = Place::Name(format!("parameters.{name}.range"));
                let unit = stated.as_ref().and_then(|(_, unit)| unit.as_ref());
                let [value, range] = [&[value][..], &[low, high]].map(|values| quoted(values, gradient.unit, unit));
                let expected = format!("a range that holds {value}, the gradient of the curve");
                let remedy = "widen the range, or check the curve";
                problems.push(Problem::new(&file, place, range, expected, remedy));
            }
            _ => match stated {
                Some((place, unit)) => {
                    let stated: f64 = format!("{:.4e}", unit.map_or(value, |unit| unit.shown(value)))
                        .parse()
                        .unwrap_or(value);
                    text.replace_range(place, &format!("{stated:?}"));
                }
                None => problems.push(in_the_workbook(campaign, name, value)),
            },
        }
    }
    InputError::unless_empty(problems, Some(()))?;
    put(&campaign.folder, "campaign.toml", &text)
}

/// Values in a workbook stay unchanged.
fn in_the_workbook(campaign: &Campaign, name: &str, value: f64) -> Problem {
    let unit = campaign.parameter(name).map_or("", |own| &own.unit);
    let value = quoted(&[value], unit, None);
    let remedy = format!("write {value} into its cell of the workbook, or add [parameters.{name}]");
    let expected = format!("[parameters.{name}], whose value can be replaced");
    let place = Place::Name(format!("parameters.{name}"));
    Problem::new(
        campaign.manifest(),
        place,
        "a parameter that its workbook states",
        expected,
        remedy,
    )
}

/// Position of a parameter value in the file, and its unit; `None` if the file does not state it.
fn value_of(text: &str, name: &str) -> Option<(Range<usize>, Option<Declared>)> {
    let table = DeTable::parse(text).expect("the campaign was read from this text");
    let parameter = table
        .get_ref()
        .get("parameters")
        .and_then(|parameters| parameters.get_ref().get(name));
    let own = |key| parameter.and_then(|parameter| parameter.get_ref().get(key));
    let unit = own("unit").and_then(|unit| Declared::of(unit.get_ref().as_str()?));
    own("value").map(|value| (value.span(), unit))
}
