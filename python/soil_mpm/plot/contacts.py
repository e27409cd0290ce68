"""Contact of deformable bodies in pairs, from frames: contact.png, and contact_PAIR.csv with the numbers. Needs matplotlib."""

import matplotlib.pyplot as plt
import numpy as np

from soil_mpm.plot.curves import save
from soil_mpm.results import read_frame
from soil_mpm.units import axis_unit

AXES = "xyz"
SIDES = [("tab:blue", "o"), ("tab:red", "^")]  # of nodes whose normal has a positive and a negative sign along an axis


def pairs_of(groups):
    """{pair: fields} of a frame: the groups that have contact."""
    return {name: group for name, group in groups.items() if "contact_pressure" in group}


def table_of(contact, dim):
    """Header and rows of a pair's table: by node, place [m], normal out of the first body, area [m2, in 2D m], pressure and shear on
    the first body [Pa]."""
    vectors = {"": "position", "normal_": "contact_normal", "shear_": "contact_shear"}
    columns = {f"{prefix}{AXES[d]}": contact[field][:, d] for prefix, field in vectors.items() for d in range(dim)}
    columns["area"], columns["pressure"] = contact["contact_area"], contact["contact_pressure"]
    return list(columns), np.column_stack(list(columns.values())) if len(contact["contact_area"]) else np.zeros((0, len(columns)))


def draw_pair(run, panels, name, contact, dim):
    """Pressure, and shear along the axis in which the contact is longest, against the place along this axis."""
    position, normal = contact["position"][:, :dim], contact["contact_normal"][:, :dim]
    along = int(np.argmax(np.ptp(position, axis=0)))
    across = int(np.argmax(np.where(np.arange(dim) == along, -1, np.abs(normal).sum(axis=0))))
    upright = along == dim - 1
    for axes, (title, values) in zip(panels, (("pressure", contact["contact_pressure"]),
                                              (f"shear along {AXES[along]} on the first body", contact["contact_shear"][:, along]))):
        unit, size = axis_unit(run, values, "Pa")
        for sign, (colour, mark) in zip((1, -1), SIDES):
            chosen = np.flatnonzero(normal[:, across] * sign > 0)
            if len(chosen) == 0:
                continue
            place, value = position[chosen, along], values[chosen] / size
            label = f"normal towards {'+' if sign > 0 else '-'}{AXES[across]}"
            axes.plot(*((value, place) if upright else (place, value)), mark, color=colour, ms=2.5, alpha=0.7, label=label)
        names = [f"{AXES[along]} (m)", f"{title} ({unit})"]
        axes.set(**dict(zip(("xlabel", "ylabel"), reversed(names) if upright else names)), title=name.replace("_", " on ", 1))
        axes.grid(alpha=0.25)
    panels[0].legend(fontsize=8)


def draw_contacts(run, time=None):
    """contact.png: a row of two panels for each pair that touches in the frame nearest to a time [s], or the last one; and
    contact_PAIR.csv of each. Returns the paths; none without pairs."""
    path = run.frame if time is None else run.frame_near(time)
    if not run.words("contact_pairs") or path is None:
        return []
    at, groups = read_frame(path)
    pairs, dim = pairs_of(groups), int(run.number("dim", 2))
    paths = []
    for name, contact in pairs.items():
        header, rows = table_of(contact, dim)
        paths.append(run.folder / f"contact_{name}.csv")
        paths[-1].write_text("\n".join([",".join(header)] + [",".join(f"{x:.9g}" for x in row) for row in rows]) + "\n")
    touching = {name: contact for name, contact in pairs.items() if len(contact["contact_area"])}
    if touching:
        figure, all_axes = plt.subplots(len(touching), 2, figsize=(11, 3.6 * len(touching)), squeeze=False, layout="constrained")
        for panels, (name, contact) in zip(all_axes, touching.items()):
            draw_pair(run, panels, name, contact, dim)
        figure.suptitle(f"contact at {at:.4g} s", fontsize=10)
        paths.insert(0, save(figure, run.folder / "contact.png"))
    return paths
