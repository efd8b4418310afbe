//! The formats that the reference firmware's page documents.

use super::*;
use crate::wire::{Frame, WIRE_BYTES};

const PAGE: &str = include_str!("../../../../../examples/firmware/nail8/README.md");
const SKETCH: &str = include_str!("../../../../../examples/firmware/nail8/nail8.ino");

/// What the page's bytes hold.
fn decoded(bytes: &[u8], query: &str) -> Seen {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bytes");
    std::fs::write(&path, bytes).unwrap();
    let mut reader = Reader::open(&format!("{}?{query}", path.display()));
    reader.run(|_| false).unwrap();
    assert_eq!((reader.log.rows.len(), reader.log.spoilt), (1, 0), "{:?}", reader.log);
    reader.log.rows.remove(0)
}

#[test]
fn the_documented_line_and_frame_hold_the_documented_sample() {
    let lines: Vec<&str> = PAGE.lines().filter(|line| line.starts_with('$')).collect();
    assert_eq!(lines.len(), 2);
    let counts = [512.0, 498.0, 0.0, 1023.0, 777.0, 640.0, 333.0, 250.0];
    let line = decoded(format!("{}\r\n{}\r\n", lines[0], lines[1]).as_bytes(), "form=lines");
    assert_eq!((line.time_s, line.values.as_slice()), (1.234_567, &counts[..]));

    let hex = |word: &str| -> Vec<u8> {
        let line = PAGE.lines().find_map(|line| line.strip_prefix(word)).unwrap();
        line.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
    };
    let frame = Frame { photodiodes: counts.map(|count| count as u16), time_us: 1_234_567, counter: 42, lit: true };
    let shown = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ");
    let mut plain = [0; WIRE_BYTES];
    let length = cobs::decode(&frame.encoded(), &mut plain).unwrap().frame_size();
    assert_eq!(shown(&hex("frame")), shown(&plain[..length]));
    assert_eq!(shown(&hex("wire")), shown(&frame.encoded()));
    assert_eq!(decoded(&hex("wire"), "form=frames").values, counts);
    assert!(SKETCH.contains("time_us,n,led,P1,P2,P3,P4,P5,P6,P7,P8") && SKETCH.contains("UNTESTED ON HARDWARE"));
}
