//! The differences between two models: their parameters, masses, links and equations, line by line.

use std::fmt::{self, Display, Formatter};

use crate::back::equations::{Equation, Sheet};
use crate::back::notation::Notation;
use crate::check::Checked;
use crate::front::print::one_line;
use crate::front::syntax::Statement;
use crate::patch::Base;

/// In what a model differs from another, under headings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Parameters, derived quantities, masses, links, what is seen, equations. Parts without a change are left out.
    pub parts: Vec<Part>,
}

/// What changes under a heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// For example `links`.
    pub heading: &'static str,
    /// First what changes or goes, in the order of the first model, then what comes, in that of the second.
    pub changes: Vec<Changed>,
}

/// Something that the models do not have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Changed {
    /// Its name, `z.damper`; of an equation its left side.
    pub name: String,
    /// In the first model.
    pub before: Option<String>,
    /// In the second model.
    pub after: Option<String>,
}

/// Names with their lines.
type Lines = Vec<(String, String)>;

/// Whether a statement belongs to a part.
type Belongs = fn(&Statement) -> bool;

/// The parts of a text, with what belongs to them.
const PARTS: [(&str, Belongs); 5] = [
    ("parameters", |statement| matches!(statement, Statement::Parameter(_))),
    ("derived quantities", |statement| matches!(statement, Statement::Let(_))),
    ("masses and points", |statement| {
        matches!(statement, Statement::Coordinate(_))
    }),
    ("links", |statement| matches!(statement, Statement::Link(_))),
    ("outputs and channels", |statement| {
        matches!(statement, Statement::Output(..) | Statement::Channel(..))
    }),
];

/// In what the second model differs from the first. What is zero by an option counts as absent.
pub fn difference(first: &Checked, second: &Checked) -> Difference {
    let (before, after) = (Base::of(first), Base::of(second));
    let texts = PARTS.map(|(heading, belongs)| Part {
        heading,
        changes: changes(&lines(&before, belongs), &lines(&after, belongs)),
    });
    let equations = Part {
        heading: "equations",
        changes: changes(&equations(first), &equations(second)),
    };
    let parts = texts.into_iter().chain([equations]);
    Difference {
        parts: parts.filter(|part| !part.changes.is_empty()).collect(),
    }
}

/// True where two models have the same equations, however their links are written.
pub fn moves_alike(first: &Checked, second: &Checked) -> bool {
    changes(&equations(first), &equations(second)).is_empty()
}

/// The statements of a kind, each with the direction that it stands in.
fn lines(tree: &Base, belongs: Belongs) -> Lines {
    let outside = tree.axle.body.iter().map(|statement| (String::new(), statement));
    let inside = tree.directions().flat_map(|direction| {
        let home = format!("{}.", direction.name.text);
        direction.body.iter().map(move |statement| (home.clone(), statement))
    });
    let all = outside.chain(inside).filter(|(_, statement)| belongs(statement));
    let named = all.map(|(home, statement)| match statement {
        Statement::Parameter(own) => (own.name.text.clone(), one_line(statement)),
        Statement::Output(None, signal) => (format!("{home}{signal}"), one_line(statement)),
        _ => {
            let name = statement.name().map_or("", |name| name.text.as_str());
            (format!("{home}{name}"), one_line(statement))
        }
    });
    named.collect()
}

fn changes(first: &Lines, second: &Lines) -> Vec<Changed> {
    let find = |lines: &Lines, name: &str| lines.iter().find(|(own, _)| own == name).map(|(_, line)| line.clone());
    let before = first.iter().map(|(name, line)| Changed {
        name: name.clone(),
        before: Some(line.clone()),
        after: find(second, name),
    });
    let new = second.iter().filter(|(name, _)| find(first, name).is_none());
    let after = new.map(|(name, line)| Changed {
        name: name.clone(),
        before: None,
        after: Some(line.clone()),
    });
    before
        .chain(after)
        .filter(|change| change.before != change.after)
        .collect()
}

fn equations(model: &Checked) -> Lines {
    let sheet = Sheet::new(model, Notation::Text);
    let motion = sheet.motion.into_iter().flat_map(|(_, equations)| equations);
    let standing = motion
        .chain(sheet.inner)
        .chain(sheet.names)
        .map(|equation| written("", equation));
    let rolling = sheet
        .rolling
        .into_iter()
        .map(|equation| written("while the tyre rolls: ", equation));
    standing.chain(rolling).collect()
}

fn written(when: &str, Equation { left, right }: Equation) -> (String, String) {
    (format!("{when}{left}"), format!("{when}{left} = {}", right.join(" ")))
}

impl Display for Difference {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        if self.parts.is_empty() {
            return writeln!(f, "no difference");
        }
        for (index, part) in self.parts.iter().enumerate() {
            f.write_str(if index > 0 { "\n" } else { "" })?;
            writeln!(f, "{}", part.heading)?;
            for change in &part.changes {
                change.before.iter().try_for_each(|line| writeln!(f, "  - {line}"))?;
                change.after.iter().try_for_each(|line| writeln!(f, "  + {line}"))?;
            }
        }
        Ok(())
    }
}
