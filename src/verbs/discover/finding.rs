//! A finding in words: the share that it explains, its parameters, and its rivals.

use std::collections::BTreeMap;
use std::fmt::Write;

use qcar_runtime::campaign::Role;
use qcar_runtime::discover::answer::{Finding, Rival};

use crate::table::{Table, number, or_dash};
use crate::units;

/// The parameters of a finding with their units.
pub(super) fn table(finding: &Finding, of: &BTreeMap<String, String>) -> String {
    let mut table = Table::new(["parameter", "unit", "value", "stderr"]);
    for (name, value, error) in &finding.parameters {
        let unit = of.get(name).map_or("", String::as_str);
        let shown = |value| units::value(value, unit);
        let error = or_dash(Some(shown(*error)).filter(|error| error.is_finite()), 2);
        table.row(vec![
            name.clone(),
            units::name(unit).into(),
            number(shown(*value), 4),
            error,
        ]);
    }
    table.text()
}

/// Share of the residual of the judging runs that something explains, in words that follow its name.
pub(super) fn share(explained: Option<f64>, judging: Role) -> String {
    match explained {
        Some(share) => format!(
            "explains {:.1} % of the residual of the {}",
            100.0 * share,
            runs_of(judging)
        ),
        None => "has nothing to explain: the judging runs leave no residual above noise".into(),
    }
}

/// The runs of a role, in words.
pub(super) fn runs_of(role: Role) -> &'static str {
    match role {
        Role::Fit => "fitted runs",
        Role::HeldOut => "held-out runs",
    }
}

/// Place, share of the residual and parameters. `among` is the number of findings of the same answer, which
/// explain that share together.
pub(super) fn described(finding: &Finding, among: usize, judging: Role, of: &BTreeMap<String, String>) -> String {
    let others = match among {
        0 | 1 => "",
        2 => ", with the other effect,",
        _ => ", with the other effects,",
    };
    let form = finding
        .form
        .as_deref()
        .map_or_else(String::new, |form| format!(" ({})", form.replace('_', " ")));
    let mut out = format!(
        "{} at {}{form}{others} {}\n{}",
        finding.effect,
        finding.at,
        share(finding.explained, judging),
        table(finding, of)
    );
    out += &undetermined(finding);
    out
}

/// The effects that were dropped in favour of a finding, a line each, best first.
pub(super) fn rivals(finding: &Finding) -> String {
    let mut best_first: Vec<&Rival> = finding.rivals.iter().collect();
    best_first.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    let line = |rival: &&Rival| {
        let behind = number(rival.behind, 3);
        format!(
            "less likely instead: {} at {}, lower by {behind} in log evidence\n",
            rival.effect, rival.at
        )
    };
    best_first.iter().take(4).map(line).collect()
}

/// Which parameters the fitted runs do not determine, or hardly.
fn undetermined(finding: &Finding) -> String {
    let named = |is: fn(f64, f64) -> bool| {
        let own = finding.parameters.iter().filter(|(_, value, error)| is(*value, *error));
        own.map(|(name, ..)| name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let mut out = String::new();
    let not = named(|_, error| !error.is_finite());
    if !not.is_empty() {
        let _ = writeln!(out, "the fitted runs do not determine {not}");
    }
    let hardly = named(|value, error| error.is_finite() && error > value.abs());
    if !hardly.is_empty() {
        let _ = writeln!(
            out,
            "the fitted runs hardly determine {hardly}: the standard error exceeds the value"
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A value that comes from the start instead of the data must not look like an estimate.
    #[test]
    fn undetermined_parameters_are_named() {
        let finding = Finding {
            effect: "suspended_mass".into(),
            at: "body".into(),
            form: None,
            alternative: None,
            parameters: vec![
                ("m_pwt".into(), 107.3, 1.1),
                ("k_pwt_x".into(), 3e5, f64::NAN),
                ("c_pwt_x".into(), 200.0, 300.0),
            ],
            evidence: 1e4,
            explained: None,
            rivals: Vec::new(),
        };
        let text = described(&finding, 1, Role::HeldOut, &BTreeMap::new());
        assert!(
            text.starts_with("suspended_mass at body has nothing to explain"),
            "{text}"
        );
        let remarks = "the fitted runs do not determine k_pwt_x\n\
                       the fitted runs hardly determine c_pwt_x: the standard error exceeds the value\n";
        assert!(text.ends_with(remarks), "{text}");
    }
}
