//! Fits a table into a width: texts and headings continue on further lines, and columns without room follow below the
//! table.

use super::{SPACE, Shape, lines};

/// Smallest width of a column of texts.
const TEXT: usize = 14;
/// Characters after which a word may be broken.
const JOINTS: [char; 5] = ['_', '/', ',', '-', ']'];

/// The width of a table.
pub(super) fn total(shapes: &[Shape]) -> usize {
    shapes.iter().map(|(width, _)| width).sum::<usize>() + SPACE.len() * shapes.len().saturating_sub(1)
}

/// The text of a table that is wider than `width`.
pub(super) fn text(rows: &[Vec<String>], shapes: &[Shape], width: usize) -> String {
    let shapes = shrunk(rows, shapes, width);
    let parts = parts(&shapes, width).into_iter().map(|columns| {
        let shapes: Vec<Shape> = columns.iter().map(|at| shapes[*at]).collect();
        let of_row = |row: &Vec<String>| below(columns.iter().map(|at| row[*at].as_str()), &shapes);
        let head = of_row(&rows[0]);
        let count = head.len();
        let all: Vec<Vec<String>> = head.into_iter().chain(rows[1..].iter().flat_map(of_row)).collect();
        lines(&all, &shapes, count)
    });
    parts.collect::<Vec<_>>().join("\n")
}

/// Makes columns narrower until the table fits or no column can become narrower: first headings of numbers, which need
/// no further line in the rows, then texts, the widest first.
fn shrunk(rows: &[Vec<String>], shapes: &[Shape], width: usize) -> Vec<Shape> {
    let all = shapes.iter().enumerate();
    let least: Vec<usize> = all.map(|(at, shape)| narrowest(rows, at, *shape)).collect();
    let mut shapes = shapes.to_vec();
    while total(&shapes) > width {
        let yielding = shapes.iter().enumerate().filter(|(at, shape)| shape.0 > least[*at]);
        let Some((at, _)) = yielding.max_by_key(|(_, (width, numeric))| (*numeric, *width)) else {
            break;
        };
        shapes[at].0 -= 1;
    }
    shapes
}

/// Numbers and words of their headings are not broken.
fn narrowest(rows: &[Vec<String>], column: usize, (width, numeric): Shape) -> usize {
    let numbers = || {
        rows[1..]
            .iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let words = || {
        rows[0][column]
            .split_inclusive(JOINTS)
            .map(|word| word.chars().count())
            .max()
    };
    match numeric {
        true => numbers().max(words().unwrap_or(0)).min(width),
        false => TEXT.min(width),
    }
}

/// Divides the columns into parts that fit side by side. The column with the names of the rows is repeated in each
/// part.
fn parts(shapes: &[Shape], width: usize) -> Vec<Vec<usize>> {
    let names = shapes
        .iter()
        .take_while(|(_, numeric)| !numeric)
        .count()
        .clamp(1, shapes.len());
    let names = if 2 * total(&shapes[..names]) > width { 1 } else { names };
    let head: Vec<usize> = (0..names).collect();
    let mut parts = vec![head.clone()];
    for at in names..shapes.len() {
        let part = parts.last_mut().expect("there is a part from the beginning");
        part.push(at);
        let wide: Vec<Shape> = part.iter().map(|at| shapes[*at]).collect();
        if total(&wide) > width && part.len() > names + 1 {
            part.pop();
            parts.push([head.as_slice(), &[at]].concat());
        }
    }
    parts
}

/// A row as several lines, in which a long cell continues below its beginning.
fn below<'a>(cells: impl Iterator<Item = &'a str>, shapes: &[Shape]) -> Vec<Vec<String>> {
    let pieces: Vec<Vec<String>> = cells
        .zip(shapes)
        .map(|(cell, (width, _))| broken(cell, *width))
        .collect();
    let high = pieces.iter().map(Vec::len).max().unwrap_or(0);
    let row = |line: usize| {
        pieces
            .iter()
            .map(|own| own.get(line).cloned().unwrap_or_default())
            .collect()
    };
    (0..high).map(row).collect()
}

/// A text in pieces of at most `width` characters, broken between words, else after one of the joints, else anywhere.
fn broken(text: &str, width: usize) -> Vec<String> {
    let mut pieces = Vec::new();
    let mut rest: Vec<char> = text.chars().collect();
    while rest.len() > width {
        let space = rest[..=width].iter().rposition(|c| *c == ' ').filter(|at| *at > 0);
        let joint = rest[..width].iter().rposition(|c| JOINTS.contains(c)).map(|at| at + 1);
        let end = space.or(joint).unwrap_or(width.max(1));
        pieces.push(rest[..end].iter().collect());
        rest.drain(..end);
        let spaces = rest.iter().take_while(|c| **c == ' ').count();
        rest.drain(..spaces);
    }
    pieces.push(rest.into_iter().collect());
    pieces
}

#[cfg(test)]
mod tests {
    use super::broken;
    use crate::table::Table;

    #[test]
    fn a_cell_goes_on_below() {
        assert_eq!(broken("measured_after_shake", 9), ["measured_", "after_", "shake"]);
        assert_eq!(broken("one two three", 7), ["one two", "three"]);
        assert_eq!(broken("unbreakable", 4), ["unbr", "eaka", "ble"]);
        assert_eq!(broken("", 4), [""]);
    }

    #[test]
    fn every_cell_is_there_within_any_width() {
        let mut table = Table::with_headings((0..20).map(|at| format!("column_{at}_dB")).collect());
        let cell = |at: usize| {
            if at == 0 {
                "the name of this row".into()
            } else {
                format!("{}.25", 100 + at)
            }
        };
        table.row((0..20).map(cell).collect());
        for width in [40, 60, 100] {
            let text = table.within(Some(width));
            assert!(
                text.lines().all(|line| line.chars().count() <= width),
                "{width}\n{text}"
            );
            for at in 1..20 {
                assert_eq!(text.matches(&cell(at)).count(), 1, "{width}\n{text}");
            }
        }
        assert_eq!(table.within(None).lines().count(), 2);
    }
}
