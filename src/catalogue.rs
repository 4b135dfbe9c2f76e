//! Models by the name of a shipped model or by the path of a file.

use std::ops::Deref;
use std::path::Path;

use models::Shipped;
use qcar_dsl::check::Unseen;
use qcar_dsl::check::{Member, check_members};
use qcar_dsl::compile::compile_wanted;
use qcar_dsl::diagnostic::Report;
use qcar_dsl::disk::{Files, compile_file_wanted};
use qcar_dsl::response::Wanted;
use qcar_dsl::schedule::Compiled;
use qcar_dsl::source::Source;
use qcar_machine::Machine;
use qcar_runtime::campaign::Campaign;
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::Model;
use qcar_runtime::spelling;

use crate::failure::{Failure, flag};
use crate::files::read_text;
use crate::inertias::Inertias;
use crate::parameters::check_campaign;

/// A model that can run.
pub struct Loaded {
    program: Program,
    inertias: Inertias,
    unseen: Vec<Unseen>,
}

/// Compiled into qcar, or read at run time.
enum Program {
    Shipped(&'static dyn Model),
    File(Box<Machine>),
}

impl Loaded {
    fn new(compiled: &Compiled, program: Program) -> Self {
        Loaded {
            program,
            inertias: Inertias::of(compiled),
            unseen: compiled.model.unseen().to_vec(),
        }
    }

    fn file(compiled: &Compiled) -> Self {
        Loaded::new(compiled, Program::File(Box::new(Machine::new(compiled))))
    }

    /// Checks the masses at the values `p` of all parameters.
    ///
    /// # Errors
    /// Fails with every mass that is not positive.
    pub fn check_inertias(&self, p: &[f64]) -> Result<(), InputError> {
        self.inertias.check(&self.about().name, p)
    }
}

impl Loaded {
    /// Warnings on parameters that no measurement determines.
    pub fn unseen(&self) -> &[Unseen] {
        &self.unseen
    }
}

impl Deref for Loaded {
    type Target = dyn Model;

    fn deref(&self) -> &Self::Target {
        match &self.program {
            Program::Shipped(model) => *model,
            Program::File(model) => &**model,
        }
    }
}

/// The names of the shipped models, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    models::all().iter().map(|shipped| shipped.name)
}

/// True for the name of a shipped model, false for a path.
pub fn is_shipped(model: &str) -> bool {
    models::find(model).is_some()
}

/// These names as a list, for messages.
fn listed() -> String {
    names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A model that can run.
///
/// # Errors
/// Fails as [`compiled`] does.
pub fn load(model: &str) -> Result<Loaded, Failure> {
    load_wanted(model, Wanted::Jacobian)
}

/// The same with the wanted responses only; a shipped model has all of them.
///
/// # Errors
/// Fails as [`compiled`] does.
pub fn load_wanted(model: &str, wanted: Wanted) -> Result<Loaded, Failure> {
    load_and_compile(model, wanted).map(|(loaded, _)| loaded)
}

/// A model that can run, and the results of the compiler with the wanted responses only.
///
/// # Errors
/// Fails as [`compiled`] does.
pub fn load_and_compile(model: &str, wanted: Wanted) -> Result<(Loaded, Compiled), Failure> {
    let compiled = compiled_wanted(model, wanted)?;
    let loaded = match models::find(model) {
        Some(shipped) => Loaded::new(&compiled, Program::Shipped(shipped.model)),
        None => Loaded::file(&compiled),
    };
    Ok((loaded, compiled))
}

/// A model from its text.
///
/// # Errors
/// Fails as [`compiled_text`] does.
pub fn load_text(name: &str, text: &str) -> Result<Loaded, Failure> {
    compiled_text(name, text).map(|compiled| Loaded::file(&compiled))
}

/// The model of the user, otherwise that of the campaign: a shipped model, or a file relative to the folder of the
/// campaign, with the wanted responses only.
///
/// # Errors
/// Fails as [`load`] and [`check_campaign`] do. An unknown name is reported in the campaign if it comes from there.
pub fn of_campaign(campaign: &Campaign, model: Option<&str>, wanted: Wanted) -> Result<Loaded, Failure> {
    let model = load_wanted(&named_by(campaign, model)?, wanted)?;
    check_campaign(model.about(), campaign)?;
    Ok(model)
}

/// The results of the compiler for the model of the user, otherwise that of the campaign, with the wanted responses
/// only.
///
/// # Errors
/// Fails as [`compiled`] does. An unknown name is reported in the campaign if it comes from there.
pub fn compiled_of_campaign(campaign: &Campaign, model: Option<&str>, wanted: Wanted) -> Result<Compiled, Failure> {
    compiled_wanted(&named_by(campaign, model)?, wanted)
}

/// Name or path of the model of the user, otherwise that of the campaign.
///
/// # Errors
/// Fails if the name is unknown, reported in the campaign if it comes from there.
pub fn named_by(campaign: &Campaign, wanted: Option<&str>) -> Result<String, Failure> {
    if wanted.is_none() && models::find(&campaign.model).is_none() && !looks_like_a_path(&campaign.model) {
        let (place, found) = (Place::Name("model".into()), format!("`{}`", campaign.model));
        let remedy = format!(
            "{}choose among {}, or give a model file, such as `model = \"{}.axle\"`, relative to the folder of the campaign",
            suggestion(&campaign.model),
            listed(),
            campaign.model
        );
        return Err(Problem::new(
            campaign.manifest(),
            place,
            found,
            "a shipped model or a model file",
            remedy,
        )
        .into());
    }
    Ok(match wanted {
        Some(model) => model.into(),
        None if looks_like_a_path(&campaign.model) => campaign.folder.join(&campaign.model).display().to_string(),
        None => campaign.model.clone(),
    })
}

/// All results of the compiler for a model.
///
/// # Errors
/// Fails as [`compile`] does, or if the model does not compile.
pub fn compiled(model: &str) -> Result<Compiled, Failure> {
    compiled_wanted(model, Wanted::Jacobian)
}

/// The same with the wanted responses only.
///
/// # Errors
/// Fails as [`compiled`] does.
pub fn compiled_wanted(model: &str, wanted: Wanted) -> Result<Compiled, Failure> {
    compile(model, wanted)?.map_err(|report| Failure::Input(report.to_string()))
}

/// The same from the text of a model; its family is looked for in the folder of `name`.
///
/// # Errors
/// Fails if the model does not compile.
pub fn compiled_text(name: &str, text: &str) -> Result<Compiled, Failure> {
    let files = Files::new(Path::new(""));
    let source = Source {
        name: name.into(),
        text: text.into(),
    };
    let load = |asking: &str, written: &str| files.load(asking, written);
    compile_wanted(source, &load, Wanted::Jacobian).map_err(|report| Failure::Input(report.to_string()))
}

/// Compiles a shipped model or a file with the wanted responses, or gives the report of the compiler.
///
/// # Errors
/// Fails if a name is neither shipped nor a file, or if the file cannot be read.
pub fn compile(model: &str, wanted: Wanted) -> Result<Result<Compiled, Report>, Failure> {
    match models::find(model) {
        Some(shipped) => Ok(compile_shipped(shipped, wanted)),
        None if looks_like_a_path(model) => {
            let from_disk = compile_file_wanted(Path::new(""), model, wanted).map_err(|reason| {
                let remedy = "correct the path, put the file there, or save it as UTF-8";
                Problem::new(Path::new(model), Place::File, reason, "a model file", remedy)
            })?;
            Ok(from_disk.compiled)
        }
        None => Err(unknown(model).into()),
    }
}

/// Every member of the family in a file: its options, and the result of the checks.
///
/// # Errors
/// Fails if the file cannot be read or is no family.
pub fn members(file: &str) -> Result<Vec<Member>, Failure> {
    let text = read_text(Path::new(file))?;
    let source = Source {
        name: file.into(),
        text,
    };
    check_members(source, &|_, path| {
        Err(format!("a family loads no other file, such as {path}"))
    })
    .map_err(|report| Failure::Input(report.to_string()))
}

fn compile_shipped(shipped: &Shipped, wanted: Wanted) -> Result<Compiled, Report> {
    let source = Source {
        name: shipped.file.into(),
        text: shipped.text.into(),
    };
    let family = |_: &str, written: &str| {
        let family = shipped.families.iter().find(|(path, _)| *path == written);
        let (path, text) = family.ok_or("it is not shipped with the model")?;
        Ok(Source {
            name: path.to_string(),
            text: text.to_string(),
        })
    };
    compile_wanted(source, &family, wanted)
}

/// True for a string that cannot be the name of a shipped model.
pub fn looks_like_a_path(name: &str) -> bool {
    name.contains(['/', '\\', '.'])
}

/// The shipped model with the nearest name as a question, or nothing.
fn suggestion(model: &str) -> String {
    let nearest = spelling::nearest(model, names());
    nearest.map_or(String::new(), |own| format!("did you mean `{own}`? Otherwise "))
}

fn unknown(model: &str) -> Problem {
    let remedy = format!(
        "{}choose among {}, or give the path of a file",
        suggestion(model),
        listed()
    );
    flag(
        "MODEL",
        format!("`{model}`"),
        "a shipped model or a model file",
        &remedy,
    )
}
