#!/usr/bin/env python3
"""Runs the notebooks of docs/notebooks: the code of all cells, in order, in one process, in a folder of its own.

usage: notebooks.py PATH_TO_mpm [NAME ...] [--docs]

A notebook checks its own numbers by `assert`. --docs puts what each cell prints, and its pictures, into the notebook; they are small, so that the
files stay small. No Jupyter is needed.
"""

import argparse
import ast
import base64
import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "notebooks"
MOST = 300e3  # bytes of a notebook


def source_of(cell):
    return "".join(cell["source"])


def output_of(text):
    return {"output_type": "stream", "name": "stdout", "text": text.splitlines(keepends=True)}


def picture_of(figure):
    """The output of a cell that has drawn a figure."""
    data = io.BytesIO()
    figure.savefig(data, format="png", dpi=70)
    return {"output_type": "display_data", "metadata": {}, "data": {"image/png": base64.b64encode(data.getvalue()).decode() + "\n", "text/plain": ["<Figure>"]}}


def run_cell(code, scope):
    """Runs a cell, whose last expression is its value, and returns its outputs."""
    import matplotlib.pyplot as plt
    tree = ast.parse(code)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(tree, "<cell>", "exec"), scope)
        value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), scope) if last else None
        drawn = [plt.figure(number) for number in plt.get_fignums()]
        if value is not None and not drawn:
            print(repr(value))
    outputs = [output_of(said.getvalue())] if said.getvalue() else []
    outputs += [picture_of(figure) for figure in drawn]
    plt.close("all")
    return outputs


def run_cells(path, to):
    """Runs the cells of a notebook in this process, and writes it with their outputs to a file."""
    import matplotlib
    matplotlib.use("agg")
    notebook, scope, count = json.loads(pathlib.Path(path).read_text()), {"__name__": "__main__"}, 0
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            count += 1
            cell["execution_count"], cell["outputs"] = count, run_cell(source_of(cell), scope)
    pathlib.Path(to).write_text(json.dumps(notebook, indent=1) + "\n")


def faults_of(path, program, docs):
    """Lines about a notebook that does not run, or is too large."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPM_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}
    with tempfile.TemporaryDirectory() as folder:
        made = pathlib.Path(folder) / "made.ipynb"
        done = subprocess.run([sys.executable, __file__, "--cells", path, made], cwd=folder, env=environment, capture_output=True, text=True)
        if done.returncode:
            return [f"{path.name}: {done.stderr.strip()[-1500:]}"]
        if made.stat().st_size > MOST:
            return [f"{path.name}: takes {made.stat().st_size / 1e3:.0f} kB with its outputs, may take {MOST / 1e3:.0f}"]
        if docs:
            path.write_text(made.read_text())
    return []


def main():
    if sys.argv[1:2] == ["--cells"]:
        return run_cells(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--docs", action="store_true")
    given = parser.parse_args()
    paths = [FOLDER / f"{name}.ipynb" for name in given.names] or sorted(FOLDER.glob("*.ipynb"))
    program, failed = str(pathlib.Path(given.program).resolve()), 0
    for path in paths:
        faults = faults_of(path, program, given.docs)
        print(f"{path.name}: " + ("runs" if not faults else "fails"), *faults, sep="\n", flush=True)
        failed += bool(faults)
    return 1 if failed or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
