#!/usr/bin/env python3
"""Checks that docs/results.md explains each column that the program writes into history.csv, and no other.

Usage: history_columns.py PATH_TO_mpm

Short runs of wrong_input/base.opts, with options that bring every kind of column, write the headers. In the table of the page
BODY, RIGID, PART, JOINT, LOAD and PROBE stand for names, an axis x for each axis, and xx for each component of stress. Each column of a header
must match one text in code of the table's first column, and each such text a column of some header.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent / "docs" / "results.md"
HEADING = "## The history\n"
NAMES = {"BODY": "soil|boulder|bank", "RIGID": "floor|press|pipe", "PART": "rim|hub", "JOINT": "line", "LOAD": "strip", "PAIR": "boulder_bank", "PROBE": "gate|tip|toe|pier"}
PROBES = ("-probes gate,tip,toe,pier -gate_kind section -gate_axis x -gate_at 4 -tip_kind particle -tip_at {at} -toe_kind gauge -toe_at {line} "
          "-pier_kind point -pier_at {at}")
LINE = "-joints line -line_kind rod -line_bodies pipe,ground -line_point {at} -line_other_point {other}"
LOAD = "-loads strip -strip_body bank -strip_lower {lower} -strip_upper {upper} -strip_pressure 1e3"
RUNS = {
    "plane strain": "",
    "a wheel": "-pipe_free x,y,rz",
    "a wheel on a line": "-pipe_free x,y,rz -pipe_stiffness 1e3,0,1e2 " + LINE.format(at="5,4", other="7,5"),
    "a wheel in parts": "-pipe_free x,y,rz -pipe_parts rim,hub -pipe_part_forces on -rim_shape disc -rim_centre 5,4 -rim_radius 0.4 -hub_shape box "
    "-hub_lower 4.7,3.9 -hub_upper 5.8,4.1",
    "bodies that touch": "-contact_pairs boulder:bank",
    "water that flows": "-rock_water saturated -rock_porosity 0.4 -rock_grain_density 2650 -rock_permeability 1e-4",
    "particles that split": "-particle_domain split -position_correction delta",
    "stages under water with loads": "-gravity 0,-9.81 -water_level 5.2 -output_energy on -stages rest,push -rest_end equilibrium "
    + PROBES.format(at="2,1", line="2") + " " + LOAD.format(lower="0,0", upper="8,6"),
    "3D": "-dim 3 -mesh_lower 0,0,0 -mesh_upper 8,6,2 -soil_lower 0,0.5,0 -soil_upper 8,2,2 -boulder_shape ball -boulder_centre 2,3.5,1 "
    "-bank_shape box -bank_lower 6,2,0 -bank_upper 8,3,2 -floor_lower 0,0,0 -floor_upper 8,0.5,2 -press_lower 6,4.5,0 "
    "-press_upper 8,5.5,2 -press_velocity 0,-0.1,0 -pipe_parts rim,hub -pipe_part_forces on -rim_shape ball -rim_centre 5,4.5,1 "
    "-rim_radius 0.4 -hub_shape box -hub_lower 4.7,4.4,0.9 -hub_upper 5.8,4.6,1.1 -pipe_free x,y,z,rx,ry,rz -mesh_xmin fixed -mesh_zmin friction -mesh_zmin_friction 0.3 "
    "-pipe_viscosity 0,0,0,1,0,0 " + LINE.format(at="5,4.5,1", other="7,5,1.5") + " "
    + PROBES.format(at="2,1,1", line="2,1") + " " + LOAD.format(lower="0,0,0", upper="8,6,2"),
}


def patterns():
    """{text: regular expression} of the first column of the table under "The history"."""
    section = PAGE.read_text().split(HEADING)[1].split("\n## ")[0]
    texts = [text for row in re.findall(r"^\| (`.*?) \|", section, re.M) for text in re.findall(r"`([^`]+)`", row)]
    return {text: expression(text) for text in texts}


def expression(text):
    """wall_xmin_force_x: any side and any axis; BODY_xq999, PROBE_stress_xx and so on likewise."""
    for word, names in NAMES.items():
        text = text.replace(word, f"({names})")
    text = re.sub(r"_xx$", "_(xx|yy|zz|xy|yz|zx)", text)
    text = text.replace("wall_xmin_", "wall_[xyz](min|max)_")
    return re.compile(re.sub(r"_x(min|max|q999)?$", r"_[xyz]\1", text))


def header(binary, options):
    """The columns of a run of base.opts with options, what went wrong as a line, or None where the program was built without -dim 3."""
    with tempfile.TemporaryDirectory() as folder:
        deck = HERE / "wrong_input" / "base.opts"
        lines = [line.split(maxsplit=1) for line in deck.read_text().splitlines() if line.startswith("-")]
        given = re.findall(r"(?:^|\s)-([a-z]\w*)", options)
        left_out = {"bank_polygon"} if "bank_shape" in given else set()
        left_out |= {"pipe_shape", "pipe_centre", "pipe_radius"} if "pipe_parts" in given else set()
        left_out |= {"rock_density"} if "rock_water" in given else set()
        copy = pathlib.Path(folder) / "deck.opts"
        copy.write_text("\n".join(" ".join(words) for words in lines if words[0].lstrip("-") not in left_out) + "\n")
        command = [binary, "-options_file", str(copy), *options.split(), "-backend", "serial", "-p2g", "sequential",
                   "-output_frames", "off", "-output_dir", "out"]
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
        path = pathlib.Path(folder) / "out" / "history.csv"
        if result.returncode == 2 and "mpm: -dim: " in result.stderr:  # a build without 3D
            return None
        if result.returncode != 0 or not path.exists():
            return f"status {result.returncode}: {result.stderr.strip()}"
        return path.read_text().splitlines()[0].split(",")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    binary, table = str(pathlib.Path(sys.argv[1]).resolve()), patterns()
    faults, seen = [], set()
    for name, options in RUNS.items():
        columns = header(binary, options)
        if columns is None:
            continue
        if isinstance(columns, str):
            faults.append(f"{name}: {columns}")
            continue
        for column in columns:
            found = [text for text, pattern in table.items() if pattern.fullmatch(column)]
            seen.update(found)
            if not found:
                faults.append(f"{name}: the table has no {column}")
    faults += [f"no run writes {text}" for text in table if text not in seen]
    print("\n".join(faults) or f"{len(table)} kinds of columns: the table has those of {len(RUNS)} runs")
    sys.exit(1 if faults else 0)


main()
