//! Reads `campaign.toml` as a [`Campaign`], with the requirements for each section and between sections.

use std::path::Path;

use super::contents::{Campaign, Channel, Parameter, Profile, Road, RoleNames, Test, impossible_fact, unit_of_fact};
use super::fields::{Document, Section};
use super::reading::RunData;
use super::recorded::{self, Files};
use super::table;
use super::unit::Declared;
use crate::error::{InputError, Place, Problem};
use runs::{RunContext, is_table, run};
use sensors::sensors;

// Entries of the campaign's workbook.
mod workbook;
// `[[channel]]` sections.
mod sensors;
// `[[run]]` sections.
mod runs;

/// Columns of a slow curve, m and N.
pub(super) const CURVE: &[&str] = &["displacement", "force"];
/// Columns of a dynamic bounce, s, m, m/s and N.
pub(super) const DYNAMIC_CURVE: &[&str] = &["time", "displacement", "velocity", "force"];
/// Columns of a dynamometer table, m/s and N.
pub(super) const FORCES: &[&str] = &["velocity", "force"];
/// Optional column of a dynamometer table, N.
pub(super) const UNCERTAINTY: &[&str] = &["uncertainty"];
/// Columns of a road, m, m and 1.
pub(super) const ROAD: &[&str] = &["x", "z"];
/// Optional columns of a road.
pub(super) const SLOPE: &[&str] = &["slope"];

impl Campaign {
    /// Opens a campaign: reads `campaign.toml` of `folder` (or that file, if it is given itself), the header line of every
    /// plain table that it lists, and the runs of all other files.
    ///
    /// # Errors
    /// Fails with all problems of `campaign.toml`; without any, with all problems of the headers of files; without
    /// these, with all problems of the other files.
    pub fn open(folder: impl AsRef<Path>) -> Result<Campaign, InputError> {
        let folder = folder_of(folder.as_ref());
        let document = Document::read(&folder.join("campaign.toml"))?;
        let files = Files::default();
        let campaign = {
            let tree = document.parse()?;
            campaign(folder, document.top(&tree), &files)
        };
        let mut campaign = document.finish(campaign)?;
        let mut names = plain_columns(&campaign)?;
        campaign.recorded = recorded_runs(&campaign, &files)?;
        let columns = campaign.recorded.iter().flat_map(|recorded| &recorded.columns);
        names.extend(columns.map(|(name, _)| name.clone()));
        InputError::unless_empty(campaign.problems_of_recorded(), Some(()))?;
        campaign.notices = notices(&campaign, &names);
        campaign.notices.extend(campaign.gaps_of_recorded());
        let recorded = campaign
            .runs
            .iter()
            .filter(|run| !run.plain && run.test.sample_rate().is_some());
        for run in recorded.cloned().collect::<Vec<_>>() {
            let findings = campaign.of_recorded(&run)?;
            campaign.notices.extend(findings.iter().map(ToString::to_string));
        }
        Ok(campaign)
    }
}

/// The folder of a `campaign.toml` that is given in place of its folder.
fn folder_of(given: &Path) -> &Path {
    let is_manifest = given.ends_with("campaign.toml") && given.is_file();
    let folder = given.parent().filter(|_| is_manifest).unwrap_or(given);
    if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    }
}

fn campaign(folder: &Path, top: Section<'_>, files: &Files) -> Option<Campaign> {
    format(&top);
    let (name, description) = (top.text("name"), top.remark("description"));
    let workbook = workbook::named(folder, &top, files);
    let model = workbook::model(&top, workbook.as_ref());
    let workbook = workbook.unwrap_or_default();
    let vehicle = top.section("vehicle");
    let vehicle = vehicle.map_or(Vec::new(), |section| facts(&section));
    let roles = top.section("roles").map(|section| roles(&section)).unwrap_or_default();
    let parameters = top.section("parameters");
    let parameters = parameters.map_or(Some(Vec::new()), |section| parameters_of(&section));
    let sensors = sensors(folder, &top);
    let roads = each(top.sections("road"), "name", road, |road| &road.name);
    let roads = roads.map(|roads| workbook.with_roads(roads));
    let known = RunContext {
        folder,
        files,
        roads: roads.as_deref(),
        sensors: sensors.as_deref(),
    };
    let read = |section: &Section<'_>| run(section, &known);
    let runs = each(top.sections("run"), "file", read, |run| &run.name);
    let runs = runs.map(|runs| workbook.with_runs(runs));
    if runs.as_ref().is_some_and(Vec::is_empty) {
        top.wrong("run", "no run", "at least one [[run]]", "list the measured files");
    }
    top.finish();
    let (name, model, parameters, sensors, runs, roads) = (name?, model?, parameters?, sensors?, runs?, roads?);
    let (channels, mappings) = sensors
        .into_iter()
        .map(|sensor| (sensor.channel, sensor.mapping))
        .unzip();
    Some(Campaign {
        folder: folder.to_path_buf(),
        name,
        description,
        model,
        parameters: workbook.with_parameters(parameters, &vehicle),
        vehicle: workbook.with_facts(vehicle),
        roles,
        channels,
        mappings,
        runs,
        roads,
        notices: Vec::new(),
        recorded: Vec::new(),
    })
}

/// The vehicle data, of which impossible values are refused.
fn facts(section: &Section<'_>) -> Vec<(String, f64)> {
    let facts = section.quantities(unit_of_fact);
    for (name, value) in &facts {
        if let Some((expected, remedy)) = impossible_fact(name, *value) {
            section.wrong(name, section.written(name), expected, remedy);
        }
    }
    facts
}

fn format(top: &Section<'_>) {
    if let Some(format) = top.number("format")
        && format != 1.0
    {
        top.wrong(
            "format",
            format!("{format}"),
            "1",
            "convert the campaign to version 1 of the format",
        );
    }
}

/// Reads every section, even after an error, and refuses two sections with the same value of `key`.
fn each<'a, T>(
    sections: Vec<Section<'a>>,
    key: &'static str,
    read: impl Fn(&Section<'a>) -> Option<T>,
    name: impl Fn(&T) -> &String,
) -> Option<Vec<T>> {
    let mut members: Vec<Option<T>> = Vec::new();
    for section in sections {
        let member = read(&section);
        if let Some(new) = &member
            && members.iter().flatten().any(|old| name(old) == name(new))
        {
            section.wrong(
                key,
                format!("a second \"{}\"", name(new)),
                "each once",
                "rename or remove one of them",
            );
        }
        members.push(member);
    }
    members.into_iter().collect()
}

fn roles(section: &Section<'_>) -> RoleNames {
    let (wheel, body) = (section.optional_text("wheel"), section.optional_text("body"));
    section.finish();
    RoleNames { wheel, body }
}

fn parameters_of(section: &Section<'_>) -> Option<Vec<Parameter>> {
    section
        .named_sections()
        .into_iter()
        .map(|(name, section)| parameter(name, &section))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

fn parameter(name: String, section: &Section<'_>) -> Option<Parameter> {
    let (value, unit, fit) = (section.number("value"), section.text("unit"), section.boolean("fit"));
    let (range, comment) = (section.range("range"), section.remark("comment"));
    section.finish();
    let declared = unit.as_deref().map(Declared::of);
    if let (Some(unit), Some(None)) = (&unit, &declared) {
        let remedy = "write the unit of value and range, such as N/m, N/mm, N s/m, kg, mm or 1";
        section.wrong("unit", format!("\"{unit}\""), "a unit of mechanics", remedy);
    }
    if let (Some(value), Some((lower, upper))) = (value, range)
        && !(lower..=upper).contains(&value)
    {
        let remedy = "correct the start value, or widen the range";
        section.wrong(
            "value",
            format!("{value}"),
            format!("a value from {lower} to {upper}, its range"),
            remedy,
        );
    }
    let declared = declared??;
    Some(Parameter {
        name,
        value: declared.si(value?),
        range: range.map(|(lower, upper)| (declared.si(lower), declared.si(upper))),
        unit: declared.coherent,
        fit: fit?,
        comment,
    })
}

fn road(section: &Section<'_>) -> Option<Road> {
    let (name, file, source) = (
        section.text("name"),
        section.text("file"),
        section.optional_text("source"),
    );
    section.finish();
    let file = file?;
    let profile = match is_table(&file) && source.is_none() {
        true => Profile::Table,
        false => Profile::Measured(source),
    };
    Some(Road {
        name: name?,
        file,
        profile,
    })
}

/// Reads the runs of files that are no plain tables.
fn recorded_runs(campaign: &Campaign, files: &Files) -> Result<Vec<RunData>, InputError> {
    let (mut runs, mut problems) = (Vec::new(), Vec::new());
    for run in campaign.runs.iter().filter(|run| !run.plain) {
        match recorded::record(campaign, files, run) {
            Ok(recorded) => runs.push(recorded),
            Err(error) => problems.extend(error.problems),
        }
    }
    InputError::unless_empty(problems, Some(runs))
}

/// Columns of all plain time histories, if the header of every plain table is correct.
fn plain_columns(campaign: &Campaign) -> Result<Vec<String>, InputError> {
    let channels: Vec<_> = campaign.channels.iter().map(|channel| channel.name.as_str()).collect();
    let (mut recorded, mut problems) = (Vec::new(), Vec::new());
    for (file, required, allowed) in tables(campaign, &channels) {
        match table::header(&campaign.folder.join(file)) {
            Ok(headings) => {
                let path = campaign.folder.join(file);
                problems.extend(table::check_units(&path, &headings, |name| {
                    let of_channel = || campaign.channel(name).filter(|_| allowed == channels);
                    of_channel().map_or_else(|| unit_of_column(name), |channel| Some(channel.unit()))
                }));
                let names: Vec<String> = headings.into_iter().map(|own| own.name).collect();
                problems.extend(table::check_names(&path, &names, required, allowed));
                recorded.extend(names);
            }
            Err(error) => {
                let named = error
                    .problems
                    .into_iter()
                    .map(|problem| with_columns(problem, required, allowed));
                problems.extend(named);
            }
        }
    }
    InputError::unless_empty(problems, Some(recorded))
}

/// The SI unit of a column of a plain table, other than that of a channel.
fn unit_of_column(name: &str) -> Option<&'static str> {
    match name {
        "time" => Some("s"),
        "displacement" | "x" | "z" => Some("m"),
        "velocity" => Some("m/s"),
        "force" | "uncertainty" => Some("N"),
        "slope" => Some("1"),
        _ => None,
    }
}

/// Description of the columns of a missing file, for its author.
fn with_columns(problem: Problem, required: &[&str], allowed: &[&str]) -> Problem {
    let columns = required.iter().chain(allowed).copied().collect::<Vec<_>>().join(",");
    match problem.place {
        Place::File => Problem {
            expected: format!("{} with the header line {columns}", problem.expected),
            ..problem
        },
        _ => problem,
    }
}

/// Every file with its required and optional columns.
fn tables<'a>(campaign: &'a Campaign, channels: &'a [&str]) -> Vec<(&'a str, &'a [&'a str], &'a [&'a str])> {
    let plain = campaign.runs.iter().filter(|run| run.plain);
    let runs = plain.map(|run| match run.test {
        Test::Bounce | Test::Longitudinal => (run.file.as_str(), CURVE, &[][..]),
        Test::DynamicBounce { .. } => (run.file.as_str(), DYNAMIC_CURVE, &[][..]),
        Test::Dynamometer(_) => (run.file.as_str(), FORCES, UNCERTAINTY),
        Test::Sweep(_) | Test::Cleat { .. } | Test::TimeHistory(_) => (run.file.as_str(), &["time"][..], channels),
    });
    let roads = campaign.roads.iter().filter(|road| road.profile == Profile::Table);
    runs.chain(roads.map(|road| (road.file.as_str(), ROAD, SLOPE)))
        .collect()
}

fn notices(campaign: &Campaign, recorded: &[String]) -> Vec<String> {
    let unused = campaign
        .channels
        .iter()
        .filter(|channel| !recorded.contains(&channel.name) && !campaign.is_missed(&channel.name));
    let say = |channel: &Channel| {
        let (file, name) = (campaign.manifest(), &channel.name);
        format!(
            "{}: no run records the channel `{name}`; remove it, or check the column names",
            file.display()
        )
    };
    unused.map(say).collect()
}
