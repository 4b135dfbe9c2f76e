//! Boxes around groups of segments: most of the ground under a wheel is clearly inside or clearly outside its circle.

use super::Segment;

/// The unloaded outline of a wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circle {
    pub centre: [f64; 2],
    pub radius: f64,
}

/// Boxes around 4, 16, 64 … segments, level after level, and the highest ground of all.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    levels: Vec<Vec<Box>>,
    pub highest: f64,
}

#[derive(Clone, Copy, Debug)]
struct Box {
    low: [f64; 2],
    high: [f64; 2],
}

/// Segments or boxes in the next larger box, as a power of two.
const SHIFT: usize = 2;
/// Road nearer to the circle than this share of its radius squared is evaluated piece by piece.
const MARGIN: f64 = 1e-12;

impl Bounds {
    pub fn new(segments: &[Segment]) -> Self {
        let mut levels = vec![group(&segments.iter().map(Box::around).collect::<Vec<_>>())];
        while levels[levels.len() - 1].len() > 1 {
            levels.push(group(&levels[levels.len() - 1]));
        }
        let highest = levels[levels.len() - 1][0].high[1];
        Self { levels, highest }
    }

    /// The segment after the largest group that starts with segment `k`, ends up to `last` and does not cross `circle`.
    pub fn skip(&self, k: usize, last: usize, circle: &Circle) -> Option<usize> {
        let fits = |level: &usize| {
            let shift = SHIFT * (level + 1);
            k & ((1 << shift) - 1) == 0 && k + (1 << shift) <= last + 1
        };
        let largest = (0..self.levels.len()).take_while(fits).last()?;
        (0..=largest).rev().find_map(|level| {
            let shift = SHIFT * (level + 1);
            (!self.levels[level][k >> shift].may_cross(circle)).then_some(k + (1 << shift))
        })
    }
}

fn group(boxes: &[Box]) -> Vec<Box> {
    boxes
        .chunks(1 << SHIFT)
        .map(|chunk| chunk[1..].iter().fold(chunk[0], |all, one| all.with(one)))
        .collect()
}

impl Box {
    fn around(segment: &Segment) -> Self {
        let (from, to) = (segment.at(segment.start), segment.at(segment.end));
        let level = segment.along[1] == 0.0;
        let heights = if level {
            [segment.origin[1]; 2]
        } else {
            [from[1], to[1]]
        };
        Self {
            low: [from[0], heights[0].min(heights[1])],
            high: [to[0], heights[0].max(heights[1])],
        }
    }

    fn with(self, other: &Self) -> Self {
        let both = |f: fn(f64, f64) -> f64, a: [f64; 2], b: [f64; 2]| [f(a[0], b[0]), f(a[1], b[1])];
        Self {
            low: both(f64::min, self.low, other.low),
            high: both(f64::max, self.high, other.high),
        }
    }

    fn may_cross(&self, circle: &Circle) -> bool {
        let r2 = circle.radius * circle.radius;
        let (mut nearest, mut farthest) = (0.0, 0.0);
        for axis in 0..2 {
            let (below, above) = (
                self.low[axis] - circle.centre[axis],
                self.high[axis] - circle.centre[axis],
            );
            let gap = below.max(-above).max(0.0);
            let reach = above.max(-below);
            nearest += gap * gap;
            farthest += reach * reach;
        }
        nearest <= r2 * (1.0 + MARGIN) && farthest >= r2 * (1.0 - MARGIN)
    }
}
