//! The road under a rolling tyre: straight pieces and vertical steps, level beyond its ends.
//!
//! Curved profiles are sampled so densely that a chord may replace the curve between two samples. A contact needs
//! integrals over the ground between two points, which are differences of two prefix integrals. So a query costs the
//! same for a plank and for a measured road of a million samples.

use crate::shown::{rounded, shown, six_digits};

mod bounds;
mod integrals;
// What a road is made from: samples, shapes, noise.
mod iso8608;
mod samples;
mod shapes;

pub(crate) use bounds::{Bounds, Circle};
pub(crate) use integrals::{Integrals, Moments};
pub use iso8608::{Class, Random};
pub use shapes::Shape;

/// Height of the ground over distance, level beyond the first and the last point.
#[derive(Clone, Debug)]
pub struct Road {
    vertices: Vec<[f64; 2]>,
    segments: Vec<Segment>,
    integrals: Integrals,
    bounds: Bounds,
    index: Index,
}

/// A straight piece of ground, `origin + s·along` for `start <= s <= end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    pub origin: [f64; 2],
    pub along: [f64; 2],
    pub start: f64,
    pub end: f64,
}

/// Reason why something is no road for a tyre: what was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[expect(missing_docs, reason = "the message says it")]
pub enum RoadError {
    #[error("{}", points(*.found))]
    TooFew { found: usize },
    #[error("columns x, z and slope of {x}, {z} and {slope} values")]
    Lengths { x: usize, z: usize, slope: usize },
    #[error("{value} as {column} of sample {sample}")]
    NotFinite {
        column: &'static str,
        sample: usize,
        value: f64,
    },
    #[error("x that falls from {} to {} at sample {sample}", shown(*.before, "m"), shown(*.x, "m"))]
    NotMonotonic { sample: usize, before: f64, x: f64 },
    #[error("a road with all points at x = {}", shown(*.x, "m"))]
    NoLength { x: f64 },
    #[error("slope {} at x = {}, where the heights rise by {} m per m", six_digits(*.slope), shown(*.x, "m"), six_digits(*.rise))]
    SlopeContradictsHeight { x: f64, slope: f64, rise: f64 },
    #[error("slopes that are {} times as steep as the heights rise over x", rounded(*.factor, 3))]
    SlopeInOtherUnit { factor: f64 },
    #[error(
        "a road rougher than its sampling: leaving out a sample changes it by {share:.2} of its own standard deviation"
    )]
    Rough { share: f64, limit: f64 },
    #[error("a road that ends at x = {}", shown(*.end, "m"))]
    TooShort { end: f64, needed: f64 },
    #[error("a {name} of {}", shown(*.value, "m"))]
    Shape {
        name: &'static str,
        expected: &'static str,
        value: f64,
    },
}

fn points(found: usize) -> String {
    match found {
        0 => "a road without points".into(),
        1 => "a road of one point".into(),
        more => format!("a road of {more} points"),
    }
}

impl RoadError {
    /// What a road for a tyre must have.
    #[must_use]
    pub fn expected(&self) -> String {
        match self {
            Self::TooFew { .. } => "two points or more".into(),
            Self::Lengths { .. } => "columns of one length".into(),
            Self::NotFinite { .. } => "a finite number".into(),
            Self::NotMonotonic { .. } => "x that never decreases; two points at one x are a step".into(),
            Self::NoLength { .. } => "points at several x".into(),
            Self::SlopeContradictsHeight { .. } | Self::SlopeInOtherUnit { .. } => {
                "a slope that leads to the next height".into()
            }
            Self::Rough { limit, .. } => format!("a change of at most {limit}, so that a tyre can roll on chords"),
            Self::TooShort { needed, .. } => format!("one that reaches x = {}, as the run does", shown(*needed, "m")),
            Self::Shape { expected, .. } => (*expected).into(),
        }
    }

    /// How the road can be mended.
    #[must_use]
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Rough { .. } => "sample the profile finer, or smooth it",
            Self::SlopeContradictsHeight { .. } => {
                "leave out the column `slope`, or give the slope of the segment to the right of each point; a step stands alone"
            }
            Self::SlopeInOtherUnit { .. } => {
                "correct the units of x, z and slope in the header line, such as `z [mm]`, or leave out the column `slope`"
            }
            Self::TooShort { .. } => "lengthen the road, or shorten the ride",
            _ => "correct the profile: finite numbers, from left to right",
        }
    }
}

impl Road {
    /// A road through points `[x, z]` in m, used unchanged: two points at one x are a vertical step.
    ///
    /// # Errors
    /// Fails if there are fewer than two points, if a number is not finite, or if x decreases.
    pub fn from_points(points: &[[f64; 2]]) -> Result<Self, RoadError> {
        samples::check_points(points)?;
        Ok(Self::through(samples::simplify(points, samples::EXACT)))
    }

    /// A road through samples of x (m), height z (m) and slope of the segment to the right of each sample.
    ///
    /// If the slope of a sample leads to the next one (within 0.1 of the slope of the chord), the road follows the
    /// chord. Otherwise it follows the slope, then steps vertically at the next sample. Samples on one line within 1
    /// µm, the resolution of such files, become one segment.
    ///
    /// # Errors
    /// Fails if columns differ in length, if there are too few samples, if a number is not finite, if x decreases, if a
    /// slope contradicts the heights at two successive samples, if the slopes are a multiple of the rises of the heights
    /// (by a factor above 2 or below 1/2, as a wrong unit gives it), or if the road is too rough for its sampling: it
    /// changes by more than a quarter of its standard deviation (RMS) if each sample is replaced by the line through
    /// its neighbours, which for a sine is about nine samples per wavelength. A few points at uneven distances, whose
    /// slopes lead exactly from one to the next, are corners of a profile and not samples of a curve; a cleat may be
    /// given by them.
    pub fn from_samples(x: &[f64], z: &[f64], slope: &[f64]) -> Result<Self, RoadError> {
        let points = samples::points(x, z, slope)?;
        if !samples::are_corners(x, &points, slope) {
            samples::check_roughness(&points)?;
        }
        Ok(Self::through(samples::simplify(&points, samples::RESOLUTION)))
    }

    /// A shape after `run_in` metres of flat road, followed by flat road.
    ///
    /// # Errors
    /// Fails if a dimension of the shape or the run-in is not positive.
    pub fn from_shape(shape: &Shape, run_in: f64) -> Result<Self, RoadError> {
        Self::from_points(&shape.points(run_in)?)
    }

    /// A random road of ISO 8608.
    ///
    /// # Errors
    /// Fails if a length or spacing does not suit the band of wavelengths of the standard.
    pub fn from_random(random: &Random) -> Result<Self, RoadError> {
        Self::from_points(&random.points()?)
    }

    /// A flat road at height `z` (m).
    pub fn flat(z: f64) -> Self {
        Self::through(vec![[0.0, z], [1.0, z]])
    }

    /// The same road with flat ground after its end, at least to `x` (m).
    pub fn reaching(&self, x: f64) -> Self {
        let [end, z] = *self.vertices.last().expect("a road has points");
        let further = (x > end).then_some([x, z]);
        let points: Vec<_> = self.vertices.iter().copied().chain(further).collect();
        Self::through(samples::simplify(&points, samples::EXACT))
    }

    /// The same road with its first point at x = 0.
    pub fn beginning_at_zero(&self) -> Self {
        let first = self.vertices[0][0];
        Self::through(self.vertices.iter().map(|&[x, z]| [x - first, z]).collect())
    }

    /// The same road for a wheel that rolls the other way: x becomes -x.
    pub fn mirrored(&self) -> Self {
        Self::through(self.vertices.iter().rev().map(|&[x, z]| [-x, z]).collect())
    }

    /// Points where the straight pieces meet, m.
    pub fn vertices(&self) -> &[[f64; 2]] {
        &self.vertices
    }

    /// Height in m at `x`; at a step, that on its right side.
    pub fn height(&self, x: f64) -> f64 {
        let segment = self.segments[self.segment_at(x)];
        segment.origin[1] + (x - segment.origin[0]) * segment.along[1] / segment.along[0]
    }

    /// Slope at `x`; at a vertex, that on its right side.
    pub fn slope(&self, x: f64) -> f64 {
        let [dx, dz] = self.segments[self.segment_at(x)].along;
        dz / dx
    }

    /// First and last x of the described road, m.
    pub fn extent(&self) -> [f64; 2] {
        [self.vertices[0][0], self.vertices[self.vertices.len() - 1][0]]
    }

    /// Positions of vertical steps, m, at which a solver starts a new step.
    pub fn steps(&self) -> impl Iterator<Item = f64> {
        self.vertices.windows(2).filter(|w| w[0][0] == w[1][0]).map(|w| w[0][0])
    }

    /// Positions of steps and kinks, m, without the small turns between the chords of a curve.
    pub(crate) fn edges(&self) -> impl Iterator<Item = [f64; 2]> {
        /// Smallest sine of the angle of a kink, in either direction.
        const SHARP: f64 = 0.02;
        let turn = |[a, b]: [[f64; 2]; 2]| a[0] * b[1] - a[1] * b[0];
        let turns = self.segments.windows(2).map(move |w| turn([w[0].along, w[1].along]));
        let sharp = turns.zip(&self.vertices).filter(|(turn, _)| turn.abs() > SHARP);
        sharp.map(|(_, vertex)| *vertex)
    }

    /// Refuses a run that would leave the road.
    ///
    /// # Errors
    /// [`RoadError::TooShort`] if the road ends before `needed` (m).
    pub fn check_reaches(&self, needed: f64) -> Result<(), RoadError> {
        let end = self.extent()[1];
        if needed <= end {
            Ok(())
        } else {
            Err(RoadError::TooShort { end, needed })
        }
    }

    /// The piece at `x`; piece `k` is between vertices `k - 1` and `k`.
    #[inline]
    pub(crate) fn segment_at(&self, x: f64) -> usize {
        self.index.vertices_up_to(&self.vertices, x)
    }

    #[inline]
    pub(crate) fn segment(&self, k: usize) -> &Segment {
        &self.segments[k]
    }

    /// True if no other piece than `k` is below the circle.
    #[inline]
    pub(crate) fn carries(&self, k: usize, circle: &Circle) -> bool {
        let ([from, to], [x, _]) = (self.span(k), circle.centre);
        from <= x - circle.radius && x + circle.radius <= to
    }

    /// Start and end of piece `k`, m; the outer pieces are infinite.
    #[inline]
    pub(crate) fn span(&self, k: usize) -> [f64; 2] {
        let before = k.checked_sub(1).and_then(|k| self.vertices.get(k));
        let from = before.map_or(f64::NEG_INFINITY, |vertex| vertex[0]);
        [from, self.vertices.get(k).map_or(f64::INFINITY, |vertex| vertex[0])]
    }

    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Integrals over the ground between two vertices.
    pub(crate) fn between(&self, from: usize, to: usize, centre: [f64; 2]) -> Moments {
        self.integrals.between(&self.vertices, from, to, centre)
    }

    fn through(vertices: Vec<[f64; 2]>) -> Self {
        let segments = segments(&vertices);
        let integrals = Integrals::new(&vertices);
        let bounds = Bounds::new(&segments);
        let index = Index::new(&vertices);
        Self {
            vertices,
            segments,
            integrals,
            bounds,
            index,
        }
    }
}

/// Computes all other data of a road from its points.
impl PartialEq for Road {
    fn eq(&self, other: &Self) -> bool {
        self.vertices == other.vertices
    }
}

impl Segment {
    /// The point at `s`.
    pub fn at(&self, s: f64) -> [f64; 2] {
        [self.origin[0] + s * self.along[0], self.origin[1] + s * self.along[1]]
    }

    fn between(from: [f64; 2], to: [f64; 2]) -> Self {
        let [dx, dz] = [to[0] - from[0], to[1] - from[1]];
        let length = dx.hypot(dz);
        Self {
            origin: from,
            along: [dx / length, dz / length],
            start: 0.0,
            end: length,
        }
    }

    fn flat(origin: [f64; 2], start: f64, end: f64) -> Self {
        Self {
            origin,
            along: [1.0, 0.0],
            start,
            end,
        }
    }
}

fn segments(vertices: &[[f64; 2]]) -> Vec<Segment> {
    let before = Segment::flat(vertices[0], f64::NEG_INFINITY, 0.0);
    let after = Segment::flat(vertices[vertices.len() - 1], 0.0, f64::INFINITY);
    let inner = vertices.windows(2).map(|w| Segment::between(w[0], w[1]));
    std::iter::once(before)
        .chain(inner)
        .chain(std::iter::once(after))
        .collect()
}

/// Cells of equal width with the number of vertices before each, so that a search passes only few vertices.
#[derive(Clone, Debug)]
struct Index {
    first: f64,
    cells_per_metre: f64,
    vertices_before: Vec<u32>,
}

impl Index {
    const CELLS_PER_VERTEX: usize = 8;

    fn new(vertices: &[[f64; 2]]) -> Self {
        let cells = vertices.len() * Self::CELLS_PER_VERTEX;
        let [first, last] = [vertices[0][0], vertices[vertices.len() - 1][0]];
        let cells_per_metre = if last > first {
            cells as f64 / (last - first)
        } else {
            0.0
        };
        let mut index = Self {
            first,
            cells_per_metre,
            vertices_before: vec![0; cells],
        };
        for vertex in vertices {
            let cell = index.cell(vertex[0]);
            if cell + 1 < cells {
                index.vertices_before[cell + 1] += 1;
            }
        }
        for cell in 1..cells {
            index.vertices_before[cell] += index.vertices_before[cell - 1];
        }
        index
    }

    #[inline]
    fn cell(&self, x: f64) -> usize {
        // The cast saturates: points before the road fall into the first cell, points after it into the last.
        (((x - self.first) * self.cells_per_metre) as usize).min(self.vertices_before.len() - 1)
    }

    #[inline]
    fn vertices_up_to(&self, vertices: &[[f64; 2]], x: f64) -> usize {
        let before = self.vertices_before[self.cell(x)] as usize;
        before + vertices[before..].iter().take_while(|vertex| vertex[0] <= x).count()
    }
}
