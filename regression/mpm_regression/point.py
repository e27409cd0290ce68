"""Runs the program on a single material point: decks and paths of tests in, element.csv out."""
import csv
import os
import pathlib
import subprocess
import tempfile

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
STRESS = ["s" + c for c in COMPONENTS]
STRAIN = ["e" + c for c in COMPONENTS]


def scratch_folder():
    """A temporary folder, in memory where the system has such: each run waits for the disk several times."""
    memory = "/dev/shm"
    return tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None)


def deck_of(model, **parameters):
    """The text of a deck with one material, named soil."""
    lines = ["-materials soil", f"-soil_model {model}", "-soil_density 2000"]
    return "\n".join(lines + [f"-soil_{key} {value}" for key, value in parameters.items()]) + "\n"


def read_table(path):
    """{column: [numbers]} of a CSV file with lines of #."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(line for line in file if line.strip() and not line.startswith("#"))
    return {name: [float(row[k]) for row in rows] for k, name in enumerate(header)}


def write_path(path, columns):
    """A path file of {column: [numbers, or None for an empty cell]}."""
    rows = zip(*columns.values())
    cell = lambda value: "" if value is None else repr(float(value))
    path.write_text("\n".join([",".join(columns)] + [",".join(map(cell, row)) for row in rows]) + "\n")


def run_point(binary, folder, deck, path, *options, status=0):
    """element.csv of a run in a folder, as a table; with another status than 0 the lines of stderr."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "deck.opts").write_text(deck)
    command = [str(binary), "-options_file", str(folder / "deck.opts"), "-element_path", str(path), "-output_dir",
               str(folder / "out"), *map(str, options)]
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMP_PROC_BIND="false")
    result = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    if result.returncode != status:
        raise RuntimeError(f"status {result.returncode} in lieu of {status} of {' '.join(command)}\n{result.stderr}")
    return read_table(folder / "out" / "element.csv") if status == 0 else result.stderr.splitlines()
