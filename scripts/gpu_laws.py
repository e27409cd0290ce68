"""What a step of the same problem costs with each law on a GPU, for scripts/gpu_checks; scripts/benchmark laws takes the decks."""

import functools
import operator
import re

from benchmark_runs import HISTORY, ROOT, run, speed_of

try:
    import h5py
except ImportError:
    h5py = None  # then the share that yields is not told

# Of about the stiffness and strength of the clay of inputs/footing.opts. From the initial stress the soil yields near the
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
SMALL, LARGE = "", "-mesh_upper 57.6,4.45 -soil_upper 57.6,4"  # 76,800 and 1,474,560 particles
STEPS = 1000
TIME_STEP = 6e-5  # s, of the deck


def write_deck(model, parameters, path):
    """inputs/footing.opts with another law."""
    lines = [line for line in (ROOT / "inputs" / "footing.opts").read_text().splitlines()
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


def measure(program, out):
    """Prints us a step of each law and its ratio to von_mises, for strong and weak soil, in both precisions."""
    for precision in ("single", "double"):
        for weak in (False, True):
            base = None
            for model, (parameters, of_weak) in LAWS.items():
                if weak and not of_weak:
                    continue
                deck = out / f"{model}.opts"
                write_deck(model, parameters | (of_weak if weak else {}), deck)
                options = f"-options_file {deck} -backend cuda -p2g tile -precision {precision} {STRESS} -time_max_steps {STEPS}"
                us = min(speed_of(run(program, f"{options} {HISTORY} {LARGE}", out / "laws"))["us"] for _ in range(2))
                run(program, f"{options} {SMALL} -progress off -output_interval {STEPS * TIME_STEP / 4}", out / "laws")
                share = yielding(sorted((out / "laws").glob("frames/frame_*.h5")))
                base = base or us
                yields = "share that yields not known" if share is None else f"{100 * share:.3g} % yield"
                print(f"{model}, {'weak' if weak else 'strong'} soil, {precision}: {us:.4g} us a step,"
                      f" {us / base:.3f} of von_mises; {yields} (of 76,800 particles)", flush=True)
    return True
