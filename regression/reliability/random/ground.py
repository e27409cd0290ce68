"""Ground: bodies from closed triangle surfaces and layers, whose particles must have the volume of the shape.

A deck has one to four layers between random levels, polylines and rasters (which may touch), or a ball, a wedge or a tilted box of
triangles, with one to four particles a cell in each direction, and makes a few steps under gravity. Some take their strength from a
field. Each run must end well with the exact volume, to 1e-3, in the history's masses and the first frame, and the strengths of the field;
several ranks must have the particles of one. With each deck goes a file of ground of which bytes are changed, taken out or put in: the
program takes it, or refuses it with one line.
"""
import pathlib

import h5py
import numpy as np

from deck import Deck
from mpm_regression.folders import frames, rows

DENSITY = 1700.0


def triangles_of_ball(halvings):
    corners = np.array([[[1, 0, 0], [0, 1, 0], [0, 0, 1]]], float)
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    faces = []
    for sign in signs:
        face = corners[0] * sign
        faces.append(face if sign.prod() > 0 else face[[1, 0, 2]])
    faces = np.array(faces)
    for _ in range(halvings):
        a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
        p, q, r = ((u + v) / np.linalg.norm(u + v, axis=1, keepdims=True) for u, v in ((a, b), (b, c), (c, a)))
        faces = np.concatenate([np.stack(t, 1) for t in ((a, p, r), (p, b, q), (r, q, c), (p, q, r))])
    return faces


def triangles_of_prism(outline, width):
    """A prism along y over a convex outline, anticlockwise in x and z."""
    front = [np.array([x, 0, z]) for x, z in outline]
    back = [np.array([x, width, z]) for x, z in outline]
    n, faces = len(outline), []
    for k in range(n):
        m = (k + 1) % n
        faces += [(front[k], back[m], front[m]), (front[k], back[k], back[m])]
    for k in range(1, n - 1):
        faces += [(front[0], front[k + 1], front[k])[::-1], (back[0], back[k + 1], back[k])]
    return np.array(faces)


def volume_of(faces):
    return np.einsum("ij,ij->i", faces[:, 0], np.cross(faces[:, 1], faces[:, 2])).sum() / 6


def turn(faces, draw):
    q, _ = np.linalg.qr(np.array([[draw.gauss(0, 1) for _ in range(3)] for _ in range(3)]))
    return faces @ (q if np.linalg.det(q) > 0 else -q)


def write_stl(path, faces, binary):
    if binary:
        record = np.zeros(len(faces), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
        record["corners"] = faces
        path.write_bytes(b"binary".ljust(80) + np.uint32(len(faces)).tobytes() + record.tobytes())
        return record["corners"].astype(float)
    lines = ["solid ground"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop", *(f"vertex {x!r} {y!r} {z!r}" for x, y, z in face.tolist()), "endloop",
                  "endfacet"]
    path.write_text("\n".join([*lines, "endsolid ground", ""]))
    return faces


def write_raster(path, values, x, y, cell):
    rows_, columns = values.shape
    text = [f"ncols {columns}", f"nrows {rows_}", f"xllcorner {x!r}", f"yllcorner {y!r}", f"cellsize {cell!r}"]
    path.write_text("\n".join(text + [" ".join(map(repr, row.tolist())) for row in values[::-1]]) + "\n")


class Surfaces:
    """Surfaces one under the other over a plan of 6 m x 4 m; `last` are the heights of all on one common grid of lines."""

    def __init__(self, draw, folder, dim):
        self.draw, self.folder, self.dim, self.cell = draw, folder, dim, draw.choice([0.5, 0.75, 1.3])
        self.count = 0
        nx, ny = int(np.ceil(6 / self.cell)) + 2, int(np.ceil(4 / self.cell)) + 2
        self.x = np.sort([draw.uniform(0.3, 5.7) for _ in range(4)])
        self.shape = (ny, nx) if dim == 3 else (6,)
        self.top = np.full(self.shape, 5.5)

    def noise(self, size):
        return np.array([self.draw.random() for _ in range(int(np.prod(size)))]).reshape(size)

    def next(self):
        """The text of an option and the mean height in the plan of a surface at or under the last one."""
        drop = np.maximum(self.noise(self.shape) * 1.6 - 0.3, 0)
        if self.draw.random() < 0.25:
            heights = np.full(self.shape, max(self.top.min() - self.draw.uniform(0.2, 1), 0.0))
        else:
            heights = np.maximum(self.top - drop, 0)
        self.top = heights
        flat = heights.ravel()
        if (flat == flat[0]).all():
            return repr(float(flat[0])), float(flat[0])
        if self.dim == 2:
            x = np.concatenate([[0], self.x, [6]])
            return ",".join(f"{a!r},{b!r}" for a, b in zip(x.tolist(), heights.tolist())), float(((heights[1:] + heights[:-1]) / 2 * np.diff(x)).sum() / 6)
        path = self.folder / f"surface_{self.count}.asc"
        self.count += 1
        write_raster(path, heights, -0.31, -0.17, self.cell)
        return str(path), mean_in_plan(heights, -0.31, -0.17, self.cell, 6, 4)


def mean_in_plan(heights, x, y, cell, width, depth):
    """By points of Gauss in the parts that the program's triangles do not share with the outside: the plan is cut into the pieces
    between lines, and each of these into many small squares."""
    ny, nx = heights.shape
    edges = [np.unique(np.concatenate([np.clip(o + (np.arange(n) + 0.5) * cell, 0, end), [0, end]]))
             for o, n, end in ((x, nx, width), (y, ny, depth))]
    total = 0.0
    for i in range(len(edges[0]) - 1):
        for j in range(len(edges[1]) - 1):
            m = 24
            u = edges[0][i] + (np.arange(m) + 0.5) / m * (edges[0][i + 1] - edges[0][i])
            v = edges[1][j] + (np.arange(m) + 0.5) / m * (edges[1][j + 1] - edges[1][j])
            a, b = np.meshgrid(u, v)
            total += triangles_at(heights, (a - x) / cell - 0.5, (b - y) / cell - 0.5).mean() * np.ptp(edges[0][i:i + 2]) * np.ptp(
                edges[1][j:j + 2])
    return total / (width * depth)


def triangles_at(z, a, b):
    """Heights at places in cells from the middle of the first one, by four triangles of equal corners' mean."""
    ny, nx = z.shape
    a, b = np.clip(a, 0, nx - 1), np.clip(b, 0, ny - 1)
    i, j = np.minimum(a.astype(int), nx - 2), np.minimum(b.astype(int), ny - 2)
    s, t = a - i, b - j
    p, q, r, w = z[j, i], z[j, i + 1], z[j + 1, i], z[j + 1, i + 1]
    middle = (p + q + r + w) / 4

    def side(c, d, away, along):
        return c + (d - c) * along + away * (2 * middle - c - d)
    return np.where((t <= s) & (t <= 1 - s), side(p, q, t, s),
                    np.where((t >= s) & (t >= 1 - s), side(r, w, 1 - t, s),
                             np.where(s <= t, side(p, r, s, t), side(q, w, 1 - s, t))))


def layers(draw, folder, dim):
    """Options and {body: volume}."""
    surfaces, bodies, options = Surfaces(draw, folder, dim), {}, []
    above, mean_above = surfaces.next()
    for k in range(draw.randint(1, 4)):
        below, mean_below = surfaces.next()
        if mean_above - mean_below < 0.05:
            continue
        name, previous = f"layer{k}", list(bodies)
        shared = previous and options[options.index(f"-{previous[-1]}_base") + 1] == above
        options += [f"-{name}_shape", "layer", f"-{name}_top", previous[-1] if shared and draw.random() < 0.5 else above,
                    f"-{name}_base", below]
        bodies[name] = (mean_above - mean_below) * (24 if dim == 3 else 6)
        above, mean_above = below, mean_below
    return options, bodies


def solid(draw, folder):
    kind = draw.choice(["ball", "wedge", "box"])
    if kind == "ball":
        faces = triangles_of_ball(draw.randint(2, 4)) * draw.uniform(0.7, 1.4)
    elif kind == "wedge":
        faces = triangles_of_prism([(0, 0), (draw.uniform(1, 2.5), 0), (draw.uniform(0, 2), draw.uniform(0.5, 1.8))], draw.uniform(0.8, 2))
    else:
        a, b, c = (draw.uniform(0.5, 1.6) for _ in range(3))
        faces = triangles_of_prism([(0, 0), (a, 0), (a, c), (0, c)], b)
    faces = turn(faces, draw)
    faces = faces - (faces.min((0, 1)) + faces.max((0, 1))) / 2 + np.array([3, 2, 2.9]) + [draw.uniform(-0.2, 0.2) for _ in range(3)]
    path = folder / "solid.stl"
    faces = write_stl(path, faces, draw.random() < 0.5)
    return ["-soil_shape", "stl", "-soil_file", str(path)], {"soil": volume_of(faces)}


STRENGTH = np.array([2e4, 700.0, -450.0, 1100.0])  # Pa, and its growth along x, y, z


def write_field(path, draw, dim):
    """A strength that is linear in space, on a grid around the mesh."""
    lower, spacing = [-draw.random() for _ in range(dim)], [draw.uniform(0.4, 2) for _ in range(dim)]
    axes = [low + h * np.arange(int(np.ceil((6 - low) / h)) + 2) for low, h in zip(lower, spacing)]
    grid = np.meshgrid(*axes, indexing="ij")
    slopes = STRENGTH[1:] if dim == 3 else STRENGTH[[1, 3]]
    with h5py.File(path, "w") as file:
        data = file.create_dataset("su", data=(STRENGTH[0] + sum(s * x for s, x in zip(slopes, grid))).T)
        data.attrs["lower"], data.attrs["spacing"] = lower, spacing


class Ground(Deck):
    strategies = ("tile", "tile", "tile", "sequential", "atomic", "mosaic", "gather")
    restarts, several, others = 0.1, 0.6, 0.0

    def make(self):
        self.options, self.bodies, self.width = self.draw_ground(self.dim)

    def draw_ground(self, dim):
        """Options, {body: exact volume [m3]}, and the edge of a particle [m]."""
        draw, folder, bodies = self.draw, self.folder, {}
        while not bodies:
            options, bodies = solid(draw, folder) if dim == 3 and draw.random() < 0.4 else layers(draw, folder, dim)
        per_cell = draw.choice([1, 2, 2, 3, 4]) if dim == 2 else draw.choice([1, 2, 2, 3])
        spacing, law = draw.choice([0.25, 0.5]), draw.choice([["von_mises", "-clay_su", draw.choice([1e3, 1e5])], ["linear_elastic"]])
        upper, gravity = ("6,6", "0,-9.81") if dim == 2 else ("6,4,6", "0,0,-9.81")
        words = ["-dim", dim, "-mesh_lower", ",".join(["0"] * dim), "-mesh_upper", upper, "-mesh_spacing", spacing, "-gravity", gravity,
                 "-materials", "clay", "-clay_density", DENSITY, "-clay_young", 1e7, "-clay_poisson", 0.3, "-clay_model", *law,
                 "-time_end", 1, "-time_max_steps", draw.randint(1, 30), "-bodies", ",".join(bodies)]
        field = folder / "field.h5"
        field.unlink(missing_ok=True)
        if len(law) > 1 and draw.random() < 0.7:
            write_field(field, draw, dim)
        for name in bodies:
            words += [f"-{name}_material", "clay", f"-{name}_particles_per_cell", per_cell]
            words += [f"-{name}_field", field] if field.exists() else []
        return [str(word) for word in words + options], bodies, spacing / per_cell

    def check(self, folder):
        header, first, *_ = rows(folder)
        with h5py.File(frames(folder)[0]) as frame:
            for name, volume in self.bodies.items():
                mass, held = float(first[header.index(f"{name}_mass")]), frame[name]["volume"][()]
                assert abs(mass / DENSITY / volume - 1) < 1e-3, f"{name}: mass {mass / DENSITY}, exact volume {volume}"
                assert abs(held.sum() / volume - 1) < 1e-3, f"{name}: volume {held.sum()}, exact {volume}"
                assert held.min() > 0 and held.max() < 2.5 * self.width**self.dim, f"{name}: volumes {held.min()} to {held.max()}"
                if f"-{name}_field" in self.options:
                    x = frame[name]["position"][()]
                    exact = STRENGTH[0] + x @ (STRENGTH[1:] if self.dim == 3 else STRENGTH[[1, 3, 2]] * [1, 1, 0])
                    assert np.allclose(frame[name]["su"][()], exact, rtol=1e-6), f"{name}: strengths of the field"

    def check_other(self, folder, whole, what):
        self.check(folder)
        with h5py.File(frames(whole)[0]) as one, h5py.File(frames(folder)[0]) as many:
            for name in self.bodies:
                for field in ("position", "volume", "mass", *(["su"] if f"-{name}_field" in self.options else [])):
                    assert np.array_equal(one[name][field][()], many[name][field][()]), f"{what}: {name}/{field}"

    def compare(self, whole):
        options, _, _ = self.draw_ground(3) if "3" in self.given.dims else ([], 0, 0)
        used = [pathlib.Path(word) for word in options if word.startswith(str(self.folder))]
        if not used:
            return
        path = self.draw.choice(used)
        path.write_bytes(self.spoiled(bytearray(path.read_bytes())))
        _, done = self.launch("spoiled", "-dry_run", options=options, status=None)
        lines = done.stderr.strip().splitlines()
        good = done.returncode == 0 or (done.returncode == 2 and 1 <= len(lines) <= 4 and all(
            line.startswith("mpm: -") and ", takes " in line for line in lines))
        assert good, f"spoiled file {path.name}: status {done.returncode}\n{done.stderr[-1500:]}\n{' '.join(options)}"

    def spoiled(self, content):
        draw = self.draw
        for _ in range(draw.choice([1, 1, 3, 30])):
            at = draw.randrange(len(content))
            what = draw.choice(["change", "cut", "out", "in"])
            if what == "change":
                content[at] = draw.randrange(256)
            elif what == "cut" and draw.random() < 0.3:
                del content[at:]
            elif what == "out":
                del content[at:at + draw.choice([1, 7, 50])]
            else:
                content[at:at] = draw.choice([b"0", b"9e9", b"-", b"nan", b"\0", b" vertex ", b"\n", bytes(draw.randrange(256) for _ in range(9))])
            content = content or bytearray(b"x")
        return bytes(content)
