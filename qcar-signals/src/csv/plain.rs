//! Rows with numbers alone, which are read in one pass over their bytes, without splitting them into cells.

use super::Decimals;

/// Reads rows of which each cell is a number without separated thousands, or empty.
pub(super) struct PlainRows {
    delimiter: u8,
    decimals: Decimals,
    /// The last line, with decimal points.
    line: Vec<u8>,
    numbers: Vec<f64>,
}

impl PlainRows {
    pub(super) fn new(delimiter: u8, decimals: Decimals) -> Self {
        PlainRows {
            delimiter,
            decimals,
            line: Vec::new(),
            numbers: Vec::new(),
        }
    }

    /// The `width` cells of a line, NaN for an empty one; `None` if it has others, or anything that is not plain.
    pub(super) fn read(&mut self, line: &[u8], width: usize) -> Option<&[f64]> {
        let line = match self.decimals {
            Decimals::Point => line,
            Decimals::Comma => {
                self.line.clear();
                self.line.extend(line.iter().map(with_point));
                &self.line
            }
        };
        self.numbers.clear();
        let mut rest = line;
        for left in (0..width).rev() {
            let (number, length) = number(trimmed(&mut rest), self.delimiter)?;
            self.numbers.push(number);
            rest = &rest[length..];
            if self.delimiter != b' ' {
                trimmed(&mut rest);
            }
            match rest.split_first() {
                Some((&byte, after)) if byte == self.delimiter => rest = after,
                None if left == 0 => {}
                _ => return None,
            }
        }
        let is_filled = self.numbers.iter().any(|number| !number.is_nan());
        (is_filled && trimmed(&mut rest).is_empty()).then_some(&self.numbers)
    }
}

/// A byte of a number with a decimal comma, as it would be with a point.
fn with_point(byte: &u8) -> u8 {
    match byte {
        b',' => b'.',
        b'.' => b',',
        other => *other,
    }
}

/// Removes the spaces at the beginning.
fn trimmed<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    while let [b' ', after @ ..] = rest {
        *rest = after;
    }
    rest
}

/// The number at the beginning, NaN for an empty cell, and its length.
fn number(rest: &[u8], delimiter: u8) -> Option<(f64, usize)> {
    match rest.first() {
        None if delimiter == b' ' => None,
        None => Some((f64::NAN, 0)),
        Some(byte) if *byte == delimiter => Some((f64::NAN, 0)),
        // `inf` and `nan` are numbers to the parser.
        Some(_) => fast_float2::parse_partial(rest)
            .ok()
            .filter(|(number, _): &(f64, usize)| number.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::rows::{Row, Rows};
    use super::{Decimals, PlainRows};

    /// The cells as they are read one by one; `None` if one is no number.
    fn cell_by_cell(line: &str, delimiter: u8, decimals: Decimals) -> Option<Vec<f64>> {
        let mut row = Row::default();
        Rows::new(line, delimiter).read(&mut row).ok()?;
        row.cells.iter().map(|cell| decimals.number(cell)).collect()
    }

    fn bits(numbers: &[f64]) -> Vec<u64> {
        numbers.iter().map(|number| number.to_bits()).collect()
    }

    #[test]
    fn rows_are_plain_or_read_cell_by_cell() {
        let (nan, semicolon) = (f64::NAN, b';');
        let cases: [(u8, Decimals, &str, Option<&[f64]>); 16] = [
            (semicolon, Decimals::Comma, "1,5;-2;3e-2", Some(&[1.5, -2.0, 0.03])),
            (semicolon, Decimals::Comma, " 1,5 ; ;+3 ", Some(&[1.5, nan, 3.0])),
            (semicolon, Decimals::Comma, "1;2;3;", Some(&[1.0, 2.0, 3.0])),
            (semicolon, Decimals::Comma, "1;2;", Some(&[1.0, 2.0, nan])),
            (semicolon, Decimals::Comma, "1.234,5;2;3", None),
            (semicolon, Decimals::Comma, "1;2", None),
            (semicolon, Decimals::Comma, "1;2;3;4", None),
            (semicolon, Decimals::Comma, ";;", None),
            (semicolon, Decimals::Point, "1;nan;3", None),
            (semicolon, Decimals::Point, "1;inf;3", None),
            (semicolon, Decimals::Point, "1;2 mm;3", None),
            (semicolon, Decimals::Point, "1;2e;3", None),
            (b',', Decimals::Point, "1.5,\"2\",3", None),
            (b',', Decimals::Point, "1.5,,3", Some(&[1.5, nan, 3.0])),
            (b' ', Decimals::Point, "  1   2 3  ", Some(&[1.0, 2.0, 3.0])),
            (b' ', Decimals::Point, "1 2 ", None),
        ];
        for (delimiter, decimals, line, expected) in cases {
            let mut rows = PlainRows::new(delimiter, decimals);
            assert_eq!(rows.read(line.as_bytes(), 3).map(bits), expected.map(bits), "`{line}`");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_plain_row_has_the_numbers_of_its_cells(
            line in "([ +-]?[0-9]{0,20}[.,;\t|]?[0-9.,]{0,18}(e-?[0-9]{1,3})?[ ]{0,2}[;,\t| ]){1,5}",
            delimiter in prop::sample::select(&b";,\t| "[..]),
            comma in any::<bool>(),
            width in 1_usize..7,
        ) {
            let decimals = if comma && delimiter != b',' { Decimals::Comma } else { Decimals::Point };
            let mut rows = PlainRows::new(delimiter, decimals);
            if let Some(numbers) = rows.read(line.as_bytes(), width) {
                let cells = cell_by_cell(&line, delimiter, decimals).unwrap();
                prop_assert_eq!(bits(numbers), bits(&cells[..width]));
                prop_assert!(cells[width..].iter().all(|cell| cell.is_nan()));
            }
        }
    }
}
