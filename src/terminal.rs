//! Width and colours of the terminal. In a pipe or a file, lines are not broken and have no colour, unless the
//! environment variable COLUMNS or --color says otherwise.

use std::env;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;

use clap::ValueEnum;
use console::Term;

/// Choice of colours for results and errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal, unless the environment variable NO_COLOR is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// Properties of an output stream.
#[derive(Clone, Copy, Default)]
struct Outlet {
    /// Number of columns; `None` without a limit.
    width: Option<usize>,
    colored: bool,
}

impl Outlet {
    fn of(is_terminal: bool, term: &Term, color: Color) -> Self {
        let stated = env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
        let own = || {
            is_terminal
                .then(|| term.size_checked())
                .flatten()
                .map(|(_, columns)| columns.into())
        };
        let wanted = || {
            env::var_os("NO_COLOR").is_none_or(|no| no.is_empty())
                && env::var_os("TERM").is_none_or(|term| term != "dumb")
        };
        Outlet {
            width: stated.or_else(own).filter(|width| *width >= NARROWEST),
            colored: match color {
                Color::Auto => is_terminal && wanted(),
                Color::Always => true,
                Color::Never => false,
            },
        }
    }

    fn styled(self, style: &str, text: &str) -> String {
        match self.colored {
            true => format!("\u{1b}[{style}m{text}\u{1b}[0m"),
            false => text.into(),
        }
    }

    /// Breaks long lines between words and indents the further ones. Drawings are unchanged.
    fn wrapped(self, text: &str) -> String {
        let Some(width) = self.width else {
            return text.into();
        };
        let lines = text.split_inclusive('\n').map(|line| {
            let is_long = line.trim_end().chars().count() > width;
            if is_long && !line.contains(DRAWN) {
                broken(line, width)
            } else {
                line.into()
            }
        });
        lines.collect()
    }
}

/// First characters of the drawn lines of diagnostics.
const DRAWN: [char; 4] = ['│', '╭', '╰', '┬'];
/// Smallest width.
const NARROWEST: usize = 40;
/// Indent of the further lines of a paragraph.
const INDENT: &str = "  ";

const BOLD: &str = "1";
const RED: &str = "31";
const YELLOW: &str = "33";

/// Standard output and standard error; a library without a terminal writes as for files.
static OUTLETS: OnceLock<[Outlet; 2]> = OnceLock::new();

/// Determines width and colours of each stream. The first call in a process decides.
pub fn detect(color: Color) {
    let out = Outlet::of(std::io::stdout().is_terminal(), &Term::stdout(), color);
    let error = Outlet::of(std::io::stderr().is_terminal(), &Term::stderr(), color);
    let _ = OUTLETS.set([out, error]);
}

fn outlets() -> [Outlet; 2] {
    OUTLETS.get().copied().unwrap_or_default()
}

/// Number of columns of standard output; `None` without a limit.
pub fn width() -> Option<usize> {
    outlets()[0].width
}

/// Heading of a table.
pub fn heading(text: &str) -> String {
    outlets()[0].styled(BOLD, text)
}

/// Sentences and tables for standard output: long sentences are broken, and notices are marked.
pub fn prose(text: &str) -> String {
    let out = outlets()[0];
    let text = out.wrapped(text);
    match out.colored {
        true => text.replace("\nnote: ", &format!("\n{} ", out.styled(YELLOW, "note:"))),
        false => text,
    }
}

/// A path as a word of a printed command: in quotes if a shell would take it apart.
pub fn word(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "._-/+,:@%=\\".contains(c);
    match text.chars().all(is_plain) {
        true => text,
        false => format!("'{}'", text.replace('\'', r"'\''")),
    }
}

/// An error for standard error; the place at the start of each line is marked.
pub fn complaint(text: &str) -> String {
    let error = outlets()[1];
    let marked = |line: &str| match line.split_once(": found ") {
        Some((place, rest)) if error.colored && !line.starts_with(' ') => {
            format!("{}: found {rest}", error.styled(RED, place))
        }
        _ => line.into(),
    };
    let wrapped = error.wrapped(text);
    wrapped.split_inclusive('\n').map(marked).collect()
}

/// Writes notices to standard error, beside a result that has no place for them, such as CSV.
pub fn aside(notices: &str) {
    to_error(&outlets()[1].wrapped(notices));
}

/// Writes to standard error. A reader that has closed the pipe, such as `head`, needs no more of it; `eprint` would panic.
pub fn to_error(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// A line in pieces of at most this number of characters, broken at spaces.
fn broken(line: &str, width: usize) -> String {
    let text = line.trim_end_matches('\n');
    let own_indent = &text[..text.len() - text.trim_start().len()];
    let (mut out, mut length) = (own_indent.to_string(), own_indent.chars().count());
    let mut is_first = true;
    for word in text.trim_start().split(' ') {
        let own = word.chars().count();
        if !is_first && length + 1 + own > width {
            out += &format!("\n{own_indent}{INDENT}");
            length = own_indent.chars().count() + INDENT.len();
        } else if !is_first {
            out.push(' ');
            length += 1;
        }
        out += word;
        length += own;
        is_first = false;
    }
    out + &line[text.len()..]
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{broken, word};

    #[test]
    fn a_path_is_one_word_of_a_command() {
        assert_eq!(word(Path::new("new/rig_1.axle")), "new/rig_1.axle");
        assert_eq!(word(Path::new("my rig")), "'my rig'");
        assert_eq!(word(Path::new("a'b")), r"'a'\''b'");
    }

    #[test]
    fn a_long_line_is_broken_between_words() {
        assert_eq!(broken("note: one two three\n", 10), "note: one\n  two\n  three\n");
        assert_eq!(broken("unbreakable words", 4), "unbreakable\n  words");
        assert_eq!(broken("short\n", 80), "short\n");
        assert_eq!(broken("  - a + b + c\n", 9), "  - a + b\n    + c\n");
    }
}
