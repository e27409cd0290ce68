#!/usr/bin/env python3
"""Holds the conditions of `mpm -schema` against the program. Each option on which others depend gets each of its values in a deck that
gives these others too: the program must refuse those that have no place by the schema, and take the others.

Usage: regression/schema.py PATH_TO_mpm
"""
import concurrent.futures
import pathlib
import re
import subprocess
import sys
import tempfile

import mpm_regression  # noqa: F401, puts the package on the path
from soil_mpm.deck import Deck
from soil_mpm.deck_text import DeckText
from soil_mpm.problems import UnknownOption
from soil_mpm.schema import Schema

DECK = """-dim {dim} -mesh_lower {zero} -mesh_upper {size} -mesh_spacing 1 -time_end 1 -gravity {gravity}
-materials clay -clay_model von_mises -clay_density 1000 -clay_young 1e6 -clay_poisson 0.3 -clay_su 1000
-bodies soil,cap -soil_material clay -cap_material clay -cap_shape box -cap_lower {cap_lower} -cap_upper {cap_upper}
-soil_shape box -soil_lower {zero} -soil_upper {soil}
-rigid_bodies plate,other -plate_shape box -plate_lower {plate_lower} -plate_upper {plate_upper} -plate_motion dynamic -plate_density 1000
-other_shape box -other_lower {other_lower} -other_upper {other_upper}
-loads push -push_body soil -push_lower {zero} -push_upper {size} -push_pressure 1 -water_level 1 -water_regions pool
-pool_lower {zero} -pool_upper {soil} -joints link -link_kind ball -link_bodies plate,ground -link_point {plate_lower}
-probes gauge1 -gauge1_kind point -gauge1_at {soil} -contact_pairs soil:cap"""
PLACES = {"zero": (0, 0), "size": (20, 20), "soil": (8, 2), "gravity": (0, -10), "cap_lower": (0, 2), "cap_upper": (2, 3),
          "plate_lower": (4, 4), "plate_upper": (6, 6), "other_lower": (10, 10), "other_upper": (12, 12)}
TWINS = ("cap_", "other_", "mesh_xmax", "mesh_ymin", "mesh_ymax", "mesh_zmax")  # read as the options of another name are
SPATIAL = ("_shape", "_kind", "mesh_zmin")  # what depends on them is different in 3D
# Options whose refusal has other words than "nothing here", or depends on more than a condition says.
EXCEPTIONS = {
    "part_forces": "-NAME_part_forces off is taken of a body of one shape",
    "parts": "-NAME_parts makes other options wrong, whose own places the program then does not tell",
    "contact": "where contact acts by default depends on the motion and the shape (docs/contact.md)",
    "axis": "a hinge in 2D has no axis",
    "stop_deg": "a ball in 3D has no stops",
    "density": "a mass beside it makes it wrong, by other words",
    "tip_angle_deg": "of a cone with a height",
    "geometry": "has its own words with -dim 3",
    "xpic_order": "the default of -velocity_update depends on -analysis",
    "position_correction_rate": "the default of -position_correction depends on -analysis",
    "centre_of_mass": "of a body that does not turn has other words",
    "moment_point": "of a body that does not turn has other words",
}


def text_of(dim):
    """The deck in 2D or 3D."""
    places = {key: ",".join(map(str, [x, *[0 if x == 0 or key == "gravity" else x] * (dim - 2), y])) for key, (x, y) in PLACES.items()}
    return DECK.format(dim=dim, **places).replace(" -", "\n-")


def deck_of(dim, program):
    deck = Deck(program=program)
    deck._text = DeckText.of(text_of(dim))
    deck._known.clear()
    return deck


def value_of(option, dim):
    """Some value of an option's kind; it may be wrong in other ways."""
    low, high = option.lowest or 0, 1e9 if option.highest is None else option.highest
    number = f"{low + min(1, (high - low) / 2):.9g}" if option.kind != "integer" else str(int(low) + 1)
    numbers = ",".join(number for _ in option.forms[dim == 3].split(","))
    return {"number": number, "integer": number, "text": "0:1,1:1", "flag": "on", "list": "0,1", "numbers": numbers,
            "word": next(iter(option.choices), "none")}[option.kind]


def errors(program, deck):
    """{option in lower case: its line on stderr}."""
    with tempfile.TemporaryDirectory() as folder:
        path = deck.write(pathlib.Path(folder) / "deck.opts")
        done = subprocess.run([program, "-options_file", path, "-dry_run"], capture_output=True, text=True, cwd=folder, check=False)
    return {found[1].lower(): found[0] for found in re.finditer(r"^mpm: -(\w+): .*$", done.stderr, re.MULTILINE)}


def trials(schema):
    """(dim, option on which others depend, its value or None for not given, these others)."""
    for dim in (2, 3):
        deck = deck_of(dim, PROGRAM)
        choosers = {}
        for option in schema.instances({**deck.names(), "stages": []}):
            for condition in option.where:
                choosers.setdefault(condition.option, set()).add(option.name)
        for chooser, others in choosers.items():
            if chooser.startswith(TWINS) or (dim == 3 and not chooser.endswith(SPATIAL)):
                continue
            try:
                options = schema.find(chooser, deck.names())
            except UnknownOption:  # -soil_parts, since only rigid bodies have parts
                continue
            if chooser != "dim":
                yield from ((dim, chooser, choice, sorted(others)) for choice in [*options[0].choices, None])


def is_exception(name):
    return any(name == key or name.endswith("_" + key) for key in EXCEPTIONS)


def check(trial):
    """Lines about options that the program takes or refuses against the schema."""
    dim, chooser, choice, others = trial
    deck = deck_of(dim, PROGRAM)
    for name in {chooser, *others}:
        deck._text.remove(name.lower())
    deck._known.clear()
    if choice is not None:
        deck[chooser] = choice
    for name in others:
        deck[name] = value_of(deck.option(name), dim)
    said = errors(PROGRAM, deck)
    if chooser in said or is_exception(chooser):  # a wrong choice hides what depends on it
        return []
    lines = []
    for name in filter(lambda name: not is_exception(name), others):
        refused = "takes nothing here: " in said.get(name.lower(), "") and "needs a material" not in said[name.lower()]
        where = deck.why_no_place(name)
        if bool(where) != refused:
            what = f"has a place only where {where}" if where else f"has a place; the program: {said[name.lower()]}"
            lines.append(f"{dim}D, -{chooser} {choice}: -{name} by the schema {what}")
    return lines


def main():
    schema = Schema.of_program(PROGRAM)
    all_trials = list(trials(schema))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        lines = [line for found in pool.map(check, all_trials) for line in found]
    print("\n".join([*lines, f"schema: {len(all_trials)} decks, {len(lines)} differences"]))
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    PROGRAM = pathlib.Path(sys.argv[1]).resolve()
    main()
