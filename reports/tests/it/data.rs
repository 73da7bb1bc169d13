//! The data: the dictionary names every column, and Parquet holds what CSV holds.

use super::support::{key, write_run};
use polars::prelude::{CsvReader, DataFrame, ParquetReader, SerReader};
use reports::dictionary;
use reports::report::{self, Options};
use reports::store::layout;
use tempfile::TempDir;

fn names(frame: &DataFrame) -> Vec<&str> {
    frame.get_column_names().into_iter().map(|name| name.as_str()).collect()
}

#[test]
fn the_data_are_complete_and_described() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "teach", "default", 0), &[0.0, 0.5]);
    write_run(results.path(), &key("E", "vds", "default", 0), &[0.25]);
    write_run(results.path(), &key("E", "vds", "default", 1), &[]);
    report::write(results.path(), &Options::default()).unwrap();
    let folder = layout::report_dir(results.path());
    let open = |name: String| std::fs::File::open(folder.join(name)).unwrap();
    let text = std::fs::read_to_string(folder.join("DATA.md")).unwrap();
    let rows = [3, 3, 2, 2, 0, 0, 1, 11, 0, 0];
    assert_eq!(dictionary::FILES.len(), rows.len());
    for (data, rows) in dictionary::FILES.iter().zip(rows) {
        let csv: DataFrame = CsvReader::new(open(format!("{}.csv", data.name))).finish().unwrap();
        assert_eq!(csv.height(), rows, "{}", data.name);
        let is_teacher = |name: &&str| name.starts_with("teacher.");
        let described = data.columns.iter().map(|column| column.name).filter(|name| !is_teacher(name));
        let found = names(&csv).into_iter().filter(|name| !is_teacher(name));
        assert_eq!(found.collect::<Vec<_>>(), described.collect::<Vec<_>>(), "{}", data.name);
        if data.parquet {
            let parquet: DataFrame =
                ParquetReader::new(open(format!("{}.parquet", data.name))).finish().unwrap();
            assert_eq!((parquet.shape(), names(&parquet)), (csv.shape(), names(&csv)));
            assert!(parquet.column("seed").unwrap().u64().is_ok());
        }
        for column in data.columns {
            assert!(text.contains(&format!("| `{}` | {} | {} |", column.name, column.kind, column.meaning)));
        }
    }
}

#[test]
fn the_numbers_of_a_run_by_hand() {
    let results = TempDir::new().unwrap();
    write_run(results.path(), &key("E", "teach", "default", 0), &[0.0, 0.5, 1.0]);
    report::write(results.path(), &Options { window: 2, ..Options::default() }).unwrap();
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
    assert!(page.contains("<td class=\"number\">0.75 [0.60, 0.86]</td>"), "on the page too");
    // 2,000 steps take 3,600 s, of which the teacher has a fifth and learning half.
    assert_eq!(["wall_hours", "teacher_hours", "learning_hours"].map(field), ["1.0", "0.2", "0.5"]);
}
