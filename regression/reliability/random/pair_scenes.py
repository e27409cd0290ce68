"""Scenes of deformable bodies in pairs: where the bodies of contact_pairs.py are, and their mirror images."""
import itertools
import math

from deck import vector

WIDTH, HEIGHT, DEPTH = 3.0, 1.6, 1.2  # m, of the mesh; DEPTH along y in 3D
NAMES = "abcdrstu"  # as many as a run has velocity fields; other options begin with some other letters
FACETS = [(0, 2, 1), (0, 1, 3), (0, 4, 2), (0, 3, 4), (5, 1, 2), (5, 3, 1), (5, 2, 4), (5, 4, 3)]  # of an octahedron


def write_octahedron(path, low, high):
    """A surface of eight triangles with a vertex in the middle of each face of a box."""
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    points = [list(middle) for _ in range(6)]
    for k, (axis, end) in enumerate([(2, low), (0, low), (1, low), (1, high), (0, high), (2, high)]):
        points[k][axis] = end[axis]
    lines = [line for facet in FACETS for line in ("facet normal 0 0 0", "outer loop", *("vertex " + " ".join(map(repr, points[n])) for n in facet), "endloop", "endfacet")]
    path.write_text("\n".join(["solid rock", *lines, "endsolid rock"]) + "\n")


class Scene:
    """Shapes of bodies in the boxes that a scene has for them. `words`: their options; `cell`: m; `along`: the axis of the row."""

    def __init__(self, draw, dim, kind, folder):
        self.draw, self.dim, self.kind, self.folder = draw, dim, kind, folder
        self.cell = 0.1 if dim == 2 else 0.2
        self.along = 1 if kind == "rings" else 0
        self.size = [HEIGHT, WIDTH] if kind == "rings" else [WIDTH, *[DEPTH] * (dim - 2), HEIGHT]
        self.particles = draw.choice([2, 2, 3]) if dim == 2 else 2  # a cell along an axis
        self.lattice = self.cell / self.particles
        self.words, self.velocity = [], {}
        self.rigid, self.gravity, self.sides = [], [0.0] * dim, {}
        getattr(self, kind)()
        self.names = list(self.velocity)
        self.pairs = [pair for pair in itertools.combinations(self.names, 2) if draw.random() < 0.85] or [tuple(self.names[:2])]

    def near(self, x):
        """x, on a face of a cell or a little to its side: no particle begins on such a face, whose mean round-off would choose."""
        return x + self.draw.choice([0.0, self.draw.uniform(0.003, 0.02), self.draw.uniform(0.003, 0.02)])

    def length(self, low, high):
        """A length in metres of whole particles, whose box has a mirror image."""
        return self.lattice * round(self.draw.uniform(low, high) / self.lattice)

    def speed(self, inward, size=1.5):
        """A velocity along `inward`, and some across."""
        draw = self.draw
        out = [inward[d] * draw.uniform(0.4, size) + draw.uniform(-0.3, 0.3) for d in range(self.dim)]
        return [0.0, out[1]] if self.kind == "rings" else out

    # ------------------------------------------------------------------------------------------ scenes

    def row(self):
        """Bodies along an axis, which move towards the middle."""
        count = self.draw.choice([2, 3, 4] if self.dim == 2 else [2, 3])
        width = 2.6 / count
        for k in range(count):
            middle = [0.6] * (self.dim - 1) + [0.8 + self.draw.uniform(-0.15, 0.15)]
            middle[self.along] = 0.2 + width * (k + 0.5) + self.draw.uniform(0.005, 0.02)
            half = [self.draw.uniform(0.25, 0.45) for _ in middle]
            half[self.along] = 0.5 * self.lattice * int((width - self.draw.uniform(0.002, 0.06)) / self.lattice)
            inward = [float(d == self.along) * (1 - 2 * k / (count - 1)) for d in range(self.dim)]
            self.add(NAMES[k], [m - h for m, h in zip(middle, half)], [m + h for m, h in zip(middle, half)], inward)

    def rings(self):
        """A row along the axis of revolution, of bodies about it or at a distance from it."""
        self.row()
        inner = self.draw.choice([0.0, 0.0, 0.25])
        for k, word in enumerate(self.words):
            if word.endswith(("_lower", "_centre", "_upper")):
                place = [float(x) for x in self.words[k + 1].split(",")]
                place[0] = inner + (self.draw.uniform(0.4, 1.0) if word.endswith("_upper") else 0.0)
                self.words[k + 1] = vector(place)

    def corner(self):
        """Three or four bodies about a point, into which they move: all have the nodes there."""
        at, gap, joined = [self.near(1.5), *[0.6] * (self.dim - 2), self.near(0.8)], self.draw.choice([0.0, 0.0, 0.03]), self.draw.random() < 0.4
        places = [(-1, -1), (1, -1), *([(0, 1)] if joined else [(-1, 1), (1, 1)])]
        for name, (x, z) in zip(NAMES, places):
            low, high = list(at), list(at)
            for axis, side in ((0, x), (self.dim - 1, z)):
                size = self.length(0.35, 0.55)
                low[axis] = at[axis] + (gap if side > 0 else -gap - size if side < 0 else -size)
                high[axis] = low[axis] + (size if side else 2 * size)
            if self.dim == 3:
                low[1], high[1] = 0.2, 0.2 + self.length(0.6, 0.8)
            self.add(name, low, high, [-x, *[0.0] * (self.dim - 2), -z])

    def wheel(self):
        """Five to eight wedges about a point, into which they move."""
        at, count, turned = [self.near(1.5), self.near(0.8)], self.draw.randint(5, 8), self.draw.uniform(0, 1)
        for k, name in enumerate(NAMES[:count]):
            a, b, middle = (2 * math.pi / count * (k + part) + turned for part in (0.03, 0.97, 0.5))
            radius = self.draw.uniform(0.5, 0.7)
            tip = [at[0] + 0.02 * math.cos(middle), at[1] + 0.02 * math.sin(middle)]
            outline = [*tip, *(value for angle in (a, b) for value in (at[0] + radius * math.cos(angle), at[1] + radius * math.sin(angle)))]
            self.velocity[name] = self.speed([-math.cos(middle), *[0.0] * (self.dim - 2), -math.sin(middle)])
            self.words += [f"-{name}_shape", "polygon", f"-{name}_polygon", vector(outline), *(["-" + name + "_width", "0.2,1.0"] if self.dim == 3 else [])]

    def inside(self):
        """A body that is cut out of another one, and maybe of a third above it, and moves in it."""
        x, z = self.near(1.5), self.near(0.3)
        parts, level = self.draw.choice([1, 2]), z
        size = [self.length(0.45, 0.6) for _ in range(2)]
        for name in NAMES[1:1 + parts]:
            top = level + self.length(*((0.4, 0.5) if parts == 2 else (0.8, 1.0)))
            low, high = [x - size[0], *[0.1] * (self.dim - 2), level], [x + size[1], *[1.1] * (self.dim - 2), top]
            self.words += [f"-{name}_cut_out", "a"]
            self.add(name, low, high, [0.0] * self.dim, simple=True)
            level = top
        half, bottom = self.length(0.17, 0.25), self.near(0.6)
        low, high = [x - half, *[0.6 - half] * (self.dim - 2), bottom], [x + half, *[0.6 + half] * (self.dim - 2), bottom + 2 * half]
        self.add("a", low, high, [self.draw.choice([-1, 0, 1]), *[0.0] * (self.dim - 2), self.draw.choice([-1, 1])])

    def ground(self):
        """Two bodies side by side on the bottom of the mesh, between its sides or not, and one that falls or stands on both."""
        draw, up = self.draw, self.dim - 1
        self.gravity[up] = -9.81
        wide, level, middle = draw.random() < 0.5, self.length(0.4, 0.7), self.near(1.5)
        middle = 1.5 if wide else middle
        for name, low, high in (("a", 0.0 if wide else middle - self.length(0.9, 1.1), middle), ("b", middle, WIDTH if wide else middle + self.length(0.9, 1.1))):
            self.add(name, [low, *[0.0] * (self.dim - 2), 0.0], [high, *[DEPTH] * (self.dim - 2), level], [0.0] * self.dim, simple=True)
        half, base = self.length(0.25, 0.4), level + draw.choice([0.0, 0.0, 0.04])
        low, high = [middle - half, *[0.2] * (self.dim - 2), base], [middle + half, *[0.9] * (self.dim - 2), base + self.length(0.35, 0.5)]
        self.add("c", low, high, [0.0] * (self.dim - 1) + [-0.5])
        kinds = ["smooth", "friction", "fixed", "roller"]
        side = draw.choice(kinds)
        self.sides = {**{f"{axis}{end}": side for axis in "xyz"[:up] for end in ("min", "max")}, f"{'xyz'[up]}min": draw.choice(kinds)}

    def rigid_between(self):
        """A row of two, and a rigid body that falls on the place where they meet."""
        draw, up = self.draw, self.dim - 1
        for k, name in enumerate("ab"):
            low = [self.near(0.7) if k == 0 else self.near(1.52), *[0.2] * (self.dim - 2), self.near(0.2)]
            high = [low[0] + self.length(0.6, 0.78), *[0.9] * (self.dim - 2), low[up] + self.length(0.5, 0.65)]
            self.add(name, low, high, [1 - 2 * k, *[0.0] * (self.dim - 1)])
        base = 0.9
        shape = draw.choice(["box", "disc", "polygon"])
        self.rigid = ["-rigid_bodies", "tool"]
        if shape == "box":
            self.rigid += ["-tool_shape", "box", "-tool_lower", vector([1.2, *[0.3] * (self.dim - 2), base]), "-tool_upper", vector([1.8, *[0.8] * (self.dim - 2), base + 0.3])]
        elif shape == "disc":
            self.rigid += ["-tool_shape", "disc" if self.dim == 2 else "ball", "-tool_centre", vector([1.5, *[0.6] * (self.dim - 2), base + 0.3]), "-tool_radius", "0.3"]
        else:
            self.rigid += ["-tool_shape", "polygon", "-tool_polygon", vector([1.5, base - 0.05, 1.8, base + 0.3, 1.2, base + 0.3])]
            self.rigid += ["-tool_width", "0.3,0.8"] if self.dim == 3 else []
        down = vector([0.0] * up + [-draw.uniform(0.5, 2)])
        self.rigid += ["-tool_velocity", down, "-tool_motion", *draw.choice([["prescribed"], ["dynamic", "-tool_density", "2500"]])]
        self.rigid += draw.choice([[], ["-tool_friction", "0.4"], ["-tool_shear_limit", "500"]])

    # ------------------------------------------------------------------------------------------ shapes

    def add(self, name, low, high, inward, simple=False):
        """A body of a random shape in a box; simple: one that has its faces."""
        draw, dim = self.draw, self.dim
        self.velocity[name] = self.speed(inward)
        shapes = ["box"] if simple else ["box", "box", "round", "round", "polygon"] + (["stl", "cylinder"] if dim == 3 else [])
        shape = draw.choice(["box", "box", "round"] if self.kind == "rings" else shapes)
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        radius = min(b - a for a, b in zip(low, high)) / 2
        fill = draw.choice([[], [], [f"-{name}_fill", "centre"]])
        if shape == "box":
            self.words += [f"-{name}_shape", "box", f"-{name}_lower", vector(low), f"-{name}_upper", vector(high), *fill]
        elif shape == "round":
            self.words += [f"-{name}_shape", "disc" if dim == 2 else "ball", f"-{name}_centre", vector(middle), f"-{name}_radius", f"{radius:.6f}", *fill]
        elif shape == "cylinder":
            self.words += [f"-{name}_shape", "cylinder", f"-{name}_centre", vector([*middle[:2], low[2]]), f"-{name}_radius", f"{min(radius, 0.45):.6f}",
                           f"-{name}_height", f"{high[2] - low[2]:.6f}"]
        elif shape == "stl":
            write_octahedron(self.folder / f"{name}.stl", low, high)
            self.words += [f"-{name}_shape", "stl", f"-{name}_file", str(self.folder / f"{name}.stl")]
        else:
            (x, z), (u, w) = (low[0], low[-1]), (high[0], high[-1])
            outline = draw.choice([[x, z, u, z, u, z + 0.6 * (w - z), x, w], [x + 0.2 * (u - x), z, u, z + 0.2 * (w - z), u - 0.2 * (u - x), w, x, w - 0.2 * (w - z)],
                                   [x, z, u, z, middle[0], w], [x, z, u, z, u, w, middle[0], w, middle[0], middle[-1], x, middle[-1]]])
            self.words += [f"-{name}_shape", "polygon", f"-{name}_polygon", vector(outline), *fill]
            self.words += [f"-{name}_width", vector([low[1], high[1]])] if dim == 3 else []

    def mirrored(self, words):
        """The options of the scene's image across the middle of the mesh along the row; None where a shape has no image."""
        if any(word.endswith("stl") for word in words):
            return None
        words, axis, wide = list(words), self.along, WIDTH
        for k in range(len(words) - 1):
            key = words[k].rsplit("_", 1)[-1] if words[k].startswith("-") else ""
            if key not in ("velocity", "centre", "lower", "upper", "polygon") or words[k].startswith("-mesh"):
                continue
            values = [float(x) for x in words[k + 1].split(",")]
            if key == "polygon":
                points = [[wide - a, b] if axis == 0 else [a, wide - b] for a, b in zip(values[::2], values[1::2])]
                values = [x for point in points[::-1] for x in point]
            else:
                values[axis] = -values[axis] if key == "velocity" else wide - values[axis]
            words[k + 1] = vector(values)
        for k in [k for k, word in enumerate(words) if word.endswith("_lower") and not word.startswith("-mesh")]:
            end = words.index(words[k].replace("_lower", "_upper")) + 1
            low, high = ([float(x) for x in words[n].split(",")] for n in (k + 1, end))
            low[axis], high[axis] = high[axis], low[axis]
            words[k + 1], words[end] = vector(low), vector(high)
        return words
