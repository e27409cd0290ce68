"""When a force on a rigid may be given as a factor of the clay's strength, and that factor. Needs numpy."""

from dataclasses import dataclass

import numpy as np

from soil_mpm.results import extent, is_half_model

CLAYS = ("von_mises", "tresca")  # models with an undrained strength that only depth changes
REFERENCE_RIGIDITY, REFERENCE_POISSON = 500, 0.49  # E/su and nu of the stored curves


@dataclass
class Factor:
    """N = F / (su A), of the component of the force against the way that a rigid is pushed."""
    axis: int           # of the way
    sign: float         # of the way along it
    width: float        # m, B of the whole: diameter, or edge across the way
    strength: float     # Pa, su
    area: float         # m2 (m in 2D), A of the modelled part
    half: bool          # the modelled part is half of it
    footing: bool       # a footing on clay of one strength, for which 2 + pi holds at small strain

    @property
    def unit_force(self):
        """Force on the modelled part at N = 1: N, in 2D N a metre."""
        return self.strength * self.area

    def formula(self, unit):
        """How it is made, for the axis of a picture; `unit` is that of the area."""
        if self.footing:
            return "$N_c = F / (s_u B)$"
        return f"$F / (s_u A)$, $s_u$ = {self.strength / 1e3:.4g} kPa, $A$ = {self.area:.4g} {unit}"


def clays_of(run, bodies):
    """Names of the materials of some bodies, None where one is no clay."""
    names = {run.text(f"{body}_material", run.words("materials")[0] if run.words("materials") else "") for body in bodies}
    return names if all(run.text(f"{name}_model") in CLAYS for name in names) else None


def one_strength(run):
    """Undrained strength [Pa] of the clay where all bodies have one and depth does not change it, else None."""
    materials = clays_of(run, run.words("bodies"))
    if not materials or any(run.number(f"{name}_su_gradient") for name in materials):
        return None
    strengths = {run.number(f"{name}_su") for name in materials}
    return strengths.pop() if len(strengths) == 1 and min(strengths) > 0 else None


def levels(run, name):
    """Lower and upper side of a shape on the vertical axis, m."""
    up = 2 if run.text("dim", "2") == "3" else 1
    shape = run.text(f"{name}_shape", "box")
    if shape == "polygon":
        heights = run.numbers(f"{name}_polygon")[1::2]
        return min(heights), max(heights)
    if shape in ("disc", "ball"):
        centre, radius = run.numbers(f"{name}_centre")[up], run.number(f"{name}_radius")
        return centre - radius, centre + radius
    return run.numbers(f"{name}_lower")[up], run.numbers(f"{name}_upper")[up]


def is_level_box(run, name):
    return run.text(f"{name}_shape", "box") == "box" and run.number(f"{name}_angle_deg") == 0


def is_footing(run, name):
    """Is it a plate that is pushed straight down, in plane strain, from the level surface of clay of one strength?"""
    velocity = run.numbers(f"{name}_velocity", [0, 0])
    if (run.text("dim", "2") != "2" or run.text("geometry", "plane_strain") != "plane_strain" or one_strength(run) is None
            or run.text(f"{name}_motion") != "prescribed" or velocity[0] != 0 or not velocity[1] < 0):
        return False
    boxes = [body for body in run.words("bodies") if is_level_box(run, body)]
    if not is_level_box(run, name) or len(boxes) != len(run.words("bodies")):
        return False
    surface = max(levels(run, body)[1] for body in boxes)
    return abs(levels(run, name)[0] - surface) <= run.number("mesh_spacing") * (1 + 1e-9)


def strength_at(run, level):
    """Undrained strength [Pa] of the first clay at a level [m], None without clay."""
    for material in run.words("materials"):
        if run.text(f"{material}_model") in CLAYS:
            depth = max(run.number(f"{material}_su_datum") - level, 0)
            return run.number(f"{material}_su") + depth * run.number(f"{material}_su_gradient") or None
    return None


def modelled_parts(run, name):
    """Along each axis the part of a disc's diameter that sides of the mesh leave of it."""
    radius, parts = run.number(f"{name}_radius"), []
    for axis, centre in enumerate(run.numbers(f"{name}_centre")):
        low, high = (run.numbers(f"mesh_{end}")[axis:axis + 1] or [centre + sign * radius]
                     for end, sign in (("lower", -1), ("upper", 1)))
        parts.append((min(centre + radius, *high) - max(centre - radius, *low)) / (2 * radius))
    return np.array(parts)


def area_across(run, name, axis):
    """(width of the modelled part [m], its area across the way along an axis: m in 2D, else m2), None where it is not known."""
    shape, three = run.text(f"{name}_shape", "box"), run.text("dim", "2") == "3"
    if shape in ("disc", "ball"):
        radius, parts = run.number(f"{name}_radius"), np.delete(modelled_parts(run, name), axis)
        return 2 * radius * parts[0], (np.pi * radius ** 2 if three else 2 * radius) * parts.prod()
    if three and is_level_box(run, name):
        edges = np.subtract(run.numbers(f"{name}_upper"), run.numbers(f"{name}_lower"))
        across = np.delete(edges, axis)
        return across[0], across.prod()
    if three or shape == "half_plane":
        return None
    lower, upper = extent(run, name) if axis == 1 else levels(run, name)
    return upper - lower, upper - lower


def area_revolved(run, name):
    """(diameter [m], area [m2]) of a body of revolution across its axis."""
    inner, outer = extent(run, name)
    return 2 * outer, np.pi * (outer ** 2 - inner ** 2)


def factor(run, name):
    """The Factor of a rigid that is pushed straight along an axis into clay, or None. The strength is that at its underside
    where it goes down or up, at its middle where it goes sideways."""
    velocity = np.array(run.numbers(f"{name}_velocity"))
    if run.text(f"{name}_motion") != "prescribed" or np.count_nonzero(velocity) != 1:
        return None
    axis = int(np.flatnonzero(velocity)[0])
    vertical = axis == len(velocity) - 1
    revolved = run.text("geometry", "plane_strain") == "axisymmetric"
    across = area_revolved(run, name) if revolved and vertical else None if revolved else area_across(run, name, axis)
    strength = across and strength_at(run, levels(run, name)[0] if vertical else np.mean(levels(run, name)))
    if not strength:
        return None
    half = vertical and not revolved and is_half_model(run, name)
    return Factor(axis, float(np.sign(velocity[axis])), (2 if half else 1) * across[0], strength, across[1], half,
                  is_footing(run, name))


def has_reference(run):
    """Is the soil that of the stored curves: weightless, of one strength, with their stiffness?"""
    clay, = clays_of(run, run.words("bodies")) or [None]
    return (clay is not None and not any(run.numbers("gravity")) and run.text(f"{clay}_young") != "field"
            and abs(run.number(f"{clay}_young") / run.number(f"{clay}_su") - REFERENCE_RIGIDITY) < 1e-6 * REFERENCE_RIGIDITY
            and run.number(f"{clay}_poisson") == REFERENCE_POISSON)
