//! The units in which results are shown. Values inside and in JSON are in SI.

use std::borrow::Cow;
use std::str::FromStr;
use std::sync::OnceLock;

use qcar_runtime::campaign::{Declared, dimension};
use qcar_runtime::shown;
use serde_json::json;

/// Units of the choice `engineering`: one for each kind that engineers of ride comfort do not show in SI.
const ENGINEERING: [&str; 5] = ["N/mm", "N s/mm", "mm", "mm/s", "g"];
/// Units of measured signals.
const SIGNALS: [&str; 8] = ["m", "m/s", "m/s^2", "rad", "rad/s", "rad/s^2", "N", "N m"];
/// Ratios of signals that are kinds of their own, so that `mm` does not choose N/mm: stiffness and damping.
const KINDS: [&str; 2] = ["N/m", "N s/m"];

/// A unit for each kind of quantity that is not shown in SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Units(Vec<ShownUnit>);

/// A shown unit, and its value in SI.
#[derive(Clone, Debug, PartialEq)]
struct ShownUnit {
    name: String,
    declared: Declared,
    /// The coherent unit; of an angle, `rad` or one of its rates.
    si: String,
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
            let si = coherent(&declared);
            if let Some(twice) = units.of_kind(&si) {
                return Err(format!(
                    "`{name}` and `{}` are of the same kind; leave one of them out",
                    twice.name
                ));
            }
            units.0.push(ShownUnit {
                name: name.into(),
                declared,
                si,
            });
        }
        Ok(units)
    }

    fn of_kind(&self, si: &str) -> Option<&ShownUnit> {
        // The radian is 1, but no other number without dimension is an angle.
        let is_like = |own: &&ShownUnit| own.declared.is_like(si) && counts_angles(&own.si) == counts_angles(si);
        self.0.iter().find(is_like)
    }

    /// The shown units of numerator and denominator, if a unit is the ratio of two signals, such as `(m/s^2)/N`, and
    /// none is chosen for its own kind.
    fn of_ratio<'a>(&'a self, si: &'a str) -> Option<[Part<'a>; 2]> {
        let is_kind = KINDS.iter().any(|kind| dimension(kind) == dimension(si));
        let (above, below) = parts(si).filter(|_| !is_kind)?;
        if ![above, below].iter().all(|part| SIGNALS.contains(part)) {
            return None;
        }
        let part = |si| Part {
            si,
            shown: self.of_kind(si),
        };
        let both = [part(above), part(below)];
        both.iter().any(|own| own.shown.is_some()).then_some(both)
    }

    /// The shown unit for a unit of a measured file, and the latter.
    fn of_file(&self, unit: &str) -> Option<(&ShownUnit, Declared)> {
        let declared = Declared::of(unit)?;
        Some((self.of_kind(&coherent(&declared))?, declared))
    }

    /// Script that passes these units to a page.
    fn script(&self) -> String {
        if self.0.is_empty() {
            return "view.units = 'si';".into();
        }
        let scale = |own: &ShownUnit| (own.si.clone(), json!([own.declared.shown(1.0), own.name]));
        let scales: serde_json::Map<_, _> = self.0.iter().map(scale).collect();
        let names: Vec<&str> = self.0.iter().map(|own| own.name.as_str()).collect();
        let system = json!({ "name": names.join(", "), "scales": scales });
        format!(
            "SYSTEMS.chosen = {};\nview.units = 'chosen';",
            system.to_string().replace('<', "\\u003c")
        )
    }

    /// A value in the shown unit, and the name of that; `None` if it is shown in SI.
    fn converted<'a>(&'a self, value: f64, si: &'a str) -> Option<(f64, Cow<'a, str>)> {
        if let Some(own) = self.of_kind(si) {
            return Some((own.declared.shown(value), Cow::Borrowed(own.name.as_str())));
        }
        let [above, below] = self.of_ratio(si)?;
        let name = format!("{}/{}", grouped(above.name()), grouped(below.name()));
        Some((value * above.of_one() / below.of_one(), Cow::Owned(name)))
    }

    /// The shown unit of a value in the unit `si`.
    pub fn name<'a>(&'a self, si: &'a str) -> Cow<'a, str> {
        self.converted(1.0, si).map_or(Cow::Borrowed(si), |(_, name)| name)
    }

    /// A value in the shown unit.
    pub fn value(&self, value: f64, si: &str) -> f64 {
        self.converted(value, si).map_or(value, |(shown, _)| shown)
    }
}

/// Numerator or denominator of a ratio.
struct Part<'a> {
    si: &'a str,
    /// Its shown unit; `None` for SI.
    shown: Option<&'a ShownUnit>,
}

impl Part<'_> {
    fn name(&self) -> &str {
        self.shown.map_or(self.si, |own| &own.name)
    }

    /// The value of one SI unit in the shown unit.
    fn of_one(&self) -> f64 {
        self.shown.map_or(1.0, |own| own.declared.shown(1.0))
    }
}

/// The coherent unit of a declared one; of an angle, `rad` or one of its rates.
fn coherent(of: &Declared) -> String {
    let rates = dimension(&of.coherent).filter(|_| counts_angles(&of.written));
    match rates {
        Some([0, 0, 0]) => "rad".into(),
        Some([0, 0, -1]) => "rad/s".into(),
        Some([0, 0, -2]) => "rad/s^2".into(),
        _ => of.coherent.clone(),
    }
}

/// True for an angle and its rates, such as `rad/s` or `deg`.
fn counts_angles(unit: &str) -> bool {
    ["rad", "deg", "°", "rpm"].iter().any(|symbol| unit.starts_with(symbol)) || unit.starts_with("mrad")
}

/// Numerator and denominator of a unit, without their parentheses: what stands before and after the first `/` outside
/// parentheses.
fn parts(unit: &str) -> Option<(&str, &str)> {
    let mut depth = 0;
    let at = unit.find(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == '/' && depth == 0
    })?;
    Some((bare(&unit[..at]), bare(&unit[at + 1..])))
}

fn bare(part: &str) -> &str {
    let inner = part.strip_prefix('(').and_then(|part| part.strip_suffix(')'));
    inner.unwrap_or(part)
}

/// A unit that stays one factor of a ratio.
fn grouped(unit: &str) -> Cow<'_, str> {
    match unit.contains(['/', ' ']) {
        true => Cow::Owned(format!("({unit})")),
        false => Cow::Borrowed(unit),
    }
}

/// Choice of the user.
static CHOSEN: OnceLock<Units> = OnceLock::new();

/// Sets the units of all results and messages. The first choice of a process holds.
pub fn choose(units: Units) {
    let _ = CHOSEN.set(units);
    shown::convert_by(|value, si| {
        let (shown, name) = CHOSEN.get()?.converted(value, si)?;
        Some((shown, name.into_owned()))
    });
}

/// The shown unit of a value in `si`: SI without a choice.
pub fn name(si: &str) -> Cow<'_, str> {
    CHOSEN.get().map_or(Cow::Borrowed(si), |units| units.name(si))
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
    match &*name(si) {
        "1" | "" => shown.into(),
        unit => format!("{shown} {unit}"),
    }
}

/// A script that opens a page in the chosen units; empty without a choice, so that the page uses its own.
pub fn script() -> String {
    CHOSEN.get().map_or(String::new(), Units::script)
}

/// The unit of a magnitude in decibels: relative to 1 of the shown unit, which a pure number has not.
pub fn decibels(si: &str) -> String {
    match &*name(si) {
        "1" => "dB".into(),
        unit => format!("dB re 1 {unit}"),
    }
}

/// A column heading with its shown unit in brackets; a pure number has none.
pub fn heading(what: &str, si: &str) -> String {
    match &*name(si) {
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
        assert_eq!((units.name("N/m"), units.value(25e3, "N/m")), ("N/mm".into(), 25.0));
        assert_eq!((units.name("m/s^2"), units.value(9.80665, "m/s^2")), ("g".into(), 1.0));
        assert_eq!(
            (units.name("N s/m"), units.value(1500.0, "N s/m")),
            ("N s/m".into(), 1500.0)
        );
        assert_eq!(units.name("1"), "1");
        let engineering: Units = "engineering".parse().unwrap();
        for (si, shown, size) in [
            ("(m/s^2)/N", "g/N", 1.0 / 9.80665),
            ("(m/s)/N", "(mm/s)/N", 1e3),
            ("N/(m/s^2)", "N/g", 9.80665),
            ("rad/m", "rad/mm", 1e-3),
        ] {
            assert_eq!(engineering.name(si), shown);
            assert!((engineering.value(1.0, si) / size - 1.0).abs() < 1e-12, "{si}");
        }
        for unit in ["N/(m/s)", "m/s", "kg/m", "1/m"] {
            assert_eq!(units.name(unit), unit);
        }
        assert_eq!(
            (engineering.name("N s/m"), engineering.value(1500.0, "N s/m")),
            ("N s/mm".into(), 1.5)
        );
        assert_eq!("si".parse::<Units>(), Ok(Units::default()));
    }

    #[test]
    fn a_unit_of_angles_is_not_that_of_other_numbers() {
        let units: Units = "deg,rpm".parse().unwrap();
        assert_eq!((units.name("rad"), units.name("rad/s")), ("deg".into(), "rpm".into()));
        assert_eq!((units.name("1"), units.name("1/s")), ("1".into(), "1/s".into()));
        assert_eq!(units.value(0.5, "1"), 0.5);
    }

    #[test]
    fn a_unit_is_known_and_its_kind_is_chosen_once() {
        for text in ["", "N/mmm", "mm,m", "si,mm"] {
            assert!(text.parse::<Units>().is_err(), "{text}");
        }
    }
}
