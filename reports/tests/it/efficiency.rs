//! Sample-efficiency curves, by hand.

use super::support::{key, write_run};
use reports::analysis::efficiency;
use reports::analysis::group;
use reports::stats::Resampling;
use reports::store::Store;
use reports::synthetic::catalogue;
use tempfile::TempDir;

#[test]
fn curves_end_where_every_run_has_been() {
    let results = TempDir::new().unwrap();
    let write = |environment: &str, seed: u64, rates: &[f64]| {
        write_run(results.path(), &key(environment, "nova", "default", seed), rates);
    };
    write("A", 0, &[0.0, 0.5, 1.0]);
    write("A", 1, &[0.0, 0.2, 0.4, 0.9]);
    write("B", 0, &[0.0, 0.6]);
    write("B", 1, &[0.0, 0.8]);
    write("C", 0, &[1.0, 1.0]);
    let store = Store::read(results.path()).unwrap();
    let groups = group::groups(&store, &catalogue());
    let groups: Vec<_> = groups.iter().collect();
    let resampling = Resampling { resamples: 200, ..Resampling::default() };
    let curves = efficiency::curves(&groups, &["A", "B"], 1, resampling);
    assert_eq!(curves.len(), 1);
    let at = |share: f64| {
        let index = curves[0].shares.iter().position(|other| *other == share).unwrap();
        (curves[0].iqm[index], curves[0].intervals.as_ref().unwrap()[index])
    };
    assert_eq!(at(0.0), (0.0, (0.0, 0.0)));
    // A at 1,000 of 2,000 steps: 0.5 and 0.2; B at 500 of 1,000: still 0 and 0. The middle two of four.
    assert!((at(0.5).0 - 0.1).abs() < 1e-12);
    // 1.0 and 0.4, not the 0.9 that one run alone goes on to; 0.6 and 0.8.
    let (iqm, (low, high)) = at(1.0);
    assert!((iqm - 0.7).abs() < 1e-12);
    assert!(low < iqm && iqm < high);
}
