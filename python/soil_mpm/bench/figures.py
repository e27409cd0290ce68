"""The paper's Figs 5, 6, 8 and 10 from our runs, in one picture. Needs numpy and h5py, to draw matplotlib.

Of the paper's own curves only what its tables and text say is drawn: Figs 5 and 8 are described there in words, Figs 6 and
10 follow from Tables 1 and 3.
"""

import numpy as np

from soil_mpm.bench.runs import commit, run, speed_of
from soil_mpm.bench.tables import MOSAIC_SPEEDUP, PAPER, Measured
from soil_mpm.results import Run, bearing_curve, reference_curve, window_means
from soil_mpm.runout import reference_runout, run_out

EXACT = 2 + np.pi
COLOURS = {"auto": "#0072b2", "gather": "#d55e00", "mosaic": "#009e73"}
LABELS = {"auto": "default", "gather": "gather", "mosaic": "mosaic"}


def curves(program, backend, folder):
    """Whole runs of both problems as they stand in inputs: bearing capacity against penetration, run-out against time."""
    found = {}
    for problem in ("footing", "landslide"):
        options = f"-options_file inputs/{problem}.opts -backend {backend} -precision double -output_frames off -progress off"
        speed = speed_of(run(program, options, folder))
        done = Run(folder)
        if problem == "footing":
            x, y = window_means(*bearing_curve(done, "plate"))
            reference = reference_curve(done.number("mesh_spacing"), False)
        else:
            x, y = done.history["time"], run_out(done, "slide")
            stored = reference_runout(done).get("flat")
            reference = (stored["time"], stored["toe"]) if stored else None
        found[problem] = {"x": rounded(x), "y": rounded(y), "particles": speed["count"], "backend": backend, "commit": commit(),
                          "reference": [rounded(each) for each in reference] if reference else None}
        print(f"{problem}.opts to its end: {speed['steps']} steps of {speed['us']:.4g} us", flush=True)
    return found


def rounded(values):
    return [float(f"{each:.5g}") for each in values]


def draw_curve(axes, kept, problem):
    if problem not in kept["curves"]:
        axes.text(0.5, 0.5, "not measured", transform=axes.transAxes, ha="center")
        return
    curve = kept["curves"][problem]
    axes.plot(curve["x"], curve["y"], color=COLOURS["auto"], lw=2, label=f"this program, {curve['particles']:,} particles")
    if curve["reference"]:
        axes.plot(*curve["reference"], "k.", ms=4, label="independent sequential solver")
    if problem == "footing":
        axes.axhline(EXACT, color="0.4", ls="--", label="exact, small strain; the paper agrees \"reasonably well\"")
        axes.set(title="Fig. 5: bearing capacity of the footing", xlabel="penetration $w/B$", ylabel="$N_c$",
                 xlim=(0, 0.2), ylim=(0, 7.5))
    else:
        axes.axhspan(20, 25, color="0.85", label="where the paper's slide ends: 20 to 25 m")
        axes.axvline(11, color="0.4", ls=":", label="the paper's slide stops at 11 s")
        axes.set(title="Fig. 8: run-out of the slide", xlabel="time (s)", ylabel="run-out of the toe (m)",
                 xlim=(0, 15), ylim=(0, 30))


def draw_speedups(axes, measured, problem):
    """Time of the sequential CPU in double precision over the GPU's, against the number of particles."""
    sizes = np.array(list(PAPER[problem]))
    paper = np.array(list(PAPER[problem].values()))
    for column, style, precision in ((1, "-", "single"), (2, "--", "double")):
        axes.plot(sizes, paper[:, 0] / paper[:, column], "k" + style, marker="s", ms=3, lw=1, label=f"paper, gather, {precision}")
        for strategy, colour in COLOURS.items():
            pairs = [(n, measured.us(problem, n, "serial", "double", "auto"), measured.us(problem, n, "cuda", precision, strategy))
                     for n in sizes]
            pairs = [(n, cpu / gpu) for n, cpu, gpu in pairs if cpu and gpu]
            if pairs:
                axes.plot(*zip(*pairs), style, color=colour, marker="o", ms=3, label=f"ours, {LABELS[strategy]}, {precision}")
    if problem == "footing":
        axes.plot(sizes[-1], MOSAIC_SPEEDUP, "k^", ms=5, label="paper, mosaic, single")
    number = {"footing": 6, "landslide": 10}[problem]
    axes.set(xscale="log", yscale="log", xlabel="particles", ylabel="speed-up over one core, double precision",
             title=f"Fig. {number}: speed-up of the {problem}")
    axes.set_ylim(top=15 * axes.get_ylim()[1])  # room for the legend


def draw(kept, folder):
    """Draws the picture into a folder; returns the line of Markdown that shows it."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    measured = Measured(kept["runs"])
    figure, panels = plt.subplots(2, 2, figsize=(12, 9), layout="constrained")
    draw_curve(panels[0, 0], kept, "footing")
    draw_speedups(panels[0, 1], measured, "footing")
    draw_curve(panels[1, 0], kept, "landslide")
    draw_speedups(panels[1, 1], measured, "landslide")
    for axes in panels.flat:
        axes.grid(alpha=0.25, which="both")
        if axes.get_legend_handles_labels()[0]:
            axes.legend(fontsize=8, loc="best" if axes in panels[:, 0] else "upper left", ncols=1 if axes in panels[:, 0] else 3)
    figure.savefig(folder / "performance_paper.png", dpi=100)
    plt.close(figure)
    return "![Figs 5, 6, 8 and 10 of the paper by our runs](../images/performance_paper.png)"
