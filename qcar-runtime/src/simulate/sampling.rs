//! Sampling of signals as by a recorder: on a fine grid, through an anti-alias filter, at the sample rate.

use super::interpolation::SparseRange;
use crate::vectors::{Loops, widest};

/// The anti-alias filter: linear phase, without delay, flat within 0.02 % up to 0.4 of the sample rate.
///
/// A signal is computed on a grid finer than the sample rate and low-passed by a sinc with a Kaiser window (J. F.
/// Kaiser, "Nonrecursive digital filter design using the I0-sinh window function", 1974) of 80 dB. Frequencies above
/// 0.6 of the sample rate are stopped, so that aliases stay above 0.4 of it. Measuring systems do the same in their
/// converters, so a model must be sampled alike for a comparison of peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct AntiAlias {
    oversampling: usize,
    /// Centre tap, then those on one side; the filter is symmetric.
    taps: Vec<f64>,
}

impl AntiAlias {
    /// Points of the fine grid per sample, for continuous signals. Over a cleat the samples differ by at most 0.02 %
    /// from those with sixteen points.
    pub const CONTINUOUS: usize = 2;
    /// Points of the fine grid per sample, for signals with jumps.
    pub const JUMPING: usize = 16;
    /// Reach of the filter to each side, in samples.
    pub const REACH: usize = 13;

    const ATTENUATION: f64 = 80.0;

    /// The filter for a grid of `oversampling` points (at least 1) per sample. With one point it passes the signal
    /// unchanged, with all frequencies above half the sample rate.
    pub fn new(oversampling: usize) -> Self {
        let beta = 0.1102 * (Self::ATTENUATION - 8.7);
        let reach = (Self::REACH * oversampling) as i32;
        let tap = |i: i32| {
            let window = bessel_i0(beta * (1.0 - (f64::from(i) / f64::from(reach)).powi(2)).sqrt());
            // The cut-off of the ideal low-pass is half the sample rate.
            window * sinc(f64::from(i) / oversampling as f64)
        };
        let taps: Vec<f64> = (0..=reach).map(tap).collect();
        let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
        let taps = taps.iter().map(|tap| tap / sum).collect();
        Self { oversampling, taps }
    }

    /// Samples of a fine signal that begins [`AntiAlias::REACH`] samples before the first and ends as many after the
    /// last.
    pub fn decimate(&self, fine: &[f64]) -> Vec<f64> {
        let samples = fine
            .len()
            .saturating_sub(2 * (self.taps.len() - 1))
            .div_ceil(self.oversampling);
        let phase = |phase| fine[phase..].iter().step_by(self.oversampling).copied().collect();
        let phases: Vec<Vec<f64>> = (0..self.oversampling).map(phase).collect();
        self.decimate_phases(|phase| &phases[phase], samples)
    }

    /// The same for a signal that is stored phase by phase: points one sample apart are neighbours in memory, as the
    /// taps need them.
    fn decimate_phases<'a>(&self, phase: impl Fn(usize) -> &'a [f64], samples: usize) -> Vec<f64> {
        let mut out = vec![0.0; samples];
        widest(Decimation {
            filter: self,
            phase,
            out: &mut out,
        });
        out
    }
}

/// A signal that is stored phase by phase, and its filtered samples.
struct Decimation<'f, 'o, P> {
    filter: &'f AntiAlias,
    phase: P,
    out: &'o mut [f64],
}

impl<'a, P: Fn(usize) -> &'a [f64]> Loops for Decimation<'_, '_, P> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        let (every, taps, samples) = (self.filter.oversampling, &self.filter.taps, self.out.len());
        let from = |point: usize| &(self.phase)(point % every)[point / every..][..samples];
        let reach = taps.len() - 1;
        for (out, y) in self.out.iter_mut().zip(from(reach)) {
            *out = taps[0] * y;
        }
        // The taps are zero at whole samples: with two points per sample, every other one.
        let taps = taps.iter().enumerate().skip(1).filter(|(_, tap)| **tap != 0.0);
        for (distance, tap) in taps {
            let beside = from(reach - distance).iter().zip(from(reach + distance));
            for (out, (before, after)) in self.out.iter_mut().zip(beside) {
                *out += tap * (before + after);
            }
        }
    }
}

/// The fine grid of a recording.
pub(super) struct Grid {
    filter: AntiAlias,
    /// Distance of the points, s.
    spacing: f64,
    samples: usize,
}

impl Grid {
    /// The grid for `samples` samples (at least one) at `rate` (Hz), the first at time 0.
    pub fn new(rate: f64, samples: usize, oversampling: usize) -> Self {
        Self {
            filter: AntiAlias::new(oversampling),
            spacing: 1.0 / (rate * oversampling as f64),
            samples,
        }
    }

    /// Time of the first point, s.
    pub fn start(&self) -> f64 {
        self.time(0)
    }

    /// Distance of the points, s.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Time of the last point, s.
    pub fn end(&self) -> f64 {
        self.time(self.points() - 1)
    }

    /// The same time, without a recorded point.
    pub fn without_points(self) -> Self {
        Self { samples: 0, ..self }
    }

    /// Times with the largest whole number of samples between them that fits into `longest` (s), at least one; or half
    /// a sample if points are no closer and a whole sample is too long. The last point is among every second of them.
    pub fn steps(&self, longest: f64) -> Vec<f64> {
        let every = self.filter.oversampling;
        // Slightly more, so that rounding loses no sample.
        let samples = (longest / (self.spacing * every as f64) + 1e-6) as usize;
        let stride = if samples == 0 && every == AntiAlias::CONTINUOUS {
            every / 2
        } else {
            samples.max(1) * every
        };
        let first = (self.points() - 1) % (2 * stride);
        let points = (first..self.points()).step_by(stride);
        points.map(|point| self.time(point)).collect()
    }

    /// Number of points.
    fn points(&self) -> usize {
        match self.samples {
            0 => 0,
            samples => (samples - 1 + 2 * AntiAlias::REACH) * self.filter.oversampling + 1,
        }
    }

    /// Largest number of points one sample apart.
    fn points_of_phase(&self) -> usize {
        self.points().div_ceil(self.filter.oversampling)
    }

    fn time(&self, point: usize) -> f64 {
        let first = AntiAlias::REACH * self.filter.oversampling;
        (point as f64 - first as f64) * self.spacing
    }
}

/// Signals recorded on a fine grid, point by point.
pub(super) struct Tape {
    grid: Grid,
    /// The point to be recorded next.
    next: usize,
    /// The phases of each signal, one after the other.
    tracks: Vec<f64>,
    /// Number of samples at the beginning that are equal.
    still: usize,
    /// Ranges that were left out.
    sparse: Vec<SparseRange>,
}

impl Tape {
    /// An empty tape.
    pub fn new(grid: Grid, signals: usize) -> Self {
        Self::over(Vec::new(), grid, signals)
    }

    /// An empty tape in the memory of another one.
    pub fn over(mut room: Vec<f64>, grid: Grid, signals: usize) -> Self {
        room.resize(signals * grid.filter.oversampling * grid.points_of_phase(), 0.0);
        Self {
            next: 0,
            tracks: room,
            still: 0,
            sparse: Vec::new(),
            grid,
        }
    }

    /// Its memory, for another tape.
    pub fn into_buffer(self) -> Vec<f64> {
        self.tracks
    }

    /// Time of the point to be recorded next; `None` if it is after `end` (s).
    pub fn next(&self, end: f64) -> Option<f64> {
        let time = self.grid.time(self.next);
        (self.next < self.grid.points() && time <= end).then_some(time)
    }

    /// Records the same value of each signal at all points before `end` (s); no point must have been recorded.
    pub fn record_rest(&mut self, end: f64, values: impl Iterator<Item = f64>) {
        while self.next(end.next_down()).is_some() {
            self.next += 1;
        }
        if self.next == 0 {
            return;
        }
        let (every, length) = (self.grid.filter.oversampling, self.grid.points_of_phase());
        for (track, value) in self.tracks.chunks_exact_mut(every * length).zip(values) {
            for (phase, track) in track.chunks_exact_mut(length).enumerate() {
                track[..(self.next + every - 1 - phase) / every].fill(value);
            }
        }
        self.still = self.next / every;
    }

    /// Records the next point: a value for each signal.
    #[inline]
    pub fn record(&mut self, values: impl Iterator<Item = f64>) {
        let (every, length) = (self.grid.filter.oversampling, self.grid.points_of_phase());
        let first = self.next % every * length + self.next / every;
        for (track, value) in self.tracks.chunks_exact_mut(every * length).zip(values) {
            track[first] = value;
        }
        self.next += 1;
    }

    /// Adds an impulse of each signal at time `t` (s), in its unit times a second, to the recorded points beside it.
    pub fn add_impulse(&mut self, t: f64, impulses: impl Iterator<Item = f64>) {
        let (every, length) = (self.grid.filter.oversampling, self.grid.points_of_phase());
        let place = (t - self.grid.start()) / self.grid.spacing;
        if place < 0.0 || place + 1.0 >= self.grid.points() as f64 {
            return;
        }
        let (point, after) = (place as usize, place.fract());
        for (track, impulse) in self.tracks.chunks_exact_mut(every * length).zip(impulses) {
            for (point, share) in [(point, 1.0 - after), (point + 1, after)] {
                track[point % every * length + point / every] += share * impulse / self.grid.spacing;
            }
        }
    }

    /// Leaves out the points before a sample at time `t` (s).
    pub fn skip_to(&mut self, t: f64) {
        if self.next(t.next_down()).is_none() {
            return;
        }
        let every = self.grid.filter.oversampling;
        let from = self.next.saturating_sub(1) / every;
        while self.next(t.next_down()).is_some() {
            self.next += 1;
        }
        let to = self.next / every;
        match self.sparse.last_mut() {
            Some(range) if range.to == from && range.stride == to - from => range.to = to,
            _ => self.sparse.push(SparseRange {
                from,
                to,
                stride: to - from,
                reach: AntiAlias::REACH,
            }),
        }
    }

    /// Interpolates the points that were left out.
    pub fn fill_in(&mut self) {
        let (every, length) = (self.grid.filter.oversampling, self.grid.points_of_phase());
        for range in &self.sparse {
            range.fill(&mut self.tracks, (every, length));
        }
    }

    /// The samples of a signal through the filter.
    pub fn filtered(&self, signal: usize) -> Vec<f64> {
        let (filter, samples) = (&self.grid.filter, self.grid.samples);
        let mut out = Vec::with_capacity(samples);
        let filter_to = |out: &mut Vec<f64>, end: usize| {
            let from = out.len();
            if from == end {
                return;
            }
            out.extend(filter.decimate_phases(|phase| &self.track(signal, phase)[from..], end - from));
        };
        let still = 0..self.still.saturating_sub(2 * AntiAlias::REACH);
        for smooth in std::iter::once(still).chain(self.sparse.iter().map(SparseRange::all_smooth)) {
            // A smooth signal passes the filter unchanged.
            let (start, end) = (smooth.start.min(samples), smooth.end.min(samples));
            filter_to(&mut out, start);
            out.extend_from_slice(&self.plain(signal)[start..end]);
        }
        filter_to(&mut out, samples);
        out
    }

    /// The samples of a signal without the filter.
    pub fn plain(&self, signal: usize) -> &[f64] {
        &self.track(signal, 0)[AntiAlias::REACH..][..self.grid.samples]
    }

    fn track(&self, signal: usize, phase: usize) -> &[f64] {
        let length = self.grid.points_of_phase();
        &self.tracks[(signal * self.grid.filter.oversampling + phase) * length..][..length]
    }
}

fn sinc(x: f64) -> f64 {
    let angle = std::f64::consts::PI * x;
    if x == 0.0 {
        1.0
    } else if x.fract() == 0.0 {
        0.0
    } else {
        angle.sin() / angle
    }
}

/// The modified Bessel function of order zero, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let terms = (1..).scan(1.0, |term, k| {
        *term *= quarter / f64::from(k * k);
        Some(*term)
    });
    // Smaller terms change no digit.
    1.0 + terms.take_while(|term| *term > 1e-18).sum::<f64>()
}
