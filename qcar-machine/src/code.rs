//! Executable memory and calls of its code. All unsafe code of the crate is here.
#![expect(
    unsafe_code,
    reason = "the processor runs code that was written into memory, which Rust cannot check"
)]

use memmap2::{Mmap, MmapMut};
use qcar_dsl::derive::vectors::Vectors;
use qcar_dsl::evaluate::arguments::{Arguments, Part};
use qcar_dsl::program::Program;
use qcar_model::{LANES, Lanes};

use crate::assemble::Width;
use crate::call::Call;
use crate::reads::Reads;
use crate::shape::{Shape, VectorWidth};
use crate::translate::{Translated, Wide, translate};

/// Bytes of a number.
const NUMBER_BYTES: usize = size_of::<f64>();

/// Code for one point or for parameter sets. Arguments: the addresses of four parts, of the results and of the
/// constants.
type PointFunction = unsafe extern "sysv64" fn(*const f64, *const f64, *const f64, *const f64, *mut f64, *const Wide);
/// Code for many points. Arguments: the shared part, the rows that are read and written, the offsets in bytes of the
/// first point and of the end, and the constants.
type SweepFunction =
    unsafe extern "sysv64" fn(*const f64, *const *const f64, *const *mut f64, usize, usize, *const Wide);

/// A program as machine code in one shape.
#[derive(Debug)]
pub struct Code {
    memory: Mmap,
    /// Calls of functions, kept alive here because the code contains their addresses.
    _calls: Box<[Call]>,
    constants: Box<[Wide]>,
    reads: Reads,
    results: usize,
    /// Number of sets or points that the instructions compute together.
    width: usize,
}

impl Code {
    /// The code for vectors of this many numbers. `None` if this machine cannot run it, if the system refuses
    /// executable memory, or if the program has no translation.
    pub fn new(vectors: &Vectors, program: &Program, shape: Shape, vector_width: VectorWidth) -> Option<Code> {
        if !vector_width.is_supported() {
            return None;
        }
        let reads = Reads::new(vectors, program, shape);
        let (width, compute_call) = match (shape, vector_width) {
            (Shape::Single, _) => (Width::One, compute::<1> as *const () as usize),
            (_, VectorWidth::Four) => (Width::Four, compute::<4> as *const () as usize),
            (_, VectorWidth::Eight) => (Width::Eight, compute::<8> as *const () as usize),
        };
        let Translated { code, calls, constants } = translate(program, &reads, (shape, width), compute_call)?;
        let mut memory = MmapMut::map_anon(code.len()).ok()?;
        memory.copy_from_slice(&code);
        Some(Code {
            memory: memory.make_exec().ok()?,
            _calls: calls,
            constants,
            reads,
            results: program.outputs.len(),
            width: width.numbers(),
        })
    }

    /// Computes the program at one point, with code for one point.
    ///
    /// # Panics
    /// If an argument has fewer entries than the program reads, or the results do not fit.
    pub fn run(&self, given: &Arguments, into: &mut [f64]) {
        let mut parts = [std::ptr::null(); 4];
        for (pointer, &(part, length)) in parts.iter_mut().zip(&self.reads.parts) {
            *pointer = checked(given.part(part), length).as_ptr();
        }
        let into = &mut into[..self.results];
        let [a, b, c, d] = parts;
        // SAFETY: `memory` holds a function of this signature, since `translate` wrote it so. It reads the entries of
        // the parts below those lengths, the numbers, and its own stack, and writes as many results as there are.
        unsafe {
            let code: PointFunction = std::mem::transmute(self.memory.as_ptr());
            code(a, b, c, d, into.as_mut_ptr(), self.constants.as_ptr());
        }
    }

    /// Computes the program for each of the sets, with code for sets.
    ///
    /// # Panics
    /// As [`Code::run`].
    pub fn sets(&self, given: &[(Part, &[Lanes])], into: &mut [Lanes]) {
        let mut parts = [std::ptr::null::<f64>(); 4];
        for (pointer, &(part, length)) in parts.iter_mut().zip(&self.reads.parts) {
            let rows = given.iter().find(|own| own.0 == part).map_or(&[][..], |own| own.1);
            *pointer = checked(rows, length).as_flattened().as_ptr();
        }
        let into = into[..self.results].as_flattened_mut();
        for first in (0..LANES).step_by(self.width) {
            let [a, b, c, d] = parts.map(|part| part.wrapping_add(first));
            let into = into.as_mut_ptr().wrapping_add(first);
            // SAFETY: as in `run`, where each entry and each result is `width` numbers of its row, from `first` on.
            unsafe {
                let code: PointFunction = std::mem::transmute(self.memory.as_ptr());
                code(a, b, c, d, into, self.constants.as_ptr());
            }
        }
    }

    /// Computes the program at this many points, with code for points; false if there are too few. The results are
    /// written one after the other, each as a row of points.
    ///
    /// # Panics
    /// As [`Code::run`].
    pub fn sweep(&self, given: &Arguments, points: usize, into: &mut [&mut [f64]]) -> bool {
        if points < self.width {
            return false;
        }
        let shared = self.reads.parts.first();
        let shared = shared.map_or(&[][..], |&(part, length)| checked(given.part(part), length));
        let read = self.reads.rows.iter();
        let read: Vec<*const f64> = read
            .map(|&(part, entry)| given.part(part)[entry * points..][..points].as_ptr())
            .collect();
        let rows = into.iter_mut().flat_map(|part| part.chunks_exact_mut(points));
        let written: Vec<*mut f64> = rows.map(|row| row.as_mut_ptr()).collect();
        assert!(
            written.len() >= self.results,
            "{} rows for {} results",
            written.len(),
            self.results
        );
        let run = |from: usize, to: usize| {
            // SAFETY: as in `run`, of the shared part. The code reads and writes the points from `from` on by groups of
            // `width` while their first is below `to`, and each row has `points` of them, which is at least `to + width
            // - 1`.
            unsafe {
                let code: SweepFunction = std::mem::transmute(self.memory.as_ptr());
                let (from, to, constants) = (NUMBER_BYTES * from, NUMBER_BYTES * to, self.constants.as_ptr());
                code(shared.as_ptr(), read.as_ptr(), written.as_ptr(), from, to, constants);
            }
        };
        // The last group is complete too: it may compute some points of the previous one again.
        let last = points - self.width;
        if last > 0 {
            run(0, last);
        }
        run(last, last + 1);
        true
    }
}

#[track_caller]
fn checked<T>(entries: &[T], length: usize) -> &[T] {
    assert!(
        entries.len() >= length,
        "{} entries where a model reads {length}",
        entries.len()
    );
    entries
}

/// Computes a call at `N` points, with a row of them for each argument.
///
/// # Safety
/// There are as many rows as the call has arguments.
unsafe extern "sysv64" fn compute<const N: usize>(call: &Call, rows: *const Wide, result: &mut Wide) {
    // SAFETY: the caller, the code of a program with this call, has stored this many rows.
    let rows = unsafe { std::slice::from_raw_parts(rows, call.arguments()) };
    for (point, result) in result.0.iter_mut().enumerate().take(N) {
        *result = call.value(|argument| rows[argument].0[point]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use qcar_dsl::expr::Function;
    use qcar_dsl::program::{Op, Value};

    /// Other tests compare with the interpreter, and would pass if there were no code at all.
    #[test]
    fn machine_code_runs_in_each_shape_and_vector_width() {
        [VectorWidth::Four, VectorWidth::Eight]
            .into_iter()
            .for_each(runs_in_each_shape);
    }

    fn runs_in_each_shape(vector_width: VectorWidth) {
        let ops = vec![
            Op::Prepared(1),
            Op::Constant(2.0),
            Op::Mul(Value(0), Value(1)),
            Op::Call(Function::Sin, Value(2)),
        ];
        let outputs = vec![Value(2), Value(3)];
        let program = Program {
            ops,
            outputs,
            curves: Vec::new(),
        };
        let code = |shape| Code::new(&Vectors::default(), &program, shape, vector_width);
        let shapes = [Shape::Single, Shape::Sets, Shape::Points(&[Part::Constants])];
        if !vector_width.is_supported() {
            return assert!(shapes.into_iter().all(|shape| code(shape).is_none()));
        }
        let [once, sets, points] = shapes.map(|shape| code(shape).expect("the program has a translation"));
        let constants = [7.0, 0.25, 0.5, 0.75, 1.0, 1.25];
        let mut at = [0.0; 2];
        once.run(&Arguments::default().with(Part::Constants, &constants), &mut at);
        assert_eq!(at, [0.5, 0.5f64.sin()]);
        let mut rows = [[0.0; LANES]; 2];
        sets.sets(&[(Part::Constants, &[[7.0; LANES], [0.25; LANES]])], &mut rows);
        assert_eq!(rows, [[0.5; LANES], [0.5f64.sin(); LANES]]);
        let columns = [[0.0; 9], std::array::from_fn(|point| 0.25 * (point + 1) as f64)];
        let given = Arguments::default().with(Part::Constants, columns.as_flattened());
        let (mut twice, mut sine) = ([0.0; 9], [0.0; 9]);
        assert!(points.sweep(&given, 9, &mut [&mut twice, &mut sine]));
        assert_eq!(
            (twice, sine),
            (columns[1].map(|x| 2.0 * x), columns[1].map(|x| (2.0 * x).sin()))
        );
    }
}
