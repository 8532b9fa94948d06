use bevy::math::*;
use dolomite_terrain::*;
use dolomite_tessellation::detail::*;
use std::time::Instant;
fn hashf(k: u32, salt: u32) -> f32 {
    let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    (h ^ (h >> 16)) as f32 / u32::MAX as f32
}
fn perspective(anchor: IVec2, eye: Vec3, rotation: Quat, fov: f32, near: f32, w: f32, h: f32) -> DetailView {
    let aspect = w / h;
    let tan = (fov / 2.0).tan();
    let clip = Mat4::perspective_infinite_reverse_rh(fov, aspect, near) * Mat4::from_rotation_translation(rotation, eye).inverse();
    let row = |k| clip.row(k);
    let planes = [row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1), row(3) - row(2), Vec4::W];
    let mut v: DetailView = bytemuck::Zeroable::zeroed();
    v.planes = planes.map(|p| p.to_array());
    v.eye = eye.to_array();
    v.scale = h / 2.0 / tan;
    v.right = (rotation * Vec3::X).to_array();
    v.up = (rotation * Vec3::Y).to_array();
    v.forward = (rotation * Vec3::NEG_Z).to_array();
    v.near = near;
    v.cos_corner = 1.0 / (1.0 + tan * tan * (1.0 + aspect * aspect)).sqrt();
    v.anchor = anchor.to_array();
    v
}
fn main() {
    let which: Vec<String> = std::env::args().collect();
    let layers = if which[1] == "fbm" {
        vec![Layer { source: Source::Fractal(Fractal { octaves: 14, amplitude: 900.0, wavelength: 4000.0, ..Default::default() }), mask: None }]
    } else {
        let f = |sum, seed, octaves, gain, amplitude, wavelength, erosion, warp| Source::Fractal(Fractal { sum, seed, octaves, gain, amplitude, wavelength, erosion, warp, ..Default::default() });
        let warp = |strength, wavelength, octaves, seed| Some(Warp { strength, wavelength, octaves, seed });
        let mask = |low, high| Some(Mask { low, high });
        vec![
            Layer { source: Source::Hill(Hill { centre: DVec2::ZERO, radius: 8000.0, height: 340.0 }), mask: None },
            Layer { source: f(dolomite_terrain::Sum::Fbm, 11, 7, 0.5, 180.0, 3300.0, 1.0, None), mask: mask(-80.0, 0.0) },
            Layer { source: Source::Hill(Hill { centre: DVec2::new(800.0, -1200.0), radius: 3400.0, height: 330.0 }), mask: None },
            Layer { source: f(dolomite_terrain::Sum::Billow, 12, 10, 0.42, -430.0, 1450.0, 1.0, warp(330.0, 1500.0, 3, 23)), mask: mask(-10.0, 420.0) },
            Layer { source: f(dolomite_terrain::Sum::Ridged, 5, 9, 0.5, 440.0, 1150.0, 1.0, warp(200.0, 900.0, 2, 3)), mask: mask(250.0, 1500.0) },
            Layer { source: f(dolomite_terrain::Sum::Eroded, 31, 12, 0.48, 90.0, 600.0, 1.5, warp(60.0, 400.0, 2, 29)), mask: mask(20.0, 300.0) },
            Layer { source: f(dolomite_terrain::Sum::Fbm, 47, 7, 0.5, 2.2, 38.0, 1.0, None), mask: mask(4.0, 60.0) },
        ]
    };
    let sea = if which[1] == "fbm" { None } else { Some(0.0) };
    let terrain = Terrain::new(TerrainData { extent: GroundRect::square(DVec2::ZERO, 16384.0), layers, base: if sea.is_some() { -80.0 } else { 0.0 }, sea_level: sea }).unwrap();
    let tau: f32 = which[2].parse().unwrap();
    let count: u32 = which[3].parse().unwrap();
    let samples: u32 = which[4].parse().unwrap();
    for k in 0..count {
        let mut cells = DetailCells::new(terrain.clone(), 0.125);
        let mut xz = Vec2::new(hashf(k, 1) - 0.5, hashf(k, 2) - 0.5) * 9000.0;
        if sea.is_some() { let mut t = 100; while terrain.sample_f64(xz.as_dvec2()).height < 2.0 { xz = Vec2::new(hashf(k, t) - 0.5, hashf(k, t + 1) - 0.5) * 9000.0; t += 2; } }
        let above = [1.7, 20.0, 200.0, 0.3, 1500.0][k as usize % 5];
        let ground = (terrain.sample_f64(xz.as_dvec2()).height as f32).max(sea.unwrap_or(-1e30));
        let anchor = xz.floor().as_ivec2();
        let rel = xz - anchor.as_vec2();
        let eye = Vec3::new(rel.x, ground + above, rel.y);
        let pitch = [-0.05, -0.1, -0.3, 0.0, -0.8][k as usize % 5];
        let rot = Quat::from_euler(EulerRot::YXZ, hashf(k, 3) * 6.28, pitch, 0.0);
        let fov = if which.len() > 5 { which[5].parse::<f32>().unwrap().to_radians() } else { 1.047 };
        let mut view = perspective(anchor, eye, rot, fov, 0.1, 1920.0, 1080.0);
        view.set_metric(&Detail { metric: Metric::ErrorBound { pixels: tau }, ..Default::default() });
        let t = Instant::now();
        let sel = select(&mut cells, &view, 1 << 22);
        let t1 = t.elapsed();
        let t = Instant::now();
        let _ = select(&mut cells, &view, 1 << 22);
        let t2 = t.elapsed();
        let t = Instant::now();
        let m = mesh::mesh(&cells, &sel);
        let t3 = t.elapsed();
        // measured
        let a = GroundPoint { cell: anchor, frac: UVec2::ZERO };
        let mut errs = Vec::new();
        let mut tri_errs = Vec::new();
        let stride = (m.triangles.len() as u32 / (samples / 4 + 1)).max(1);
        let proj = |p: DVec3| { let d = p - eye.as_dvec3(); let w = d.dot(Vec3::from(view.forward).as_dvec3()); (DVec2::new(d.dot(Vec3::from(view.right).as_dvec3()), d.dot(Vec3::from(view.up).as_dvec3())) / w, w) };
        let seen = |p: DVec3| { let (s, w) = proj(p); let tan = (fov as f64 / 2.0).tan(); w > 0.1 && s.y.abs() < tan && s.x.abs() < tan * 1920.0 / 1080.0 };
        let mut i = 0;
        while i < m.triangles.len() as u32 {
            let t = m.triangles[i as usize].map(|k| { let v = m.vertices[k as usize]; let r = v.point.relative_to(a).as_dvec2(); DVec3::new(r.x, v.height as f64, r.y) });
            let mut worst = 0.0f64; let mut any=false;
            for j in 0..4 {
                let (mut u, mut v) = (hashf(i, 10 + j) as f64, hashf(i, 30 + j) as f64);
                if j == 0 { (u, v) = (0.5, 0.5); }
                if u + v > 1.0 { u = 1.0 - u; v = 1.0 - v; }
                let p = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
                let w = DVec2::new(p.x, p.z) + anchor.as_dvec2();
                let h = terrain.sample_f64(w).height.max(sea.unwrap_or(-1e30) as f64);
                let q = DVec3::new(p.x, h, p.z);
                if seen(p) || seen(q) { let (s, w1) = proj(p); let (r, w2) = proj(q); if w1 > 0.1 && w2 > 0.1 { let e = (s - r).length() * view.scale as f64; errs.push(e); worst = worst.max(e);any=true; } }
            }
            if any {tri_errs.push(worst);}
            i += stride;
        }
        errs.sort_by(f64::total_cmp); tri_errs.sort_by(f64::total_cmp);
        let q = |v: &Vec<f64>, f: f64| if v.is_empty() { 0.0 } else { v[((v.len() - 1) as f64 * f) as usize] };
        println!("above {above:6} cells {:7} kept {:6} V {:7} T {:7} make {t1:?} select {t2:?} mesh {t3:?} held {:.2} | err p50 {:.3} p99 {:.3} max {:.3} tri p50 {:.3}", cells.len(), sel.cells().count(), m.vertices.len(), m.triangles.len(), sel.held, q(&errs, 0.5) / tau as f64, q(&errs, 0.99) / tau as f64, q(&errs, 1.0) / tau as f64, q(&tri_errs, 0.5) / tau as f64);
    }
}
