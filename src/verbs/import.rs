//! `qcar import`: a new campaign from measured files.

use std::path::{Path, PathBuf};

use super::inspect::{self, Contents, Look};
use super::new::campaign::{make_head, seen_from};
use crate::catalogue;
use crate::completion;
use crate::failure::{Failure, flag};
use crate::files::{put, write_new};
use crate::terminal::{prose, word};
use clap::Args;
use clap_complete::engine::ArgValueCompleter;

// Parts of a channel's name.
mod tokens;
// Sensor of a channel, from its name and unit.
mod guess;
// The sensors of a campaign.
mod sensors;
// Properties of a sweep, from the motion of its pad.
mod sweep;
// Kind of run of a file.
mod kind;

/// Create a campaign from measured files
///
/// Lists the channels of each file, proposes from name and unit which sensor of the model each is, and recognises the
/// kind of run; for a sweep it also finds the frequencies and the velocity of the pad. A recording with several sweeps,
/// separated by 1.5 s of rest, is split into runs. The new folder has a campaign.toml that says what to fill in. The
/// files stay where they are.
#[derive(Args)]
#[command(
    after_help = "Example:\n  qcar import models/campaigns/axle_a_rig/rig/sweep_025.csv.gz models/campaigns/axle_a_rig/rig/sweep_100.csv.gz --out imported --model axle_a"
)]
pub struct Arguments {
    /// Measured files: MDF, RPC III, UFF 58, TDMS, MAT, .xlsx or text
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The folder to write; it must not exist
    #[arg(long, value_name = "CAMPAIGN")]
    out: PathBuf,
    /// The model to fit: name of a shipped model, or path of a model file
    #[arg(long, default_value = "quarter_car", add = ArgValueCompleter::new(completion::models))]
    model: String,
}

/// A file and its contents.
struct Measured {
    /// Path as the user gave it.
    file: PathBuf,
    /// Path as the campaign must give it.
    seen: String,
    contents: Contents<kind::PadMotion>,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    must_be_new(&arguments.out)?;
    each_once(&arguments.files)?;
    let model = catalogue::load(&arguments.model)?;
    let name = name_of(&arguments.out)?;
    let pads = Look {
        is_in: &|signal| kind::PadMotion::is_in(signal, model.about()),
        take: &|signal| kind::PadMotion::of(signal, model.about()),
    };
    let mut files = Vec::new();
    for file in &arguments.files {
        let contents = Contents::of(file, &pads)?;
        must_have_channels(file, &contents)?;
        files.push(Measured {
            seen: seen_from(&arguments.out, &file.display().to_string(), false),
            contents,
            file: file.clone(),
        });
    }
    let mut proposed = sensors::propose(&files, model.about());
    let runs: Vec<Vec<kind::Proposed>> = files
        .iter()
        .map(|file| kind::propose(file, &proposed, model.about()))
        .collect();
    proposed.take_for_curves(runs.iter().flatten().flat_map(kind::Proposed::channels_of_curve));
    let model_name = seen_from(
        &arguments.out,
        &arguments.model,
        catalogue::is_shipped(&arguments.model),
    );
    let mut text = make_head(&name, &model_name, model.about());
    text += &sensors::sections(&proposed, model.about());
    text += &kind::sections(&runs.iter().flatten().collect::<Vec<_>>());
    write_new(&[&arguments.out], || put(&arguments.out, "campaign.toml", &text))?;
    Ok(prose(&report(arguments, &files, &proposed, &runs)))
}

fn must_have_channels<T>(file: &Path, contents: &Contents<T>) -> Result<(), Failure> {
    if !contents.recording.signals.is_empty() {
        return Ok(());
    }
    let found = format!("{}, a file without channels", file.display());
    let remedy = "export the measured channels too, or leave the file out";
    Err(flag("FILES", found, "files with measured channels", remedy).into())
}

fn must_be_new(folder: &Path) -> Result<(), Failure> {
    match folder.exists() {
        false => Ok(()),
        true => {
            let found = format!("{}, which exists already", folder.display());
            Err(flag(
                "--out",
                found,
                "a folder that does not exist yet",
                "choose another name, or move it away",
            )
            .into())
        }
    }
}

/// # Errors
/// Fails if two paths are those of one file, whose runs would have one name.
fn each_once(files: &[PathBuf]) -> Result<(), Failure> {
    let same = |a: &Path, b: &Path| {
        a == b
            || a.canonicalize()
                .ok()
                .is_some_and(|a| b.canonicalize().is_ok_and(|b| a == b))
    };
    let twice = files
        .iter()
        .enumerate()
        .find(|(at, file)| files[..*at].iter().any(|other| same(other, file)));
    match twice {
        None => Ok(()),
        Some((_, file)) => {
            let found = format!("{} a second time", file.display());
            Err(flag("FILES", found, "each file once", "leave one of them out").into())
        }
    }
}

/// The name of the campaign is that of its folder.
fn name_of(folder: &Path) -> Result<String, Failure> {
    let name = folder.file_name().and_then(|name| name.to_str());
    name.map(String::from).ok_or_else(|| {
        let found = folder.display().to_string();
        flag(
            "--out",
            found,
            "the path of a new folder",
            "write a name such as `rig_front`",
        )
        .into()
    })
}

fn report(
    arguments: &Arguments,
    files: &[Measured],
    proposed: &sensors::Sensors,
    runs: &[Vec<kind::Proposed>],
) -> String {
    let mut text = String::new();
    for (file, runs) in files.iter().zip(runs) {
        text += &format!("{}: {}\n", file.file.display(), inspect::text(&file.contents));
        text.extend(runs.iter().map(|run| format!("taken for {}\n", run.description())));
        text += "\n";
    }
    text += &sensors::table(proposed);
    text += &format!(
        "\n{}/campaign.toml written. Now\n1. read it from top to bottom, and fill in every line marked `give yours`\n",
        arguments.out.display()
    );
    let out = word(&arguments.out);
    text += &format!("2. qcar check {out}\n3. qcar fit {out}\n");
    text
}
