//! From `campaign.toml` to [`Campaign`]: what each section must hold, and what must agree between them.

use std::path::Path;

use super::contents::{
    Axis, Campaign, Channel, Parameter, Quantity, Recording, Road, Role, RoleNames, Run, Side, Spacing, Sweep, Test,
};
use super::fields::{Document, Section};
use super::{table, unit};
use crate::error::{InputError, Place, Problem};

/// The columns of a quasi-static curve, m and N.
pub(super) const CURVE: &[&str] = &["displacement", "force"];
/// The columns of a dynamic bounce, s, m, m/s and N.
pub(super) const DYNAMIC_CURVE: &[&str] = &["time", "displacement", "velocity", "force"];
/// The columns of a road, m, m and 1.
pub(super) const ROAD: &[&str] = &["x", "z", "slope"];

impl Campaign {
    /// Opens a campaign: reads `campaign.toml` of `folder` and the header line of every file that it lists.
    ///
    /// # Errors
    /// All problems of `campaign.toml` together; where it has none, all problems of the files' headers.
    pub fn open(folder: impl AsRef<Path>) -> Result<Campaign, InputError> {
        let folder = folder.as_ref();
        let document = Document::read(&folder.join("campaign.toml"))?;
        let campaign = {
            let tree = document.parse()?;
            campaign(folder, document.top(&tree))
        };
        let mut campaign = document.finish(campaign)?;
        let recorded = recorded_columns(&campaign)?;
        campaign.notices = notices(&campaign, &recorded);
        Ok(campaign)
    }
}

fn campaign(folder: &Path, top: Section<'_>) -> Option<Campaign> {
    format(&top);
    let (name, model, description) = (top.text("name"), top.text("model"), top.remark("description"));
    let vehicle = top
        .section("vehicle")
        .map(|section| section.numbers())
        .unwrap_or_default();
    let roles = top.section("roles").map(|section| roles(&section)).unwrap_or_default();
    let parameters = top
        .section("parameters")
        .map_or(Some(Vec::new()), |section| parameters(&section));
    let channels = each(top.sections("channel"), "name", channel, |channel| &channel.name);
    let roads = each(top.sections("road"), "name", road, |road| &road.name);
    let runs = each(
        top.sections("run"),
        "file",
        |section| run(section, roads.as_deref()),
        |run| &run.file,
    );
    if runs.as_ref().is_some_and(Vec::is_empty) {
        top.wrong("run", "no run", "at least one [[run]]", "list the measured files");
    }
    top.finish();
    let (folder, notices) = (folder.to_path_buf(), Vec::new());
    let (name, model, parameters, channels, runs, roads) = (name?, model?, parameters?, channels?, runs?, roads?);
    Some(Campaign {
        folder,
        name,
        description,
        model,
        vehicle,
        roles,
        parameters,
        channels,
        runs,
        roads,
        notices,
    })
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

/// Reads every section, even after one has failed, and refuses two that share the value of `key`.
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

fn parameters(section: &Section<'_>) -> Option<Vec<Parameter>> {
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
    if let Some(unit) = unit.as_ref().filter(|unit| unit::dimension(unit).is_none()) {
        let remedy = "convert value and range, and write the coherent unit (N/m, N s/m, kg, m, 1)";
        section.wrong("unit", format!("\"{unit}\""), "a coherent SI unit", remedy);
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
    Some(Parameter {
        name,
        value: value?,
        unit: unit?,
        range,
        fit: fit?,
        comment,
    })
}

fn channel(section: &Section<'_>) -> Option<Channel> {
    let (name, location) = (section.text("name"), section.text("location"));
    let (side, axis) = (section.choice("side", Side::NAMES), section.choice("axis", Axis::NAMES));
    let (quantity, unit) = (section.choice("quantity", Quantity::NAMES), section.text("unit"));
    if name.as_deref() == Some("time") {
        section.wrong(
            "name",
            "\"time\"",
            "another name",
            "the column `time` holds the time; rename the channel",
        );
    }
    if let (Some(quantity), Some(unit)) = (quantity, &unit)
        && unit::dimension(unit) != unit::dimension(quantity.unit())
    {
        let expected = format!("\"{}\"", quantity.unit());
        let remedy = format!(
            "convert the column `{}` in every file, and write this unit",
            name.as_deref().unwrap_or("")
        );
        section.wrong("unit", format!("\"{unit}\""), expected, remedy);
    }
    section.finish();
    unit?;
    Some(Channel {
        name: name?,
        location: location?,
        side: side?,
        axis: axis?,
        quantity: quantity?,
    })
}

/// Which keys a run may have depends on its kind: without a known kind, none of them is refused.
fn run(section: &Section<'_>, roads: Option<&[Road]>) -> Option<Run> {
    let (file, role) = (section.text("file"), section.choice("role", Role::NAMES));
    let read = section.choice("kind", KINDS)?;
    let test = read(section, roads);
    section.finish();
    Some(Run {
        file: file?,
        role: role?,
        test: test?,
    })
}

type ReadTest = fn(&Section<'_>, Option<&[Road]>) -> Option<Test>;

const KINDS: &[(&str, ReadTest)] = &[
    ("sweep", |section, _| sweep(section)),
    ("bounce", |_, _| Some(Test::Bounce)),
    ("dynamic_bounce", |section, _| dynamic_bounce(section)),
    ("longitudinal", |_, _| Some(Test::Longitudinal)),
    ("cleat", cleat),
    ("time_history", |section, _| time_history(section)),
];

fn sweep(section: &Section<'_>) -> Option<Test> {
    let (peak_velocity, spacing) = (
        section.positive("peak_velocity"),
        section.choice("spacing", Spacing::NAMES),
    );
    let (start, end) = (section.positive("start_frequency"), section.positive("end_frequency"));
    let sample_rate = section.positive("sample_rate");
    let (start_frequency, end_frequency, sample_rate) = (start?, end?, sample_rate?);
    if start_frequency >= end_frequency {
        let expected = format!("above the start at {start_frequency} Hz");
        section.wrong(
            "end_frequency",
            format!("{end_frequency} Hz"),
            expected,
            "correct the two frequencies",
        );
    }
    if end_frequency >= sample_rate / 2.0 {
        let expected = format!("below half the sample rate, {} Hz", sample_rate / 2.0);
        section.wrong(
            "end_frequency",
            format!("{end_frequency} Hz"),
            expected,
            "correct the frequency or the rate",
        );
    }
    let (peak_velocity, spacing) = (peak_velocity?, spacing?);
    Some(Test::Sweep(Sweep {
        peak_velocity,
        start_frequency,
        end_frequency,
        spacing,
        sample_rate,
    }))
}

fn dynamic_bounce(section: &Section<'_>) -> Option<Test> {
    let (peak_velocity, amplitude) = (section.positive("peak_velocity"), section.positive("amplitude"));
    Some(Test::DynamicBounce {
        peak_velocity: peak_velocity?,
        amplitude: amplitude?,
    })
}

fn cleat(section: &Section<'_>, roads: Option<&[Road]>) -> Option<Test> {
    let (speed, sample_rate) = (section.positive("speed"), section.positive("sample_rate"));
    let cleat = section.text("cleat")?;
    if let Some(roads) = roads
        && !roads.iter().any(|road| road.name == cleat)
    {
        let names: Vec<_> = roads.iter().map(|road| format!("\"{}\"", road.name)).collect();
        let expected = match names.as_slice() {
            [] => "the name of a [[road]], of which there is none".to_string(),
            names => format!("the name of a [[road]]: {}", names.join(", ")),
        };
        section.wrong(
            "cleat",
            format!("\"{cleat}\""),
            expected,
            "correct the name, or add the road",
        );
    }
    Some(Test::Cleat {
        speed: speed?,
        sample_rate: sample_rate?,
        cleat,
    })
}

fn time_history(section: &Section<'_>) -> Option<Test> {
    let (sample_rate, band_limited) = (section.positive("sample_rate"), section.boolean("band_limited"));
    let (band, periodic) = (section.range("band"), section.flag("periodic"));
    let (sample_rate, band_limited) = (sample_rate?, band_limited?);
    if let Some((low, high)) = band
        && (low < 0.0 || high >= sample_rate / 2.0)
    {
        section.wrong(
            "band",
            format!("[{low}, {high}] Hz"),
            format!(
                "a band from 0 Hz to below half the sample rate, {} Hz",
                sample_rate / 2.0
            ),
            "correct the band, or leave it out to compare all frequencies",
        );
    }
    Some(Test::TimeHistory(Recording {
        sample_rate,
        band_limited,
        band,
        periodic,
    }))
}

fn road(section: &Section<'_>) -> Option<Road> {
    let (name, file) = (section.text("name"), section.text("file"));
    section.finish();
    Some(Road {
        name: name?,
        file: file?,
    })
}

/// The columns of all time histories, once the header of every file has been found right.
fn recorded_columns(campaign: &Campaign) -> Result<Vec<String>, InputError> {
    let channels: Vec<_> = campaign.channels.iter().map(|channel| channel.name.as_str()).collect();
    let (mut recorded, mut problems) = (Vec::new(), Vec::new());
    for (file, required, allowed) in tables(campaign, &channels) {
        match table::header(&campaign.folder.join(file)) {
            Ok(names) => {
                problems.extend(table::check_names(
                    &campaign.folder.join(file),
                    &names,
                    required,
                    allowed,
                ));
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

/// Where a file is missing, its columns are what its maker must know.
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

/// Every file with the columns that it must and may have.
fn tables<'a>(campaign: &'a Campaign, channels: &'a [&str]) -> Vec<(&'a str, &'a [&'a str], &'a [&'a str])> {
    let runs = campaign.runs.iter().map(|run| match run.test {
        Test::Bounce | Test::Longitudinal => (run.file.as_str(), CURVE, &[][..]),
        Test::DynamicBounce { .. } => (run.file.as_str(), DYNAMIC_CURVE, &[][..]),
        Test::Sweep(_) | Test::Cleat { .. } | Test::TimeHistory(_) => (run.file.as_str(), &["time"][..], channels),
    });
    runs.chain(campaign.roads.iter().map(|road| (road.file.as_str(), ROAD, &[][..])))
        .collect()
}

fn notices(campaign: &Campaign, recorded: &[String]) -> Vec<String> {
    let unused = campaign
        .channels
        .iter()
        .filter(|channel| !recorded.contains(&channel.name));
    let say = |channel: &Channel| {
        let (file, name) = (campaign.manifest(), &channel.name);
        format!(
            "{}: the channel `{name}` is recorded in no run; remove it, or check the column names",
            file.display()
        )
    };
    unused.map(say).collect()
}
