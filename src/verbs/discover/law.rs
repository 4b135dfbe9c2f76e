//! A learned law as an effect file, as part of a model, and as text.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_dsl::patch::{Curve, NewParameter, Ordinate, ParameterRole, Patch};
use qcar_runtime::discover::answer::{Finding, Learned};
use qcar_runtime::error::InputError;

use super::ExtendedModel;
use crate::files::put;
use crate::table::number;
use crate::workshop::Bench;

/// The learned laws, ready to be printed and written.
pub(crate) struct LearnedModel {
    /// The laws.
    pub laws: Vec<Law>,
    /// The model with all laws.
    pub model: ExtendedModel,
}

/// Beginning of the names of effect files.
pub(super) const FILE: &str = "learned_";

/// A law at a place.
pub(crate) struct Law {
    /// Description of the law.
    pub words: String,
    /// Units of its parameters.
    pub units: BTreeMap<String, String>,
    /// File name of its effect file, which contains the place, and text of the file with the fitted values.
    name: String,
    text: String,
    /// Path of the effect file; `None` before it is written.
    pub file: Option<PathBuf>,
}

/// Standard errors by parameter.
type Errors = BTreeMap<String, f64>;

fn errors(of: &Finding) -> Errors {
    let parameters = of.parameters.iter();
    parameters.map(|(name, _, error)| (name.clone(), *error)).collect()
}

/// Adds the laws to the model of the bench; `None` if one does not apply there.
pub(super) fn learned_model(mut bench: Bench, learned: &Learned) -> Option<LearnedModel> {
    let share = learned
        .explained
        .map(|share| format!("; this law explains {:.0} % of them", 100.0 * share));
    let why = format!(
        "Evidence: no effect of the catalogue explains the residuals{}.",
        share.unwrap_or_default()
    );
    let mut laws = Vec::new();
    let mut text = String::new();
    for finding in &learned.laws {
        let patched = bench.patched(&finding.effect, &finding.at, None)?;
        laws.push(law(
            bench.patch(&finding.effect)?,
            finding,
            &patched.parameters,
            learned.longest,
        ));
        text = patched.text(&why);
        bench = bench.holding(patched.model);
    }
    let name = bench.checked().name.clone();
    let model = ExtendedModel { name, text, file: None };
    Some(LearnedModel { laws, model })
}

fn law(patch: &Patch, finding: &Finding, declared: &[NewParameter], longest: f64) -> Law {
    let found = |own: &NewParameter| {
        let known = finding.parameters.iter().find(|(name, ..)| *name == own.effect_name);
        let start = known.map_or(own.start, |(_, value, _)| *value);
        NewParameter { start, ..own.clone() }
    };
    let parameters: Vec<NewParameter> = declared.iter().map(found).collect();
    Law {
        words: words(patch, &parameters, &errors(finding), longest),
        units: parameters
            .iter()
            .map(|own| (own.effect_name.clone(), own.unit.to_string()))
            .collect(),
        name: format!("{FILE}{}_at_{}.axle", finding.effect, finding.at),
        text: patch.text_at(&parameters),
        file: None,
    }
}

impl LearnedModel {
    /// Stores the paths that the files will have.
    pub(super) fn place(&mut self, folder: &Path) {
        self.model.place(folder);
        for law in &mut self.laws {
            law.file = Some(folder.join(&law.name));
        }
    }

    /// Writes the model and an effect file for each law.
    ///
    /// # Errors
    /// Fails if the folder cannot be written to.
    pub(super) fn write(&self, folder: &Path) -> Result<(), InputError> {
        self.model.write(folder)?;
        self.laws.iter().try_for_each(|law| put(folder, &law.name, &law.text))
    }
}

/// Description of a law: a sentence for each curve and each other parameter that is determined. A law without curves is
/// described by its largest coefficients. `longest` is the duration of the longest run, s.
fn words(patch: &Patch, parameters: &[NewParameter], errors: &Errors, longest: f64) -> String {
    let curves = patch.curves();
    if curves.is_empty() {
        return shares(parameters);
    }
    let sentences = curves.iter().map(|curve| of_curve(curve, parameters, errors, longest));
    let is_of_curve = |name: &String| curves.iter().any(|curve| curve.holds(name));
    let is_mentioned = |own: &&NewParameter| {
        let is_determined = errors.get(&own.effect_name).is_some_and(|error| *error < DETERMINED);
        !own.known && is_determined && !is_of_curve(&own.effect_name)
    };
    let beside = parameters.iter().filter(is_mentioned);
    let beside = beside.map(|own| format!("{} = {} ({})", own.effect_name, number(own.start, 3), own.doc));
    let sentences: Vec<String> = sentences.chain(beside).collect();
    format!("{}; no memory", sentences.join("; "))
}

/// A coefficient is mentioned if it has at least this share of their sum.
const MENTIONED: f64 = 0.1;

fn shares(parameters: &[NewParameter]) -> String {
    let free: Vec<&NewParameter> = parameters.iter().filter(|own| !own.known).collect();
    let sum: f64 = free.iter().map(|own| own.start).sum();
    let unit = free.first().map_or(String::new(), |own| own.unit.to_string());
    let largest = free.iter().filter(|own| own.start >= MENTIONED * sum);
    let largest = largest.map(|own| format!("{:.0} % {} ({})", 100.0 * own.start / sum, own.effect_name, own.doc));
    format!(
        "{} {unit} in all: {}",
        number(sum, 3),
        largest.collect::<Vec<_>>().join(", ")
    )
}

/// Both directions count as equal if they differ by less than this share of the largest change.
const ALIKE: f64 = 0.1;
/// A point is mentioned if its standard error is below this share of the curve's value at rest.
const DETERMINED: f64 = 0.5;

/// `over the speed it changes from 1 at rest to 0.62 at 0.2, 0.41 at 0.5 m/s in both directions`
fn of_curve(curve: &Curve, parameters: &[NewParameter], errors: &Errors, longest: f64) -> String {
    let named = |name: &str| parameters.iter().find(|own| own.effect_name == name);
    let scale = curve.scale.as_deref().and_then(named);
    let over = scale.or_else(|| named(&curve.over));
    let unit = over.map_or("in its unit".into(), |own| own.unit.to_string());
    let points = determined(curve, scale.map_or(1.0, |own| own.start), &named, errors);
    let over = match curve.over.as_str() {
        "s" if unit == "rad" => "angle",
        "s" => "travel",
        "v" => "speed",
        clock if is_clock(clock, parameters) => return of_time(&points, unit, longest),
        other => other,
    };
    let rest = points.iter().find(|(x, _)| *x == 0.0).map(|(_, y)| *y);
    let [compression, rebound] = [-1.0, 1.0].map(|sign| side(&points, sign));
    let listed = |points: &[(f64, f64)], of: &str| {
        let values = points
            .iter()
            .map(|(x, y)| format!("{} at {}", number(*y, 3), number(x.abs(), 3)));
        format!("{} {unit} {of}", values.collect::<Vec<_>>().join(", "))
    };
    let changes = points.iter().map(|(_, y)| (y - rest.unwrap_or(0.0)).abs());
    let sides = match (compression.is_empty(), rebound.is_empty()) {
        (true, true) => return format!("over the {over} it is not determined"),
        (false, false) if are_alike(&compression, &rebound, ALIKE * changes.fold(0.0, f64::max)) => {
            listed(&rebound, "in both directions")
        }
        (false, false) => format!(
            "{} and {}",
            listed(&compression, "in compression"),
            listed(&rebound, "in rebound")
        ),
        (_, true) => listed(&compression, "in compression; rebound is not determined"),
        (true, _) => listed(&rebound, "in rebound; compression is not determined"),
    };
    match rest {
        Some(rest) => format!("over the {over} it changes from {} at rest to {sides}", number(rest, 3)),
        None => format!("over the {over} it is {sides}; at rest it is not determined"),
    }
}

/// The points of a curve whose ordinates are numbers, or products of parameters that the data determine.
fn determined<'a>(
    curve: &Curve,
    scale: f64,
    named: &impl Fn(&str) -> Option<&'a NewParameter>,
    errors: &Errors,
) -> Vec<(f64, f64)> {
    let point = |(x, y): &(f64, Ordinate)| match y {
        Ordinate::Number(y) => Some((x * scale, *y)),
        Ordinate::Product(names) => {
            let is_determined = names
                .iter()
                .all(|name| errors.get(name).is_some_and(|error| *error < DETERMINED));
            let factors = names.iter().map(|name| named(name).map(|own| own.start));
            Some((x * scale, factors.product::<Option<f64>>()?)).filter(|_| is_determined)
        }
    };
    curve.points.iter().filter_map(point).collect()
}

/// True if both sides have as many points, whose ordinates differ by less than `limit`.
fn are_alike(one: &[(f64, f64)], other: &[(f64, f64)], limit: f64) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(a, b)| (a.1 - b.1).abs() < limit)
}

fn is_clock(name: &str, parameters: &[NewParameter]) -> bool {
    let own = parameters.iter().find(|own| own.effect_name == name);
    own.is_some_and(|own| own.role == ParameterRole::Clock)
}

/// `it changes from 1 at the start of a run to 0.9 after 10, about 0.8 after 20 s`, where the `longest` run (s) ends. The
/// value there is interpolated linearly between two points of the law.
fn of_time(points: &[(f64, f64)], unit: String, longest: f64) -> String {
    let end = if unit == "s" { longest } else { 1.0 };
    let (within, beyond): (Vec<_>, Vec<_>) = side(points, 1.0).into_iter().partition(|(time, _)| *time <= end);
    let after = |(time, y): (f64, f64)| format!("{} after {}", number(y, 3), number(time, 3));
    let (from, y) = within.last().copied().unwrap_or((0.0, 1.0));
    let at_end = beyond.first().filter(|_| from < end);
    let at_end = at_end.map(|(time, later)| (end, y + (later - y) * (end - from) / (time - from)));
    let mut values: Vec<String> = within.into_iter().map(after).collect();
    values.extend(at_end.map(|at_end| format!("about {}", after(at_end))));
    if values.is_empty() {
        return "how it changes with time is not determined".into();
    }
    let unit = if unit == "1" { "of the run".into() } else { unit };
    format!(
        "it changes from 1 at the start of a run to {} {unit}",
        values.join(", ")
    )
}

/// The points on one side of zero, from zero outwards, without repeated values.
fn side(points: &[(f64, f64)], sign: f64) -> Vec<(f64, f64)> {
    let mut own: Vec<(f64, f64)> = points.iter().filter(|(x, _)| x * sign > 0.0).copied().collect();
    own.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    own.dedup_by(|later, earlier| later.1 == earlier.1);
    own
}

#[cfg(test)]
mod tests {

    use super::*;

    fn declared(name: &str, start: f64, known: bool) -> NewParameter {
        NewParameter {
            name: name.into(),
            effect_name: name.into(),
            unit: "1".into(),
            start,
            range: (0.0, 10.0),
            known,
            doc: String::new(),
            role: qcar_dsl::patch::ParameterRole::Other,
            scales_force: false,
            is_new: true,
        }
    }

    fn curve() -> Curve {
        let product = |names: &[&str]| Ordinate::Product(names.iter().map(|name| name.to_string()).collect());
        Curve {
            over: "v".into(),
            scale: Some("v_ref".into()),
            points: vec![
                (-1.0, product(&["a", "b"])),
                (-0.5, product(&["a"])),
                (0.0, Ordinate::Number(1.0)),
                (0.5, product(&["c"])),
                (1.0, product(&["c", "d"])),
            ],
        }
    }

    fn text(values: [f64; 4], errors: [f64; 4]) -> String {
        text_of(&curve(), values, errors)
    }

    fn text_of(curve: &Curve, values: [f64; 4], errors: [f64; 4]) -> String {
        let names = ["a", "b", "c", "d"];
        let mut parameters: Vec<NewParameter> = names
            .iter()
            .zip(values)
            .map(|(name, value)| declared(name, value, false))
            .collect();
        parameters.push(declared("v_ref", 0.4, true));
        of_curve(
            curve,
            &parameters,
            &names.map(String::from).into_iter().zip(errors).collect(),
            60.0,
        )
    }

    #[test]
    fn a_curve_is_described_by_its_points() {
        assert_eq!(
            text([0.5, 0.5, 0.5, 0.5], [0.01; 4]),
            "over the speed it changes from 1 at rest to 0.5 at 0.2, 0.25 at 0.4 1 in both directions"
        );
        assert!(
            text([0.5, 0.5, 2.0, 1.5], [0.01; 4])
                .contains("0.5 at 0.2, 0.25 at 0.4 1 in compression and 2 at 0.2, 3 at 0.4 1 in rebound")
        );
    }

    #[test]
    fn a_change_with_time_is_described_by_times() {
        let points = [(0.0, 1.0), (10.0, 0.9), (30.0, 0.75), (100.0, 0.75)];
        let text = |longest: f64| of_time(&points, "s".into(), longest);
        assert_eq!(
            text(120.0),
            "it changes from 1 at the start of a run to 0.9 after 10, 0.75 after 30 s"
        );
        assert_eq!(
            text(20.0),
            "it changes from 1 at the start of a run to 0.9 after 10, about 0.825 after 20 s"
        );
        assert_eq!(
            text(5.0),
            "it changes from 1 at the start of a run to about 0.95 after 5 s"
        );
        assert_eq!(
            of_time(&points[..1], "1".into(), 20.0),
            "how it changes with time is not determined"
        );
    }

    #[test]
    fn an_undetermined_value_at_rest_is_left_out() {
        let mut curve = curve();
        curve.points[2].1 = Ordinate::Product(vec!["c".into(), "b".into()]);
        assert_eq!(
            text_of(&curve, [0.5, 0.5, 2.0, 1.5], [f64::NAN, f64::NAN, 0.01, 0.01]),
            "over the speed it is 2 at 0.2, 3 at 0.4 1 in rebound; compression is not determined; at rest it is not determined"
        );
    }

    /// A point beyond all runs has the value of its neighbour, without a measurement.
    #[test]
    fn undetermined_values_are_left_out() {
        let text = text([0.5, 0.5, 2.0, 1.5], [0.01, f64::NAN, f64::INFINITY, 0.01]);
        assert_eq!(
            text,
            "over the speed it changes from 1 at rest to 0.5 at 0.2 1 in compression; rebound is not determined"
        );
    }
}
