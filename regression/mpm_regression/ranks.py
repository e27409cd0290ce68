"""regression/run --ranks 1,2,4: every case on several numbers of ranks, held against one rank.

The reference of a run is the same run on one rank, with the same back end, strategy and precision. Each number of ranks
with each partition must agree with it after 1 step and after 100 within the bounds of compare.py.
"""

from mpm_regression import cases
from mpm_regression import differences
from mpm_regression.compare import BOUNDS, finished, of_precision
from mpm_regression.row import Row, failed


def start(pool, given, case, variant, strategy):
    """Sends the runs of a variant (back end, precision, ranks, partition) to the pool: {steps: {run: future}}."""
    backend, precision, ranks, partition = variant
    folder = given.out / "ranks" / case.name / "-".join([*variant[:2], strategy, ranks, partition])
    options = f"{given.options} -p2g {strategy} -partition {partition} -output_interval 1e9"
    return {steps: {run: pool.submit(cases.run_program, given.binary, case, run, variant, folder / f"steps_{steps}",
                                     f"{options} -time_max_steps {steps}", int(ranks)) for run in case.runs}
            for steps in BOUNDS}


def rows(started, reference, precision):
    """Rows of a variant: how far it is apart from one rank."""
    for steps, futures in started.items():
        apart = {name: differences.largest(run, reference[steps][name])
                 for name, run in of_precision(futures, precision).items()}
        name = max(apart, key=lambda each: apart[each][0])
        yield Row(f"{steps} steps: apart at most, {name}, {apart[name][1]}", apart[name][0], 0, BOUNDS[steps]["double"],
                  "one rank", single=BOUNDS[steps]["single"])


def compare(pool, given, keep):
    """Runs all cases; calls keep(case, variant, rows of it, seconds, runs) for each variant in turn."""
    numbers = [n for n in given.ranks.split(",") if n != "1"]
    split = [(n, partition) for n in numbers for partition in given.partition.split(",")]
    todo = []
    for case in map(cases.Case, given.cases or cases.names()):
        for pair in case.variants(given.backends.split(","), given.precisions.split(",")):
            for strategy in given.strategies.split(","):
                todo.append((case, pair, strategy, start(pool, given, case, (*pair, "1", "box"), strategy),
                             {each: start(pool, given, case, (*pair, *each), strategy) for each in split}))
    for case, pair, strategy, alone, together in todo:
        for each, started in together.items():
            variant = (*pair, strategy, *each)
            try:
                reference = {steps: finished(futures) for steps, futures in alone.items()}
                seconds = sum(future.result()[1] for futures in started.values() for future in futures.values())
                keep(case, variant, list(rows(started, reference, pair[1])), seconds, {})
            except cases.ProgramFailed as error:
                keep(case, variant, [failed(error)], 0.0, {})
