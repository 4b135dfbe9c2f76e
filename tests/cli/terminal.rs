//! What a terminal shows: lines that fit, colour where it is wanted, words that complete.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::repository;
use crate::far_starts::write_with_stop;
use crate::studied::{COLUMNS, Studied};

/// Runs `qcar` with variables of the environment.
fn run(folder: &Path, variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_qcar"))
        .args(arguments)
        .env_remove("NO_COLOR")
        .env_remove("COLUMNS")
        .envs(variables.iter().copied())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// What prints for people, on shipped models and campaigns.
const PRINTS: &[&str] = &[
    "show",
    "check",
    "check models/campaigns/axle_a_rig",
    "inspect models/campaigns/axle_a_rig/rig/sweep_025.csv.gz",
    "matrices axle_d --params tests/data/axle_d.toml",
    "frf axle_a --params models/campaigns/axle_a_rig --frequencies 1:20:5",
    "diff axle_c axle_f",
    "effects",
    "effects axle_c",
    "effects segmented_polynomial_damper",
    "kc models/campaigns/axle_a_rig",
    "fit models/campaigns/axle_a_rig --out out/fit",
    "simulate models/campaigns/axle_a_rig",
    "simulate models/campaigns/silverbox",
    "sensitivity models/campaigns/axle_a_rig --sobol 200",
    "sensitivity models/campaigns/axle_a_rig --list",
    "compare models/campaigns/axle_a_rig/campaign.toml models/campaigns/axle_a_rig/truth.toml --campaign models/campaigns/axle_a_rig",
    "score models/campaigns/axle_a_rig",
    "import models/recordings/sweep_low.mf4 models/recordings/sweep_high.mf4 --out out/imported",
    "new axle my_axle",
    "new campaign my_rig",
    "new template vehicle.xlsx",
    "export quarter_car --as csv --out out/quarter_car.csv",
];

#[test]
fn no_line_is_wider_than_the_terminal() {
    let folder = repository();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    std::os::unix::fs::symlink(data, folder.path().join("tests")).unwrap();
    let searched = folder.path().join("searched");
    fs::create_dir(&searched).unwrap();
    write_with_stop(&searched);
    for line in PRINTS.iter().chain(&["discover searched"]) {
        prints(folder.path(), line);
    }
    for (verb, made) in [("study", Studied::new("axle_c_study")), ("target", Studied::targets())] {
        fits(verb, &made.said.replace(made.folder.to_str().unwrap(), "results"));
    }
}

#[test]
#[ignore = "a whole search; .ci/run runs it"]
fn no_line_of_a_search_on_a_rig_is_wider_than_the_terminal() {
    prints(repository().path(), "discover models/campaigns/axle_c_study");
}

/// Asserts that all which a command line prints fits.
#[track_caller]
fn prints(folder: &Path, line: &str) {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let ran = run(folder, &[("COLUMNS", "100")], &arguments);
    assert!(
        ran.status.code().is_some_and(|code| code < 2),
        "qcar {line}\n{}",
        text(&ran.stderr)
    );
    fits(line, &text(&ran.stdout));
}

#[track_caller]
fn fits(line: &str, printed: &str) {
    let wide = printed.lines().find(|line| line.chars().count() > COLUMNS);
    assert!(wide.is_none(), "qcar {line}\n{}", wide.unwrap_or_default());
}

#[test]
fn complaints_are_broken_between_words() {
    let folder = repository();
    let arguments = ["frf", "axle_a", "--set", "k_tire=1"];
    let ran = run(folder.path(), &[("COLUMNS", "100")], &arguments);
    let (broken, whole) = (text(&ran.stderr), text(&run(folder.path(), &[], &arguments).stderr));
    assert!(broken.lines().all(|line| line.chars().count() <= COLUMNS), "{broken}");
    let words = |text: &str| text.split_whitespace().map(String::from).collect::<Vec<_>>();
    assert_eq!(words(&broken), words(&whole));
}

#[test]
fn a_pipe_gets_whole_lines_without_colour() {
    let folder = repository();
    let whole = text(&run(folder.path(), &[], &["effects"]).stdout);
    assert!(whole.lines().any(|line| line.chars().count() > COLUMNS) && !whole.contains('\u{1b}'));
}

#[test]
fn colour_is_as_it_was_asked_for() {
    let folder = repository();
    let colored = |variables: &[(&str, &str)], arguments: &[&str]| {
        run(folder.path(), variables, arguments).stdout.contains(&0x1b)
    };
    assert!(colored(&[], &["show", "--color", "always"]));
    assert!(colored(&[("NO_COLOR", "1")], &["show", "--color", "always"]));
    assert!(!colored(&[], &["show", "--color", "never"]));
    assert!(!colored(&[], &["show"]));
    let plain = text(&run(folder.path(), &[], &["show"]).stdout);
    let always = text(&run(folder.path(), &[], &["show", "--color", "always"]).stdout);
    assert_eq!(always.replace("\u{1b}[1m", "").replace("\u{1b}[0m", ""), plain);
}

/// What bash offers for a line whose last word is begun, by the script that qcar prints.
fn offered(line: &str) -> Option<Vec<String>> {
    let folder = Path::new(env!("CARGO_BIN_EXE_qcar")).parent().unwrap();
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
    let program = format!(
        "eval \"$(qcar completions bash)\"; COMP_WORDS=({line}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
         _clap_complete_qcar qcar \"${{COMP_WORDS[COMP_CWORD]}}\"; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    );
    let ran = Command::new("bash").args(["-c", &program]).env("PATH", path).output();
    let Ok(ran) = ran else {
        eprintln!("not checked: completion in bash, which is absent");
        return None;
    };
    Some(text(&ran.stdout).lines().map(String::from).collect())
}

#[test]
fn bash_completes_verbs_flags_models_and_effects() {
    for (line, expected) in [
        ("qcar si", "simulate"),
        ("qcar frf --fre", "--frequencies"),
        ("qcar frf quarter", "quarter_car"),
        ("qcar fit models --model axle_c_r", "axle_c_rigid_tm"),
        ("qcar patch axle_a bouc", "bouc_wen_hysteresis"),
        ("qcar effects coul", "coulomb_friction"),
        ("qcar fit --format j", "json"),
        ("qcar check Carg", "Cargo.toml"),
        ("qcar new temp", "template"),
    ] {
        let Some(offered) = offered(line) else { return };
        assert!(offered.iter().any(|own| own.trim() == expected), "{line}: {offered:?}");
    }
}
