//! `qcar discover`: the residuals of a model, and which effect is missing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use qcar_dsl::check::Checked;
use qcar_dsl::patch::Patched;
use qcar_runtime::campaign::Campaign;
use qcar_runtime::discover::answer::{DetectionLimit, Discovery, Finding, Update, Verdict};
use qcar_runtime::discover::candidate::Workshop;
use qcar_runtime::discover::numbers::Numbers;
use qcar_runtime::discover::posterior::Setting;
use qcar_runtime::discover::{Evidence, Sweeps, select};
use qcar_runtime::error::InputError;
use qcar_runtime::model::About;

use crate::completion;
use crate::failure::Failure;
use crate::files::{folder_for_results, put};
use crate::interruption::{leave, note};
use crate::parameters::{bound, campaign_out_of_range, check_campaign, own};
use crate::progress::Showing;
use crate::results::Results;
use crate::terminal::prose;
use crate::verbs::{Format, kc};
use crate::workshop::{Bench, given};

// The places where an added stiffness would explain the residual.
pub(crate) mod places;
// A learned law as an effect file.
pub(crate) mod law;
// The verdict in words.
pub(crate) mod verdict;
// A finding in words.
mod finding;
// Fitted parameters, and zero offsets of sensors.
mod fitted;
// Fitted nuisance parameters as text and JSON.
mod nuisances;
// A learned law as text and JSON.
mod learned;
// The answer as JSON.
pub(crate) mod result;
// The answer as text.
mod text;
// The residuals as a figure.
mod figure;
// Notices about sensors and ranges.
mod notices;
// The side of the car whose sensor is wrong.
mod wrong_side;
// Results of a search that was stopped.
mod unfinished;

use finding::runs_of;
use verdict::listed;
use wrong_side::wrong_side;

/// Find the effect that a campaign shows and its model lacks
///
/// Fits the model to the runs with the role `fit`, examines the residuals in standard deviations, tries the effects of
/// the catalogue at every place where they apply, and checks them on the `held_out` runs. The verdict is `none` if
/// noise explains the residuals, `found`, `class` if several effects explain them equally well, or `unknown`.
#[derive(Args)]
#[command(after_help = "Example:\n  qcar discover models/campaigns/axle_a_rig --out found")]
pub struct Arguments {
    /// Folder with a campaign.toml
    campaign: PathBuf,
    /// Start from this model, by name or path, instead of the campaign's
    #[arg(long, add = ArgValueCompleter::new(completion::models))]
    model: Option<String>,
    /// Write the patched model file, parameters.toml, discovery.json and gap.svg into this folder; after Ctrl-C, write
    /// what is known so far into its subfolder `unfinished`
    #[arg(long, value_name = "DIR", value_parser = folder_for_results)]
    out: Option<PathBuf>,
    /// Multiply assumptions of the search, to see their influence on the answer
    #[arg(long, hide = true, value_name = "NAME=FACTOR,…", value_parser = multiplied)]
    assume: Option<Numbers>,
    /// Output format
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Result of a search in a campaign.
pub struct Answer {
    /// Name of the campaign.
    pub campaign: String,
    /// Name of the model with which the search began.
    pub base_model: String,
    /// Its measured data.
    pub evidence: Evidence,
    /// Result of the search.
    pub discovery: Discovery,
    /// The base model, with its nuisance effects.
    base: Checked,
    /// Links and masses that its nuisance effects have added: they are no places of the user's model.
    added_parts: Vec<String>,
    /// Places at which a change would explain the residuals of the sweeps.
    pub sweeps: Sweeps,
    /// Units of the parameters of each finding.
    pub units: Vec<BTreeMap<String, String>>,
    /// The model with the findings; `None` if none of them changes the model.
    pub(crate) model: Option<ExtendedModel>,
    /// The learned laws and the model with them; `None` without any.
    pub(crate) learned: Option<law::LearnedModel>,
    /// Duration of the search, s.
    pub seconds: f64,
}

impl Answer {
    /// The answer as `docs/json.md` describes it.
    pub fn json(&self) -> String {
        result::json(self)
    }

    /// The answer in words.
    pub fn text(&self) -> String {
        text::text(self)
    }

    /// Detection limits at the places of the user's model.
    fn detection_limits(&self) -> impl Iterator<Item = &DetectionLimit> {
        let all = self.discovery.detection_limits.iter();
        all.filter(|own| !self.added_parts.contains(&own.at))
    }

    /// Residuals of each sensor over frequency, before and after, as SVG.
    pub fn figure(&self) -> String {
        let title = format!("{}: residuals of the model; 0 dB is noise", self.campaign);
        figure::residuals(title, [&self.discovery.before.misfit, &self.discovery.after.misfit]).svg()
    }

    /// The text of the model with the findings; `None` if none of them changes the model.
    pub fn model_text(&self) -> Option<&str> {
        self.model.as_ref().map(|model| &*model.text)
    }

    /// All parameter values of the model with the findings.
    pub fn values(&self) -> &[(String, f64)] {
        &self.discovery.after.named
    }
}

/// A model with effects.
pub(crate) struct ExtendedModel {
    /// Its name.
    pub name: String,
    /// Text of the model file.
    pub text: String,
    /// Path of the model file; `None` before it is written.
    pub file: Option<PathBuf>,
}

impl ExtendedModel {
    fn file_name(&self) -> String {
        format!("{}.axle", self.name)
    }

    /// Stores the path that the model file will have.
    fn place(&mut self, folder: &Path) {
        self.file = Some(folder.join(self.file_name()));
    }

    fn write(&self, folder: &Path) -> Result<(), InputError> {
        put(folder, &self.file_name(), &self.text)
    }
}

/// The files of a search.
const RESULTS: Results = Results {
    record: "discovery.json",
    names: ["/model", "/campaign"],
    between: "for",
    files: &["parameters.toml", "gap.svg"],
};

/// Checks that a search for what a model lacks in a campaign replaces only results of its own.
///
/// # Errors
/// Fails as [`Results::check`] does.
pub(crate) fn check_folder(folder: &Path, model: &str, campaign: &str) -> Result<(), InputError> {
    let extended = format!("{model}_");
    let is_model = |name: &str| {
        let begins = name.starts_with(&extended) || name.starts_with(law::FILE);
        begins && name.ends_with(".axle")
    };
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut models: Vec<PathBuf> = files
        .filter(|file| file.file_name().to_str().is_some_and(is_model))
        .map(|file| file.path())
        .collect();
    models.sort();
    RESULTS.check(
        folder,
        [model, campaign],
        models.into_iter().chain(unfinished::foreign(folder)),
    )
}

/// Parses factors on the assumptions of the search.
fn multiplied(text: &str) -> Result<Numbers, String> {
    let expected = || format!("NAME=FACTOR is expected, NAME one of {}", Numbers::NAMES.join(", "));
    text.split(',').try_fold(Numbers::default(), |numbers, part| {
        let (name, factor) = part.split_once('=').ok_or_else(expected)?;
        let factor: f64 = factor.parse().map_err(|_| expected())?;
        numbers.with(name, factor).ok_or_else(expected)
    })
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let numbers = arguments.assume.clone().unwrap_or_default();
    let (model, out) = (arguments.model.as_deref(), arguments.out.as_deref());
    let mut answer = discover(&arguments.campaign, model, out, numbers)?;
    if let Some(folder) = &arguments.out {
        write(&mut answer, folder)?;
    }
    Ok(match arguments.format {
        Format::Text => prose(&text::text(&answer)),
        Format::Json => result::json(&answer),
    })
}

/// Searches for the effects that the model of the campaign in a folder lacks. The result has the notices of the
/// campaign.
///
/// # Errors
/// Fails if the campaign cannot be read or has no data for the model, or if the model does not compile.
pub fn discover(folder: &Path, model: Option<&str>, out: Option<&Path>, numbers: Numbers) -> Result<Answer, Failure> {
    let campaign = Campaign::open(folder)?;
    let mut answer = answer(&campaign, model, out, numbers)?;
    answer.evidence.notices.splice(0..0, campaign.notices);
    Ok(answer)
}

/// Searches for the effects that the model of a campaign lacks. If it is stopped, it writes its intermediate results to
/// `out`.
///
/// # Errors
/// Fails if the campaign has no data for the model, or if the model does not compile.
pub(crate) fn answer(
    campaign: &Campaign,
    model: Option<&str>,
    out: Option<&Path>,
    numbers: Numbers,
) -> Result<Answer, Failure> {
    let start = Instant::now();
    let bench = Bench::of_campaign(campaign, model)?;
    let base_model = bench.model().about().name.to_string();
    if let Some(folder) = out {
        check_folder(folder, &base_model, &campaign.name)?;
    }
    check_campaign(bench.model().about(), campaign)?;
    if kc::has_curves(campaign) {
        // A curve in a wrong unit would look like a missing effect, so the curves are checked first.
        kc::gradients(campaign)?;
    }
    let setting = setting(campaign, bench.model().about())?;
    let outside = campaign_out_of_range(bench.model().about(), campaign);
    let showing = Showing::new();
    showing.step(format!("{}: reading", campaign.name));
    let mut evidence = Evidence::from_campaign(campaign, bench.model().about())?;
    evidence.numbers = numbers;
    let bench = bench.measured(&evidence);
    let base_explanation = OnceLock::new();
    let on_update = |update: Update<'_>| match update {
        Update::Step(what) => showing.step(format!("{}: {what}", campaign.name)),
        Update::Done(done, of) => showing.count(done, of),
        Update::Interim(what, findings, explanation) => {
            let before = base_explanation.get_or_init(|| explanation.clone());
            if let Some(folder) = out {
                let files = unfinished::files(&campaign.name, &bench, findings, [before, explanation]);
                leave(&unfinished::folder(folder), files);
            }
            // Last, so that a search which is stopped after this line has left its files.
            note(what);
        }
    };
    let discovery = select::discover(Box::new(bench.clone()), &setting, &mut evidence, &on_update);
    drop(showing);
    out.inspect(|folder| leave(folder, Vec::new()));
    let discovery =
        discovery.map_err(|error| Failure::Input(format!("{}: {error}\n", campaign.manifest().display())))?;
    let of_sensors = notices::of_sensors(&discovery, &evidence, bench.model().about());
    evidence.notices.extend(of_sensors);
    let errors = discovery.findings.iter().flat_map(|finding| {
        let signals = extended(&bench, finding).map_or_else(Vec::new, |patched| patched.signals);
        signals.into_iter().map(move |error| (finding, error))
    });
    let of_sides = errors.filter_map(|(finding, error)| wrong_side(finding, &error, campaign));
    evidence.notices.extend(of_sides);
    evidence.notices.extend(notices::on_ranges(&discovery, campaign));
    evidence.notices.extend(outside);
    // Without sweeps that the model can be compared with, there are no places.
    let [before, after] = [0, 1].map(|of| with_nuisances(bench.clone(), &discovery.nuisances[of]));
    let sweeps = Sweeps::new(before.model(), &discovery.before.refit, &evidence).unwrap_or_default();
    Ok(Answer {
        added_parts: added_parts(bench.checked(), before.checked()),
        base: before.checked().clone(),
        sweeps,
        units: units(after.clone(), &discovery),
        learned: (discovery.learned.as_ref()).and_then(|learned| law::learned_model(before, learned)),
        model: found(after, &discovery, &evidence),
        campaign: campaign.name.clone(),
        base_model,
        evidence,
        discovery,
        seconds: start.elapsed().as_secs_f64(),
    })
}

/// Parameters of the campaign, and further parameters of the model that may be estimated, such as those of an effect
/// that it already has.
///
/// # Errors
/// Fails as [`bound`] does.
fn setting(campaign: &Campaign, about: &About) -> Result<Setting, InputError> {
    let mut parameters = campaign.parameters.clone();
    parameters.extend(own(about, campaign));
    bound(&mut parameters, about, campaign)?;
    Ok(given(&parameters, campaign))
}

/// Names of the links and coordinates of a model that another one lacks.
fn added_parts(lacking: &Checked, model: &Checked) -> Vec<String> {
    let parts = |of: &Checked| -> Vec<String> {
        let links = of.links.iter().map(|own| own.name.clone());
        links.chain(of.coordinates.iter().map(|own| own.name.clone())).collect()
    };
    let known = parts(lacking);
    parts(model).into_iter().filter(|own| !known.contains(own)).collect()
}

/// The bench with nuisance effects added to its model. They apply, since they have been fitted.
fn with_nuisances(bench: Bench, nuisances: &[Finding]) -> Bench {
    nuisances.iter().fold(bench, |bench, own| {
        let patched = extended(&bench, own).expect("what was fitted applies");
        bench.holding(patched.model)
    })
}

/// The model of the bench with a finding added; `None` if the finding does not apply.
fn extended(bench: &Bench, finding: &Finding) -> Option<Patched> {
    bench.patched(&finding.effect, &finding.at, finding.form.as_deref())
}

/// The units of the parameters of each finding. The findings are added one after another, those of each alternative of
/// a class to the model with the certain ones.
fn units(mut bench: Bench, discovery: &Discovery) -> Vec<BTreeMap<String, String>> {
    let (certain, alternatives) = discovery.certain_and_alternatives();
    let mut units = units_of(&mut bench, certain);
    for alternative in alternatives {
        units.extend(units_of(&mut bench.clone(), alternative));
    }
    units
}

/// The units of the parameters of findings that are added to the bench one after another.
fn units_of(bench: &mut Bench, findings: &[Finding]) -> Vec<BTreeMap<String, String>> {
    let mut units = Vec::new();
    for finding in findings {
        let patched = extended(bench, finding);
        let own = patched.iter().flat_map(|patched| &patched.parameters);
        units.push(own.map(|own| (own.effect_name.clone(), own.unit.clone())).collect());
        if let Some(patched) = patched.filter(|own| own.signals.is_empty()) {
            *bench = bench.clone().holding(patched.model);
        }
    }
    units
}

/// The model with the findings; `None` unless the verdict is `Found`.
fn found(bench: Bench, discovery: &Discovery, evidence: &Evidence) -> Option<ExtendedModel> {
    let [before, after] = [&discovery.before, &discovery.after].map(|of| of.misfit.judged(evidence));
    let runs = runs_of(evidence.judging());
    let why = format!("Evidence: the RMS residual of {runs} fell from {before:.2} to {after:.2} standard deviations.");
    match discovery.verdict {
        Verdict::Found => patched(bench, &discovery.findings, &why),
        _ => None,
    }
}

/// The model with effects and a sentence on their evidence; `None` if none of them changes the model.
fn patched(mut bench: Bench, findings: &[Finding], why: &str) -> Option<ExtendedModel> {
    let mut written = None;
    for finding in findings {
        let patched = extended(&bench, finding)?;
        if !patched.signals.is_empty() {
            continue;
        }
        let text = patched.text(why);
        bench = bench.holding(patched.model);
        let name = bench.checked().name.clone();
        written = Some(ExtendedModel { name, text, file: None });
    }
    written
}

/// Writes the model file, the parameters and the figure, and removes intermediate results of a stopped search.
///
/// # Errors
/// Fails if the folder cannot be written to.
pub(crate) fn write(answer: &mut Answer, folder: &Path) -> Result<(), Failure> {
    if let Some(model) = &mut answer.model {
        model.place(folder);
    }
    if let Some(learned) = &mut answer.learned {
        learned.place(folder);
    }
    put(folder, "discovery.json", &result::json(answer))?;
    if let Some(model) = &answer.model {
        model.write(folder)?;
    }
    if let Some(learned) = &answer.learned {
        learned.write(folder)?;
    }
    let (campaign, discovery) = (&answer.campaign, &answer.discovery);
    let best = discovery.certain_and_alternatives().1;
    let best = best
        .first()
        .map_or_else(String::new, |own| format!(", {} for one", listed(own)));
    let heading = format!("{campaign}: what explains its runs best{best}");
    put(
        folder,
        "parameters.toml",
        &fitted::parameters(&heading, &discovery.after),
    )?;
    put(folder, "gap.svg", &answer.figure())?;
    unfinished::remove(folder);
    Ok(())
}
