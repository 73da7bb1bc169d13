"""Curricula for goalbench, written in Python.

Derive a class from `Curriculum`, give it `propose`, and end your file with `serve(MyTeacher)`:

    from goalbench_curriculum import Curriculum, serve

    class Mine(Curriculum):
        def propose(self, lesson):
            return self.random.randrange(len(self.pool))

    serve(Mine)

    goalbench run --env MazeA --curriculum process --set curriculum.process.command="python mine.py"

One file and the standard library alone: put it beside yours. goalbench starts your program once per run and
talks with it through standard input and output; `print` is redirected to standard error.

Everything that you keep in `self` is saved with the run's checkpoints, so that a run that was interrupted goes
on as if it had not been. Draw from `self.random` alone: it is the run's own stream.
"""

import base64
import io
import json
import math
import os
import pickle
import random
import sys
import zlib

PROTOCOL = 1

NATIVE = "native"
"""What `propose` returns to keep the goal that the environment drew itself."""


class Curriculum:
    """A curriculum: chooses the goal of every training episode.

    Set by goalbench before `begin`:

    - `spec`: the task, with `environment` (its id), `state`, `goal`, `action` (dimensions) and `horizon`;
    - `pool`: the candidate goals, a list of N lists of G numbers, the same for all curricula of a seed;
    - `seed`: the run's seed;
    - `random`: the run's own stream, a `random.Random` with a `draw(weights)` besides.

    Yours to set, if there is something to record:

    - `weights`: the current probability of every goal of the pool, a list of N numbers that sum to 1;
    - `statistics`: further numbers by name, always the same names.
    """

    weights = None
    statistics = {}

    def begin(self):
        """Called once, before the first episode: set up everything that you keep."""

    def propose(self, lesson):
        """The goal of the coming episode: an index into the pool, a list of G numbers, or `NATIVE`.

        To record what you thought of the goal, return a `Proposal` instead.
        """
        raise NotImplementedError("a curriculum needs a method `propose`")

    def observe(self, episode):
        """Called after every training episode."""

    def save(self):
        """All that a resumed run needs, as bytes. By default everything in `self`, pickled."""
        state = io.BytesIO()
        _Pickler(state, protocol=4).dump(self.__dict__)
        return state.getvalue()

    def load(self, state):
        """Takes back what `save` gave."""
        self.__dict__.update(_Unpickler(io.BytesIO(state)).load())


class _Pickler(pickle.Pickler):
    """Pickles equal states to equal bytes: whether two equal strings are one object does not show."""

    def persistent_id(self, value):
        return value.encode("utf-8", "surrogatepass") if type(value) is str else None


class _Unpickler(pickle.Unpickler):
    def persistent_load(self, pid):
        return sys.intern(pid.decode("utf-8", "surrogatepass"))


class Proposal:
    """A goal, how it was scored (the larger, the more it was wanted), and its (place, of) in a ranked set."""

    def __init__(self, goal, score=None, rank=None):
        self.goal, self.score, self.rank = goal, score, rank


class Episode:
    """A finished training episode.

    `goal` (G numbers), `index` (of the goal in the pool, or None), `success` (at the last step), `total_reward`
    (the return: the sum of the rewards), `achieved` (what was achieved in the end, G numbers).
    """

    def __init__(self, message):
        self.goal, self.index, self.success = message["goal"], message["pool"], message["success"]
        self.total_reward, self.achieved = message["return"], message["achieved"]


class Lesson:
    """What a curriculum may see when it chooses. The functions ask goalbench, and only `propose` may call them.

    `state` (S numbers) and `achieved` (G numbers) are the start of the coming episode, `gradient_steps` those
    that the student has taken.
    """

    def __init__(self, message, ask):
        self.state, self.achieved = message["state"], message["achieved"]
        self.gradient_steps, self._ask = message["gradient_steps"], ask

    def confidence(self, goals=None, states=None, network="online"):
        """The student's confidence in each of `goals`: the mean of Q(s, g, pi(s, g)) over `states`.

        Goals are those of the pool unless others are given, the one state is the coming start. Networks:
        "online", "target" or "target-critic".
        """
        return self._ask("confidence", goals=goals, states=states, network=network)["values"]

    def fresh_goals(self, count=1):
        """Goals that the environment could ask for at the coming start, drawn from its own distribution."""
        return self._ask("fresh_goals", count=count)["goals"]

    def replay_states(self, count=1):
        """States drawn from the student's replay buffer; an empty list before the first episode."""
        return self._ask("replay_states", count=count)["states"]

    def replay_achieved(self, count=1):
        """Achieved goals drawn from the student's replay buffer; an empty list before the first episode."""
        return self._ask("replay_achieved", count=count)["goals"]

    def history(self):
        """(tries, successes): training episodes towards each goal of the pool so far, and those that succeeded."""
        told = self._ask("history")
        return told["tries"], told["successes"]


class Stream(random.Random):
    """goalbench's own generator (ChaCha with 8 rounds), so that a curriculum draws what its twin in Rust would.

    Everything of `random.Random` works, and only `seed` does nothing.
    """

    def __new__(cls, key=bytes(32)):
        return super().__new__(cls, 0)

    def __init__(self, key=bytes(32)):
        self._key = [int.from_bytes(key[i : i + 4], "little") for i in range(0, 32, 4)]
        self._block, self._words = 0, []
        super().__init__(0)

    def seed(self, *_):
        self.gauss_next = None

    def getstate(self):
        return self._key, self._block, self._words, self.gauss_next

    def setstate(self, state):
        self._key, self._block, self._words, self.gauss_next = state

    def __reduce__(self):
        return Stream, (), self.getstate()

    def _word(self):
        if not self._words:
            self._words = _chacha8(self._key, self._block)[::-1]
            self._block += 1
        return self._words.pop()

    def random(self):
        """A number from [0, 1) in steps of 2^-52."""
        low, high = self._word(), self._word()
        return ((high << 32 | low) >> 12) * 2.0**-52

    def getrandbits(self, k):
        """`k` random bits."""
        if k < 0:
            raise ValueError("number of bits must be non-negative")
        bits = 0
        for i in range((k + 31) // 32):
            bits |= self._word() << (32 * i)
        return bits >> (-k % 32)

    def draw(self, weights):
        """An index drawn in proportion to `weights`, none of them negative."""
        total, sums = 0.0, []
        for weight in weights:
            total += weight
            sums.append(total)
        if not total > 0.0 or not math.isfinite(total):
            raise ValueError("weights must have a positive, finite sum")
        drawn = self.random() * total
        low, high = 0, len(sums) - 1
        while low < high:
            middle = (low + high) // 2
            if sums[middle] <= drawn:
                low = middle + 1
            else:
                high = middle
        return low


def _chacha8(key, block):
    """The 16 words of a block of the key stream."""
    start = [0x61707865, 0x3320646E, 0x79622D32, 0x6B206574, *key, block & 0xFFFFFFFF, block >> 32, 0, 0]
    x = list(start)
    for _ in range(4):
        for a, b, c, d in _QUARTERS:
            x[a] = (x[a] + x[b]) & 0xFFFFFFFF
            t = x[d] ^ x[a]
            x[d] = (t << 16 | t >> 16) & 0xFFFFFFFF
            x[c] = (x[c] + x[d]) & 0xFFFFFFFF
            t = x[b] ^ x[c]
            x[b] = (t << 12 | t >> 20) & 0xFFFFFFFF
            x[a] = (x[a] + x[b]) & 0xFFFFFFFF
            t = x[d] ^ x[a]
            x[d] = (t << 8 | t >> 24) & 0xFFFFFFFF
            x[c] = (x[c] + x[d]) & 0xFFFFFFFF
            t = x[b] ^ x[c]
            x[b] = (t << 7 | t >> 25) & 0xFFFFFFFF
    return [(word + first) & 0xFFFFFFFF for word, first in zip(x, start)]


_QUARTERS = [
    (0, 4, 8, 12), (1, 5, 9, 13), (2, 6, 10, 14), (3, 7, 11, 15),
    (0, 5, 10, 15), (1, 6, 11, 12), (2, 7, 8, 13), (3, 4, 9, 14),
]


def serve(curriculum_class):
    """Talks with goalbench until the run is over."""
    if sys.stdin.isatty():
        sys.exit("goalbench starts this program: --set curriculum.process.command=\"python " + sys.argv[0] + '"')
    # Answers have a pipe of their own; whatever else is printed, by whomever, goes to standard error.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", newline="\n")
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    _Server(curriculum_class, sys.stdin.buffer, answers).run()


class _Server:
    """The program's end of the conversation."""

    # Given by goalbench in every `hello`, and so no part of what is saved.
    GIVEN = ("spec", "pool", "seed")

    def __init__(self, curriculum_class, questions, answers):
        self.curriculum, self.questions, self.answers = curriculum_class(), questions, answers
        self.told = {}

    def run(self):
        for line in iter(self.questions.readline, b""):
            message = json.loads(line)
            self.say(**getattr(self, "on_" + message["type"])(message))

    def say(self, **answer):
        # Not-a-number has no JSON form: better a clear error here than a refusal there.
        self.answers.write(json.dumps(answer, allow_nan=False) + "\n")
        self.answers.flush()

    def ask(self, what, **about):
        self.say(type="ask", what=what, **{name: _plain(value) for name, value in about.items() if value is not None})
        line = self.questions.readline()
        if not line:
            sys.exit("goalbench is gone")
        return json.loads(line)

    def on_hello(self, message):
        if message["protocol"] != PROTOCOL:
            sys.exit(f"this goalbench_curriculum.py speaks protocol {PROTOCOL}, goalbench {message['protocol']}")
        curriculum = self.curriculum
        curriculum.spec, curriculum.pool, curriculum.seed = message["spec"], message["pool"], message["seed"]
        curriculum.random = Stream(bytes.fromhex(message["stream"]))
        curriculum.begin()
        return {"type": "ready", "protocol": PROTOCOL, **self.news()}

    def on_propose(self, message):
        proposal = self.curriculum.propose(Lesson(message, self.ask))
        if not isinstance(proposal, Proposal):
            proposal = Proposal(proposal)
        answer = {"type": "goal", "goal": _goal(proposal.goal), **self.news()}
        if proposal.score is not None and math.isfinite(proposal.score):
            answer["score"] = float(proposal.score)
        if proposal.rank is not None:
            answer["rank"] = [int(place) for place in proposal.rank]
        return answer

    def on_episode(self, message):
        self.curriculum.observe(Episode(message))
        return {"type": "heard", **self.news()}

    def on_save(self, _):
        given = {name: self.curriculum.__dict__.pop(name) for name in self.GIVEN}
        try:
            state = self.curriculum.save()
        finally:
            self.curriculum.__dict__.update(given)
        return {"type": "saved", "state": f"{zlib.crc32(state):08x}" + base64.b64encode(state).decode()}

    def on_load(self, message):
        checksum, state = message["state"][:8], base64.b64decode(message["state"][8:], validate=True)
        if checksum != f"{zlib.crc32(state):08x}":
            sys.exit("the saved state is damaged")
        self.curriculum.load(state)
        # goalbench has what it knew when the state was saved, not what `begin` has just told.
        self.told = {}
        return {"type": "loaded"}

    def news(self):
        """Weights and statistics, as far as goalbench does not know them yet."""
        now = {}
        if self.curriculum.weights is not None:
            now["weights"] = [float(weight) for weight in self.curriculum.weights]
        if self.curriculum.statistics:
            now["statistics"] = {name: _number(value) for name, value in self.curriculum.statistics.items()}
        news = {name: value for name, value in now.items() if self.told.get(name) != value}
        self.told.update(news)
        return news


def _goal(goal):
    if goal is None:
        raise TypeError("propose returned None; a goal is an index, a list of numbers or NATIVE")
    if isinstance(goal, str):
        return goal
    goal = _plain(goal)
    if isinstance(goal, list):
        for i, x in enumerate(goal):
            if not isinstance(x, (int, float)) or not math.isfinite(x):
                raise ValueError(f"number {i} of the goal is {x}; every number must be finite")
    return goal


def _number(value):
    value = float(value)
    return value if math.isfinite(value) else None


def _plain(value):
    """Numbers, tuples and arrays (numpy's have `tolist`) as JSON knows them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return value
