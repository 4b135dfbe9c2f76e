//! Whatever an effect file contains, it applies or is refused with a message; the patched model is a valid model.

use qcar_dsl::check::Checked;
use qcar_dsl::check::check_text;
use qcar_dsl::compile::derive;
use qcar_dsl::patch::Patch;
use qcar_dsl::source::Source;

/// Every kind of part that an effect may attach to.
const MODEL: &str = "
axle bench {
    known param m_body: kg = 400;
    known param m_wheel: kg = 40;
    param k: N/m = 25e3 in 5e3..200e3;
    param c: N s/m = 1500;
    param k_tire: N/m = 220e3;
    direction z {
        road pad;
        mass body = m_body;
        mass wheel = m_wheel;
        node seat;
        link tire: wheel - pad { spring k_tire; }
        link mount: body - seat { spring 10*k; damper c; }
        link damper: seat - wheel { damper c; }
        link spring: body - wheel { spring k; }
        output body.acceleration;
        output wheel.acceleration;
    }
    direction x {
        mass body = m_body;
        mass wheel = m_wheel;
        link spring: body - wheel { spring k; damper c; }
        output wheel.acceleration;
    }
}
";

/// The model to which effects are applied.
pub fn bench() -> Checked {
    let source = Source {
        name: "bench.axle".to_string(),
        text: MODEL.to_string(),
    };
    check_text(source, &|_, _| Err(String::new())).unwrap_or_else(|report| panic!("{report}"))
}

/// Fails if an effect makes the compiler panic, or if the compiler refuses the patched model.
pub fn survives(text: &str) {
    let source = Source {
        name: "fuzz.axle".to_string(),
        text: text.to_string(),
    };
    let patch = match Patch::read(source) {
        Ok(patch) => patch,
        Err(report) => return assert!(!report.to_string().is_empty()),
    };
    let model = bench();
    for place in patch.places(&model) {
        match patch.apply(&model, &place, &|_| None) {
            Ok(patched) => drop(derive(patched.model)),
            Err(report) => assert!(!report.to_string().is_empty()),
        }
    }
}
