"""Plays a policy that `goalbench export RUN --out DIR` wrote: `python play_policy.py DIR [EPISODES [SEED]]`.

Needs torch; to play also gymnasium-robotics 1.4.2 with mujoco 3.3.7, which has no mazes: `Policy.act` acts in any world."""
import hashlib, json, sys
from pathlib import Path

import torch

VERSIONS = {"FetchReach": 4, "FetchPush": 4, "FetchSlide": 4, "FetchPickAndPlace": 4, "HandReach": 3}


class Policy:
    def __init__(self, folder):
        self.about = json.loads((Path(folder) / "policy.json").read_text())
        raw = (Path(folder) / "policy.safetensors").read_bytes()
        if self.about["format"] != 1 or self.about["sha256"] != hashlib.sha256(raw).hexdigest():
            raise ValueError(f"{folder}: policy.json has another format than 1, or does not belong to policy.safetensors")
        start = 8 + int.from_bytes(raw[:8], "little")
        self.numbers = {}
        for name, entry in json.loads(raw[8:start]).items():
            if name != "__metadata__":
                bytes_ = bytearray(raw[start:][slice(*entry["data_offsets"])])
                self.numbers[name] = torch.frombuffer(bytes_, dtype=torch.float32).reshape(entry["shape"])

    def act(self, observation):
        """Greedy actions, `[..., A]`, for `observation` and `desired_goal`, `[..., S]` and `[..., G]`, of a dictionary."""
        parts = []
        for part in self.about["inputs"]:
            x = torch.as_tensor(observation[part["observation"]]).float()
            x = x.clamp(-part["clip_before"], part["clip_before"]) - self.numbers[part["mean"]]
            parts.append((x * self.numbers[part["scale"]]).clamp(-part["clip_after"], part["clip_after"]))
        x = torch.cat(parts, dim=-1).double()
        for layer in self.about["layers"]:
            x = x @ self.numbers[layer["weight"]].double().T + self.numbers[layer["bias"]].double()
            x = getattr(torch, layer["activation"])(x)
        return x.numpy()


def play(policy, episodes=100, seed=0):
    """The share of `episodes` that end in success."""
    import gymnasium, gymnasium_robotics, mujoco
    gymnasium.register_envs(gymnasium_robotics)
    task = policy.about["environment"]
    env = gymnasium.make(f"{task['id']}-v{VERSIONS.get(task['id'], 1)}", max_episode_steps=task["horizon"])
    if not task["native_ccd"]:
        env.unwrapped.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_NATIVECCD
    successes = 0
    for episode in range(episodes):
        observation = env.reset(seed=seed + episode)[0]
        for _ in range(task["horizon"]):
            observation, _, _, _, info = env.step(policy.act(observation))
        successes += info["is_success"]
    return successes / episodes


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3, 4) or not all(word.isdecimal() for word in sys.argv[2:]) or sys.argv[2:3] == ["0"]:
        sys.exit(__doc__)
    print(play(Policy(sys.argv[1]), *map(int, sys.argv[2:])))
