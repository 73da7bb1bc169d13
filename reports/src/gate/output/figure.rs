//! Curves of the baseline and now, a panel per cell.

use super::Check;
use crate::analysis::catalogue::Catalogue;
use crate::analysis::curves::{Curve, DDOF, Point, Progress};
use crate::analysis::group::GroupKey;
use crate::gate::cells::Cell;
use crate::gate::error::GateError;
use crate::render::figure::{LearningPanel, Style, learning};
use crate::stats;

/// An SVG with a panel per cell, the cells of a curriculum side by side.
///
/// # Errors
/// [`GateError::Figure`] if drawing fails.
pub fn figure(check: &Check<'_>) -> Result<String, GateError> {
    let catalogue = check.catalogue;
    let mut cells: Vec<(&Cell, &Cell)> = check.before.iter().zip(check.now).collect();
    // Stable: environments stay in the protocol's order.
    cells.sort_by_cached_key(|(_, now)| catalogue.method(&now.curriculum));
    let pairs: Vec<(String, [Curve; 2])> = cells
        .into_iter()
        .map(|(before, now)| {
            let variant =
                if now.variant == "default" { String::new() } else { format!(" ({})", now.variant) };
            let title = format!("{}, {}{variant}", now.environment, catalogue.title(&now.curriculum));
            (title, [curve(catalogue, now, "now"), curve(catalogue, before, "baseline")])
        })
        .collect();
    let panels: Vec<LearningPanel<'_>> = pairs
        .iter()
        .map(|(title, curves)| LearningPanel { title: title.clone(), curves: curves.iter().collect() })
        .collect();
    let keys = pairs.iter().flat_map(|(_, curves)| curves).map(|curve| &curve.key);
    Ok(learning(&panels, &Style::new(keys), Progress::EnvironmentSteps)?)
}

/// The mean curve of a cell, labelled as its `side`.
fn curve(catalogue: &Catalogue, cell: &Cell, side: &str) -> Curve {
    let rates: Vec<Vec<f64>> = cell.curves.values().map(|curve| curve.rates(cell.episodes)).collect();
    let point = |(index, &step): (usize, &u64)| {
        let at: Vec<f64> = rates.iter().map(|rates| rates[index]).collect();
        Some(Point {
            step,
            n: at.len(),
            mean: stats::mean(&at)?,
            std: stats::std_dev(&at, DDOF),
            ..Point::default()
        })
    };
    Curve {
        key: GroupKey::new(catalogue, &cell.environment, &cell.curriculum, side),
        points: cell.steps.iter().enumerate().filter_map(point).collect(),
        episodes: (cell.episodes, cell.episodes),
        interpolated: false,
        failed: 0,
    }
}
