//! A second axle simulator that shares nothing with qcar: it makes campaigns in which effects are hidden.

#![allow(
    missing_docs,
    reason = "fields have the names of the campaign format, the axle tables and the catalogue"
)]

mod random;

// What a campaign is to hold.
pub mod hardware;
pub mod programme;

// What is hidden in the car, and the car.
mod other_law;

pub mod hidden;

mod axle;

// How it moves.
mod corner;

mod integrate;

// On the rigs.
mod kc;
mod rig;

// On the track.
mod road;

mod enveloping;
mod radial;

mod cleat;

// What sensors make of it.
mod calibration;

mod sensor;

// All of it in a folder.
mod campaign;

// What of it can be found at all.
mod separable;

// Cases by the hundred, and what was answered to them.
pub mod matrix;

pub mod outcome;

pub mod tables;

use std::path::Path;

use axle::{Axle, Layout, Mount};
use hardware::{Flaw, Hardware};
use hidden::Hidden;
use programme::Programme;

/// What campaign is wanted.
#[derive(Clone, Debug)]
pub struct Order {
    /// Seed of everything random.
    pub seed: u64,
    /// `a`, `c` or `d`.
    pub axle: String,
    /// The model that the engineer starts from, in place of the axle without what is hidden.
    pub model: Option<String>,
    /// Standard deviation of a sensor's gain error.
    pub systematic: f64,
    /// Noise of the rig's accelerometers, m/s².
    pub noise: f64,
    /// Which runs.
    pub programme: Programme,
    /// Whether to run its cleats too.
    pub cleats: bool,
    /// What the model lacks.
    pub effects: Vec<Hidden>,
    /// What no model has.
    pub flaws: Vec<Flaw>,
}

impl Order {
    /// A campaign of an axle with nothing hidden.
    pub fn clean(axle: &str, seed: u64) -> Self {
        Self {
            seed,
            axle: axle.to_owned(),
            model: None,
            systematic: 0.005,
            noise: 0.02,
            programme: Programme::full(),
            cleats: true,
            effects: Vec::new(),
            flaws: Vec::new(),
        }
    }
}

/// Writes the campaign to a folder.
///
/// # Errors
/// An axle that does not exist, or a folder that cannot be written to.
pub fn make(order: Order, folder: &Path) -> Result<(), String> {
    let (plan, axle, _) = planned(order, folder)?;
    campaign::write(&plan, &axle, folder).map_err(|e| format!("{}: {e}", folder.display()))
}

/// How much of what is hidden no parameter of the engineer's model can imitate: RMS over the fitted runs in units of
/// the sensors' noise, by the equations of this simulator.
///
/// # Errors
/// An axle that does not exist.
pub fn strength(order: Order) -> Result<f64, String> {
    let (plan, axle, known) = planned(order, Path::new("campaign"))?;
    Ok(separable::strength(&plan, &axle, &known))
}

/// The plan, the real axle, and the axle as the engineer knows it.
fn planned(order: Order, folder: &Path) -> Result<(campaign::Plan, Axle, Axle), String> {
    let known = known(&order.axle)?;
    let real = real(known, &order.effects);
    let axle = with_parts(Axle::draw(real, order.seed), &order.effects);
    let seen = Axle {
        layout: without(known, &order.effects),
        ..axle
    };
    let plan = campaign::Plan {
        name: folder
            .file_name()
            .map_or("campaign".into(), |name| name.to_string_lossy().into_owned()),
        model: order.model.unwrap_or_else(|| model_name(&order.axle, &order.effects)),
        parameters: campaign::parameters(&axle, seen.layout),
        effects: order.effects,
        seed: order.seed,
        systematic: order.systematic,
        noise: order.noise,
        programme: if order.cleats {
            order.programme
        } else {
            order.programme.without_cleats()
        },
        hardware: Hardware::new(order.seed, order.flaws),
    };
    Ok((plan, axle, seen))
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
