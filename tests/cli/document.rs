//! What documents say of the command line: its commands, and what they print.

use std::fs;
use std::path::Path;

/// What stands in the documents for the installed program.
const FROM_SOURCE: &str = "cargo run --release -- ";

/// A fenced block of a document: the word behind the fence, and the lines.
pub struct Block {
    /// `sh`, `diff`, ... or nothing.
    pub kind: String,
    /// What stands in it.
    pub text: String,
}

/// The fenced blocks of a document of the repository, in their order.
pub fn blocks(document: &str) -> Vec<Block> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(document)).unwrap();
    let fenced = text.split("\n```").skip(1).step_by(2);
    fenced
        .map(|block| {
            let (kind, text) = block.split_once('\n').unwrap();
            Block {
                kind: kind.into(),
                text: text.into(),
            }
        })
        .collect()
}

/// The arguments of each `qcar` in a shell block, in their order.
pub fn commands(block: &Block) -> Vec<&str> {
    if block.kind != "sh" {
        return Vec::new();
    }
    let lines = block.text.lines();
    lines
        .filter_map(|line| line.strip_prefix(FROM_SOURCE).or(line.strip_prefix("qcar ")))
        .collect()
}

/// The words of a text, without what only separates them.
pub fn words(text: &str) -> Vec<&str> {
    text.split_whitespace().map(|word| word.trim_end_matches(',')).collect()
}

/// Whether the same is said: words alike, numbers within a percent.
pub fn alike(shown: &[&str], printed: &[&str]) -> bool {
    let same = |(shown, printed): (&&str, &&str)| match (shown.parse::<f64>(), printed.parse::<f64>()) {
        (Ok(shown), Ok(printed)) => (shown - printed).abs() <= 0.051 + 0.01 * printed.abs(),
        _ => shown == printed,
    };
    shown.len() == printed.len() && shown.iter().zip(printed).all(same)
}
