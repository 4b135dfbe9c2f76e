//! The channel of a measured file that is a sensor, and its conversion to SI.

use super::contents::{ChannelMapping, Quantity, Trigger, Window};
use super::fields::Section;
use super::unit::{self, examples, says_its_angle};
use qcar_signals::si::{Si, in_si};

/// Duration at the beginning of a recording whose mean `zero = "start"` subtracts, s.
const ZERO_SPAN: f64 = 1.0;

/// Keys of the source of values; a channel with one of them has a mapping.
const MAPPED: [&str; 5] = ["source", "scale", "offset", "sign", "zero"];

/// The mapping of a channel, and true if the section has keys that a plain table does not need.
///
/// `si` is the unit of the result. A channel without such keys has it as its `unit`, and its own name as source.
pub(super) fn mapping(section: &Section<'_>, name: &str, si: Option<&'static str>) -> Option<(ChannelMapping, bool)> {
    let mapped = MAPPED.iter().any(|key| section.has(key));
    let source = section.optional_text("source");
    let (scale, offset) = (section.optional_number("scale"), section.optional_number("offset"));
    let (sign, zero) = (sign(section), zero(section));
    let unit = match mapped {
        true => section.optional_text("unit"),
        false => Some(section.text("unit")?),
    };
    if let (Some(si), Some(unit)) = (si, &unit) {
        check_unit(section, name, unit, si, mapped);
    }
    let mapping = ChannelMapping {
        name: name.into(),
        source: source.unwrap_or_else(|| name.into()),
        unit,
        si: si?,
        scale,
        offset: offset.unwrap_or(0.0),
        sign: sign?,
        zero: zero?,
        shared: false,
    };
    Some((mapping, mapped))
}

fn check_unit(section: &Section<'_>, name: &str, unit: &str, si: &'static str, mapped: bool) {
    if mapped && !(of_quantity(in_si(unit), si) && says_its_angle(unit, si)) {
        let remedy = "give the unit of the values after `scale` and `offset`";
        section.wrong("unit", format!("\"{unit}\""), examples(si), remedy);
    }
    if !mapped && unit::dimension(unit) != unit::dimension(si) {
        // Only the header line of a table may state another unit of the same kind.
        let stated = if of_quantity(in_si(unit), si) {
            format!(" or state its unit in the header line, as in `{name} [{unit}]`,")
        } else {
            String::new()
        };
        let remedy = format!("convert the column `{name}` in every file,{stated} and write this unit");
        section.wrong("unit", format!("\"{unit}\""), format!("\"{si}\""), remedy);
    }
}

/// True if a unit is one of the quantity with the SI unit `si`.
pub(super) fn of_quantity(unit: Option<Si>, si: &str) -> bool {
    unit.map(|unit| unit.dimension) == unit::dimension(si)
}

fn sign(section: &Section<'_>) -> Option<f64> {
    match section.optional_number("sign") {
        None => Some(1.0),
        Some(sign) if sign.abs() == 1.0 => Some(sign),
        Some(other) => {
            section.wrong(
                "sign",
                format!("{other}"),
                "1 or -1",
                "for any other factor use `scale`",
            );
            None
        }
    }
}

/// Duration at the beginning that gives the zero, s; `None` without one.
fn zero(section: &Section<'_>) -> Option<Option<f64>> {
    let span = section.has("zero_span").then(|| section.positive("zero_span", "s"));
    if !section.has("zero") {
        if span.is_some() {
            section.wrong(
                "zero_span",
                "no `zero`",
                "`zero = \"start\"` beside it",
                "add it, or remove `zero_span`",
            );
        }
        return Some(None);
    }
    section.choice("zero", &[("start", ())])?;
    Some(Some(span.unwrap_or(Some(ZERO_SPAN))?))
}

/// The mapping of each column of a curve that the run maps, and true if there is one.
pub(super) fn columns(section: &Section<'_>, columns: &[&'static str]) -> Option<(Vec<ChannelMapping>, bool)> {
    let (mut mappings, mut any) = (Vec::new(), false);
    for &column in columns.iter().filter(|column| **column != "time") {
        let si = match column {
            "displacement" => Quantity::Displacement.unit(),
            "velocity" => Quantity::Velocity.unit(),
            _ => Quantity::Force.unit(),
        };
        mappings.push(match section.section(column) {
            Some(own) => {
                any = true;
                let mapping = mapped_column(&own, column, si);
                own.finish();
                mapping
            }
            None => Some(ChannelMapping::plain(column, si)),
        });
    }
    Some((mappings.into_iter().collect::<Option<_>>()?, any))
}

fn mapped_column(section: &Section<'_>, column: &str, si: &'static str) -> Option<ChannelMapping> {
    section.text("source")?;
    mapping(section, column, Some(si)).map(|(mapping, _)| mapping)
}

impl ChannelMapping {
    /// Values in SI under the column's own name.
    pub(super) fn plain(name: &str, si: &'static str) -> ChannelMapping {
        ChannelMapping {
            name: name.into(),
            source: name.into(),
            unit: Some(si.into()),
            si,
            scale: None,
            offset: 0.0,
            sign: 1.0,
            zero: None,
            shared: false,
        }
    }
}

/// The part of a recording that is a run.
pub(super) fn window(section: &Section<'_>) -> Option<Window> {
    let (from, to) = (
        section.optional_quantity("from", "s"),
        section.optional_quantity("to", "s"),
    );
    let trigger = match section.section("trigger") {
        Some(section) => Some(trigger(&section)?),
        None => None,
    };
    if let (Some(from), Some(to)) = (from, to)
        && from >= to
    {
        let expected = format!("above `from = {}`", section.written("from"));
        section.wrong(
            "to",
            section.written("to"),
            expected,
            "correct the two times: the window is empty",
        );
        return None;
    }
    Some(Window { from, to, trigger })
}

fn trigger(section: &Section<'_>) -> Option<Trigger> {
    let (channel, above) = (section.text("channel"), section.number("above"));
    section.finish();
    Some(Trigger {
        channel: channel?,
        above: above?,
    })
}
