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
        "Input normalisers",
        "not described",
        "running means and standard deviations that begin with one pseudo-observation of 0, as in OpenAI Baselines",
    ),
    row(
        "States of the confidence score",
        "the mean over D, the replay buffer's state distribution (said after Eq. 6), without saying over how many states",
        "8 reference states, drawn from the replay buffer and held, so that a window never compares values of different \
         states; renewed every 100 evaluations with a hand-over, during which both sets are measured; fresh draws \
         (`replay`) and the start of the coming episode (`initial`) are settings",
    ),
    row("Range of the confidence score", "Eq. 7 sets no bounds", "TEACH's confidence is not clipped"),
    row(
        "Smoothed confidence",
        "section 5.4 and Eq. 12 speak of a smoothed value function, not of a smoothed policy",
        "the target critic about the online policy's actions (`target-critic`); target critic and target policy \
         (`target`) are a setting",
    ),
    row(
        "Choice of the goal",
        "sampling in proportion (Eq. 11) in one place, the goal of highest variance (section 5.2) in another",
        "in proportion; the highest is a setting",
    ),
    row(
        "One timestep of the window",
        "the sum of Eq. 8 runs over Algorithm 2's own time, where Δ only says when the curriculum is computed anew",
        "a value is recorded whenever the networks have changed, once per cycle of two episodes, and Δ says how often the \
         curriculum is computed anew from the last n values; to record only when Δ is due (`record = evaluation`) is a \
         setting. With steps of the environment taken literally the student's networks would stand still within a window",
    ),
    row(
        "SPaCE's growth of the goal set",
        "reads as if the set grew with progress",
        "the set grows when progress stagnates, as in SPaCE's paper and code",
    ),
    row(
        "SPaCE's updates",
        "not described",
        "the set is updated every 2048 environment steps; until then its goals take turns",
    ),
    row(
        "ProCuRL's tasks",
        "a geometric mean of the value function over goals, without saying at which states",
        "a start with its goal, as in ProCuRL's paper: confidence is asked anew for every start; the states of TEACH are a \
         setting",
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
        "20 episodes, each with a random goal; nothing of starts, of exploration or of when in an episode success counts",
        "20 episodes with the greedy online policy, success at the last step, and success at any step beside it; goals and \
         starts depend on environment, seed and evaluation alone",
    ),
    row(
        "Goals of evaluations",
        "sampled at random from the goal space, which section 5.2 says consists of N goals: from all that the environment \
         knows, or from the pool",
        "the environment's own distribution; the pool is a setting (`evaluation.goals`)",
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
