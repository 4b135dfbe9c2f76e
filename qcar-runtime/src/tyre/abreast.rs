//! Area contacts of several wheels, each on its own straight piece of road: loops over the lanes, with the same bits as
//! for each wheel alone.

use super::area::with_rates;
use super::patches::Line;
use super::sweep::Sweeps;
use super::{Change, Geometry, Rates, Touch, Tyre};
use crate::model::{Contacts, LANES, Lanes};
use crate::road::{Circle, Road, Segment};

const NOTHING: Lanes = [0.0; LANES];

/// A straight piece of road under each wheel.
pub(crate) struct Pieces {
    origin: [Lanes; 2],
    along: [Lanes; 2],
    start: Lanes,
    end: Lanes,
    /// Start and end of each piece along x, m.
    span: [Lanes; 2],
}

/// Motion of the wheels.
pub(crate) struct Wheels {
    /// Positions, m.
    pub position: [Lanes; 2],
    /// Velocities, m/s.
    pub velocity: [Lanes; 2],
}

/// Contacts of the wheels with the pieces.
pub(crate) struct Touches {
    deflection: Lanes,
    direction: [Lanes; 2],
    /// Rate and direction.
    growth: [Lanes; 3],
    shrinkage: [Lanes; 3],
    /// True if the contact of a lane is valid: short, and with its piece only.
    pub holds: [bool; LANES],
}

impl Pieces {
    /// Pieces under no wheel.
    pub fn none() -> Self {
        Self {
            origin: [NOTHING; 2],
            along: [NOTHING; 2],
            start: NOTHING,
            end: NOTHING,
            span: [[f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]],
        }
    }

    /// Puts piece `k` of a road under a wheel.
    pub fn put(&mut self, lane: usize, road: &Road, k: usize) {
        let (segment, span) = (road.segment(k), road.span(k));
        for (rows, own) in [
            (&mut self.origin, segment.origin),
            (&mut self.along, segment.along),
            (&mut self.span, span),
        ] {
            rows.iter_mut().zip(own).for_each(|(row, own)| row[lane] = own);
        }
        (self.start[lane], self.end[lane]) = (segment.start, segment.end);
    }

    #[inline(always)]
    fn segment(&self, lane: usize) -> Segment {
        Segment {
            origin: at(&self.origin, lane),
            along: at(&self.along, lane),
            start: self.start[lane],
            end: self.end[lane],
        }
    }
}

impl Wheels {
    /// Wheels at rest.
    pub fn none() -> Self {
        Self {
            position: [NOTHING; 2],
            velocity: [NOTHING; 2],
        }
    }
}

/// Intermediate results of the loops over the lanes. A single loop with all of the work would not be vectorised.
struct Chords {
    from: [Lanes; 2],
    to: [Lanes; 2],
    /// Heights of the centres above the lines, m, and normals of the lines, pointing up.
    distance: Lanes,
    up: [Lanes; 2],
    is_inside: [bool; LANES],
}

/// Speeds and directions of the circles at their turning points, and sines and cosines of the ends of the chords.
struct Turns {
    speed: Lanes,
    along: [Lanes; 2],
    sine: [Lanes; 2],
    cosine: [Lanes; 2],
}

impl Tyre {
    /// The contacts of several such tyres with the pieces under them.
    #[inline(always)]
    pub(crate) fn touches(&self, pieces: &Pieces, wheels: &Wheels) -> Touches {
        // All other contacts are computed one by one.
        if self.geometry != Geometry::Area || self.rates != Rates::AtStaticDeflection {
            return Touches::none();
        }
        let (radius, rate) = (self.radius, self.static_rate);
        let chords = chords(radius, pieces, wheels);
        let turns = turns(radius, &chords, wheels);
        let mut touches = Touches::none();
        for lane in 0..LANES {
            let sweeps = Sweeps::turning(radius, turns.speed[lane], at(&turns.along, lane));
            let (parts, is_across) = sweeps.between((at(&turns.sine, lane), at(&turns.cosine, lane)));
            let deflection = radius - chords.distance[lane];
            touches.set(lane, &with_rates(rate, deflection, at(&chords.up, lane), parts));
            touches.holds[lane] = chords.is_inside[lane] & is_across;
        }
        touches
    }
}

#[inline(always)]
fn chords(radius: f64, pieces: &Pieces, wheels: &Wheels) -> Chords {
    let mut chords = Chords {
        from: [NOTHING; 2],
        to: [NOTHING; 2],
        distance: NOTHING,
        up: [NOTHING; 2],
        is_inside: [false; LANES],
    };
    for lane in 0..LANES {
        let centre = at(&wheels.position, lane);
        let is_carried = (pieces.span[0][lane] <= centre[0] - radius) & (centre[0] + radius <= pieces.span[1][lane]);
        let line = Line::new(&pieces.segment(lane), &Circle { centre, radius });
        let (chord, is_inside) = line.chord();
        let (from, to, up) = (line.at(chord.from), line.at(chord.to), line.frame().1);
        for axis in 0..2 {
            (chords.from[axis][lane], chords.to[axis][lane]) = (from[axis], to[axis]);
            chords.up[axis][lane] = up[axis];
        }
        chords.distance[lane] = line.distance;
        chords.is_inside[lane] = is_carried & is_inside;
    }
    chords
}

#[inline(always)]
fn turns(radius: f64, chords: &Chords, wheels: &Wheels) -> Turns {
    let mut turns = Turns {
        speed: NOTHING,
        along: [NOTHING; 2],
        sine: [NOTHING; 2],
        cosine: [NOTHING; 2],
    };
    for lane in 0..LANES {
        let sweeps = Sweeps::new(radius, at(&wheels.velocity, lane));
        let (speed, along) = sweeps.turn();
        let (sine, cosine) = sweeps.places([at(&chords.from, lane), at(&chords.to, lane)]);
        turns.speed[lane] = speed;
        for end in 0..2 {
            turns.along[end][lane] = along[end];
            (turns.sine[end][lane], turns.cosine[end][lane]) = (sine[end], cosine[end]);
        }
    }
    turns
}

/// The entries of a lane.
#[inline(always)]
fn at<const ROWS: usize>(rows: &[Lanes; ROWS], lane: usize) -> [f64; ROWS] {
    std::array::from_fn(|row| rows[row][lane])
}

impl Touches {
    fn none() -> Self {
        Self {
            deflection: NOTHING,
            direction: [NOTHING; 2],
            growth: [NOTHING; 3],
            shrinkage: [NOTHING; 3],
            holds: [false; LANES],
        }
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, touch: &Touch) {
        self.deflection[lane] = touch.deflection;
        for axis in 0..2 {
            self.direction[axis][lane] = touch.direction[axis];
            self.growth[1 + axis][lane] = touch.growth.direction[axis];
            self.shrinkage[1 + axis][lane] = touch.shrinkage.direction[axis];
        }
        (self.growth[0][lane], self.shrinkage[0][lane]) = (touch.growth.rate, touch.shrinkage.rate);
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Touch {
        let change = |of: &[Lanes; 3]| Change {
            rate: of[0][lane],
            direction: [of[1][lane], of[2][lane]],
        };
        Touch {
            deflection: self.deflection[lane],
            direction: [self.direction[0][lane], self.direction[1][lane]],
            growth: change(&self.growth),
            shrinkage: change(&self.shrinkage),
        }
    }

    /// As [`Touch::strains`]: stretches and rates for each of the three.
    #[inline(always)]
    pub fn strains(&self) -> [[Lanes; 2]; 3] {
        let mut strains = [[NOTHING; 2]; 3];
        for lane in 0..LANES {
            let own = self.get(lane).strains();
            for (strain, [s, v]) in strains.iter_mut().zip(own) {
                (strain[0][lane], strain[1][lane]) = (s, v);
            }
        }
        strains
    }

    /// As [`Touch::force`], from the forces of the laws at the strains.
    #[inline(always)]
    pub fn pushing(&self, resisting: &[Lanes; 3]) -> Contacts {
        let mut contacts = Contacts::default();
        for lane in 0..LANES {
            contacts.set(lane, &self.get(lane).pushing(at(resisting, lane)));
        }
        contacts
    }
}
