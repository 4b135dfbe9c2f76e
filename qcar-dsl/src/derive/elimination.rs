//! Sparse symmetric systems solved symbolically: L D Lᵀ at compile time, over real or complex expressions.
//!
//! The unknown with the fewest neighbours is eliminated first, so that chains and trees of masses have no fill. Among
//! several the last is taken, since the excited and measured ones usually come first in a model. Zeros are structural
//! and cost nothing.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Expr, Graph};

/// A number that is an expression.
pub trait Scalar: Copy {
    /// 0
    fn zero(g: &mut Graph) -> Self;
    /// 1
    fn one(g: &mut Graph) -> Self;
    /// True for a structural zero.
    fn is_zero(self, g: &Graph) -> bool;
    /// `self + other`
    fn add(self, g: &mut Graph, other: Self) -> Self;
    /// `self - other`
    fn sub(self, g: &mut Graph, other: Self) -> Self;
    /// `self other`
    fn mul(self, g: &mut Graph, other: Self) -> Self;
    /// `self / other`
    fn div(self, g: &mut Graph, other: Self) -> Self;
    /// `factor self` for a real factor
    fn scale(self, g: &mut Graph, factor: Expr) -> Self;
}

impl Scalar for Expr {
    fn zero(g: &mut Graph) -> Self {
        g.constant(0.0)
    }

    fn one(g: &mut Graph) -> Self {
        g.constant(1.0)
    }

    fn is_zero(self, g: &Graph) -> bool {
        g.as_constant(self) == Some(0.0)
    }

    fn add(self, g: &mut Graph, other: Self) -> Self {
        g.add(self, other)
    }

    fn sub(self, g: &mut Graph, other: Self) -> Self {
        g.sub(self, other)
    }

    fn mul(self, g: &mut Graph, other: Self) -> Self {
        g.mul(self, other)
    }

    fn div(self, g: &mut Graph, other: Self) -> Self {
        g.div(self, other)
    }

    fn scale(self, g: &mut Graph, factor: Expr) -> Self {
        g.mul(factor, self)
    }
}

/// A symmetric matrix by its structural nonzeros.
#[derive(Clone, Debug)]
pub struct Symmetric<S> {
    size: usize,
    entries: BTreeMap<(usize, usize), S>,
}

impl<S: Scalar> Symmetric<S> {
    /// All zero.
    pub fn new(size: usize) -> Self {
        Symmetric {
            size,
            entries: BTreeMap::new(),
        }
    }

    /// Adds to an entry and to its transposed entry.
    pub fn add(&mut self, g: &mut Graph, i: usize, j: usize, value: S) {
        let place = (i.min(j), i.max(j));
        let sum = match self.entries.remove(&place) {
            Some(before) => before.add(g, value),
            None => value,
        };
        if !sum.is_zero(g) {
            self.entries.insert(place, sum);
        }
    }

    /// An entry; `None` if it is zero.
    pub fn get(&self, i: usize, j: usize) -> Option<S> {
        self.entries.get(&(i.min(j), i.max(j))).copied()
    }

    /// The nonzeros on and above the diagonal: row, column, value.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, S)> {
        self.entries.iter().map(|(&(i, j), &value)| (i, j, value))
    }

    /// The rows and columns of some unknowns, in their order.
    pub fn restricted(&self, unknowns: &[usize]) -> Self {
        let places: BTreeMap<usize, usize> = (0..).zip(unknowns).map(|(place, &unknown)| (unknown, place)).collect();
        let place = |i| places.get(&i).copied();
        let kept = self
            .iter()
            .filter_map(|(i, j, value)| Some((place(i)?, place(j)?, value)));
        let entries = kept.map(|(i, j, value)| ((i.min(j), i.max(j)), value)).collect();
        Symmetric {
            size: unknowns.len(),
            entries,
        }
    }
}

impl Symmetric<Expr> {
    /// Adds `factor h hᵀ` for a vector with few nonzeros.
    pub fn add_outer(&mut self, g: &mut Graph, h: &[(usize, Expr)], factor: Expr) {
        for (i, j, product) in outer(g, h) {
            let entry = g.mul(product, factor);
            self.add(g, i, j, entry);
        }
    }
}

/// `h hᵀ` on and above the diagonal, of a vector with few nonzeros: row, column, product.
pub fn outer(g: &mut Graph, h: &[(usize, Expr)]) -> Vec<(usize, usize, Expr)> {
    let pairs = h
        .iter()
        .enumerate()
        .flat_map(|(n, &left)| h[n..].iter().map(move |&right| (left, right)));
    pairs
        .map(|((i, left), (j, right))| (i, j, g.mul(left, right)))
        .collect()
}

/// The factors of a symmetric matrix.
#[derive(Clone, Debug)]
pub struct Factors<S> {
    /// In the order of elimination.
    steps: Vec<Step<S>>,
}

/// One unknown eliminated: its pivot, and its column of L.
#[derive(Clone, Debug)]
struct Step<S> {
    unknown: usize,
    pivot: S,
    column: Vec<(usize, S)>,
}

impl<S: Scalar> Factors<S> {
    /// Factors a matrix.
    pub fn of(g: &mut Graph, mut matrix: Symmetric<S>) -> Self {
        let mut left = Remaining::of(&matrix);
        let mut steps = Vec::with_capacity(matrix.size);
        while let Some((unknown, neighbours)) = left.take() {
            let row: Vec<(usize, S)> = neighbours
                .into_iter()
                .filter_map(|i| Some((i, matrix.get(i, unknown)?)))
                .collect();
            let pivot = matrix.get(unknown, unknown).unwrap_or_else(|| S::zero(g));
            let column: Vec<(usize, S)> = row.iter().map(|&(i, a)| (i, a.div(g, pivot))).collect();
            for (n, &(i, l)) in column.iter().enumerate() {
                for &(j, a) in &row[n..] {
                    let product = l.mul(g, a);
                    let less = S::zero(g).sub(g, product);
                    matrix.add(g, i, j, less);
                    left.join(i, j, matrix.get(i, j).is_some());
                }
            }
            steps.push(Step { unknown, pivot, column });
        }
        Factors { steps }
    }

    /// The solution for a right-hand side.
    pub fn solve(&self, g: &mut Graph, mut b: Vec<S>) -> Vec<S> {
        for step in &self.steps {
            for &(i, l) in &step.column {
                let product = l.mul(g, b[step.unknown]);
                b[i] = b[i].sub(g, product);
            }
        }
        for step in self.steps.iter().rev() {
            let start = b[step.unknown].div(g, step.pivot);
            b[step.unknown] = step.eliminated(g, start, |i| b[i]);
        }
        b
    }

    /// The inverse, row by row from the last pivot up (Takahashi, Fagan and Chen, 1973). Symmetric entries share one
    /// expression.
    pub fn inverse(&self, g: &mut Graph) -> Vec<Vec<S>> {
        let zero = S::zero(g);
        let mut inverse: Vec<Vec<S>> = vec![vec![zero; self.steps.len()]; self.steps.len()];
        let mut done: Vec<usize> = Vec::with_capacity(self.steps.len());
        for step in self.steps.iter().rev() {
            let k = step.unknown;
            for &j in &done {
                let entry = step.eliminated(g, zero, |i| inverse[i][j]);
                inverse[k][j] = entry;
                inverse[j][k] = entry;
            }
            let one = S::one(g);
            let start = one.div(g, step.pivot);
            inverse[k][k] = step.eliminated(g, start, |i| inverse[i][k]);
            done.push(k);
        }
        inverse
    }
}

impl<S: Scalar> Step<S> {
    /// `start - Σ l_i x_i` over the column.
    fn eliminated(&self, g: &mut Graph, start: S, x: impl Fn(usize) -> S) -> S {
        self.column.iter().fold(start, |sum, &(i, l)| {
            let product = l.mul(g, x(i));
            sum.sub(g, product)
        })
    }
}

/// The remaining unknowns, each with those that share an entry with it.
struct Remaining {
    neighbours: Vec<BTreeSet<usize>>,
    /// By number of neighbours; among equal numbers, the last first.
    order: BTreeSet<(usize, Reverse<usize>)>,
}

impl Remaining {
    fn of<S: Scalar>(matrix: &Symmetric<S>) -> Self {
        let mut left = Remaining {
            neighbours: vec![BTreeSet::new(); matrix.size],
            order: (0..matrix.size).map(|unknown| (0, Reverse(unknown))).collect(),
        };
        for (i, j, _) in matrix.iter() {
            left.join(i, j, true);
        }
        left
    }

    /// Removes the unknown with the fewest neighbours and returns these.
    fn take(&mut self) -> Option<(usize, BTreeSet<usize>)> {
        let (_, Reverse(unknown)) = self.order.pop_first()?;
        let neighbours = std::mem::take(&mut self.neighbours[unknown]);
        for &other in &neighbours {
            self.change(other, |of_other| of_other.remove(&unknown));
        }
        Some((unknown, neighbours))
    }

    /// Adds or removes a common entry of two unknowns.
    fn join(&mut self, i: usize, j: usize, joined: bool) {
        for (one, other) in [(i, j), (j, i)].into_iter().filter(|_| i != j) {
            self.change(one, |of_one| {
                if joined {
                    of_one.insert(other)
                } else {
                    of_one.remove(&other)
                }
            });
        }
    }

    fn change(&mut self, unknown: usize, how: impl FnOnce(&mut BTreeSet<usize>) -> bool) {
        self.order.remove(&(self.neighbours[unknown].len(), Reverse(unknown)));
        how(&mut self.neighbours[unknown]);
        self.order.insert((self.neighbours[unknown].len(), Reverse(unknown)));
    }
}
