"""What a step costs with each law on one core of a processor, over a step with von_mises, for strong and weak soil (gpu_laws.py).

The laws take turns, so that a machine that slows down does so for all of them, and of the repeats of a law the shortest counts:
whatever else the machine does makes a run longer, never shorter.
"""

from datetime import date

from benchmark_runs import HISTORY, commit, run, speed_of
from benchmark_tables import digits, number, table
from gpu_laws import LAWS, STRESS, TIME_STEP, write_deck, yielding

STEPS = 250  # the soil moves too little to be sorted anew
BASE = "von_mises"


def cases(precisions, words):
    """Precision, and whether the soil is weak, with the laws that take turns there: those given, or all; von_mises is one."""
    wanted = [BASE, *(word for word in (words.split(",") if words else LAWS) if word != BASE)]
    for word in wanted:
        if word not in LAWS:
            raise SystemExit(f"benchmark: --laws: given \"{words}\", takes names of {','.join(LAWS)}")
    return [(precision, weak, [law for law in wanted if LAWS[law][1] or not weak]) for weak in (False, True) for precision in precisions]


def measure(program, precision, weak, laws, repeats, folder):
    """A result of each law: us a step of all repeats and the shortest, and the share of the particles that yield in the last quarter
    of the steps, None where it is not known."""
    decks = {}
    for law in laws:
        decks[law] = folder / f"{law}.opts"
        folder.mkdir(parents=True, exist_ok=True)
        parameters, of_weak = LAWS[law]
        write_deck(law, parameters | (of_weak if weak else {}), decks[law])
    options = f"-backend serial -p2g tile -precision {precision} {STRESS} -time_max_steps {STEPS}"
    turns = [{law: speed_of(run(program, f"-options_file {decks[law]} {options} {HISTORY}", folder / "run")) for law in laws}
             for _ in range(repeats)]
    results = []
    for law in laws:
        run(program, f"-options_file {decks[law]} {options} -progress off -output_interval {STEPS * TIME_STEP / 4}", folder / "run")
        share = yielding(sorted((folder / "run").glob("frames/frame_*.h5")))
        best = min((turn[law] for turn in turns), key=lambda each: each["us"])
        results.append({"kind": "laws", "problem": law, "soil": "weak" if weak else "strong", "precision": precision,
                        "backend": "serial", "particles": best["count"], "us": best["us"],
                        "all_us": [turn[law]["us"] for turn in turns], "yields": share, "machine": best["machine"],
                        "device": best["device"], "functions": best["functions"], "date": date.today().isoformat(),
                        "commit": commit()})
    return results


def cell(each, base):
    """us a step, its ratio to that of the base, and the share that yields."""
    if each is None or base is None:
        return "-"
    share = "" if each["yields"] is None else f", {digits(100 * each['yields'])} %"
    return f"{number(each['us'])} ({each['us'] / base['us']:.2f}{share})"


def text_of(runs):
    found = {(each["problem"], each["soil"], each["precision"]): each for each in runs}
    columns = [(soil, precision) for soil in ("strong", "weak") for precision in ("single", "double")
               if (BASE, soil, precision) in found]
    rows = [[f"`{law}`", *(cell(found.get((law, *column)), found[(BASE, *column)]) for column in columns)]
            for law in LAWS if any((law, *column) in found for column in columns)]
    about = sorted({f"{each['machine']}, {each['device']}; {each['date']}, commit {each['commit']}, the shortest of "
                    f"{len(each['all_us'])} runs that took turns" for each in runs})
    particles = " and ".join(sorted({f"{each['particles']:,}" for each in runs}))
    return "\n\n".join([f"us a step of the footing of {particles} particles (over that of `{BASE}`, share of the particles that yield):",
                        table(["law", *(f"{soil} soil, {precision}" for soil, precision in columns)], rows), "Measured on",
                        "\n".join(f"- {each}" for each in about)])
