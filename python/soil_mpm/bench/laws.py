"""Time of a step with each law on one core of a processor or on a GPU, over a step with von_mises, for strong and weak soil.

The laws take turns, so that a machine that slows down does so for all of them, and of the repeats of a law the shortest counts:
whatever else the machine does makes a run longer, never shorter.
"""

import functools
import operator
import re
from datetime import date

from soil_mpm.bench.runs import HISTORY, commit, run, speed_of
from soil_mpm.bench.tables import digits, number, table
from soil_mpm.tree import ROOT

try:
    import h5py
except ImportError:
    h5py = None  # then the share that yields is left out

# Stiffness and strength are about those of the clay of inputs/footing.opts. From the initial stress the soil yields near the
# footing; `weak` lets all soil yield as it expands at its surface and slides.
STIFF = {"young": 1.5e6, "poisson": 0.3}
GRAINS = {"mu_static": 0.38, "mu_dynamic": 0.64, "inertial_number": 0.28, "grain_diameter": 1e-3, "grain_density": 2500}
STATE = {"lambda": 0.2, "kappa": 0.05, "poisson": 0.3, "specific_volume": 2}
SOFT = {"remoulded_ratio": 0.3, "xi95": 10}
LAWS = {  # model: parameters, and those of weak soil
    "von_mises": (STIFF | {"su": 3000}, {"su": 3}),
    "linear_elastic": (STIFF, {}),
    "tresca": (STIFF | {"su": 3000}, {"su": 3}),
    "mohr_coulomb": (STIFF | {"cohesion": 1000, "friction_deg": 25}, {"cohesion": 1, "friction_deg": 1}),
    "drucker_prager": (STIFF | {"cohesion": 1000, "friction_deg": 25, "match": "plane_strain"},
                       {"cohesion": 1, "friction_deg": 1}),
    "mu_i": (STIFF | GRAINS, {"mu_static": 1e-3, "mu_dynamic": 0.2}),
    "newtonian": ({"bulk_modulus": 5e6, "viscosity": 1}, {}),
    "yield_stress_fluid": ({"bulk_modulus": 5e6, "shear_modulus": 5e5, "yield_stress": 3000, "consistency": 100, "exponent": 0.5},
                           {"yield_stress": 3}),
    "power_elastic": ({"bulk_modulus": 1.5e6, "pressure_reference": 1e5, "exponent": 0.5, "poisson": 0.3}, {}),
    "j2_hardening": (STIFF | {"yield_stress": 5000, "hardening_modulus": 1e5}, {"yield_stress": 5}),
    "cam_clay": (STATE | {"critical_state_ratio": 1, "ocr": 2}, {"critical_state_ratio": 0.05, "ocr": 1}),
    "softening_clay": (STIFF | SOFT | {"su": 3000}, {"su": 3}),
}
STRESS = "-soil_stress -1e4,-1e4,-1e4,0"
TIME_STEP = 6e-5  # s, of the deck
STEPS = {"serial": 250, "cuda": 1000}  # on one core the soil moves too little to be sorted anew
LARGE = {"serial": "", "cuda": "-mesh_upper 57.6,4.45 -soil_upper 57.6,4"}  # of the timed runs: 76,800 and 1,474,560 particles
BASE = "von_mises"


def write_deck(model, parameters, path, deck="footing"):
    """inputs/DECK.opts with another law."""
    lines = [line for line in (ROOT / "inputs" / f"{deck}.opts").read_text().splitlines()
             if not re.match(r"-clay_(?!density)", line)]
    lines += [f"-clay_model {model}", *(f"-clay_{key} {value}" for key, value in parameters.items())]
    path.write_text("\n".join(lines) + "\n")


def yielding(frames):
    """Share of the particles whose plastic strain or preconsolidation changed between two frames; None if not known."""
    if h5py is None or len(frames) < 2:
        return None
    with h5py.File(frames[-2]) as before, h5py.File(frames[-1]) as after:
        names = [name for name in ("plastic_strain", "preconsolidation") if name in after["soil"]]
        changed = [before["soil"][name][:] != after["soil"][name][:] for name in names]  # frames of all laws have plastic_strain
        return float(functools.reduce(operator.or_, changed).mean()) if changed else 0.0


def cases(precisions, words):
    """Precision, and whether the soil is weak, with the laws that take turns there: those given, or all; von_mises is one."""
    wanted = [BASE, *(word for word in (words.split(",") if words else LAWS) if word != BASE)]
    for word in wanted:
        if word not in LAWS:
            raise SystemExit(f"benchmark: --laws: given \"{words}\", takes names of {','.join(LAWS)}")
    return [(precision, weak, [law for law in wanted if LAWS[law][1] or not weak]) for weak in (False, True) for precision in precisions]


def write_decks(laws, weak, folder):
    """The deck of each law, {law: path}."""
    folder.mkdir(parents=True, exist_ok=True)
    decks = {law: folder / f"{law}.opts" for law in laws}
    for law, path in decks.items():
        parameters, of_weak = LAWS[law]
        write_deck(law, parameters | (of_weak if weak else {}), path)
    return decks


def measure(program, precision, weak, laws, repeats, folder, backend="serial"):
    """A result of each law: us a step of all repeats and the shortest, and the share of 76,800 particles that yield in the last
    quarter of the steps, None where it is not known."""
    decks, steps = write_decks(laws, weak, folder), STEPS[backend]
    options = f"-backend {backend} -p2g tile -precision {precision} {STRESS} -time_max_steps {steps}"
    timed = f"{options} {HISTORY} {LARGE[backend]}"
    turns = [{law: speed_of(run(program, f"-options_file {decks[law]} {timed}", folder / "run")) for law in laws} for _ in range(repeats)]
    results = []
    for law in laws:
        run(program, f"-options_file {decks[law]} {options} -progress off -output_interval {steps * TIME_STEP / 4}", folder / "run")
        share = yielding(sorted((folder / "run").glob("frames/frame_*.h5")))
        best = min((turn[law] for turn in turns), key=lambda each: each["us"])
        results.append({"kind": "laws", "problem": law, "soil": "weak" if weak else "strong", "precision": precision,
                        "backend": backend, "particles": best["count"], "us": best["us"],
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
