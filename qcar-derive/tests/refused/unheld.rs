qcar_derive::axle! {
    axle unheld {
        param m: kg "Mass";
        param m_loose: kg "A mass that nothing holds";
        param k: N/m "Stiffness";
        direction z {
            road pad;
            mass body = m;
            mass loose = m_loose;
            link spring: body - pad { spring k; }
        }
    }
}

fn main() {}
