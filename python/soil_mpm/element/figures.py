"""Pictures of single material points: those of a laboratory report, and of any path. Needs matplotlib."""

import csv

import matplotlib
import matplotlib.ticker
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
# name: (label, unit, factor from SI)
QUANTITIES = {
    "axial_strain": ("axial strain", "%", 100), "volume_strain": ("volume strain", "%", 100),
    "shear_strain": ("shear strain", "%", 100), "q": ("deviator stress q", "kPa", 1e-3),
    "p": ("mean effective stress p'", "kPa", 1e-3), "pore_pressure": ("excess pore pressure", "kPa", 1e-3),
    "vertical_stress": ("vertical effective stress", "kPa", 1e-3), "shear_stress": ("shear stress", "kPa", 1e-3),
    "void_ratio": ("void ratio e", "-", 1), "lateral_stress": ("lateral effective stress", "kPa", 1e-3),
}


def panels_of(test):
    """(abscissa, ordinate) of the four pictures of a kind of test."""
    if test.kind == "shear":
        second = "axial_strain" if test.drained else "pore_pressure"
        return [("shear_strain", "shear_stress"), ("shear_strain", second), ("vertical_stress", "shear_stress"),
                ("vertical_stress", "void_ratio")]
    second = "volume_strain" if test.drained else "pore_pressure"
    pressure = "vertical_stress" if test.kind == "oedometer" else "p"
    return [("axial_strain", "q"), ("axial_strain", second), ("p", "q"), (pressure, "void_ratio")]


def label_of(name):
    label, unit, _ = QUANTITIES[name]
    return f"{label} ({unit})"


def drawn(values, name):
    return np.asarray(values) * QUANTITIES[name][2]


def has_void_ratio(results):
    return all(np.isfinite(found["void_ratio"]).all() for _, found, _ in results)


def with_pressure(test, found, measured):
    """Measured values of a triaxial test with the mean effective stress that follows from them: the lateral stress at the
    start, a third of q, less the excess pore pressure."""
    if measured is None or test.kind != "triaxial" or "q" not in measured or "p" in measured:
        return measured
    if not test.drained and "pore_pressure" not in measured:
        return measured
    lost = 0 if test.drained else measured["pore_pressure"]
    return dict(measured, p=found["lateral_stress"][0] + measured["q"] / 3 - lost)


def draw_panel(axes, pair, results, logarithmic):
    x, y = pair
    for k, (test, found, measured) in enumerate(results):
        colour, measured = COLOURS[k % len(COLOURS)], with_pressure(test, found, measured)
        axes.plot(drawn(found[x], x), drawn(found[y], y), color=colour, lw=1.8, label=test.name)
        if measured is not None and x in measured and y in measured:
            axes.plot(drawn(measured[x], x), drawn(measured[y], y), "o", color=colour, ms=3.5, mfc="none", mew=0.9,
                      label=f"{test.name}, measured")
    if logarithmic:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(matplotlib.ticker.FormatStrFormatter("%g"))
        axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    if y in ("volume_strain",) or y == "axial_strain":
        axes.invert_yaxis()  # compression downward, as laboratories draw it
    axes.set(xlabel=label_of(x) + (", logarithmic scale" if logarithmic else ""), ylabel=label_of(y))
    axes.grid(alpha=0.25)


def draw_report(results, path, title):
    """The four pictures of a laboratory report: of (test, results, what was measured or None) of one group. Where no void
    ratio is known, the last one is the volume strain."""
    figure, all_axes = plt.subplots(2, 2, figsize=(10.5, 8), layout="constrained")
    for n, (axes, (x, y)) in enumerate(zip(all_axes.flat, panels_of(results[0][0]))):
        if y == "void_ratio" and not has_void_ratio(results):
            y = "volume_strain"
        draw_panel(axes, (x, y), results, n == 3 and all((found[x] > 0).all() for _, found, _ in results))
    all_axes.flat[2].legend(fontsize=8)  # beside the stress paths there is room
    figure.suptitle(title)
    figure.savefig(path, dpi=130)
    plt.close(figure)
    return path


def read_columns(path):
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).reshape(-1, len(header)).T))


def invariants(table):
    """Deviator stress q = sqrt(3 J2), mean pressure p (Pa), shear strain sqrt(2/3 e':e') and volume strain (-),
    compression positive."""
    def parts(letter):
        values = [table[letter + c] for c in ("xx", "yy", "zz", "xy", "yz", "zx")]
        mean = sum(values[:3]) / 3
        return mean, sum((v - mean) ** 2 for v in values[:3]) + 2 * sum(v**2 for v in values[3:])
    mean_stress, stress = parts("s")
    mean_strain, strain = parts("e")
    return np.sqrt(1.5 * stress), -mean_stress, np.sqrt(2 / 3 * strain), -3 * mean_strain


def draw_path(folder):
    """element.png: invariants of any path of element.csv in a folder. Its path."""
    table = read_columns(folder / "element.csv")
    q, p, shear, volume = invariants(table)
    figure, axes = plt.subplots(2, 2, figsize=(10.5, 8), layout="constrained")
    panels = [(shear * 100, q / 1e3, "shear strain $\\epsilon_q$ (%)", "deviator stress q (kPa)"),
              (shear * 100, volume * 100, "shear strain $\\epsilon_q$ (%)", "volume strain, compression positive (%)"),
              (p / 1e3, q / 1e3, "mean pressure p (kPa)", "deviator stress q (kPa)"),
              (volume * 100, p / 1e3, "volume strain, compression positive (%)", "mean pressure p (kPa)")]
    for each, (x, y, xlabel, ylabel) in zip(axes.flat, panels):
        each.plot(x, y, color=COLOURS[0], lw=1.6)
        each.plot(x[:1], y[:1], "o", color=COLOURS[1], ms=5, label="start")
        each.set(xlabel=xlabel, ylabel=ylabel)
        each.grid(alpha=0.25)
    axes.flat[0].legend(fontsize=8)
    path = folder / "element.png"
    figure.savefig(path, dpi=130)
    plt.close(figure)
    return path
