//! The runs of a campaign.

/// The runs of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Programme {
    /// Sweeps on the 4-poster.
    pub sweeps: Vec<SweepRun>,
    /// Velocity levels of the dynamic bounce on the K&C rig, mm/s. Without any, the campaign has no K&C curves.
    pub kc: Vec<u32>,
    /// Drives over cleats on the track.
    pub cleats: Vec<CleatRun>,
    /// Whether the body carries sensors.
    pub body_sensor: bool,
}

/// A sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepRun {
    /// Peak velocity of the pad, mm/s.
    pub level: u32,
    /// Hz.
    pub from: f64,
    /// Hz.
    pub to: f64,
    /// s.
    pub seconds: f64,
    /// `fit` or `held_out`.
    pub role: &'static str,
}

/// A drive over a cleat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CleatRun {
    /// mm.
    pub height: u32,
    /// Index of the speed.
    pub number: u32,
    /// km/h.
    pub speed: f64,
    /// s.
    pub seconds: f64,
    /// `fit` or `held_out`.
    pub role: &'static str,
}

impl CleatRun {
    /// The text that seeds the noise of the run.
    pub fn stream(&self) -> u32 {
        1000 * self.height + self.number
    }
}

const FIT: &str = "fit";
const HELD_OUT: &str = "held_out";

impl Programme {
    /// Five sweeps, K&C curves and twelve drives.
    pub fn full() -> Self {
        let levels = [(5, HELD_OUT), (25, FIT), (50, HELD_OUT), (100, FIT), (150, HELD_OUT)];
        Self {
            sweeps: levels.map(|(level, role)| sweep(level, 42.25, role)).to_vec(),
            kc: vec![25, 75, 125],
            cleats: all_cleats(),
            body_sensor: true,
        }
    }

    /// Three short sweeps, K&C curves and three short drives.
    pub fn fast() -> Self {
        Self {
            sweeps: vec![sweep(25, 16.0, FIT), sweep(50, 16.0, HELD_OUT), sweep(100, 16.0, FIT)],
            kc: vec![75],
            cleats: vec![
                cleat(10, 1, 1.0, FIT),
                cleat(20, 0, 1.0, HELD_OUT),
                cleat(30, 2, 1.0, FIT),
            ],
            body_sensor: true,
        }
    }

    /// Three short sweeps and K&C curves, without drives.
    pub fn without_cleats(mut self) -> Self {
        self.cleats.clear();
        self
    }

    /// The fast programme without the body's sensors.
    pub fn no_body_sensor() -> Self {
        Self {
            body_sensor: false,
            ..Self::fast()
        }
    }

    /// A single sweep and nothing else.
    pub fn one_sweep(level: u32) -> Self {
        Self {
            sweeps: vec![sweep(level, 42.25, FIT)],
            kc: Vec::new(),
            cleats: Vec::new(),
            body_sensor: true,
        }
    }

    /// Four drives and nothing else.
    pub fn cleats_alone() -> Self {
        Self {
            sweeps: Vec::new(),
            kc: Vec::new(),
            cleats: vec![
                cleat(10, 1, 1.5, FIT),
                cleat(20, 0, 1.5, FIT),
                cleat(30, 1, 1.5, HELD_OUT),
                cleat(40, 2, 1.5, FIT),
            ],
            body_sensor: true,
        }
    }

    /// Sweeps over a part of the band, given in Hz, and K&C curves.
    pub fn band(from: f64, to: f64) -> Self {
        let mut programme = Self::fast().without_cleats();
        for sweep in &mut programme.sweeps {
            (sweep.from, sweep.to) = (from, to);
        }
        programme
    }
}

/// Drives at three speeds over four heights. Of each speed one height in four is fitted, so that fitted and held-out
/// drives are spread over speeds and heights.
fn all_cleats() -> Vec<CleatRun> {
    let of_height = |height: u32| {
        (0..3).map(move |number| {
            let fitted = (height / 10 + number).is_multiple_of(4);
            cleat(height, number, 1.5, if fitted { FIT } else { HELD_OUT })
        })
    };
    [10, 20, 30, 40].into_iter().flat_map(of_height).collect()
}

fn sweep(level: u32, seconds: f64, role: &'static str) -> SweepRun {
    SweepRun {
        level,
        from: 0.5,
        to: 30.0,
        seconds,
        role,
    }
}

fn cleat(height: u32, number: u32, seconds: f64, role: &'static str) -> CleatRun {
    CleatRun {
        height,
        number,
        speed: 20.0 + 10.0 * f64::from(number),
        seconds,
        role,
    }
}
