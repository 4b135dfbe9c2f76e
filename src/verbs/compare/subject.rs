//! The kind of a comparison: two parameter sets, two models or two campaigns.

use std::path::{Path, PathBuf};

use crate::catalogue;
use crate::failure::{Failure, flag};

/// Two arguments of one kind.
#[derive(Debug, PartialEq)]
pub(super) enum Subject {
    /// Files of parameter values.
    Parameters([PathBuf; 2]),
    /// Models, by name or path.
    Models([String; 2]),
    /// Folders with a campaign.toml.
    Campaigns([PathBuf; 2]),
}

impl Subject {
    /// The kind of two arguments.
    ///
    /// # Errors
    /// Fails if an argument is of no kind or of two kinds, or if the kinds differ.
    pub fn of(first: &str, second: &str) -> Result<Self, Failure> {
        match (one("A", first)?, one("B", second)?) {
            (One::Parameters(a), One::Parameters(b)) => Ok(Subject::Parameters([a, b])),
            (One::Model(a), One::Model(b)) => Ok(Subject::Models([a, b])),
            (One::Campaign(a), One::Campaign(b)) => Ok(Subject::Campaigns([a, b])),
            (a, b) => {
                let found = format!(
                    "`{first}`, which is {}, and `{second}`, which is {}",
                    a.kind(),
                    b.kind()
                );
                let remedy = "compare two parameter files, two models, or two campaigns";
                Err(flag("A and B", found, "two of one kind", remedy).into())
            }
        }
    }

    /// Names of the sides, as the user gave them.
    pub fn names(&self) -> [String; 2] {
        match self {
            Subject::Models(names) => names.clone(),
            Subject::Parameters(paths) | Subject::Campaigns(paths) => {
                paths.each_ref().map(|path| path.display().to_string())
            }
        }
    }
}

enum One {
    Parameters(PathBuf),
    Model(String),
    Campaign(PathBuf),
}

impl One {
    fn kind(&self) -> &'static str {
        match self {
            One::Parameters(_) => "a parameter file",
            One::Model(_) => "a model",
            One::Campaign(_) => "a campaign",
        }
    }
}

const EXPECTED: &str = "a parameter file (.toml, or the fit.json of a fit), a model (.axle, or a shipped name), or a \
                        campaign's folder";

fn one(name: &str, text: &str) -> Result<One, Failure> {
    let path = Path::new(text);
    let wrong = |found: String, remedy: &str| Err(flag(name, found, EXPECTED, remedy).into());
    if path.is_dir() {
        return match (folder(path), catalogue::is_shipped(text)) {
            (Some(_), true) => {
                let remedy = format!("write ./{text} for the folder, or compare from another place");
                wrong(format!("`{text}`, which is a folder and a shipped model"), &remedy)
            }
            (Some(found), false) => Ok(found),
            (None, true) => Ok(One::Model(text.into())),
            (None, false) => {
                let remedy = "name a folder that has one of them, or a file";
                wrong(format!("`{text}`, a folder without campaign.toml or fit.json"), remedy)
            }
        };
    }
    if catalogue::is_shipped(text) {
        return Ok(One::Model(text.into()));
    }
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("axle") => Ok(One::Model(text.into())),
        Some("toml" | "json") => Ok(One::Parameters(path.into())),
        _ if path.exists() => wrong(format!("`{text}`"), "give the file the ending of its kind"),
        _ => wrong(
            format!("`{text}`, which does not exist"),
            "correct the path or the name; `qcar show` lists the models",
        ),
    }
}

/// A campaign, or the result of a fit.
fn folder(path: &Path) -> Option<One> {
    let answer = path.join("fit.json");
    if path.join("campaign.toml").is_file() {
        Some(One::Campaign(path.into()))
    } else {
        answer.is_file().then_some(One::Parameters(answer))
    }
}
