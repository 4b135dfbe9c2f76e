//! Makes the campaigns of the blind tests.
//!
//! `qcar-blind FOLDER --seed N --axle a|c|d [--hide NAME@PLACE:parameter=value,…]… [--model MODEL]`

mod axle;
mod campaign;
mod cleat;
mod corner;
mod hidden;
mod integrate;
mod kc;
mod random;
mod rig;
mod sensor;

use std::path::PathBuf;
use std::process::ExitCode;

use axle::{Axle, Layout, Mount};
use hidden::Hidden;

const USAGE: &str = "qcar-blind FOLDER [--seed N] [--axle a|c|d] [--model NAME] [--systematic SHARE] [--noise M_S2] \
                     [--no-cleats] [--hide NAME@PLACE:parameter=value,...]...";

fn main() -> ExitCode {
    match make() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}\nusage: {USAGE}");
            ExitCode::from(2)
        }
    }
}

fn make() -> Result<(), String> {
    let mut words = std::env::args().skip(1);
    let folder = words.next().filter(|word| !word.starts_with('-'));
    let folder = PathBuf::from(folder.ok_or("which folder?")?);
    let (mut seed, mut letter, mut model) = (1, String::from("c"), None);
    let (mut systematic, mut noise, mut cleats, mut effects) = (0.005, 0.02, true, Vec::new());
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        let number = |text: String| text.parse::<f64>().map_err(|e| format!("{text}: {e}"));
        match word.as_str() {
            "--seed" => seed = value()?.parse().map_err(|e| format!("--seed: {e}"))?,
            "--axle" => letter = value()?,
            "--model" => model = Some(value()?),
            "--systematic" => systematic = number(value()?)?,
            "--noise" => noise = number(value()?)?,
            "--no-cleats" => cleats = false,
            "--hide" => effects.push(parse(&value()?)?),
            _ => return Err(format!("what is {word}?")),
        }
    }
    let known = known(&letter)?;
    let real = real(known, &effects);
    let axle = with_parts(Axle::draw(real, seed), &effects);
    let plan = campaign::Plan {
        name: folder
            .file_name()
            .map_or("campaign".into(), |name| name.to_string_lossy().into_owned()),
        model: model.unwrap_or_else(|| model_name(&letter, &effects)),
        parameters: campaign::parameters(&axle, without(known, &effects)),
        effects,
        seed,
        systematic,
        noise,
        cleats,
    };
    campaign::write(&plan, &axle, &folder).map_err(|e| format!("{}: {e}", folder.display()))
}

fn parse(text: &str) -> Result<Hidden, String> {
    let wrong = || format!("{text} is not NAME@PLACE:parameter=value,…");
    let (name, rest) = text.split_once('@').ok_or_else(wrong)?;
    let (at, list) = rest.split_once(':').ok_or_else(wrong)?;
    let mut parameters = Vec::new();
    for pair in list.split(',') {
        let (name, value) = pair.split_once('=').ok_or_else(wrong)?;
        parameters.push((name, value.parse::<f64>().map_err(|_| wrong())?));
    }
    Ok(Hidden::new(name, at, &parameters))
}

/// The axle of a letter, as its table has it.
fn known(letter: &str) -> Result<Layout, String> {
    let axle = |subframe, powertrain| Layout {
        top_mount: true,
        subframe,
        powertrain,
    };
    match letter {
        "a" => Ok(axle(false, Mount::Body)),
        "c" => Ok(axle(false, Mount::None)),
        "d" => Ok(axle(true, Mount::Subframe)),
        _ => Err(format!("there is no axle {letter}: a, c or d")),
    }
}

/// What the engineer's model has: the axle less the parts that are hidden.
fn without(mut layout: Layout, effects: &[Hidden]) -> Layout {
    for effect in effects {
        match effect.name.as_str() {
            "top_mount" => layout.top_mount = false,
            "suspended_mass" => layout.powertrain = Mount::None,
            _ => {}
        }
    }
    layout
}

/// What the axle really has.
fn real(mut layout: Layout, effects: &[Hidden]) -> Layout {
    for effect in effects {
        match (effect.name.as_str(), effect.at.as_str()) {
            ("top_mount", _) => layout.top_mount = true,
            ("suspended_mass", "subframe") => layout.powertrain = Mount::Subframe,
            ("suspended_mass", _) => layout.powertrain = Mount::Body,
            _ => {}
        }
    }
    layout
}

/// Hidden parts have the values that their effect names.
fn with_parts(mut axle: Axle, effects: &[Hidden]) -> Axle {
    for effect in effects {
        for (name, value) in &effect.parameters {
            let part = match name.as_str() {
                "m_tm" => &mut axle.m_tm,
                "k_tm" => &mut axle.k_tm,
                "c_tm" => &mut axle.c_tm,
                "m_pwt" => &mut axle.m_pwt,
                "k_pwt_z" => &mut axle.k_pwt_z,
                "c_pwt_z" => &mut axle.c_pwt_z,
                "k_pwt_x" => &mut axle.k_pwt_x,
                "c_pwt_x" => &mut axle.c_pwt_x,
                _ => continue,
            };
            *part = *value;
        }
    }
    axle
}

/// The shipped model of what the engineer knows.
fn model_name(letter: &str, effects: &[Hidden]) -> String {
    let hides = |name: &str| effects.iter().any(|effect| effect.name == name);
    match letter {
        "a" if hides("suspended_mass") => "axle_c".to_owned(),
        "c" if hides("top_mount") => "axle_c_rigid_tm".to_owned(),
        "d" if hides("suspended_mass") => "axle_d_no_pwt".to_owned(),
        _ => format!("axle_{letter}"),
    }
}
