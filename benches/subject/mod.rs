//! What is measured: the five vertical masses of axle_d at three hundred lines.

use qcar_runtime::model::{LANES, Lanes, Model, ResponseMut};

qcar_derive::axle_file!("benches/subject/axle_d_z.axle");

/// Behind the seam, as the workbench sees it.
pub const MODEL: &dyn Model = &axle_d_z::AxleDZ;

/// Places of inputs and outputs for a call through the seam.
pub struct Subject<'a> {
    model: &'a dyn Model,
    /// A parameter set.
    pub p: Vec<f64>,
    /// What it prepares to.
    pub constants: Vec<f64>,
    /// A state.
    pub x: Vec<f64>,
    /// An input.
    pub u: Vec<f64>,
    /// rad/s
    pub omega: Vec<f64>,
    /// The nonzeros of A, B, C and D.
    pub matrices: Vec<f64>,
    /// The nonzeros of their parameter Jacobians.
    pub sensitivities: Vec<f64>,
    /// The response to the pad: real and imaginary parts, then those of its Jacobian.
    pub response: [Vec<f64>; 4],
}

impl<'a> Subject<'a> {
    /// Room for everything, and a plausible axle.
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
    p: Vec<Lanes>,
    x: Vec<Lanes>,
    u: Vec<Lanes>,
    /// The nonzeros of A, B, C and D.
    pub matrices: Vec<Lanes>,
    /// Those of their parameter Jacobians.
    pub sensitivities: Vec<Lanes>,
}

impl<'a> Sets<'a> {
    /// Room for everything, and plausible axles.
    pub fn new(model: &'a dyn Model) -> Self {
        let about = model.about();
        let row = |p: &f64| std::array::from_fn(|set| p * (1.0 + 0.01 * set as f64));
        let room = |rows: usize| vec![[0.0; LANES]; rows];
        Sets {
            model,
            p: Subject::new(model).p.iter().map(row).collect(),
            x: room(about.states.len()),
            u: room(about.inputs.len()),
            matrices: room(about.matrices.len()),
            sensitivities: room(about.sensitivities.len()),
        }
    }

    /// A, B, C, D and all their parameter Jacobians.
    pub fn linearise(&mut self) {
        self.model.matrices_sets(&self.p, &self.x, &self.u, &mut self.matrices);
        self.model
            .sensitivities_sets(&self.p, &self.x, &self.u, &mut self.sensitivities);
    }
}

/// Hz, logarithmic from 0.5 to 30.
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
