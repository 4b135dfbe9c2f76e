//! Contact geometry of a rolling tyre: the intersection of the road with the circle of the unloaded tyre.
//!
//! The geometry gives an equivalent deflection (that on a flat road with the same contact), its rate split into growth
//! and shrinkage, and the direction in which each part pushes. The magnitude is the law of a link in the model file,
//! `f(s, v)` with the stretch `s` = -deflection; see [`Touch::force`].
//!
//! The ground under the circle is assumed to be below the wheel centre. Several separate patches are allowed.
//!
//! # A law for the link (figures 3.8 and 3.9 of the thesis)
//!
//! With the static load `F0` at the static deflection `d0` and the stiffness `k` there, the parabola
//! `F(d) = a d + b d²` with `a = 2 F0/d0 - k` and `b = (k - F0/d0)/d0` is smooth, passes through zero and the static
//! point and has slope `k` there. It is progressive for `k >= F0/d0`, and falls nowhere for `k <= 2 F0/d0`.
//! As a resisting force of the stretch: `a s - b s² + c v` for `s < 0`.

mod series;
// The unloaded circle of the tyre.
mod circle;
// Intervals in which the road is inside the circle.
mod patches;
// The area that the circle sweeps as it moves.
mod sweep;
// The three geometries.
mod area;
mod point;
mod radial;
// From geometry to force.
mod force;
// Several wheels together.
mod abreast;

pub(crate) use abreast::{Pieces, Wheels};
pub use area::Overlap;
pub use circle::{segment_area, segment_deflection};

use std::cell::Cell;

use crate::road::{Road, Segment};
use crate::shown::shown;

/// A tyre's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    radius: f64,
    geometry: Geometry,
    rates: Rates,
    static_deflection: f64,
    /// Factor from the change of a contact at the static deflection to a rate.
    static_rate: f64,
}

/// Contact geometry: how the road acts on the tyre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    /// Height below the wheel centre, vertically (thesis 3.3.2.1).
    Point,
    /// Overlap area of circle and ground (thesis 3.3.2.2).
    Area,
    /// Springs along the radii (thesis 2.4.3.2).
    Radial,
}

/// The deflection at which a change of the contact is converted to the rate of the equivalent deflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rates {
    /// At the static deflection: the ratio is a constant (thesis 3.3.2.2).
    AtStaticDeflection,
    /// At the present equivalent deflection: the rate is the derivative of that deflection.
    AtDeflection,
}

/// The motion of a wheel's centre over the road, `[x, z]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Position, m.
    pub position: [f64; 2],
    /// Velocity, m/s.
    pub velocity: [f64; 2],
}

/// A contact between tyre and road; directions are unit vectors `[x, z]` from the contact to the wheel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Deflection on a flat road that would give the same contact, m, positive.
    pub deflection: f64,
    /// From the centroid of the contact.
    pub direction: [f64; 2],
    /// The part in which the circle enters the ground.
    pub growth: Change,
    /// The part in which it leaves the ground.
    pub shrinkage: Change,
}

/// A part of the change of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Rate of the equivalent deflection, m/s, never negative.
    pub rate: f64,
    /// Direction from the centroid of this part; zero without such a part.
    pub direction: [f64; 2],
}

/// Reason why numbers are no tyre.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("found {}, expected {}", self.found(), self.expected())]
#[expect(missing_docs, reason = "the message says it")]
pub enum TyreError {
    Radius { radius: f64 },
    StaticDeflection { deflection: f64, radius: f64 },
}

impl TyreError {
    /// What was found.
    pub fn found(&self) -> String {
        match self {
            TyreError::Radius { radius } => format!("a tyre's radius of {}", shown(*radius, "m")),
            TyreError::StaticDeflection { deflection, .. } => {
                format!("a static deflection of {}", shown(*deflection, "m"))
            }
        }
    }

    /// What was expected.
    pub fn expected(&self) -> String {
        match self {
            TyreError::Radius { .. } => "more than 0".into(),
            TyreError::StaticDeflection { radius, .. } => {
                format!("more than 0 and less than the radius, {}", shown(*radius, "m"))
            }
        }
    }
}

impl Tyre {
    /// A tyre of unloaded `radius` (m) that its static load deflects by `static_deflection` (m) on a flat road.
    ///
    /// # Errors
    /// Fails if the radius is not positive, or if the static deflection is not between zero and the radius.
    pub fn new(radius: f64, static_deflection: f64, geometry: Geometry, rates: Rates) -> Result<Self, TyreError> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(TyreError::Radius { radius });
        }
        if !(static_deflection > 0.0 && static_deflection < radius) {
            return Err(TyreError::StaticDeflection {
                deflection: static_deflection,
                radius,
            });
        }
        let tyre = Self {
            radius,
            geometry,
            rates,
            static_deflection,
            static_rate: 0.0,
        };
        Ok(tyre.with_geometry(geometry))
    }

    /// Unloaded radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Deflection under the static load on a flat road, m.
    pub fn static_deflection(&self) -> f64 {
        self.static_deflection
    }

    /// Contact geometry.
    pub fn geometry(&self) -> Geometry {
        self.geometry
    }

    /// The same tyre with another contact geometry.
    pub fn with_geometry(self, geometry: Geometry) -> Self {
        let tyre = Self { geometry, ..self };
        Self {
            static_rate: tyre.rate_at(self.static_deflection),
            ..tyre
        }
    }

    /// Length of the contact with a flat road at the static deflection, m.
    pub fn patch(&self) -> f64 {
        2.0 * (self.static_deflection * (2.0 * self.radius - self.static_deflection)).sqrt()
    }

    /// The contact of a wheel with a road; `None` if the circle is clear of the ground.
    ///
    /// Allocates nothing. Its time hardly depends on the sampling of the road (except for [`Geometry::Radial`], which
    /// evaluates each piece of the road in the circle).
    pub fn touch(&self, road: &Road, wheel: &Wheel) -> Option<Touch> {
        self.touch_near(road, wheel, &Cell::new(0))
    }

    /// As [`Tyre::touch`], starting with the piece of road that was under the wheel before.
    ///
    /// If the circle is still over this piece alone, as most of the time, no search is needed.
    #[inline(always)]
    pub(crate) fn touch_near(&self, road: &Road, wheel: &Wheel, piece: &Cell<usize>) -> Option<Touch> {
        match self.geometry {
            Geometry::Area => area::touch(self, road, wheel, piece),
            Geometry::Point => point::touch(self, road, wheel),
            Geometry::Radial => radial::touch(self, road, wheel),
        }
    }

    /// The contact of a point tyre with one straight piece of the road, which goes on beyond its ends. Without contact,
    /// its deflection is negative.
    pub(crate) fn touch_piece(&self, piece: &Segment, wheel: &Wheel) -> Touch {
        point::touch_piece(self, piece, wheel)
    }

    /// The circle's overlap with the ground, in full.
    pub fn overlap(&self, road: &Road, wheel: &Wheel) -> Overlap {
        area::overlap(self.radius, road, wheel)
    }

    /// Area in m² that the circle has in common with a flat road at `deflection` (m), equation 3.4 of the thesis.
    #[inline]
    pub fn area(&self, deflection: f64) -> f64 {
        self.radius * self.radius * segment_area(deflection / self.radius)
    }

    /// Deflection in m on a flat road at which the circle has `area` (m²) in common with it.
    pub fn deflection(&self, area: f64) -> f64 {
        self.radius * segment_deflection(area / (self.radius * self.radius))
    }

    /// Factor from the change of a contact to the rate of the equivalent deflection, at this `deflection`.
    #[inline(always)]
    fn rate(&self, deflection: f64) -> f64 {
        match self.rates {
            Rates::AtStaticDeflection => self.static_rate,
            Rates::AtDeflection => self.rate_at(deflection),
        }
    }

    fn rate_at(&self, deflection: f64) -> f64 {
        match self.geometry {
            Geometry::Point => 1.0,
            Geometry::Area => 1.0 / (self.radius * circle::flat_chord(deflection / self.radius)),
            Geometry::Radial => 1.0 / (self.radius * radial::flat_damping(deflection / self.radius)),
        }
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn norm(v: [f64; 2]) -> f64 {
    dot(v, v).sqrt()
}

/// The vector with coordinates `v` in the frame of two others.
fn combined(v: [f64; 2], first: [f64; 2], second: [f64; 2]) -> [f64; 2] {
    [v[0] * first[0] + v[1] * second[0], v[0] * first[1] + v[1] * second[1]]
}

/// The unit vector against `v`; zero for zero.
fn against(v: [f64; 2]) -> [f64; 2] {
    let squared = dot(v, v);
    // The root and the quotient do not wait for each other.
    let scale = if squared >= f64::MIN_POSITIVE {
        -squared.sqrt() * squared.recip()
    } else {
        0.0
    };
    [v[0] * scale, v[1] * scale]
}
