//! The layouts of the corner family, and their equations assembled from the tables of the thesis as numbers.

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix, DVector};

/// A choice of every option of the family.
#[derive(Clone, Debug)]
pub struct Layout {
    top_mount: bool,
    subframe: bool,
    subframe_x: &'static str,
    powertrain: &'static str,
    spring_arm: bool,
    damper_arm: bool,
    spring_reaction: &'static str,
    damper_reaction: &'static str,
}

/// A linear combination of positions, `pad` among them.
type Stretch = Vec<(&'static str, f64)>;

/// Stretch, stiffness, damping.
type Link = (Stretch, f64, f64);

/// Values for every parameter that a layout may have, SI: invented, of the size of a mid-size car.
pub const VALUES: [(&str, f64); 27] = [
    ("m_corner", 505.0),
    ("m_half_vehicle", 1010.0),
    ("m_wheel_other_axle", 39.0),
    ("m_wheel", 43.0),
    ("m_tm", 4.2),
    ("m_sf", 22.0),
    ("m_pwt", 57.0),
    ("k_wheel_z", 31e3),
    ("c_wheel_z", 1900.0),
    ("mr_spring", 0.63),
    ("mr_damper", 0.71),
    ("k_tm", 520e3),
    ("c_tm", 710.0),
    ("k_sf_z", 1.3e6),
    ("c_sf_z", 900.0),
    ("k_pwt_z", 260e3),
    ("c_pwt_z", 480.0),
    ("k_tire", 225e3),
    ("c_tire", 140.0),
    ("static_tire_load", 4954.0),
    ("static_tire_def", 0.0235),
    ("k_wheel_x", 450e3),
    ("c_wheel_x", 820.0),
    ("k_sf_x", 2.1e6),
    ("c_sf_x", 1250.0),
    ("k_pwt_x", 290e3),
    ("c_pwt_x", 430.0),
];

/// The value of a parameter.
pub fn value(name: &str) -> f64 {
    VALUES
        .iter()
        .find(|(n, _)| *n == name)
        .unwrap_or_else(|| panic!("no value for {name}"))
        .1
}

/// All that the thesis's section 3.3.1.2 allows, and those with a sub-frame that moves in x alone.
pub fn valid() -> Vec<Layout> {
    let mut found = Vec::new();
    for bits in 0..16 {
        let on = |bit: u32| bits >> bit & 1 == 1;
        let free = if on(1) { vec!["body", "subframe"] } else { vec!["body"] };
        for subframe_x in if on(1) {
            vec!["as_z"]
        } else {
            vec!["as_z", "mass", "node"]
        } {
            for powertrain in ["none"].into_iter().chain(free.iter().copied()) {
                for spring_reaction in free.iter().copied() {
                    for damper_reaction in free.iter().copied() {
                        found.push(Layout {
                            top_mount: on(0),
                            subframe: on(1),
                            subframe_x,
                            powertrain,
                            spring_arm: on(2),
                            damper_arm: on(3),
                            spring_reaction,
                            damper_reaction,
                        });
                    }
                }
            }
        }
    }
    found
}

impl Layout {
    /// As an axle file chooses it.
    pub fn choices(&self) -> String {
        let on = |on: bool| if on { "on" } else { "off" };
        let arm = |arm: bool| if arm { "arm" } else { "upright" };
        let Layout {
            subframe_x,
            powertrain,
            spring_reaction,
            damper_reaction,
            ..
        } = self;
        let (top_mount, subframe) = (on(self.top_mount), on(self.subframe));
        let (spring, damper) = (arm(self.spring_arm), arm(self.damper_arm));
        format!(
            "top_mount = {top_mount}; subframe = {subframe}; subframe_x = {subframe_x}; powertrain = {powertrain}; \
             spring = {spring}; damper = {damper}; spring_reaction = {spring_reaction}; \
             damper_reaction = {damper_reaction};"
        )
    }

    /// True where the sub-frame is a part of the body in z and none in x.
    pub fn moves_in_x_alone(&self) -> bool {
        self.subframe_x != "as_z"
    }

    /// The acceleration of every mass for a unit excitation at ω: a pad displacement of 1 m, or a force of 1 N.
    pub fn accelerations(&self, axis: &str, excitation: &str, omega: f64) -> BTreeMap<String, Complex<f64>> {
        let (masses, links) = if axis == "z" {
            (self.masses_z(), self.links_z())
        } else {
            self.chain_x()
        };
        let place = |name: &str| masses.iter().position(|(mass, _)| *mass == name);
        let mut dynamic = DMatrix::<Complex<f64>>::zeros(masses.len(), masses.len());
        let mut force = DVector::<Complex<f64>>::zeros(masses.len());
        for (at, (_, mass)) in masses.iter().enumerate() {
            dynamic[(at, at)] -= omega * omega * mass;
        }
        for (stretch, k, c) in &links {
            let kappa = Complex::new(*k, omega * c);
            for (row, s_row) in stretch.iter().filter_map(|(name, s)| Some((place(name)?, s))) {
                for (name, s) in stretch {
                    match place(name) {
                        Some(column) => dynamic[(row, column)] += kappa * s_row * *s,
                        None if excitation == "pad" => force[row] -= kappa * s_row * *s,
                        None => (),
                    }
                }
            }
        }
        if excitation != "pad" {
            force[place("wheel").unwrap()] += 1.0;
        }
        let q = dynamic.lu().solve(&force).unwrap();
        let moving = masses.iter().zip(q.iter()).filter(|((_, mass), _)| *mass > 0.0);
        moving
            .map(|((name, _), q)| (name.to_string(), -omega * omega * q))
            .collect()
    }

    fn masses_z(&self) -> Vec<(&'static str, f64)> {
        let mut masses = vec![("wheel", value("m_wheel"))];
        let on = [
            (self.top_mount, "tm", "m_tm"),
            (self.subframe, "sf", "m_sf"),
            (self.powertrain != "none", "pwt", "m_pwt"),
        ];
        masses.extend(
            on.iter()
                .filter(|(on, ..)| *on)
                .map(|&(_, name, mass)| (name, value(mass))),
        );
        let others: f64 = masses.iter().map(|(_, mass)| mass).sum();
        masses.push(("body", value("m_corner") - others));
        masses
    }

    fn links_z(&self) -> Vec<Link> {
        let seat = |reaction: &str| if reaction == "subframe" { "sf" } else { "body" };
        let pivot = if self.subframe { "sf" } else { "body" };
        let top = if self.top_mount {
            "tm"
        } else {
            seat(self.damper_reaction)
        };
        let arm = |top, ratio: f64| vec![(top, 1.0), (pivot, ratio - 1.0), ("wheel", -ratio)];
        let (k, c) = (value("k_wheel_z"), value("c_wheel_z"));
        let (of_spring, of_damper) = (value("mr_spring"), value("mr_damper"));
        let mut links = vec![
            (difference("wheel", "pad"), value("k_tire"), value("c_tire")),
            match self.spring_arm {
                true => (arm(seat(self.spring_reaction), of_spring), k / of_spring.powi(2), 0.0),
                false => (difference(seat(self.spring_reaction), "wheel"), k, 0.0),
            },
            match self.damper_arm {
                true => (arm(top, of_damper), 0.0, c / of_damper.powi(2)),
                false => (difference(top, "wheel"), 0.0, c),
            },
        ];
        if self.top_mount {
            links.push((
                difference(seat(self.damper_reaction), "tm"),
                value("k_tm"),
                value("c_tm"),
            ));
        }
        if self.subframe {
            links.push((difference("body", "sf"), value("k_sf_z"), value("c_sf_z")));
        }
        if self.powertrain != "none" {
            links.push((
                difference("pwt", seat(self.powertrain)),
                value("k_pwt_z"),
                value("c_pwt_z"),
            ));
        }
        links
    }

    fn chain_x(&self) -> (Vec<(&'static str, f64)>, Vec<Link>) {
        let (k, c) = (value("k_wheel_x"), value("c_wheel_x"));
        let mut masses = vec![
            ("wheel", value("m_wheel")),
            ("wheel_other", value("m_wheel_other_axle")),
        ];
        let mut links = vec![(difference("wheel_other", "body"), k, c)];
        if self.subframe || self.subframe_x != "as_z" {
            masses.push(("sf", if self.subframe_x == "node" { 0.0 } else { value("m_sf") }));
            links.push((difference("wheel", "sf"), k, c));
            links.push((difference("sf", "body"), value("k_sf_x"), value("c_sf_x")));
        } else {
            links.push((difference("wheel", "body"), k, c));
        }
        if self.powertrain != "none" {
            let seat = if self.powertrain == "subframe" { "sf" } else { "body" };
            masses.push(("pwt", value("m_pwt")));
            links.push((difference("pwt", seat), value("k_pwt_x"), value("c_pwt_x")));
        }
        let others: f64 = masses.iter().map(|(_, mass)| mass).sum();
        masses.push(("body", value("m_half_vehicle") - others));
        (masses, links)
    }
}

fn difference(upper: &'static str, lower: &'static str) -> Stretch {
    vec![(upper, 1.0), (lower, -1.0)]
}
