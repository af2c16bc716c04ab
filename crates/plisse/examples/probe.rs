use plisse::{field::*, linalg::newton::Convexity, material::Material, mesh::*, progress::*, rest::RestMetric};
fn read(p: &str) -> (Vec<Vec3>, Vec<[usize; 3]>) {
    let t = std::fs::read_to_string(p).unwrap();
    let mut v = vec![];
    let mut f = vec![];
    for l in t.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        if w.is_empty() {
            continue;
        }
        if w[0] == "v" {
            v.push(Vec3::new(w[1].parse().unwrap(), w[2].parse().unwrap(), w[3].parse().unwrap()));
        }
        if w[0] == "f" {
            let g = |s: &str| s.split('/').next().unwrap().parse::<usize>().unwrap() - 1;
            f.push([g(w[1]), g(w[2]), g(w[3])]);
        }
    }
    (v, f)
}
struct Print(bool);
impl Observer for Print {
    fn step(&self, s: &Step) {
        if self.0 {
            eprintln!("{:4} E {:.10e} r {:.2e}", s.iteration, s.energy_joule, s.residual);
        }
    }
}
fn main() {
    let dir = "/work/shared/data/";
    let verbose = std::env::args().nth(1).as_deref() == Some("-v");
    for (name, clamp) in [("tfw-disk", false), ("cylinder-688", true)] {
        let (rp, rf) = read(&format!("{dir}{name}/rest.obj"));
        let (pp, pf) = read(&format!("{dir}{name}/pose.obj"));
        let topo = Topology::new(name, pp.len(), pf).unwrap();
        let rest = RestMetric::from_shape(name, &rp, &rf).unwrap();
        let mut held = vec![false; pp.len()];
        if clamp {
            for l in std::fs::read_to_string(format!("{dir}{name}/clamp.dat")).unwrap().lines().skip(2) {
                held[l.split_whitespace().next().unwrap().parse::<usize>().unwrap()] = true;
            }
        }
        let m = Material::new(1e7, 0.44, 1e-4).unwrap();
        {
            let st = plisse::strain::strain(&topo, &rest, &pp);
            let both = st.iter().filter(|s| s.principal[1] < 0.0).count();
            let mixed = st.iter().filter(|s| s.is_mixed()).count();
            println!("pure compression {both} mixed {mixed} of {}", st.len());
            if !clamp {
                for (f, face) in topo.faces.iter().enumerate() {
                    let c = (pp[face[0]] + pp[face[1]] + pp[face[2]]) / 3.0;
                    if f % 12 == 0 {
                        println!("r {:.4} strain {:?}", c.x.hypot(c.y), st[f].principal);
                    }
                }
            }
        }
        for convexity in [Convexity::Clamped] {
            for rings in [1, 2, 3, 4, 5, 6] {
                let o = FieldOptions {
                    rule: if clamp { WrinkleFreeRule::Published } else { WrinkleFreeRule::Published },
                    convexity,
                    curvature_rings: rings,
                    first_wavelength_factor: 0.5,
                    ..Default::default()
                };
                let mut best = f64::MAX;
                let mut out = None;
                for _ in 0..3 {
                    let t = std::time::Instant::now();
                    out = Some(solve(&topo, &rest, &pp, &held, &m, &o, &Print(verbose)).unwrap());
                    best = best.min(t.elapsed().as_secs_f64());
                }
                let Solved { field, report } = out.unwrap();
                let max = field.amplitude_m.iter().copied().fold(0.0, f64::max);
                let mean = field.amplitude_m.iter().sum::<f64>() / field.amplitude_m.len() as f64;
                println!(
                    "{name} {convexity:?} {rings}: E {:.9e} max {:.6e} mean {:.6e} it {} {:?} pg {:.1e} per {:?} s {:.4} free {} wf {:.6e}",
                    report.energy_joule,
                    max,
                    mean,
                    report.iterations,
                    report.ending,
                    report.projected_gradient,
                    report.periods.iter().map(|p| (p.turns, p.before_rounding)).collect::<Vec<_>>(),
                    best,
                    field.wrinkle_free.iter().filter(|f| **f).count(),
                    report.wrinkle_free_energy_joule
                );
                if !clamp {
                    let a: Vec<f64> = std::fs::read_to_string(format!("{dir}{name}/amplitude.txt"))
                        .unwrap()
                        .split_whitespace()
                        .map(|s| s.parse().unwrap())
                        .collect();
                    let d: f64 = a.iter().zip(&field.amplitude_m).map(|(x, y)| (x - y).powi(2)).sum();
                    let n: f64 = a.iter().map(|x| x * x).sum();
                    println!("   rms rel {:.4}", (d / n).sqrt());
                    let mut rows: Vec<(f64, f64, f64)> =
                        (0..pp.len()).map(|v| (pp[v].x.hypot(pp[v].y), field.amplitude_m[v], a[v])).collect();
                    rows.sort_by(|x, y| x.0.total_cmp(&y.0));
                    for c in rows.chunks(13) {
                        let m = |k: fn(&(f64, f64, f64)) -> f64| c.iter().map(k).sum::<f64>() / c.len() as f64;
                        eprintln!(
                            "  r {:.4} ours {:.4e} pub {:.4e} ratio {:.3}",
                            m(|x| x.0),
                            m(|x| x.1),
                            m(|x| x.2),
                            m(|x| x.1) / m(|x| x.2)
                        );
                    }
                }
            }
        }
    }
}
