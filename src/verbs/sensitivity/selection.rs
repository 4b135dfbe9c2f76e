//! Metrics and parameters by name.

use qcar_runtime::campaign::RoleNames;
use qcar_runtime::error::{InputError, Problem};
use qcar_runtime::metric::{Course, Ground, Metric, MetricError};
use qcar_runtime::model::About;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::roles::Roles;
use qcar_runtime::spelling::{self, nearest};

use crate::failure::flag;
use crate::verbs::each_once;

/// True if a name matches a pattern, in which each `*` means any characters.
pub(crate) fn fits(pattern: &str, name: &str) -> bool {
    let Some((prefix, rest)) = pattern.split_once('*') else {
        return pattern == name;
    };
    let (between, suffix) = rest.rsplit_once('*').unwrap_or(("", rest));
    let inner = name.strip_prefix(prefix).and_then(|name| name.strip_suffix(suffix));
    let after = |name: &str, piece: &str| name.find(piece).map(|at| at + piece.len());
    let mut pieces = between.split('*');
    inner.is_some_and(|inner| {
        pieces
            .try_fold(0, |from, piece| Some(from + after(&inner[from..], piece)?))
            .is_some()
    })
}

/// Keeps the courses that match the names; all without names.
///
/// # Errors
/// Fails with every name that matches no course.
pub(crate) fn keep_runs(courses: &mut Vec<Course>, names: &[String]) -> Result<(), InputError> {
    let known: Vec<&str> = courses.iter().map(|course| course.name.as_str()).collect();
    let lost = names.iter().filter(|name| !known.iter().any(|own| fits(name, own)));
    let expected = format!("one of {}", known.join(", "));
    let problem = |name: &String| {
        flag(
            "--runs",
            format!("`{name}`"),
            &expected,
            "correct the name or remove it",
        )
    };
    let problems = lost.map(problem).collect();
    courses.retain(|course| names.is_empty() || names.iter().any(|name| fits(name, &course.name)));
    InputError::unless_empty(problems, Some(()))
}

/// The metrics that match the names, in the order of the names; a name may contain `*`.
///
/// # Errors
/// Fails with every name that matches no metric of the model.
pub(crate) fn metrics(ground: &Ground<'_>, names: &[String]) -> Result<Vec<usize>, InputError> {
    let (mut chosen, mut problems) = (Vec::new(), Vec::new());
    for name in names {
        let found: Vec<usize> = places(ground.metrics(), name).collect();
        if found.is_empty() {
            problems.push(unknown(ground, name, |found, expected, remedy| {
                flag("--metrics", found, expected, remedy)
            }));
        }
        chosen.extend(found);
    }
    let chosen = each_once(chosen);
    problems.extend(chosen.iter().filter_map(|&metric| unread(ground, metric)));
    InputError::unless_empty(problems, Some(chosen))
}

/// The problem of a metric that has no value on any of the runs.
fn unread(ground: &Ground<'_>, metric: usize) -> Option<Problem> {
    let found = format!("`{}`, on runs without an obstacle", ground.metrics()[metric].name);
    let remedy = "choose such a run with --runs, or leave the metric out";
    ground
        .readings_of(metric)
        .is_empty()
        .then(|| flag("--metrics", found, "a run over an obstacle", remedy))
}

fn places<'a>(metrics: &'a [Metric], pattern: &'a str) -> impl Iterator<Item = usize> + 'a {
    let all = metrics.iter().enumerate();
    all.filter(move |(_, metric)| fits(pattern, &metric.name))
        .map(|(place, _)| place)
}

/// The problem of a name that is no metric of the model.
pub(crate) fn unknown(ground: &Ground<'_>, name: &str, problem: impl Fn(&str, &str, &str) -> Problem) -> Problem {
    let expected = format!("a metric of model `{}`", ground.about().name);
    let known = || ground.metrics().iter().map(|metric| &*metric.name);
    let ridden = [
        ".peak",
        ".after_shake",
        ".weighted_rms",
        ".vdv",
        ".dynamic_load",
        ".travel",
    ];
    let remedy = if ground.courses().is_empty()
        && ridden.iter().any(|suffix| name.ends_with(suffix))
        && nearest(name, known()).is_none()
    {
        "rides need r_tire, static_tire_def and static_tire_load: give a campaign, or parameter values with [vehicle]"
            .into()
    } else {
        match nearest(name, known()) {
            Some(nearest) => format!("did you mean `{nearest}`? `qcar sensitivity MODEL --list` prints all of them"),
            None => "`qcar sensitivity MODEL --list` prints all of them".into(),
        }
    };
    problem(&format!("`{name}`"), &expected, &remedy)
}

/// The default metrics: those of wheel and body, the load of the tyre, the travel, and the modes.
pub(crate) fn usual(ground: &Ground<'_>, names: &RoleNames) -> Vec<usize> {
    let roles = Roles::of(ground.about(), names).ok();
    let body = roles.as_ref().and_then(|roles| Some(roles.on_rig().ok()?.body));
    let ends: Vec<String> = roles.map(|roles| roles.wheel).into_iter().chain(body).collect();
    let is_end = |place: &str| {
        place
            .rsplit_once('_')
            .is_some_and(|(mass, _)| ends.iter().any(|end| end == mass))
    };
    let wanted = |metric: &Metric| match metric.name.rsplit_once('.') {
        Some((place, "peak" | "after_shake" | "vdv")) => metric.what.is_ridden() && is_end(place),
        Some((_, "weighted_rms" | "peak_frequency")) => false,
        _ => true,
    };
    let all = ground.metrics().iter().enumerate();
    all.filter(|(place, metric)| wanted(metric) && !ground.readings_of(*place).is_empty())
        .map(|(place, _)| place)
        .collect()
}

/// The metrics that have a value, and a notice on each that is infinite because a mode has no damping.
pub(crate) fn without_infinite(ground: &Ground<'_>, values: &Values, metrics: Vec<usize>) -> (Vec<usize>, Vec<String>) {
    let (mut finite, mut notices) = (Vec::new(), Vec::new());
    for metric in metrics {
        match ground.check_at_rest(values, metric) {
            Err(error @ MetricError::Undamped { .. }) => notices.push(format!("left out: {error}")),
            _ => finite.push(metric),
        }
    }
    (finite, notices)
}

/// Parameters by name, without duplicates and without tied ones; without names, all that the model does not declare
/// `known`.
///
/// # Errors
/// Fails with every name that is no parameter of the model or is that of a tied parameter.
pub(crate) fn parameters(about: &About, values: &Values, names: &[String]) -> Result<Vec<usize>, InputError> {
    if names.is_empty() {
        let all = about.parameters.iter().enumerate();
        let open = all.filter(|(place, own)| !own.known && values.leader(*place) == *place);
        return Ok(open
            .filter(|(place, _)| values.as_slice()[*place] != 0.0)
            .map(|(place, _)| place)
            .collect());
    }
    let (mut chosen, mut problems) = (Vec::new(), Vec::new());
    for name in names {
        match parameter(about, values, name, |found, expected, remedy| {
            flag("--parameters", found, expected, remedy)
        }) {
            Ok(place) => chosen.push(place),
            Err(error) => problems.extend(error.problems),
        }
    }
    InputError::unless_empty(problems, Some(each_once(chosen)))
}

/// A parameter that is not tied to another.
///
/// # Errors
/// Fails if the name is no parameter of the model or is that of a tied parameter.
pub(crate) fn parameter(
    about: &About,
    values: &Values,
    name: &str,
    problem: impl Fn(&str, &str, &str) -> Problem,
) -> Result<usize, InputError> {
    let known = || about.parameters.iter().map(|own| &*own.name);
    let expected = format!("a parameter of model `{}`", about.name);
    let Some(place) = known().position(|own| own == name) else {
        let remedy = spelling::remedy(name, known());
        return Err(problem(&format!("`{name}`"), &expected, &remedy).into());
    };
    match values.leader(place) {
        leader if leader == place => Ok(place),
        leader => {
            let leader = &about.parameters[leader].name;
            let found = format!("`{name}`, which takes the value of `{leader}`");
            Err(problem(
                &found,
                "a parameter that is not tied to another",
                &format!("name `{leader}`, or give `{name}` a value"),
            )
            .into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn each_star_stands_for_any_letters() {
        let name = "cleat/v30_h20.csv.gz";
        for pattern in ["*", "cleat/*", "*.gz", "c*v30*h20*z", "*h20*", "**v30_*", name] {
            assert!(fits(pattern, name), "{pattern}");
        }
        for pattern in ["", "v30*", "*h20", "*h20*v30*", "cleat/v30_h20.csv.gz*gz", "*x*"] {
            assert!(!fits(pattern, name), "{pattern}");
        }
    }
}
