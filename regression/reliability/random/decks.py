"""The kinds of random decks: their names, each that of a module, and the classes there."""
import importlib

KINDS = {"correction": "Correction", "free_field": "FreeField", "loads": "Loads", "periodic": "Periodic", "probes": "Probes",
         "sides": "Sides", "stiffness": "Stiffness", "tractions": "Tractions"}


def kind_of(name):
    if name not in KINDS:
        raise SystemExit(f"{name} is no kind of decks; kinds: {', '.join(sorted(KINDS))}")
    return getattr(importlib.import_module(name), KINDS[name])
