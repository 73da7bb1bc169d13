#!/usr/bin/env python3
"""An independent student to hold goalbench's against: DDPG + HER with torch's automatic differentiation, in numpy and plain Python.

usage: ci/learning_reference.py --env MazeA [--curriculum her-iid] [--seed 0] [--steps 8000] [--every 1000]
       [--episodes 20] [--batch 1024] [--pseudo-observations 1] [--order joint]

Environments: MazeA, MazeB, MazeC, written out below, and FetchReach and the other Fetch and Hand tasks as gymnasium-robotics has them.
Curricula: her-iid (goals from the environment's own distribution) and teach (TEACH, Algorithm 2: s ~ D is the start of the coming episode).
Prints a JSON line per evaluation: step, success_rate.

Needs Python with
    pip install torch==2.11.0 numpy mujoco==3.3.7 gymnasium-robotics==1.4.2
of which mazes take only the first two.

It shares no code and no random draw with goalbench, only what both take from the papers and from OpenAI Baselines' HER. So the two agree
in distribution, never run by run: `ci/learning-parity` compares them over seeds.
"""
import argparse, copy, json, warnings

import numpy as np
import torch

MAZES = {
    "MazeA": """
        #############
        #S.#........#
        #..#........#
        #..#..####..#
        #.....#.....#
        #.....#.....#
        #..#..#..#..#
        #..#.....#..#
        #..#.....#..#
        #..#..#..#..#
        #.....#.....#
        #.....#.....#
        #############""",
    "MazeB": """
        #############
        #..........S#
        #...........#
        #..#######..#
        #........#..#
        #........#..#
        #..#.....#..#
        #..#.....#..#
        #..#.....#..#
        #..#######..#
        #...........#
        #...........#
        #############""",
    "MazeC": """
        #############
        #...........#
        #...........#
        #..#######..#
        #..#.....#..#
        #..#.....#..#
        #..#.....#..#
        #..#.....#..#
        #..#.....#..#
        #..#######..#
        #...........#
        #S..........#
        #############""",
}
# mjDSBL_NATIVECCD: contacts as MuJoCo computed them before it had a collision detection of its own for convex bodies.
NATIVE_CCD_DISABLED = 1 << 17


class Maze:
    """A point on [-1, 1]² that moves with the velocity it is told; walls stop it. State = achieved goal = position."""

    horizon, states, goals, actions = 50, 2, 2, 2

    def __init__(self, name, seed):
        cells = np.array([list(row) for row in MAZES[name].split()])
        self.rng = np.random.default_rng(seed)
        self.wall, self.free = cells == "#", np.argwhere(cells != "#")
        self.start = self.to_position(np.argwhere(cells == "S")[0] + 0.5)

    @staticmethod
    def to_position(place):
        """Of a place in units of cells."""
        return place * 2 / 13 - 1

    def in_wall(self, position):
        row, column = np.clip(np.floor((position + 1) / 2 * 13), 0, 12).astype(int)
        return self.wall[row, column]

    def draw_goal(self):
        return self.to_position(self.free[self.rng.integers(len(self.free))] + self.rng.uniform(size=2))

    def reset(self):
        """State, achieved goal and a goal of its own for the new episode."""
        self.position = self.start
        return self.position, self.position, self.draw_goal()

    def step(self, action):
        for _ in range(10):
            moved = self.position + 0.01 * action
            if self.in_wall(moved):
                break
            self.position = moved
        return self.position, self.position

    def success(self, achieved, goals):
        return np.linalg.norm(achieved - goals, axis=-1) < 0.1


class Robot:
    """A task of gymnasium-robotics."""

    def __init__(self, name, seed):
        import gymnasium, gymnasium_robotics

        warnings.filterwarnings("ignore")
        gymnasium.register_envs(gymnasium_robotics)
        version = 4 if name.startswith("Fetch") else 3 if name == "HandReach" else 1
        self.env = gymnasium.make(f"{name}-v{version}").unwrapped
        self.env.model.opt.disableflags |= NATIVE_CCD_DISABLED
        self.horizon = gymnasium.spec(f"{name}-v{version}").max_episode_steps
        first, _ = self.env.reset(seed=seed)
        self.states, self.goals = len(first["observation"]), len(first["desired_goal"])
        self.actions = self.env.action_space.shape[0]

    def draw_goal(self):
        return self.reset()[2]

    def reset(self):
        observation, _ = self.env.reset()
        return observation["observation"].copy(), observation["achieved_goal"].copy(), np.ravel(self.env.goal).copy()

    def step(self, action):
        observation = self.env.step(action)[0]
        return observation["observation"].copy(), observation["achieved_goal"].copy()

    def success(self, achieved, goals):
        return np.asarray(self.env._is_success(achieved, goals), dtype=bool)


class Normalizer:
    """Inputs minus their mean, over their standard deviation. Before it is fed, mean 0 and standard deviation 1."""

    def __init__(self, width, pseudo_observations):
        # Baselines starts the count at 1 and the sums at 0: one observation of 0 that nobody made.
        self.count = pseudo_observations
        self.sum, self.squares = np.zeros(width), np.zeros(width)
        self.mean, self.std = np.zeros(width), np.ones(width)

    def feed(self, rows):
        rows = np.clip(rows.astype(np.float64), -200, 200)
        self.count += len(rows)
        self.sum += rows.sum(axis=0)
        self.squares += (rows**2).sum(axis=0)
        self.mean = self.sum / self.count
        self.std = np.sqrt(np.maximum(self.squares / self.count - self.mean**2, 0.01**2))

    def __call__(self, rows):
        return np.clip((np.clip(rows, -200, 200) - self.mean) / self.std, -5, 5).astype(np.float32)


class Replay:
    """Whole episodes of which transitions are drawn with HER's "future" goals, k = 4."""

    def __init__(self, env, rng):
        self.env, self.rng = env, rng
        self.capacity, self.stored = 1_000_000 // env.horizon, 0
        steps = self.capacity, env.horizon
        self.states = np.zeros((steps[0], steps[1] + 1, env.states), np.float32)
        self.achieved = np.zeros((steps[0], steps[1] + 1, env.goals), np.float32)
        self.actions = np.zeros((*steps, env.actions), np.float32)
        self.goals = np.zeros((self.capacity, env.goals), np.float32)

    def push(self, states, achieved, actions, goal):
        """Gives the index of the episode's place."""
        place = self.stored % self.capacity
        self.states[place], self.achieved[place], self.actions[place], self.goals[place] = states, achieved, actions, goal
        self.stored += 1
        return place

    def draw(self, count, episode=None):
        """States, actions, goals, rewards and next states of `count` transitions, from one episode or from all."""
        horizon, rng = self.env.horizon, self.rng
        episodes = rng.integers(min(self.stored, self.capacity), size=count) if episode is None else np.full(count, episode)
        steps = rng.integers(horizon, size=count)
        later = steps + 1 + (rng.uniform(size=count) * (horizon - steps)).astype(int)
        relabelled = (rng.uniform(size=count) < 0.8)[:, None]
        goals = np.where(relabelled, self.achieved[episodes, later], self.goals[episodes])
        reached = self.env.success(self.achieved[episodes, steps + 1].astype(np.float64), goals.astype(np.float64))
        rewards = reached.astype(np.float32) - 1
        return self.states[episodes, steps], self.actions[episodes, steps], goals, rewards, self.states[episodes, steps + 1]


def network(inputs, outputs, layers):
    widths = [inputs] + [256] * layers
    modules = []
    for n, m in zip(widths, widths[1:]):
        modules += [torch.nn.Linear(n, m), torch.nn.ReLU()]
    modules.append(torch.nn.Linear(widths[-1], outputs))
    for linear in modules[::2]:
        torch.nn.init.xavier_uniform_(linear.weight)
        torch.nn.init.zeros_(linear.bias)
    return torch.nn.Sequential(*modules)


class Student:
    """DDPG with HER as OpenAI Baselines configures it."""

    def __init__(self, env, layers, options):
        self.rng = np.random.default_rng([options.seed, 1])
        torch.manual_seed(options.seed)
        self.gamma = 1 - 1 / env.horizon
        self.lowest = -1 / (1 - self.gamma)
        self.batch, self.order = options.batch, options.order
        self.actor = torch.nn.Sequential(network(env.states + env.goals, env.actions, layers), torch.nn.Tanh())
        self.critic = network(env.states + env.goals + env.actions, 1, layers)
        self.target_actor, self.target_critic = copy.deepcopy(self.actor), copy.deepcopy(self.critic)
        self.adam_actor = torch.optim.Adam(self.actor.parameters(), lr=1e-3)
        self.adam_critic = torch.optim.Adam(self.critic.parameters(), lr=1e-3)
        self.of_states = Normalizer(env.states, options.pseudo_observations)
        self.of_goals = Normalizer(env.goals, options.pseudo_observations)
        self.replay = Replay(env, self.rng)
        self.horizon, self.cycles = env.horizon, 0

    def inputs(self, states, goals):
        return torch.from_numpy(np.concatenate([self.of_states(states), self.of_goals(goals)], axis=1))

    @staticmethod
    def value(critic, inputs, actions):
        return critic(torch.cat([inputs, actions], dim=1))

    @torch.no_grad()
    def act(self, state, goal):
        return self.actor(self.inputs(state[None], goal[None]))[0].numpy().astype(np.float64)

    def explore(self, state, goal):
        action = self.act(state, goal)
        if self.rng.uniform() < 0.3:
            return self.rng.uniform(-1, 1, size=len(action))
        return np.clip(action + self.rng.normal(0, 0.2, size=len(action)), -1, 1)

    @torch.no_grad()
    def confidence(self, state, goals):
        """C(g) (TEACH, Eq. 7) of every goal at one state."""
        inputs = self.inputs(np.repeat(state[None], len(goals), axis=0), goals)
        return self.value(self.critic, inputs, self.actor(inputs))[:, 0].numpy().astype(np.float64)

    def observe(self, states, achieved, actions, goal):
        place = self.replay.push(states, achieved, actions, goal)
        states, _, goals, _, _ = self.replay.draw(self.horizon, episode=place)
        self.of_states.feed(states)
        self.of_goals.feed(goals)

    def critic_gradient(self, inputs, actions, rewards, next_inputs):
        with torch.no_grad():
            following = self.value(self.target_critic, next_inputs, self.target_actor(next_inputs))
            targets = (rewards + self.gamma * following).clamp(self.lowest, 0)
        loss = (self.value(self.critic, inputs, actions) - targets).square().mean()
        return torch.autograd.grad(loss, list(self.critic.parameters()))

    def actor_gradient(self, inputs):
        actions = self.actor(inputs)
        loss = -self.value(self.critic, inputs, actions).mean() + actions.square().mean()
        return torch.autograd.grad(loss, list(self.actor.parameters()))

    @staticmethod
    def apply(optimizer, gradient):
        for parameter, slope in zip(optimizer.param_groups[0]["params"], gradient):
            parameter.grad = slope
        optimizer.step()

    def update(self):
        states, actions, goals, rewards, next_states = self.replay.draw(self.batch)
        inputs, next_inputs = self.inputs(states, goals), self.inputs(next_states, goals)
        of_critic = self.critic_gradient(inputs, torch.from_numpy(actions), torch.from_numpy(rewards)[:, None], next_inputs)
        if self.order == "sequential":
            self.apply(self.adam_critic, of_critic)
            self.apply(self.adam_actor, self.actor_gradient(inputs))
        else:
            of_actor = self.actor_gradient(inputs)
            self.apply(self.adam_critic, of_critic)
            self.apply(self.adam_actor, of_actor)

    def learn(self):
        """The second half of a cycle: 40 gradient steps, then the targets follow."""
        for _ in range(40):
            self.update()
        with torch.no_grad():
            for target, online in ((self.target_actor, self.actor), (self.target_critic, self.critic)):
                for old, new in zip(target.parameters(), online.parameters()):
                    old.mul_(0.95).add_(new, alpha=0.05)
        self.cycles += 1


class Iid:
    """HER-IID: every episode keeps the goal that its reset drew."""

    def propose(self, student, start, own):
        return own


class Teach:
    """TEACH: goals of a fixed pool, in proportion to the variance of their confidence over the last 10 states of the networks."""

    def __init__(self, env, seed):
        self.rng = np.random.default_rng([seed, 2])
        self.pool = np.array([env.draw_goal() for _ in range(1000)])
        self.window, self.measured = [], None

    def propose(self, student, start, own):
        confidence = student.confidence(start, self.pool)
        # One entry per state of the networks: a later start of the same cycle takes the place of the one before.
        if self.measured == student.cycles:
            self.window.pop()
        self.window = (self.window + [confidence])[-10:]
        self.measured = student.cycles
        variance = np.var(self.window, axis=0)
        if len(self.window) < 2 or variance.sum() < 1e-8:
            return self.pool[self.rng.integers(len(self.pool))]
        return self.pool[self.rng.choice(len(self.pool), p=variance / variance.sum())]


def play(env, act, propose):
    """One episode: H + 1 states and achieved goals, H actions, the goal."""
    state, achieved, goal = env.reset()
    goal = propose(state, goal)
    states, achieved_goals, actions = [state], [achieved], []
    for _ in range(env.horizon):
        actions.append(act(state, goal))
        state, achieved = env.step(actions[-1])
        states.append(state)
        achieved_goals.append(achieved)
    return np.array(states), np.array(achieved_goals), np.array(actions), goal


def success_rate(env, student, episodes):
    """Share of greedy episodes that are successful at their last step."""
    played = [play(env, student.act, lambda start, own: own) for _ in range(episodes)]
    return float(np.mean([env.success(achieved[-1], goal) for _, achieved, _, goal in played]))


def train(options):
    torch.set_num_threads(1)
    make = Maze if options.env in MAZES else Robot
    env, evaluation = make(options.env, 2 * options.seed), make(options.env, 2 * options.seed + 1)
    student = Student(env, 3 if options.env.startswith("Hand") else 2, options)
    teacher = Teach(env, options.seed) if options.curriculum == "teach" else Iid()

    def evaluate(step):
        print(json.dumps({"step": step, "success_rate": success_rate(evaluation, student, options.episodes)}), flush=True)

    evaluate(0)
    step = 0
    while step < options.steps:
        reached = step // options.every
        for _ in range(2):
            student.observe(*play(env, student.explore, lambda start, own: teacher.propose(student, start, own)))
            step += env.horizon
        student.learn()
        if step // options.every > reached or step >= options.steps:
            evaluate(step)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--env", required=True)
    parser.add_argument("--curriculum", choices=["her-iid", "teach"], default="her-iid")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--steps", type=int, default=8000)
    parser.add_argument("--every", type=int, default=1000, help="training steps between evaluations")
    parser.add_argument("--episodes", type=int, default=20, help="of an evaluation")
    parser.add_argument("--batch", type=int, default=1024)
    parser.add_argument("--pseudo-observations", type=int, default=1, help="of 0 that normalisers begin with: 1 (Baselines) or 0")
    parser.add_argument("--order", choices=["joint", "sequential"], default="joint",
                        help="both gradients at the same parameters (Baselines), or the actor's at the critic that has just stepped")
    train(parser.parse_args())


if __name__ == "__main__":
    main()
