//! The flags: what each verb takes, with an example.

use clap::{CommandFactory, Parser, Subcommand};

use crate::failure::Failure;
use crate::terminal::{self, Color};
use crate::units::{self, Units};
use crate::verbs::{
    check, compare, completions, diff, discover, effects, explore, export, fit, frf, import, inspect, kc, matrices,
    modes, new, patch, plan, score, sensitivity, show, simulate, study, target,
};

/// Quarter-car axle models: compile them, fit them to rig data
///
/// A MODEL is the name of a shipped model (`qcar show` lists them) or the path of a model file.
/// Results go to standard output, progress and errors to standard error.
/// The exit status is 0 for success, 1 if a verb found a fault (its help says which), 2 for unusable input, 130 after Ctrl-C.
#[derive(Parser)]
// The same width everywhere, so that help reads in a terminal as it does in the tests.
#[command(name = "qcar", version, verbatim_doc_comment, term_width = 0)]
pub struct Cli {
    /// Units of results: si, engineering, or a unit for each kind such as N/mm,mm,g; JSON stays in SI
    #[arg(long, global = true, value_name = "UNITS", display_order = 900)]
    units: Option<Units>,
    /// Use colours: auto (on a terminal, unless NO_COLOR is set), always or never
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_default_value = true,
        hide_possible_values = true,
        display_order = 901
    )]
    color: Color,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    New(new::Arguments),
    Inspect(inspect::Arguments),
    Import(import::Arguments),
    Check(check::Arguments),
    Show(show::Arguments),
    Matrices(matrices::Arguments),
    Modes(modes::Arguments),
    Frf(frf::Arguments),
    Fit(fit::Arguments),
    Plan(plan::Arguments),
    Kc(kc::Arguments),
    Simulate(simulate::Arguments),
    Explore(explore::Arguments),
    Sensitivity(sensitivity::Arguments),
    Target(target::Arguments),
    Discover(discover::Arguments),
    Study(study::Arguments),
    Compare(compare::Arguments),
    Score(score::Arguments),
    Effects(effects::Arguments),
    Patch(patch::Arguments),
    Diff(diff::Arguments),
    Export(export::Arguments),
    Completions(completions::Arguments),
}

impl Cli {
    /// Runs the verb and returns the text for standard output.
    pub fn run(self) -> Result<String, Failure> {
        terminal::detect(self.color);
        if let Some(units) = self.units {
            units::choose(units);
        }
        match self.verb {
            Verb::New(arguments) => new::run(&arguments),
            Verb::Inspect(arguments) => inspect::run(&arguments),
            Verb::Import(arguments) => import::run(&arguments),
            Verb::Check(arguments) => check::run(&arguments),
            Verb::Show(arguments) => show::run(&arguments),
            Verb::Matrices(arguments) => matrices::run(&arguments),
            Verb::Modes(arguments) => modes::run(&arguments),
            Verb::Frf(arguments) => frf::run(&arguments),
            Verb::Fit(arguments) => fit::run(&arguments),
            Verb::Plan(arguments) => plan::run(&arguments),
            Verb::Kc(arguments) => kc::run(&arguments),
            Verb::Simulate(arguments) => simulate::run(&arguments),
            Verb::Explore(arguments) => explore::run(&arguments),
            Verb::Sensitivity(arguments) => sensitivity::run(&arguments),
            Verb::Target(arguments) => target::run(&arguments),
            Verb::Discover(arguments) => discover::run(&arguments),
            Verb::Study(arguments) => study::run(&arguments),
            Verb::Compare(arguments) => compare::run(&arguments),
            Verb::Score(arguments) => score::run(&arguments),
            Verb::Effects(arguments) => effects::run(&arguments),
            Verb::Patch(arguments) => patch::run(&arguments),
            Verb::Diff(arguments) => diff::run(&arguments),
            Verb::Export(arguments) => export::run(&arguments),
            Verb::Completions(arguments) => completions::run(&arguments, &Cli::command()),
        }
    }
}
