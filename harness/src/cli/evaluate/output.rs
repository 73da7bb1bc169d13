//! What `goalbench evaluate` prints.

use reports::schema::RunKey;
use reports::stats::{Ddof, mean, std_dev, wilson_interval};
use serde::Serialize;

use super::Measured;
use crate::pace;

/// Coverage of the intervals.
const CONFIDENCE: f64 = 0.95;

impl Measured {
    /// Wilson's interval of the probability of success.
    fn interval(&self) -> (f64, f64) {
        wilson_interval(self.tally.successes, self.tally.episodes, CONFIDENCE).expect("there are episodes")
    }

    /// What seeds are averaged over.
    fn group(&self) -> (&std::path::Path, &str, &str, &str) {
        let RunKey { environment, curriculum, variant, .. } = &self.run;
        (&self.results, environment, curriculum, variant)
    }
}

/// A line of `--json`.
#[derive(Serialize)]
struct Line<'a> {
    #[serde(flatten)]
    run: &'a RunKey,
    folder: String,
    step: u64,
    steps: u64,
    episode_seed: u64,
    episodes: u64,
    successes: u64,
    success_rate: f64,
    ci_low: f64,
    ci_high: f64,
    mean_return: f64,
}

/// A JSON object per run and line. `seed` is that of the episodes.
pub(super) fn as_json(measured: &[Measured], seed: u64) -> String {
    let line = |one: &Measured| {
        let (score, (ci_low, ci_high)) = (one.tally.score(), one.interval());
        let line = Line {
            run: &one.run,
            folder: one.folder.display().to_string(),
            step: one.step,
            steps: one.steps,
            episode_seed: seed,
            episodes: one.tally.episodes,
            successes: one.tally.successes,
            success_rate: score.success_rate,
            ci_low,
            ci_high,
            mean_return: score.mean_return,
        };
        serde_json::to_string(&line).expect("a line is plain data") + "\n"
    };
    measured.iter().map(line).collect()
}

/// A table of runs, and one of means over seeds where there are several; for each results folder if there are
/// several.
pub(super) fn as_text(measured: &[Measured]) -> String {
    let sections: Vec<&[Measured]> = measured.chunk_by(|a, b| a.results == b.results).collect();
    let texts = sections.iter().map(|section| {
        let head = format!("{}\n", section[0].results.display());
        let head = if sections.len() > 1 { head } else { String::new() };
        head + &table(section) + &summary(section)
    });
    texts.collect::<Vec<_>>().join("\n")
}

fn table(measured: &[Measured]) -> String {
    let mut text = format!(
        "{:<52} {:>17} {:>8} {:>9} {:>8}  {:<15} {:>11}\n",
        "run", "step", "episodes", "successes", "success", "95 % interval", "mean return"
    );
    for one in measured {
        let (score, (low, high)) = (one.tally.score(), one.interval());
        text += &format!(
            "{:<52} {:>17} {:>8} {:>9} {:>8.4}  {low:.4}-{high:.4}   {:>11.3}\n",
            one.run.to_string(),
            pace::of_steps(one.step, one.steps),
            one.tally.episodes,
            one.tally.successes,
            score.success_rate,
            score.mean_return,
        );
    }
    text
}

/// Means over seeds, of runs that are configured alike; nothing where every run is the only one of its kind.
fn summary(measured: &[Measured]) -> String {
    let measured: Vec<&Measured> = measured.iter().filter(|one| !one.is_odd).collect();
    let groups: Vec<&[&Measured]> =
        measured.chunk_by(|a, b| a.group() == b.group()).filter(|group| group.len() > 1).collect();
    if groups.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "\nmean ± standard deviation over seeds (ddof {})\n{:<52} {:>17} {:>8} {:>18}  {:>19}\n",
        Ddof::Sample,
        "environment/curriculum/variant",
        "step",
        "seeds",
        "success",
        "mean return"
    );
    for group in groups {
        let RunKey { environment, curriculum, variant, .. } = &group[0].run;
        let scores: Vec<_> = group.iter().map(|one| one.tally.score()).collect();
        let spread = |values: Vec<f64>, digits: usize| {
            let middle = mean(&values).expect("there are seeds");
            let deviation = std_dev(&values, Ddof::Sample).expect("there is more than one seed");
            format!("{middle:.digits$} ± {deviation:.digits$}")
        };
        text += &format!(
            "{:<52} {:>17} {:>8} {:>18}  {:>19}\n",
            format!("{environment}/{curriculum}/{variant}"),
            steps(group),
            group.len(),
            spread(scores.iter().map(|score| score.success_rate).collect(), 4),
            spread(scores.iter().map(|score| score.mean_return).collect(), 3),
        );
    }
    text
}

/// Training steps behind the policies of `group`: one number, or the lowest and highest where seeds differ.
fn steps(group: &[&Measured]) -> String {
    let all = || group.iter().map(|one| one.step);
    match (all().min(), all().max()) {
        (Some(low), Some(high)) if low < high => format!("{low}-{high}"),
        (low, _) => low.unwrap_or_default().to_string(),
    }
}
