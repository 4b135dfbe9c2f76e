//! Roads from samples, shapes and noise: what they keep, and what they refuse.

use qcar_runtime::road::{Class, Random, Road, RoadError, Shape};

const CLEAT: Shape = Shape::Cleat {
    height: 0.03,
    descent: 0.366,
    blend: 0.208,
};

/// A cleat as a campaign samples it: every millimetre, six decimals, the step between two samples.
fn sampled_cleat() -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let exact = Road::from_shape(&CLEAT, 1.501).unwrap();
    let round = |v: f64| (v * 1e6).round() / 1e6;
    let x: Vec<f64> = (0..6000).map(|i| f64::from(i) / 1000.0).collect();
    let z = x.iter().map(|&x| round(exact.height(x + 1e-9))).collect();
    let slope = x
        .iter()
        .map(|&x| round((exact.height(x + 0.0009) - exact.height(x + 0.0001)) / 0.0008))
        .collect();
    (x, z, slope)
}

#[test]
fn samples_on_a_line_become_one_segment_and_a_jump_becomes_a_step() {
    let (x, z, slope) = sampled_cleat();
    let road = Road::from_samples(&x, &z, &slope).unwrap();
    assert_eq!(road.steps().collect::<Vec<_>>(), [1.501]);
    assert_eq!((road.height(1.501 - 1e-9), road.height(1.501)), (0.0, 0.03));
    assert!(road.vertices().len() < 80, "{} vertices", road.vertices().len());
    for (x, z) in x.iter().zip(&z) {
        assert!((road.height(*x) - z).abs() <= 1.01e-6, "height at {x}");
    }
}

#[test]
fn the_cleat_returns_to_the_flat_with_continuous_curvature() {
    let road = Road::from_shape(&CLEAT, 1.0).unwrap();
    let slope = 0.03 / (0.366 + 0.104);
    assert!((road.slope(1.1) + slope).abs() < 1e-12);
    assert_eq!(
        (road.height(0.999), road.height(1.0), road.height(1.6)),
        (0.0, 0.03, 0.0)
    );
    let mean_slope = |x: f64| (road.height(x + 0.01) - road.height(x - 0.01)) / 0.02;
    assert!(
        (mean_slope(1.366 + 0.104) + slope / 2.0).abs() < 1e-4,
        "half the slope in the middle of the return"
    );
    let curvature = |x: f64| (mean_slope(x + 0.01) - mean_slope(x - 0.01)) / 0.02;
    let largest = 1.5 * slope / 0.208;
    assert!(curvature(1.366).abs() < 0.2 * largest && curvature(1.574).abs() < 0.2 * largest);
    assert!((curvature(1.366 + 0.104) / largest - 1.0).abs() < 0.05);
}

#[test]
fn shapes_have_their_heights_and_steps() {
    let half_sine = Road::from_shape(
        &Shape::HalfSine {
            height: 0.05,
            length: 0.5,
        },
        2.0,
    )
    .unwrap();
    for x in [0.07, 0.2, 0.33_f64] {
        let height = 0.05 * (std::f64::consts::PI * x / 0.5).sin();
        assert!((half_sine.height(2.0 + x) - height).abs() < 2e-7, "half-sine at {x}");
    }
    let plank = Road::from_shape(
        &Shape::Plank {
            height: 0.02,
            length: 0.1,
        },
        2.0,
    )
    .unwrap();
    assert_eq!(plank.steps().collect::<Vec<_>>(), [2.0, 2.1]);
    assert_eq!(plank.height(2.05), 0.02);
    let pothole = Road::from_shape(
        &Shape::Pothole {
            depth: 0.06,
            length: 0.4,
        },
        2.0,
    )
    .unwrap();
    assert_eq!(
        (pothole.height(1.9), pothole.height(2.2), pothole.height(2.5)),
        (0.0, -0.06, 0.0)
    );
}

#[test]
fn the_road_goes_on_flat_beyond_its_ends() {
    let road = Road::from_points(&[[1.0, 0.2], [2.0, 0.5]]).unwrap();
    assert_eq!((road.height(-1e6), road.height(1e6)), (0.2, 0.5));
    assert_eq!((road.slope(0.0), road.slope(3.0)), (0.0, 0.0));
    assert_eq!(
        road.check_reaches(2.5),
        Err(RoadError::TooShort { end: 2.0, needed: 2.5 })
    );
}

/// Power of the road around a wave number, by projection on many sines within a band.
fn band_density(road: &Road, low: f64, high: f64) -> f64 {
    let (start, step, count) = (10.0, 0.05, 40_000);
    let length = step * f64::from(count);
    let bins = ((high - low) * length).floor();
    let window = |i: i32| (std::f64::consts::PI * f64::from(i) / f64::from(count)).sin().powi(2);
    let heights: Vec<f64> = (0..count)
        .map(|i| window(i) * road.height(start + step * f64::from(i)))
        .collect();
    let every = (bins as usize / 40).max(1);
    let lines: Vec<f64> = (0..bins as usize)
        .step_by(every)
        .map(|k| {
            let turn = std::f64::consts::TAU * (low + k as f64 / length) * step;
            let (re, im) = heights.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, z)| {
                let (sine, cosine) = (turn * i as f64).sin_cos();
                (re + z * cosine, im + z * sine)
            });
            // The window keeps 3/8 of the power.
            2.0 * step * step * (re * re + im * im) / (length * 0.375)
        })
        .collect();
    lines.iter().sum::<f64>() / lines.len() as f64
}

#[test]
fn a_random_road_has_the_density_of_its_class() {
    let random = Random {
        class: Class::C,
        seed: 11,
        length: 2010.0,
        spacing: 0.03,
    };
    let road = Road::from_random(&random).unwrap();
    for centre in [0.02, 0.04, 0.1, 0.2_f64] {
        let (low, high) = (centre / 1.4, centre * 1.4);
        let expected = 256e-6 * 0.01 / (low * high);
        let found = band_density(&road, low, high);
        assert!(
            (found / expected).ln().abs() < 0.5,
            "{found} instead of {expected} around {centre}"
        );
    }
}

#[test]
fn every_class_has_the_density_of_the_standard() {
    // ISO 8608, table C.2: geometric means of G(n0) at n0 = 0.1 cycles/m, 1e-6 m³.
    let table = [16.0, 64.0, 256.0, 1024.0, 4096.0, 16384.0, 65536.0, 262144.0];
    let classes = [
        Class::A,
        Class::B,
        Class::C,
        Class::D,
        Class::E,
        Class::F,
        Class::G,
        Class::H,
    ];
    for (class, density) in classes.into_iter().zip(table) {
        let road = |seed| {
            let (length, spacing) = (2010.0, 0.03);
            Road::from_random(&Random {
                class,
                seed,
                length,
                spacing,
            })
            .unwrap()
        };
        let found = (1..=4).map(|seed| band_density(&road(seed), 0.05, 0.2)).sum::<f64>() / 4.0;
        // G(n0) (n/n0)^-2, its mean over the band.
        let expected = 1e-6 * density * 0.01 / (0.05 * 0.2);
        assert!(
            (found / expected - 1.0).abs() < 0.2,
            "{class:?}: {found}, not {expected}"
        );
    }
}

#[test]
fn a_seed_is_a_road() {
    let random = Random {
        class: Class::B,
        seed: 5,
        length: 30.0,
        spacing: 0.03,
    };
    let road = |seed| Road::from_random(&Random { seed, ..random }).unwrap();
    assert_eq!(road(5).vertices(), road(5).vertices());
    assert_ne!(road(5).vertices(), road(6).vertices());
    assert_eq!(road(5).height(0.0), 0.0);
}

#[test]
fn roads_that_make_no_sense_are_refused() {
    let ramp: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
    let flat = vec![0.0; 200];
    let with = |at: usize, value: f64| {
        let mut z = flat.clone();
        z[at] = value;
        z
    };
    let noise: Vec<f64> = (0..200).map(|i| 1e-3 * f64::from(i * 7919 % 13)).collect();
    let chords = |z: &[f64]| {
        (0..200)
            .map(|i| (z[(i + 1).min(199)] - z[i]) / 0.01)
            .collect::<Vec<f64>>()
    };
    let cases = [
        (
            Road::from_samples(&ramp[..1], &flat[..1], &flat[..1]),
            "a road of one point",
        ),
        (
            Road::from_samples(&ramp, &flat[1..], &flat),
            "columns x, z and slope of 200, 199 and 200 values",
        ),
        (
            Road::from_samples(&ramp, &with(3, f64::NAN), &flat),
            "NaN as z of sample 3",
        ),
        (
            Road::from_samples(&ramp, &flat, &with(4, f64::INFINITY)),
            "inf as slope of sample 4",
        ),
        (
            Road::from_samples(&with(100, -1.0), &flat, &flat),
            "x that falls from 0 m to -1 m at sample 100",
        ),
        (Road::from_samples(&flat, &flat, &flat), "all points at x = 0 m"),
        (
            Road::from_samples(&ramp, &with(50, 0.05), &flat),
            "where the heights rise by",
        ),
        (
            Road::from_samples(&ramp, &noise, &chords(&noise)),
            "a road rougher than its sampling",
        ),
        (
            Road::from_shape(
                &Shape::Plank {
                    height: 0.0,
                    length: 1.0,
                },
                1.0,
            ),
            "height of the plank of 0 m",
        ),
        (Road::from_shape(&CLEAT, -1.0), "run-in of -1 m"),
        (
            Road::from_random(&Random {
                class: Class::A,
                seed: 1,
                length: 50.0,
                spacing: 0.1,
            }),
            "spacing of the random",
        ),
        (
            Road::from_random(&Random {
                class: Class::A,
                seed: 1,
                length: 2.0,
                spacing: 0.01,
            }),
            "length of the random",
        ),
    ];
    for (result, message) in cases {
        let found = result.expect_err(message).to_string();
        assert!(found.contains(message), "`{found}` does not say `{message}`");
    }
}

/// Heights in another unit than the slopes: too small for a single slope to contradict them.
#[test]
fn slopes_that_are_a_multiple_of_the_rises_are_refused() {
    let (x, z, slope) = sampled_cleat();
    for (factor, wrong) in [(1e-3, 1e3), (0.3048, 3.2808)] {
        let scaled: Vec<f64> = z.iter().map(|z| z * factor).collect();
        match Road::from_samples(&x, &scaled, &slope) {
            Err(RoadError::SlopeInOtherUnit { factor }) => assert!((factor / wrong - 1.0).abs() < 0.03, "{factor}"),
            other => panic!("{factor}: {other:?}"),
        }
    }
    let per_cent: Vec<f64> = slope.iter().map(|slope| slope * 0.01).collect();
    let found = Road::from_samples(&x, &z, &per_cent);
    assert!(matches!(found, Err(RoadError::SlopeInOtherUnit { .. })), "{found:?}");
    assert!(
        Road::from_samples(&x, &z, &vec![0.0; x.len()]).is_ok(),
        "slopes that say nothing"
    );
}

/// A slope that a profilometer smooths over a metre, or in which noise is as large as the slope, is one of this road.
#[test]
fn slopes_of_a_measured_road_may_be_smooth_or_noisy() {
    let x: Vec<f64> = (0..4000).map(|i| 0.01 * f64::from(i)).collect();
    let height = |x: f64| 0.01 * (0.7 * x).sin() + 0.002 * (9.0 * x).sin();
    let z: Vec<f64> = x.iter().map(|&x| height(x)).collect();
    let smooth: Vec<f64> = x
        .iter()
        .map(|&x| (height(x + 0.505) - height(x - 0.495)) / 1.0)
        .collect();
    Road::from_samples(&x, &z, &smooth).unwrap();
    let mut state = 5u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.06 * (f64::from(state) / f64::from(u32::MAX) - 0.5)
    };
    let noisy: Vec<f64> = x
        .iter()
        .map(|&x| (height(x + 0.01) - height(x)) / 0.01 + noise())
        .collect();
    Road::from_samples(&x, &z, &noisy).unwrap();
}

/// A plank with ramps of 10 mm, by its corners: no sampling has made these, so none can be too coarse.
#[test]
fn a_cleat_may_be_given_by_its_corners() {
    let corners = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.01, 0.02],
        [2.05, 0.02],
        [2.06, 0.0],
        [30.0, 0.0],
    ];
    let [x, z] = [0, 1].map(|axis| corners.map(|corner| corner[axis]).to_vec());
    let slope = [0.0, 2.0, 0.0, -2.0, 0.0, 0.0];
    let road = Road::from_samples(&x, &z, &slope).unwrap();
    assert_eq!(road.vertices(), corners);
    // The same heights at even distances are samples, and too few of them.
    let x: Vec<f64> = (0..6).map(|i| 0.01 * f64::from(i)).collect();
    let sampled = Road::from_samples(&x, &z, &slope);
    assert!(matches!(sampled, Err(RoadError::Rough { .. })), "{sampled:?}");
}
