"""A curriculum of your own in Python: the pool goals nearest to the start, and a circle that grows.

It is `own_curriculum.rs` once more, and chooses the very same goals.

    goalbench list python > goalbench_curriculum.py
    goalbench run --env MazeA --curriculum process,her-iid --steps 20000 \\
        --set curriculum.process.command="python nearest.py" --set curriculum.process.title="Nearest first"
"""

import argparse
import math

from goalbench_curriculum import Curriculum, serve

parser = argparse.ArgumentParser()
parser.add_argument("--share", type=float, default=0.1, help="share of the pool to begin with")
parser.add_argument("--growth", type=float, default=0.05, help="what is added when the student does well")
parser.add_argument("--threshold", type=float, default=0.5, help="success rate that counts as doing well")
parser.add_argument("--episodes", type=int, default=20, help="training episodes looked back on")
options = parser.parse_args()


class Nearest(Curriculum):
    def begin(self):
        self.share = options.share
        self.recent = []
        self.weights = [1 / len(self.pool)] * len(self.pool)
        self.statistics = {"share": self.share}

    def propose(self, lesson):
        order = sorted(range(len(self.pool)), key=lambda goal: distance(self.pool[goal], lesson.achieved))
        within = max(1, min(len(order), math.floor(self.share * len(order) + 0.5)))
        self.weights = [0.0] * len(order)
        for goal in order[:within]:
            self.weights[goal] = 1 / within
        return self.random.draw(self.weights)

    def observe(self, episode):
        self.recent = (self.recent + [episode.success])[-options.episodes :]
        enough = sum(self.recent) >= options.threshold * options.episodes
        if len(self.recent) == options.episodes and enough:
            self.share = min(self.share + options.growth, 1.0)
            self.recent = []
        self.statistics = {"share": self.share}


def distance(a, b):
    total = 0.0
    for x, y in zip(a, b):
        total += (x - y) * (x - y)
    return math.sqrt(total)


serve(Nearest)
