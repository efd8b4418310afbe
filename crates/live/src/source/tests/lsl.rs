//! A stream of the Lab Streaming Layer, out and in.

use super::*;
use crate::source::LslOutlet;

#[test]
fn what_is_sent_comes_back_to_the_bit() {
    let id = format!("lunula-test-{}", std::process::id());
    let labels = ["P1", "P2"].map(str::to_owned);
    let outlet = LslOutlet::new("lunula test", "nail", &id, &labels, Some(1000.0)).unwrap();
    let mut reader = Reader::open(&format!("lsl:source_id={id}"));
    for _ in 0..100 {
        if outlet.has_readers() {
            break;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    for row in 0..500 {
        outlet.push(&[f64::from(row), (f64::from(row) * 0.1).sin()]).unwrap();
        std::thread::sleep(Duration::from_millis(1));
    }
    reader.run(|log| log.rows.len() >= 500).unwrap();
    for (row, seen) in reader.log.rows.iter().enumerate() {
        assert_eq!(seen.values, [row as f64, (row as f64 * 0.1).sin()]);
    }
    assert!(reader.log.rows.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    assert_eq!(reader.stream.names(), ["time_s", "P1", "P2"]);
    let said = refused("lsl:name=nobody");
    assert!(said.contains("is not found") && said.contains("lunula test"), "{said}");
}
