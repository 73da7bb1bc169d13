//! Known deviations from the paper: where it is silent or contradicts itself, and what is done here.

/// A known deviation or choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Deviation {
    /// What it is about.
    pub topic: &'static str,
    /// What the paper says, or that it says nothing.
    pub paper: &'static str,
    /// What is done here.
    pub here: &'static str,
}

const fn row(topic: &'static str, paper: &'static str, here: &'static str) -> Deviation {
    Deviation { topic, paper, here }
}

/// All that are known, in the order of the method: student, teachers, protocol.
pub static DEVIATIONS: &[Deviation] = &[
    row(
        "Student's hyper-parameters",
        "states batch size, depth and the critic's learning rate; not width, γ, the actor's learning rate, noise, \
         HER's k, or gradient steps per environment step",
        "the public HER configuration of OpenAI Baselines, with one environment worker",
    ),
    row(
        "States of the confidence score",
        "the mean over states drawn from D, without saying which or how many",
        "the start state of the coming episode; replayed states are a setting",
    ),
    row(
        "Choice of the goal",
        "sampling in proportion (Eq. 11) in one place, the goal of highest variance (section 5.2) in another",
        "in proportion; the highest is a setting",
    ),
    row(
        "One timestep of the window",
        "not defined",
        "one evaluation of the pool, every Δ episodes, skipped while the networks have not changed",
    ),
    row(
        "SPaCE's growth of the goal set",
        "reads as if the set grew with progress",
        "the set grows when progress stagnates, as in SPaCE's paper and code",
    ),
    row(
        "Hyper-parameters of baselines",
        "refers to official code",
        "the same student for all methods; official settings are a preset",
    ),
    row(
        "Control for the goal pool",
        "none",
        "HER-IID-pool draws uniformly from the same fixed pool: it separates choosing well from choosing from a pool",
    ),
    row(
        "Pool goals of the HandManipulate tasks",
        "does not say that these goals depend on the start: they hold the place where the object has settled",
        "goals of the pool keep the place of the start they were drawn for, also where they are set at another; fresh \
         goals (HER-IID, VDS) are of the start at hand",
    ),
    row(
        "Grids of ablations",
        "prints no values beyond n = 3, n = 10 and Δ = 1",
        "n of 3, 5, 10 and 20; Δ of 1, 2, 5, 10 and 50",
    ),
    row(
        "Evaluation",
        "not described in detail",
        "20 episodes with the greedy online policy, success at the last step; goals and starts depend on environment, \
         seed and evaluation alone",
    ),
    row(
        "Spread",
        "bands of standard deviations over seeds, ddof not stated",
        "ddof = 1 throughout; claims are judged by exact paired sign-flip tests, never by overlap of bands",
    ),
    row(
        "Action dimension of Fetch",
        "Table 1 prints 3",
        "4, as the environments take; the last moves the fingers, in FetchPickAndPlace only",
    ),
    row(
        "Hand tasks",
        "names HandManipulateBlock, -Pen and -Egg; its appendix B describes rotation goals without a position",
        "the suite `paper` follows the appendix, `paper-ids` the names",
    ),
    row(
        "Physics",
        "environments of the MuJoCo version of its time",
        "MuJoCo as named under versions, checked against recordings",
    ),
];
