//! Arguments and results of an evaluation.

/// Deflection and forces of a tyre that rolls over a profile; `T` is a number, or one number for each parameter set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact<T = f64> {
    /// Equivalent stretch, m: minus the deflection on a flat road that would have the same contact.
    pub s: T,
    /// Its rate, m/s.
    pub v: T,
    /// The force on the wheel along [`crate::ContactAbout::axes`], N.
    pub force: [T; 2],
}

/// Number of parameter sets, or of lines of a frequency response, that are computed together.
pub const LANES: usize = 8;

/// One value for each of several parameter sets.
pub type Lanes = [f64; LANES];

impl<T: Copy> Contact<T> {
    /// Deflection, rate, and the forces in z and x: the order in which programs read them.
    #[must_use]
    pub fn entries(&self) -> [T; 4] {
        [self.s, self.v, self.force[0], self.force[1]]
    }
}

impl Contact {
    /// The contact with these entries, of which there are four.
    pub(crate) fn of_entries(entries: &[f64]) -> Self {
        Self {
            s: entries[0],
            v: entries[1],
            force: [entries[2], entries[3]],
        }
    }
}

/// Contacts of the tyres of several parameter sets.
pub type Contacts = Contact<Lanes>;

impl Contacts {
    /// The contact of a set.
    #[inline]
    pub fn get(&self, set: usize) -> Contact {
        Contact {
            s: self.s[set],
            v: self.v[set],
            force: [self.force[0][set], self.force[1][set]],
        }
    }

    /// Sets the contact of a set.
    #[inline]
    pub fn set(&mut self, set: usize, contact: &Contact) {
        (self.s[set], self.v[set]) = (contact.s, contact.v);
        (self.force[0][set], self.force[1][set]) = (contact.force[0], contact.force[1]);
    }
}

/// Calls `work` for each set with its values, and stores the results in the rows `into`.
pub(crate) fn one_by_one(
    from: [&[Lanes]; 3],
    into: &mut [Lanes],
    mut work: impl FnMut(&[f64], &[f64], &[f64], &mut [f64]),
) {
    let mut of_set = from.map(|rows| vec![0.0; rows.len()]);
    let mut found = vec![0.0; into.len()];
    for set in 0..LANES {
        for (values, rows) in of_set.iter_mut().zip(from) {
            values.iter_mut().zip(rows).for_each(|(value, row)| *value = row[set]);
        }
        let [a, b, c] = &of_set;
        work(a, b, c, &mut found);
        into.iter_mut().zip(&found).for_each(|(row, value)| row[set] = *value);
    }
}

/// States and inputs at several points as a structure of arrays, so that a model can compute many points at once.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// Number of points.
    pub count: usize,
    /// A row of `count` points for each state.
    pub x: &'a [f64],
    /// A row of `count` points for each input.
    pub u: &'a [f64],
}

impl Points<'_> {
    /// Calls `work` for each point with its states and inputs, and stores the results in the rows `into`.
    pub(crate) fn one_by_one(&self, into: &mut [f64], mut work: impl FnMut(&[f64], &[f64], &mut [f64])) {
        let room = |rows: &[f64]| vec![0.0; rows.len() / self.count.max(1)];
        let (mut x, mut u, mut found) = (room(self.x), room(self.u), room(into));
        let take = |rows: &[f64], point: usize, column: &mut [f64]| {
            let rows = rows.iter().skip(point).step_by(self.count);
            column.iter_mut().zip(rows).for_each(|(value, row)| *value = *row);
        };
        for point in 0..self.count {
            take(self.x, point, &mut x);
            take(self.u, point, &mut u);
            work(&x, &u, &mut found);
            for (row, value) in into.chunks_exact_mut(self.count).zip(&found) {
                row[point] = *value;
            }
        }
    }
}

/// Destination of a frequency response: a structure of arrays, with a row of `omega.len()` lines for each entry.
pub struct ResponseMut<'a> {
    /// Real parts, row after row, in the order of [`crate::ResponseLayout::outputs`].
    pub re: &'a mut [f64],
    /// Imaginary parts.
    pub im: &'a mut [f64],
    /// Real and imaginary parts of the parameter Jacobian, in the order of [`crate::ResponseLayout::jacobian`]; `None`
    /// if it is not wanted.
    pub jacobian: Option<(&'a mut [f64], &'a mut [f64])>,
}
