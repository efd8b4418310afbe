//! Lines decoded: names, cells, checksums, what is spoilt.

mod damage;

use super::*;
use crate::wire::checksum::{crc16, xor8};
use crate::wire::testing::naming;

pub(super) fn lines(options: LineOptions) -> Lines {
    Lines::new(Box::new(naming), options)
}

/// What a stream holds, the numbers with their bits; pieces end at `cuts`.
pub(super) fn steps(lines: &mut Lines, stream: &[u8], cuts: &[usize]) -> Result<Vec<String>, WireFault> {
    let mut found = Vec::new();
    let mut begin = 0;
    for end in cuts.iter().copied().chain([stream.len()]) {
        let mut piece = &stream[begin..end];
        begin = end;
        while let Some(step) = lines.next(&mut piece, 0)? {
            found.push(shown_step(step, lines));
        }
    }
    while let Some(step) = lines.finish(0)? {
        found.push(shown_step(step, lines));
    }
    Ok(found)
}

fn shown_step(step: Step, lines: &Lines) -> String {
    match step {
        Step::Columns { again } => format!("{}{}", if again { "again " } else { "" }, lines.decoded().names.join("|")),
        Step::Sample(Sample { time, counter, lit }) => {
            format!("{time} {counter:?} {lit:?} {:?}", lines.decoded().values)
        }
        Step::Spoilt(spoil) => format!("{spoil:?}"),
    }
}

fn all(text: &str) -> Vec<String> {
    steps(&mut lines(LineOptions::default()), text.as_bytes(), &[]).unwrap()
}

#[test]
fn lines_say_what_their_columns_are() {
    let rows = ["time_s|n|led|P1|P2|note", "0.5 Some(3) Some(true) [1.25, NaN]", "1 None None [-0.0, 2.0]"];
    for text in [
        "time_s,n,led,P1,P2,note\n0.5,3,1,1.25,,x\n1,,,-0,2,\n",
        "\u{feff}# by hand\r\n\r\n\"time_s\", n,led,P1,P2,note\r\n0.5,3,on,\"1.25\",nan,\"a,b\"\r\n#\r\n1,,NA,-0,2.0,",
        "time_s\tn\tled\tP1\tP2\tnote\n0.5\t3\ttrue\t1.25\t\t\n1\t\t\t-0\t2\t\n",
        "sep=;\ntime_s;n;led;P1;P2;note\n0,5;3;1,0;1,25;;\n1;;;-0;2;\n",
        "time_s n  led P1 P2 note\n0.5 3.0 1 1.25 NA x\n  1 NA NA -0 2 x  \n",
        "# time_s,n,led,P1,P2,note\n0.5,3,1,1.25,,\n1,,,-0,2,,,\n",
        "# by hand\r\rtime_s,n,led,P1,P2,note\r0.5,3,1,1.25,,x\r1,,,-0,2,\r",
    ] {
        let mut found = all(text);
        found.retain(|step| step != "BeforeNames");
        assert_eq!(found, rows, "{text}");
    }
}

#[test]
fn names_may_be_given_beforehand() {
    let columns = Some(["time_s", "P1"].map(str::to_owned).into());
    for (text, again) in [("1,2\n3,4", 0), ("time,light\n1,2\n3,4\n", 0), ("1\t2\na\tb\n3\t4\n", 1)] {
        let found =
            steps(&mut lines(LineOptions { columns: columns.clone(), ..Default::default() }), text.as_bytes(), &[]);
        let mut found = found.unwrap();
        assert_eq!(found.iter().filter(|step| step.starts_with("again")).count(), again);
        found.retain(|step| !step.starts_with("again"));
        assert_eq!(found, ["time_s|P1", "1 None None [2.0]", "3 None None [4.0]"], "{text}");
    }
}

#[test]
fn a_spoilt_row_costs_itself() {
    let text = "time_s,led,P1,P2\n0,1,1,2\n1,1,1\n2,1,1,2,3\n3,1,x,2\n4,7,1,2\n5,1,inf,2\n\u{fffd}\n6,0,3,4\n";
    let mut decoder = lines(LineOptions::default());
    let found = steps(&mut decoder, text.as_bytes(), &[]).unwrap();
    let rows = ["0 None Some(true) [1.0, 2.0]", "6 None Some(false) [3.0, 4.0]"];
    assert_eq!((&found[1], &found[8]), (&rows[0].to_owned(), &rows[1].to_owned()));
    let tally = &decoder.decoded().tally;
    assert_eq!((tally.count(Spoil::Cells), tally.count(Spoil::Unreadable), tally.spoilt()), (3, 3, 6));
    assert_eq!((tally.kinds[0].line, tally.kinds[0].text.as_str()), (3, "1,1,1"));
    assert_eq!((tally.kinds[1].line, tally.kinds[1].text.as_str()), (5, "3,1,x,2"));
}

#[test]
fn a_device_that_starts_again_repeats_its_names() {
    let text = "rst:0x1 (POWERON),boot:0x13\nwaiting for download\nmode:DIO, clock div:2\ntime_us,n,P1\n7,0,1\n8,1,1\n\
                ets Jul 29 2019\ntime_us,n,P1\n7,0,1\n";
    let mut found = all(text);
    found.retain(|step| step != "BeforeNames" && step != "Cells");
    let row = "7 Some(0) None [1.0]";
    assert_eq!(found, ["time_us|n|P1", row, "8 Some(1) None [1.0]", "again time_us|n|P1", row]);
}

#[test]
fn a_device_that_starts_again_with_other_columns_ends_the_stream() {
    let fault = |text: &str| steps(&mut lines(LineOptions::default()), text.as_bytes(), &[]).unwrap_err();
    let head = "time_s,P1,P2,note\n0,1,2,x\n";
    for names in ["time_s,P2,P1,note", "P1,time_s,P2,note", "time_s,P1,P3,note", "time_us,P1,P2,note"] {
        let (line, before) = (3, "time_s,P1,P2,note".to_owned());
        let expected = WireFault::OtherNames { line, names: names.to_owned(), before };
        assert_eq!(fault(&format!("{head}{names}\n1,3,4,y\n")), expected);
    }
    let said = fault("P1,P2\n1,2\nP2,P1\n").to_string();
    let words = "line 3 names the columns P2,P1, and the rows before it are P1,P2: the device started again";
    assert!(said.starts_with(words), "{said}");
    // Messages, and rows of other columns, are spoilt each by itself.
    for (line, spoil) in [
        ("sensor,is,warm,now", "Unreadable"),
        ("time_s,P1,P2,7", "Unreadable"),
        ("time_s,P1,P\u{1},note", "Unreadable"),
        ("time_s,P2,P1", "Cells"),
        ("time_s,P1,P2,P3,note", "Cells"),
    ] {
        assert_eq!(all(&format!("{head}{line}\n"))[2], spoil, "{line}");
    }
    // Half a line of names is none.
    let mut decoder = lines(LineOptions::default());
    let mut rest = head.as_bytes();
    while decoder.next(&mut rest, 0).unwrap().is_some() {}
    decoder.cut(true);
    assert_eq!(decoder.next(&mut &b"s,P1,P2,note\n"[..], 0), Ok(None));
    decoder.cut(true);
    assert!(decoder.next(&mut &b"note,time_s,P2,P1\n"[..], 0).is_err());
    // A line that is damaged is not believed.
    let sealed = |line: &str| format!("{line}*{:02X}\n", xor8(line.as_bytes()));
    let text = [sealed("P1,P2"), sealed("1,2"), sealed("P1,P2").replacen('2', "3", 1), "P2,P1\n".to_owned()].concat();
    assert_eq!(all(&text)[2..], ["Checksum", "Unchecked"]);
    assert!(matches!(fault(&(text + &sealed("P2,P1"))), WireFault::OtherNames { line: 5, .. }));
}

#[test]
fn names_given_in_another_order_than_the_streams_are_refused() {
    let columns = Some(["time_s", "P1", "P2"].map(str::to_owned).into());
    let found = |text: &str| {
        steps(&mut lines(LineOptions { columns: columns.clone(), ..Default::default() }), text.as_bytes(), &[])
    };
    for (text, line) in [("time_s,P2,P1\n1,2,3\n", 1), ("1,2,3\ntime_s,P2,P1\n1,2,3\n", 2)] {
        let (names, given) = ("time_s,P2,P1".to_owned(), "time_s,P1,P2".to_owned());
        let fault = found(text).unwrap_err();
        assert_eq!(fault, WireFault::OtherOrder { line, names, given });
        assert!(fault.to_string().contains("--names gives them in another order, time_s,P1,P2; leave --names out"));
    }
    // The device's own words for the same columns.
    assert_eq!(found("time,light,dark\n1,2,3\n").unwrap()[1], "1 None None [2.0, 3.0]");
}

#[test]
fn counts_become_volts_where_they_are_scaled() {
    let options = LineOptions { volts_per_count: Some(5.0 / 1023.0), ..Default::default() };
    let found = steps(&mut lines(options), b"P1,F\n1023,2\n", &[]).unwrap();
    assert_eq!(found[1], format!("NaN None None [{:?}, 2.0]", 1023.0 * (5.0 / 1023.0)));
}

#[test]
fn rows_have_checksums_where_one_had() {
    let sealed = |line: &str| format!("{line}*{:02X}\n", xor8(line.as_bytes()));
    let crc = |line: &str| format!("${line}*{:04x}\r\n", crc16(line.as_bytes()));
    for seal in [&sealed as &dyn Fn(&str) -> String, &crc] {
        let good = seal("1,2");
        let text = format!("time_s,P1\n{good}3,4\n{}{}", seal("5,6").replace(",6", ",7"), seal("8,9"));
        let found = all(&text);
        let rows = ["1 None None [2.0]", "Unchecked", "Checksum", "8 None None [9.0]"];
        assert_eq!(found[1..], rows, "{text}");
    }
    // Of another kind than before.
    let mixed = format!("P1\n{}{}", sealed("1"), crc("2"));
    assert_eq!(all(&mixed)[2], "Checksum");
}

#[test]
fn faults_say_what_to_do() {
    let fault = |text: &[u8], is_file: bool| {
        let found = steps(&mut lines(LineOptions { is_file, ..Default::default() }), text, &[]);
        found.unwrap_err().to_string()
    };
    for (text, words) in [
        (&b"0.1,2\n0.2,3\n"[..], "--names"),
        (b"time_s,light\n0,1\n", "line 1 names the columns time_s,light: there is no photodiode"),
        (b"", "ends before a line of names"),
        (b"\xf3\x02\xe0\x1c\x00\x9f\xfe\xe0\x80\n\xf3\x02\xe0\x1c", "looks like a wrong baud rate"),
    ] {
        for is_file in [false, true] {
            let said = fault(text, is_file);
            assert!(said.contains(words), "{said}");
        }
    }
    let dated = fault(b"time,light\n05.03.2024 09:26:53,0.1,ok\n", true);
    assert!(dated.contains("line 1 names the columns time,light"), "{dated}");
    let padded = fault(b"Subject,S1,,\n,,,\ntime,light,a,b\n1,2,3,4\n", true);
    assert!(padded.contains("line 3 names the columns time,light,a,b"), "{padded}");
    let more = fault(b"time,light\n1,2,3\n", true);
    assert!(more.contains("line 1 names the columns time,light"), "{more}");
    assert!(fault(b"Ready.\n1,2,3\n", true).contains("--names"));
    let said = fault(&[0xe0; 5000], false);
    assert!(said.contains("looks like a wrong baud rate"), "{said}");
    // A device that sends numbers for long, and never names.
    let mut decoder = lines(LineOptions::default());
    let mut sent = 0;
    let fault = (0..100).find_map(|row| {
        sent += 1;
        decoder.next(&mut &b"1,2\n"[..], row * 40_000_000).err()
    });
    assert!(matches!(fault, Some(WireFault::NoNames { line: 76, .. })), "{fault:?} after {sent}");
}

#[test]
fn half_a_line_at_a_seam_is_dropped() {
    let mut decoder = lines(LineOptions::default());
    let mut rows = 0;
    let mut feed = |decoder: &mut Lines, text: &str| {
        let mut piece = text.as_bytes();
        while let Some(step) = decoder.next(&mut piece, 0).unwrap() {
            rows += u32::from(matches!(step, Step::Sample(_)));
        }
        rows
    };
    assert_eq!(feed(&mut decoder, "time_s,P1\n1,2\n2,3\n3,"), 2);
    decoder.cut(true);
    assert_eq!(feed(&mut decoder, "4,5\n5,6\n"), 3, "the first line may be the end of one");
    decoder.cut(false);
    assert_eq!(feed(&mut decoder, "6,7\n"), 4);
    decoder.cut(true);
    assert_eq!(feed(&mut decoder, "time_s,P1\n7,8\n"), 5);
    assert_eq!(decoder.decoded().tally.spoilt(), 0);
}

#[test]
fn a_line_without_end_takes_no_memory() {
    let mut decoder = lines(LineOptions::default());
    let mut head = &b"time_s,P1\n1,2\n"[..];
    while decoder.next(&mut head, 0).unwrap().is_some() {}
    let piece = vec![b'7'; 1 << 16];
    let mut spoilt = 0;
    // A gigabyte.
    let counted = allocation_counter::measure(|| {
        for _ in 0..1 << 14 {
            spoilt += u32::from(decoder.next(&mut &piece[..], 0).unwrap().is_some());
        }
    });
    assert!(counted.bytes_max <= 4 << 20, "{counted:?}");
    let mut rest = &b"7\n3,4\n"[..];
    assert!(matches!(decoder.next(&mut rest, 0), Ok(Some(Step::Sample(Sample { time: 3.0, .. })))));
    assert_eq!((spoilt, decoder.decoded().tally.count(Spoil::TooLong)), (1, 1));
}

#[test]
fn a_row_allocates_nothing() {
    let text = "0.001,17,1,1.25,2.5,-3.5e-3,4,5,6,7,8\n".repeat(1000);
    let mut decoder = lines(LineOptions::default());
    let mut rows = 0;
    let mut feed = |decoder: &mut Lines, text: &str| {
        for piece in text.as_bytes().chunks(1000) {
            let mut piece = piece;
            while let Some(step) = decoder.next(&mut piece, 0).unwrap() {
                rows += u32::from(matches!(step, Step::Sample(_)));
            }
        }
    };
    feed(&mut decoder, "time_s,n,led,P1,P2,P3,P4,P5,P6,P7,P8\n");
    let counted = allocation_counter::measure(|| feed(&mut decoder, &text));
    assert_eq!((rows, counted.count_total), (1000, 0));
}
