//! The signals that are recorded while a model rolls over a road.

use super::exponential::ExponentialStepper;
use super::rolling::Rolling;
use super::sampling::{Grid, Tape};
use crate::model::{About, Contact, Lanes, Model};
use crate::solver::{After, Effort, Event, Step, System};
use crate::vectors::{Loops, widest};

/// A rolling model and its recorded signals.
pub(super) struct Recorder<'a, M: ?Sized> {
    rolling: Rolling<'a, M>,
    stepper: Option<ExponentialStepper>,
    /// Buffer for a state.
    state: Vec<f64>,
    /// Buffer for its rates, then the outputs if the model has to compute them, then force and deflection of the
    /// contact.
    rates: Vec<f64>,
    /// For each output that is kept, its index in that row. The acceleration of a mass is a rate, so most models need
    /// not compute their outputs.
    places: Vec<Option<usize>>,
    /// The indices that are recorded, those of outputs first.
    recorded: Vec<usize>,
    /// The first of these indices.
    first: usize,
    tape: Tape,
    /// Times at which the tyre lost contact, s.
    pub lift_offs: Vec<f64>,
    /// Times at which it regained contact, s.
    pub landings: Vec<f64>,
    /// Time of the last evaluation, s, and true if the tyre was on the ground.
    last: (f64, bool),
}

/// Which signals of a ride are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedSignals {
    /// For each output of the model, true if it is kept.
    pub outputs: Vec<bool>,
    /// True if the force of the tyre is kept.
    pub force: bool,
    /// True if the area of the contact is kept.
    pub area: bool,
}

impl RecordedSignals {
    /// All signals.
    pub fn all(about: &About) -> Self {
        Self {
            outputs: vec![true; about.outputs.len()],
            force: true,
            area: true,
        }
    }
}

/// Values of the contact at the end of each row: force of the tyre in z and x, and its deflection.
const OF_CONTACT: usize = 3;

impl<'a, M: Model + ?Sized> Recorder<'a, M> {
    /// A recorder of the signals that are `kept`, which reuses the memory of another tape.
    pub fn new(
        rolling: Rolling<'a, M>,
        stepper: Option<ExponentialStepper>,
        (grid, buffer): (Grid, Vec<f64>),
        about: &About,
        kept: &RecordedSignals,
    ) -> Self {
        let (states, outputs) = (about.states.len(), &about.outputs);
        let of_output = |output: usize| kept.outputs[output].then_some(output);
        let wanted = || (0..outputs.len()).map(of_output);
        let rate = |output: usize| about.rate(&outputs[output].signal);
        let are_rates = wanted().flatten().all(|output| rate(output).is_some());
        let asked = if are_rates { 0 } else { outputs.len() };
        let place = |output: usize| if are_rates { rate(output) } else { Some(states + output) };
        let places: Vec<Option<usize>> = wanted().map(|output| output.and_then(place)).collect();
        let of_contact = [kept.force, kept.force, kept.area].into_iter().zip(states + asked..);
        let of_contact = of_contact.filter_map(|(is_kept, place)| is_kept.then_some(place));
        let recorded: Vec<usize> = places.iter().copied().flatten().chain(of_contact).collect();
        Self {
            rolling,
            stepper,
            state: vec![0.0; states],
            rates: vec![0.0; states + asked + OF_CONTACT],
            places,
            first: recorded.iter().copied().min().unwrap_or(states),
            tape: Tape::over(buffer, grid, recorded.len()),
            recorded,
            lift_offs: Vec::new(),
            landings: Vec::new(),
            last: (f64::NAN, true),
        }
    }

    /// Records a car that is at rest in state `x` until a time, s.
    pub fn rest(&mut self, until: f64, x: &[f64]) {
        observe(&self.rolling, until, x, &mut self.rates);
        let values = self.recorded.iter().map(|&place| self.rates[place]);
        self.tape.record_rest(until, values);
    }

    /// The equations of motion while it rolls.
    pub fn rolling(&self) -> &Rolling<'a, M> {
        &self.rolling
    }

    /// Stores the contact's force at the end of a step, for the exponential method.
    fn note(&mut self, step: &Step<'_>) {
        let Some(stepper) = &mut self.stepper else {
            return;
        };
        let force = step.end_rates().and_then(|rates| {
            let [vertical, longitudinal, deflection] = *rates.last_chunk::<OF_CONTACT>()?;
            let contact = Contact {
                force: [vertical, longitudinal],
                ..Contact::default()
            };
            (deflection > 0.0).then(|| self.rolling.driven(contact).force)
        });
        stepper.note(&self.rolling, step.end, step.end_state(), force);
    }

    /// Records a sample at time `t` with its contact; [`Recorder::finish`] interpolates between it and the last one.
    pub fn record_step(&mut self, t: f64, x: &[f64], contact: Contact) {
        if self.tape.next(t).is_some() {
            self.tape.skip_to(t);
            let (dx, outputs, of_contact) = parts(&mut self.rates, x.len());
            self.rolling.move_by(&self.rolling.driven(contact), x, dx, outputs);
            tell(&contact, of_contact);
            self.record();
        }
    }

    /// The same from the rates of several rides, of which this one has a lane; only if the model computes no outputs.
    pub fn record_lane(&mut self, t: f64, (rates, lane): (&[Lanes], usize), contact: Contact) {
        if self.tape.next(t).is_some() {
            self.tape.skip_to(t);
            tell(&contact, &mut self.rates[rates.len()..]);
            let rate = |&place: &usize| rates.get(place).map_or(self.rates[place], |rates| rates[lane]);
            self.tape.record(self.recorded.iter().map(rate));
        }
    }

    /// True if some kept outputs are not rates, so that the model has to compute them.
    pub fn computes_outputs(&self) -> bool {
        self.rates.len() > self.state.len() + OF_CONTACT
    }

    fn record(&mut self) {
        self.tape.record(self.recorded.iter().map(|&place| self.rates[place]));
    }

    /// Interpolates the samples within steps of which only the ends were recorded.
    pub fn finish(&mut self) {
        self.tape.fill_in();
    }

    /// Each output at the samples; empty for outputs that are not kept.
    pub fn outputs(&self) -> Vec<Vec<f64>> {
        let filtered = |place| {
            self.track(place)
                .map(|track| self.tape.filtered(track))
                .unwrap_or_default()
        };
        self.places.iter().copied().map(filtered).collect()
    }

    /// Force of the tyre on the wheel in z and x at the samples, N, and area of its contact, m².
    pub fn contact(&self) -> [Vec<f64>; 3] {
        let place = |what: usize| Some(self.rates.len() - OF_CONTACT + what);
        let of = |what: usize| self.track(place(what)).map_or(&[][..], |track| self.tape.plain(track));
        let area = |deflection: &f64| self.rolling.tyre.area(*deflection);
        [of(0).to_vec(), of(1).to_vec(), of(2).iter().map(area).collect()]
    }

    fn track(&self, place: Option<usize>) -> Option<usize> {
        place.and_then(|place| self.recorded.iter().position(|own| *own == place))
    }

    /// The memory of its tape, for another recorder.
    pub fn into_buffer(self) -> Vec<f64> {
        self.tape.into_buffer()
    }

    /// Integrates this ride by the exponential method, which has begun, for at most `most_steps` steps. Stores the
    /// state in `x` and returns the time and the effort.
    pub fn go_on(&mut self, x: &mut [f64], most_steps: usize) -> (f64, Effort) {
        let mut stepper = self.stepper.take().expect("it has taken over");
        widest(Steps {
            stepper: &mut stepper,
            recorder: self,
            most: most_steps,
        });
        x.copy_from_slice(stepper.state());
        let ended = stepper.end();
        self.stepper = Some(stepper);
        ended
    }

    /// The exponential method, and the equations of motion.
    pub fn stepper(&mut self) -> Option<(&mut ExponentialStepper, &Rolling<'a, M>)> {
        Some((self.stepper.as_mut()?, &self.rolling))
    }
}

impl<M: Model + ?Sized> System for Recorder<'_, M> {
    fn derivative(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let rolling = &self.rolling;
        let grounded = widest(Observation {
            rolling,
            t,
            x,
            rates: dx,
        });
        self.last = (t, grounded);
    }

    fn signals(&self) -> usize {
        self.rates.len() - self.state.len()
    }

    fn enter(&mut self, t: f64, x: &mut [f64]) {
        self.rolling.pass_steps(t, x);
        if let Some(stepper) = &mut self.stepper {
            stepper.pass(t);
        }
    }

    fn next_kink(&self, t: f64, x: &[f64], dx: &[f64], from: f64) -> f64 {
        let wanted = self
            .stepper
            .as_ref()
            .map_or(f64::INFINITY, ExponentialStepper::next_time);
        self.rolling.next_kink(t, x, dx, from).min(wanted)
    }

    fn takes_over(&mut self, t: f64, x: &[f64]) -> bool {
        self.stepper.as_mut().is_some_and(|stepper| stepper.begin(t, x))
    }

    fn accept(&mut self, step: &Step<'_>) {
        self.note(step);
        let smooth = step.has_rates();
        while let Some(t) = self.tape.next(step.end) {
            if smooth {
                step.rates_at(t, self.first, &mut self.rates[self.first..]);
            } else {
                step.at(t, &mut self.state);
                observe(&self.rolling, t, &self.state, &mut self.rates);
            }
            self.record();
        }
    }

    /// Two events: the tyre loses or regains contact, and a point contact reaches a vertical step.
    fn events(&self) -> usize {
        2
    }

    fn event_values(&mut self, t: f64, x: &[f64], values: &mut [f64]) {
        // The last evaluation of a step is at its end, so the contact there is already known.
        let grounded = if t == self.last.0 {
            self.last.1
        } else {
            self.rolling.touch(t, x).is_some()
        };
        values[0] = if grounded { 1.0 } else { -1.0 };
        values[1] = self.rolling.to_next_step(t, x);
    }

    fn happen(&mut self, event: &Event<'_>) -> After {
        match (event.index, event.rising) {
            (0, true) => self.landings.push(event.time),
            (0, false) => self.lift_offs.push(event.time),
            _ => {}
        }
        After::Restart
    }
}

/// One evaluation, compiled for each instruction set.
struct Observation<'a, 'b, M: ?Sized> {
    rolling: &'a Rolling<'b, M>,
    t: f64,
    x: &'a [f64],
    rates: &'a mut [f64],
}

impl<M: Model + ?Sized> Loops for Observation<'_, '_, M> {
    type Result = bool;

    #[inline(always)]
    fn run(self) -> bool {
        observe(self.rolling, self.t, self.x, self.rates)
    }
}

/// Steps of the exponential method, compiled for each instruction set.
struct Steps<'s, 'r, 'a, M: ?Sized> {
    stepper: &'s mut ExponentialStepper,
    recorder: &'r mut Recorder<'a, M>,
    most: usize,
}

impl<M: Model + ?Sized> Loops for Steps<'_, '_, '_, M> {
    type Result = ();

    #[inline(always)]
    fn run(self) {
        for _ in 0..self.most {
            let Some((time, contact)) = self.stepper.step(&self.recorder.rolling) else {
                break;
            };
            self.recorder.record_step(time, self.stepper.state(), contact);
        }
    }
}

/// Computes derivative and signals at time `t`. Returns true if the tyre is on the ground.
#[inline(always)]
fn observe<M: Model + ?Sized>(rolling: &Rolling<'_, M>, t: f64, x: &[f64], rates: &mut [f64]) -> bool {
    let (dx, outputs, of_contact) = parts(rates, x.len());
    let contact = rolling.motion(t, x, dx, outputs);
    tell(&contact.unwrap_or_default(), of_contact);
    contact.is_some()
}

/// The rates of the states, the outputs, and the values of the contact.
#[inline(always)]
fn parts(rates: &mut [f64], states: usize) -> (&mut [f64], &mut [f64], &mut [f64]) {
    let (dx, signals) = rates.split_at_mut(states);
    let (outputs, of_contact) = signals.split_at_mut(signals.len() - OF_CONTACT);
    (dx, outputs, of_contact)
}

#[inline(always)]
fn tell(contact: &Contact, of_contact: &mut [f64]) {
    of_contact.copy_from_slice(&[contact.force[0], contact.force[1], -contact.s]);
}
