//! From expressions to straight-line programs.
//!
//! A program contains only the values that its outputs need, each once, and arguments first, in the order in which the
//! outputs use them. Values that depend on the parameters alone are computed by `prepare`.

use qcar_model::About;

use crate::check::Checked;
use crate::derive::complex::Complex;
use crate::derive::linear::Linear;
use crate::derive::motion::{Motion, RollingTyre};
use crate::derive::response;
use crate::derive::vectors::Vectors;
use crate::expr::{CurveId, Expr, Graph, Node, Symbol};
use crate::hash::{HashMap, HashSet};
use crate::program::{Op, Program, Programs, Response, Rolling, Value};

/// A compiled model: everything that its printers and its interpreter need.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The checked model.
    pub model: Checked,
    /// The graph of the model, extended by the expressions of `motion` and `linear`.
    pub graph: Graph,
    /// Its equations.
    pub motion: Motion,
    /// Its matrices.
    pub linear: Linear,
    /// Names, positions and sparsity.
    pub about: About,
    /// The symbols at those positions.
    pub vectors: Vectors,
    /// Its programs.
    pub programs: Programs,
}

/// The equations of motion with a rolling tyre, and the tyre.
pub type RollingMotion = (Motion, RollingTyre);

/// Schedules all programs of a model.
pub fn schedule(
    graph: &mut Graph,
    motion: &Motion,
    rolling: Option<&RollingMotion>,
    linear: &Linear,
    responses: &[response::Response],
) -> Programs {
    let mut constants = Constants::default();
    let rates = motion.expand(graph, &motion.rates);
    let outputs = motion.expand(graph, &motion.outputs);
    let derivative = Writer::prepared(graph, &mut constants).program(&rates);
    let outputs = Writer::prepared(graph, &mut constants).program(&outputs);
    let responses = responses
        .iter()
        .map(|response| self::response(graph, &mut constants, response))
        .collect();
    let rolling = rolling.map(|rolling| self::rolling(graph, &mut constants, rolling));
    let matrices: Vec<Expr> = linear.matrices.iter().map(|&(_, value)| value).collect();
    let sensitivities: Vec<Expr> = linear.sensitivities.iter().map(|&(.., value)| value).collect();
    let jacobian: Vec<Expr> = linear.parameter_jacobian.iter().map(|&(.., value)| value).collect();
    let [matrices, sensitivities, parameter_jacobian] = [matrices, sensitivities, jacobian].map(|values| {
        let values = motion.expand(graph, &values);
        Writer::direct(graph).program(&values)
    });
    let prepare = Writer::direct(graph).program(&constants.values);
    Programs {
        prepare,
        derivative,
        outputs,
        matrices,
        sensitivities,
        parameter_jacobian,
        responses,
        rolling,
    }
}

fn response(graph: &mut Graph, constants: &mut Constants, response: &response::Response) -> Response {
    let parts = |values: &[Complex]| -> Vec<Expr> {
        values
            .iter()
            .map(|value| value.re)
            .chain(values.iter().map(|value| value.im))
            .collect()
    };
    let values: Vec<_> = response.outputs.iter().map(|&(_, value)| value).collect();
    let slopes: Vec<_> = response.jacobian.iter().map(|&(.., slope)| slope).collect();
    let (values, slopes) = (parts(&values), parts(&slopes));
    let value = Writer::prepared(graph, constants).program(&values);
    let both: Vec<Expr> = values.into_iter().chain(slopes).collect();
    let mut writer = Writer::prepared(graph, constants);
    writer.share_divisors(&both);
    let mut jacobian = response.jacobian.chunk_by(|(a, ..), (b, ..)| a == b).peekable();
    for (place, &(_, value)) in response.outputs.iter().enumerate() {
        let slopes = jacobian.next_if(|slopes| usize::from(slopes[0].0) == place);
        let slopes = slopes.into_iter().flatten();
        for part in [value].into_iter().chain(slopes.map(|&(.., slope)| slope)) {
            writer.value(part.re);
            writer.value(part.im);
        }
    }
    Response {
        value,
        with_jacobian: writer.program(&both),
    }
}

fn rolling(graph: &mut Graph, constants: &mut Constants, (motion, tyre): &RollingMotion) -> Rolling {
    let force = graph.symbol(Symbol::LinkForce(tyre.link));
    let [force, rates, outputs] =
        [&[force][..], &motion.rates, &motion.outputs].map(|values| motion.expand(graph, values));
    Rolling {
        contact_force: Writer::prepared(graph, constants).program(&force),
        derivative: Writer::prepared(graph, constants).program(&rates),
        outputs: Writer::prepared(graph, constants).program(&outputs),
    }
}

/// The values that `prepare` computes, in its order.
#[derive(Default)]
struct Constants {
    values: Vec<Expr>,
    places: HashMap<Expr, u32>,
}

impl Constants {
    fn place(&mut self, e: Expr) -> u32 {
        *self.places.entry(e).or_insert_with(|| {
            self.values.push(e);
            self.values.len() as u32 - 1
        })
    }
}

/// Builds one program.
struct Writer<'a> {
    graph: &'a mut Graph,
    /// Receives the values that depend on the parameters alone; `None` to compute them in this program.
    constants: Option<&'a mut Constants>,
    program: Program,
    values: HashMap<Expr, Value>,
    powers: HashMap<(Expr, i32), Value>,
    curves: HashMap<CurveId, u32>,
    fixed: HashMap<Expr, bool>,
    /// Divisors that are used more than once, so that a reciprocal saves divisions.
    shared_divisors: HashSet<Expr>,
}

impl<'a> Writer<'a> {
    fn direct(graph: &'a mut Graph) -> Self {
        Writer {
            graph,
            constants: None,
            program: Program::default(),
            values: HashMap::default(),
            powers: HashMap::default(),
            curves: HashMap::default(),
            fixed: HashMap::default(),
            shared_divisors: HashSet::default(),
        }
    }

    fn prepared(graph: &'a mut Graph, constants: &'a mut Constants) -> Self {
        Writer {
            constants: Some(constants),
            ..Writer::direct(graph)
        }
    }

    fn program(mut self, outputs: &[Expr]) -> Program {
        self.share_divisors(outputs);
        self.program.outputs = outputs.iter().map(|&e| self.value(e)).collect();
        self.program
    }

    /// True if `prepare` computes the value.
    fn is_prepared(&mut self, e: Expr) -> bool {
        self.constants.is_some() && self.is_fixed(e) && self.graph.as_constant(e).is_none()
    }

    /// True if a value depends on the parameters alone.
    fn is_fixed(&mut self, e: Expr) -> bool {
        if let Some(&known) = self.fixed.get(&e) {
            return known;
        }
        let fixed = match self.graph.node(e) {
            Node::Symbol(leaf) => matches!(leaf, Symbol::Parameter(_)),
            node => {
                let arguments: Vec<Expr> = self.graph.arguments(node).collect();
                arguments.into_iter().all(|argument| self.is_fixed(argument))
            }
        };
        self.fixed.insert(e, fixed);
        fixed
    }

    /// Finds the divisors of more than one quotient. `prepare` computes the reciprocals of those that depend on the
    /// parameters alone.
    fn share_divisors(&mut self, outputs: &[Expr]) {
        let mut seen = HashSet::default();
        let mut divisors = HashSet::default();
        let mut waiting = outputs.to_vec();
        while let Some(e) = waiting.pop() {
            if !seen.insert(e) || self.is_prepared(e) {
                continue;
            }
            let node = self.graph.node(e);
            if let Node::Div(_, divisor) = node
                && (!divisors.insert(divisor) || self.is_prepared(divisor))
            {
                self.shared_divisors.insert(divisor);
            }
            waiting.extend(self.graph.arguments(node));
        }
    }

    fn value(&mut self, e: Expr) -> Value {
        if let Some(&known) = self.values.get(&e) {
            return known;
        }
        let value = if self.is_prepared(e) {
            self.constant(e)
        } else {
            self.operation(e)
        };
        self.values.insert(e, value);
        value
    }

    fn constant(&mut self, e: Expr) -> Value {
        let place = self.constants.as_mut().map_or(0, |constants| constants.place(e));
        self.push(Op::Prepared(place))
    }

    fn operation(&mut self, e: Expr) -> Value {
        let op = match self.graph.node(e) {
            Node::Constant(bits) => Op::Constant(f64::from_bits(bits)),
            Node::Symbol(leaf) => Op::Input(leaf),
            Node::Neg(a) => Op::Neg(self.value(a)),
            Node::Add(a, b) => Op::Add(self.value(a), self.value(b)),
            Node::Sub(a, b) => Op::Sub(self.value(a), self.value(b)),
            Node::Mul(a, b) => Op::Mul(self.value(a), self.value(b)),
            Node::Div(a, b) => return self.quotient(a, b),
            Node::Powi(a, n) => return self.power(a, n),
            Node::Pow(a, b) => Op::Pow(self.value(a), self.value(b)),
            Node::Min(a, b) => Op::Min(self.value(a), self.value(b)),
            Node::Max(a, b) => Op::Max(self.value(a), self.value(b)),
            Node::Call(f, a) => Op::Call(f, self.value(a)),
            Node::Select(test, a, b) => Op::Select(self.value(test), self.value(a), self.value(b)),
            Node::Table(order, x, curve) => Op::Table(order, self.value(x), self.curve(curve)),
        };
        self.push(op)
    }

    /// The position of a curve in the program.
    fn curve(&mut self, id: CurveId) -> u32 {
        if let Some(&known) = self.curves.get(&id) {
            return known;
        }
        let curve = self.graph.curve(id).clone().map(|&entry| self.value(entry));
        self.program.curves.push(curve);
        let place = self.program.curves.len() as u32 - 1;
        self.curves.insert(id, place);
        place
    }

    fn quotient(&mut self, a: Expr, b: Expr) -> Value {
        let one = self.graph.constant(1.0);
        if a == one || !self.shared_divisors.contains(&b) {
            let op = Op::Div(self.value(a), self.value(b));
            return self.push(op);
        }
        let reciprocal = self.graph.div(one, b);
        let op = Op::Mul(self.value(a), self.value(reciprocal));
        self.push(op)
    }

    /// A whole power as products, by repeated squaring.
    fn power(&mut self, a: Expr, n: i32) -> Value {
        if n == 1 {
            return self.value(a);
        }
        if let Some(&known) = self.powers.get(&(a, n)) {
            return known;
        }
        let op = if n < 0 {
            let one = self.graph.constant(1.0);
            Op::Div(self.value(one), self.power(a, -n))
        } else if n % 2 == 0 {
            let half = self.power(a, n / 2);
            Op::Mul(half, half)
        } else {
            Op::Mul(self.power(a, n - 1), self.value(a))
        };
        let value = self.push(op);
        self.powers.insert((a, n), value);
        value
    }

    fn push(&mut self, op: Op) -> Value {
        self.program.ops.push(op);
        Value(self.program.ops.len() as u32 - 1)
    }
}
