//! The data at three fidelities, for the stages of a search.

use crate::campaign::Role;
use crate::discover::observe::{Evidence, Stimulus};

/// Line decimation of sweeps in the coarse and the medium data.
pub const DECIMATION: [usize; 2] = [6, 3];
/// Mean periods in a window of the coarse and the medium data. A window of two periods determines the stiffness and the
/// damping of what moves in it. If a frequency is wrong by a quarter, the phase error at its end is only half a period.
const PERIODS: [f64; 2] = [2.0, 8.0];

/// The data at three fidelities.
pub struct Fidelity {
    /// Decimated sweep lines, one cleat run and the beginning of records, or windows of them.
    pub coarse: Evidence,
    /// More sweep lines, the same cleat run, and the beginning of records, or longer windows.
    pub medium: Evidence,
    /// All fitted runs.
    pub fine: Evidence,
    /// True if the coarse data have windows of records instead of their beginning.
    pub has_windows: bool,
    /// Windows of records between those of the coarse and of the medium data, and between these and whole records, each
    /// twice as long as the ones before. A fit to short windows leaves a small frequency error. In windows that are
    /// much longer it would grow to a phase error of a whole period, and the search would end in a local minimum.
    pub longer: [Vec<Evidence>; 2],
}

impl Fidelity {
    /// For a search that begins near the right model. The coarse and the medium data keep only the cleat run with the
    /// highest obstacle, since the simulation of a cleat run takes as long as that of many sweeps.
    pub fn of(evidence: &Evidence) -> Self {
        let mut rides: Vec<usize> = (0..evidence.runs.len())
            .filter(|&run| evidence.runs[run].role == Role::Fit && is_ride(&evidence.runs[run].stimulus))
            .collect();
        rides.sort_by(|&a, &b| evidence.runs[b].level.total_cmp(&evidence.runs[a].level));
        let keep = |run: usize| {
            let own = &evidence.runs[run];
            own.role == Role::Fit && (!is_ride(&own.stimulus) || rides.first() == Some(&run))
        };
        let few = evidence.only(keep);
        Self {
            coarse: few.thinned(DECIMATION[0]),
            medium: few.thinned(DECIMATION[1]),
            fine: evidence.only(|run| evidence.runs[run].role == Role::Fit),
            has_windows: false,
            longer: [Vec::new(), Vec::new()],
        }
    }

    /// For a search that may begin far from the right model: records are cut into windows first. `None` if no record
    /// can be cut.
    pub fn in_windows(evidence: &Evidence) -> Option<Self> {
        let usual = Self::of(evidence);
        let doubled = |first: f64| (1..).map(move |n| first * 2.0_f64.powi(n));
        let to_medium = doubled(PERIODS[0]).take_while(|&periods| periods < PERIODS[1]);
        let to_fine = doubled(PERIODS[1]);
        Some(Self {
            longer: [
                to_medium
                    .map_while(|periods| usual.medium.in_windows(periods))
                    .collect(),
                to_fine.map_while(|periods| usual.fine.in_windows(periods)).collect(),
            ],
            coarse: usual.coarse.in_windows(PERIODS[0])?,
            medium: usual.medium.in_windows(PERIODS[1]).unwrap_or(usual.medium),
            has_windows: true,
            ..usual
        })
    }
}

fn is_ride(stimulus: &Stimulus) -> bool {
    matches!(stimulus, Stimulus::Cleat(_))
}
