"""Images of a deck that must agree with it: `IMAGES` has a function each, (deck, draw) -> Image, or None where the deck has none."""
import dataclasses

from dimensions import SIDE, TIME, domain_of, factor, kind_of, names_of, pairs_of

EXACT, ROUND_OFF = "bits", "round-off"


@dataclasses.dataclass
class Image:
    """A deck and how its results lead back. Axis k of the image is axis `axes[k]` of the deck, times `signs[k]`; then `shift` is added [m of
    the deck]. `scales`: units of length, time and mass of the deck in those of the image."""
    deck: dict
    must: str = ROUND_OFF
    axes: tuple = ()
    signs: tuple = ()
    shift: tuple = ()
    scales: tuple = (1.0, 1.0, 1.0)
    joins: dict = dataclasses.field(default_factory=dict)  # {body of the deck: bodies of the image}
    copies: int = 1  # particles of the image for one of the deck
    width: float = 1.0  # m, that the image has where the deck is in plane strain
    ranks: int = 1
    cut: float = 0.0  # share of the steps before a restart
    rows: bool = True  # whether rows have the same times
    skips: str = ""  # pattern of columns that cannot be compared

    def complete(self, dim):
        self.axes = self.axes or tuple(range(dim))
        self.signs = self.signs or (1,) * dim
        self.shift = self.shift or (0.0,) * dim
        return self


# ------------------------------------------------------------------------------------------------ values of options

def tuple_of(value):
    return value if isinstance(value, tuple) else (value,)


def turned_stress(s, axes, signs):
    """Components xx yy zz xy yz zx, in 2D xx yy zz xy, about other axes."""
    if len(s) == 4:
        return (*(s[a] for a in axes), s[2], s[3] * signs[0] * signs[1])
    pair = {frozenset((0, 1)): 3, frozenset((1, 2)): 4, frozenset((2, 0)): 5}
    shear = [(0, 1), (1, 2), (2, 0)]
    return (*(s[a] for a in axes), *(s[pair[frozenset((axes[i], axes[j]))]] * signs[i] * signs[j] for i, j in shear))


def moved(kind, value, units, image, dim, name, deck):
    """A value of an option in the image."""
    axes, signs, shift, up = image.axes, image.signs, image.shift, dim - 1
    by = factor(units, image.scales) if units != (0, 0, 0) else 1

    def place(x, k):  # along axis k of the image
        return signs[k] * x + shift[k]

    def axis_of(old):
        return axes.index(old)

    if kind in ("word", "number") or (kind == "levels" and isinstance(value, str)):
        return value if kind == "word" or by == 1 else value * by
    if kind == "numbers":
        return tuple(x * by for x in value) if isinstance(value, tuple) else value * by
    if kind == "axis":
        return "xyz"[axis_of("xyz".index(value))]
    if kind == "level" or (kind == "levels" and not isinstance(value, tuple)):
        return place(value, up) * by
    if kind == "place":
        return tuple(place(value[axes[k]], k) * by for k in range(dim))
    if kind == "vector":
        return tuple(signs[k] * value[axes[k]] * by + 0.0 for k in range(dim))
    if kind == "stress":
        return tuple(x * by + 0.0 for x in turned_stress(value, axes, signs))
    if kind == "width":
        return tuple(sorted(place(x, 1) * by for x in value))
    if kind in ("outline", "levels"):
        old = {0: 0, up: 1}  # which number of a vertex
        vertices = [tuple(place(vertex[old[axes[k]]], k) * by for k in (0, up)) for vertex in zip(value[::2], value[1::2])]
        return tuple(x for vertex in vertices for x in vertex)
    if kind == "table":
        rows = [tuple(float(x) for x in row.split(":")) for row in value.split(",")]
        t = factor(TIME, image.scales)
        if len(rows[0]) == 2:  # factors of a vector
            return ",".join(f"{row[0] * t!r}:{row[1]!r}" for row in rows)
        return ",".join(":".join(repr(x) for x in (row[0] * t, *(signs[k] * row[1 + axes[k]] * by for k in range(dim)))) for row in rows)
    if kind == "at":
        if deck[name.replace("_at", "_kind")] == "section":
            k = axis_of("xyz".index(deck[name.replace("_at", "_axis")]))
            return place(value, k) * by
        full = tuple_of(value) + (0.0,) * (dim - len(tuple_of(value)))
        out = tuple(place(full[axes[k]], k) * by for k in range(dim))[:len(tuple_of(value))]
        return out if len(out) > 1 else out[0]
    raise KeyError(f"kind {kind}")


def apply(deck, image):
    """Gives an image the deck that its axes, shift and scales make of one."""
    dim, out = deck["dim"], {}
    image.complete(dim)
    for name, value in deck.items():
        kind, units = kind_of(name, deck)
        side = SIDE.match(name)
        if side:
            k = image.axes.index("xyz".index(side[1]))
            end = side[2] if image.signs[k] > 0 else {"min": "max", "max": "min"}[side[2]]
            name = f"mesh_{'xyz'[k]}{end}" + (f"_{side[3]}" if side[3] else "")
        out[name] = moved(kind, value, units, image, dim, name, deck)
    for name in [n for n in out if n.endswith("lower") and n.replace("lower", "upper") in out]:
        low, high = out[name], out[name.replace("lower", "upper")]
        out[name], out[name.replace("lower", "upper")] = tuple(map(min, low, high)), tuple(map(max, low, high))
    image.deck = out
    return image


# ------------------------------------------------------------------------------------------------ what a deck allows

def shapes(deck):
    return {value for name, value in deck.items() if name.endswith("_shape")}


def is_upright(deck):
    """Whether the last axis is another than the others."""
    probes = [deck[f"{name}_kind"] for name in names_of(deck, "probes")]
    rings = [name for name in names_of(deck, "bodies") if deck.get(f"{name}_fill") == "cut" and deck[f"{name}_shape"] == "ball"]
    return bool(rings or shapes(deck) & {"layer", "cylinder", "cone"} or "water_level" in deck or "gauge" in probes or deck.get("geometry")
                or any(name.endswith(("gradient", "su_ratio")) and value for name, value in deck.items()) or "k0" in deck.values())


def has_prism(deck):
    return deck["dim"] == 3 and "polygon" in shapes(deck)


def is_periodic(deck):
    return "periodic" in deck.values()


def on_mesh(deck, place):
    """Whether a place is a node of the mesh, so that the lattice of a box that begins there is that of the mesh."""
    return all(abs(x / deck["mesh_spacing"] - round(x / deck["mesh_spacing"])) < 1e-9 for x in place)


def single(deck):
    return deck["precision"] == "single"


# ------------------------------------------------------------------------------------------------ the images

def scales_of(draw, any_factor, most):
    """Scales of length, time and mass that leave densities and stresses in the ranges that the options take."""
    length, time, density = (any_factor(each) for each in most)
    return length, time, density * length ** 3


def units(deck, draw):
    """Other units, by powers of four, whose roots are exact: not a bit changes."""
    return apply(deck, Image({}, EXACT, scales=scales_of(draw, lambda most: 4.0 ** draw.randint(-most, most), (2, 1, 3))))


def any_units(deck, draw):
    """Other units, by any numbers."""
    if single(deck):
        return None
    return apply(deck, Image({}, scales=scales_of(draw, lambda most: round(10 ** draw.uniform(-most, most), 3), (1, 0.7, 1))))


def mirror(deck, draw):
    """The mirror image about a plane normal to an axis."""
    choice = [k for k in range(deck["dim"]) if not (k == deck["dim"] - 1 and is_upright(deck) and not deck.get("geometry")) and not (k == 0 and deck.get("geometry"))]
    if deck.get("geometry") and (shapes(deck) & {"layer"} or "water_level" in deck or any(n.endswith("gradient") for n in deck)):
        return None
    k = draw.choice(choice) if choice else None
    return None if k is None else apply(deck, Image({}, signs=tuple(-1 if d == k else 1 for d in range(deck["dim"]))))


def turn(deck, draw):
    """Axes that change places, and in half of the decks change sign: swaps and quarter turns."""
    dim = deck["dim"]
    if deck.get("geometry") or (dim == 2 and is_upright(deck)) or (has_prism(deck) and is_upright(deck)):
        return None
    if dim == 2:
        axes = (1, 0)
    elif has_prism(deck):
        axes = (2, 1, 0)
    else:
        axes = (1, 0, 2) if is_upright(deck) else draw.choice([(1, 0, 2), (2, 1, 0), (0, 2, 1), (1, 2, 0), (2, 0, 1)])
    signs = [draw.choice([1, -1]) if draw.random() < 0.5 else 1 for _ in range(dim)]
    if is_upright(deck):
        signs[-1] = 1
    return apply(deck, Image({}, axes=axes, signs=tuple(signs)))


def shift(deck, draw):
    """Everything moved by whole cells."""
    by = [draw.randint(-7, 7) * deck["mesh_spacing"] for _ in range(deck["dim"])]
    if deck.get("geometry"):
        by[0] = 0.0
    return apply(deck, Image({}, shift=tuple(by)))


def room(deck, draw):
    """More empty cells above."""
    up = deck["dim"] - 1
    if deck.get(f"mesh_{'xyz'[up]}max") != "free" or shapes(deck) & {"half_plane"}:
        return None
    out = dict(deck)
    out["mesh_upper"] = (*deck["mesh_upper"][:-1], deck["mesh_upper"][up] + draw.randint(1, 9) * deck["mesh_spacing"])
    return Image(out)


def order(deck, draw):
    """Another order of materials, bodies and probes."""
    out = dict(deck)
    for what in ("materials", "bodies", "probes"):
        names = names_of(deck, what)
        if len(names) > 1:
            out[what] = ",".join(names[::-1])
    return Image(out) if out != deck else None


def parts(deck, draw):
    """The box of soil as two, which meet at a plane of cells."""
    body = "ground"
    if deck.get(f"{body}_shape") != "box" or deck.get("push_body") == body:
        return None
    if pairs_of(deck) and ("weld" not in deck.values() or deck.get("f_bar_fraction") != 0):
        return None  # where others slide on it, a part has a boundary at the cut; and F-bar acts within each body
    axis = draw.randrange(deck["dim"])
    low, high, h = deck[f"{body}_lower"], deck[f"{body}_upper"], deck["mesh_spacing"]
    at = low[axis] + h * max(1, int((high[axis] - low[axis]) / h / 2))
    if at >= high[axis] - 0.5 * h:
        return None
    out = dict(deck)
    out.update({name.replace("ground", "rest", 1): value for name, value in deck.items() if name.startswith("ground_")})
    out["ground_upper"] = tuple(at if k == axis else x for k, x in enumerate(high))
    out["rest_lower"] = tuple(at if k == axis else x for k, x in enumerate(low))
    out["bodies"] = ",".join(["ground", "rest", *names_of(deck, "bodies")[1:]])
    for pair in names_of(deck, "contact_pairs"):
        other = pair.replace("ground", "rest")
        out.update({"contact_pairs": f"{pair},{other}", f"{other.replace(':', '_')}_contact": "weld"})
    if any(f"{probe}_bodies" in deck for probe in names_of(deck, "probes")):
        return None
    return Image(out, joins={"ground": ("ground", "rest")})


def outline(deck, draw):
    """A box as the polygon, layer or surface of triangles that has its outline."""
    boxes = [body for body in names_of(deck, "bodies") if deck[f"{body}_shape"] == "box" and on_mesh(deck, deck[f"{body}_lower"])]
    if not boxes:
        return None
    body, dim = draw.choice(boxes), deck["dim"]
    low, high = deck[f"{body}_lower"], deck[f"{body}_upper"]
    out = {name: value for name, value in deck.items() if name not in (f"{body}_lower", f"{body}_upper")}
    whole = all(a == b for a, b in zip((*low[:-1], *high[:-1]), (*deck["mesh_lower"][:-1], *deck["mesh_upper"][:-1])))
    shape = draw.choice(["polygon", *(["layer"] if whole else []), *(["stl"] if dim == 3 else [])])
    out[f"{body}_shape"] = shape
    out.setdefault(f"{body}_fill", "centre")
    if shape == "polygon":
        out[f"{body}_polygon"] = (low[0], low[-1], high[0], low[-1], high[0], high[-1], low[0], high[-1])
        if dim == 3:
            out[f"{body}_width"] = (low[1], high[1])
    elif shape == "layer":
        out.update({f"{body}_base": low[-1], f"{body}_top": high[-1]})
    else:
        out[f"{body}_file"] = ("stl", low, high)
    return Image(out)


def thin(deck, draw):
    """Plane strain as a slab of one cell between two rollers in 3D."""
    if deck["dim"] == 3 or deck.get("geometry") or "time_step" not in deck or domain_of(deck) == "split":
        return None
    if set(deck.get(f"{body}_particles_per_cell") for body in names_of(deck, "bodies")) - {deck["ground_particles_per_cell"]}:
        return None
    h, out = deck["mesh_spacing"], {}
    for name, value in deck.items():
        kind, _ = kind_of(name, deck)
        side = SIDE.match(name)
        if side:
            name = name.replace(f"_{side[1]}{side[2]}", f"_{'xz'['xy'.index(side[1])]}{side[2]}")
        if kind == "place":
            y = (0.0, h)[name.endswith("upper")] if name.endswith(("lower", "upper")) else h / 2
            value = (value[0], y, value[1])
        elif kind == "vector":
            by = h if name.endswith("_force") else 1
            value = (value[0] * by, 0.0, value[1] * by)
        elif kind == "table":
            rows = [row.split(":") for row in value.split(",")]
            value = ",".join(":".join(row if len(row) == 2 else [*row[:2], "0.0", row[2]]) for row in rows)
        elif kind == "stress":
            value = (value[0], value[2], value[1], 0.0, 0.0, value[3])
        elif kind == "axis":
            value = {"x": "x", "y": "z"}[value]
        elif kind == "at" and deck[name.replace("_at", "_kind")] != "section":
            value = (value, h / 2) if not isinstance(value, tuple) else (value[0], h / 2, value[1])
        elif kind == "outline" and name.endswith("polygon"):
            out[name.replace("polygon", "width")] = (0.0, h)
        out[name] = value
    out["dim"] = 3
    for name in [name for name, value in deck.items() if name.endswith("_shape") and value == "disc"]:
        return None  # has no prism
    return Image(out, axes=(0, 2), signs=(1, 1), shift=(0.0, 0.0), copies=deck["ground_particles_per_cell"], width=h,
                 skips=".*_(strays|limited|put_back|stretched|area)")


def ranks(deck, draw):
    """Several ranks."""
    return Image(dict(deck), ranks=draw.choice([2, 2, 3]))


def strategy(deck, draw):
    """Another loop from particles to nodes."""
    return Image({**deck, "p2g": draw.choice(["sequential", "mosaic", "tile", "atomic"])})


def restart(deck, draw):
    """Two runs that a checkpoint joins, on one rank."""
    return Image(dict(deck), EXACT, cut=draw.uniform(0.1, 0.9))


def restart_ranks(deck, draw):
    """Two runs that a checkpoint joins, against one, both on two ranks."""
    return Image({**deck}, EXACT, cut=draw.uniform(0.1, 0.9), ranks=2)


def watched(deck, draw):
    """With probes, or without, and other rows and frames: looking changes nothing."""
    if "probes" in deck:
        names = names_of(deck, "probes")
        out = {name: value for name, value in deck.items() if name.partition("_")[0] not in names and name != "probes"}
    else:
        out = {**deck, "probes": "eye", "eye_kind": "point", "eye_at": tuple(x / 2 for x in deck["mesh_upper"])}
    if draw.random() < 0.5:
        out["output_energy"] = "off" if deck.get("output_energy") == "on" else "on"
    if draw.random() < 0.5:
        return Image(out, EXACT, rows=False)
    out["history_interval"] = deck["history_interval"] / draw.choice([2, 1000])  # the host looks more often, or after each step
    rigids = "|".join(names_of(deck, "rigid_bodies")) or "wall_..."
    means = "|".join(f"{pair}_(force_.|area)" for pair in pairs_of(deck)) or "wall_..."
    return Image(out, EXACT, rows=False, skips=f"(wall_....|{rigids})_force_.|{means}")  # means since the last row


IMAGES = {f.__name__: f for f in (units, any_units, mirror, turn, shift, room, order, parts, outline, thin, ranks, strategy, restart, restart_ranks, watched)}
