//! Tables as Apache Parquet: one row group every 65 536 rows, every column optional.

use std::cell::Cell;
use std::fs::File;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Arc, Once};

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;

use super::{Column, ColumnKind, Value, number_value, plausible};
use crate::input;

/// Rows that are held before they are written.
const GROUP_ROWS: usize = 65_536;

/// A Parquet file in the making.
pub(super) struct ParquetWriter {
    file: SerializedFileWriter<File>,
    held: Vec<Held>,
    rows: usize,
}

impl std::fmt::Debug for ParquetWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ParquetWriter").field("rows", &self.rows).finish_non_exhaustive()
    }
}

/// The held cells of a column: the known ones, and for each row whether it is known (Parquet's definition level).
struct Held {
    cells: Cells,
    known: Vec<i16>,
}

enum Cells {
    Integers(Vec<i64>),
    Numbers(Vec<f64>),
    Texts(Vec<ByteArray>),
}

impl ParquetWriter {
    pub(super) fn create(at: &Path, columns: &[Column], facts: &[(String, String)]) -> Result<Self, String> {
        let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
        let schema = Type::group_type_builder("table").with_fields(fields).build().map_err(|e| e.to_string())?;
        let facts: Vec<KeyValue> = facts.iter().map(|(k, v)| KeyValue::new(k.clone(), v.clone())).collect();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(facts).filter(|f| !f.is_empty()))
            .build();
        let file = File::create(at).map_err(|e| e.to_string())?;
        let file =
            SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).map_err(|e| e.to_string())?;
        let held = columns.iter().map(Held::of).collect();
        Ok(Self { file, held, rows: 0 })
    }

    pub(super) fn write(&mut self, cells: &[Value<'_>], columns: &[Column]) -> Result<(), String> {
        for ((cell, column), held) in cells.iter().zip(columns).zip(&mut self.held) {
            held.push(cell, column.decimals());
        }
        self.rows += 1;
        if self.rows == GROUP_ROWS { self.write_group() } else { Ok(()) }
    }

    pub(super) fn finish(mut self) -> Result<(), String> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.file.close().map(drop).map_err(|e| e.to_string())
    }

    fn write_group(&mut self) -> Result<(), String> {
        let mut group = self.file.next_row_group().map_err(|e| e.to_string())?;
        for held in &mut self.held {
            let column = group.next_column().map_err(|e| e.to_string())?;
            held.write_to(column.ok_or("fewer columns than the table has")?)?;
        }
        group.close().map_err(|e| e.to_string())?;
        self.rows = 0;
        Ok(())
    }
}

fn field(column: &Column) -> Result<Arc<Type>, String> {
    let physical = match column.kind {
        ColumnKind::Integer => Physical::INT64,
        ColumnKind::Number { .. } => Physical::DOUBLE,
        ColumnKind::Text => Physical::BYTE_ARRAY,
    };
    let text = matches!(column.kind, ColumnKind::Text);
    Type::primitive_type_builder(&column.name, physical)
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(text.then_some(LogicalType::String))
        .build()
        .map(Arc::new)
        .map_err(|e| e.to_string())
}

impl Held {
    fn of(column: &Column) -> Self {
        let cells = match column.kind {
            ColumnKind::Integer => Cells::Integers(Vec::new()),
            ColumnKind::Number { .. } => Cells::Numbers(Vec::new()),
            ColumnKind::Text => Cells::Texts(Vec::new()),
        };
        Self { cells, known: Vec::new() }
    }

    fn push(&mut self, cell: &Value<'_>, decimals: Option<usize>) {
        let known = match (&mut self.cells, cell) {
            (Cells::Integers(held), Value::Integer(whole)) => {
                held.push(*whole);
                true
            }
            (Cells::Numbers(held), Value::Integer(_) | Value::Number(_)) => {
                let number = match cell {
                    Value::Integer(whole) => number_value(*whole as f64, decimals),
                    Value::Number(number) => number_value(*number, decimals),
                    Value::Missing | Value::Text(_) => None,
                };
                held.extend(number);
                number.is_some()
            }
            (Cells::Texts(held), Value::Text(text)) if !text.is_empty() => {
                held.push(ByteArray::from(*text));
                true
            }
            _ => false,
        };
        self.known.push(i16::from(known));
    }

    fn write_to(&mut self, mut column: SerializedColumnWriter<'_>) -> Result<(), String> {
        fn write<D: DataType>(
            column: &mut SerializedColumnWriter<'_>,
            held: &mut Vec<D::T>,
            known: &[i16],
        ) -> Result<(), String> {
            column.typed::<D>().write_batch(held, Some(known), None).map_err(|e| e.to_string())?;
            held.clear();
            Ok(())
        }
        match &mut self.cells {
            Cells::Integers(held) => write::<Int64Type>(&mut column, held, &self.known)?,
            Cells::Numbers(held) => write::<DoubleType>(&mut column, held, &self.known)?,
            Cells::Texts(held) => write::<ByteArrayType>(&mut column, held, &self.known)?,
        }
        self.known.clear();
        column.close().map_err(|e| e.to_string())
    }
}

/// A column as it is read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Read {
    Integers(Vec<Option<i64>>),
    Numbers(Vec<Option<f64>>),
    Texts(Vec<Option<String>>),
}

/// What a Parquet file holds.
pub(super) struct Contents {
    pub(super) names: Vec<String>,
    pub(super) columns: Vec<Read>,
    pub(super) facts: Vec<(String, String)>,
}

fn open(path: &Path) -> Result<SerializedFileReader<File>, String> {
    let file = input::open_regular(path).map_err(|e| e.to_string())?;
    plausible::check_footer(&file)?;
    let pages = file.try_clone().map_err(|e| e.to_string())?;
    let reader = SerializedFileReader::new(file).map_err(|e| format!("not a whole Parquet file ({e})"))?;
    plausible::check_pages(&pages, reader.metadata())?;
    Ok(reader)
}

/// The format's reader panics on some damaged files (15 of 50,000 that fuzzing made, at three places) where it should
/// refuse them: that costs the file and nothing else.
fn unharmed<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    static HOOK: Once = Once::new();
    thread_local! {
        static QUIET: Cell<bool> = const { Cell::new(false) };
    }
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |about| {
            if !QUIET.get() {
                before(about);
            }
        }));
    });
    let outer = QUIET.replace(true);
    let read = panic::catch_unwind(AssertUnwindSafe(read));
    QUIET.set(outer);
    read.unwrap_or_else(|_| Err("is damaged: its pages are not what its headers say; get it again, whole".to_owned()))
}

/// Reads a Parquet file without nested columns.
pub(super) fn read(path: &Path) -> Result<Contents, String> {
    unharmed(|| contents(path))
}

fn contents(path: &Path) -> Result<Contents, String> {
    let reader = open(path)?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let mut names = Vec::new();
    let mut columns = Vec::new();
    for k in 0..schema.num_columns() {
        let described = schema.column(k);
        let name = described.path().string();
        if described.max_rep_level() > 0 || described.path().parts().len() > 1 {
            return Err(format!("column `{name}` is nested; write plain columns"));
        }
        columns.push(read_column(&reader, k).map_err(|why| format!("column `{name}` can't be read ({why})"))?);
        names.push(name);
    }
    let facts = reader.metadata().file_metadata().key_value_metadata().into_iter().flatten();
    let facts = facts.filter_map(|f| Some((f.key.clone(), f.value.clone()?))).collect();
    Ok(Contents { names, columns, facts })
}

/// The names of a Parquet file's columns, the rows unread.
pub(super) fn names(path: &Path) -> Result<Vec<String>, String> {
    unharmed(|| {
        let reader = open(path)?;
        let schema = reader.metadata().file_metadata().schema_descr();
        Ok((0..schema.num_columns()).map(|k| schema.column(k).path().string()).collect())
    })
}

fn read_column(reader: &SerializedFileReader<File>, column: usize) -> Result<Read, String> {
    let described = reader.metadata().file_metadata().schema_descr().column(column);
    let mut read = match described.physical_type() {
        Physical::BOOLEAN | Physical::INT32 | Physical::INT64 if is_plain_integer(&described) => {
            Read::Integers(Vec::new())
        }
        Physical::INT64 if stamp_kind(&described).is_some() => Read::Texts(Vec::new()),
        Physical::FLOAT | Physical::DOUBLE => Read::Numbers(Vec::new()),
        Physical::BYTE_ARRAY => Read::Texts(Vec::new()),
        other => return Err(format!("its type {other} is neither number nor text; write it as double or string")),
    };
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(|e| e.to_string())?;
        // Pages may say otherwise, without end.
        let most = read.rows() + usize::try_from(group.metadata().num_rows()).map_err(|e| e.to_string())?;
        let cells = group.get_column_reader(column).map_err(|e| e.to_string())?;
        match (cells, &mut read) {
            (ColumnReader::BoolColumnReader(r), Read::Integers(into)) => {
                extend::<BoolType, _>(r, into, most, |v| Ok(i64::from(v)))?
            }
            (ColumnReader::Int32ColumnReader(r), Read::Integers(into)) => {
                let unsigned = described.converted_type() == ConvertedType::UINT_32;
                extend::<Int32Type, _>(r, into, most, |v| {
                    Ok(if unsigned { i64::from(v as u32) } else { i64::from(v) })
                })?
            }
            (ColumnReader::Int64ColumnReader(r), Read::Integers(into)) => extend::<Int64Type, _>(r, into, most, Ok)?,
            (ColumnReader::Int64ColumnReader(r), Read::Texts(into)) => {
                let (a_second, zoned) = stamp_kind(&described).unwrap_or((1, false));
                extend::<Int64Type, _>(r, into, most, |v| stamp_text(v, a_second, zoned))?
            }
            (ColumnReader::FloatColumnReader(r), Read::Numbers(into)) => {
                extend::<FloatType, _>(r, into, most, |v| Ok(f64::from(v)))?
            }
            (ColumnReader::DoubleColumnReader(r), Read::Numbers(into)) => extend::<DoubleType, _>(r, into, most, Ok)?,
            (ColumnReader::ByteArrayColumnReader(r), Read::Texts(into)) => {
                extend::<ByteArrayType, _>(r, into, most, |v| {
                    v.as_utf8().map(str::to_owned).map_err(|_| "not UTF-8 text".to_owned())
                })?
            }
            _ => return Err("its type changes within the file".to_owned()),
        }
        if read.rows() != most {
            return Err("it has fewer rows than the file says; get it again, whole".to_owned());
        }
    }
    Ok(read)
}

impl Read {
    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Integers(column) => column.len(),
            Self::Numbers(column) => column.len(),
            Self::Texts(column) => column.len(),
        }
    }
}

/// Integers that count; not dates, times or decimals.
fn is_plain_integer(described: &parquet::schema::types::ColumnDescriptor) -> bool {
    use ConvertedType as C;
    let converted = described.converted_type();
    matches!(converted, C::NONE | C::INT_8 | C::INT_16 | C::INT_32 | C::INT_64 | C::UINT_8 | C::UINT_16 | C::UINT_32)
        && !matches!(described.logical_type_ref(), Some(LogicalType::Timestamp { .. } | LogicalType::Time { .. }))
}

/// Of a column of dates with times of day: how many of its units make a second, and whether they are in UTC.
fn stamp_kind(described: &parquet::schema::types::ColumnDescriptor) -> Option<(i64, bool)> {
    match (described.logical_type_ref(), described.converted_type()) {
        (Some(LogicalType::Timestamp(stamp)), _) => {
            let a_second = match stamp.unit {
                TimeUnit::MILLIS => 1_000,
                TimeUnit::MICROS => 1_000_000,
                TimeUnit::NANOS => 1_000_000_000,
            };
            Some((a_second, stamp.is_adjusted_to_u_t_c))
        }
        (_, ConvertedType::TIMESTAMP_MILLIS) => Some((1_000, true)),
        (_, ConvertedType::TIMESTAMP_MICROS) => Some((1_000_000, true)),
        _ => None,
    }
}

/// A date with a time of day as ISO 8601 writes it.
fn stamp_text(units: i64, a_second: i64, zoned: bool) -> Result<String, String> {
    let nanoseconds = i128::from(units) * i128::from(1_000_000_000 / a_second);
    let stamp = jiff::Timestamp::from_nanosecond(nanoseconds).map_err(|why| why.to_string())?;
    Ok(if zoned { stamp.to_string() } else { jiff::tz::Offset::UTC.to_datetime(stamp).to_string() })
}

fn extend<D: DataType, V>(
    mut reader: ColumnReaderImpl<D>,
    into: &mut Vec<Option<V>>,
    most: usize,
    convert: impl Fn(D::T) -> Result<V, String>,
) -> Result<(), String> {
    let (mut known, mut values) = (Vec::new(), Vec::new());
    loop {
        known.clear();
        values.clear();
        let (rows, ..) =
            reader.read_records(GROUP_ROWS, Some(&mut known), None, &mut values).map_err(|e| e.to_string())?;
        if rows == 0 {
            return Ok(());
        }
        if into.len() + rows > most {
            return Err("it has more rows than the file says; get it again, whole".to_owned());
        }
        let mut values = values.drain(..);
        for row in 0..rows {
            let value = if known.get(row).is_none_or(|&level| level > 0) { values.next() } else { None };
            into.push(value.map(&convert).transpose()?);
        }
    }
}
