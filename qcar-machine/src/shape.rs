//! Shapes of the code of a program: for how many points or parameter sets a call computes it, and with which vectors.

use qcar_dsl::evaluate::arguments::Part;

/// Number of evaluations of a program in a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// At one point.
    Single,
    /// For [`qcar_model::LANES`] parameter sets, with a row for each entry.
    Sets,
    /// At many points, with a row for each entry of the varying parts.
    Points(&'static [Part]),
}

/// Width of the vectors for several sets or points, in numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum VectorWidth {
    /// AVX.
    Four,
    /// AVX-512.
    Eight,
}

impl VectorWidth {
    /// The widest vectors of this processor.
    pub fn widest() -> Self {
        if Self::Eight.is_supported() {
            Self::Eight
        } else {
            Self::Four
        }
    }

    /// True if this processor has such vectors.
    pub fn is_supported(self) -> bool {
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
