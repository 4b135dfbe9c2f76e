//! The results of straight-line code over lines of a response.

use std::marker::PhantomData;

/// The lines of a response with `N` outputs and `R` results that a vector `V` holds: real parts, imaginary parts, and
/// those of the Jacobian.
pub struct LinesMut<'a, V, const N: usize, const R: usize> {
    /// The first of these lines in the first row of each part.
    pub(super) parts: [*mut f64; 4],
    /// Number of lines in a row.
    pub(super) lines: usize,
    of: PhantomData<(&'a mut [f64], V)>,
}

impl<'a, V, const N: usize, const R: usize> LinesMut<'a, V, N, R> {
    /// The lines from `first` on; a vector holds `lanes` of them.
    ///
    /// # Panics
    ///
    /// If there are fewer lines, or a part has no room for a row of each result.
    #[inline]
    pub(crate) fn new(parts: &'a mut [&mut [f64]; 4], lines: usize, first: usize, lanes: usize) -> Self {
        let slopes = R / 2 - N;
        assert!(lines >= lanes && first <= lines - lanes);
        let rows = [N, N, slopes, slopes];
        assert!(parts.iter().zip(rows).all(|(part, rows)| part.len() >= rows * lines));
        LinesMut {
            parts: parts.each_mut().map(|part| part.as_mut_ptr().wrapping_add(first)),
            lines,
            of: PhantomData,
        }
    }
}

/// The part and the row of a result. A macro, since rustc inlines a function only if it needs the same instructions as
/// its caller.
macro_rules! place_of_line {
    ($place:ident, $outputs:ident, $results:ident) => {{
        let slopes = $results / 2 - $outputs;
        assert!($place < $results);
        match $place {
            _ if $place < $outputs => (0, $place),
            _ if $place < 2 * $outputs => (1, $place - $outputs),
            _ if $place < 2 * $outputs + slopes => (2, $place - 2 * $outputs),
            _ => (3, $place - 2 * $outputs - slopes),
        }
    }};
}

pub(super) use place_of_line;
