"""Brings the data of a `goalbench report` to other tools: `python convert_report.py TOOL REPORT OUT`.

REPORT is the folder RESULTS/report. TOOL and OUT are one of

    rliable    OUT.json: {"auc": SCORES, "final_success": SCORES, "tasks": [...], "seeds": {METHOD: [...]}}, where SCORES
               is {METHOD: [[of every task] of every seed]}; `np.array` of each value makes it rliable's dictionary
    marl-eval  OUT.json: environment, task, method, seed and step, as marl-eval reads raw data
    mlflow     tracking URI of MLflow, such as sqlite:///mlflow.db; needs `mlflow`
    wandb      folder for offline runs of Weights & Biases, which `wandb sync` uploads; needs `wandb`

Runs that have not finished are left out and named on standard error.
"""
import csv, json, sys
from collections import defaultdict
from pathlib import Path

KEY = ("environment", "curriculum", "variant", "seed")


def read(report, name):
    with open(Path(report) / f"{name}.csv", newline="") as file:
        return list(csv.DictReader(file))


def key_of(row):
    return row["environment"], row["curriculum"], row["variant"], int(row["seed"])


def name_of(key):
    return "/".join(map(str, key))


def method_of(key):
    _, curriculum, variant, _ = key
    return curriculum if variant == "default" else f"{curriculum}/{variant}"


def leave_out(what):
    print(f"left out: {what}", file=sys.stderr)


def finished(report):
    """The rows of `runs.csv` that have finished, and those of `records.csv` for each, by run."""
    runs = {key_of(row): row for row in read(report, "runs")}
    for key in [key for key, row in runs.items() if row["status"] != "finished"]:
        leave_out(f"{name_of(key)}, which is {runs.pop(key)['status']}")
    records = defaultdict(list)
    for row in read(report, "records"):
        if key_of(row) in runs:
            records[key_of(row)].append(row)
    return runs, records


def identity(key, row):
    return dict(zip(KEY, key)) | {"config_hash": row["config_hash"]}


def numbers(record):
    """What an evaluation recorded, by name, without what is empty."""
    return {name: float(value) for name, value in record.items() if name not in (*KEY, "step", "eval_index") and value}


def write(out, document):
    Path(f"{out}.json").write_text(json.dumps(document, indent=1))


def rliable(report, out):
    runs, _ = finished(report)
    tasks = sorted({environment for environment, *_ in runs})
    rows = defaultdict(lambda: defaultdict(dict))
    for key, row in runs.items():
        rows[method_of(key)][key[3]][key[0]] = row
    # A matrix of scores has no holes.
    for method, seeds in rows.items():
        for seed in [seed for seed, of_task in seeds.items() if len(of_task) < len(tasks)]:
            leave_out(f"seed {seed} of {method}, which lacks {sorted(set(tasks) - set(seeds.pop(seed)))}")
    rows = {method: dict(sorted(seeds.items())) for method, seeds in rows.items() if seeds}
    document = {"tasks": tasks, "seeds": {method: list(seeds) for method, seeds in rows.items()}}
    for score in ("auc", "final_success"):
        document[score] = {method: [[float(of_task[task][score]) for task in tasks] for of_task in seeds.values()]
                           for method, seeds in rows.items()}
    write(out, document)


def marl_eval(report, out):
    runs, records = finished(report)
    document = defaultdict(lambda: defaultdict(lambda: defaultdict(dict)))
    for key in runs:
        curve, steps = {}, [int(record["step"]) for record in records[key]]
        for index, (step, record) in enumerate(zip(steps, records[key])):
            metrics = {name: [float(record[name])] for name in ("success_rate", "mean_return")}
            curve[f"step_{index}"] = {"step_count": step, **metrics}
        curve["absolute_metrics"] = metrics
        # marl-eval compares tasks only if they were evaluated equally often: each such set is an environment.
        document[f"{len(steps)} evaluations to step {steps[-1]}"][key[0]][method_of(key)][f"seed_{key[3]}"] = curve
    write(out, document)


def mlflow(report, out):
    from mlflow.entities import Metric, Param
    from mlflow.tracking import MlflowClient

    runs, records = finished(report)
    client = MlflowClient(tracking_uri=out)
    experiment = client.create_experiment(Path(report).resolve().parent.name)
    for key, row in runs.items():
        run = client.create_run(experiment, run_name=name_of(key)).info.run_id
        client.log_batch(run, params=[Param(name, str(value)) for name, value in identity(key, row).items()])
        for record in records[key]:
            metrics = [Metric(name, value, 0, int(record["step"])) for name, value in numbers(record).items()]
            client.log_batch(run, metrics=metrics)
        client.set_terminated(run)


def wandb(report, out):
    import wandb

    runs, records = finished(report)
    Path(out).mkdir(parents=True, exist_ok=True)
    for key, row in runs.items():
        names = {"name": name_of(key), "group": f"{key[0]}/{method_of(key)}"}
        with wandb.init(mode="offline", dir=out, project="goalbench", config=identity(key, row), **names) as run:
            for record in records[key]:
                step = int(record["step"])
                run.log({"global_step": step, **numbers(record)}, step=step)


TOOLS = {"rliable": rliable, "marl-eval": marl_eval, "mlflow": mlflow, "wandb": wandb}

if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in TOOLS:
        sys.exit(__doc__)
    TOOLS[sys.argv[1]](*sys.argv[2:])
