//! In which shapes there is code of a program, and for vectors of which breadth.

use qcar_dsl::evaluate::given::Part;

/// How often a program is computed in a call.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// At one point.
    Once,
    /// For [`qcar_model::LANES`] sets, of which each entry has a row.
    Sets,
    /// At many points, of which each entry of the varying parts has a row.
    Points(&'static [Part]),
}

/// How many numbers a vector holds, where several sets or points are computed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Breadth {
    /// AVX.
    Four,
    /// AVX-512.
    Eight,
}

impl Breadth {
    /// The most that this processor has.
    pub fn widest() -> Self {
        if Self::Eight.is_there() {
            Self::Eight
        } else {
            Self::Four
        }
    }

    /// True where this processor has such vectors.
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
