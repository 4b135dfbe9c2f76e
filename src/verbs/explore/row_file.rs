//! A file filled with the rows of an ensemble, block by block.

use std::path::Path;

use qcar_runtime::ensemble::{Column, Ensemble, Rows};
use qcar_runtime::error::{InputError, Place, Problem};
use qcar_runtime::model::Model;

use super::existing_rows::ExistingRows;
use super::ledger::{Choice, FileState, Ledger};
use super::sink::{Sink, unfinished};
use crate::failure::Failure;
use crate::interruption;
use crate::progress::Showing;
use crate::table::{counted, noted};
use crate::units;

/// Rows of a block for each thread: enough to keep all threads busy, and little memory.
const ROWS_OF_THREAD: usize = 64;

/// Rows without metrics, and the reason for the first.
#[derive(Default)]
struct Failed {
    rows: usize,
    first: Option<(u64, String)>,
    /// Rows in which a channel is infinite at the resonance of an undamped mode, and the first set with one.
    infinite: usize,
    first_infinite: Option<u64>,
}

/// Writes all missing rows of a part, and describes the file.
///
/// # Errors
/// Fails if a file with other results has that name, or if it cannot be written. It is a finding if no row has metrics.
pub(super) fn fill<M: Model + ?Sized>(
    ensemble: &Ensemble<'_, M>,
    choice: &Choice,
    path: &Path,
) -> Result<String, Failure> {
    let columns = ensemble.columns();
    let headings: Vec<String> = columns.iter().map(|own| units::heading(&own.name, &own.unit)).collect();
    let sets = choice.part.sets(ensemble.design.count().unwrap_or(u64::MAX));
    let each = ensemble.rows_of_set() as u64;
    let rows = (sets.end - sets.start) * each;
    let ledger = Ledger::new(ensemble, choice, &headings, rows);
    let text = format!(
        "{}: {} of {}, {} in {}\n{}",
        ensemble.model.about().name,
        counted((sets.end - sets.start) as usize, "set"),
        choice.scheme,
        counted(rows as usize, "row"),
        path.display(),
        noted(choice.notices)
    );
    if ledger.file_state(path)? == FileState::Done {
        return Ok(text + "note: the file was already complete\n");
    }
    let resumed = "finished rows are in";
    interruption::note(&format!(
        "{resumed} {}; the same command resumes there",
        unfinished(path).display()
    ));
    let (mut sink, kept) = Sink::open(path, &headings, &ledger.text(), |row| (sets.start + row / each) as f64)?;
    if kept.rows > rows {
        return Err(not_ours(path, "more rows than there are").into());
    }
    // Computes the last row again, to detect rows of another program version.
    let from = sets.start + kept.rows.saturating_sub(1) / each;
    let failed = write(
        ensemble,
        &columns,
        (&mut sink, &kept),
        (from..sets.end, sets.start),
        path,
    )?;
    sink.finish()?;
    let text = text + &notes(&failed, &kept);
    match failed.rows as u64 == rows && rows > 0 {
        true => Err(Failure::Finding(text)),
        false => Ok(text),
    }
}

fn write<M: Model + ?Sized>(
    ensemble: &Ensemble<'_, M>,
    columns: &[Column],
    (sink, kept): (&mut Sink, &ExistingRows),
    (sets, first): (std::ops::Range<u64>, u64),
    path: &Path,
) -> Result<Failed, InputError> {
    let each = ensemble.rows_of_set() as u64;
    let block = (ROWS_OF_THREAD * rayon::current_num_threads()).div_ceil(each as usize) as u64;
    let showing = Showing::new();
    showing.step(format!("{}: after row", ensemble.model.about().name));
    let mut failed = Failed::default();
    let mut at = sets.start;
    let shown_rows = |at: u64| showing.count(((at - first) * each) as usize, ((sets.end - first) * each) as usize);
    shown_rows(at);
    while at < sets.end {
        let until = sets.end.min(at + block);
        let found = ensemble.rows(at..until);
        let numbers = shown(columns, &found);
        // Rows of this block that are already in the file are not written again.
        let known = kept.rows.saturating_sub((at - first) * each) as usize * columns.len();
        let (known, new) = numbers.split_at(known.min(numbers.len()));
        check_last(kept, known, columns.len(), path)?;
        sink.append(new)?;
        failed.count(at, &found, columns);
        at = until;
        shown_rows(at);
    }
    Ok(failed)
}

/// All numbers of a block, in the units of the user.
fn shown(columns: &[Column], block: &[Rows]) -> Vec<f64> {
    let numbers = block.iter().flat_map(|rows| &rows.numbers);
    let column = columns.iter().cycle();
    numbers
        .zip(column)
        .map(|(number, own)| units::value(*number, &own.unit))
        .collect()
}

/// # Errors
/// Fails if the last row of the file differs from the computed one.
fn check_last(kept: &ExistingRows, known: &[f64], width: usize, path: &Path) -> Result<(), InputError> {
    let (Some(last), Some(start)) = (&kept.last, known.len().checked_sub(width)) else {
        return Ok(());
    };
    let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
    match last.iter().zip(&known[start..]).all(same) {
        true => Ok(()),
        false => Err(not_ours(path, "rows that this program would not write")),
    }
}

fn not_ours(path: &Path, found: &str) -> InputError {
    let remedy = "remove it and its .design.json, or choose another file";
    let expected = "rows of this command, from a machine of this kind";
    Problem::new(unfinished(path), Place::File, found, expected, remedy).into()
}

impl Failed {
    fn count(&mut self, first: u64, block: &[Rows], columns: &[Column]) {
        let width = columns.len();
        let is_peak = |place: &usize| columns[*place].name.ends_with(".peak");
        let peaks: Vec<usize> = (0..width - 1).filter(is_peak).collect();
        // The height of such a peak is missing, its frequency is there.
        let is_infinite = |row: &&[f64]| {
            let mut pairs = peaks.iter().map(|&peak| [row[peak], row[peak + 1]]);
            row[width - 1] == 0.0 && pairs.any(|[height, frequency]| height.is_nan() && frequency.is_finite())
        };
        for (set, rows) in (first..).zip(block) {
            let failed = rows.numbers.chunks_exact(width).filter(|row| row[width - 1] != 0.0);
            self.rows += failed.count();
            let infinite = rows.numbers.chunks_exact(width).filter(is_infinite).count();
            self.infinite += infinite;
            if infinite > 0 {
                self.first_infinite.get_or_insert(set);
            }
            if let (None, Some(reason)) = (&self.first, &rows.failure) {
                self.first = Some((set, reason.clone()));
            }
        }
    }
}

fn notes(failed: &Failed, kept: &ExistingRows) -> String {
    let begun = match kept.rows {
        0 => String::new(),
        rows => format!("note: {rows} of them existed already\n"),
    };
    let has = |rows: usize| if rows == 1 { "has" } else { "have" };
    let missing = failed.first.as_ref().map_or(String::new(), |(set, reason)| {
        format!(
            "note: {} of the rows computed now {} no metrics; the first is set {set}: {}\n",
            failed.rows,
            has(failed.rows),
            reason.trim_end()
        )
    });
    let infinite = failed.first_infinite.map_or(String::new(), |set| {
        format!(
            "note: {} of the rows computed now {} no height of a peak, because a mode is undamped and its resonance \
             infinite; the first is set {set}\n",
            failed.infinite,
            has(failed.infinite)
        )
    });
    begun + &missing + &infinite
}
