//! The subject of the benchmarks: the five vertical masses of axle_d at three hundred lines.

use std::ops::{Deref, DerefMut};

use qcar_runtime::model::{LANES, Lanes, Model, ResponseMut};

qcar_derive::axle_file!("benches/subject/axle_d_z.axle");

/// The model as the workbench uses it, through its trait.
pub const MODEL: &dyn Model = &axle_d_z::AxleDZ;

/// Buffers of inputs and outputs for calls of the trait.
pub struct Subject<'a> {
    model: &'a dyn Model,
    /// A parameter set.
    pub p: Vec<f64>,
    /// Its constants.
    pub constants: Vec<f64>,
    /// A state.
    pub x: Vec<f64>,
    /// An input.
    pub u: Vec<f64>,
    /// Angular frequencies, rad/s.
    pub omega: Vec<f64>,
    /// The nonzeros of A, B, C and D.
    pub matrices: Vec<f64>,
    /// The nonzeros of their parameter Jacobians.
    pub sensitivities: Vec<f64>,
    /// The response to the pad: real and imaginary parts, then those of its Jacobian.
    pub response: [Vec<f64>; 4],
}

impl<'a> Subject<'a> {
    /// Buffers, and a plausible axle.
    pub fn new(model: &'a dyn Model) -> Self {
        let about = model.about();
        let p = about
            .parameters
            .iter()
            .map(|parameter| value(&parameter.name))
            .collect::<Vec<_>>();
        let mut constants = vec![0.0; about.constants];
        model.prepare(&p, &mut constants);
        let omega = (0..300)
            .map(|line| std::f64::consts::TAU * frequency(line))
            .collect::<Vec<_>>();
        let layout = &about.responses[0];
        let rows = [
            layout.outputs.len(),
            layout.outputs.len(),
            layout.jacobian.len(),
            layout.jacobian.len(),
        ];
        Subject {
            model,
            p,
            constants,
            x: vec![0.0; about.states.len()],
            u: vec![0.0; about.inputs.len()],
            matrices: vec![0.0; about.matrices.len()],
            sensitivities: vec![0.0; about.sensitivities.len()],
            response: rows.map(|rows| vec![0.0; rows * omega.len()]),
            omega,
        }
    }

    /// A, B, C, D and all their parameter Jacobians.
    pub fn linearise(&mut self) {
        self.model.matrices(&self.p, &self.x, &self.u, &mut self.matrices);
        self.model
            .sensitivities(&self.p, &self.x, &self.u, &mut self.sensitivities);
    }

    /// The response of five accelerations to the pad with its full Jacobian, constants included.
    pub fn respond(&mut self) {
        self.model.prepare(&self.p, &mut self.constants);
        let [re, im, slopes_re, slopes_im] = &mut self.response;
        let into = ResponseMut {
            re,
            im,
            jacobian: Some((slopes_re, slopes_im)),
        };
        self.model.response(0, &self.constants, &self.omega, into);
    }
}

/// Several parameter sets together.
pub struct Sets<'a> {
    model: &'a dyn Model,
    p: Rows,
    constants: Rows,
    x: Rows,
    u: Rows,
    /// The nonzeros of A, B, C and D.
    pub matrices: Rows,
    /// The nonzeros of their parameter Jacobians.
    pub sensitivities: Rows,
    omega: Vec<f64>,
    /// The response to the pad with its Jacobian, of [`AT_ONCE`] lines.
    response: Rows,
}

/// Number of lines of a response of several sets that fit into the L1 cache.
const AT_ONCE: usize = 4;

/// Rows aligned to cache lines, so that each of the widest vectors is in one line.
pub struct Rows {
    memory: Vec<f64>,
    start: usize,
}

impl Rows {
    fn new(rows: usize) -> Self {
        let memory = vec![0.0; LANES * (rows + 1)];
        let start = memory.as_ptr().align_offset(size_of::<Lanes>());
        Rows { memory, start }
    }
}

impl Deref for Rows {
    type Target = [Lanes];

    fn deref(&self) -> &[Lanes] {
        let rows = self.memory.len() - LANES;
        self.memory[self.start..][..rows].as_chunks().0
    }
}

impl DerefMut for Rows {
    fn deref_mut(&mut self) -> &mut [Lanes] {
        let rows = self.memory.len() - LANES;
        self.memory[self.start..][..rows].as_chunks_mut().0
    }
}

impl<'a> Sets<'a> {
    /// Buffers, and plausible axles.
    pub fn new(model: &'a dyn Model) -> Self {
        let about = model.about();
        let row = |p: &f64| std::array::from_fn(|set| p * (1.0 + 0.01 * set as f64));
        let subject = Subject::new(model);
        let mut p = Rows::new(subject.p.len());
        p.iter_mut().zip(&subject.p).for_each(|(to, value)| *to = row(value));
        Sets {
            model,
            p,
            constants: Rows::new(about.constants),
            x: Rows::new(about.states.len()),
            u: Rows::new(about.inputs.len()),
            matrices: Rows::new(about.matrices.len()),
            sensitivities: Rows::new(about.sensitivities.len()),
            omega: subject.omega,
            response: Rows::new(AT_ONCE * about.responses[0].rows(true)),
        }
    }

    /// A, B, C, D and all their parameter Jacobians.
    pub fn linearise(&mut self) {
        self.model.matrices_sets(&self.p, &self.x, &self.u, &mut self.matrices);
        self.model
            .sensitivities_sets(&self.p, &self.x, &self.u, &mut self.sensitivities);
    }

    /// The response with its full Jacobian, constants included; some lines overwrite those before.
    pub fn respond(&mut self) {
        self.model.prepare_sets(&self.p, &mut self.constants);
        let rows = self.model.about().responses[0].rows(true);
        for lines in self.omega.chunks(AT_ONCE) {
            let into = &mut self.response[..lines.len() * rows];
            self.model.response_sets(0, &self.constants, lines, true, into);
        }
    }
}

/// Frequencies, Hz, logarithmic from 0.5 to 30.
pub fn frequency(line: usize) -> f64 {
    0.5 * 60f64.powf(line as f64 / 299.0)
}

/// A plausible value of a parameter, SI.
fn value(name: &str) -> f64 {
    match name {
        "m_corner" => 580.0,
        "m_wheel" => 35.0,
        "m_tm" => 5.0,
        "m_sf" => 24.0,
        "m_pwt" => 55.0,
        "mr_spring" => 0.6,
        "mr_damper" => 0.8,
        "k_wheel_z" => 55e3,
        "k_tm" => 400e3,
        "k_sf_z" => 1.5e6,
        "k_pwt_z" => 300e3,
        "k_tire" => 250e3,
        "c_wheel_z" => 3e3,
        "c_tm" => 1.2e3,
        "c_sf_z" => 3e3,
        "c_pwt_z" => 800.0,
        "c_tire" => 120.0,
        // The tyre stays linear.
        "static_tire_load" | "static_tire_def" => 0.0,
        other => unreachable!("the model has no {other}"),
    }
}
