//! The road of the track: a cleat.

/// A cleat, sampled every millimetre: flat road, a vertical step, a descent and a smooth return.
pub struct Road {
    pub z: Vec<f64>,
    pub slope: Vec<f64>,
}

/// Spacing of the samples, m.
pub const SPACING: f64 = 1e-3;
const START: f64 = 1.5;

impl Road {
    /// No cleat.
    pub fn flat() -> Self {
        let rest = vec![0.0; 18_001];
        Self {
            z: rest.clone(),
            slope: rest,
        }
    }

    /// The profile of a cleat of height `h`, m, on 18 m of road: 78 % of it lost on a straight descent, the rest on
    /// a return whose slope fades like a cosine, so that the curvature is continuous.
    pub fn cleat(h: f64) -> Self {
        let straight = 0.366;
        let slope = 0.78 * h / straight;
        let rest = 0.22 * h;
        let fade = 2.0 * rest / slope;
        let z = |x: f64| {
            let along = x - START;
            let u = ((along - straight) / fade).min(1.0);
            if along < SPACING / 2.0 {
                0.0
            } else if along < straight {
                h - slope * along
            } else {
                rest - slope * fade / 2.0 * (u + (std::f64::consts::PI * u).sin() / std::f64::consts::PI)
            }
        };
        let z: Vec<f64> = (0..=18_000).map(|i| z(f64::from(i) * SPACING)).collect();
        let slope = (0..z.len())
            .map(|i| {
                if i + 1 < z.len() {
                    (z[i + 1] - z[i]) / SPACING
                } else {
                    0.0
                }
            })
            .collect();
        Self { z, slope }
    }

    /// Height of the road at a position, m.
    pub fn height(&self, x: f64) -> f64 {
        let place = (x / SPACING).clamp(0.0, (self.z.len() - 2) as f64);
        let i = place as usize;
        self.z[i] + (self.z[i + 1] - self.z[i]) * (place - i as f64)
    }

    /// The greatest height between two positions, m: the top of the step, or that at an end if the step is not between
    /// them.
    pub fn highest(&self, from: f64, to: f64) -> f64 {
        let top = (START / SPACING) as usize + 1;
        if (from..=to).contains(&(top as f64 * SPACING)) {
            return self.z[top];
        }
        self.height(from).max(self.height(to))
    }
}
