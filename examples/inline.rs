//! A model in the text of a program, and the effect of a softer spring.
//!
//! ```text
//! cargo run --example inline
//! ```

use std::error::Error;

qcar_derive::axle! {
    axle quarter {
        "A body on a spring and damper, a wheel on a tyre"
        param m_body: kg = 360 "Mass of the body";
        param m_wheel: kg = 40 "Mass of the wheel";
        param k: N/m = 25 N/mm "Stiffness of the spring";
        param c: N s/m = 1500 "Damping";
        param k_tire: N/m = 220 N/mm "Stiffness of the tyre";
        direction z {
            road pad;
            mass body = m_body;
            mass wheel = m_wheel;
            link tire: wheel - pad { spring k_tire; }
            link strut: body - wheel { spring k; damper c; }
            output body.acceleration;
        }
    }
}

/// Shows the eigenvalues of two parameter sets.
pub fn main() -> Result<(), Box<dyn Error>> {
    let usual = quarter::Parameters::default();
    let soft = quarter::Parameters { k: 18e3, ..usual };
    for (name, p) in [("usual", usual), ("soft", soft)] {
        let system = quarter::state_space(&p);
        println!("{name}:");
        for root in system.a.complex_eigenvalues().iter().filter(|root| root.im > 0.0) {
            let (natural, damping) = (root.norm() / std::f64::consts::TAU, -root.re / root.norm());
            println!("  {natural:6.2} Hz, damping ratio {damping:.3}");
        }
    }
    Ok(())
}
