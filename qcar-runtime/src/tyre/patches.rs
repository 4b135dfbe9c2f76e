//! Parts of the road inside the circle, patch by patch from the rear to the front.

use crate::road::{Circle, Moments, Road, Segment};

/// A stretch of ground inside the circle; points are relative to the circle's centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Where the ground enters the circle.
    pub from: [f64; 2],
    /// Where it leaves the circle.
    pub to: [f64; 2],
    /// Integrals over the ground between the two.
    pub ground: Moments,
}

/// The line of a piece of road, seen from the centre of a circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    origin: [f64; 2],
    along: [f64; 2],
    start: f64,
    end: f64,
    /// Position on the line of the point nearest to the centre.
    foot: f64,
    /// Height of the centre above the line; negative below it.
    pub distance: f64,
    /// Negative for a line outside the circle.
    half_chord_squared: f64,
}

/// The part of a piece of road that is inside a circle, from one place on its line to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clip {
    pub from: f64,
    pub to: f64,
}

/// Possible start of a patch: the piece of road, and the point on it.
type Place = (usize, [f64; 2]);

/// First and last piece of road that can reach into the circle; `None` if even the highest ground cannot.
#[inline]
pub(super) fn candidates(road: &Road, circle: &Circle) -> Option<(usize, usize)> {
    let clearance = (circle.centre[1] - road.bounds().highest).max(0.0);
    let reach_squared = circle.radius * circle.radius - clearance * clearance;
    if reach_squared <= 0.0 {
        return None;
    }
    let (x, reach) = (circle.centre[0], reach_squared.sqrt());
    Some((road.segment_at(x - reach), road.segment_at(x + reach)))
}

/// Calls `each` with the patches on the pieces `first` to `last` of the road.
#[inline]
pub(super) fn patches(road: &Road, circle: &Circle, (first, last): (usize, usize), mut each: impl FnMut(Patch)) {
    let mut open: Option<Place> = None;
    let mut k = first;
    while k <= last {
        if let Some(next) = road.bounds().skip(k, last, circle) {
            k = next;
            continue;
        }
        let line = Line::new(road.segment(k), circle);
        let clip = line.clip();
        // By rounding, neighbours may disagree on whether their common vertex is inside; the patch ends there.
        let goes_on = clip.is_some_and(|clip| clip.from == line.start);
        if let Some(entry) = open.filter(|_| !goes_on) {
            each(Patch::between(road, circle, entry, (k, line.at(line.start))));
        }
        let entry = open.take().filter(|_| goes_on);
        if let Some(clip) = clip {
            let entry = entry.unwrap_or((k, line.at(clip.from)));
            if clip.to == line.end {
                open = Some(entry);
            } else {
                each(Patch::between(road, circle, entry, (k, line.at(clip.to))));
            }
        }
        k += 1;
    }
    if let Some(entry) = open {
        let line = Line::new(road.segment(last), circle);
        each(Patch::between(road, circle, entry, (last, line.at(line.end))));
    }
}

impl Patch {
    fn between(road: &Road, circle: &Circle, (first, from): Place, (last, to): Place) -> Self {
        if first == last {
            return Self {
                from,
                to,
                ground: Moments::straight(from, to),
            };
        }
        let vertex = |k: usize| {
            let [x, z] = road.vertices()[k];
            [x - circle.centre[0], z - circle.centre[1]]
        };
        let ground = Moments::straight(from, vertex(first))
            .plus(road.between(first, last - 1, circle.centre))
            .plus(Moments::straight(vertex(last - 1), to));
        Self { from, to, ground }
    }
}

impl Line {
    #[inline(always)]
    pub fn new(segment: &Segment, circle: &Circle) -> Self {
        let [ax, az] = segment.along;
        let origin = [
            segment.origin[0] - circle.centre[0],
            segment.origin[1] - circle.centre[1],
        ];
        let distance = az * origin[0] - ax * origin[1];
        Self {
            origin,
            along: segment.along,
            start: segment.start,
            end: segment.end,
            foot: -(ax * origin[0] + az * origin[1]),
            distance,
            half_chord_squared: circle.radius * circle.radius - distance * distance,
        }
    }

    /// The part inside the circle; `None` without one.
    #[inline]
    pub fn clip(&self) -> Option<Clip> {
        let inside = |place: f64| (place - self.foot) * (place - self.foot) < self.half_chord_squared;
        let (start_inside, end_inside) = (inside(self.start), inside(self.end));
        if start_inside && end_inside {
            return Some(Clip {
                from: self.start,
                to: self.end,
            });
        }
        let dips_in = self.half_chord_squared > 0.0 && self.start < self.foot && self.foot < self.end;
        if !(start_inside || end_inside || dips_in) {
            return None;
        }
        let half = self.half_chord_squared.sqrt();
        Some(Clip {
            from: if start_inside { self.start } else { self.foot - half },
            to: if end_inside { self.end } else { self.foot + half },
        })
    }

    /// The part of the line inside the circle, and true if a part of it is inside the piece.
    #[inline(always)]
    pub fn chord(&self) -> (Clip, bool) {
        let half = self.half_chord_squared.sqrt();
        let clip = Clip {
            from: self.foot - half,
            to: self.foot + half,
        };
        let outside = |place: f64| (place - self.foot) * (place - self.foot) >= self.half_chord_squared;
        let is_between = (self.start < self.foot) & (self.foot < self.end);
        let is_inside = (self.half_chord_squared > 0.0) & is_between & outside(self.start) & outside(self.end);
        (clip, is_inside)
    }

    /// A point of the line, relative to the centre.
    #[inline(always)]
    pub fn at(&self, place: f64) -> [f64; 2] {
        [
            self.origin[0] + place * self.along[0],
            self.origin[1] + place * self.along[1],
        ]
    }

    /// The unit vectors along the line and across it, up from the ground.
    #[inline(always)]
    pub fn frame(&self) -> ([f64; 2], [f64; 2]) {
        (self.along, [-self.along[1], self.along[0]])
    }

    /// Distance of a position ahead of the foot.
    pub fn ahead(&self, place: f64) -> f64 {
        place - self.foot
    }
}
