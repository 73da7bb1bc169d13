//! Known deviations from the paper: where it is silent or contradicts itself, and what is done here.

use reports::analysis::catalogue::Deviation;

const fn row(topic: &'static str, paper: &'static str, here: &'static str) -> Deviation {
    Deviation { topic, paper, here }
}

/// All that are known, in the order of the method: student, teachers, protocol.
pub(super) static DEVIATIONS: &[Deviation] = &[
    row(
        "Student's hyper-parameters",
        "states batch size, depth and the critic's learning rate; not width, γ, the actor's learning rate, noise, \
         HER's k, or gradient steps per environment step",
        "the public HER configuration of OpenAI Baselines, with one environment worker",
    ),
    row(
        "When the student learns",
        "an update after every environment step (Algorithm 2)",
        "40 gradient steps after every two episodes, as in OpenAI Baselines",
    ),
    row(
        "Input normalisers",
        "none mentioned",
        "as in OpenAI Baselines: relabelled samples of new episodes, beginning with one pseudo-observation of 0; fed after \
         every episode, not once per cycle",
    ),
    row(
        "Exploration",
        "added noise, with an Ornstein-Uhlenbeck process as an example",
        "Gaussian noise and 30 % uniform actions, as in OpenAI Baselines; Ornstein-Uhlenbeck is a setting",
    ),
    row(
        "An episode's last step",
        "not described",
        "kept; OpenAI Baselines drops it and counts success one step earlier",
    ),
    row(
        "The N goals",
        "sampled uniformly from the goal space",
        "drawn once from the environment's own distribution of goals",
    ),
    row(
        "States of the confidence score",
        "the mean over D, the replay buffer's state distribution (said after Eq. 6), without saying over how many states",
        "8 reference states, drawn from the replay buffer and held, so that a window never compares values of different \
         states; renewed every 100 measurements with a hand-over, during which both sets are measured; fresh draws \
         (`replay`) and the start of the coming episode (`initial`) are settings",
    ),
    row("Range of the confidence score", "Eq. 7 sets no bounds", "TEACH's confidence is not clipped"),
    row(
        "Smoothed confidence",
        "a Polyak-averaged value function (section 5.4, Eq. 12); neither its coefficient nor whose action it judges",
        "the averaged critic about the trained policy's action (`target-critic`); it is the student's own target network, so \
         that it has its coefficient (`student.polyak`, 0.95 in the preset `paper`); that of an averaged policy (`target`) is a setting",
    ),
    row(
        "Choice of the goal",
        "in proportion to the variance (Eq. 11), or the goal of maximum uncertainty (section 5.2); at every step (Algorithm \
         2), or once per episode (section 5.2)",
        "in proportion, once per episode; the maximum is a setting",
    ),
    row(
        "One timestep of the window",
        "Algorithm 2's own time: every environment step, each with an update of the student; Δ only says when the curriculum \
         is computed anew",
        "a value is recorded whenever the networks have changed, once per cycle: n = 10 spans 20 episodes, not 10 steps, in \
         which this student's networks would stand still. Δ says how often the curriculum is computed anew from the \
         last n values; to record only when Δ is due (`record = evaluation`) is a setting",
    ),
    row(
        "SPaCE's growth of the goal set",
        "reads as if the set grew with progress",
        "the set grows when progress stagnates, as in SPaCE's paper and code",
    ),
    row(
        "SPaCE's order and updates",
        "names no order, threshold or interval",
        "one more goal when the set's mean value stagnates (η = 0.1), largest improvement first, every 2048 environment \
         steps; SPaCE's code by default ranks the lowest value first and waits 100 steps per goal of the set",
    ),
    row(
        "SPaCE's values",
        "the agent's predictions of state values, extended to DDPG and HER",
        "Q at the greedy action from held replay states; SPaCE's code takes each instance's own start",
    ),
    row(
        "ProCuRL's value and interval",
        "the goal of the highest geometric mean of the value function; no formula, no interval",
        "a draw by softmax of p(1 − p), β = 20, with p from the value of the coming start between its bounds, renewed at \
         every start and change of the networks; with a reward of −1 per step p also falls with the time that success takes",
    ),
    row(
        "VDS's ensemble",
        "\"official implementation\"",
        "40 gradient steps per cycle on batches of the student's size; `official` takes 100 of 1000 after every episode, as \
         the command of VDS's README does; candidates come from the environment at hand, not from another instance",
    ),
    row(
        "Hyper-parameters of baselines",
        "official code for HER-IID and VDS, own extensions of SPaCE and ProCuRL; no values",
        "the same student for all methods; `official` has 3 layers, batches of 256 and one episode per cycle",
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
        "the text names no values beyond n = 3, n = 10 and Δ = 1",
        "n of 3, 5, 10 and 20; Δ of 1, 2, 5, 10 and 50",
    ),
    row(
        "Evaluation",
        "20 episodes, each with a random goal; nothing of how often, of starts, of exploration or of when in an episode success \
         counts",
        "every 10,000 steps (on mazes 5,000) 20 episodes with the greedy online policy, success at the last step, and success at any step beside it; goals and \
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
        "the same, unless `report --bands` asks for others; ddof = 1 throughout; claims are judged by exact paired \
         sign-flip tests, never by overlap of bands",
    ),
    row(
        "Action dimension of Fetch",
        "Table 1 prints 3, and 4 for FetchPickAndPlace",
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
        "MuJoCo 3.3.7 with native CCD off (`physics.native_ccd`), checked against recordings",
    ),
];
