use lunula::photo::outline::detect::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    for f in &a[1..] {
        let im = image::open(f).unwrap();
        let t = std::time::Instant::now();
        let r = debug_detect(&im);
        let dt = t.elapsed().as_secs_f64() * 1e3;
        println!("F {f} {dt:.1}");
        for d in r { print!("{:.3} {:.1}", d.confidence, d.axis.clockwise_deg()); for p in d.outline.points() { print!(" {:.2} {:.2}", p[0], p[1]); } println!(); }
    }
}
