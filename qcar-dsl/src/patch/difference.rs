//! The differences between two models: their parameters, masses, links and equations, line by line.

use std::fmt::{self, Display, Formatter};

use crate::back::equations::{Equation, Sheet};
use crate::back::notation::Notation;
use crate::check::Checked;
use crate::front::print::one_line;
use crate::front::syntax::Statement;
use crate::patch::ModelTree;

/// The differences between two models, under headings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Parameters, derived quantities, masses, links, outputs, equations. Parts without a change are left out.
    pub parts: Vec<Part>,
}

/// The differences under one heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// For example `links`.
    pub heading: &'static str,
    /// First changed and removed lines in the order of the first model, then added ones in that of the second.
    pub changes: Vec<LineChange>,
}

/// A line in which the models differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineChange {
    /// Its name, `z.damper`; of an equation its left side.
    pub name: String,
    /// Its text in the first model; `None` if only the second has it.
    pub before: Option<String>,
    /// Its text in the second model; `None` if only the first has it.
    pub after: Option<String>,
}

/// Names with their lines.
type Lines = Vec<(String, String)>;

/// True if a statement belongs to a part.
type Belongs = fn(&Statement) -> bool;

/// The parts of a text, each with a test of which statements belong to it.
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

/// The differences of the second model from the first. Parts that an option sets to zero count as absent.
pub fn difference(first: &Checked, second: &Checked) -> Difference {
    let (before, after) = (ModelTree::of(first), ModelTree::of(second));
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

/// The statements of a kind, each with its direction.
fn lines(tree: &ModelTree, belongs: Belongs) -> Lines {
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

fn changes(first: &Lines, second: &Lines) -> Vec<LineChange> {
    let find = |lines: &Lines, name: &str| lines.iter().find(|(own, _)| own == name).map(|(_, line)| line.clone());
    let before = first.iter().map(|(name, line)| LineChange {
        name: name.clone(),
        before: Some(line.clone()),
        after: find(second, name),
    });
    let new = second.iter().filter(|(name, _)| find(first, name).is_none());
    let after = new.map(|(name, line)| LineChange {
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
