"""Curves of a run's history: forces on rigids, and a slide's run-out. Needs matplotlib."""

import sys

import matplotlib.pyplot as plt
import numpy as np

from soil_mpm.factor import factor, has_reference
from soil_mpm.results import MEAN_FROM, MEAN_TO, WINDOW, mean_over, reference_curve, window_means
from soil_mpm.runout import NORMALS, direction_text, reference_runout, slides, toes
from soil_mpm.units import axis_unit, is_plane

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]
STYLES = ["-", "--", ":", "-."]


def save(figure, path, **options):
    figure.savefig(path, dpi=150, **options)
    plt.close(figure)
    return path


def run_label(run, others):
    return run.folder.resolve().name if others else "this run"


def rigids_with_force(run):
    return [name for name in run.words("rigid_bodies") if any(f"{name}_force_{axis}" in run.history for axis in "xyz")]


def mark_time(axes, run, time, values):
    """A thin line where the run is at a time [s], on an axis of `values` at the rows of the history."""
    if time is not None and "time" in run.history:
        axes.axvline(np.interp(time, run.history["time"], values), color="0.6", lw=1, zorder=0, label=f"t = {time:.4g} s")


def mark_stages(axes, run):
    """Where a stage ends and the next one begins, on an axis of time."""
    for name, time in run.stage_ends():
        axes.axvline(time, color="0.6", lw=0.8, ls=":", zorder=0)
        axes.annotate(f"end of {name}", (time, 1), xycoords=("data", "axes fraction"), rotation=90, va="top", ha="right",
                      fontsize=8, color="0.4")


# ---------------------------------------------------------------------------------------------- forces


def pushed(run, name, drawn):
    """Way [m] of a rigid that is pushed straight, and the force [N] against it, in the middle of each interval of the
    history, and the interval's way: a row's force is the mean over the interval that ends there."""
    axis = "xyz"[drawn.axis]
    way = drawn.sign * run.history[f"{name}_{axis}"]
    return (way[1:] + way[:-1]) / 2, -drawn.sign * run.history[f"{name}_force_{axis}"][1:], np.diff(way)


def report_mean(run, name, drawn, curve, reference):
    """Tells the mean factor of a footing over the range that is customary, else over the last half of the way."""
    way, force, weight = curve
    w, n = way / drawn.width, force / drawn.unit_force
    lower, upper = (MEAN_FROM, MEAN_TO) if drawn.footing else (w.max() / 2, w.max())
    line = f"{run.folder}: {name}: mean factor over {lower:.3g}-{upper:.3g} B: {mean_over(w, n, weight, lower, upper):.3f}"
    if drawn.footing and w.max() < MEAN_TO - WINDOW / 2:
        line += f" (the run ends at {w.max():.3f} B)"
    if reference is not None:
        line += f"; reference {mean_over(*reference, np.ones(len(reference[0])), upper=min(MEAN_TO, w.max())):.3f}"
    print(line + ("; exact for small strain 5.142" if drawn.footing else ""))


def stored_curve(run, name, drawn):
    """Way / B and factor of the stored curve for the same footing on the same clay, or None."""
    if not drawn.footing or not has_reference(run):
        return None
    return reference_curve(run.number("mesh_spacing") / drawn.width,
                           run.number(f"{name}_fillet") > 0.5 * run.number("mesh_spacing"))


def draw_pushed(axes, run, name, others):
    """The force against the way of a rigid that is pushed straight, with its factor at the right: each row thin, means
    over windows thick."""
    drawn, top = factor(run, name), 0.0
    reference = stored_curve(run, name, drawn)
    unit_text, size = axis_unit(run, pushed(run, name, drawn)[1], "N")
    for k, (each, colour) in enumerate(zip([run] + others, COLOURS)):
        its = factor(each, name) if name in rigids_with_force(each) else None
        if its is None or its.axis != drawn.axis:
            print(f"plot: {each.folder} has no rigid {name} that is pushed the same way", file=sys.stderr)
            continue
        way, force, weight = pushed(each, name, its)
        window = WINDOW * its.width
        if np.median(weight) > window / 2:  # a window has no rows to take a mean of
            axes.plot(way, force / size, color=colour, lw=2.2, label=f"{run_label(each, others)}, each row of the history")
            top = max(top, force.max(initial=0))
        else:
            if k == 0:
                axes.plot(way, force / size, color=colour, lw=0.7, alpha=0.55, label="each row of the history")
            centres, means = window_means(way, force, weight, window)
            axes.plot(centres, means / size, color=colour, lw=2.2,
                      label=f"{run_label(each, others)}, mean over {window:.3g} m of {'penetration' if drawn.footing else 'way'} ({WINDOW} B)")
            top = max(top, means.max(initial=0))
        report_mean(each, name, its, (way, force, weight), reference if k == 0 else None)
    unit, width = drawn.unit_force / size, drawn.width
    if reference is not None:
        axes.plot(reference[0] * width, reference[1] * unit, "k.-", lw=0.9, ms=4,
                  label=f"reference solver, d = {run.number('mesh_spacing') / width:.3g} B")
        top = max(top, reference[1].max() * drawn.unit_force)
    if drawn.footing:
        axes.axhline((2 + np.pi) * unit, color="0.35", ls="--", lw=1.2, label="$(2 + \\pi) s_u B$, exact for small strain")
        top = max(top, (2 + np.pi) * drawn.unit_force)
    if top > 0:
        axes.set_ylim(0, 1.2 * top / size)
    axes.set_xlim(left=0)
    axes.secondary_xaxis("top", functions=(lambda x: x / width, lambda x: x * width)).set_xlabel(
        "penetration / B" if drawn.footing else "way / B")
    axes.secondary_yaxis("right", functions=(lambda y: y / unit, lambda y: y * unit)).set_ylabel(
        f"{'bearing capacity factor' if drawn.footing else 'factor'} {drawn.formula('m' if is_plane(run) else 'm²')}")
    half = "" if not drawn.half else " on the modelled half" if run.text("dim", "2") == "2" else " on the modelled part"
    axes.set(xlabel="penetration (m)" if drawn.footing else f"way in {'xyz'[drawn.axis]} (m)",
             ylabel=f"force of the soil{half} ({unit_text})", title=name)


def draw_force(axes, run, name, others):
    """Components of the soil's force on a rigid: against the length of its displacement where it moves, else the time."""
    moves = name in run.moving_rigids()
    unit_text, size = axis_unit(run, run.columns(f"{name}_force_"), "N")
    for each, style in zip([run] + others, STYLES):
        if name not in rigids_with_force(each) or not moves and "time" not in each.history:
            continue
        along = np.linalg.norm(each.columns(f"{name}_"), axis=1) if moves else each.history["time"]
        for component, colour, axis in zip(each.columns(f"{name}_force_").T / size, COLOURS, "xyz"):
            axes.plot(along, component, style, color=colour, lw=1.2,
                      label=f"along {axis}, {run_label(each, others)}" if others else f"along {axis}")
    if not moves:
        mark_stages(axes, run)
    axes.set(xlabel="displacement (m)" if moves else "time (s)", ylabel=f"force of the soil ({unit_text})",
             title=name if moves else f"{name} (fixed)")


def has_factor(run, name, asked):
    """Is the force of a rigid drawn with a factor? That of a footing on clay of one strength is, others if asked for."""
    found = factor(run, name)
    if asked and found is None and name in run.moving_rigids():
        print(f"plot: --factor: {name} has none: it takes a rigid of known section, pushed along one axis, and clay",
              file=sys.stderr)
    return found is not None and (asked or found.footing)


def draw_curves(run, others, asked=False, time=None):
    """curve.png: the forces on each rigid in a panel, with a factor where it has one; of many rigids those with the largest
    forces. Returns its path, or None without rigids or history."""
    most = 12  # panels that a reader takes in
    rigids = rigids_with_force(run)
    if not rigids:
        return None
    if len(rigids) > most:
        largest = {name: np.abs(run.columns(f"{name}_force_")).max() for name in rigids}
        chosen = sorted(rigids, key=largest.get, reverse=True)[:most]
        print(f"plot: curve.png has the {most} of {len(rigids)} rigid bodies with the largest forces", file=sys.stderr)
        rigids = [name for name in rigids if name in chosen]
    figure, all_axes = plt.subplots(len(rigids), 1, figsize=(8.2, 5.4 * len(rigids)), squeeze=False, layout="constrained")
    for axes, name in zip(all_axes[:, 0], rigids):
        with_factor = has_factor(run, name, asked)
        (draw_pushed if with_factor else draw_force)(axes, run, name, others)
        moves = name in run.moving_rigids()
        mark_time(axes, run, time, np.linalg.norm(run.columns(f"{name}_"), axis=1) if moves else run.history.get("time"))
        axes.grid(alpha=0.25)
        axes.legend(fontsize=9, loc="lower right" if with_factor else "best")
    return save(figure, run.folder / "curve.png")


# ---------------------------------------------------------------------------------------------- run-out


def draw_reference_runout(axes, run):
    """The stored curves of the same problem: lines, or marks where only some times are known."""
    for (normal, curve), style in zip(reference_runout(run).items(), ["-", "--"]):
        few = len(curve["time"]) < 20
        axes.plot(curve["time"], curve["toe"], "ko" if few else "k" + style, ms=4, lw=1.1,
                  mfc="none" if few and style == "--" else "k", label=f"reference solver, {NORMALS[normal]}")


def draw_runout(run, others, time=None):
    """runout.png: run-out of the toe of each sliding body against time. Returns its path, or None if none slides."""
    if not slides(run):
        return None
    figure, axes = plt.subplots(figsize=(8.2, 5.4), layout="constrained")
    colours, directions = iter(COLOURS * 10), []
    for each in [run] + others:
        for body in slides(each):
            colour, label = next(colours), f"{body}, {run_label(each, others)}"
            direction, found = toes(each, body)
            directions.append(direction_text(direction))
            for toe, style in zip(found, ["-", ":"]):
                axes.plot(toe.time, toe.way, style, color=colour, lw=2.2, label=f"{label}: {toe.name}")
    along = ", along " + directions[0] if len(set(directions)) == 1 else ", along the motion of each body"
    draw_reference_runout(axes, run)
    mark_time(axes, run, time, run.history["time"])
    mark_stages(axes, run)
    axes.set(xlabel="time (s)", ylabel="run-out (m)", title="run-out of the toe since the start" + along, ylim=(0, None))
    axes.set_xlim(left=0)
    axes.grid(alpha=0.25)
    axes.legend(fontsize=9, loc="lower right")
    return save(figure, run.folder / "runout.png")
