//! `qcar modes`: natural frequencies, damping ratios and mode shapes.

use clap::Args;
use qcar_dsl::response::Wanted;
use qcar_runtime::free_motions::{FreeMotion, FreeMotions, Kind, MOST_STATES, free_motions};
use qcar_runtime::matrices::at_rest;
use qcar_runtime::model::{About, Model, StateKind};
use qcar_runtime::response::parameters::Values;
use serde::Serialize;

use crate::catalogue;
use crate::failure::Failure;
use crate::json;
use crate::mode_shape::Moving;
use crate::parameters;
use crate::stability::unstable;
use crate::table::{Table, counted, noted, noted_below, number};
use crate::terminal::{aside, prose};
use crate::units;
use crate::verbs::{ModelArguments, TableFormat};

/// Print natural frequencies, damping ratios and mode shapes
///
/// Frequencies are those without damping; a nonlinear model is linearised at rest. For each mass and massless point,
/// the shape has its amplitude relative to the largest, and its phase in degrees. Parts that turn count in rad, others
/// in m.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  qcar modes quarter_car --set c_wheel_z=0\n  qcar modes axle_a --params models/campaigns/axle_a_rig --format csv"
)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Output format
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    format: TableFormat,
}

/// Runs the verb.
pub fn run(arguments: &Arguments) -> Result<String, Failure> {
    let model = catalogue::load_wanted(&arguments.model.model, Wanted::Nothing)?;
    let about = model.about();
    let values = parameters::resolve(about, arguments.model.params.as_deref(), &arguments.model.set)?;
    model.check_inertias(values.as_slice())?;
    parameters::require_finite(&about.name, at_rest(&*model, values.as_slice()).iter())?;
    let found = free_motions(&*model, &values);
    let result = Modes {
        model: about.name.to_string(),
        linear: about.linear,
        notices: notices(&*model, &values, &found),
        modes: numbered(&found.motions),
        rigid: found.rigid,
    };
    let points = points(about);
    Ok(match arguments.format {
        TableFormat::Text => prose(&text(&result, &points)),
        TableFormat::Json => json::line(&result),
        TableFormat::Csv => {
            aside(&noted(&result.notices));
            csv(&result, &points)
        }
    })
}

/// The free motions of a model.
#[derive(Serialize)]
struct Modes {
    model: String,
    /// False if the equations were linearised at rest.
    linear: bool,
    notices: Vec<String>,
    /// Lowest frequency first.
    modes: Vec<Mode>,
    /// Number of eigenvalues that are zero.
    rigid: usize,
}

/// A free motion.
#[derive(Serialize)]
struct Mode {
    /// That of the metric `mode.N.frequency`, which counts vibrations.
    number: Option<usize>,
    /// Undamped natural frequency, Hz.
    frequency: f64,
    damping: f64,
    kind: &'static str,
    unstable: bool,
    parts: Vec<Moving>,
}

impl Mode {
    fn of(motion: &FreeMotion, number: Option<usize>) -> Self {
        Mode {
            number,
            frequency: motion.frequency,
            damping: motion.damping,
            kind: match motion.kind {
                Kind::Vibration => "vibration",
                Kind::Overdamped => "overdamped",
                Kind::Aperiodic => "aperiodic",
            },
            unstable: motion.is_unstable(),
            parts: motion.shape.iter().map(Moving::of).collect(),
        }
    }

    /// The kind, and whether the motion grows.
    fn words(&self) -> String {
        let ending = if self.unstable { ", unstable" } else { "" };
        format!("{}{ending}", self.kind)
    }

    fn part(&self, (axis, point): &(String, String)) -> Option<&Moving> {
        let mut parts = self.parts.iter();
        parts.find(|part| part.axis == *axis && part.point == *point)
    }
}

fn numbered(motions: &[FreeMotion]) -> Vec<Mode> {
    let mut vibrations = 0;
    let mode = |motion: &FreeMotion| {
        let vibrates = motion.kind == Kind::Vibration;
        vibrations += usize::from(vibrates);
        Mode::of(motion, vibrates.then_some(vibrations))
    };
    motions.iter().map(mode).collect()
}

/// Axis and name of every mass and massless point.
fn points(about: &About) -> Vec<(String, String)> {
    let positions = about.states.iter().filter(|state| state.kind == StateKind::Position);
    let names = positions.map(|state| (state.axis.to_string(), state.location.to_string()));
    names.collect()
}

fn notices(model: &dyn Model, values: &Values, found: &FreeMotions) -> Vec<String> {
    let has = |kind: Kind| found.motions.iter().any(|own| own.kind == kind);
    let overdamped = has(Kind::Overdamped).then(|| {
        "an overdamped mode returns to rest without oscillation; its frequency and damping ratio are those of its two \
         real eigenvalues together, its shape is that of the slower one"
            .into()
    });
    let aperiodic = has(Kind::Aperiodic).then(|| {
        "the frequency of an aperiodic motion is the rate at which it decays or grows over 2π; each belongs to a law \
         with memory or a massless point, or two of them to an overdamped mode"
            .into()
    });
    let rigid = (found.rigid > 0).then(|| {
        format!(
            "{} of the model {} zero and not listed: nothing holds a part of it, which moves as a rigid body",
            counted(found.rigid, "eigenvalue"),
            if found.rigid == 1 { "is" } else { "are" }
        )
    });
    let out = parameters::out_of_range(model.about(), values.as_slice()).into_iter();
    // The table says of each motion of a larger model whether it grows.
    let is_checked = model.about().states.len() <= MOST_STATES;
    out.chain(is_checked.then(|| unstable(model, values)).flatten())
        .chain(overdamped)
        .chain(aperiodic)
        .chain(rigid)
        .collect()
}

fn text(of: &Modes, points: &[(String, String)]) -> String {
    let frequency = format!("frequency_{}", units::name("Hz"));
    let head = ["mode".into(), "kind".into(), frequency, "damping_ratio".into()];
    let shape = points
        .iter()
        .flat_map(|(axis, point)| [format!("{axis}_{point}"), format!("{axis}_{point}_deg")]);
    let mut table = Table::with_headings(head.into_iter().chain(shape).collect());
    for mode in &of.modes {
        let head = [
            mode.number.map_or("-".into(), |number| number.to_string()),
            mode.words(),
            number(units::value(mode.frequency, "Hz"), 5),
            number(mode.damping, 4),
        ];
        let shape = points.iter().flat_map(|point| match mode.part(point) {
            Some(part) => [number(part.amplitude, 4), number(part.phase, 4)],
            None => ["0".into(), "-".into()],
        });
        table.row(head.into_iter().chain(shape).collect());
    }
    let note = if of.linear { "" } else { "Linearised at rest.\n\n" };
    format!("{note}{}{}", table.text(), noted_below(&of.notices))
}

fn csv(of: &Modes, points: &[(String, String)]) -> String {
    let shape = points
        .iter()
        .map(|(axis, point)| format!(",{axis}_{point},{axis}_{point}_deg"));
    let mut out = format!(
        "mode,kind,unstable,{},damping_ratio{}\n",
        units::heading("frequency", "Hz"),
        shape.collect::<String>()
    );
    for mode in &of.modes {
        let cells = points.iter().map(|point| match mode.part(point) {
            Some(part) => format!(",{},{}", part.amplitude, part.phase),
            None => ",0,".into(),
        });
        out += &format!(
            "{},{},{},{},{}{}\n",
            mode.number.map_or(String::new(), |number| number.to_string()),
            mode.kind,
            mode.unstable,
            units::value(mode.frequency, "Hz"),
            mode.damping,
            cells.collect::<String>()
        );
    }
    out
}
