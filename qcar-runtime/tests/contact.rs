//! The contact's closed forms against polygons of 200 000 corners, and against what a flat road must give.

use qcar_runtime::road::{Class, Random, Road, Shape};
use qcar_runtime::tyre::{Geometry, Overlap, Rates, Touch, Tyre, Wheel, segment_area, segment_deflection};
use std::f64::consts::PI;

const RADIUS: f64 = 0.33;
const STATIC: f64 = 0.02;

fn tyre(geometry: Geometry) -> Tyre {
    Tyre::new(RADIUS, STATIC, geometry, Rates::AtStaticDeflection).unwrap()
}

fn wheel(x: f64, z: f64, vx: f64, vz: f64) -> Wheel {
    Wheel {
        position: [x, z],
        velocity: [vx, vz],
    }
}

/// What a polygon sees of the overlap: area, first moments about the centre, and per direction of change the flux
/// and `∫ n |v·n| ds`.
#[derive(Default)]
struct Polygon {
    area: f64,
    moment: [f64; 2],
    growth: [f64; 3],
    shrinkage: [f64; 3],
}

/// Clips the lower half of a polygon, of equal angles, with the ground, edge by edge between all corners of both.
fn polygon(road: &Road, wheel: &Wheel) -> Polygon {
    const EDGES: usize = 200_000;
    let [cx, cz] = wheel.position;
    let mut out = Polygon::default();
    let mut ground = 0;
    let vertices = road.vertices();
    let corner = |i: usize| {
        let angle = PI * (i as f64 / EDGES as f64 - 0.5);
        [cx + RADIUS * angle.sin(), cz - RADIUS * angle.cos()]
    };
    for i in 0..EDGES {
        let (a, b) = (corner(i), corner(i + 1));
        let mut from = a[0];
        while from < b[0] {
            while ground < vertices.len() && vertices[ground][0] <= from {
                ground += 1;
            }
            let to = vertices.get(ground).map_or(b[0], |v| v[0].min(b[0]));
            slab(vertices, ground, (a, b), (from, to), wheel, &mut out);
            from = to;
        }
    }
    out
}

/// Between two x the ground and the edge are straight: what is between them where the ground is higher.
fn slab(
    vertices: &[[f64; 2]],
    ground: usize,
    (a, b): ([f64; 2], [f64; 2]),
    (from, to): (f64, f64),
    wheel: &Wheel,
    out: &mut Polygon,
) {
    let line = |p: [f64; 2], q: [f64; 2], x: f64| p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]);
    let height = |x: f64| match ground {
        0 => vertices[0][1],
        g if g == vertices.len() => vertices[g - 1][1],
        g => line(vertices[g - 1], vertices[g], x),
    };
    let gap = |x: f64| height(x) - line(a, b, x);
    let (mut from, mut to) = (from, to);
    let (left, right) = (gap(from), gap(to));
    if left <= 0.0 && right <= 0.0 {
        return;
    }
    if left < 0.0 {
        from += (to - from) * left / (left - right);
    } else if right < 0.0 {
        to -= (to - from) * right / (right - left);
    }
    let [cx, cz] = wheel.position;
    // Simpson's rule is exact for the squares of straight lines.
    for (x, weight) in [(from, 1.0), ((from + to) / 2.0, 4.0), (to, 1.0)] {
        let weight = weight / 6.0 * (to - from);
        let (high, low) = (height(x) - cz, line(a, b, x) - cz);
        out.area += weight * (high - low);
        out.moment[0] += weight * (x - cx) * (high - low);
        out.moment[1] += weight * (high * high - low * low) / 2.0;
    }
    let slope = (b[1] - a[1]) / (b[0] - a[0]);
    let length = (to - from) * (1.0 + slope * slope).sqrt();
    let normal = [
        slope / (1.0 + slope * slope).sqrt(),
        -1.0 / (1.0 + slope * slope).sqrt(),
    ];
    let flux = (wheel.velocity[0] * normal[0] + wheel.velocity[1] * normal[1]) * length;
    let side = if flux > 0.0 {
        &mut out.growth
    } else {
        &mut out.shrinkage
    };
    side[0] += flux.abs();
    side[1] += normal[0] * flux.abs();
    side[2] += normal[1] * flux.abs();
}

fn compare(road: &Road, wheel: &Wheel) -> Overlap {
    let ours = tyre(Geometry::Area).overlap(road, wheel);
    let theirs = polygon(road, wheel);
    let circle = PI * RADIUS * RADIUS;
    let speed = wheel.velocity[0].hypot(wheel.velocity[1]);
    let check = |what: &str, ours: f64, theirs: f64, scale: f64| {
        assert!(
            (ours - theirs).abs() < 1e-9 * scale,
            "{what} at {wheel:?}: {ours} but the polygon has {theirs}"
        );
    };
    check("area", ours.area, theirs.area, circle);
    for axis in 0..2 {
        check("moment", ours.moment[axis], theirs.moment[axis], circle * RADIUS);
    }
    for (name, sweep, side) in [
        ("growth", ours.growth, theirs.growth),
        ("shrinkage", ours.shrinkage, theirs.shrinkage),
    ] {
        let around = 2.0 * PI * RADIUS * speed;
        check(name, sweep.flux, side[0], around);
        check(name, sweep.moment[0], side[1], around);
        check(name, sweep.moment[1], side[2], around);
    }
    ours
}

/// Uniform numbers for positions and velocities.
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn cleat() -> Road {
    Road::from_shape(
        &Shape::Cleat {
            height: 0.03,
            descent: 0.366,
            blend: 0.208,
        },
        1.5,
    )
    .unwrap()
}

#[test]
fn random_roads_agree_with_polygons() {
    let random = Random {
        class: Class::E,
        seed: 7,
        length: 30.0,
        spacing: 0.01,
    };
    let road = Road::from_random(&random).unwrap();
    let mut dice = Dice(1);
    for _ in 0..60 {
        let x = dice.between(6.0, 29.0);
        let z = road.height(x) + RADIUS - dice.between(-0.002, 0.05);
        compare(&road, &wheel(x, z, dice.between(-10.0, 10.0), dice.between(-2.0, 2.0)));
    }
}

#[test]
fn obstacles_agree_with_polygons() {
    let mut dice = Dice(2);
    let shapes = [
        Shape::Cleat {
            height: 0.04,
            descent: 0.366,
            blend: 0.208,
        },
        Shape::HalfSine {
            height: 0.02,
            length: 0.1,
        },
        Shape::Plank {
            height: 0.025,
            length: 0.08,
        },
        Shape::Pothole {
            depth: 0.05,
            length: 0.15,
        },
    ];
    let mut most_patches = 0;
    for shape in &shapes {
        let road = Road::from_shape(shape, 1.0).unwrap();
        for _ in 0..25 {
            let (x, z) = (dice.between(0.7, 1.7), RADIUS - dice.between(-0.02, 0.04));
            let overlap = compare(&road, &wheel(x, z, dice.between(3.0, 12.0), dice.between(-2.0, 2.0)));
            most_patches = most_patches.max(overlap.patches);
        }
    }
    assert!(most_patches >= 2, "no obstacle was touched in two places");
}

#[test]
fn finely_sampled_ground_agrees_with_polygons() {
    let x: Vec<f64> = (0..4001).map(|i| f64::from(i) * 5e-4).collect();
    let z: Vec<f64> = x
        .iter()
        .map(|x| 0.004 * (40.0 * x).sin() + 0.01 * (9.0 * x).cos())
        .collect();
    let points: Vec<[f64; 2]> = x.iter().zip(&z).map(|(&x, &z)| [x, z]).collect();
    let road = Road::from_points(&points).unwrap();
    let mut dice = Dice(3);
    for _ in 0..40 {
        let x = dice.between(0.0, 2.0);
        compare(
            &road,
            &wheel(
                x,
                dice.between(0.29, 0.34),
                dice.between(-9.0, 9.0),
                dice.between(-2.0, 2.0),
            ),
        );
    }
}

#[test]
fn the_rates_are_the_derivative_of_the_area() {
    let (road, tyre) = (cleat(), tyre(Geometry::Area));
    let (vx, vz, dt) = (8.0, -0.7, 1e-7);
    for x in [1.2, 1.35, 1.45, 1.7, 2.0, 2.2] {
        let at = |t: f64| tyre.overlap(&road, &wheel(x + vx * t, 0.315 + vz * t, vx, vz));
        let (before, now, after) = (at(-dt), at(0.0), at(dt));
        let rate = (after.area - before.area) / (2.0 * dt);
        assert!(
            (now.growth.flux - now.shrinkage.flux - rate).abs() < 1e-7,
            "at {x}: {rate} against {now:?}"
        );
    }
}

#[test]
fn a_flat_road_gives_equation_3_4() {
    let tyre = tyre(Geometry::Area);
    for d in [1e-4, 1e-3, 0.02, 0.05, 0.1, 0.2, 0.32_f64] {
        let r = RADIUS;
        let area = r * r * ((r - d) / r).acos() - (r - d) * (2.0 * r * d - d * d).sqrt();
        let overlap = tyre.overlap(&Road::flat(0.5), &wheel(3.0, 0.5 + r - d, 5.0, -1.0));
        assert!((tyre.area(d) - area).abs() < 1e-14, "equation 3.4 at {d}");
        assert!((overlap.area - area).abs() < 1e-14, "overlap at {d}");
    }
}

#[test]
fn the_inverse_keeps_its_digits_for_the_lightest_touch() {
    for d in [1e-15, 1e-12, 1e-9, 1e-6, 1e-5_f64] {
        // Equation 3.4 for small deflections, to the second term that follows the leading one.
        let area = (32.0 * d.powi(3)).sqrt() / 3.0 * (1.0 - 3.0 * d / 20.0 - 3.0 * d * d / 224.0);
        assert!((segment_deflection(area) / d - 1.0).abs() < 1e-14, "inverse at {d}");
    }
    for d in [1e-3, 0.02, 0.06, 0.1, 0.14, 0.16, 0.3] {
        assert!(
            (segment_deflection(segment_area(d)) / d - 1.0).abs() < 1e-12,
            "inverse at {d}"
        );
    }
}

#[test]
fn the_inverse_of_the_segment_is_its_inverse_everywhere() {
    for i in 1..2000 {
        let deflection = f64::from(i) * 1e-3;
        let back = segment_deflection(segment_area(deflection));
        assert!((back - deflection).abs() < 1e-11, "{deflection} came back as {back}");
    }
}

#[test]
fn a_straight_slope_gives_what_the_whole_road_gives() {
    // The same plane, once as one piece and once broken by vertices on it that no simplification removes.
    let plain = Road::from_points(&[[0.0, 0.0], [10.0, 1.0]]).unwrap();
    let broken = Road::from_points(&[[0.0, 0.0], [4.9, 0.49], [5.0, 0.5 + 1e-11], [10.0, 1.0]]).unwrap();
    assert_eq!((plain.vertices().len(), broken.vertices().len()), (2, 4));
    let at = wheel(5.0, 0.5 + RADIUS - 0.02, 8.0, 0.3);
    let (a, b) = (
        tyre(Geometry::Area).touch(&plain, &at).unwrap(),
        tyre(Geometry::Area).touch(&broken, &at).unwrap(),
    );
    for (one, other) in numbers(&a).into_iter().zip(numbers(&b)) {
        assert!((one - other).abs() < 1e-8, "{a:?} against {b:?}");
    }
}

fn numbers(touch: &Touch) -> [f64; 9] {
    let Touch {
        deflection,
        direction: d,
        growth,
        shrinkage,
    } = *touch;
    let (g, s) = (growth.direction, shrinkage.direction);
    [
        deflection,
        d[0],
        d[1],
        growth.rate,
        g[0],
        g[1],
        shrinkage.rate,
        s[0],
        s[1],
    ]
}

fn law(s: f64, v: f64) -> f64 {
    150e3 * s - 2e6 * s * s + 200.0 * v
}

#[test]
fn a_mirrored_road_mirrors_the_longitudinal_force() {
    let road = Road::from_random(&Random {
        class: Class::D,
        seed: 3,
        length: 20.0,
        spacing: 0.02,
    })
    .unwrap();
    let mirrored = road.mirrored();
    for geometry in [Geometry::Area, Geometry::Radial, Geometry::Point] {
        let tyre = tyre(geometry);
        for i in 0..100 {
            let (x, vx, vz) = (6.03 + 0.1 * f64::from(i), 8.0, -0.5);
            let z = road.height(x) + RADIUS - 0.02;
            let one = tyre.touch(&road, &wheel(x, z, vx, vz)).unwrap().force(law);
            let other = tyre.touch(&mirrored, &wheel(-x, z, -vx, vz)).unwrap().force(law);
            assert!(
                (one.force[0] - other.force[0]).abs() < 1e-6 * one.force[0].abs(),
                "{geometry:?} z at {x}"
            );
            assert!(
                (one.force[1] + other.force[1]).abs() < 1e-6 * one.force[0].abs(),
                "{geometry:?} x at {x}"
            );
        }
    }
}

#[test]
fn the_force_is_continuous_over_a_vertical_step() {
    let (road, step) = (cleat(), 1e-6);
    for geometry in [Geometry::Area, Geometry::Radial] {
        let tyre = tyre(geometry);
        let force = |x: f64| {
            tyre.touch(&road, &wheel(x, RADIUS - 0.015, 8.0, 0.0))
                .unwrap()
                .force(law)
                .force
        };
        let mut last = force(1.2);
        for i in 1..900_000 / 10 {
            let next = force(1.2 + 10.0 * step * f64::from(i));
            // 10 µm of road change the force of 5 kN by a few newton at most, even where a corner is first touched.
            assert!(
                (next[0] - last[0]).abs() < 20.0 && (next[1] - last[1]).abs() < 20.0,
                "{geometry:?} at {i}"
            );
            last = next;
        }
    }
}

#[test]
fn no_contact_is_no_touch() {
    for geometry in [Geometry::Area, Geometry::Radial, Geometry::Point] {
        let above = wheel(1.7, RADIUS + 0.031, 8.0, 1.0);
        assert_eq!(tyre(geometry).touch(&cleat(), &above), None);
        assert_eq!(
            tyre(geometry).touch(&Road::flat(0.0), &wheel(0.3, RADIUS, 8.0, -1.0)),
            None
        );
    }
}

#[test]
fn the_total_force_never_pulls() {
    let (road, mut dice) = (cleat(), Dice(5));
    for geometry in [Geometry::Area, Geometry::Radial] {
        for _ in 0..2000 {
            let (x, z) = (dice.between(1.1, 2.4), RADIUS - dice.between(0.0, 0.03));
            let at = wheel(x, z, dice.between(0.0, 12.0), dice.between(-1.0, 60.0));
            let Some(touch) = tyre(geometry).touch(&road, &at) else {
                continue;
            };
            let contact = touch.force(|s, v| law(s, 20.0 * v));
            let along = contact.force[1] * touch.direction[0] + contact.force[0] * touch.direction[1];
            assert!(along >= -1e-9, "{geometry:?} pulls with {along} N at {at:?}");
        }
    }
}

#[test]
fn vertical_motion_on_a_flat_road_has_the_rate_of_the_wheel() {
    for geometry in [Geometry::Area, Geometry::Point] {
        for rates in [Rates::AtStaticDeflection, Rates::AtDeflection] {
            let tyre = Tyre::new(RADIUS, STATIC, geometry, rates).unwrap();
            let down = tyre
                .touch(&Road::flat(0.0), &wheel(0.0, RADIUS - STATIC, 0.0, -0.3))
                .unwrap();
            assert!((down.growth.rate - 0.3).abs() < 1e-12 && down.shrinkage.rate == 0.0);
            let up = tyre
                .touch(&Road::flat(0.0), &wheel(0.0, RADIUS - STATIC, 0.0, 0.3))
                .unwrap();
            assert!((up.shrinkage.rate - 0.3).abs() < 1e-12 && up.growth.rate == 0.0);
        }
    }
}

#[test]
fn radii_on_a_flat_road_give_the_thesis_formula() {
    let (stiffness, damping, vz) = (3e5, 400.0, -0.4);
    let tyre = tyre(Geometry::Radial);
    for deflection in [0.001, STATIC, 0.05_f64] {
        let half = ((RADIUS - deflection) / RADIUS).acos();
        let force = 2.0 * stiffness * RADIUS * (half.sin() - half * half.cos())
            - damping * vz * (half.cos() * half.sin() + half);
        let at_rest = ((RADIUS - STATIC) / RADIUS).acos();
        let per_rate = damping * (at_rest + at_rest.sin() * at_rest.cos());
        let touch = tyre
            .touch(&Road::flat(0.0), &wheel(0.4, RADIUS - deflection, 0.0, vz))
            .unwrap();
        let ours = touch.force(|s, v| {
            let half = ((RADIUS + s) / RADIUS).acos();
            -2.0 * stiffness * RADIUS * (half.sin() - half * half.cos()) + per_rate * v
        });
        assert!(
            (ours.force[0] / force - 1.0).abs() < 1e-9,
            "{ours:?} against {force} at {deflection}"
        );
        assert!(ours.force[1].abs() < 1e-9 * force);
    }
}

#[test]
fn radii_agree_with_a_sum_over_many_rays() {
    const RAYS: usize = 20_000;
    let road = Road::from_shape(
        &Shape::Plank {
            height: 0.02,
            length: 0.05,
        },
        1.0,
    )
    .unwrap();
    for (x, deflection) in [(0.9, 0.02), (1.02, 0.01), (1.13, 0.02), (1.3, 0.03)] {
        let z = RADIUS - deflection;
        let mut sum = [0.0; 2];
        for i in 0..RAYS {
            let angle = PI * ((i as f64 + 0.5) / RAYS as f64 - 0.5);
            let compression = RADIUS - first_ground(&road, [x, z], angle);
            sum[0] -= compression * angle.sin() * PI / RAYS as f64;
            sum[1] += compression * angle.cos() * PI / RAYS as f64;
        }
        let size = sum[0].hypot(sum[1]);
        let touch = tyre(Geometry::Radial).touch(&road, &wheel(x, z, 0.0, 0.0)).unwrap();
        let half = ((RADIUS - touch.deflection) / RADIUS).acos();
        assert!(
            (2.0 * RADIUS * (half.sin() - half * half.cos()) / size - 1.0).abs() < 2e-3,
            "size at {x}"
        );
        assert!(
            (touch.direction[0] - sum[0] / size).abs() < 2e-3,
            "direction at {x}: {touch:?} against {sum:?}"
        );
    }
}

/// Distance to the ground along a ray, found by walking, with short steps where a long one would lead below it; the
/// radius where there is none nearer.
fn first_ground(road: &Road, [x, z]: [f64; 2], angle: f64) -> f64 {
    let mut distance = 0.2;
    for step in [1e-4, 1e-5] {
        let above = |distance: f64| z - distance * angle.cos() > road.height(x + distance * angle.sin());
        while distance < RADIUS && above(distance + step) {
            distance += step;
        }
    }
    distance.min(RADIUS)
}

#[test]
fn the_progressive_law_meets_the_static_point() {
    let (load, d0, k) = (4815.7, 0.02361, 230_900.0);
    let (a, b) = (2.0 * load / d0 - k, (k - load / d0) / d0);
    let force = |d: f64| a * d + b * d * d;
    let slope = |d: f64| (force(d + 1e-7) - force(d - 1e-7)) / 2e-7;
    assert_eq!(force(0.0), 0.0);
    assert!((force(d0) / load - 1.0).abs() < 1e-12 && (slope(d0) / k - 1.0).abs() < 1e-6);
    assert!(
        (1..100).all(|i| slope(f64::from(i + 1) * 1e-3) > slope(f64::from(i) * 1e-3)),
        "progressive"
    );
}

#[test]
fn impossible_tyres_are_refused() {
    for (radius, deflection) in [
        (0.3, 0.3),
        (0.3, -0.1),
        (-0.3, 0.1),
        (f64::NAN, 0.1),
        (0.3, f64::NAN),
        (0.3, 0.0),
    ] {
        assert!(Tyre::new(radius, deflection, Geometry::Area, Rates::AtStaticDeflection).is_err());
    }
    let error = Tyre::new(0.3, 0.31, Geometry::Area, Rates::AtStaticDeflection).unwrap_err();
    assert_eq!(
        error.to_string(),
        "found a static deflection of 0.31 m, expected more than 0 and less than the radius, 0.3 m"
    );
}
