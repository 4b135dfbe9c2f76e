//! Ratios as logarithms, for the fit.
//!
//! A magnitude in dB and a phase are the two parts of `ln T`, and `ln (N/D) = ln N − ln D`: the logarithm of each
//! signal is computed once, however many channels use it. A channel is a difference of two logarithms, and its
//! derivatives are the differences of theirs.

use super::Response;
use super::parameters::Values;
use super::signal::Term;
use crate::model::Model;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// The logarithms of some signals, and their derivatives along some parameters, on the grid of a [`Response`].
pub struct Logarithms {
    terms: Vec<Term>,
    columns: usize,
    /// For each term the entries of the response's Jacobian by column. Other columns are always zero.
    sources: Vec<BTreeMap<usize, Vec<usize>>>,
    /// For each term the logarithm of its power of jω, `k ln ω`, which depends on no parameter.
    offset: Vec<Vec<f64>>,
    /// `1/N` of the current term, so that its derivatives need no division.
    reciprocal: (Vec<f64>, Vec<f64>),
    lines: usize,
    magnitude: Vec<f64>,
    angle: Vec<f64>,
    d_magnitude: Vec<f64>,
    d_angle: Vec<f64>,
}

impl Logarithms {
    /// Prepares for `terms` and for derivatives along the parameters `free`, each together with those tied to it.
    pub fn new<M: Model + ?Sized>(
        response: &Response<'_, M>,
        terms: Vec<Term>,
        values: &Values,
        free: &[usize],
    ) -> Self {
        let (lines, columns) = (response.omega().len(), free.len());
        let sources = terms
            .iter()
            .map(|term| sources(response, *term, values, free))
            .collect();
        let power_of = |term: &Term| {
            response
                .omega()
                .iter()
                .map(|omega| f64::from(term.power) * omega.ln())
                .collect()
        };
        Self {
            offset: terms.iter().map(power_of).collect(),
            reciprocal: (vec![0.0; lines], vec![0.0; lines]),
            sources,
            columns,
            lines,
            magnitude: vec![0.0; terms.len() * lines],
            angle: vec![0.0; terms.len() * lines],
            d_magnitude: vec![0.0; terms.len() * columns * lines],
            d_angle: vec![0.0; terms.len() * columns * lines],
            terms,
        }
    }

    /// Takes the logarithms of an evaluated response.
    pub fn evaluate<M: Model + ?Sized>(&mut self, response: &Response<'_, M>) {
        for term in 0..self.terms.len() {
            self.take(term, response);
            self.differentiate(term, response);
        }
    }

    /// `ln |signal|` and its angle (rad, not unwrapped) for each line.
    pub fn signal(&self, term: usize) -> (&[f64], &[f64]) {
        let range = term * self.lines..(term + 1) * self.lines;
        (&self.magnitude[range.clone()], &self.angle[range])
    }

    /// Their derivatives along a column.
    pub fn slope(&self, term: usize, column: usize) -> (&[f64], &[f64]) {
        let range = self.slope_range(term, column);
        (&self.d_magnitude[range.clone()], &self.d_angle[range])
    }

    fn slope_range(&self, term: usize, column: usize) -> std::ops::Range<usize> {
        let start = (term * self.columns + column) * self.lines;
        start..start + self.lines
    }

    fn take<M: Model + ?Sized>(&mut self, term: usize, response: &Response<'_, M>) {
        let range = term * self.lines..(term + 1) * self.lines;
        let turn = FRAC_PI_2 * f64::from(self.terms[term].power);
        let (magnitude, angle) = (&mut self.magnitude[range.clone()], &mut self.angle[range]);
        let offset = &self.offset[term];
        let Some(row) = self.terms[term].row else {
            magnitude.copy_from_slice(offset);
            angle.fill(turn);
            return;
        };
        let (re, im) = response.row(row);
        for line in 0..offset.len() {
            magnitude[line] = 0.5 * (re[line] * re[line] + im[line] * im[line]).ln() + offset[line];
            angle[line] = im[line].atan2(re[line]) + turn;
        }
    }

    /// `d ln N = dN / N`.
    fn differentiate<M: Model + ?Sized>(&mut self, term: usize, response: &Response<'_, M>) {
        let Some(row) = self.terms[term].row else { return };
        self.invert(response.row(row));
        for (&column, entries) in &self.sources[term] {
            let range = self.slope_range(term, column);
            let (magnitude, angle) = (&mut self.d_magnitude[range.clone()], &mut self.d_angle[range]);
            magnitude.fill(0.0);
            angle.fill(0.0);
            for &entry in entries {
                let into = (&mut *magnitude, &mut *angle);
                add_product(into, response.entry(entry), (&self.reciprocal.0, &self.reciprocal.1));
            }
        }
    }

    fn invert(&mut self, (re, im): (&[f64], &[f64])) {
        let (to_re, to_im) = (&mut self.reciprocal.0[..re.len()], &mut self.reciprocal.1[..re.len()]);
        for line in 0..re.len() {
            let scale = 1.0 / (re[line] * re[line] + im[line] * im[line]);
            to_re[line] = re[line] * scale;
            to_im[line] = -im[line] * scale;
        }
    }
}

/// `into += a b` of complex rows.
fn add_product(into: (&mut [f64], &mut [f64]), a: (&[f64], &[f64]), b: (&[f64], &[f64])) {
    let lines = into.0.len();
    let (into_re, into_im) = (&mut into.0[..lines], &mut into.1[..lines]);
    let (a_re, a_im, b_re, b_im) = (&a.0[..lines], &a.1[..lines], &b.0[..lines], &b.1[..lines]);
    for line in 0..lines {
        into_re[line] += a_re[line] * b_re[line] - a_im[line] * b_im[line];
        into_im[line] += a_re[line] * b_im[line] + a_im[line] * b_re[line];
    }
}

fn sources<M: Model + ?Sized>(
    response: &Response<'_, M>,
    term: Term,
    values: &Values,
    free: &[usize],
) -> BTreeMap<usize, Vec<usize>> {
    let column = |parameter: u16| {
        free.iter()
            .position(|&free| free == values.leader(usize::from(parameter)))
    };
    let entries = response.layout().jacobian.iter().enumerate();
    let own = entries.filter(|(_, (row, _))| term.row == Some(usize::from(*row)));
    let mut sources = BTreeMap::<usize, Vec<usize>>::new();
    for (entry, (_, parameter)) in own {
        if let Some(column) = column(*parameter) {
            sources.entry(column).or_default().push(entry);
        }
    }
    sources
}
