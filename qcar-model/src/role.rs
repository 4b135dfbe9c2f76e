//! Roles of the parameters of an effect.

/// Role of a parameter in its effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterRole {
    /// Strength: at this value the model is that without the effect.
    Strength {
        /// 0, another value in SI, or infinity.
        vanishes_at: f64,
    },
    /// Shape: where the effect acts, over travel, speed or frequency.
    Shape,
    /// Time since the start of a run, in s or, without a unit, relative to the run; each run sets it.
    Clock,
    /// Any other.
    Other,
}
