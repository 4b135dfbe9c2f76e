//! The command line of qcar.

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::{CommandFactory, Parser};
use clap_complete::CompleteEnv;
use qcar::cli::Cli;
use qcar::failure::Failure;
use qcar::verbs::completions::VARIABLE;
use qcar::{interruption, terminal};

fn main() -> ExitCode {
    CompleteEnv::with_factory(Cli::command).var(VARIABLE).complete();
    interruption::listen();
    match Cli::parse().run() {
        Ok(text) => print(&text, 0),
        Err(failure) => {
            let status = failure.exit_status();
            match failure {
                Failure::Finding(text) => print(&text, status),
                Failure::Input(text) => {
                    terminal::to_error(&(terminal::complaint(text.trim_end()) + "\n"));
                    ExitCode::from(status)
                }
            }
        }
    }
}

/// Writes to standard output. A closed pipe, such as that of `head`, is no error.
fn print(text: &str, status: u8) -> ExitCode {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            terminal::to_error(&format!("cannot write to standard output: {error}\n"));
            ExitCode::from(2)
        }
        _ => ExitCode::from(status),
    }
}
