//! `qcar completions`: a shell script for completions.

use clap::{Args, Command, ValueEnum};
use clap_complete::env::{Bash, EnvCompleter, Fish, Powershell, Zsh};

use crate::failure::Failure;

/// The environment variable by which the shell requests completions.
pub const VARIABLE: &str = "QCAR_COMPLETE";

/// Print a script with which a shell completes verbs, flags and their values, and names of models and effects
///
/// bash: put it into ~/.local/share/bash-completion/completions/qcar
/// zsh: put it into a folder of $fpath, as _qcar
/// fish: put it into ~/.config/fish/completions/qcar.fish
/// powershell: add it to the file that $PROFILE names
#[derive(Args)]
#[command(verbatim_doc_comment, after_help = "Example:\n  qcar completions bash")]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

#[derive(Clone, Copy, ValueEnum)]
enum Shell {
    Bash,
    Fish,
    Powershell,
    Zsh,
}

/// Prints the script for the program of `cli`, which the shell must find by its name.
pub fn run(arguments: &Arguments, cli: &Command) -> Result<String, Failure> {
    let shell: &dyn EnvCompleter = match arguments.shell {
        Shell::Bash => &Bash,
        Shell::Fish => &Fish,
        Shell::Powershell => &Powershell,
        Shell::Zsh => &Zsh,
    };
    let (name, mut script) = (cli.get_name(), Vec::new());
    let written = shell.write_registration(VARIABLE, name, name, name, &mut script);
    written.map_err(|error| Failure::Input(error.to_string()))?;
    Ok(String::from_utf8_lossy(&script).into_owned())
}
