//! Model predictions of measured channels: ratios of two signals over frequency, with their parameter Jacobian.

// Values of all parameters, including those tied to others.
pub mod parameters;
// Units of signals and of their ratios.
pub mod unit;
// The row of a response that holds a measured signal.
pub mod signal;
// The response of a nonlinear model about an operating point.
mod linearized;
// The periodic response of a nonlinear model to a sine.
pub mod periodic;
// Ratios as complex numbers.
pub mod ratio;
// Ratios as logarithms, for the fit.
pub mod logarithm;

use crate::model::{Model, ResponseLayout, ResponseMut};
pub use linearized::OperatingPoint;

/// The frequency response of a model to one excitation on a fixed grid; its buffers are reused.
pub struct Response<'m, M: ?Sized> {
    pub(crate) model: &'m M,
    pub(crate) excitation: usize,
    omega: Vec<f64>,
    layout: ResponseLayout,
    /// The operating point of a nonlinear model; `None` for a linear one.
    about: Option<OperatingPoint>,
    constants: Vec<f64>,
    re: Vec<f64>,
    im: Vec<f64>,
    jacobian_re: Vec<f64>,
    jacobian_im: Vec<f64>,
}

impl<'m, M: Model + ?Sized> Response<'m, M> {
    /// A response on `frequency` (Hz, above zero). A nonlinear model is linearised at rest.
    pub fn new(model: &'m M, excitation: usize, frequency: &[f64]) -> Self {
        let about = model.about();
        let point = (!about.linear).then(|| OperatingPoint::rest(about));
        Self::with_point(model, excitation, frequency, point)
    }

    /// A response of a nonlinear model about `point`, which stays the same if parameters change.
    pub fn at(model: &'m M, excitation: usize, frequency: &[f64], point: OperatingPoint) -> Self {
        Self::with_point(model, excitation, frequency, Some(point))
    }

    fn with_point(model: &'m M, excitation: usize, frequency: &[f64], point: Option<OperatingPoint>) -> Self {
        let about = model.about();
        let layout = match point {
            None => about.responses[excitation].clone(),
            Some(_) => linearized::layout(about),
        };
        let rows = layout.outputs.len() * frequency.len();
        Self {
            model,
            excitation,
            omega: frequency.iter().map(|f| std::f64::consts::TAU * f).collect(),
            layout,
            about: point,
            constants: vec![0.0; about.constants],
            re: vec![0.0; rows],
            im: vec![0.0; rows],
            jacobian_re: Vec::new(),
            jacobian_im: Vec::new(),
        }
    }

    /// Computes all rows and their Jacobian for the parameters `p`.
    pub fn evaluate(&mut self, p: &[f64]) {
        let entries = self.layout.jacobian.len() * self.omega.len();
        self.jacobian_re.resize(entries, 0.0);
        self.jacobian_im.resize(entries, 0.0);
        self.compute(p, true);
    }

    /// Computes all rows for the parameters `p`, and no Jacobian.
    pub fn evaluate_values(&mut self, p: &[f64]) {
        self.jacobian_re.clear();
        self.jacobian_im.clear();
        self.compute(p, false);
    }

    /// True if the Jacobian has been computed too.
    pub fn has_jacobian(&self) -> bool {
        self.jacobian_re.len() == self.layout.jacobian.len() * self.omega.len()
    }

    fn compute(&mut self, p: &[f64], jacobian: bool) {
        let into = ResponseMut {
            re: &mut self.re,
            im: &mut self.im,
            jacobian: jacobian.then_some((&mut self.jacobian_re[..], &mut self.jacobian_im[..])),
        };
        match &self.about {
            None => {
                self.model.prepare(p, &mut self.constants);
                self.model.response(self.excitation, &self.constants, &self.omega, into);
            }
            Some(point) => linearized::response(self.model, self.excitation, p, point, &self.omega, into),
        }
    }

    /// Angular frequencies, rad/s.
    pub fn omega(&self) -> &[f64] {
        &self.omega
    }

    /// The meaning of each row.
    pub fn layout(&self) -> &ResponseLayout {
        &self.layout
    }

    /// Real and imaginary parts of a row.
    pub fn row(&self, row: usize) -> (&[f64], &[f64]) {
        let range = self.lines(row);
        (&self.re[range.clone()], &self.im[range])
    }

    /// Real and imaginary parts of an entry of the Jacobian.
    pub fn entry(&self, entry: usize) -> (&[f64], &[f64]) {
        let range = self.lines(entry);
        (&self.jacobian_re[range.clone()], &self.jacobian_im[range])
    }

    fn lines(&self, row: usize) -> std::ops::Range<usize> {
        let lines = self.omega.len();
        row * lines..(row + 1) * lines
    }
}
