"""The kinds of random decks: their names, each that of a module, and the classes there."""
import importlib

KINDS = {"axisymmetric": "Axisymmetric", "collapses": "Collapses", "compression": "Compression", "correction": "Correction",
         "contact_pairs": "ContactPairs", "courant": "Courant", "energy": "Energy", "free_field": "FreeField", "ground": "Ground", "joints": "Joints", "level": "Level", "lights": "Lights", "loads": "Loads",
         "periodic": "Periodic", "pore_flow": "PoreFlow", "probes": "Probes", "sides": "Sides", "sites": "Sites", "soils": "Soils", "stage_bodies": "StageBodies",
         "stages": "Stages", "starts": "Starts", "stiffness": "Stiffness", "symmetry": "Symmetry", "tractions": "Tractions", "rigid_pairs": "RigidPairs", "turning": "Turning",
         "water": "Water"}


def kind_of(name):
    if name not in KINDS:
        raise SystemExit(f"{name} is no kind of decks; kinds: {', '.join(sorted(KINDS))}")
    return getattr(importlib.import_module(name), KINDS[name])
