use std::fs;

use proptest::prelude::*;

use super::*;
use crate::trial::Folder;

const FORMATS: [&str; 2] = ["csv", "parquet"];

fn columns() -> Vec<Column> {
    vec![
        Column::integer("frame"),
        Column::rounded("time_s", 6),
        Column::number("free"),
        Column::rounded("J2_deg", 5),
        Column::text("status"),
    ]
}

/// A new table, filled by `fill`.
fn fill(path: &Path, columns: Vec<Column>, facts: &[(String, String)], fill: impl FnOnce(&mut TableWriter)) {
    let mut table = TableWriter::create(path, path, columns, facts).unwrap();
    fill(&mut table);
    table.finish().unwrap();
}

fn written(extension: &str, rows: &[[Value<'_>; 5]]) -> (Folder, PathBuf) {
    let folder = Folder::new();
    let path = folder.path("t").with_extension(extension);
    let facts = [("angles".to_owned(), "positive in flexion".to_owned())];
    fill(&path, columns(), &facts, |table| rows.iter().for_each(|row| table.write(row).unwrap()));
    (folder, path)
}

const ROWS: [[Value<'static>; 5]; 4] = [
    [Value::Integer(0), Value::Number(0.0), Value::Number(0.1), Value::Number(-0.000_001), Value::Text("ok")],
    [Value::Integer(1), Value::Number(1.0 / 30.0), Value::Missing, Value::Missing, Value::Text("lost: a, \"b\"\nä")],
    [Value::Integer(i64::MIN), Value::Integer(-2), Value::Number(1e-300), Value::Number(f64::NAN), Value::Missing],
    [
        Value::Missing,
        Value::Number(-1_234.567_890_12),
        Value::Number(-0.0),
        Value::Number(f64::INFINITY),
        Value::Text(""),
    ],
];

#[test]
fn tables_read_alike_from_both_formats() {
    for extension in FORMATS {
        let (_dir, path) = written(extension, &ROWS);
        let table = Table::read(&path).unwrap();
        assert_eq!((table.rows(), table.names().join(",").as_str()), (4, "frame,time_s,free,J2_deg,status"));
        assert_eq!(table.integers("frame").unwrap(), [Some(0), Some(1), Some(i64::MIN), None]);
        assert_eq!(table.numbers("time_s").unwrap(), [Some(0.0), Some(0.033_333), Some(-2.0), Some(-1_234.567_89)]);
        assert_eq!(table.numbers("free").unwrap(), [Some(0.1), None, Some(1e-300), Some(0.0)]);
        assert!(table.numbers("free").unwrap()[3].unwrap().is_sign_positive(), "{extension}");
        assert_eq!(table.numbers("J2_deg").unwrap(), [Some(0.0), None, None, None]);
        assert!(table.numbers("J2_deg").unwrap()[0].unwrap().is_sign_positive(), "{extension}");
        let status: Vec<Option<&str>> = vec![Some("ok"), Some("lost: a, \"b\"\nä"), None, None];
        assert_eq!(table.texts("status").unwrap(), status.iter().map(|s| s.map(str::to_owned)).collect::<Vec<_>>());
        assert_eq!(table.facts().len(), usize::from(extension == "parquet"));
    }
}

#[test]
fn csv_is_what_a_person_expects() {
    let (_dir, path) = written("csv", &ROWS[..2]);
    let text = fs::read_to_string(path).unwrap();
    assert_eq!(
        text,
        "frame,time_s,free,J2_deg,status\n0,0.000000,0.1,0.00000,ok\n1,0.033333,,,\"lost: a, \"\"b\"\"\nä\"\n"
    );
}

#[test]
fn a_table_may_have_no_rows() {
    for extension in FORMATS {
        let (_dir, path) = written(extension, &[]);
        let table = Table::read(&path).unwrap();
        assert_eq!((table.rows(), table.names().len()), (0, 5));
        assert!(table.numbers("time_s").unwrap().is_empty() && table.texts("status").unwrap().is_empty());
    }
}

#[test]
fn long_tables_span_row_groups() {
    let rows = 2 * 65_536 + 3;
    let folder = Folder::new();
    let path = folder.path("long.parquet");
    let columns = vec![Column::integer("frame"), Column::rounded("x", 3), Column::text("status")];
    fill(&path, columns, &[], |table| {
        for k in 0..rows {
            let x = if k % 3 == 0 { Value::Missing } else { Value::Number(k as f64 / 7.0) };
            table.write(&[Value::Integer(k), x, Value::Text(if k % 5 == 0 { "lost: a" } else { "ok" })]).unwrap();
        }
    });
    let table = Table::read(&path).unwrap();
    assert_eq!(table.integers("frame").unwrap(), (0..rows).map(Some).collect::<Vec<_>>());
    let x = table.numbers("x").unwrap();
    assert!((0..rows as usize).all(|k| x[k].is_some() == (k % 3 != 0)));
    assert_eq!(x[131_074], Some(18_724.857));
    assert_eq!(table.texts("status").unwrap()[65_540].as_deref(), Some("lost: a"));
}

#[test]
fn the_same_rows_give_the_same_bytes() {
    for extension in FORMATS {
        let [a, b] = [written(extension, &ROWS), written(extension, &ROWS)].map(|(_dir, path)| fs::read(path).unwrap());
        assert!(a == b, "{extension}");
    }
}

#[test]
fn wrong_rows_and_columns_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("t.csv");
    let mut table = TableWriter::create(&path, &path, columns(), &[]).unwrap();
    assert!(table.write(&ROWS[0][..4]).unwrap_err().to_string().contains("4 cells for 5 columns"));
    let mut row = ROWS[0];
    row[0] = Value::Number(1.5);
    assert!(table.write(&row).unwrap_err().to_string().contains("`frame`"));
    let twice = vec![Column::text("a"), Column::text("a")];
    assert!(TableWriter::create(&path, &path, twice, &[]).unwrap_err().to_string().contains("two columns"));
    let other = dir.path().join("t.xlsx");
    let message = TableWriter::create(&other, &other, columns(), &[]).unwrap_err().to_string();
    assert!(message.contains("t.xlsx") && message.contains(".parquet"), "{message}");
    let nowhere = dir.path().join("no/t.parquet");
    assert!(TableWriter::create(&nowhere, &nowhere, columns(), &[]).unwrap_err().to_string().contains("t.parquet"));
    assert_eq!(TableFormat::of(Path::new("A.CSV")).unwrap(), TableFormat::Csv);
}

fn read_text(text: &[u8]) -> Result<Table, TableError> {
    Table::read(&Folder::new().file("log.csv", text))
}

#[test]
fn files_of_other_programs_are_read() {
    let table = read_text(b"\xef\xbb\xbftime_s, P1 ,note\r\n0, 1e-3,\"a, b\"\r\n\r\n+2.5,,c\r\n").unwrap();
    assert_eq!(table.names(), ["time_s", "P1", "note"]);
    assert_eq!(table.numbers("time_s").unwrap(), [Some(0.0), Some(2.5)]);
    assert_eq!(table.numbers("P1").unwrap(), [Some(0.001), None]);
    assert_eq!(table.texts("note").unwrap()[0].as_deref(), Some("a, b"));
}

#[test]
fn a_wrong_cell_is_named_with_file_line_and_column() {
    let table = read_text(b"a,b\n1,\"two\nlines\"\n1,2\nnan,2.5\nx,3\n").unwrap();
    let message = table.numbers("a").unwrap_err().to_string();
    assert!(message.contains("log.csv:5: column `a`: `NaN` is no finite number"), "{message}");
    let message = table.integers("b").unwrap_err().to_string();
    assert!(message.contains("log.csv:2: column `b`"), "{message}");
    let message = table.numbers("c").unwrap_err().to_string();
    assert!(message.contains("no column `c`; its columns are a, b"), "{message}");
    let (_dir, path) = written("parquet", &ROWS);
    let table = Table::read(&path).unwrap();
    let message = table.numbers("status").unwrap_err().to_string();
    assert!(message.contains("t.parquet: row 1, column `status`"), "{message}");
    assert!(table.integers("time_s").unwrap_err().to_string().contains("row 2, column `time_s`"));
}

#[test]
fn other_delimiters_decimal_commas_and_line_ends_are_read() {
    let plain = read_text(b"time_s,name,P1\n0.5,\"a, b\",-1e-3\n1,2 x,\n").unwrap();
    let texts = |table: &Table| table.texts("name").unwrap();
    for mark in [';', '\t', '|'] {
        for (comma, end) in [(',', "\n"), ('.', "\r\n"), (',', "\r")] {
            let text = format!("time_s;name;P1\n0{comma}5;\"a, b\";-1e-3\n1;2 x;\n");
            let text = text.replace(';', &mark.to_string()).replace('\n', end);
            for text in [format!("{end}{end}{text}"), format!("\u{feff}{text}")] {
                let read = read_text(text.as_bytes()).unwrap();
                assert_eq!(read.names(), plain.names(), "{text:?}");
                assert_eq!(read.numbers("time_s").unwrap(), plain.numbers("time_s").unwrap(), "{text:?}");
                assert_eq!(read.numbers("P1").unwrap(), [Some(-0.001), None], "{text:?}");
                assert_eq!(texts(&read), texts(&plain), "{text:?}");
                let names = column_names(&Folder::new().file("t.csv", &text)).unwrap();
                assert_eq!(names, plain.names(), "{text:?}");
            }
        }
    }
    // Rows of nothing at the end, and only there.
    let read = read_text(b"a,b\n,\n1,2\n,\n\"\",\n").unwrap();
    assert_eq!(read.numbers("b").unwrap(), [None, Some(2.0)]);
    assert_eq!(read_text(b"a,b\n,\n").unwrap().rows(), 0);
    // A line is the file's own; in a table with commas a decimal comma is another cell.
    let said = read_text(b"a;b\r1,5;2\rx;3\r").unwrap().numbers("a").unwrap_err().to_string();
    assert!(said.contains(":3: column `a`"), "{said}");
    assert!(read_text(b"a,b;c\n1,5;2\n").unwrap().numbers("b;c").is_err());
    let said = read_text(b"a,b\n\"1,5\",2\n").unwrap().numbers("a").unwrap_err().to_string();
    assert!(said.contains("`1,5` is no finite number (where commas part the cells, a decimal has a point)"), "{said}");
    assert_eq!(read_text(b"a;b;name, first\n1,5;2;x\n").unwrap().numbers("a").unwrap(), [Some(1.5)]);
}

#[test]
fn damaged_files_are_refused() {
    for (text, words) in [
        (&b""[..], "is empty"),
        (b"a,b\n1,2\n1,2,3\n", "line 3 has 3 cells and the first line 2"),
        (b"a;b\n1,5;2.5\n", "decimal commas (line 2) and decimal points (line 2)"),
        (b"a;b\n1,5\n", "line 2 has 1 cells and the first line 2"),
        (b"a,a,,\n1,2,,\n", "two columns are named `a`"),
        (b"a,b\n1,\xff\n", "line 2 is not UTF-8"),
    ] {
        let message = read_text(text).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("log.csv"), "{message}");
    }
    assert!(Table::read(Path::new("nothing.csv")).unwrap_err().to_string().contains("nothing.csv"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn numbers_come_back(
        free in prop::collection::vec(
            prop::option::of(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO),
            1..20,
        ),
        fixed in -1e6..1e6_f64,
    ) {
        let read = FORMATS.map(|extension| {
            let rows: Vec<[Value<'_>; 5]> =
                free.iter()
                    .map(|&x| [Value::Missing, Value::Number(fixed), x.into(), Value::Number(fixed), Value::Missing])
                    .collect();
            let (_dir, path) = written(extension, &rows);
            let table = Table::read(&path).unwrap();
            (table.numbers("free").unwrap(), table.numbers("J2_deg").unwrap()[0].unwrap())
        });
        prop_assert_eq!(&read[0], &read[1]);
        prop_assert_eq!(&read[0].0, &free);
        // Half of the last decimal and the rounding of a million.
        prop_assert!((read[0].1 - fixed).abs() <= 0.5e-5 + 1e-9);
    }
}

#[test]
fn dates_of_other_programs_are_read_as_text() {
    use ::parquet::data_type::Int64Type;
    use ::parquet::file::writer::SerializedFileWriter;
    use ::parquet::schema::parser::parse_message_type;

    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("stamps.parquet");
    let schema =
        "message t { required int64 zoned (TIMESTAMP(NANOS,true)); required int64 local (TIMESTAMP(MILLIS,false)); }";
    let schema = std::sync::Arc::new(parse_message_type(schema).unwrap());
    let mut file = SerializedFileWriter::new(fs::File::create(&path).unwrap(), schema, Default::default()).unwrap();
    let mut group = file.next_row_group().unwrap();
    for value in [1_634_808_058_216_642_589, 1_634_808_058_216] {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&[value], None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    file.close().unwrap();
    let table = Table::read(&path).unwrap();
    assert_eq!(table.texts("zoned").unwrap(), [Some("2021-10-21T09:20:58.216642589Z".to_owned())]);
    assert_eq!(table.texts("local").unwrap(), [Some("2021-10-21T09:20:58.216".to_owned())]);
    assert_eq!((table.is_text("local"), table.is_text("none")), (Some(true), None));
}

#[test]
fn nan_of_other_programs_is_distinguished_from_infinity() {
    let table = read_text(b"a,b\n1,inf\nNaN,2\n,3\n").unwrap();
    let a = table.numbers_or_nan("a").unwrap();
    assert!(a[0] == Some(1.0) && a[1].is_some_and(f64::is_nan) && a[2].is_none());
    assert!(table.numbers("a").is_err() && table.numbers_or_nan("b").is_err());
}

#[test]
fn many_rows_at_once_are_the_same_as_row_by_row() {
    let columns = || vec![Column::integer("k"), Column::number("x"), Column::rounded("y", 3), Column::text("words")];
    for extension in ["csv", "parquet"] {
        let dir = tempfile::tempdir().unwrap();
        let rows = 2 * CHUNK + 17;
        let make = |k: usize, write: &mut dyn FnMut(&[Value<'_>])| {
            let x = (k as f64).sin() * 10f64.powi((k % 30) as i32 - 15);
            let words = format!("a \"{k}\", b");
            let x = if k.is_multiple_of(7) { Value::Missing } else { Value::Number(x) };
            write(&[Value::Integer(k as i64), x, Value::Number(-1e-5 * k as f64), Value::Text(&words)]);
        };
        let [one, many] = ["one", "many"].map(|name| dir.path().join(name).with_extension(extension));
        fill(&one, columns(), &[], |table| {
            (0..rows).for_each(|k| make(k, &mut |cells| table.write(cells).unwrap()));
        });
        fill(&many, columns(), &[], |table| table.write_rows(rows, &make).unwrap());
        assert!(std::fs::read(one).unwrap() == std::fs::read(&many).unwrap(), "{extension}");
        assert_eq!(Table::read(&many).unwrap().rows(), rows);
        let mut table = TableWriter::create(&many, &many, columns(), &[]).unwrap();
        let short = |k: usize, write: &mut dyn FnMut(&[Value<'_>])| write(&[Value::Integer(k as i64)]);
        assert!(table.write_rows(3, &short).unwrap_err().to_string().contains("row 1 has 1 cells for 4 columns"));
    }
}
