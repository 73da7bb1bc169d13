#!/usr/bin/env python3
"""Computes the numbers behind the study's verdicts again, from the records alone, and compares them with a report.

    python harness/study/check.py RESULTS [REPORT]

RESULTS is what `goalbench unpack` makes of an archive, REPORT is RESULTS/report. The rules are those of
harness/docs/reports.md; neither code nor random numbers are the program's. Needs NumPy. Exit code 1 if anything
disagrees.
"""

import csv
import itertools
import json
import math
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

ALPHA, MARGIN, WINDOW, ENUMERATED, FLIPS = 0.05, 0.1, 5, 16, 40_000
BASELINES = ["vds", "space", "procurl", "her-iid"]
RANDOM = np.random.default_rng(20_251_224)


# Records and scores

class Curve(NamedTuple):
    steps: np.ndarray
    rates: np.ndarray
    failed: bool


def read(results):
    """The curve of every run, by (environment, curriculum, variant) and seed."""
    runs = {}
    for path in sorted(Path(results).glob("runs/*/*/*/seed-*/records.jsonl")):
        environment, curriculum, variant, seed = path.parent.parts[-4:]
        rows = [json.loads(line) for line in path.read_text().splitlines()]
        curve = Curve(*np.array([(row["step"], row["success_rate"]) for row in rows]).T, failed=False)
        runs.setdefault((environment, curriculum, variant), {})[int(seed.removeprefix("seed-"))] = curve
    # A run that failed counts 0 in every evaluation it would still have had.
    for cell in runs.values():
        longest = max((curve.steps for curve in cell.values()), key=len)
        for seed, curve in cell.items():
            missing = longest[len(curve.steps):]
            if len(missing):
                rates = np.concatenate([curve.rates, 0.0 * missing])
                cell[seed] = Curve(np.concatenate([curve.steps, missing]), rates, failed=True)
    return runs


def final(curve):
    return curve.rates[1:][-WINDOW:].mean()


def area(curve):
    steps, rates = curve.steps, curve.rates
    return np.sum(np.diff(steps) * (rates[1:] + rates[:-1]) / 2) / (steps[-1] - steps[0])


def noise(curve):
    """None of a run that failed: its zeros do not change from one to the next."""
    return None if curve.failed else np.abs(np.diff(curve.rates)).mean()


def steps_to(curve, rate):
    """The first evaluation of at least `rate` that begins five whose mean is no lower; infinite without one."""
    steps, rates = curve.steps, curve.rates
    for i in range(len(rates) - WINDOW + 1):
        if rates[i] >= rate and rates[i:i + WINDOW].mean() >= rate - 1e-12:
            return steps[i]
    return math.inf


# The sign-flip test of pairs in strata of equal weight

def flips(n):
    """Signs, one row per flip without the data's own, and whether they are all there are."""
    if n <= ENUMERATED:
        signs = np.array(list(itertools.product([1.0, -1.0], repeat=n)))
        return signs[1:], True
    return RANDOM.choice([1.0, -1.0], size=(FLIPS, n)), False


class Test:
    """Differences by environment, tested against no difference."""

    def __init__(self, strata):
        strata = [np.asarray(stratum) for stratum in strata]
        self.pairs = sum(map(len, strata))
        self.weights = np.concatenate([np.full(len(s), 1 / (len(s) * len(strata))) for s in strata])
        self.values = np.concatenate(strata)
        self.difference = float(self.weights @ self.values)
        self.signs, self.exact = flips(self.pairs)
        self.ties = 1e-12

    def p(self, shift=0.0):
        values = self.weights * (self.values - shift)
        own, drawn = values.sum(), self.signs @ values
        above = np.sum(drawn >= own - self.ties) + 1
        below = np.sum(drawn <= own + self.ties) + 1
        return min(1.0, 2 * min(above, below) / (len(drawn) + 1))

    def interval(self, level):
        """All shifts that are not refused: each flip's crossing point orders them."""
        sums, shares = self.signs @ (self.weights * self.values), self.signs @ self.weights
        rest = shares < 1 - 1e-12
        crossings = np.sort((self.difference - sums[rest]) / (1 - shares[rest]))
        most = level * (len(sums) + 1) / 2 - 1 - np.sum(~rest)
        index = math.floor(most + 1e-9)
        if index < 0:
            return None
        return float(crossings[index]), float(crossings[-1 - index])


def improvement(strata):
    """Share of pairs ahead, ties one half, and the test of the signs."""
    signs = [np.sign(np.where(np.abs(s) < 1e-12, 0, s)) for s in map(np.asarray, strata)]
    return float(np.mean([((s + 1) / 2).mean() for s in signs])), Test(signs).p()


def hochberg(ps):
    order = sorted(range(len(ps)), key=lambda i: -ps[i])
    adjusted, least = [0.0] * len(ps), 1.0
    for rank, i in enumerate(order, 1):
        least = min(least, rank * ps[i])
        adjusted[i] = least
    return adjusted


def fisher(ps):
    """p of -2 sum ln p under a chi-square with 2k degrees of freedom: a finite sum for even degrees."""
    half = -sum(math.log(p) for p in ps)
    return math.exp(-half) * sum(half ** k / math.factorial(k) for k in range(len(ps)))


# Effects and rules

class Effect:
    """Pairs of two sides by environment, in the order of names."""

    def __init__(self, runs, a, b, measure):
        self.places = {}
        for environment in sorted({key[0] for key in runs}):
            one, two = runs.get((environment, *a)), runs.get((environment, *b))
            if one and two:
                seeds = sorted(one.keys() & two.keys())
                scores = [(measure(one[s]), measure(two[s])) for s in seeds]
                differences = [a - b for a, b in scores if a is not None and b is not None]
                if differences:
                    self.places[environment] = np.array(differences)
        self.strata = list(self.places.values())
        self.test = Test(self.strata)
        self.improvement, self.improvement_p = improvement(self.strata)

    def above(self, level):
        """1 where means and signs both say above, -1 below, 0 otherwise."""
        interval = self.test.interval(level)
        means = 0 if interval is None else int(interval[0] > 0) - int(interval[1] < 0)
        signs = int(np.sign(self.improvement - 0.5)) if self.improvement_p <= level + 1e-9 else 0
        return means if means == signs else 0

    def p_beyond(self, place, bound, direction):
        directed = self.places[place] * direction
        sides = [directed - bound, np.sign(directed)]
        return max(Test([values]).p() if values.mean() > 1e-12 else 1.0 for values in sides)

    def beyond(self, bound, direction, level):
        """Environments beyond `bound` in `direction` (a function of the place), corrected."""
        names = list(self.places)
        adjusted = hochberg([self.p_beyond(name, bound, direction(name)) for name in names])
        return [name for name, p in zip(names, adjusted) if p <= level + 1e-9]

    def side(self, place):
        return 1.0 if self.places[place].mean() > 0 else -1.0

    def everywhere(self, level, holds):
        """Whether it holds of every environment's one-sided interval."""
        intervals = [Test([stratum]).interval(2 * level) for stratum in self.strata]
        return all(interval is not None and holds(*interval) for interval in intervals)


def versus(effect, level):
    return {1: "confirmed", -1: "refuted", 0: "undecided"}[effect.above(level)]


def consistent(effect, level):
    if effect.beyond(0.0, lambda _: -1.0, 2 * level):
        return "refuted"
    most = sum(s.mean() > 0 for s in effect.strata) * 2 > len(effect.strata)
    fine = effect.everywhere(level, lambda low, _: low > -MARGIN)
    return "confirmed" if effect.above(level) == 1 and most and fine else "undecided"


def equivalent(effects, share):
    each = ALPHA / (share * len(effects))
    refuted, confirmed = False, True
    for effect in effects:
        outside = effect.beyond(MARGIN, effect.side, each)
        together = fisher([effect.p_beyond(name, MARGIN, effect.side(name)) for name in effect.places])
        refuted |= bool(outside) or together <= each
        confirmed &= effect.everywhere(ALPHA, lambda low, high: -MARGIN < low and high < MARGIN)
    return "refuted" if refuted else "confirmed" if confirmed else "undecided"


def some(effects, direction):
    sides = [direction * effect.above(ALPHA / len(effects)) for effect in effects]
    return "confirmed" if 1 in sides else "refuted" if all(side == -1 for side in sides) else "undecided"


def not_above(effects):
    each = ALPHA / (2 * len(effects))
    if any(e.above(each) == 1 or e.beyond(MARGIN, lambda _: 1.0, each) for e in effects):
        return "refuted"
    fine = all(e.everywhere(ALPHA, lambda _, high: high < MARGIN) for e in effects)
    return "confirmed" if fine else "undecided"


def mixed(effects):
    each = ALPHA / len(effects)
    for e in effects:
        if e.beyond(0.0, lambda _: 1.0, each) and e.beyond(0.0, lambda _: -1.0, each):
            return "confirmed"
    return "refuted" if equivalent(effects, 1) == "confirmed" else "undecided"


def somewhere_best(effects):
    names = list(effects[0].places)
    worst = [max(e.p_beyond(name, 0.0, -1.0) for e in effects) for name in names]
    if any(p <= ALPHA + 1e-9 for p in hochberg(worst)):
        return "confirmed"
    each = ALPHA / len(effects)
    beaten = [any(e.p_beyond(name, 0.0, 1.0) <= each + 1e-9 for e in effects) for name in names]
    return "refuted" if all(beaten) else "undecided"


# Comparison with a report

class Comparison:
    def __init__(self):
        self.numbers, self.wrong = 0, []

    def same(self, what, ours, theirs, tolerance=1e-9):
        self.numbers += 1
        if isinstance(ours, str) or ours is None or theirs in ("", None):
            agree = (ours or "") == (theirs or "")
        else:
            agree = abs(ours - float(theirs)) <= tolerance
        if not agree:
            self.wrong.append(f"{what}: {ours} here, {theirs} in the report")

    def effect(self, what, effect, row, level):
        """A row's effect; random flips leave the ends of intervals and p-values uncertain."""
        test, drawn = effect.test, not effect.test.exact
        self.same(f"{what}: effect", test.difference, row["effect"])
        self.same(f"{what}: level", 1 - level, row["confidence"])
        self.same(f"{what}: pairs", test.pairs, row["pairs"])
        self.same(f"{what}: pairs ahead", effect.improvement, row["improvement"])
        for name, ours in [("p", test.p()), ("improvement_p", effect.improvement_p)]:
            # Five standard errors of the report's 10,000 flips, and of ours.
            error = 5 * 2 * math.sqrt(max(ours, 2e-4) / 2 * (1e-4 + 1 / FLIPS)) if drawn else 1e-9
            self.same(f"{what}: {name}", ours, row[name], error)
        interval = test.interval(level)
        for index, name in enumerate(["ci_low", "ci_high"]):
            ours = None if interval is None else interval[index]
            error = 0.08 * (interval[1] - interval[0]) if drawn and interval else 1e-9
            self.same(f"{what}: {name}", ours, row[name], error)


def rows(report, name):
    with open(Path(report) / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def summary(runs, report, check):
    for row in rows(report, "summary"):
        key = (row["environment"], row["curriculum"], row["variant"])
        curves = list(runs[key].values())
        check.same(f"{key}: seeds", len(curves), row["n_seeds"])
        for name, measure in [("final", final), ("auc", area)]:
            values = np.array([measure(curve) for curve in curves])
            check.same(f"{key}: {name}_mean", values.mean(), row[f"{name}_mean"])
            check.same(f"{key}: {name}_std", values.std(ddof=1), row[f"{name}_std"])
        for percent in (50, 80):
            steps = sorted(steps_to(curve, percent / 100) for curve in curves)
            median = steps[(len(steps) + 1) // 2 - 1]
            check.same(f"{key}: steps_to_{percent}", None if math.isinf(median) else median, row[f"steps_to_{percent}"])


def ledger(runs, report, check):
    found = {row["claim"]: row for row in rows(report, "ledger")}
    teach = ("teach", "default")
    present = {key[1:] for key in runs}
    level = ALPHA / len(BASELINES)
    for kind, measure, rule in [
        ("final", final, versus), ("area", area, versus), ("area-low", area, versus), ("consistent", final, consistent),
    ]:
        for baseline in BASELINES:
            if (baseline, "default") in present:
                effect, row = Effect(runs, teach, (baseline, "default"), measure), found[f"{kind}-{baseline}"]
                check.same(row["claim"], rule(effect, level), row["verdict"])
                check.effect(row["claim"], effect, row, level)
    effect, row = Effect(runs, teach, ("her-iid-pool", "default"), final), found["control-her-iid-pool"]
    check.same(row["claim"], versus(effect, ALPHA), row["verdict"])
    check.effect(row["claim"], effect, row, ALPHA)
    if ("teach", "n3") not in present:
        return

    def against(variants, other, measure):
        return {variant: Effect(runs, ("teach", variant), ("teach", other), measure) for variant in variants}

    windows = against(["n3", "n5", "n20"], "default", final)
    deltas = against(["d5", "d10", "d50"], "default", final)
    areas = against(["d5", "d10", "d50"], "default", area)
    noises, small = against(["n20"], "default", noise), against(["n3"], "default", noise)
    smooth = against(["n3+target-critic"], "n3", final)
    verdicts = {
        "window": equivalent(list(windows.values()), 2),
        "window-best": somewhere_best(list(windows.values())),
        "window-noise": some(list(noises.values()), -1),
        "window-noise-small": some(list(small.values()), 1),
        "interplay": some(list(deltas.values()), 1),
        "interplay-area": some(list(areas.values()), 1),
        "interplay-tasks": mixed(list(deltas.values())),
        "target-confidence": not_above(list(smooth.values())),
        "target-confidence-similar": equivalent(list(smooth.values()), 2),
    }
    for claim, verdict in verdicts.items():
        check.same(claim, verdict, found[claim]["verdict"])
    symbols = {"Δ = 5": "d5", "Δ = 10": "d10", "Δ = 50": "d50", "n = 3": "n3", "n = 5": "n5", "n = 20": "n20"}
    averages = [
        ("interplay", deltas, 3), ("interplay-area", areas, 3),
        ("window-noise", noises, 1), ("window-noise-small", small, 1),
    ]
    for claim, effects, tests in averages:
        effect = effects[symbols[found[claim]["value"]]]
        check.effect(claim, effect, found[claim], ALPHA / tests)
    check.effect("target-confidence", smooth["n3+target-critic"], found["target-confidence"], ALPHA / 2)


def readings(runs, report, check):
    """Claims about baselines under readings: TEACH's variant is the one whose settings the row names."""
    named = {
        frozenset(): "default", frozenset(["argmax"]): "argmax", frozenset(["replay"]): "replay",
        frozenset(["replay", "argmax"]): "replay+argmax", frozenset(["initial"]): "initial",
        frozenset(["initial", "argmax"]): "initial+argmax", frozenset(["pool"]): "goals=pool",
    }
    claims = {}
    for row in rows(report, "readings"):
        if row["claim"]:
            claims.setdefault((row["family"], row["claim"]), []).append(row)
    for (family, claim), judged in claims.items():
        kind, baseline = claim.split("-", 1) if not claim.startswith("area-low") else ("area-low", claim[9:])
        measure = area if kind.startswith("area") else final
        level = ALPHA / len(judged)
        for row in judged:
            first = row["settings"].split(" (")[0]
            words = frozenset(word for word in ("argmax", "replay", "initial", "pool") if f"= {word}" in first)
            variant = named[words]
            if family:
                variant = "d10+evaluation" if "= evaluation" in first else "d10"
            outside = variant if variant == "goals=pool" else "default"
            effect = Effect(runs, ("teach", variant), (baseline, outside), measure)
            what = f"{claim} under {row['settings']} {family}"
            rule = consistent if kind == "consistent" else versus
            check.same(what, rule(effect, level), row["verdict"])
            check.effect(what, effect, row, level)


def main():
    results = Path(sys.argv[1])
    report = Path(sys.argv[2]) if len(sys.argv) > 2 else results / "report"
    runs, check = read(results), Comparison()
    summary(runs, report, check)
    ledger(runs, report, check)
    readings(runs, report, check)
    print(f"{sum(map(len, runs.values()))} runs, {check.numbers} numbers compared, {len(check.wrong)} disagree")
    for line in check.wrong:
        print(line)
    sys.exit(bool(check.wrong))


if __name__ == "__main__":
    main()
