//! The README's commands work as printed.

use crate::common::{repository, run_line};
use crate::document::{alike, blocks, commands, words};
use crate::studied::Studied;

#[test]
fn the_commands_of_the_readme_run() {
    let blocks = blocks("README.md");
    let folder = repository();
    let commands: Vec<&str> = blocks.iter().flat_map(commands).collect();
    assert!(commands.len() >= 5, "{commands:?}");
    for command in commands {
        // Its study is that of the next test, and takes as long as all the others.
        if command == "study models/campaigns/axle_c_study --out results" {
            Studied::new("axle_c_study");
            continue;
        }
        let ran = run_line(folder.path(), command);
        assert_eq!(ran.status, 0, "qcar {command}\n{}", ran.stderr);
    }
}

/// The block of the README that shows what a study prints, against what it prints: words alike, numbers within a
/// percent.
#[test]
fn the_summary_of_the_readme_is_that_of_the_study() {
    let blocks = blocks("README.md");
    let shown = blocks
        .iter()
        .find(|block| block.text.starts_with("axle_c_study:"))
        .unwrap();
    let study = Studied::new("axle_c_study");
    let printed = study.said.replace(study.folder.to_str().unwrap(), "results");
    let (shown, printed) = (words(&shown.text), words(&printed));
    assert!(
        alike(&shown, &printed),
        "the README says {shown:?}, the study {printed:?}"
    );
}
