//! Roles of the parameters of an effect.

/// What a parameter is to its effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterRole {
    /// As it goes to a value, the model becomes what it was without the effect.
    Strength {
        /// 0, another value in SI, or infinity.
        vanishes_at: f64,
    },
    /// It says where the effect acts, over travel, speed or frequency.
    Shape,
    /// It is the time since a run began, in s or, without a unit, in parts of the run: each run gives it.
    Clock,
    /// None of these.
    Other,
}
