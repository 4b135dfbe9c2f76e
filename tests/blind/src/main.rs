//! Makes the campaigns of the blind tests.
//!
//! `qcar-blind FOLDER --seed N --axle a|c|d [--hide NAME@PLACE[/FORM]:parameter=value,…]… [--flaws all|NAME,…] [--model
//! MODEL]`

use std::path::PathBuf;
use std::process::ExitCode;

use qcar_blind::hardware::Flaw;
use qcar_blind::hidden::Hidden;
use qcar_blind::programme::Programme;
use qcar_blind::{Order, make};

const USAGE: &str = "qcar-blind FOLDER [--seed N] [--axle a|c|d] [--model NAME] [--systematic SHARE] [--noise M_S2] \
                     [--no-cleats] [--fast] [--flaws all|NAME,...] [--hide NAME@PLACE[/FORM]:parameter=value,...]...";

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}\nusage: {USAGE}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), String> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().filter(|word| !word.starts_with('-'));
    let folder = PathBuf::from(folder.ok_or("which folder?")?);
    let mut order = Order::clean("c", 1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        let number = |text: String| text.parse::<f64>().map_err(|e| format!("{text}: {e}"));
        match word.as_str() {
            "--seed" => order.seed = value()?.parse().map_err(|e| format!("--seed: {e}"))?,
            "--axle" => order.axle = value()?,
            "--model" => order.model = Some(value()?),
            "--systematic" => order.systematic = number(value()?)?,
            "--noise" => order.noise = number(value()?)?,
            "--no-cleats" => order.cleats = false,
            "--fast" => order.programme = Programme::fast(),
            "--flaws" => order.flaws = flaws(&value()?)?,
            "--hide" => order.effects.push(parse(&value()?)?),
            _ => return Err(format!("what is {word}?")),
        }
    }
    make(order, &folder)
}

fn flaws(text: &str) -> Result<Vec<Flaw>, String> {
    if text == "all" {
        return Ok(Flaw::MILD.to_vec());
    }
    let named =
        |name: &str| Flaw::named(name).ok_or(format!("there is no flaw {name}: all, Cams, or of {:?}", Flaw::MILD));
    text.split(',').map(named).collect()
}

fn parse(text: &str) -> Result<Hidden, String> {
    let wrong = || format!("{text} is not NAME@PLACE:parameter=value,…");
    let (name, rest) = text.split_once('@').ok_or_else(wrong)?;
    let (at, list) = rest.split_once(':').ok_or_else(wrong)?;
    let (at, form) = at.split_once('/').unwrap_or((at, ""));
    let mut parameters = Vec::new();
    for pair in list.split(',') {
        let (name, value) = pair.split_once('=').ok_or_else(wrong)?;
        parameters.push((name, value.parse::<f64>().map_err(|_| wrong())?));
    }
    Ok(Hidden::new(name, at, &parameters).form(form))
}
