use qcar_runtime::campaign::*;
use qcar_runtime::response::parameters::Values;
use qcar_runtime::road::Road as R;
use qcar_runtime::simulate::*;
use qcar_runtime::tyre::*;
use std::collections::BTreeMap;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let folder = std::path::PathBuf::from(&args[1]);
    let c = Campaign::open(&folder).unwrap();
    let truth = Truth::read(&folder.join("truth.toml")).unwrap();
    let m = models::find(&c.model).unwrap().model;
    let about = m.about();
    let given: BTreeMap<String, f64> = truth.parameters.iter().cloned().collect();
    let vehicle: BTreeMap<String, f64> = c.vehicle.iter().cloned().collect();
    let values = Values::resolve(about, &given, &vehicle).unwrap();
    let g = c.vehicle("gravity").unwrap();
    let rates = if args.iter().any(|a| a == "moment") {
        Rates::AtDeflection
    } else {
        Rates::AtStaticDeflection
    };
    let tyre = Tyre::new(
        c.vehicle("r_tire").unwrap(),
        c.vehicle("static_tire_def").unwrap(),
        Geometry::Area,
        rates,
    )
    .unwrap();
    let car = Car {
        model: m,
        parameters: values.as_slice(),
        tyre,
        gravity: g,
        variant: Variant::Complete,
    };
    println!(
        "load m g {} stated {}",
        c.vehicle("m_corner").unwrap() * g,
        c.vehicle("static_tire_load").unwrap()
    );
    let mut all: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for run in &c.runs {
        let Test::Cleat {
            speed,
            sample_rate,
            cleat,
        } = &run.test
        else {
            continue;
        };
        let h = c.history(run).unwrap();
        let rf = c.roads.iter().find(|r| &r.name == cleat).unwrap();
        let s = c.road(rf).unwrap();
        let road = R::from_samples(&s.x, &s.z, &s.slope).unwrap();
        let d = Drive {
            road: &road,
            speed: *speed,
            sample_rate: *sample_rate,
            samples: h.len(),
        };
        let t0 = std::time::Instant::now();
        let ride = ride(&car, &d, &Settings::default()).unwrap();
        println!(
            "{} {:?} {:?} def {} traction {} lift {:?} t_end_x {}",
            run.file,
            t0.elapsed(),
            ride.effort,
            ride.static_deflection,
            ride.traction,
            ride.lift_offs,
            ride.time.last().unwrap()
        );
        let peak = |v: &[f64]| {
            v.iter()
                .enumerate()
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
                .map(|(i, v)| (i, *v))
                .unwrap()
        };
        let wheel_m = h.signal("wheel_left_z").unwrap();
        let out = |loc: &str, axis: &str| {
            about
                .outputs
                .iter()
                .position(|o| o.signal.location == loc && o.signal.axis == axis)
                .map(|i| ride.outputs[i].clone())
        };
        let wheel_s = out("wheel", "z").unwrap();
        let (im, _) = peak(wheel_m);
        let (is, _) = peak(&wheel_s);
        // impact: first 100 ms from first touch in each
        for (ch, v) in &h.signals {
            let ax = if ch.axis == Axis::Z { "z" } else { "x" };
            let Some(sim) = out(&ch.location, ax) else { continue };
            let (ipm, pm) = peak(v);
            let (ips, ps) = peak(&sim);
            let rms = |v: &[f64], i0: usize| {
                let w = &v[(i0 + 100).min(v.len())..(i0 + 600).min(v.len())];
                (w.iter().map(|x| x * x).sum::<f64>() / w.len() as f64).sqrt()
            };
            let (rm, rs) = (rms(v, im), rms(&sim, is));
            // trace difference with measured alignment
            let mut best = (0i64, f64::MAX);
            for lag in -6..=6i64 {
                let mut e = 0.0;
                for i in 10..v.len() as i64 - 10 {
                    let a = v[i as usize];
                    let b = sim[(i + lag) as usize];
                    e += (a - b) * (a - b);
                }
                if e < best.1 {
                    best = (lag, e);
                }
            }
            let nn = v.iter().map(|x| x * x).sum::<f64>();
            println!(
                "   {:14} peak m {:8.3}@{} s {:8.3}@{} err {:6.2}%  rms m {:.4} s {:.4} err {:6.2}%  trace {:.2}% lag {}",
                ch.name,
                pm,
                ipm,
                ps,
                ips,
                100. * (ps.abs() / pm.abs() - 1.),
                rm,
                rs,
                100. * (rs / rm - 1.),
                100. * (best.1 / nn).sqrt(),
                best.0
            );
            all.entry(ch.name.clone())
                .or_default()
                .push((100. * (ps.abs() / pm.abs() - 1.), 100. * (rs / rm - 1.)));
        }
        if args.iter().any(|a| run.file.contains(a.as_str()) && a != "moment") && args.len() > 2 {
            let names = ["wheel", "body"];
            for i in 0..h.len() {
                print!("T {:.3}", ride.time[i]);
                for n in names {
                    for ax in ["z", "x"] {
                        let m = h
                            .signals
                            .iter()
                            .find(|(ch, _)| ch.location == n && (ch.axis == Axis::Z) == (ax == "z"))
                            .unwrap()
                            .1[i];
                        print!(" {:.2} {:.2}", m, out(n, ax).unwrap()[i]);
                    }
                }
                println!(
                    " F {:.0} {:.0} A {:.5}",
                    ride.force[0][i], ride.force[1][i], ride.area[i]
                );
            }
        }
    }
    for (k, v) in all {
        let med = |f: &dyn Fn(&(f64, f64)) -> f64| {
            let mut w: Vec<f64> = v.iter().map(|x| f(x).abs()).collect();
            w.sort_by(f64::total_cmp);
            ((w[5] + w[6]) / 2., *w.last().unwrap())
        };
        let (a, b) = (med(&|x| x.0), med(&|x| x.1));
        println!(
            "{k:14} peak median {:.2} worst {:.2} rms median {:.2} worst {:.2}",
            a.0, a.1, b.0, b.1
        );
    }
}
