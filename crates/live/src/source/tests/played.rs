//! Recordings played back.

use std::io::Write;
use std::net::TcpListener;

use super::*;
use crate::source::{Pace, Rows, StreamCertificate};

fn file(text: &[u8]) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(text).unwrap();
    file
}

fn csv(rows: usize) -> String {
    let mut text = "time_s,n,P1\n".to_owned();
    for row in 0..rows {
        text.push_str(&format!("{},{row},{}\n", 100.0 + row as f64 * 0.001, row * 2));
    }
    text
}

fn played(address: &str) -> (Stream, Log) {
    let mut reader = Reader::open(address);
    reader.run(|_| false).unwrap();
    assert!(reader.log.ended && reader.log.columns == 1);
    (reader.stream, reader.log)
}

#[test]
fn every_pace_gives_the_same_rows() {
    let file = file(csv(300).as_bytes());
    let path = file.path().display();
    let (stream, fast) = played(&path.to_string());
    assert_eq!(fast.rows.len(), 300);
    assert_eq!((fast.rows[0].time_s, fast.rows[0].begins, fast.rows[1].begins), (100.0, true, false));
    assert_eq!(stream.stream_now_s(u64::MAX), fast.rows[299].time_s);
    assert_eq!(stream.lateness().unwrap().summary(), None);
    for (rate, seconds) in [("1", 0.299), ("3", 0.0997)] {
        let (stream, slow) = played(&format!("{path}?rate={rate}"));
        let time = |log: &Log| -> Vec<Seen> { log.rows.iter().map(|row| Seen { host_ns: 0, ..row.clone() }).collect() };
        assert_eq!(time(&slow), time(&fast));
        // No row is early.
        let first_ns = slow.rows[0].host_ns;
        for row in &slow.rows {
            let due_ns = (row.time_s - 100.0) / rate.parse::<f64>().unwrap() * 1e9;
            assert!((row.host_ns - first_ns) as f64 + 1.0 >= due_ns, "{row:?}");
        }
        assert!((slow.rows[299].host_ns - first_ns) as f64 >= seconds * 1e9);
        assert_eq!(stream.lateness().unwrap().summary().unwrap().count, 300);
    }
}

#[test]
fn a_file_begins_again_where_it_is_looped() {
    let file = file(csv(50).as_bytes());
    let mut reader = Reader::open(&format!("{}?loop", file.path().display()));
    reader.run(|log| log.rows.len() >= 175).unwrap();
    let log = reader.log;
    let begins: Vec<usize> = (0..175).filter(|&row| log.rows[row].begins).collect();
    assert_eq!(begins, [0, 50, 100, 150]);
    for pair in log.rows.windows(2) {
        // A file that begins again goes on after one period.
        assert!((pair[1].time_s - pair[0].time_s - 0.001).abs() <= 1e-9, "{pair:?}");
    }
    assert_eq!((log.columns, log.spoilt), (1, 0));
    assert!(log.rows.iter().all(|row| row.lost == 0));
}

/// The certificate of a stream that nobody wants any more after so many rows.
fn broken_off(mut stream: Stream, clock: &HostClock, most: usize) -> StreamCertificate {
    let mut rows = 0;
    while !stream.ended() {
        wait(&[&stream], &[], None, clock).unwrap();
        let mut on = |event: Event<'_>| {
            rows += usize::from(matches!(event, Event::Row(_)));
            assert!(rows <= most, "{event:?}");
            if rows == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        stream.poll(clock.now_ns(), &mut on).unwrap();
    }
    stream.certificate()
}

#[test]
fn what_lies_behind_the_end_does_not_count() {
    // A gap in time and a spoilt line, in the piece that is read.
    let mut text = "time_s,P1\n".to_owned();
    (0..400)
        .filter(|k| !(200..300).contains(k))
        .for_each(|k| text.push_str(&format!("{}.{:02},1\n", k / 100, k % 100)));
    text.push_str("spoilt\n");
    let file = file(text.as_bytes());
    let address = file.path().display().to_string();
    for (query, most, lost, set_back) in [("", 200, 0, 0), ("", 201, 100, 0), ("?loop", 650, 200, 2)] {
        let Reader { stream, clock, .. } = Reader::open(&format!("{address}{query}"));
        let found = broken_off(stream, &clock, most);
        assert_eq!((found.counts.rows, found.counts.lost_by_time), (most as u64, lost), "{query} {most}");
        assert_eq!((found.counts.set_back, found.spoilt.len()), (set_back, usize::from(set_back > 0)));
    }
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let Reader { stream, clock, .. } = Reader::open(&format!("tcp:{}?once", listener.local_addr().unwrap()));
    listener.accept().unwrap().0.write_all(text.as_bytes()).unwrap();
    let found = broken_off(stream, &clock, 200);
    assert_eq!((found.counts.rows, found.counts.lost_by_time, found.spoilt.len()), (200, 0, 0));
}

#[test]
fn a_row_that_waits_for_its_time_does_not_count_yet() {
    let file = file(b"time_s,P1\n0.00,1\n0.01,1\n0.02,1\n0.03,1\n9000,1\n");
    let mut reader = Reader::open(&format!("{}?rate=1", file.path().display()));
    reader.rows(4);
    reader.stream.poll(reader.clock.now_ns(), &mut |_| ControlFlow::Continue(())).unwrap();
    let counts = reader.stream.certificate().counts;
    assert_eq!((counts.rows, counts.lost_by_time), (4, 0));
}

#[test]
fn what_is_wrong_with_a_file_is_said() {
    let said = |text: &[u8], query: &str| {
        let file = file(text);
        let reader = Reader::with(&format!("{}{query}", file.path().display()), StreamOptions::default());
        reader.and_then(|mut reader| reader.run(|_| false)).unwrap_err().to_string()
    };
    for (text, query, words) in [
        (&b"\x1f\x8b\x08"[..], "", "gunzip"),
        (b"PAR1", "", ".parquet"),
        (b"a\0b", "", "form=frames"),
        (b"", "", "ends before a line of names"),
        (b"1,2\n3,4\n", "", "line 1 holds numbers"),
        (b"P1,P2\n3,4\n", "?loop", "no column of time"),
        (&[7; 5000], "?form=frames", "no whole frame"),
    ] {
        let said = said(text, query);
        assert!(said.contains(words), "{said}");
    }
    let said = refused("no/such.csv");
    assert!(said.contains("no/such.csv: does not exist"), "{said}");
}

struct Made {
    names: Vec<String>,
    row: u32,
}

impl Rows for Made {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn next(&mut self, cells: &mut [f64], _: &mut [Vec<u8>]) -> Result<bool, String> {
        self.row += 1;
        cells.copy_from_slice(&[f64::from(self.row) * 0.5, 1.0, f64::from(self.row)]);
        Ok(self.row <= 10)
    }

    fn rewind(&mut self) -> Result<(), String> {
        self.row = 0;
        Ok(())
    }
}

#[test]
fn rows_that_a_program_makes_are_played_like_a_file() {
    for (looped, rows) in [(false, 10), (true, 25)] {
        let made = Made { names: ["time_s", "led", "P1"].map(str::to_owned).into(), row: 0 };
        let options = StreamOptions::default();
        let pace = (Pace::Max, looped);
        let stream =
            Stream::of_rows("phantom:x".to_owned(), Box::new(made), pace, Some(0.5), &options, Box::new(naming));
        let mut reader = Reader::of(stream, HostClock::start());
        // A call hands out a piece.
        reader.run(|log| log.rows.len() >= rows).unwrap();
        let mut log = reader.log;
        log.rows.truncate(rows);
        let last = &log.rows[rows - 1];
        assert_eq!((log.rows.len(), last.time_s), (rows, rows as f64 * 0.5));
        assert_eq!(log.rows[3].values, [2.0]);
        assert_eq!(log.rows.iter().filter(|row| row.begins).count(), rows.div_ceil(10));
    }
}

#[test]
fn a_played_row_allocates_nothing() {
    let file = file(csv(100_000).as_bytes());
    let Reader { mut stream, .. } = Reader::open(&file.path().display().to_string());
    let mut rows = 0_u64;
    let mut poll = |stream: &mut Stream| {
        let mut on = |event: Event<'_>| {
            rows += u64::from(matches!(event, Event::Row(_)));
            ControlFlow::Continue(())
        };
        stream.poll(0, &mut on).unwrap();
        rows
    };
    poll(&mut stream);
    let counted = allocation_counter::measure(|| while !stream.ended() && poll(&mut stream) < 90_000 {});
    assert_eq!(counted.count_total, 0);
    assert!(rows >= 90_000);
}

#[test]
fn a_damaged_time_costs_its_row_and_a_pause_none() {
    let mut text = "time_s,n,P1\n".to_owned();
    let mut truth = Vec::new();
    for row in 0..300_u32 {
        // Two pauses, and digits that are wrong before, at and behind one.
        let time_s = f64::from(row) / 1e3 + if row >= 100 { 60.0 } else { 0.0 } + if row >= 200 { 0.5 } else { 0.0 };
        let wrong_s = match row {
            50 | 199 => 4000.0,
            150 => -30.0,
            _ => 0.0,
        };
        text.push_str(&format!("{:.3},{row},{}\n", time_s + wrong_s, row * 2));
        if wrong_s == 0.0 {
            truth.push((time_s, vec![f64::from(row * 2)]));
        }
    }
    let file = file(text.as_bytes());
    for address in [file.path().display().to_string(), format!("{}?rate=1000", file.path().display())] {
        let (stream, log) = played(&address);
        assert_eq!(log.rows.len(), truth.len());
        for (row, (time_s, values)) in log.rows.iter().zip(&truth) {
            assert!((row.time_s - time_s).abs() <= 1e-9 && row.values == *values, "{row:?} {time_s} {values:?}");
        }
        let counts = stream.certificate().counts;
        assert_eq!((counts.doubtful, counts.lost, counts.set_back, counts.disorder), (3, 3, 0, 0));
    }
}
