//! The table of a campaign in Apache Parquet.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use wisdom_mission::Row;

use super::columns::{COLUMNS, Column, Of};
use super::folder::write_by;

/// Writes `runs.parquet`: the columns of `runs.csv` in one row group, whole numbers as INT64 and others as DOUBLE,
/// both empty where a run has none, text as UTF-8.
pub(super) fn write(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let fields =
        COLUMNS.iter().map(|c| Ok(Arc::new(field(c)?))).collect::<anyhow::Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("runs").with_fields(fields).build()?;
    write_by(path, |file| {
        let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::default())?;
        let mut group = writer.next_row_group()?;
        for column in &COLUMNS {
            let mut out = group.next_column()?.expect("the schema has every column");
            match column.of {
                Of::Count(of) => {
                    // They fit: a plan's seeds have a sign bit to spare.
                    let (values, there) = sparse(rows, |row| of(row).map(|n| n as i64));
                    out.typed::<Int64Type>().write_batch(&values, Some(&there), None)?;
                }
                Of::Real(of) => {
                    let (values, there) = sparse(rows, of);
                    out.typed::<DoubleType>().write_batch(&values, Some(&there), None)?;
                }
                Of::Text(of) => {
                    let values: Vec<ByteArray> =
                        rows.iter().map(|row| ByteArray::from(of(row).into_bytes())).collect();
                    out.typed::<ByteArrayType>().write_batch(&values, None, None)?;
                }
            }
            out.close()?;
        }
        group.close()?;
        writer.close()?;
        Ok(())
    })
}

/// The values that are there, and for each row 1 if it has one, else 0.
fn sparse<T>(rows: &[Row], of: impl Fn(&Row) -> Option<T>) -> (Vec<T>, Vec<i16>) {
    let mut values = Vec::with_capacity(rows.len());
    let there = rows
        .iter()
        .map(|row| {
            let value = of(row);
            let is_there = i16::from(value.is_some());
            values.extend(value);
            is_there
        })
        .collect();
    (values, there)
}

fn field(column: &Column) -> anyhow::Result<Type> {
    let (physical, converted, repetition) = match column.of {
        Of::Count(_) => (Physical::INT64, ConvertedType::INT_64, Repetition::OPTIONAL),
        Of::Real(_) => (Physical::DOUBLE, ConvertedType::NONE, Repetition::OPTIONAL),
        Of::Text(_) => (Physical::BYTE_ARRAY, ConvertedType::UTF8, Repetition::REQUIRED),
    };
    Ok(Type::primitive_type_builder(column.name, physical)
        .with_converted_type(converted)
        .with_repetition(repetition)
        .build()?)
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;
    use wisdom_mission::Plan;

    use super::*;

    #[test]
    fn a_failed_run_reads_back_with_its_error_and_without_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.parquet");
        let policy = "most-interesting".parse().unwrap();
        let plan = Plan::new(vec![7, 8], &["pcr6".parse().unwrap()], &[policy]).unwrap();
        let rows: Vec<Row> =
            plan.cases().map(|case| Row::failed(&case, format!("no {}", case.seed))).collect();
        write(&path, &rows).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        let read: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(read.len(), 2);
        let place = |name: &str| COLUMNS.iter().position(|c| c.name == name).unwrap();
        assert_eq!(read[1].get_long(place("seed")).unwrap(), 8);
        assert_eq!(read[1].get_string(place("rule")).unwrap(), "pcr6");
        assert_eq!(read[1].get_string(place("error")).unwrap(), "no 8");
        assert!(read[1].get_double(place("distance_m")).is_err(), "there is none");
        assert_eq!(read[0].get_column_iter().count(), COLUMNS.len());
    }
}
