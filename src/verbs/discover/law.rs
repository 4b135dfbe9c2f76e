//! The law that was learned where no effect of the catalogue explains the gap: as an effect file, as a model, and in words.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use qcar_dsl::patch::{Curve, NewParameter, Ordinate, Patch};
use qcar_runtime::discover::search::{Finding, Learned};

use super::Written;
use crate::failure::Failure;
use crate::files::put;
use crate::table::number;
use crate::workshop::Bench;

/// What was learned, ready to be told and written.
pub(crate) struct LearnedModel {
    /// Each law.
    pub laws: Vec<Law>,
    /// The model with all of them.
    pub model: Written,
}

/// A law at a place.
pub(crate) struct Law {
    /// What it is like.
    pub words: String,
    /// Units of its parameters.
    pub units: BTreeMap<String, String>,
    /// Its name, and its effect file with the values that were found.
    name: String,
    text: String,
    /// Where that was written.
    pub file: Option<PathBuf>,
}

/// Puts the laws into the model of the bench; `None` where one does not apply there.
pub(super) fn learned_model(mut bench: Bench, learned: &Learned) -> Option<LearnedModel> {
    let why = format!(
        "Evidence: no effect of the catalogue explains the gap; this law closes {:.0} % of it.",
        100.0 * learned.explained
    );
    let mut laws = Vec::new();
    let mut text = String::new();
    for finding in &learned.laws {
        let patched = bench.patched(&finding.effect, &finding.at, None)?;
        laws.push(law(bench.patch(&finding.effect)?, finding, &patched.parameters));
        text = patched.text(&why);
        bench = bench.holding(patched.model);
    }
    let name = bench.checked().name.clone();
    let model = Written { name, text, file: None };
    Some(LearnedModel { laws, model })
}

fn law(patch: &Patch, finding: &Finding, declared: &[NewParameter]) -> Law {
    let found = |own: &NewParameter| {
        let known = finding.parameters.iter().find(|(name, ..)| *name == own.effect_name);
        let start = known.map_or(own.start, |(_, value, _)| *value);
        NewParameter { start, ..own.clone() }
    };
    let parameters: Vec<NewParameter> = declared.iter().map(found).collect();
    Law {
        words: words(patch, &parameters),
        units: parameters
            .iter()
            .map(|own| (own.effect_name.clone(), own.unit.to_string()))
            .collect(),
        name: finding.effect.clone(),
        text: patch.text_at(&parameters),
        file: None,
    }
}

impl LearnedModel {
    /// Writes the model and an effect file for each law.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub(super) fn write(&mut self, folder: &Path) -> Result<(), Failure> {
        self.model.write(folder)?;
        for law in &mut self.laws {
            let name = format!("learned_{}.axle", law.name);
            put(folder, &name, &law.text)?;
            law.file = Some(folder.join(name));
        }
        Ok(())
    }
}

/// What a law is like: each of its curves in a sentence, or which of its coefficients count.
fn words(patch: &Patch, parameters: &[NewParameter]) -> String {
    let curves = patch.curves();
    if curves.is_empty() {
        return shares(parameters);
    }
    let sentences: Vec<String> = curves.iter().map(|curve| of_curve(curve, parameters)).collect();
    format!("{}; no memory", sentences.join("; "))
}

/// A coefficient is told of from this share of their sum on.
const WORTH_TELLING: f64 = 0.1;

fn shares(parameters: &[NewParameter]) -> String {
    let free: Vec<&NewParameter> = parameters.iter().filter(|own| !own.known).collect();
    let sum: f64 = free.iter().map(|own| own.start).sum();
    let unit = free.first().map_or(String::new(), |own| own.unit.to_string());
    let told = free.iter().filter(|own| own.start >= WORTH_TELLING * sum);
    let told = told.map(|own| format!("{:.0} % {} ({})", 100.0 * own.start / sum, own.effect_name, own.doc));
    format!(
        "{} {unit} in all: {}",
        number(sum, 3),
        told.collect::<Vec<_>>().join(", ")
    )
}

/// Sides whose ordinates differ by less than this part of the largest change are called the same, and a change by less than
/// this is none.
const ALIKE: f64 = 0.1;

/// `it falls to 0.41 of its value at rest at 0.5 m/s of compression, …`
fn of_curve(curve: &Curve, parameters: &[NewParameter]) -> String {
    let named = |name: &str| parameters.iter().find(|own| own.effect_name == name);
    let scale = curve.scale.as_deref().and_then(named);
    let unit = scale.map_or("times".into(), |own| own.unit.to_string());
    let scale = scale.map_or(1.0, |own| own.start);
    let points: Vec<(f64, f64)> = curve
        .points
        .iter()
        .map(|(x, y)| match y {
            Ordinate::Number(y) => (x * scale, *y),
            Ordinate::Parameter(name) => (x * scale, named(name).map_or(f64::NAN, |own| own.start)),
        })
        .collect();
    let rest = points.iter().find(|(x, _)| *x == 0.0).map_or(0.0, |(_, y)| *y);
    let over = match curve.over.as_str() {
        "s" => "travel",
        "v" => "speed",
        other => other,
    };
    let largest = points.iter().map(|(_, y)| (y - rest).abs()).fold(0.0, f64::max);
    if largest < ALIKE {
        return format!("it hardly changes with the {over}");
    }
    let side = |sign: f64| -> Vec<(f64, f64)> {
        let mut own: Vec<(f64, f64)> = points.iter().filter(|(x, _)| x * sign > 0.0).copied().collect();
        own.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        own
    };
    let [compression, rebound] = [-1.0, 1.0].map(side);
    let pairs = compression.iter().zip(&rebound);
    let is_even = compression.len() == rebound.len()
        && pairs
            .into_iter()
            .all(|(a, b)| a.0 == -b.0 && (a.1 - b.1).abs() < ALIKE * largest);
    let told = |points: &[(f64, f64)], of: &str| {
        let told = points
            .iter()
            .map(|(x, y)| format!("{} at {}", number(*y, 3), number(x.abs(), 3)));
        format!("{} {unit} {of}", told.collect::<Vec<_>>().join(", "))
    };
    let sides = if is_even {
        told(&rebound, "in both directions alike")
    } else {
        format!(
            "{}; {}",
            told(&compression, "in compression"),
            told(&rebound, "in rebound")
        )
    };
    format!("over the {over} it goes from {rest} at rest to {sides}")
}
