//! The data dictionary: what every column of the tidy data and of the tables' numbers means.

use crate::analysis::comparison::{ALPHA, TARGET_POWER};
use crate::report::Options;

/// A column of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: &'static str,
    /// Its meaning, with unit.
    pub meaning: &'static str,
}

const fn column(name: &'static str, kind: &'static str, meaning: &'static str) -> Column {
    Column { name, kind, meaning }
}

/// A file of the report, or two of the same content.
#[derive(Clone, Copy, Debug)]
pub struct Data {
    /// Its name, without extension.
    pub name: &'static str,
    /// Whether there is a Parquet file beside the CSV.
    pub parquet: bool,
    /// What a row stands for.
    pub row: &'static str,
    /// All columns, in order; `teacher.NAME` stands for one column per number of teachers.
    pub columns: &'static [Column],
}

const ENVIRONMENT: Column = column("environment", "string", "environment id");
const CURRICULUM: Column = column("curriculum", "string", "curriculum id");
const VARIANT: Column =
    column("variant", "string", "label of the protocol's variant, `default` where it has none");
const SEED: Column = column(
    "seed",
    "u64",
    "run seed; runs of one environment and seed share initial weights and evaluation goals",
);
const SEEDS: Column = column("n_seeds", "u64", "seeds with at least one evaluation");

/// Every file of data, the tidy ones first.
pub static FILES: &[Data] = &[
    Data { name: "records", parquet: true, row: "evaluation", columns: RECORDS },
    Data { name: "runs", parquet: true, row: "run", columns: RUNS },
    Data { name: "summary", parquet: false, row: "environment, curriculum and variant", columns: SUMMARY },
    Data { name: "costs", parquet: false, row: "environment, curriculum and variant", columns: COSTS },
    Data { name: "teaching", parquet: false, row: "environment, curriculum and variant", columns: TEACHING },
    Data {
        name: "aggregates",
        parquet: false,
        row: "method over the shared environments",
        columns: AGGREGATES,
    },
    Data { name: "comparisons", parquet: false, row: "method and its reference", columns: COMPARISONS },
    Data { name: "ledger", parquet: false, row: "claim of the paper", columns: LEDGER },
    Data { name: "readings", parquet: false, row: "claim and reading of the paper", columns: READINGS },
    Data { name: "environments", parquet: false, row: "environment", columns: ENVIRONMENTS },
];

static RECORDS: &[Column] = &[
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    SEED,
    column("step", "u64", "training steps taken in the environment, evaluation steps not counted"),
    column("eval_index", "u64", "index of the evaluation; 0 is the untrained student"),
    column("episodes", "u64", "episodes in this evaluation"),
    column("success_rate", "f64", "share of them that ended in success, in [0, 1]"),
    column(
        "any_success_rate",
        "f64",
        "share of them that were successful after at least one of their actions; empty where the run is older than the \
         field",
    ),
    column("mean_return", "f64", "mean over episodes of the sum of rewards, in [-H, 0]"),
    column("gradient_steps", "u64", "gradient steps taken by the student"),
    column("teacher.NAME", "f64", "number that the teacher recorded; empty where it is not defined"),
];

static RUNS: &[Column] = &[
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    SEED,
    column("status", "string", "`finished`, `failed` or `unfinished`"),
    column("evaluations", "u64", "evaluations that could be used"),
    column("step", "u64", "training steps at the last of them; empty without one"),
    column("gradient_steps", "u64", "gradient steps of the student at the last of them"),
    column("final_success", "f64", "success rate averaged over the last evaluations"),
    column("final_successes", "u64", "successes in these evaluations"),
    column("final_episodes", "u64", "episodes in these evaluations"),
    column(
        "final_ci_low",
        "f64",
        "lower end of Wilson's interval of final_successes / final_episodes: noise of evaluating this run, not of seeds",
    ),
    column("final_ci_high", "f64", "its upper end"),
    column("wall_hours", "f64", "hours of wall-clock time up to the last evaluation; empty without timings"),
    column("evaluation_hours", "f64", "hours of it spent in evaluations"),
    column(
        "teacher_hours",
        "f64",
        "hours of it spent in the teacher: proposing goals, observing episodes, learning; empty where timings do not \
         tell",
    ),
    column("learning_hours", "f64", "hours of it spent in the student's gradient steps; likewise"),
    column("config_hash", "string", "hash of the complete config"),
    column("versions", "string", "versions of goalbench and its native libraries"),
];

static SUMMARY: &[Column] = &[
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    SEEDS,
    column("final_mean", "f64", "mean over seeds of the final success"),
    column("final_std", "f64", "its standard deviation over seeds, ddof = 1; empty for one seed"),
    column(
        "final_any_mean",
        "f64",
        "mean over seeds of the final success at any step of an episode; empty where a seed has no record of it",
    ),
    column("final_iqm", "f64", "interquartile mean over seeds of the final success"),
    column("final_ci_low", "f64", "lower end of the bootstrap interval of final_iqm; empty for one seed"),
    column("final_ci_high", "f64", "its upper end"),
    column(
        "auc_mean",
        "f64",
        "mean over seeds of the area under the success rate, divided by the steps it spans",
    ),
    column("auc_std", "f64", "its standard deviation over seeds, ddof = 1"),
    column(
        "steps_to_50",
        "u64",
        "step by which half of the seeds had a mean success of 0.5 over the last evaluations; empty where censored",
    ),
    column("steps_to_80", "u64", "the same for 0.8"),
    column("wall_hours", "f64", "mean over seeds of the hours of wall-clock time up to the last evaluation"),
    column("gradient_steps", "f64", "mean over seeds of the student's gradient steps"),
];

static COSTS: &[Column] = &[
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    SEEDS,
    column("steps_min", "u64", "fewest training steps at a seed's last evaluation"),
    column("steps_max", "u64", "most of them"),
    column("gradient_steps", "f64", "mean over seeds of the student's gradient steps"),
    column("wall_hours", "f64", "mean over seeds of the hours of wall-clock time; empty without timings"),
    column("teacher_hours", "f64", "hours of it spent in the teacher; empty where timings do not tell"),
    column("learning_hours", "f64", "hours of it spent in the student's gradient steps; likewise"),
    column("evaluation_hours", "f64", "hours of it spent in evaluations"),
];

static TEACHING: &[Column] = &[
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    SEEDS,
    column(
        "picked_goals",
        "f64",
        "distinct goals of the pool picked since the evaluation before, mean over evaluations and seeds; empty, as are \
         the following, where no teacher records it",
    ),
    column("effective_picks", "f64", "exponential of the entropy of the picks since then; likewise"),
    column("effective_goals", "f64", "exponential of the entropy of the curriculum; likewise"),
    column(
        "pick_rank_mean",
        "f64",
        "mean over episodes of the goal's rank (0 for the first) over the highest rank, 0.5 for fair turns; likewise",
    ),
    column(
        "score_success_correlation",
        "f64",
        "correlation over episodes of the teacher's score of the goal with success at it; likewise",
    ),
];

static AGGREGATES: &[Column] = &[
    CURRICULUM,
    VARIANT,
    column("environments", "u64", "environments that all methods of the file have"),
    column("runs", "u64", "runs in them"),
    column("mean", "f64", "mean over environments of the mean final success over seeds"),
    column("iqm", "f64", "interquartile mean of the final success of all runs"),
    column("iqm_ci_low", "f64", "lower end of its bootstrap interval, stratified by environment"),
    column("iqm_ci_high", "f64", "its upper end"),
    column("optimality_gap", "f64", "mean over runs of what the final success lacks to 1"),
    column("optimality_gap_ci_low", "f64", "lower end of its bootstrap interval, stratified by environment"),
    column("optimality_gap_ci_high", "f64", "its upper end"),
];

static COMPARISONS: &[Column] = &[
    column("family", "string", "`methods` or `variants`: the comparisons that p_holm corrects for together"),
    ENVIRONMENT,
    CURRICULUM,
    VARIANT,
    column("reference_curriculum", "string", "curriculum id of the reference"),
    column("reference_variant", "string", "variant of the reference"),
    column("n_seeds", "u64", "finished runs of the same evaluations"),
    column("n_reference", "u64", "the same for the reference"),
    column("runs_left_out", "u64", "runs of both that are not finished or were evaluated at other steps"),
    column("n_pairs", "u64", "seeds that both have"),
    column("difference", "f64", "mean over pairs of the difference of final success, method minus reference"),
    column("difference_ci_low", "f64", "lower end of its paired bootstrap interval"),
    column("difference_ci_high", "f64", "its upper end"),
    column(
        "sign_flip_p",
        "f64",
        "two-sided p-value of the exact sign-flip test of these pairs, uncorrected; not below 2^(1 - n_pairs)",
    ),
    column("probability_of_improvement", "f64", "P(run of the method > run of the reference), ties one half"),
    column("welch_t", "f64", "t of Welch's test of equal means; empty where neither side varies"),
    column("welch_df", "f64", "its degrees of freedom"),
    column("welch_p", "f64", "its two-sided p-value, uncorrected"),
    column("p_holm", "f64", "the p-value corrected by Holm's method for all comparisons of its family"),
    column("effect_size", "f64", "Cohen's d"),
    column(
        "level",
        "f64",
        "0.05 over the tests of the family: the strictest level that Holm's method asks for",
    ),
    column(
        "power",
        "f64",
        "power of the t-test at that level to find an effect of that size with the seeds at hand",
    ),
    column("needed_seeds", "u64", "seeds on each side to find it; empty above 10,000"),
];

static LEDGER: &[Column] = &[
    column("claim", "string", "short name"),
    column("source", "string", "figure of the paper"),
    column("statement", "string", "the claim as a testable statement"),
    column("verdict", "string", "`confirmed`, `refuted` or `undecided`"),
    column("value", "string", "the value whose effect decides, where the claim is about several; else empty"),
    column("effect", "f64", "difference of success rates that decides, mean over environments"),
    column(
        "ci_low",
        "f64",
        "lower end of the interval that the sign-flip test does not refuse; empty for too few pairs",
    ),
    column("ci_high", "f64", "its upper end"),
    column("confidence", "f64", "coverage of that interval after Bonferroni's correction"),
    column("p", "f64", "two-sided p-value of the sign-flip test of no difference, uncorrected"),
    column("environments", "u64", "environments with enough pairs"),
    column("environments_ahead", "u64", "those of them where the mean difference is above 0"),
    column("environments_behind", "u64", "those of them where it is below 0"),
    column("pairs", "u64", "pairs of runs with the same seed in them"),
    column("runs_left_out", "u64", "runs that are not finished or were evaluated at other steps"),
    column("evidence", "string", "all effects in words, or what is missing"),
    column("rule", "string", "when the claim counts as confirmed or refuted"),
];

static READINGS: &[Column] = &[
    column("claim", "string", "short name, as in the ledger"),
    column(
        "family",
        "string",
        "what TEACH's other settings, the same for all readings of a family, have apart from the default ones; empty \
         for those",
    ),
    column("reading", "u64", "number of the reading, the same for all claims of its family"),
    column(
        "settings",
        "string",
        "the settings that the reading is named by, and in parentheses those that gave the same runs",
    ),
    column("verdict", "string", "`confirmed`, `refuted` or `undecided`, by the ledger's rule"),
    column("effect", "f64", "difference of success rates under this reading, mean over environments"),
    column(
        "ci_low",
        "f64",
        "lower end of the interval that the sign-flip test does not refuse; empty for too few pairs",
    ),
    column("ci_high", "f64", "its upper end"),
    column(
        "confidence",
        "f64",
        "coverage of that interval after Bonferroni's correction for the claim's readings",
    ),
    column("p", "f64", "two-sided p-value of the sign-flip test of no difference, uncorrected"),
    column("environments", "u64", "environments with enough pairs"),
    column("environments_ahead", "u64", "those of them where the mean difference is above 0"),
    column("environments_behind", "u64", "those of them where it is below 0"),
    column("pairs", "u64", "pairs of runs with the same seed in them"),
    column("runs_left_out", "u64", "runs that are not finished or were evaluated at other steps"),
    column("evidence", "string", "what the verdict rests on, or what is missing for one"),
    column("conclusion", "string", "whether the claim's verdict is the same under all readings"),
];

static ENVIRONMENTS: &[Column] = &[
    ENVIRONMENT,
    column("state", "u64", "dimension of the state"),
    column("goal", "u64", "dimension of the goal"),
    column("action", "u64", "dimension of the action"),
    column(
        "paper_action",
        "u64",
        "dimension of the action that the paper prints; empty where it prints no other one",
    ),
    column("horizon", "u64", "steps per episode"),
    column("note", "string", "why they differ"),
];

/// The dictionary as Markdown, for a report made with `options`.
pub fn markdown(options: &Options) -> String {
    let row = |column: &Column| format!("| `{}` | {} | {} |\n", column.name, column.kind, column.meaning);
    let file = |data: &Data| {
        let Data { name, parquet, row: one, columns } = data;
        let names = if *parquet { format!("{name}.csv, {name}.parquet") } else { format!("{name}.csv") };
        let rows: String = columns.iter().map(row).collect();
        format!("\n## {names}: one row per {one}\n\n| Column | Type | Meaning |\n| --- | --- | --- |\n{rows}")
    };
    format!(
        "# Data dictionary\n\nThe numbers behind the report, unrounded. CSV and Parquet of one name hold the same; an \
         empty field of a CSV is null in Parquet. Final success: over the last {} evaluations of a run. Intervals: {} \
         %, bootstrap with {} resamples where not said otherwise. Power: at level {ALPHA} over the number of tests, needed \
         seeds for a power of {TARGET_POWER}.\n{}",
        options.window,
        options.resampling.confidence * 100.0,
        options.resampling.resamples,
        FILES.iter().map(file).collect::<String>(),
    )
}
