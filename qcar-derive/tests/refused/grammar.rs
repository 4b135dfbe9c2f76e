qcar_derive::axle! {
    axle grammar {
        param m kg;
    }
}

fn main() {}
