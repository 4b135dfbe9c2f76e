//! The units in which results are shown. Values inside and in JSON are in SI.

use std::str::FromStr;
use std::sync::OnceLock;

use qcar_runtime::campaign::Declared;
use qcar_runtime::shown;
use serde_json::json;

/// Units of the choice `engineering`: one for each kind that engineers of ride comfort do not show in SI.
const ENGINEERING: [&str; 5] = ["N/mm", "N s/mm", "mm", "mm/s", "g"];

/// A unit for each kind of quantity that is not shown in SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Units(Vec<ShownUnit>);

/// A shown unit, and its value in SI.
#[derive(Clone, Debug, PartialEq)]
struct ShownUnit {
    name: String,
    declared: Declared,
}

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "si" => Ok(Units::default()),
            "engineering" => Units::of(ENGINEERING),
            list => Units::of(list.split(',')),
        }
    }
}

impl Units {
    fn of<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<Self, String> {
        let mut units = Units::default();
        for name in names.into_iter().map(str::trim) {
            let declared = Declared::of(name).ok_or_else(|| {
                format!("expected `si`, `engineering` or units such as N/mm,mm,g, found `{name}`; write each unit once")
            })?;
            if let Some(twice) = units.of_kind(&declared.coherent) {
                return Err(format!(
                    "`{name}` and `{}` are of the same kind; leave one of them out",
                    twice.name
                ));
            }
            units.0.push(ShownUnit {
                name: name.into(),
                declared,
            });
        }
        Ok(units)
    }

    fn of_kind(&self, si: &str) -> Option<&ShownUnit> {
        self.0.iter().find(|own| own.declared.is_like(si))
    }

    /// The shown unit for a unit of a measured file, and the latter.
    fn of_file(&self, unit: &str) -> Option<(&ShownUnit, Declared)> {
        let declared = Declared::of(unit)?;
        Some((self.of_kind(&declared.coherent)?, declared))
    }

    /// Script that passes these units to a page.
    fn script(&self) -> String {
        if self.0.is_empty() {
            return "view.units = 'si';".into();
        }
        let scale = |own: &ShownUnit| {
            (
                own.declared.coherent.clone(),
                json!([own.declared.shown(1.0), own.name]),
            )
        };
        let scales: serde_json::Map<_, _> = self.0.iter().map(scale).collect();
        let names: Vec<&str> = self.0.iter().map(|own| own.name.as_str()).collect();
        let system = json!({ "name": names.join(", "), "scales": scales });
        format!(
            "SYSTEMS.chosen = {};\nview.units = 'chosen';",
            system.to_string().replace('<', "\\u003c")
        )
    }

    /// The shown unit of a value in the unit `si`.
    pub fn name<'a>(&'a self, si: &'a str) -> &'a str {
        self.of_kind(si).map_or(si, |own| &own.name)
    }

    /// A value in the shown unit.
    pub fn value(&self, value: f64, si: &str) -> f64 {
        self.of_kind(si).map_or(value, |own| own.declared.shown(value))
    }
}

/// Choice of the user.
static CHOSEN: OnceLock<Units> = OnceLock::new();

/// Sets the units of all results and messages. The first choice of a process holds.
pub fn choose(units: Units) {
    let _ = CHOSEN.set(units);
    shown::convert_by(|value, si| {
        let own = CHOSEN.get()?.of_kind(si)?;
        Some((own.declared.shown(value), &own.name))
    });
}

/// The shown unit of a value in `si`: SI without a choice.
pub fn name(si: &str) -> &str {
    CHOSEN.get().map_or(si, |units| units.name(si))
}

/// A value in SI, converted to the shown unit.
pub fn value(value: f64, si: &str) -> f64 {
    CHOSEN.get().map_or(value, |units| units.value(value, si))
}

/// A unit of a measured file, or the unit of its kind that the user chose, and a value of the file in it.
pub fn of_file(value: f64, unit: &str) -> (f64, &str) {
    let chosen = CHOSEN.get().and_then(|units| units.of_file(unit));
    chosen.map_or((value, unit), |(own, file)| {
        (own.declared.shown(file.si(value)), &own.name)
    })
}

/// A text with its shown unit; a pure number has none.
pub fn with_unit(shown: &str, si: &str) -> String {
    match name(si) {
        "1" | "" => shown.into(),
        unit => format!("{shown} {unit}"),
    }
}

/// A script that opens a page in the chosen units; empty without a choice, so that the page uses its own.
pub fn script() -> String {
    CHOSEN.get().map_or(String::new(), Units::script)
}

/// A column heading with its shown unit in brackets; a pure number has none.
pub fn heading(what: &str, si: &str) -> String {
    match name(si) {
        "1" | "" => what.into(),
        unit => format!("{what} [{unit}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::Units;

    #[test]
    fn a_kind_is_shown_in_the_unit_that_was_chosen_for_it() {
        let units: Units = "N/mm, mm,g".parse().unwrap();
        assert_eq!((units.name("N/m"), units.value(25e3, "N/m")), ("N/mm", 25.0));
        assert_eq!((units.name("m/s^2"), units.value(9.80665, "m/s^2")), ("g", 1.0));
        assert_eq!((units.name("N s/m"), units.value(1500.0, "N s/m")), ("N s/m", 1500.0));
        assert_eq!(units.name("1"), "1");
        let engineering: Units = "engineering".parse().unwrap();
        assert_eq!(
            (engineering.name("N s/m"), engineering.value(1500.0, "N s/m")),
            ("N s/mm", 1.5)
        );
        assert_eq!("si".parse::<Units>(), Ok(Units::default()));
    }

    #[test]
    fn a_unit_is_known_and_its_kind_is_chosen_once() {
        for text in ["", "N/mmm", "mm,m", "si,mm"] {
            assert!(text.parse::<Units>().is_err(), "{text}");
        }
    }
}
