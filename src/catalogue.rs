//! Models by the name of a shipped one or by the path of a file.

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

/// Compiled into qcar, or while it runs.
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

    /// Checks what the masses are at the values `p` of all parameters.
    ///
    /// # Errors
    /// Every mass that is not above zero.
    pub fn check_inertias(&self, p: &[f64]) -> Result<(), InputError> {
        self.inertias.check(&self.about().name, p)
    }
}

impl Loaded {
    /// What no measurement can tell of the model.
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

/// Those names as a list to choose from.
fn listed() -> String {
    names().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A model that can run.
///
/// # Errors
/// As [`compiled`].
pub fn load(model: &str) -> Result<Loaded, Failure> {
    load_wanted(model, Wanted::Jacobian)
}

/// The same with what is wanted of the responses; a shipped model has all of them.
///
/// # Errors
/// As [`compiled`].
pub fn load_wanted(model: &str, wanted: Wanted) -> Result<Loaded, Failure> {
    let compiled = compiled_wanted(model, wanted)?;
    Ok(match models::find(model) {
        Some(shipped) => Loaded::new(&compiled, Program::Shipped(shipped.model)),
        None => Loaded::file(&compiled),
    })
}

/// A model whose text is at hand.
///
/// # Errors
/// As [`compiled_text`].
pub fn load_text(name: &str, text: &str) -> Result<Loaded, Failure> {
    compiled_text(name, text).map(|compiled| Loaded::file(&compiled))
}

/// The model that the user wants, else the campaign's: a shipped one, or a file relative to the campaign's folder.
///
/// # Errors
/// As [`load`]; a name that is not known is a mistake of the campaign where the user names none. Facts of the vehicle
/// that nobody knows.
pub fn of_campaign(campaign: &Campaign, wanted: Option<&str>) -> Result<Loaded, Failure> {
    let model = load(&named_by(campaign, wanted)?)?;
    check_campaign(model.about(), campaign)?;
    Ok(model)
}

/// All that the compiler derives of the model that the user wants, else of the campaign's.
///
/// # Errors
/// As [`compiled`]; a name that is not known is a mistake of the campaign where the user names none.
pub fn compiled_of_campaign(campaign: &Campaign, wanted: Option<&str>) -> Result<Compiled, Failure> {
    compiled(&named_by(campaign, wanted)?)
}

/// The name or path of the model that the user wants, else of the campaign's.
///
/// # Errors
/// A name that is not known is a mistake of the campaign where the user names none.
pub fn named_by(campaign: &Campaign, wanted: Option<&str>) -> Result<String, Failure> {
    if wanted.is_none() && models::find(&campaign.model).is_none() && !looks_like_a_path(&campaign.model) {
        let (place, found) = (Place::Name("model".into()), format!("`{}`", campaign.model));
        let remedy = format!("choose among {}, or give the path of a file with --model", listed());
        return Err(Problem::new(campaign.manifest(), place, found, "a shipped model", remedy).into());
    }
    Ok(match wanted {
        Some(model) => model.into(),
        None if looks_like_a_path(&campaign.model) => campaign.folder.join(&campaign.model).display().to_string(),
        None => campaign.model.clone(),
    })
}

/// All that the compiler derives of a model.
///
/// # Errors
/// As [`compile`], and a model that the compiler refuses.
pub fn compiled(model: &str) -> Result<Compiled, Failure> {
    compiled_wanted(model, Wanted::Jacobian)
}

/// The same with what is wanted of the responses.
///
/// # Errors
/// As [`compiled`].
pub fn compiled_wanted(model: &str, wanted: Wanted) -> Result<Compiled, Failure> {
    compile(model, wanted)?.map_err(|report| Failure::Input(report.to_string()))
}

/// The same for the text of a model; its family is searched beside the file that `name` would be.
///
/// # Errors
/// A model that the compiler refuses.
pub fn compiled_text(name: &str, text: &str) -> Result<Compiled, Failure> {
    let files = Files::new(Path::new(""));
    let source = Source {
        name: name.into(),
        text: text.into(),
    };
    let load = |asking: &str, written: &str| files.load(asking, written);
    compile_wanted(source, &load, Wanted::Jacobian).map_err(|report| Failure::Input(report.to_string()))
}

/// Compiles a shipped model or a file, with what is wanted of the responses, or gives the compiler's report.
///
/// # Errors
/// A name that is not shipped and is no file, or a file that cannot be read.
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

/// Every member of the family in a file: its options, and what the checks say.
///
/// # Errors
/// A file that cannot be read, or is no family.
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

/// True for what can be no shipped name.
pub fn looks_like_a_path(name: &str) -> bool {
    name.contains(['/', '\\', '.'])
}

fn unknown(model: &str) -> Problem {
    let remedy = format!("choose among {}, or give the path of a file", listed());
    flag(
        "MODEL",
        format!("`{model}`"),
        "a shipped model or a model file",
        &remedy,
    )
}
