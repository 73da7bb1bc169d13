//! The data: the dictionary names every column, and Parquet holds what CSV holds.

use super::footer;
use super::support::{key, options, write_run};
use polars::prelude::{CsvReader, DataFrame, ParquetReader, SerReader};
use reports::ReportOptions;
use reports::store::layout;
use tempfile::TempDir;

fn names(frame: &DataFrame) -> Vec<&str> {
    frame.get_column_names().into_iter().map(|name| name.as_str()).collect()
}

/// The columns that `DATA.md` names for the file `name`, and whether it says that there is Parquet.
fn described(text: &str, name: &str) -> (Vec<String>, bool) {
    let section = text.split("\n## ").find(|section| section.starts_with(&format!("{name}.csv"))).unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next());
    (rows.map(str::to_owned).collect(), section.starts_with(&format!("{name}.csv, {name}.parquet:")))
}

#[test]
fn the_data_are_complete_and_described() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5]);
    write_run(results.path(), &key("E", "wren", "default", 0), &[0.25]);
    write_run(results.path(), &key("E", "wren", "default", 1), &[]);
    reports::write(results.path(), &options()).unwrap();
    let folder = layout::report_dir(results.path());
    let open = |name: String| std::fs::File::open(folder.join(name)).unwrap();
    let text = std::fs::read_to_string(folder.join("DATA.md")).unwrap();
    let files = [
        ("records", 3),
        ("runs", 3),
        ("student", 0),
        ("measures", 0),
        ("shadows", 0),
        ("reliability", 0),
        ("judgements", 0),
        ("summary", 2),
        ("variants", 0),
        ("costs", 2),
        ("teaching", 0),
        ("frontier", 0),
        ("coverage", 0),
        ("calibration", 0),
        ("progress", 0),
        ("agreement", 0),
        ("aggregates", 0),
        ("comparisons", 1),
        ("ledger", 15),
        ("ledger-elsewhere", 0),
        ("readings", 0),
        ("tuning", 0),
        ("sensitivity", 0),
        ("trials", 0),
        ("environments", 0),
    ];
    assert_eq!(text.matches("\n## ").count(), files.len());
    for (name, rows) in files {
        let csv: DataFrame = CsvReader::new(open(format!("{name}.csv"))).finish().unwrap();
        assert_eq!(csv.height(), rows, "{name}");
        let (columns, has_parquet) = described(&text, name);
        let is_teacher = |name: &&str| name.starts_with("teacher.");
        let described = columns.iter().map(String::as_str).filter(|name| !is_teacher(name));
        let found = names(&csv).into_iter().filter(|name| !is_teacher(name));
        assert_eq!(found.collect::<Vec<_>>(), described.collect::<Vec<_>>(), "{name}");
        if has_parquet {
            let parquet: DataFrame = ParquetReader::new(open(format!("{name}.parquet"))).finish().unwrap();
            assert_eq!((parquet.shape(), names(&parquet)), (csv.shape(), names(&csv)));
            // Bins are of several seeds; those without a row per run have no seed.
            let count = ["seed", "steps"].into_iter().find(|count| names(&parquet).contains(count));
            assert_eq!(count.is_none(), name == "reliability");
            assert!(count.is_none_or(|count| parquet.column(count).unwrap().u64().is_ok()), "{name}");
        }
    }
    assert!(described(&text, "records").1 && described(&text, "runs").1 && !described(&text, "summary").1);
}

#[test]
fn records_have_a_row_per_evaluation() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "wren", "default", 0), &[0.0, 0.5]);
    write_run(results.path(), &key("E", "nova", "default", 10), &[0.25]);
    write_run(results.path(), &key("E", "nova", "default", 9), &[0.75]);
    reports::write(results.path(), &options()).unwrap();
    let file = std::fs::File::open(layout::report_dir(results.path()).join("records.parquet")).unwrap();
    let frame: DataFrame = ParquetReader::new(file).finish().unwrap();
    assert_eq!(frame.shape(), (4, 15));
    let numbers = |name: &str| frame.column(name).unwrap().f64().unwrap().to_vec();
    assert_eq!(numbers("success_rate"), [0.75, 0.25, 0.0, 0.5].map(Some));
    assert_eq!(numbers("any_success_rate"), [0.8, 0.3, 0.05, 0.55].map(Some));
    assert_eq!(numbers("teacher.entropy"), [0.0, 0.0, 0.0, 1.0].map(Some));
    assert_eq!(frame.column("teacher.undefined").unwrap().null_count(), 4);
}

#[test]
fn text_in_parquet_is_a_string_to_all_readers() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "wren", "ARROW:schema", 0), &[0.0, 0.5]);
    reports::write(results.path(), &options()).unwrap();
    for name in ["records", "runs"] {
        let path = layout::report_dir(results.path()).join(format!("{name}.parquet"));
        let mut reader = ParquetReader::new(std::fs::File::open(&path).unwrap());
        // A reader of Arrow would take text for the `string_view` that polars notes there.
        let notes = reader.get_metadata().unwrap().key_value_metadata().clone().unwrap_or_default();
        assert!(notes.iter().all(|note| note.key != "ARROW:schema"), "{notes:?}");
        let frame = reader.finish().unwrap();
        assert_eq!(frame.column("variant").unwrap().str().unwrap().get(0), Some("ARROW:schema"));
        assert!(frame.column("seed").unwrap().u64().is_ok());
    }
}

#[test]
fn the_numbers_of_a_run_by_hand() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "nova", "default", 0), &[0.0, 0.5, 1.0]);
    reports::write(results.path(), &ReportOptions { window: 2, ..options() }).unwrap();
    let csv = std::fs::read_to_string(layout::report_dir(results.path()).join("runs.csv")).unwrap();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let (header, row) = (lines.next().unwrap(), lines.next().unwrap());
    let field = |name: &str| row[header.iter().position(|other| *other == name).unwrap()];
    assert_eq!(["final_success", "final_successes", "final_episodes"].map(field), ["0.75", "30", "40"]);
    // Wilson: (p + z²/2n ± z √(p(1-p)/n + z²/4n²)) / (1 + z²/n) with p = 3/4, n = 40, z = 1.959964.
    for (name, expected) in [("final_ci_low", 0.598_060), ("final_ci_high", 0.858_129)] {
        assert!((field(name).parse::<f64>().unwrap() - expected).abs() < 1e-6, "{name}: {}", field(name));
    }
    let page = std::fs::read_to_string(layout::report_dir(results.path()).join("index.html")).unwrap();
    assert!(
        page.contains("<td class=\"number\" data-title=\"Final success\">0.75 [0.60, 0.86]</td>"),
        "on the page too"
    );
    // 2,000 steps take 3,600 s, of which the teacher has a fifth and learning half.
    assert_eq!(["wall_hours", "teacher_hours", "learning_hours"].map(field), ["1.0", "0.2", "0.5"]);
}

#[test]
fn parquet_keeps_to_what_all_readers_know() {
    use polars::prelude::*;
    let results = TempDir::new().unwrap();
    for seed in 0..3 {
        write_run(results.path(), &key("E", "wren", "default", seed), &[0.0, 0.5]);
    }
    reports::write(results.path(), &options()).unwrap();
    for name in ["records", "runs"] {
        let path = layout::report_dir(results.path()).join(format!("{name}.parquet"));
        let mut reader = ParquetReader::new(std::fs::File::open(&path).unwrap());
        let metadata = reader.get_metadata().unwrap().clone();
        let (mut text, mut numbers) = (0, 0);
        for column in metadata.row_groups.iter().flat_map(|group| group.parquet_columns()) {
            let said = format!("{:?}", column.descriptor().descriptor.primitive_type);
            // Text is a `string`, numbers have 64 bits.
            match said {
                said if said.contains("ByteArray") => {
                    assert!(said.contains("String") || said.contains("Utf8"), "{name}: {said}");
                    text += 1;
                }
                said => {
                    assert!(said.contains("Int64") || said.contains("Double"), "{name}: {said}");
                    numbers += 1;
                }
            }
        }
        assert!(text > 2 && numbers > 4, "{name}: {text} and {numbers}");
        // Those that readers have had from the beginning: PLAIN, PLAIN_DICTIONARY, RLE and RLE_DICTIONARY.
        let encodings = footer::encodings(&std::fs::read(&path).unwrap());
        assert_eq!(encodings.len(), text + numbers);
        let known = |encoding: &i64| [0, 2, 3, 8].contains(encoding);
        assert!(encodings.iter().flatten().all(known), "{name}: {encodings:?}");
    }
}
