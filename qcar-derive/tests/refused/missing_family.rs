qcar_derive::axle! {
    axle missing_family from "families/none.axle" {
    }
}

fn main() {}
