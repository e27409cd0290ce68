#!/usr/bin/env python3
"""-analysis flow: the same bits as the options whose defaults it sets, also after a restart, with or without it.

    regression/analysis_defaults.py PATH_TO_mpm
"""
import pathlib
import sys
import tempfile

sys.dont_write_bytecode = True

from mpm_regression import folders  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent

FLOW = ("-analysis", "flow")
SET = ("-velocity_update", "apic", "-particle_domain", "split", "-position_correction", "delta")
SHORT = ("-time_end", 0.02, "-backend", "serial", "-p2g", "tile", "-checkpoint_interval", 0.01)
# Lines of the log where the deck gives an option of those that are set, and in a body of revolution.
NOTES = {(): "flow sets -velocity_update apic, -particle_domain split, -position_correction delta",
         ("-particle_domain", "stretch"): "flow sets -velocity_update apic, -position_correction delta; the deck gives "
                                          "-particle_domain stretch",
         SET: "flow sets nothing; the deck gives -velocity_update apic, -particle_domain split, -position_correction delta",
         ("-geometry", "axisymmetric", "-stone_centre", "0,0.95", "-plate_velocity", "0,-1", "-dry_run"):
             "flow sets -velocity_update apic, -particle_domain fixed, -position_correction none"}


def expect(condition, message):
    if not condition:
        sys.exit(f"analysis_defaults: {message}")


def main():
    binary, deck = pathlib.Path(sys.argv[1]).absolute(), HERE / "reliability" / "small.opts"
    with tempfile.TemporaryDirectory(prefix="mpm_analysis_") as base:
        base = pathlib.Path(base)
        for given, note in NOTES.items():
            done = folders.run(binary, deck, base / "note", *SHORT, "-time_max_steps", 1, *FLOW, *given)
            notes = [line for line in done.stdout.splitlines() if line.startswith("mpm: note: -analysis: ")]
            expect(notes == [f"mpm: note: -analysis: {note}"], f"{given}: the notes are {notes}")
        folders.run(binary, deck, base / "set", *SHORT, *SET)
        folders.run(binary, deck, base / "flow", *SHORT, *FLOW)
        found = folders.differences(base / "set", base / "flow")
        expect(not found, f"results differ: {found[:5]}")
        mark = folders.checkpoints(base / "flow")[0]
        for options in (FLOW, SET):  # -analysis may go, but not what it had set
            folders.run(binary, deck, base / "flow", *SHORT, *options, "-restart", mark)
            found = folders.differences(base / "set", base / "flow")
            expect(not found, f"results differ after a restart with {options}: {found[:5]}")
        done = folders.run(binary, deck, base / "flow", *SHORT, "-restart", mark, status=2)
        expect('mpm: -particle_domain: default "fixed", takes "split"' in done.stderr, f"a restart says {done.stderr}")
    print("-analysis flow: the same bits as its options, also after a restart")


if __name__ == "__main__":
    main()
