//! A first scan of the text, before the Rust lexer. That lexer refuses the whole file at the first foreign character or
//! bracket, so this scan reports each of them.

use crate::diagnostic::{Code, Diagnostic, reading};
use crate::source::{Source, Span};

/// Brackets nested deeper than this are refused, since the lexer and all that follow recurse.
const DEEPEST: usize = 64;

/// Numbers with more digits than this are refused, since the time to read one grows with the square of its length. No
/// 64-bit number needs more digits.
const LONGEST_NUMBER: usize = 1100;

/// Finds everything that the lexer would refuse.
pub fn scan(source: &Source, index: u16) -> Vec<Diagnostic> {
    let mut scan = Scan {
        source,
        index,
        open: vec![],
        foreign: vec![],
        found: vec![],
    };
    scan.run();
    scan.found
}

struct Scan<'a> {
    source: &'a Source,
    index: u16,
    open: Vec<(u32, char)>,
    /// Foreign characters of the current line.
    foreign: Vec<(Span, char)>,
    found: Vec<Diagnostic>,
}

impl Scan<'_> {
    fn run(&mut self) {
        let text = self.source.text.as_str();
        let mut at = 0;
        // Stops after a bracket that is nested too deeply, since each bracket inside it would be reported again.
        while let Some(character) = text[at..].chars().next().filter(|_| self.open.len() <= DEEPEST) {
            let rest = &text[at..];
            at += match character {
                '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
                '/' if rest.starts_with("/*") => self.comment(at, rest),
                '"' => self.sentence(at, rest),
                '0'..='9' => self.number(at, rest),
                _ => self.character(at, character),
            };
        }
        self.end_line();
        let commented_out = self.found.iter().any(|found| found.code == Code::UnclosedComment);
        if !commented_out && self.open.len() <= DEEPEST {
            let open = std::mem::take(&mut self.open);
            open.into_iter().for_each(|bracket| self.unclosed(bracket));
        }
    }

    fn span(&self, start: u32, length: usize) -> Span {
        Span {
            source: self.index,
            start,
            end: start + length as u32,
        }
    }

    /// The length of a sentence with its quotes, bytes.
    fn sentence(&mut self, at: usize, rest: &str) -> usize {
        let mut escaped = false;
        for (offset, character) in rest.char_indices().skip(1) {
            match character {
                '\n' => break,
                '"' if !escaped => return offset + 1,
                _ => escaped = character == '\\' && !escaped,
            }
        }
        let line = rest.lines().next().unwrap_or(rest);
        let span = self.span(at as u32, line.len());
        self.found.push(reading::unterminated_text(span, line));
        line.len().max(1)
    }

    /// The length of a comment with its marks, bytes.
    fn comment(&mut self, at: usize, rest: &str) -> usize {
        block_comment(rest).unwrap_or_else(|| {
            self.found.push(reading::unclosed_comment(self.span(at as u32, 2)));
            rest.len()
        })
    }

    /// The length of a sequence of digits, bytes.
    fn number(&mut self, at: usize, rest: &str) -> usize {
        let is_digit = |byte: &u8| byte.is_ascii_digit() || *byte == b'_';
        let length = rest.bytes().take_while(is_digit).count();
        if length > LONGEST_NUMBER {
            self.found
                .push(reading::number_too_long(self.span(at as u32, length), length));
        }
        length
    }

    fn character(&mut self, at: usize, character: char) -> usize {
        let length = character.len_utf8();
        match character {
            '\n' => self.end_line(),
            '(' | '[' | '{' => self.open(at as u32, character),
            ')' | ']' | '}' => self.close(at as u32, character),
            _ if is_foreign(character) => self.foreign.push((self.span(at as u32, length), character)),
            _ => {}
        }
        length
    }

    fn open(&mut self, at: u32, character: char) {
        if self.open.len() == DEEPEST {
            self.found.push(reading::nested_too_deep(self.span(at, 1)));
        }
        self.open.push((at, character));
    }

    fn close(&mut self, at: u32, character: char) {
        match self.open.last().copied() {
            Some((_, open)) if closing(open) == character => {
                self.open.pop();
            }
            Some((place, open)) => match self.open.iter().rposition(|(_, open)| closing(*open) == character) {
                // If it closes an outer bracket, the closing brackets of the inner ones are missing.
                Some(outer) => {
                    let inner = self.open.split_off(outer + 1);
                    self.open.pop();
                    inner.into_iter().for_each(|bracket| self.unclosed(bracket));
                }
                None => {
                    let expected = Some((self.span(place, 1), closing(open)));
                    self.found
                        .push(reading::stray_bracket(self.span(at, 1), character, expected));
                }
            },
            None => self
                .found
                .push(reading::stray_bracket(self.span(at, 1), character, None)),
        }
    }

    fn unclosed(&mut self, (at, open): (u32, char)) {
        self.found
            .push(reading::unclosed_bracket(self.span(at, 1), open, closing(open)));
    }

    fn end_line(&mut self) {
        let foreign = std::mem::take(&mut self.foreign);
        if let Some((first, _)) = foreign.first() {
            let line: String = self.source.line(first.start).chars().map(in_ascii).collect();
            self.found.push(reading::foreign_characters(&foreign, &line));
        }
    }
}

/// The length of a comment that may contain others, bytes; `None` if it does not end.
fn block_comment(rest: &str) -> Option<usize> {
    let mut depth = 0;
    let mut at = 0;
    while at < rest.len() {
        let tail = &rest.as_bytes()[at..];
        if tail.starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else if tail.starts_with(b"*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return Some(at);
            }
        } else {
            at += 1;
        }
    }
    None
}

fn closing(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

fn is_foreign(character: char) -> bool {
    !character.is_ascii()
        || matches!(character, '\'' | '`' | '\\' | '#' | '$' | '@' | '~' | '?')
        || (character.is_ascii_control() && !character.is_ascii_whitespace())
}

/// What to write instead of a character; empty if the language has no spelling for it.
fn in_ascii(character: char) -> String {
    let spelled = match character {
        '²' => "^2",
        '³' => "^3",
        '·' | '×' | '⋅' | '∙' => "*",
        '÷' => "/",
        '−' | '–' | '—' => "-",
        '≤' => "<=",
        '≥' => ">=",
        '≠' => "!=",
        '°' => "deg",
        '“' | '”' | '„' => "\"",
        'µ' | 'μ' => "u",
        'α' => "alpha",
        'β' => "beta",
        'γ' => "gamma",
        'δ' | 'Δ' => "delta",
        'ζ' => "zeta",
        'η' => "eta",
        'θ' | 'Θ' => "theta",
        'κ' => "kappa",
        'λ' => "lambda",
        'ν' => "nu",
        'ρ' => "rho",
        'σ' => "sigma",
        'τ' => "tau",
        'φ' | 'Φ' => "phi",
        'ψ' => "psi",
        'ω' | 'Ω' => "omega",
        'π' => "3.141592653589793",
        'ä' => "ae",
        'ö' => "oe",
        'ü' => "ue",
        'ß' => "ss",
        '…' => "..",
        '\u{a0}' | '\u{2009}' | '\u{202f}' => " ",
        _ if is_foreign(character) => "",
        _ => return character.to_string(),
    };
    spelled.to_string()
}
