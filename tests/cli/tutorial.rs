//! The tutorial, done as it says: its commands, its edits, and what it shows of their results.

use std::fs;
use std::path::Path;

use crate::common::{Ran, repository, run_line};
use crate::document::{Block, alike, blocks, commands, words};

/// Up to what takes a search.
#[test]
fn the_tutorial_begins_as_it_says() {
    let blocks = blocks("docs/tutorial.md");
    let searches = |block: &Block| commands(block).iter().any(|command| command.starts_with("discover "));
    let first = blocks.iter().position(searches).unwrap();
    assert!(first > 10, "the search is block {first}");
    follow(&blocks[..first], repository().path());
}

#[test]
#[ignore = "two whole searches; .ci/run runs it"]
fn the_tutorial_leads_where_it_says() {
    let folder = repository();
    follow(&blocks("docs/tutorial.md"), folder.path());
    for written in ["found/gap.svg", "rig_study/report.html", "my_axle.fmu"] {
        assert!(folder.path().join("mine").join(written).exists(), "{written}");
    }
}

/// Does what the blocks say, and looks whether it shows what they say.
fn follow(blocks: &[Block], folder: &Path) {
    let mut last = None;
    for (index, block) in blocks.iter().enumerate() {
        match block.kind.as_str() {
            "diff" => edit(folder, &block.text),
            "text" => shows(last.as_ref().unwrap(), &block.text),
            _ => {
                let refused = blocks.get(index + 1).is_some_and(shows_refusal);
                for command in commands(block) {
                    let ran = run_line(folder, command);
                    assert_eq!(ran.status != 0, refused, "qcar {command}\n{}", ran.stderr);
                    last = Some(ran);
                }
            }
        }
    }
}

fn shows_refusal(block: &Block) -> bool {
    let is_refusal = |said: &str| block.text.contains(said);
    block.kind == "text" && ["refused", "cannot be fitted"].into_iter().any(is_refusal)
}

/// Each line that is shown has been printed.
fn shows(ran: &Ran, shown: &str) {
    let all = ran.stdout.clone() + &ran.stderr;
    let printed: Vec<Vec<&str>> = all.lines().map(words).collect();
    for line in shown.lines() {
        let said = printed.iter().any(|printed| alike(&words(line), printed));
        assert!(said, "`{line}` is not in\n{all}");
    }
}

/// Takes out the lines with `-` and puts in those with `+`, where they and those with a space stand, which is one
/// place.
fn edit(folder: &Path, diff: &str) {
    let (head, hunks) = diff.split_once('\n').unwrap();
    let file = folder.join(head.strip_prefix("--- ").unwrap());
    let mut text = fs::read_to_string(&file).unwrap();
    for hunk in hunks.split("@@\n") {
        let (before, after) = (side(hunk, '-'), side(hunk, '+'));
        assert_eq!(text.matches(&before).count(), 1, "{before}");
        text = text.replace(&before, &after);
    }
    fs::write(file, text).unwrap();
}

/// The lines of a hunk that stand before (`-`) or after (`+`) it.
fn side(hunk: &str, sign: char) -> String {
    let lines = hunk.lines().filter_map(|line| line.strip_prefix([sign, ' ']));
    lines.map(|line| format!("{line}\n")).collect()
}
