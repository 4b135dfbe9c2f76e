//! Shapes of the code of a program, and widths of its vectors.

use qcar_dsl::evaluate::arguments::Part;

/// Number of evaluations of a program in a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// At one point.
    Once,
    /// For [`qcar_model::LANES`] sets, with a row for each entry.
    Sets,
    /// At many points, with a row for each entry of the varying parts.
    Points(&'static [Part]),
}

/// Number of values in a vector, for several sets or points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Breadth {
    /// AVX.
    Four,
    /// AVX-512.
    Eight,
}

impl Breadth {
    /// The widest vectors of this processor.
    pub fn widest() -> Self {
        if Self::Eight.is_there() {
            Self::Eight
        } else {
            Self::Four
        }
    }

    /// True if this processor has such vectors.
    pub fn is_there(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Self::Four => std::arch::is_x86_feature_detected!("avx"),
            Self::Eight => {
                std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512dq")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        false
    }
}
