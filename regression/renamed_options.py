#!/usr/bin/env python3
"""Former names of options: a run with them gives the same bits, and so does a restart from a checkpoint that holds them.

    regression/renamed_options.py PATH_TO_mpm
"""
import json
import pathlib
import sys
import tempfile

import numpy as np

sys.dont_write_bytecode = True

from mpm_regression import folders  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent

FORMER = {"rebuild_margin": "p2g_margin", "flip_fraction": "flip_share", "f_bar_fraction": "f_bar_share",
          "rigid_bodies": "rigids", "shear_fraction": "shear_share", "contact_gap_scaling": "contact_penalty",
          "contact_gap_reach": "penalty_reach", "contact_gap_exponent": "penalty_exponent"}
MORE = """
-rebuild_margin 0.3
-flip_fraction 0.99
-f_bar_fraction 0.9
-stone_shear_fraction 0.5
-plate_contact_gap_scaling none
-stone_contact_gap_reach 0.2
-stone_contact_gap_exponent 3
"""


def with_former(text):
    """The text with the former name of each option."""
    for name, former in FORMER.items():
        text = text.replace(name, former)
    return text


def options_with_former(file):
    """Puts the former names into the options of a checkpoint."""
    text = file["options"][()].tobytes().decode()
    del file["options"]
    file["options"] = np.frombuffer(with_former(text).encode(), dtype="u1")


def expect(condition, message):
    if not condition:
        sys.exit(f"renamed_options: {message}")


def main():
    binary = pathlib.Path(sys.argv[1]).absolute()
    with tempfile.TemporaryDirectory(prefix="mpm_renamed_") as base:
        base = pathlib.Path(base)
        text = (HERE / "reliability" / "small.opts").read_text() + MORE
        (base / "now.opts").write_text(text)
        (base / "former.opts").write_text(with_former(text))
        short = ("-time_end", 0.02, "-backend", "serial", "-p2g", "tile", "-checkpoint_interval", 0.01)
        for name in ("now", "former"):
            done = folders.run(binary, base / f"{name}.opts", base / name, *short)
            notes = [line for line in done.stdout.splitlines() if line.startswith("mpm: note: ")]
            logged = [line for line in (base / name / "mpm.log").read_text().splitlines()
                      if line.startswith("mpm: note: ")]
            expect(notes == logged, f"{name}: the log has other notes than the terminal")
            expect(len(notes) == (len(FORMER) if name == "former" else 0), f"{name}: the notes are {notes}")
        found = folders.differences(base / "now", base / "former")
        expect(not found, f"results differ: {found[:5]}")
        kept = [json.loads((base / name / "options.json").read_text())["options"] for name in ("now", "former")]
        for options in kept:
            options.pop("output_dir")
        expect(kept[0] == kept[1], "options.json differs")
        mark = folders.checkpoints(base / "now")[0]
        folders.change_sealed(mark, options_with_former)
        folders.run(binary, base / "now.opts", base / "now", *short, "-restart", mark)
        found = folders.differences(base / "now", base / "former")
        expect(not found, f"results differ after a restart: {found[:5]}")
    print(f"{len(FORMER)} former names: the same bits, also after a restart")


if __name__ == "__main__":
    main()
