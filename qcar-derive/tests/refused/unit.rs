qcar_derive::axle! {
    axle unit {
        param m: kg "Mass";
        param k: N/m "Stiffness";
        direction z {
            road pad;
            mass body = m;
            link spring: body - pad { damper k; }
        }
    }
}

fn main() {}
