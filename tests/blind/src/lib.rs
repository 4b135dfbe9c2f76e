//! A second axle simulator that shares no code with qcar. It makes campaigns of axles with hidden effects.

#![expect(
    missing_docs,
    reason = "fields have the names of the campaign format, the axle tables and the catalogue"
)]

mod random;

// The content of a campaign.
pub mod hardware;
pub mod programme;

// The car and its hidden effects.
mod other_law;

pub mod hidden;

mod axle;

// The motion.
mod corner;

mod integrate;

// The rigs.
mod kc;
mod rig;

// The track.
mod road;

mod enveloping;
mod radial;

mod cleat;

// The sensors.
mod calibration;

mod sensor;

// The campaign's folder.
mod campaign;

// How much of the hidden effects can be found at all.
mod separable;

// The cases of the blind matrix, and the answers to them.
pub mod matrix;

pub mod outcome;

pub mod tables;

use std::path::Path;

use axle::{Axle, Layout, Mount};
use hardware::{Flaw, Hardware};
use hidden::Hidden;
use programme::Programme;

/// The campaign to make.
#[derive(Clone, Debug)]
pub struct Order {
    /// Seed of everything random.
    pub seed: u64,
    /// `a`, `c` or `d`.
    pub axle: String,
    /// The model that the engineer starts from, if it is not the axle without its hidden parts.
    pub model: Option<String>,
    /// Standard deviation of a sensor's gain error.
    pub systematic: f64,
    /// Noise of the rig's accelerometers, m/s².
    pub noise: f64,
    /// The runs of the campaign.
    pub programme: Programme,
    /// Whether the campaign includes drives over cleats.
    pub cleats: bool,
    /// The hidden effects: in the simulated car, not in the engineer's model.
    pub effects: Vec<Hidden>,
    /// Flaws of car, rig and sensors that no model describes.
    pub flaws: Vec<Flaw>,
}

impl Order {
    /// A campaign of an axle without hidden effects.
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
/// An axle that does not exist, a law at a place where the simulator does not have it, or a folder that cannot be
/// written to.
pub fn make(order: Order, folder: &Path) -> Result<(), String> {
    let (plan, axle, _) = planned(order, folder)?;
    campaign::write(&plan, &axle, folder).map_err(|e| format!("{}: {e}", folder.display()))
}

/// The part of the hidden effects' response that no change of the engineer's parameters can reproduce: RMS over the
/// fitted runs, in units of the sensors' noise, by the equations of this simulator.
///
/// # Errors
/// An axle that does not exist, or a law at a place where the simulator does not have it.
pub fn strength(order: Order) -> Result<f64, String> {
    let (plan, axle, known) = planned(order, Path::new("campaign"))?;
    Ok(separable::strength(&plan, &axle, &known))
}

/// The plan, the real axle, and the axle as the engineer knows it.
fn planned(order: Order, folder: &Path) -> Result<(campaign::Plan, Axle, Axle), String> {
    for Hidden { name, at, .. } in &order.effects {
        if let Some(place) = matrix::only_place(name).filter(|place| place != at) {
            return Err(format!("{name} at {at}: the simulator has this law only at {place}"));
        }
    }
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

/// The axle that a letter names.
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

/// The parts of the engineer's model: those of the axle less the hidden ones.
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

/// The parts of the real axle.
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

/// The hidden effects give the values of the hidden parts.
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

/// The shipped model with the parts that the engineer knows.
fn model_name(letter: &str, effects: &[Hidden]) -> String {
    let hides = |name: &str| effects.iter().any(|effect| effect.name == name);
    match letter {
        "a" if hides("suspended_mass") => "axle_c".to_owned(),
        "c" if hides("top_mount") => "axle_c_rigid_tm".to_owned(),
        "d" if hides("suspended_mass") => "axle_d_no_pwt".to_owned(),
        _ => format!("axle_{letter}"),
    }
}
