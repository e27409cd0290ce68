"""regression/run --compare: every case on several back ends and with every strategy, held against one another.

The reference of a run is the same run on the first back end with the first strategy, in the same precision. Each other one
must agree with it after 1 step and after 100 within BOUNDS (differences.py says of what), and must give the case's own
answers at its end. `gather` and `sequential` in double precision must give the same bits when they run again.
"""

from collections import namedtuple

from mpm_regression import cases
from mpm_regression import differences
from mpm_regression.row import Row, failed

STRATEGIES = ("sequential", "atomic", "mosaic", "gather", "tile")
REPEATABLE = ("sequential", "gather")
# Friction that starts or stops to slip amplifies round-off: by 1e5 in 100 steps of a block on an incline.
BOUNDS = {1: {"double": 1e-12, "single": 5e-6}, 100: {"double": 1e-9, "single": 5e-2}}
Started = namedtuple("Started", "short again whole")  # {steps: {run: future}}, {run: future}, {run: future}


def variants(case, backends, precisions, strategies):
    """(back end, precision, strategy) of a case, by precision: the reference comes first."""
    pairs = case.variants(backends, precisions)
    return [(backend, precision, strategy) for wanted in precisions for backend, precision in pairs if precision == wanted
            for strategy in strategies]


def start(pool, given, case, variant):
    """Sends all runs of a variant to the pool."""
    backend, precision, strategy = variant

    def send(kind, more):
        folder = given.out / "compare" / case.name / "-".join(variant) / kind
        options = f"{given.options} -p2g {strategy} {more}"
        return {run: pool.submit(cases.run_program, given.binary, case, run, variant, folder, options) for run in case.runs}

    few = {steps: f"-time_max_steps {steps} -output_interval 1e9" for steps in BOUNDS}
    twice = precision == "double" and strategy in REPEATABLE
    return Started({steps: send(f"steps_{steps}", few[steps]) for steps in BOUNDS},
                   send("again", few[max(BOUNDS)]) if twice else {}, {} if given.short else send("whole", ""))


def finished(futures):
    return {name: future.result()[0] for name, future in futures.items()}


def of_precision(futures, precision):
    """The runs done, but for those that choose another precision themselves."""
    return {name: run for name, run in finished(futures).items() if run.text("precision") == precision}


def rows(case, variant, started, reference):
    """Rows of a variant: apart from the reference, the same bits twice, the case's own answers."""
    source = "-".join(variant[:1] + variant[2:])
    for steps, futures in started.short.items():
        if variant is not reference["variant"]:
            apart = {name: differences.largest(run, reference[steps][name])
                     for name, run in of_precision(futures, variant[1]).items()}
            name = max(apart, key=lambda each: apart[each][0])
            why, bound = getattr(case.module, "APART", ("", 0.0)) if (steps, variant[1]) == (1, "single") else ("", 0.0)
            yield Row(f"{steps} steps: apart at most, {name}, {apart[name][1]}", apart[name][0], 0,
                      BOUNDS[steps]["double"], "-".join(reference["variant"]), single=BOUNDS[steps]["single"],
                      shortfall=why, bound=bound)
    again = finished(started.again)
    if again:
        first = of_precision(started.short[max(BOUNDS)], variant[1])
        count = sum(differences.differing(run, again[name]) for name, run in first.items())
        yield Row(f"{max(BOUNDS)} steps twice: values whose bits differ", count, 0, 0, source)
    if started.whole:
        yield from case.module.check(finished(started.whole))


def compare(pool, given, keep):
    """Runs all variants of the cases; calls keep(case, variant, rows of them, seconds, runs) for each in turn."""
    todo = []
    for case in map(cases.Case, given.cases or cases.names()):
        for variant in variants(case, given.compare.split(","), given.precisions.split(","), given.strategies.split(",")):
            todo.append((case, variant, start(pool, given, case, variant)))
    reference = {}
    for case, variant, started in todo:
        futures = [future for group in (*started.short.values(), started.again, started.whole) for future in group.values()]
        try:
            seconds = sum(future.result()[1] for future in futures)
            if reference.get("of") != (case.name, variant[1]):
                reference = {"of": (case.name, variant[1]), "variant": variant,
                             **{steps: finished(runs) for steps, runs in started.short.items()}}
            keep(case, variant, list(rows(case, variant, started, reference)), seconds, finished(started.short[1]))
        except cases.ProgramFailed as error:
            keep(case, variant, [failed(error)], 0.0, {})
