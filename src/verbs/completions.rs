//! `qcar completions`: a script that lets a shell complete verbs and flags.

use clap::{Args, Command};
use clap_complete::{Shell, generate};

/// Print a script that lets a shell complete verbs, flags and their values
///
/// bash: put it into ~/.local/share/bash-completion/completions/qcar
/// zsh: put it into a folder of $fpath, as _qcar
/// fish: put it into ~/.config/fish/completions/qcar.fish
/// powershell: add it to the file that $PROFILE names
#[derive(Args)]
#[command(verbatim_doc_comment, after_help = "Example:\n  qcar completions bash")]
pub struct Arguments {
    /// Which shell
    shell: Shell,
}

/// Does it for all verbs of `cli`.
pub fn run(arguments: &Arguments, mut cli: Command) -> String {
    let name = cli.get_name().to_string();
    let mut script = Vec::new();
    generate(arguments.shell, &mut cli, name, &mut script);
    String::from_utf8_lossy(&script).into_owned()
}
