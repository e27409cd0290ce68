"""Options of soil that flows: the collapse of a clay column in nine variants, and random collapses, slides and impacts.

Lengths below are in m, counted from the mesh's lower corner until `Options.value` shifts them.
"""
import dataclasses
import math
import random

COLLAPSE = {
    "dim": 2, "mesh_lower": (0, 0), "mesh_upper": (4, 3), "mesh_spacing": 0.1, "mesh_ymin": "fixed", "time_end": 3,
    "gravity": (0, -9.81), "materials": "clay", "clay_model": "von_mises", "clay_density": 1800, "clay_young": 1e6,
    "clay_poisson": 0.45, "clay_su": 500, "bodies": "dam", "dam_material": "clay", "dam_shape": "box",
    "dam_lower": (0, 0), "dam_upper": (1, 2)}
FIXED = {f"mesh_{side}": "fixed" for side in ("xmin", "xmax", "ymin", "ymax")}
VARIANTS = {
    "collapse": {},
    "very weak": {"clay_su": 100},
    "taller column": {"mesh_upper": (4, 4), "dam_upper": (1, 3)},
    "half the cell": {"mesh_spacing": 0.05},
    "fixed sides": FIXED,
    "apic": {"velocity_update": "apic"},
    "no F-bar": {"f_bar_fraction": 0},
    "small steps": {"time_courant": 0.1},
    "block thrown at a wall": {"dam_lower": (0.5, 0.5), "dam_upper": (1.5, 1.5), "dam_velocity": (8, 0)}}

# Particles times steps that a core of 2020 does in a second, roughly. Decks are drawn until one takes long enough, and not too long.
UPDATES_PER_SECOND = {2: 2.0e6, 3: 0.5e6}
PLACES = ("lower", "upper", "centre", "point")  # options that are places, which the origin shifts


@dataclasses.dataclass
class Options:
    name: str
    options: dict  # {name without dash: number, word or tuple}
    origin: tuple = (0, 0, 0)  # m, the mesh's lower corner
    lift: float = 0.0  # share of the weight that water carries
    loaded: bool = False  # by what gives energy beside gravity
    ground: object = None  # of water_decks.py: what the particles' file is made from

    @property
    def dim(self):
        return int(self.options["dim"])

    def value(self, name):
        """An option as the program is given it."""
        value = self.options[name]
        if not isinstance(value, tuple):
            return f"{value:.12g}" if isinstance(value, float) else str(value)
        if name.rpartition("_")[2] in PLACES:
            value = [x + o for x, o in zip(value, self.origin)]
        elif name.endswith("_polygon"):
            value = [x + self.origin[(0, self.dim - 1)[k % 2]] for k, x in enumerate(value)]
        elif name.endswith("_width"):
            value = [x + self.origin[1] for x in value]
        elif name.endswith("_datum"):
            value = [x + self.origin[self.dim - 1] for x in value]
        return ",".join(f"{x:.15g}" for x in value)

    def words(self):
        return [word for name in self.options for word in (f"-{name}", self.value(name))]

    def bodies(self):
        return self.options["bodies"].split(",")

    def mesh(self):
        """Lower and upper corner as the program is given them, m."""
        return [[float(x) for x in self.value(f"mesh_{end}").split(",")] for end in ("lower", "upper")]


# ---------------------------------------------------------------------------------------------- random decks


class Draw:
    """The random numbers of a deck, and what has been drawn of it so far."""

    def __init__(self, seed, attempt):
        self.random = random.Random(seed)  # what it is does not hang on how long it would take
        self.dim = self.random.choices((2, 3), (0.7, 0.3))[0]
        self.kind = self.one(collapse=5, slide=3, impact=4)
        self.random.seed(f"{seed} {attempt}")
        self.cell = self.logarithmic(0.02, 0.5)  # m
        self.options = {}

    def logarithmic(self, least, most):
        return float(f"{math.exp(self.random.uniform(math.log(least), math.log(most))):.4g}")

    def uniform(self, least, most):
        return round(self.random.uniform(least, most), 6)

    def some(self, share):
        return self.random.random() < share

    def one(self, **weights):
        return self.random.choices(list(weights), list(weights.values()))[0]

    def vector(self, x, y, z):
        """Vector of x along, y across and z up in the dimension of the deck; in 2D without y."""
        return (x, z) if self.dim == 2 else (x, y, z)


def draw_soil(draw):
    o, young = draw.options, draw.logarithmic(2e4, 2e7)
    strength = 0 if draw.some(0.03) else min(draw.logarithmic(1, 2e4), young / 20)
    o.update(materials="clay", clay_model="von_mises", clay_density=draw.uniform(300, 2600), clay_young=young,
             clay_poisson=draw.uniform(0.2, 0.495), clay_su=float(f"{strength:.4g}"))
    if draw.some(0.3):
        o.update(clay_su_gradient=draw.logarithmic(10, 2000), clay_su_datum=(draw.uniform(0, 1),))


def draw_method(draw):
    o, update = draw.options, draw.one(flip=5, pic=1, xpic=2, apic=2)
    if update != "flip" or draw.some(0.3):
        o["velocity_update"] = update
    if update == "flip" and draw.some(0.4):
        o["flip_fraction"] = draw.uniform(0.5, 1)
    if update == "xpic":
        o["xpic_order"] = draw.random.randint(2, 5)
        o["flip_fraction"] = draw.random.choice([0, 0, draw.uniform(0, 1)])
    if draw.some(0.5):
        o["f_bar_fraction"] = draw.random.choice([0, 0.5, 1, draw.uniform(0, 1)])
    if draw.some(0.4):
        o["time_courant"] = draw.uniform(0.1, 0.4)
    if draw.some(0.2):
        o["damping"] = draw.uniform(0, 0.5)
    if draw.some(0.3):
        o["rebuild_margin"] = draw.uniform(0.05, 0.5)


def draw_sides(draw):
    up = "xyz"[draw.dim - 1]
    for axis in "xyz"[:draw.dim]:
        for end in ("min", "max"):
            floor = axis + end == up + "min"
            wall = draw.one(fixed=6, roller=4, free=1) if floor else draw.one(roller=4, fixed=3, free=3)
            if wall != "roller" or draw.some(0.5):
                draw.options[f"mesh_{axis}{end}"] = wall


def add_block(draw, name, place, size):
    """A body about as large as a box of `size` at `place` [m, along, across, up]: a box, a ball or a prism."""
    o, (x, y, z), (a, b, c) = draw.options, place, size
    ppc = draw.random.choice([1, 2, 2, 2, 3]) if draw.dim == 3 else draw.random.choice([1, 2, 2, 2, 3, 4])
    o.update({f"{name}_material": "clay", f"{name}_particles_per_cell": ppc})
    shape = draw.one(box=5, disc=2 if draw.dim == 2 or min(size) > 3.5 * draw.cell else 0, prism=3)
    o[f"{name}_shape"] = "polygon" if shape == "prism" else "ball" if shape == "disc" and draw.dim == 3 else shape
    if shape == "box":
        o.update({f"{name}_lower": draw.vector(x, y, z), f"{name}_upper": draw.vector(x + a, y + b, z + c)})
    elif shape == "disc":
        radius = min(a, c) / 2 if draw.dim == 2 else min(a, b, c) / 2
        o.update({f"{name}_centre": draw.vector(x + radius, y + radius, z + radius), f"{name}_radius": radius})
    else:
        cut = draw.uniform(0.05, 0.45) * a  # a trapezium, whose top is the shorter
        o[f"{name}_polygon"] = (x, z, x + a, z, x + a - cut, z + c, x + cut * draw.uniform(0, 1), z + c)
        if draw.dim == 3:
            o[f"{name}_width"] = (y, y + b)
    return a * c * (b if draw.dim == 3 else 1) * (ppc / draw.cell) ** draw.dim  # particles at most


def set_mesh(draw, cells):
    """A mesh of so many cells along, across and up; returns its extent, m."""
    extent = draw.vector(*(n * draw.cell for n in cells))
    draw.options.update(dim=draw.dim, mesh_lower=draw.vector(0, 0, 0), mesh_upper=extent, mesh_spacing=draw.cell)
    return extent


def draw_sizes(draw):
    """Cells of a body along, across and up."""
    if draw.dim == 2:
        return draw.random.randint(4, 18), 0, draw.random.randint(5, 24)
    return draw.random.randint(3, 8), draw.random.randint(2, 8), draw.random.randint(3, 10)


def draw_collapse(draw):
    """One or two columns on the floor. Returns particles and speed [m/s], as all kinds do."""
    d, (nx, ny, nz) = draw.cell, draw_sizes(draw)
    two = draw.some(0.15)
    run, deep = draw.random.randint(nx, 4 * nx), ny + draw.random.randint(0, ny)
    set_mesh(draw, ((2 if two else 1) * nx + run + 3, deep, nz + draw.random.randint(2, nz)))
    x = draw.random.choice([0, 0, draw.random.randint(0, run)]) if not two else 0
    y = draw.random.randint(0, deep - ny)
    draw.options["bodies"] = "dam,other" if two else "dam"
    size = (nx * d, ny * d, nz * d)
    particles = add_block(draw, "dam", (x * d, y * d, 0), size)
    if two:
        particles += add_block(draw, "other", ((nx + run + 3) * d, y * d, 0), size)
    draw.options["gravity"] = draw.vector(0, 0, -draw.uniform(3, 15))
    return particles, 0.0


def draw_slide(draw):
    """A block on a rigid slope, or on the floor of a mesh that lies along the slope."""
    if draw.some(0.4):
        particles, _ = draw_collapse(draw)
        angle, g = math.radians(draw.uniform(5, 40)), 9.81
        draw.options["gravity"] = draw.vector(round(g * math.sin(angle), 6), 0, -round(g * math.cos(angle), 6))
        return particles, 0.0
    o, d, (nx, ny, nz) = draw.options, draw.cell, draw_sizes(draw)
    nz, degrees = min(nz, 8), draw.uniform(10, 40)
    angle, length, high = math.radians(degrees), nx * d, nz * d
    top = draw.uniform(1.1, 2) * (length + 2 * d) * math.sin(angle) + 3 * d  # of the slope at x = 0
    wide = top / math.tan(angle) + draw.uniform(0.3, 1.5) * length + high
    deep = ny + draw.random.randint(0, ny)
    set_mesh(draw, (math.ceil(wide / d), deep, math.ceil((top + high) / d) + 2))
    o.update(bodies="slide", slide_material="clay", slide_shape="box", slide_angle_deg=-degrees)
    x, gap = d, 0.3 * d  # the block stands a little off the slope
    x, z = x + gap * math.sin(angle), top - x * math.tan(angle) + gap * math.cos(angle)
    o.update(slide_lower=draw.vector(x, 0, z), slide_upper=draw.vector(x + length, ny * d, z + high))
    o.update(rigid_bodies="base", base_shape="half_plane", base_point=draw.vector(0, 0, top), base_particles_per_cell=2,
             base_normal=draw.vector(math.sin(angle), 0, math.cos(angle)), gravity=draw.vector(0, 0, -9.81))
    o.update({"base_friction": draw.uniform(0, 0.5)} if draw.some(0.5) else {"base_shear_limit": draw.logarithmic(1, 1e4)})
    return nx * nz * 2 ** draw.dim * (ny if draw.dim == 3 else 1), 0.0


def draw_impact(draw):
    """One block thrown somewhere, two at each other, or one at a rigid block; with gravity or without."""
    o, d, (nx, ny, nz) = draw.options, draw.cell, draw_sizes(draw)
    gaps = [draw.random.randint(2, 2 * n + 2) for n in (nx, max(ny, 1), nz)]
    against = draw.one(wall=3, body=1, rigid=1)
    between = 0 if against == "wall" else draw.random.randint(3, nx + 3)
    long = 2 * gaps[0] + between + (nx if against == "wall" else 2 * nx)
    set_mesh(draw, (long, ny + 2 * gaps[1], nz + 2 * gaps[2]))
    size, place = (nx * d, ny * d, nz * d), [n * d for n in gaps]
    o["bodies"] = "block,other" if against == "body" else "block"
    particles = add_block(draw, "block", place, size)
    speed = draw.uniform(0.5, 10)
    aside = 1 if against == "wall" else 0.2
    thrown = [draw.uniform(-1, 1) if against == "wall" else 1, draw.uniform(-aside, aside), draw.uniform(-aside, aside)]
    o["block_velocity"] = draw.vector(*(round(speed * part / math.hypot(*thrown), 6) for part in thrown))
    beyond = (place[0] + size[0] + between * d, place[1], place[2])
    if against == "body":
        particles += add_block(draw, "other", beyond, size)
        o["other_velocity"] = tuple(-v * draw.uniform(0, 1) for v in o["block_velocity"])
    if against == "rigid":
        o.update(rigid_bodies="stone", stone_shape="box", stone_lower=draw.vector(*beyond), stone_particles_per_cell=2,
                 stone_upper=draw.vector(*(x + s for x, s in zip(beyond, size))), stone_friction=draw.uniform(0, 1))
    o["gravity"] = draw.vector(0, 0, -draw.random.choice([0, 9.81, 9.81]))
    return particles, speed


def set_time(draw, particles, speed):
    """Time enough to fall, run out and come to rest or to the other side. Returns steps, and the largest speed over that
    of a wave."""
    o = draw.options
    extent, g = o["mesh_upper"], math.hypot(*o["gravity"])
    nu, courant = o["clay_poisson"], o.get("time_courant", 0.4)
    modulus = o["clay_young"] * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    wave = math.sqrt(modulus / o["clay_density"])
    fastest = speed + math.sqrt(2 * g * max(extent))
    falls = math.sqrt(2 * extent[-1] / g) if g > 0 else math.inf
    end = draw.uniform(2, 5) * min(falls, 2 * max(extent) / speed if speed > 0 else math.inf)
    o["time_end"] = float(f"{end:.3g}")
    return end * wave / (courant * draw.cell), fastest / wave


def random_options(seed, dims, precision, least, most):
    """Options that a text gives: drawn until a run takes from `least` to `most` seconds on one core."""
    draw_kind = {"collapse": draw_collapse, "slide": draw_slide, "impact": draw_impact}
    for attempt in range(10000):
        draw = Draw(f"{seed} {attempt // 1000}", attempt)
        if draw.dim not in dims:
            continue
        draw_soil(draw)
        particles, speed = draw_kind[draw.kind](draw)
        steps, mach = set_time(draw, particles, speed)
        draw_method(draw)
        draw_sides(draw)
        cells = math.prod(round(x / draw.cell) for x in draw.options["mesh_upper"])
        seconds = steps * (particles + 0.3 * cells) / UPDATES_PER_SECOND[draw.dim]
        if least < seconds < most and mach < 0.5:
            return Options(draw.kind, order(draw.options), origin(draw, precision))
    raise RuntimeError(f"no deck of {seed} takes {least} to {most} s")


def origin(draw, precision):
    """The mesh's lower corner: 0, or anywhere, nearer where positions are in single precision."""
    if draw.some(0.5):
        return (0, 0, 0)
    far = (50 if precision == "single" else 1000) * draw.cell
    return tuple(draw.uniform(-far, far) for _ in range(draw.dim))


def order(options):
    """The mesh first, so that a deck reads well."""
    first = ["dim", *(name for name in options if name.startswith("mesh_")), "time_end", "gravity"]
    return {name: options[name] for name in dict.fromkeys([*first, *options])}
