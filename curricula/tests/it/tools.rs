//! Mixtures, densities and assignments agree with scikit-learn and SciPy. The fixtures say on top which
//! function made them and from what; `harness/docs/curricula.md` says how.

use curricula::{KernelDensity, Mixture, assignment};
use envs::Rows;
use serde::Deserialize;
use serde::de::DeserializeOwned;

const MIXTURE: &str = include_str!("fixtures/mixture.toml");
const DENSITY: &str = include_str!("fixtures/density.toml");
const ASSIGNMENT: &str = include_str!("fixtures/assignment.toml");

fn read<F: DeserializeOwned>(text: &str) -> F {
    toml::from_str(text).expect("a fixture")
}

fn rows(numbers: &[Vec<f64>]) -> Rows {
    let mut rows = Rows::new(numbers[0].len());
    numbers.iter().for_each(|row| rows.push(row));
    rows
}

/// Whether two numbers agree to 1e-9, relative where they are large.
fn agree(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * b.abs().max(1.0)
}

#[derive(Deserialize)]
struct MixtureFixture {
    points: Vec<Vec<f64>>,
    fit: Vec<Fit>,
}

#[derive(Deserialize)]
struct Fit {
    k: usize,
    assignment: Vec<usize>,
    weights: Vec<f64>,
    means: Vec<Vec<f64>>,
    covariances: Vec<Vec<f64>>,
    log_likelihood: f64,
    aic: f64,
}

#[test]
fn a_mixture_is_the_one_that_scikit_learn_fits_from_the_same_clusters() {
    let MixtureFixture { points, fit } = read(MIXTURE);
    let points = rows(&points);
    let d = points.width();
    assert_eq!(fit.len(), 3);
    for expected in fit {
        let k = expected.k;
        let (mixture, log_likelihood) =
            Mixture::from_assignment(&points, &expected.assignment, k).expect("a mixture");
        assert!(agree(log_likelihood, expected.log_likelihood), "{k}: {log_likelihood}");
        assert!(agree(mixture.aic(log_likelihood), expected.aic), "{k}: {}", mixture.aic(log_likelihood));
        assert_eq!(mixture.components.len(), k);
        for (i, component) in mixture.components.iter().enumerate() {
            assert!(agree(component.weight, expected.weights[i]), "{k}, {i}: {}", component.weight);
            for a in 0..d {
                assert!(agree(component.mean[a], expected.means[i][a]), "{k}, {i}: {:?}", component.mean);
                for b in 0..d {
                    let (ours, theirs) = (component.covariance(a, b), expected.covariances[i][a * d + b]);
                    assert!(agree(ours, theirs), "{k}, {i}, {a}, {b}: {ours}, not {theirs}");
                }
            }
        }
    }
}

#[derive(Deserialize)]
struct Cases<C> {
    case: Vec<C>,
}

#[derive(Deserialize)]
struct DensityCase {
    bandwidth: f64,
    points: Vec<Vec<f64>>,
    at: Vec<Vec<f64>>,
    log_densities: Vec<f64>,
}

#[test]
fn log_densities_are_those_of_scikit_learn() {
    let Cases { case } = read::<Cases<DensityCase>>(DENSITY);
    assert_eq!(case.len(), 3);
    for DensityCase { bandwidth, points, at, log_densities } in case {
        let mut density = KernelDensity::new(&rows(&points), bandwidth);
        for (at, expected) in at.iter().zip(log_densities) {
            let ours = density.log_at(at);
            assert!(agree(ours, expected), "{} dimensions: {ours}, not {expected}", at.len());
        }
    }
}

#[derive(Deserialize)]
struct AssignmentCase {
    costs: Vec<Vec<f64>>,
    columns: Vec<usize>,
    sum: f64,
}

#[test]
fn pairs_of_least_cost_are_those_of_scipy() {
    let Cases { case } = read::<Cases<AssignmentCase>>(ASSIGNMENT);
    assert_eq!(case.len(), 4);
    for AssignmentCase { costs, columns, sum } in case {
        let pairs = assignment(&rows(&costs));
        let ours: f64 = pairs.iter().zip(&costs).map(|(&column, row)| row[column]).sum();
        assert!(agree(ours, sum), "{ours}, not {sum}");
        assert_eq!(pairs, columns);
    }
}
