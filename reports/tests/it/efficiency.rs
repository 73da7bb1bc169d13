//! Sample-efficiency curves, by hand.

use super::support::{key, write_run};
use reports::analysis::aggregate::Shared;
use reports::analysis::efficiency;
use reports::analysis::finals::Finals;
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
    let finals: Vec<Finals> = groups[..2].iter().map(|group| Finals::of(group, 1)).collect();
    let shared = Shared::of(&finals);
    assert_eq!(shared.environments, ["A", "B"]);
    let curves = efficiency::curves(&groups, &shared, resampling);
    assert_eq!(curves.len(), 1);
    let at = |share: f64| {
        let index = curves[0].shares.iter().position(|other| *other == share).unwrap();
        (curves[0].iqm[index], curves[0].intervals.as_ref().unwrap()[index])
    };
    assert_eq!(at(0.0), (0.0, (0.0, 0.0)));
    // A at 1,000 of 2,000 steps: 0.5 and 0.2; B at 500 of 1,000, halfway to 0.6 and 0.8: 0.3 and 0.4. The
    // middle two of four.
    assert!((at(0.5).0 - 0.35).abs() < 1e-12);
    // 1.0 and 0.4, not the 0.9 that one run alone goes on to; 0.6 and 0.8.
    let (iqm, (low, high)) = at(1.0);
    assert!((iqm - 0.7).abs() < 1e-12);
    assert!(low < iqm && iqm < high);
}

#[test]
fn curves_show_the_rate_itself_and_end_at_it() {
    let results = TempDir::new().unwrap();
    // Still rising at the end: a trailing mean of five evaluations would end at 0.6.
    let rates = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    for environment in ["A", "B"] {
        write_run(results.path(), &key(environment, "nova", "default", 0), &rates);
    }
    let store = Store::read(results.path()).unwrap();
    let groups = group::groups(&store, &catalogue());
    let groups: Vec<_> = groups.iter().collect();
    let finals: Vec<Finals> = groups.iter().map(|group| Finals::of(group, 5)).collect();
    let curves = efficiency::curves(&groups, &Shared::of(&finals), Resampling::default());
    for (share, iqm) in curves[0].shares.iter().zip(&curves[0].iqm) {
        assert!((share - iqm).abs() < 1e-12, "{iqm} at {share}");
    }
}
