//! Accuracy of an integration. The numbers are choices: each is ten times or a hundred times finer than the one before.

/// How accurate an integration is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error of a step, relative to the largest value of a state so far.
    pub(super) tolerance: f64,
    /// Most halvings of a step for its sake.
    pub(super) halvings: u8,
    /// True if the error includes that of a law that jumps between two stages of a step. A step then has at least two
    /// parts.
    pub(super) sees_jumps: bool,
}

impl Accuracy {
    /// For smooth laws at the usual accuracy of sensors.
    pub const USUAL: Self = Self {
        tolerance: 1e-3,
        halvings: 4,
        sees_jumps: false,
    };
    /// Between the others, to see whether the error falls.
    pub const MEDIUM: Self = Self {
        tolerance: 1e-4,
        halvings: 5,
        sees_jumps: true,
    };
    /// For laws that are sharp within a step, whose errors add up over a record.
    pub const HIGH: Self = Self {
        tolerance: 1e-5,
        halvings: 6,
        sees_jumps: true,
    };

    /// Fewest halvings of a step.
    pub(super) fn fewest(self) -> u8 {
        u8::from(self.sees_jumps)
    }
}
