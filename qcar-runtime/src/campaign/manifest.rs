//! From `campaign.toml` to [`Campaign`]: what each section must hold, and what must agree between them.

use std::path::Path;

use super::contents::Tap;
use super::contents::{
    Axis, Campaign, Channel, Parameter, Quantity, Recording, Road, Role, RoleNames, Run, Side, Spacing, Sweep, Test,
};
use super::fields::{Document, Section};
use super::recorded::{self, Files, Recorded};
use super::{table, tap, unit};
use crate::error::{InputError, Place, Problem};

/// The columns of a quasi-static curve, m and N.
pub(super) const CURVE: &[&str] = &["displacement", "force"];
/// The columns of a dynamic bounce, s, m, m/s and N.
pub(super) const DYNAMIC_CURVE: &[&str] = &["time", "displacement", "velocity", "force"];
/// The columns of a road, m, m and 1.
pub(super) const ROAD: &[&str] = &["x", "z", "slope"];

impl Campaign {
    /// Opens a campaign: reads `campaign.toml` of `folder`, the header line of every plain table that it lists, and the
    /// runs of all other files.
    ///
    /// # Errors
    /// All problems of `campaign.toml` together; where it has none, all problems of the files' headers; where they have
    /// none, all problems of the other files.
    pub fn open(folder: impl AsRef<Path>) -> Result<Campaign, InputError> {
        let folder = folder.as_ref();
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

fn campaign(folder: &Path, top: Section<'_>, files: &Files) -> Option<Campaign> {
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
    let sensors = sensors(folder, &top);
    let roads = each(top.sections("road"), "name", road, |road| &road.name);
    let known = Known {
        folder,
        files,
        roads: roads.as_deref(),
        sensors: sensors.as_deref(),
    };
    let runs = each(
        top.sections("run"),
        "file",
        |section| run(section, &known),
        |run| &run.name,
    );
    if runs.as_ref().is_some_and(Vec::is_empty) {
        top.wrong("run", "no run", "at least one [[run]]", "list the measured files");
    }
    top.finish();
    let (folder, notices) = (folder.to_path_buf(), Vec::new());
    let (name, model, parameters, sensors, runs, roads) = (name?, model?, parameters?, sensors?, runs?, roads?);
    let (channels, taps) = sensors.into_iter().map(|sensor| (sensor.channel, sensor.tap)).unzip();
    Some(Campaign {
        folder,
        name,
        description,
        model,
        vehicle,
        roles,
        parameters,
        channels,
        taps,
        runs,
        roads,
        notices,
        recorded: Vec::new(),
    })
}

/// A channel, and where its values come from.
struct Sensor {
    channel: Channel,
    tap: Tap,
    /// Whether the tap says more than a plain table needs.
    mapped: bool,
}

/// What a run is read beside.
struct Known<'a> {
    folder: &'a Path,
    files: &'a Files,
    /// `None` where something is wrong with them.
    roads: Option<&'a [Road]>,
    sensors: Option<&'a [Sensor]>,
}

/// The channels of the file that `mapping` names, then those of the campaign itself.
fn sensors(folder: &Path, top: &Section<'_>) -> Option<Vec<Sensor>> {
    let shared = match top.optional_text("mapping") {
        Some(file) => mapping(&folder.join(file)).map_err(|error| top.adopt(error)).ok(),
        None => Some(Vec::new()),
    };
    let own = each(top.sections("channel"), "name", sensor, |sensor| &sensor.channel.name);
    let (mut shared, own) = (shared?, own?);
    let twice = own
        .iter()
        .find(|own| shared.iter().any(|shared| shared.channel.name == own.channel.name));
    if let Some(twice) = twice {
        let found = format!("the channel \"{}\", which `channel` has too", twice.channel.name);
        top.wrong(
            "mapping",
            found,
            "each channel once",
            "remove it from one of the two files",
        );
    }
    shared.iter_mut().for_each(|shared| shared.tap.shared = true);
    shared.extend(own);
    Some(shared)
}

/// The channels of a file that campaigns share.
fn mapping(file: &Path) -> Result<Vec<Sensor>, InputError> {
    let document = Document::read(file)?;
    let sensors = {
        let tree = document.parse()?;
        let top = document.top(&tree);
        let sensors = each(top.sections("channel"), "name", sensor, |sensor| &sensor.channel.name);
        top.finish();
        sensors
    };
    document.finish(sensors)
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

fn sensor(section: &Section<'_>) -> Option<Sensor> {
    let (name, location) = (section.text("name"), section.text("location"));
    let (side, axis) = (section.choice("side", Side::NAMES), section.choice("axis", Axis::NAMES));
    let quantity = section.choice("quantity", Quantity::NAMES);
    if name.as_deref() == Some("time") {
        section.wrong(
            "name",
            "\"time\"",
            "another name",
            "the column `time` holds the time; rename the channel",
        );
    }
    let tap = tap::tap(section, name.as_deref().unwrap_or(""), quantity.map(Quantity::unit));
    section.finish();
    let (tap, mapped) = tap?;
    let channel = Channel {
        name: name?,
        location: location?,
        side: side?,
        axis: axis?,
        quantity: quantity?,
    };
    Some(Sensor { channel, tap, mapped })
}

/// Which keys a run may have depends on its kind: without a known kind, none of them is refused.
fn run(section: &Section<'_>, known: &Known<'_>) -> Option<Run> {
    let (file, role) = (section.text("file"), section.choice("role", Role::NAMES));
    let (name, without) = (section.optional_text("name"), section.texts("without"));
    let window = tap::window(section);
    let (read, columns) = section.choice("kind", KINDS)?;
    let (columns, mapped) = tap::columns(section, columns)?;
    let mapped = mapped
        || known
            .sensors
            .is_some_and(|sensors| columns.is_empty() && sensors.iter().any(|own| own.mapped));
    let (file, window) = (file?, window?);
    let plain = is_table(&file) && !mapped && window.is_whole() && without.is_empty();
    let test = read(section, known, (!plain).then_some(&file));
    section.finish();
    Some(Run {
        name: name.unwrap_or_else(|| file.clone()),
        file,
        plain,
        window,
        without,
        columns,
        role: role?,
        test: test?,
    })
}

/// Whether a file may be a plain table.
fn is_table(file: &str) -> bool {
    file.ends_with(".csv") || file.ends_with(".csv.gz")
}

/// The rate of a run, Hz. In the file of a rig, `file`, it is the highest among its channels unless it is stated.
fn sample_rate(section: &Section<'_>, known: &Known<'_>, file: Option<&String>) -> Option<f64> {
    let Some(file) = file.filter(|_| !section.has("sample_rate")) else {
        return section.positive("sample_rate");
    };
    let taps: Vec<&Tap> = known.sensors?.iter().map(|sensor| &sensor.tap).collect();
    let highest = recorded::highest_rate(known.files, &known.folder.join(file), &taps);
    highest.map_err(|error| section.adopt(error)).ok()
}

/// Reads a test, whose file is named where it is no plain table.
type ReadTest = fn(&Section<'_>, &Known<'_>, Option<&String>) -> Option<Test>;

/// The kinds with the columns that a curve of the kind has.
const KINDS: &[(&str, (ReadTest, &[&str]))] = &[
    ("sweep", (sweep, &[])),
    ("bounce", (|_, _, _| Some(Test::Bounce), CURVE)),
    (
        "dynamic_bounce",
        (|section, _, _| dynamic_bounce(section), DYNAMIC_CURVE),
    ),
    ("longitudinal", (|_, _, _| Some(Test::Longitudinal), CURVE)),
    ("cleat", (cleat, &[])),
    ("time_history", (time_history, &[])),
];

fn sweep(section: &Section<'_>, known: &Known<'_>, file: Option<&String>) -> Option<Test> {
    let (peak_velocity, spacing) = (
        section.positive("peak_velocity"),
        section.choice("spacing", Spacing::NAMES),
    );
    let (start, end) = (section.positive("start_frequency"), section.positive("end_frequency"));
    let sample_rate = sample_rate(section, known, file);
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

fn cleat(section: &Section<'_>, known: &Known<'_>, file: Option<&String>) -> Option<Test> {
    let (speed, sample_rate) = (section.positive("speed"), sample_rate(section, known, file));
    let cleat = section.text("cleat")?;
    if let Some(roads) = known.roads
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

fn time_history(section: &Section<'_>, known: &Known<'_>, file: Option<&String>) -> Option<Test> {
    let (sample_rate, band_limited) = (sample_rate(section, known, file), section.boolean("band_limited"));
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

/// The runs of files that are no plain tables.
fn recorded_runs(campaign: &Campaign, files: &Files) -> Result<Vec<Recorded>, InputError> {
    let (mut runs, mut problems) = (Vec::new(), Vec::new());
    for run in campaign.runs.iter().filter(|run| !run.plain) {
        match recorded::record(campaign, files, run) {
            Ok(recorded) => runs.push(recorded),
            Err(error) => problems.extend(error.problems),
        }
    }
    InputError::unless_empty(problems, Some(runs))
}

/// The columns of all plain time histories, once the header of every plain table has been found right.
fn plain_columns(campaign: &Campaign) -> Result<Vec<String>, InputError> {
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
    let plain = campaign.runs.iter().filter(|run| run.plain);
    let runs = plain.map(|run| match run.test {
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
        .filter(|channel| !recorded.contains(&channel.name) && !campaign.is_missed(&channel.name));
    let say = |channel: &Channel| {
        let (file, name) = (campaign.manifest(), &channel.name);
        format!(
            "{}: the channel `{name}` is recorded in no run; remove it, or check the column names",
            file.display()
        )
    };
    unused.map(say).collect()
}
