use dolomite_fbx::check::*;
use dolomite_fbx::*;
use std::time::Instant;
fn main() {
    let mut args: Vec<String> = std::env::args().skip(1).collect();
    let out = if args[0]=="--out" { args.remove(0); Some(args.remove(0)) } else { None };
    for path in args {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.rsplit('/').next().unwrap().to_owned();
        let origin = Origin { name: name.clone(), folder: std::path::Path::new(&path).parent().map(|p| p.to_owned()) };
        let t = Instant::now();
        let loaded = Truth::load(&bytes, &origin);
        let mut load_ms = t.elapsed().as_secs_f64() * 1e3;
        let n: usize = std::env::var("N").map_or(1, |n| n.parse().unwrap());
        for _ in 1..n { let t = Instant::now(); let _ = Truth::load(&bytes, &origin); load_ms = load_ms.min(t.elapsed().as_secs_f64() * 1e3); }
        let mut opts = Options::default();
        if let Ok(x) = std::env::var("MAXREL") { opts.max_relative_error = x.parse().unwrap(); }
        if let Ok(x) = std::env::var("MAXERR") { opts.max_error = x.parse().unwrap(); }
        if let Ok(x) = std::env::var("THREADS") { opts.threads = x.parse().unwrap(); }
        let began = Instant::now(); let last = std::sync::Mutex::new(("start", 0.0f64));
        let tell = |p: Progress| { let mut l = last.lock().unwrap(); let now = began.elapsed().as_secs_f64()*1e3; if l.0 != p.stage { eprintln!("   {} {:.2}", l.0, now - l.1); *l = (p.stage, now); } };
        if std::env::var("STAGES").is_ok() { opts.progress = Some(&tell); }
        opts.within_frames = std::env::var("WITHIN").is_ok();
        let t = Instant::now();
        let c = match convert(&bytes, &origin, &opts) { Ok(c) => c, Err(e) => { println!("{name}: {e}"); continue } };
        let glb = c.to_glb().unwrap();
        let mut ms = t.elapsed().as_secs_f64() * 1e3;
        for _ in 1..n { let t = Instant::now(); let _ = convert(&bytes, &origin, &opts).unwrap().to_glb(); ms = ms.min(t.elapsed().as_secs_f64() * 1e3); }
        if let Some(out) = &out { std::fs::write(format!("{out}/{name}.glb"), &glb).unwrap(); }
        let truth = loaded.unwrap();
        let space = truth.space();
        let played = Played::read(&glb).unwrap();
        let sources = c.sources();
        if let Ok(w) = std::env::var("CH") { for ch in &c.model.clips[0].channels { if c.model.nodes[ch.node].name == w { println!("{:?} {:?} short {} times {:?}", ch.property, ch.interpolation, ch.short, ch.times); println!("{:?}", ch.values); } } }
        if let Ok(w) = std::env::var("TR") { for k in 0..20 { let t = 0.65 + 0.005 * k as f64; let (_, tp) = truth.at(Some(0), c.model.clips[0].begin + t).unwrap(); let (_, pp) = played.at(Some(0), t); println!("{t:.4} truth {:?} played {:?}", space.to_gltf(tp[&w]), pp.iter().find(|p| p.0 == w).unwrap().1); } }
        let mut worst = 0.0f64; let mut nodes_worst = 0.0f64;
        let (shapes, _) = played.at(None, 0.0);
        let (bodies, _) = truth.at(None, 0.0).unwrap();
        let rest = vertex_error(&shapes, &bodies, &space, &sources);
        for (i, clip) in c.model.clips.iter().enumerate() {
            let n = 60;
            for k in 0..=n {
                let t = clip.duration * k as f64 / n as f64 ;
                let (shapes, places) = played.at(Some(i), t);
                let (bodies, truth_places) = truth.at(Some(i), clip.begin + t).unwrap();
                worst = worst.max(vertex_error(&shapes, &bodies, &space, &sources));
                for (n, p) in &places { if c.model.nodes.iter().any(|m| m.skin.is_some() && m.name == *n) { continue } if let Some(q) = truth_places.get(n) { if places.iter().filter(|(m,_)| m==n).count()==1 { let d = p.distance(space.to_gltf(*q)); if d > nodes_worst && std::env::var("V").is_ok() { println!("  {n} clip {i} t {t} of {} d {d}", clip.duration); } nodes_worst = nodes_worst.max(d); } } }
            }
        }
        let r = &c.report;
        println!("{name}: load {load_ms:.2} conv {ms:.2} ({:.1}x) size {:.3} bound {:.1e} est {:.1e} | rest {rest:.1e} clips {} worst {worst:.2e} nodes {nodes_worst:.1e} rel {:.1e} | keys {}/{} animbytes {} glb {} v {} j {} refit {} {:.1e}/{:.1e} lost {:?}",
            ms/load_ms, r.size, r.bound, r.clips.iter().map(|c| c.error).fold(0.0,f64::max), r.clips.len(), worst/r.size, r.keys(), r.baked(), r.animation_bytes, glb.len(), r.vertices, r.joints, r.refitted, r.weight_error, r.largest_weights_error, r.lost.iter().map(|l| (l.what, l.metres)).collect::<Vec<_>>());
    }
}
