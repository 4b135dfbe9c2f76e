qcar_derive::axle! {
    axle several {
        param m: kg "Mass";
        param k: N/m "Stiffness";
        direction z {
            road pad;
            mass body = m;
            link spring: body - pda { spring k; }
            link damper: body - pad { damper c; }
        }
    }
}

fn main() {}
