//! A linear model computed a second time, by dense matrices of numbers: M, C and K assembled from incidence.
//!
//! Over complex numbers the same code gives derivatives by a complex step, exact to rounding.

use nalgebra::{Complex, ComplexField, DMatrix, DVector};
use qcar_dsl::derive::vectors::ExcitationSource;
use qcar_dsl::expr::{Expr, Graph, LinkId, Node, Symbol};
use qcar_dsl::model::{CoordinateKind, Model, Quantity, Signal, Term};

/// An expression of parameters alone, over any field.
fn value<T: ComplexField<RealField = f64> + Copy>(graph: &Graph, e: Expr, p: &[T]) -> T {
    let of = |a| value(graph, a, p);
    match graph.node(e) {
        Node::Constant(bits) => T::from_real(f64::from_bits(bits)),
        Node::Symbol(Symbol::Parameter(i)) => p[i as usize],
        Node::Neg(a) => -of(a),
        Node::Add(a, b) => of(a) + of(b),
        Node::Sub(a, b) => of(a) - of(b),
        Node::Mul(a, b) => of(a) * of(b),
        Node::Div(a, b) => of(a) / of(b),
        Node::Powi(a, n) => of(a).powi(n),
        node => panic!("a linear model has no {node:?} in its coefficients"),
    }
}

/// A coefficient of an expression that is linear in its leaves: its value with one leaf 1 and the others 0.
fn slope<T: ComplexField<RealField = f64> + Copy>(graph: &Graph, e: Expr, p: &[T], leaf: Symbol) -> T {
    let of = |a| slope(graph, a, p, leaf);
    match graph.node(e) {
        Node::Symbol(symbol) if symbol == leaf => T::one(),
        Node::Neg(a) => -of(a),
        Node::Add(a, b) => of(a) + of(b),
        Node::Sub(a, b) => of(a) - of(b),
        Node::Mul(a, b) if graph.symbols([a]).iter().all(|s| matches!(s, Symbol::Parameter(_))) => {
            value(graph, a, p) * of(b)
        }
        Node::Mul(a, b) => of(a) * value(graph, b, p),
        Node::Div(a, b) => of(a) / value(graph, b, p),
        _ => T::zero(),
    }
}

/// The matrices of a linear model over all its coordinates and inner states:
/// `M q̈ + C q̇ + K q + F z = P u`, `ż = S q + V q̇ + G z + U u`.
pub struct Reference<T: nalgebra::Scalar> {
    pub m: DMatrix<T>,
    pub c: DMatrix<T>,
    pub k: DMatrix<T>,
    pub f: DMatrix<T>,
    pub s: DMatrix<T>,
    pub v: DMatrix<T>,
    pub g: DMatrix<T>,
    /// Gravity's pull on each coordinate for g = 1.
    pub pull: DVector<T>,
    /// Rows: a link's stretch, its coefficients of q; and its force by q̈, q̇, q, z.
    pub stretch: DMatrix<T>,
    pub force: [DMatrix<T>; 4],
    pub inner: Vec<Symbol>,
    /// By the force inputs: what they push, the forces of the links, the rates of the inner states.
    pub push: DMatrix<T>,
    pub force_by_input: DMatrix<T>,
    pub rate_by_input: DMatrix<T>,
    /// Rows: a point's coefficients of q.
    pub points: DMatrix<T>,
}

impl<T: ComplexField<RealField = f64> + Copy> Reference<T> {
    pub fn new(model: &Model, p: &[T]) -> Self {
        let (n, links) = (model.coordinates.len(), model.links.len());
        let graph = &model.graph;
        let inner: Vec<Symbol> = (0..links)
            .flat_map(|l| (0..model.links[l].law.inner.len()).map(move |i| Symbol::Inner(LinkId(l as u16), i as u16)))
            .collect();
        let z = inner.len();
        let mut stretch = DMatrix::zeros(links, n);
        let mut force = [(n, ()), (n, ()), (n, ()), (z, ())].map(|(width, ())| DMatrix::zeros(links, width));
        let (mut s, mut v, mut g) = (DMatrix::zeros(z, n), DMatrix::zeros(z, n), DMatrix::zeros(z, z));
        let inputs = model.forces.len();
        let (mut force_by_input, mut rate_by_input) = (DMatrix::zeros(links, inputs), DMatrix::zeros(z, inputs));
        for (l, link) in model.links.iter().enumerate() {
            let id = LinkId(l as u16);
            for &(c, coefficient) in &link.stretch {
                stretch[(l, c.0 as usize)] = value(graph, coefficient, p);
            }
            let row = stretch.row(l).into_owned();
            for &term in &link.law.terms {
                let (by_acceleration, by_rate, by_stretch) = match term {
                    Term::Inerter(b) => (value(graph, b, p), T::zero(), T::zero()),
                    Term::Damper(c) => (T::zero(), value(graph, c, p), T::zero()),
                    Term::Spring(k) => (T::zero(), T::zero(), value(graph, k, p)),
                    Term::Force(e) => {
                        for (j, &state) in inner.iter().enumerate() {
                            force[3][(l, j)] += slope(graph, e, p, state);
                        }
                        for i in 0..inputs {
                            force_by_input[(l, i)] += slope(graph, e, p, Symbol::Force(i as u16));
                        }
                        (
                            T::zero(),
                            slope(graph, e, p, Symbol::Rate(id)),
                            slope(graph, e, p, Symbol::Stretch(id)),
                        )
                    }
                };
                for (matrix, factor) in force.iter_mut().zip([by_acceleration, by_rate, by_stretch]) {
                    let sum = matrix.row(l) + &row * factor;
                    matrix.set_row(l, &sum);
                }
            }
            for (i, state) in link.law.inner.iter().enumerate() {
                let place = inner.iter().position(|&s| s == Symbol::Inner(id, i as u16)).unwrap();
                s.set_row(place, &(&row * slope(graph, state.rate, p, Symbol::Stretch(id))));
                v.set_row(place, &(&row * slope(graph, state.rate, p, Symbol::Rate(id))));
                for (j, &other) in inner.iter().enumerate() {
                    g[(place, j)] = slope(graph, state.rate, p, other);
                }
                for i in 0..inputs {
                    rate_by_input[(place, i)] = slope(graph, state.rate, p, Symbol::Force(i as u16));
                }
            }
        }
        let scatter = stretch.transpose();
        let [mut m, c, k, f] = [0, 1, 2, 3].map(|i| &scatter * &force[i]);
        let mut push = -(&scatter * &force_by_input);
        for (i, input) in model.forces.iter().enumerate() {
            for &(c, coefficient) in &input.on {
                push[(c.0 as usize, i)] += value(graph, coefficient, p);
            }
        }
        let mut points = DMatrix::zeros(model.points.len(), n);
        for (row, point) in model.points.iter().enumerate() {
            for &(c, coefficient) in &point.combination {
                points[(row, c.0 as usize)] += value(graph, coefficient, p);
            }
        }
        let mut pull = DVector::zeros(n);
        for (i, coordinate) in model.coordinates.iter().enumerate() {
            if let CoordinateKind::Mass(inertia) = coordinate.kind {
                let inertia = value(graph, inertia, p);
                m[(i, i)] += inertia;
                if !coordinate.angle && model.gravities.iter().any(|g| g.direction == coordinate.direction) {
                    pull[i] = -inertia;
                }
            }
        }
        Reference {
            m,
            c,
            k,
            f,
            s,
            v,
            g,
            pull,
            stretch,
            force,
            inner,
            push,
            force_by_input,
            rate_by_input,
            points,
        }
    }

    /// Everything that moves when states and inputs are given: `leaf` gives positions and velocities of masses,
    /// positions of damped nodes, inner states and inputs.
    pub fn at(&self, model: &Model, leaf: &dyn Fn(Symbol) -> T) -> Instant<T> {
        let n = model.coordinates.len();
        let id = |c: usize| qcar_dsl::expr::CoordinateId(c as u16);
        let prescribed = |c: usize| matches!(model.coordinates[c].kind, CoordinateKind::Road | CoordinateKind::Motion);
        let node = |c: usize| matches!(model.coordinates[c].kind, CoordinateKind::Node);
        let heavy = |c: usize| !prescribed(c) && (!node(c) || self.m[(c, c)] != T::zero());
        let damped = |c: usize| node(c) && !heavy(c) && self.c[(c, c)] != T::zero();
        let light = |c: usize| node(c) && !heavy(c) && !damped(c);
        let z = DVector::from_iterator(self.inner.len(), self.inner.iter().map(|&state| leaf(state)));
        let u = DVector::from_fn(model.forces.len(), |i, _| leaf(Symbol::Force(i as u16)));
        let applied = &self.push * &u;
        let driven = &self.rate_by_input * &u;
        let mut q = DVector::from_fn(n, |c, _| {
            if light(c) {
                T::zero()
            } else {
                leaf(Symbol::Position(id(c)))
            }
        });
        fill(&mut q, &self.k, &light, |q| &applied - &self.k * q - &self.f * &z);
        let given = |c: usize| !light(c) && !damped(c);
        let mut qd = DVector::from_fn(n, |c, _| {
            if given(c) {
                leaf(Symbol::Velocity(id(c)))
            } else {
                T::zero()
            }
        });
        fill(&mut qd, &self.c, &damped, |qd| {
            &applied - &self.k * &q - &self.c * qd - &self.f * &z
        });
        let slope = &self.k + &self.f * &self.v;
        fill(&mut qd, &slope, &light, |qd| {
            -(&self.k * qd) - &self.f * (&self.s * &q + &self.v * qd + &self.g * &z + &driven)
        });
        let zd = &self.s * &q + &self.v * &qd + &self.g * &z + &driven;
        let mut qdd = DVector::from_fn(n, |c, _| {
            if prescribed(c) {
                leaf(Symbol::Acceleration(id(c)))
            } else {
                T::zero()
            }
        });
        let pull = &self.pull * gravity(model, leaf);
        let rest = &applied + pull - &self.k * &q - &self.c * &qd - &self.f * &z;
        fill(&mut qdd, &self.m, &heavy, |qdd| &rest - &self.m * qdd);
        fill(&mut qdd, &self.c, &damped, |qdd| {
            -(&self.k * &qd) - &self.c * qdd - &self.f * &zd
        });
        let zdd = |qdd: &DVector<T>| &self.s * &qd + &self.v * qdd + &self.g * &zd;
        fill(&mut qdd, &slope, &light, |qdd| -(&self.k * qdd) - &self.f * zdd(qdd));
        let force = &self.force[0] * &qdd + &self.force[1] * &qd + &self.force[2] * &q + &self.force[3] * &z;
        let force = force + &self.force_by_input * &u;
        let stretch = &self.stretch * &q;
        Instant {
            q,
            qd,
            qdd,
            zd,
            force,
            stretch,
        }
    }
}

fn gravity<T: ComplexField<RealField = f64> + Copy>(model: &Model, leaf: &dyn Fn(Symbol) -> T) -> T {
    if model.gravities.is_empty() {
        T::zero()
    } else {
        leaf(Symbol::Gravity(0))
    }
}

/// Solves the rows of some unknowns for their entries, which are zero before.
fn fill<T: ComplexField<RealField = f64> + Copy>(
    x: &mut DVector<T>,
    slope: &DMatrix<T>,
    unknown: &dyn Fn(usize) -> bool,
    residual: impl Fn(&DVector<T>) -> DVector<T>,
) {
    let rows: Vec<usize> = (0..x.len()).filter(|&c| unknown(c)).collect();
    if rows.is_empty() {
        return;
    }
    let rest = residual(x);
    let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| slope[(rows[i], rows[j])]);
    let right = DVector::from_fn(rows.len(), |i, _| rest[rows[i]]);
    let solution = matrix.lu().solve(&right).expect("the nodes are held");
    for (&row, value) in rows.iter().zip(solution.iter()) {
        x[row] = *value;
    }
}

/// A model at one instant.
pub struct Instant<T: nalgebra::Scalar> {
    pub q: DVector<T>,
    pub qd: DVector<T>,
    pub qdd: DVector<T>,
    pub zd: DVector<T>,
    pub force: DVector<T>,
    pub stretch: DVector<T>,
}

impl<T: nalgebra::Scalar + Copy> Instant<T> {
    pub fn rate(&self, state: Symbol, inner: &[Symbol]) -> T {
        match state {
            Symbol::Position(c) => self.qd[c.0 as usize],
            Symbol::Velocity(c) => self.qdd[c.0 as usize],
            state => self.zd[inner.iter().position(|&other| other == state).unwrap()],
        }
    }

    pub fn signal(&self, signal: &Signal, points: &DMatrix<T>) -> T
    where
        T: ComplexField,
    {
        let of = |quantity| match quantity {
            Quantity::Position => &self.q,
            Quantity::Velocity => &self.qd,
            Quantity::Acceleration => &self.qdd,
        };
        match *signal {
            Signal::Motion(c, quantity) => of(quantity)[c.0 as usize],
            Signal::Point(place, quantity) => (points.row(place as usize) * of(quantity))[0],
            Signal::LinkForce(l) => self.force[l.0 as usize],
            Signal::LinkStretch(l) => self.stretch[l.0 as usize],
        }
    }
}

/// What a force input does to coordinates and inner states; nothing to what is prescribed.
fn load(model: &Model, r: &Reference<f64>, input: usize) -> DVector<Complex<f64>> {
    let (n, z) = (model.coordinates.len(), r.inner.len());
    let moves = |c: usize| !matches!(model.coordinates[c].kind, CoordinateKind::Road | CoordinateKind::Motion);
    DVector::from_fn(n + z, |row, _| {
        let real = match row < n {
            true if moves(row) => r.push[(row, input)],
            true => 0.0,
            false => r.rate_by_input[(row - n, input)],
        };
        Complex::new(real, 0.0)
    })
}

/// The frequency response of all outputs by a dense solve over coordinates and inner states, and its derivative for a
/// derivative `d` of the matrices.
pub fn response(
    model: &Model,
    r: &Reference<f64>,
    d: &Reference<f64>,
    source: ExcitationSource,
    omega: f64,
) -> Vec<(Complex<f64>, Complex<f64>)> {
    let (n, z) = (model.coordinates.len(), r.inner.len());
    let j = Complex::new(0.0, 1.0);
    let jw = j * omega;
    let full = |a: &DMatrix<f64>| a.map(|x| Complex::new(x, 0.0));
    let build = |r: &Reference<f64>, own: f64| {
        let mut a = DMatrix::zeros(n + z, n + z);
        a.view_mut((0, 0), (n, n))
            .copy_from(&(full(&r.m) * (jw * jw) + full(&r.c) * jw + full(&r.k)));
        a.view_mut((0, n), (n, z)).copy_from(&full(&r.f));
        a.view_mut((n, 0), (z, n)).copy_from(&-(full(&r.s) + full(&r.v) * jw));
        a.view_mut((n, n), (z, z))
            .copy_from(&(DMatrix::identity(z, z) * (jw * own) - full(&r.g)));
        a
    };
    let (a, da) = (build(r, 1.0), build(d, 0.0));
    let mut held = a.clone();
    let mut right = DVector::zeros(n + z);
    for (c, coordinate) in model.coordinates.iter().enumerate() {
        if matches!(coordinate.kind, CoordinateKind::Road | CoordinateKind::Motion) {
            held.row_mut(c).fill(Complex::new(0.0, 0.0));
            held[(c, c)] = Complex::new(1.0, 0.0);
        }
    }
    match source {
        ExcitationSource::Motion(c) => right[c.0 as usize] = Complex::new(1.0, 0.0),
        ExcitationSource::Force(i) => right = load(model, r, i as usize),
    }
    let lu = held.lu();
    let x = lu.solve(&right).unwrap();
    let mut change = -(da * &x);
    if let ExcitationSource::Force(i) = source {
        change += load(model, d, i as usize);
    }
    for (c, coordinate) in model.coordinates.iter().enumerate() {
        if matches!(coordinate.kind, CoordinateKind::Road | CoordinateKind::Motion) {
            change[c] = Complex::new(0.0, 0.0);
        }
    }
    let dx = lu.solve(&change).unwrap();
    let force = |r: &Reference<f64>, l: usize| {
        let mut row = DVector::zeros(n + z);
        let motion = full(&r.force[0]) * (jw * jw) + full(&r.force[1]) * jw + full(&r.force[2]);
        row.rows_mut(0, n).copy_from(&motion.row(l).transpose());
        row.rows_mut(n, z).copy_from(&full(&r.force[3]).row(l).transpose());
        row
    };
    let stretch = |r: &Reference<f64>, l: usize| {
        let mut row = DVector::zeros(n + z);
        row.rows_mut(0, n).copy_from(&full(&r.stretch).row(l).transpose());
        row
    };
    let see = |signal: &Signal| match *signal {
        Signal::Motion(c, quantity) => {
            let factor = [Complex::new(1.0, 0.0), jw, jw * jw][quantity as usize];
            (factor * x[c.0 as usize], factor * dx[c.0 as usize])
        }
        Signal::Point(place, quantity) => {
            let factor = [Complex::new(1.0, 0.0), jw, jw * jw][quantity as usize];
            let row = |r: &Reference<f64>| {
                let mut row = DVector::zeros(n + z);
                let point = full(&r.points).row(place as usize).transpose();
                row.rows_mut(0, n).copy_from(&point);
                row
            };
            (factor * row(r).dot(&x), factor * (row(r).dot(&dx) + row(d).dot(&x)))
        }
        Signal::LinkForce(l) => {
            let l = l.0 as usize;
            let by_input = |r: &Reference<f64>| match source {
                ExcitationSource::Force(i) => r.force_by_input[(l, i as usize)],
                ExcitationSource::Motion(_) => 0.0,
            };
            let value = force(r, l).dot(&x) + by_input(r);
            (value, force(r, l).dot(&dx) + force(d, l).dot(&x) + by_input(d))
        }
        Signal::LinkStretch(l) => {
            let l = l.0 as usize;
            (stretch(r, l).dot(&x), stretch(r, l).dot(&dx) + stretch(d, l).dot(&x))
        }
    };
    model.outputs.iter().map(|output| see(&output.signal)).collect()
}
