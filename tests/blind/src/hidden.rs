//! The hidden effects of a campaign: those of the catalogue and some outside it, by name, with laws written by hand.

use crate::hardware::{Cams, Flexible, Hardware, Heat, RadialSprings};
use crate::other_law::Other;

/// An effect with its true parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Hidden {
    /// A name from the catalogue, or another.
    pub name: String,
    /// Link, mass or sensor location.
    pub at: String,
    /// Tells forms of one effect apart: `strut` for a friction that acts between body and wheel, `rolling` for a tyre
    /// effect that is absent on the rig. Empty for the usual form.
    pub form: String,
    /// Parameter values, SI units.
    pub parameters: Vec<(String, f64)>,
}

impl Hidden {
    /// An effect in its usual form.
    pub fn new(name: &str, at: &str, parameters: &[(&str, f64)]) -> Self {
        let parameters = parameters
            .iter()
            .map(|&(name, value)| (name.to_owned(), value))
            .collect();
        Self {
            name: name.to_owned(),
            at: at.to_owned(),
            form: String::new(),
            parameters,
        }
    }

    /// The same effect in another form.
    pub fn form(mut self, form: &str) -> Self {
        self.form = form.to_owned();
        self
    }

    /// The value of a parameter. Panics if the effect has no parameter with this name.
    pub fn get(&self, name: &str) -> f64 {
        let found = self.parameters.iter().find(|(n, _)| n == name);
        found
            .unwrap_or_else(|| panic!("the effect {} has no parameter {name}", self.name))
            .1
    }
}

/// The hidden effects as the equations of motion need them; an absent effect is `None`. Names are those of the
/// catalogue.
#[derive(Clone, Debug, Default)]
pub struct Laws {
    pub friction: Option<Friction>,
    /// The friction acts between body and wheel; it bypasses the top mount.
    pub friction_past_mount: bool,
    /// Tyre effects are absent on the rig.
    pub rolling_only: bool,
    pub bouc_wen: Option<BoucWen>,
    pub segmented: Option<Segmented>,
    pub k_series: Option<f64>,
    pub body_drag: Option<f64>,
    pub wheel_drag: Option<f64>,
    pub rebound_over_compression: Option<f64>,
    pub digressive: Option<Digressive>,
    pub rate_increase_at_40mm: Option<f64>,
    pub bump_stop: Option<BumpStop>,
    pub top_mount_relaxation: Option<Relaxation>,
    pub powertrain_relaxation: Option<Relaxation>,
    pub hydraulic: Option<Hydraulic>,
    pub pitch: Option<Pitch>,
    pub apparent: Option<Apparent>,
    pub tire_increase: Option<f64>,
    pub tire_relaxation: Option<TireRelaxation>,
    pub belt: Option<Belt>,
    pub saturation: Option<Saturation>,
    pub free_play: Option<f64>,
    pub inertance: Option<f64>,
    pub resonator: Option<Resonator>,
    /// A law in another form than the catalogue's: the resonator's spring also has a cubic term, N/m³.
    pub resonator_cubic: Option<f64>,
    /// Outside the catalogue: the damper fades by this share from the start of a run to its end.
    pub fade: Option<f64>,
    /// Outside the catalogue: an additional damper force c₂ v|v|, N s²/m².
    pub quadratic_damping: Option<f64>,
    /// A law in another form than the catalogue's: the top mount stiffens with the square of its extension, N/m³.
    pub cubic_top_mount: Option<f64>,
    /// A law in another form than the catalogue's.
    pub other: Option<Other>,
    /// A flaw of hardware: the body bends.
    pub flexible: Option<Flexible>,
    /// A flaw of hardware: the damper warms up.
    pub heat: Option<Heat>,
    /// A flaw of hardware: the tyre consists of radial springs over a cleat.
    pub radial_springs: Option<RadialSprings>,
    /// A flaw of hardware: the tyre follows elliptical cams over a cleat.
    pub cams: Option<Cams>,
}

macro_rules! law {
    ($(#[$doc:meta])* $name:ident { $($field:ident),* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name { $(pub $field: f64),* }

        impl $name {
            fn from(hidden: &Hidden) -> Self {
                Self { $($field: hidden.get(stringify!($field))),* }
            }
        }
    };
}

law!(/// Dahl's dry friction.
    Friction { f_coulomb, k_presliding });
law!(/// A loop without a corner.
    BoucWen { f_hysteresis, k_hysteresis, loop_shape });
law!(/// A parabola for each direction.
    Segmented { c_rebound, q_rebound, c_compression, q_compression });
law!(/// `c0 v / (1 + |v|/v0)`
    Digressive { c0, v0 });
law!(/// A stop that acts below `-gap` of wheel travel.
    BumpStop { gap, k_stop });
law!(/// A Maxwell branch.
    Relaxation { k_maxwell, relaxation_frequency });
law!(/// A spring in series with the fluid of an inertia track.
    Hydraulic { k_volume, inertance, c_track });
law!(/// A sub-frame that pitches on its front and rear bushings.
    Pitch { inertia, half_length, front_share, arm_offset });
law!(/// The body's other end on the other axle. Its wheelbase cancels.
    Apparent { dynamic_index, k_wheel_z_other, c_wheel_z_other });
law!(/// A Maxwell branch in the tyre, by its ratio of fast to slow stiffness.
    TireRelaxation { stiffness_ratio, relaxation_frequency });
law!(/// A rigid ring between wheel and road.
    Belt { m_belt, k_sidewall, c_sidewall });
law!(/// A bushing that stiffens beyond its linear travel.
    Saturation { linear_travel, rate_increase_at_twice_travel });
law!(/// A mass on a spring and damper on the wheel.
    Resonator { m_resonator, k_resonator, zeta_resonator });

impl Resonator {
    /// Damping of its mount, N s/m.
    pub fn damping(&self) -> f64 {
        2.0 * self.zeta_resonator * (self.k_resonator * self.m_resonator).sqrt()
    }
}

impl Laws {
    /// Mass that moves with the rim, kg: the wheel's mass less its belt and its resonator.
    pub fn carried_by_the_wheel(&self, m_wheel: f64) -> f64 {
        m_wheel - self.belt.map_or(0.0, |belt| belt.m_belt) - self.resonator.map_or(0.0, |own| own.m_resonator)
    }

    /// The laws of a set of effects. Sensor effects are not among them; the sensors apply them.
    pub fn of(effects: &[Hidden]) -> Self {
        let mut laws = Self::default();
        for effect in effects {
            laws.add(effect);
        }
        laws
    }

    /// The laws of a set of effects in a car with flaws.
    pub fn on(self, hardware: &Hardware) -> Self {
        Self {
            flexible: hardware.flexible(),
            heat: hardware.heat(),
            radial_springs: hardware.radial_springs(),
            cams: hardware.cams(),
            ..self
        }
    }

    fn add(&mut self, effect: &Hidden) {
        self.friction_past_mount |= effect.form == "strut";
        self.rolling_only |= effect.form == "rolling";
        match (effect.name.as_str(), effect.at.as_str()) {
            ("coulomb_friction", _) => self.friction = Some(Friction::from(effect)),
            ("asymmetric_damper", _) => self.rebound_over_compression = Some(effect.get("rebound_over_compression")),
            ("digressive_damper", _) => self.digressive = Some(Digressive::from(effect)),
            ("progressive_spring", _) => self.rate_increase_at_40mm = Some(effect.get("rate_increase_at_40mm")),
            ("bump_stop", _) => self.bump_stop = Some(BumpStop::from(effect)),
            ("bushing_relaxation", "top_mount") => self.top_mount_relaxation = Some(Relaxation::from(effect)),
            ("bushing_relaxation", _) => self.powertrain_relaxation = Some(Relaxation::from(effect)),
            ("hydraulic_mount", _) => self.hydraulic = Some(Hydraulic::from(effect)),
            ("subframe_pitch", _) => self.pitch = Some(Pitch::from(effect)),
            ("apparent_mass", _) => self.apparent = Some(Apparent::from(effect)),
            ("tire_progressive_stiffness", _) => {
                self.tire_increase = Some(effect.get("tangent_increase_at_twice_static"));
            }
            ("tire_dynamic_stiffness", _) => self.tire_relaxation = Some(TireRelaxation::from(effect)),
            ("tire_belt", _) => self.belt = Some(Belt::from(effect)),
            ("bushing_saturation", _) => self.saturation = Some(Saturation::from(effect)),
            ("free_play", _) => self.free_play = Some(effect.get("gap")),
            ("inerter", _) => self.inertance = Some(effect.get("inertance")),
            ("secondary_resonator", _) => self.resonator = Some(Resonator::from(effect)),
            ("cubic_resonator", _) => {
                self.resonator = Some(Resonator::from(effect));
                self.resonator_cubic = Some(effect.get("k3"));
            }
            ("bouc_wen_hysteresis", _) => self.bouc_wen = Some(BoucWen::from(effect)),
            ("segmented_polynomial_damper", _) => self.segmented = Some(Segmented::from(effect)),
            ("series_compliance", _) => self.k_series = Some(effect.get("k_series")),
            ("drag_to_ground", "body") => self.body_drag = Some(effect.get("c_drag")),
            ("drag_to_ground", _) => self.wheel_drag = Some(effect.get("c_drag")),
            ("damper_fade", _) => self.fade = Some(effect.get("share")),
            ("quadratic_damping", _) => self.quadratic_damping = Some(effect.get("c2")),
            ("cubic_top_mount", _) => self.cubic_top_mount = Some(effect.get("k3")),
            // Laws in another form. All other names are parts that the layout holds already, or sensor effects.
            _ => self.other = self.other.or(Other::named(&effect.name, |name| effect.get(name))),
        }
    }
}
