use super::training::*;
use super::*;
use std::path::Path;

const WORKING_PX: u32 = 1100;
const FOLLOWED: usize = 16;
fn candidates(levels: &Levels) -> Vec<Candidate> { follow_all(levels, leads(levels), FOLLOWED) }

fn median(mut v: Vec<f64>) -> f64 { v.sort_by(f64::total_cmp); if v.is_empty() { f64::NAN } else { v[v.len() / 2] } }

#[test]
#[ignore]
fn stages() {
    for (name, all) in sets(60) {
        let (mut best_tip, mut best_any, mut pick, mut dir) = (vec![], vec![], vec![], vec![]);
        let t = std::time::Instant::now();
        for s in &all {
            let c = candidates(&Levels::of(&s.image, WORKING_PX));
            for t in &s.truths {
                let of = |tip: bool| c.iter().filter(|c| (c.figures[14] > 0.5) == tip).map(|c| c.outline.iou(&t.outline)).fold(0.0, f64::max);
                best_tip.push(of(true));
                best_any.push(of(false));
                if let Some(p) = c.iter().filter(|c| c.outline.iou(&t.outline) > 0.3).max_by(|a, b| a.figures[0].total_cmp(&b.figures[0])) {
                    pick.push(p.outline.iou(&t.outline));
                    if let Some(up) = t.up { let d = p.axis.distal(); dir.push((d[0] * up[0] + d[1] * up[1]).clamp(-1.0, 1.0).acos().to_degrees()); }
                } else { pick.push(0.0); }
            }
        }
        let share = |v: &[f64], x: f64| v.iter().filter(|i| **i >= x).count() as f64 / v.len() as f64;
        let row = |n: &str, v: &[f64]| eprintln!("  {n:8} n {} median {:.3} >=.7 {:.2} >=.8 {:.2} >=.9 {:.2} >=.95 {:.2}", v.len(), median(v.to_vec()), share(v, 0.7), share(v, 0.8), share(v, 0.9), share(v, 0.95));
        eprintln!("{name}: {:.1} ms a picture", t.elapsed().as_secs_f64() * 1e3 / all.len() as f64);
        row("tips", &best_tip); row("any", &best_any); row("pick", &pick);
        eprintln!("  axis error median {:.1}, flipped {:.2}", median(dir.clone()), 1.0 - share(&dir.iter().map(|d| -d).collect::<Vec<_>>(), -90.0));
    }
}

fn sets(n: u32) -> Vec<(&'static str, Vec<Scene>)> {
    let folder = std::env::var("LUNULA_HANDS").unwrap();
    let which = std::env::var("SETS").unwrap_or("phantom even crops".into());
    let mut out = vec![];
    if which.contains("phantom") { out.push(("phantom", (0..n).map(|k| phantom(555, k)).collect())); }
    if which.contains("even") { out.push(("even", hands(Path::new(&folder), 0, false))); }
    if which.contains("odd") { out.push(("odd", hands(Path::new(&folder), 1, false))); }
    if which.contains("crops") { out.push(("crops", crops(&folder, 0))); }
    if which.contains("crodd") { out.push(("crops odd", crops(&folder, 1))); }
    if which.contains("empty") { out.push(("empty", (0..n).map(|k| empty(555, k)).collect())); }
    for (_, v) in &mut out { v.iter_mut().for_each(direct); }
    out
}

/// Real nails as close-ups: turned distal end up, 2.5 nails wide.
fn crops(folder: &str, odd: usize) -> Vec<Scene> {
    let mut out = vec![];
    for mut s in hands(Path::new(folder), odd, false) {
        direct(&mut s);
        let rgb = s.image.to_rgb8();
        for t in &s.truths {
            let Some(up) = t.up else { continue };
            let pts = t.outline.points();
            let n = pts.len() as f64;
            let c = [0, 1].map(|i| pts.iter().map(|p| p[i]).sum::<f64>() / n);
            let size = t.outline.area_px2().sqrt() * 2.3;
            if size < 60.0 { continue; }
            let frame = patch::Frame { origin: c, up, unit_px: size };
            let side = 240.0;
            let crop = image::RgbImage::from_fn(side as u32, side as u32, |x, y| {
                let q = frame.to_source([(f64::from(x) - 119.5) / side, -(f64::from(y) - 119.5) / side]);
                let (x, y) = (q[0].clamp(0.0, f64::from(rgb.width() - 1)), q[1].clamp(0.0, f64::from(rgb.height() - 1)));
                let (i, j) = (x as u32, y as u32);
                let (fx, fy) = (x - f64::from(i), y - f64::from(j));
                let g = |a: u32, b: u32| rgb.get_pixel(a.min(rgb.width() - 1), b.min(rgb.height() - 1)).0.map(f64::from);
                let (p, q, r, w) = (g(i, j), g(i + 1, j), g(i, j + 1), g(i + 1, j + 1));
                image::Rgb(std::array::from_fn(|k| ((p[k] * (1.0 - fx) + q[k] * fx) * (1.0 - fy) + (r[k] * (1.0 - fx) + w[k] * fx) * fy) as u8))
            });
            let own: Vec<_> = pts.iter().map(|p| { let q = frame.from_source(*p); [q[0] * side + 119.5, -q[1] * side + 119.5] }).collect();
            out.push(Scene { image: crop.into(), truths: vec![Truth { outline: Outline::new(&own).unwrap(), up: Some([0.0, -1.0]) }], real: true });
        }
    }
    out
}
use crate::photo::outline::Outline;

#[test]
#[ignore]
fn judged_() {
    let mut levels = vec![];
    for (name, all) in sets(std::env::var("COUNT").ok().and_then(|c| c.parse().ok()).unwrap_or(60)) {
        let t = std::time::Instant::now();
        let mut hits = vec![]; // confidence, iou
        let mut top = vec![];
        let mut axis = vec![];
        for s in &all {
            let found = different(candidates(&Levels::of(&s.image, WORKING_PX)));
            for (k, d) in found.iter().enumerate() {
                let best = s.truths.iter().max_by(|a, b| a.outline.iou(&d.outline).total_cmp(&b.outline.iou(&d.outline)));
                let iou = best.map_or(0.0, |t| t.outline.iou(&d.outline));
                hits.push((d.confidence, iou));
                if k == 0 { top.push((d.confidence, iou)); if let Some(up) = best.and_then(|b| b.up) { if iou > 0.5 { let v = d.axis.distal(); axis.push((v[0]*up[0]+v[1]*up[1]).clamp(-1.0,1.0).acos().to_degrees()); } } }
            }
        }
        let truths: usize = all.iter().map(|s| s.truths.len()).sum();
        eprintln!("{name}: {} pictures {truths} nails {:.1} ms; axis median {:.1} p90 {:.1} max {:.1}", all.len(), t.elapsed().as_secs_f64() * 1e3 / all.len() as f64, median(axis.clone()), {axis.sort_by(f64::total_cmp); axis.get(axis.len()*9/10).copied().unwrap_or(f64::NAN)}, axis.last().copied().unwrap_or(f64::NAN));
        if all.iter().all(|s| s.truths.len() == 1) { eprintln!("  top: median IoU {:.3}, conf>=.5: {}", median(top.iter().map(|t| t.1).collect()), top.iter().filter(|t| t.0 >= 0.5).count()); }
        for level in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
            let n = hits.iter().filter(|h| h.0 >= level).count();
            let at = |x: f64| hits.iter().filter(|h| h.0 >= level && h.1 >= x).count();
            let worst = hits.iter().filter(|h| h.0 >= level).map(|h| h.1).fold(1.0, f64::min);
            eprintln!("  conf>={level}: {n} found, IoU>=.7 {} (precision {:.3} recall {:.3}), >=.8 {} ({:.3}), median {:.3} worst {worst:.2}", at(0.7), at(0.7) as f64 / n as f64, at(0.7) as f64 / truths as f64, at(0.8), at(0.8) as f64 / n as f64, median(hits.iter().filter(|h| h.0 >= level).map(|h| h.1).collect()));
        }
        levels.extend(hits);
    }
    eprintln!("calibration:");
    for b in 0..10 { let v: Vec<_> = levels.iter().filter(|h| (h.0 * 10.0) as usize == b).collect(); eprintln!("  {:.1}: {} of {} IoU>=.8", b as f64 / 10.0, v.iter().filter(|h| h.1 >= 0.8).count(), v.len()); }
}

#[test]
#[ignore]
fn timing() {
    let mut s = phantom(555, 3);
    for k in 0..60 { let t = phantom(555, k); if t.image.width() == 640 { s = t; if k > 10 { break; } } }
    for image in [s.image.clone(), { let h = hands(Path::new(&std::env::var("LUNULA_HANDS").unwrap()), 0, false); h[9].image.clone() }] {
        for _ in 0..2 {
            let mut marks = vec![];
            let t = std::time::Instant::now();
            let mut last = 0.0;
            let mut mark = |n: &'static str| { let now = t.elapsed().as_secs_f64() * 1e3; marks.push((n, now - last)); last = now; };
            let levels = Levels::of(&image, WORKING_PX);
            mark("levels");
            let picture = levels.within(SEARCH_PX);
            let masks = silhouette::silhouettes(picture);
            mark("masks");
            let ends: Vec<_> = masks.iter().flat_map(tips::tips).collect();
            mark("tips");
            let n = ends.len();
            let tips = tips::strongest(ends, ENDS);
            mark("strongest");
            let frames: Vec<Frame> = tips.iter().map(|tip| Frame { origin: picture.to_source(tip.apex), up: tip.out, unit_px: tip.width * picture.step }).collect();
            let patches: Vec<_> = frames.iter().map(|f| Patch::cut(&levels, *f, search::FINGER)).collect();
            mark("cut");
            let best: Vec<_> = patches.iter().map(|p| search::on_finger(p, 2)).collect();
            mark("on_finger");
            let h = best.iter().flatten().filter(|s| s.1 > HOPE).count();
            search::anywhere(&levels, 5);
            mark("anywhere");
            let l = leads(&levels);
            mark("all leads");
            let m = l.len();
            let c = follow_all(&levels, l, FOLLOWED);
            mark("follow");
            eprintln!("{h} climbed, {m} leads, {} candidates", c.len());
            eprintln!("{}x{} {n} ends, {} tips: {marks:.1?}", image.width(), image.height(), tips.len());
        }
    }
}

#[test]
#[ignore]
fn draw() {
    let mut tiles = vec![];
    let scenes: Vec<Scene> = if std::env::var("SETS").is_ok_and(|s| s == "crops") { crops(&std::env::var("LUNULA_HANDS").unwrap(), 0) } else { (0..90).map(|k| phantom(555, k)).collect() };
    for (k, s) in scenes.into_iter().enumerate() {
        let k = k as u32;
        let found = different(candidates(&Levels::of(&s.image, WORKING_PX)));
        let top = found.first();
        let iou = top.map_or(0.0, |d| d.outline.iou(&s.truths[0].outline));
        if top.is_some_and(|d| d.confidence > 0.7) && std::env::var("ALL").is_err() { continue; }
        let levels = Levels::of(&s.image, WORKING_PX);
        let oracle = candidates(&levels).iter().map(|c| c.outline.iou(&s.truths[0].outline)).fold(0.0, f64::max);
        let lead = leads(&levels).iter().map(|l| { let p: Vec<_> = (0..48).map(|i| { let [u, v] = l.template.rim(f64::from(i) / 48.0 * 6.2832); l.nail.to_source(l.template.point(u, v)) }).collect(); super::super::Outline::new(&p).unwrap().iou(&s.truths[0].outline) }).fold(0.0, f64::max);
        eprintln!("{k}: conf {:.2} IoU {iou:.2}, best candidate {oracle:.2}, best lead {lead:.2} {}", top.map_or(0.0, |d| d.confidence), if s.image.color().has_color() { "colour" } else { "grey" });
        let mut rgb = s.image.to_rgb8();
        let mut line = |o: &super::super::Outline, c: [u8; 3]| { let p = o.points(); for i in 0..p.len() { let (a, b) = (p[i], p[(i + 1) % p.len()]); imageproc::drawing::draw_line_segment_mut(&mut rgb, (a[0] as f32, a[1] as f32), (b[0] as f32, b[1] as f32), image::Rgb(c)); } };
        line(&s.truths[0].outline, [0, 255, 0]);
        if let Some(d) = top { line(&d.outline, [255, 0, 0]); }
        let mut tile = image::RgbImage::new(240, 240);
        let r = DynamicImage::ImageRgb8(rgb).resize(240, 240, image::imageops::FilterType::Triangle).to_rgb8();
        image::imageops::replace(&mut tile, &r, 0, 0);
        tiles.push(tile);
        if tiles.len() == 30 { break; }
    }
    let mut sheet = image::RgbImage::new(240 * 6, 240 * (tiles.len() as u32).div_ceil(6));
    for (i, t) in tiles.iter().enumerate() { image::imageops::replace(&mut sheet, t, 240 * (i as i64 % 6), 240 * (i as i64 / 6)); }
    sheet.save(std::env::var("SHEET").unwrap()).unwrap();
}
