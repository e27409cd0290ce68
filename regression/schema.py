#!/usr/bin/env python3
"""Holds the conditions of `mpm -schema` against the program: an option that has a place only where another one has some value must be
refused with every other value of it, and taken with these.

Usage: regression/schema.py PATH_TO_mpm
"""
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys
import tempfile

# What NAME stands for, by the option that lists it; a stage's options begin with its name.
NAMES = {"materials": "clay", "bodies": "soil", "rigid_bodies": "plate", "joints": "link", "loads": "push", "probes": "gauge1",
         "water_regions": "pool", "contact_pairs": "soil_cap", "stages": "first"}
DECK = """-dim {dim} -mesh_lower {zero} -mesh_upper {size} -mesh_spacing 1 -time_end 1 -gravity {gravity}
-materials clay -clay_model linear_elastic -clay_density 1000 -clay_young 1e6 -clay_poisson 0.3
-bodies soil,cap -soil_material clay -cap_material clay -cap_shape box -cap_lower {cap_lower} -cap_upper {cap_upper}
-soil_shape box -soil_lower {zero} -soil_upper {soil}
-rigid_bodies plate,other -plate_shape box -plate_lower {plate_lower} -plate_upper {plate_upper} -plate_density 1000
-other_shape box -other_lower {other_lower} -other_upper {other_upper}
-loads push -push_body soil -push_lower {zero} -push_upper {size} -push_pressure 1 -water_level 1 -water_regions pool
-pool_lower {zero} -pool_upper {soil} -joints link -link_kind ball -link_bodies plate,ground -link_point {plate_lower}
-probes gauge1 -gauge1_kind point -gauge1_at {soil} -contact_pairs soil:cap"""
PLACES = {"zero": (0, 0), "size": (20, 20), "soil": (8, 2), "gravity": (0, -10), "cap_lower": (0, 2), "cap_upper": (2, 3),
          "plate_lower": (4, 4), "plate_upper": (6, 6), "other_lower": (10, 10), "other_upper": (12, 12)}
# Values that the refusal of one option by another would hide behind another mistake.
LEFT_OUT = {
    "STAGE_end": "the name of an option that a stage alone has",
}


def deck_of(dim):
    """{option: value} of the deck in 2D or 3D."""
    places = {key: ",".join(map(str, [x, *[0 if x == 0 or key == "gravity" else x] * (dim - 2), y])) for key, (x, y) in PLACES.items()}
    words = DECK.format(dim=dim, **places).split()
    return dict(zip([word[1:] for word in words[::2]], words[1::2]))


def value_of(option):
    """Some value of an option's kind; it may be wrong in other ways."""
    kind = option["type"]
    lowest = (option.get("range") or {}).get("lowest") or 0
    return {"number": str(lowest + 1), "integer": str(int(lowest) + 1), "text": "none.h5", "flag": "on", "list": "0,1",
            "numbers": option.get("form", "")}.get(kind) or option.get("choices", ["none"])[0]


def instances(name, owners):
    """The option by the names of the deck; the name of a rigid body comes from either list."""
    if not name.startswith(("NAME_", "STAGE_")):
        return [name]
    ending = name.partition("_")[2]
    return [f"{NAMES[owner]}_{ending}" for owner in owners if owner in NAMES]


def refusals(mpm, options):
    """Options, in lower case, that the program refuses as having no place."""
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "deck.opts"
        deck.write_text("".join(f"-{name} {value}\n" for name, value in options.items()))
        done = subprocess.run([mpm, "-options_file", deck, "-dry_run"], capture_output=True, text=True, cwd=folder, check=False)
    return set(re.findall(r'^mpm: -(\w+): given ".*", takes nothing', done.stderr, re.MULTILINE))


def trials(schema):
    """(dim, chooser, its value or None, {option: whether it has a place}) for each value of each option on which others depend."""
    known = {}
    for option in schema["options"]:
        for name in instances(option["name"], option.get("owners", [])):
            known.setdefault(name, option)
    wanted = {}
    for option in schema["options"]:
        if option["name"].startswith("STAGE_"):
            continue
        for condition in option.get("where", []):
            for owner in option.get("owners") or [None]:
                chooser, name = [instances(text, [owner])[0] for text in (condition["option"], option["name"])]
                wanted.setdefault(chooser, {}).setdefault(name, []).append((condition, option))
    for chooser, by_name in wanted.items():
        if chooser not in known:
            continue
        choices = known[chooser].get("choices") or [None]
        for dim in (2, 3):
            for choice in choices:
                has_place = {}
                for name, pairs in by_name.items():
                    fits = [choice in condition["is"] if condition["is"] else not condition["given"] for condition, _ in pairs]
                    has_place[name] = (any(fits), pairs[0][1])
                yield dim, chooser, choice, has_place


def check(mpm, trial):
    """Lines about options that the program takes or refuses against the schema."""
    dim, chooser, choice, has_place = trial
    options = deck_of(dim)
    if choice is None:
        options.pop(chooser, None)
    elif chooser != "dim":
        options[chooser] = choice
    elif int(choice) != dim:
        return []
    given = {name: value_of(option) for name, (_, option) in has_place.items()}
    refused = refusals(mpm, {**options, **given})
    lines = []
    for name, (fits, _) in has_place.items():
        if not fits and name not in refused:
            lines.append(f"-{name} is taken in {dim}D with -{chooser} {choice}, and the schema says that it has no place")
        if fits and choice is not None and name in refused and not depends(has_place[name][1], chooser, dim):
            lines.append(f"-{name} is refused in {dim}D with -{chooser} {choice}, and the schema says that it has a place")
    return lines


def depends(option, chooser, dim):
    """Whether an option has a further condition, which the deck may not fulfil."""
    others = [each for each in option.get("where", []) if not chooser.endswith(each["option"].partition("_")[2])]
    return bool(others)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    mpm = pathlib.Path(sys.argv[1]).resolve()
    schema = json.loads(subprocess.run([mpm, "-schema"], capture_output=True, text=True, check=True).stdout)
    cases = list(trials(schema))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        lines = [line for of_case in pool.map(lambda trial: check(mpm, trial), cases) for line in of_case]
    for line in lines:
        print(line)
    print(f"schema: {len(cases)} decks, {len(lines)} differences")
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
