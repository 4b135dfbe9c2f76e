//! Prefix integrals over the ground, from which the contact's area and first moments follow.

/// Integrals of the height over x, between two points of the ground, about some centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    /// `∫ z dx`, m².
    pub area: f64,
    /// `∫ x z dx`, m³.
    pub x: f64,
    /// `∫ z²/2 dx`, m³.
    pub z: f64,
}

impl Moments {
    /// Of a straight piece of ground.
    pub fn straight(from: [f64; 2], to: [f64; 2]) -> Self {
        let [dx, dz] = [to[0] - from[0], to[1] - from[1]];
        let sum = from[1] + to[1];
        Self {
            area: dx * sum / 2.0,
            x: dx * ((from[0] + to[0]) * sum / 4.0 + dx * dz / 12.0),
            z: dx * (sum * sum - from[1] * to[1]) / 6.0,
        }
    }

    pub fn plus(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            x: self.x + other.x,
            z: self.z + other.z,
        }
    }

    pub fn minus(self, other: Self) -> Self {
        Self {
            area: self.area - other.area,
            x: self.x - other.x,
            z: self.z - other.z,
        }
    }
}

/// The integrals from the first vertex to each vertex, about the origin of the road.
#[derive(Clone, Debug)]
pub(crate) struct Integrals(Vec<Moments>);

impl Integrals {
    pub fn new(vertices: &[[f64; 2]]) -> Self {
        let mut sums = vec![Moments::default()];
        for pair in vertices.windows(2) {
            sums.push(sums[sums.len() - 1].plus(Moments::straight(pair[0], pair[1])));
        }
        Self(sums)
    }

    /// The integrals from one vertex to another about `centre`.
    pub fn between(&self, vertices: &[[f64; 2]], from: usize, to: usize, centre: [f64; 2]) -> Moments {
        let [x0, z0] = centre;
        let sum = self.0[to].minus(self.0[from]);
        let (a, b) = (vertices[from][0], vertices[to][0]);
        let width = b - a;
        let middle = (a + b) / 2.0 - x0;
        Moments {
            area: sum.area - z0 * width,
            x: sum.x - x0 * sum.area - z0 * width * middle,
            z: sum.z - z0 * sum.area + z0 * z0 * width / 2.0,
        }
    }
}
