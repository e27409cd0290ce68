"""Random decks: mostly valid, with extreme values; their files, the nesting of options files, and the environment."""
import dataclasses
import random as generators

from deck_files import damage, odd_file, particle_file
from deck_values import read_table, value_of, wrong_value

TABLE = read_table()
# Sections of the table whose options do not make a run long, and options of them that do.
LIGHT = ("Run", "Particle", "Several", "Time", "Physics", "Output", "Material", "Each material", "Each rigid", "Each body NAME")
HEAVY = ("particles_per_cell", "mesh_lower", "mesh_upper", "mesh_spacing", "time_max_steps", "fill", "fillet")
# Options that make most decks wrong are drawn seldom.
RARE = ("dim", "output_dir", "restart", "materials", "bodies", "rigid_bodies", "wall_time_limit", "mesh_lower", "mesh_upper",
        "mesh_spacing", "dry_run", "device_memory_limit", "NAME_model", "NAME_shape")
GEOMETRY = ("lower", "upper", "polygon", "width", "centre", "radius", "point", "normal", "file", "fillet", "angle_deg",
            "material", "cut_out")
PETSC = [
    "-log_view", "-log_view :log.txt", "-log_view :missing/log.txt", "-options_view", "-options_left", "-malloc_debug",
    "-memory_view", "-objects_dump", "-help", "-version", "-info :info.txt", "-history petsc.txt", "-log_exclude vec", "-nox",
    "-saws_options", "-options_monitor", "-dll_append x.so", "-dm_view :dm.txt", "-malloc_dump", "-petsc_unknown 3", "-get_total_flops", "-skip_petscrc",
    "--kokkos-num-threads=1", "--kokkos-num-threads=foo", "--kokkos-help", "--kokkos-device-id=7", "-p2g", "-dim", "- 3",
    "--dim 2", "dim 2", "-unknown_option"]
ENVIRONMENTS = {
    "OMP_NUM_THREADS": ["", "0", "-1", "2", "3", "foo", "100000", "1,2", "99999999999"],
    "OMP_PROC_BIND": ["true", "close", "foo"],
    "PETSC_OPTIONS": ["-dim 3", "-log_view", "-options_file missing", "- -", "\"", "-malloc_debug", "#"],
    "HOME": ["", "/missing", "/dev/null"],
    "XDG_CACHE_HOME": ["/dev/null", "/proc", "cache", ""],
    "LC_ALL": ["C", "de_DE.UTF-8", "foo"],
    "TMPDIR": ["/missing", "/dev/null"],
    "KOKKOS_NUM_THREADS": ["0", "foo", "2"],
    "HDF5_USE_FILE_LOCKING": ["FALSE", "foo"],
    "TZ": ["foo", ":/dev/zero"],
    "COLUMNS": ["0", "-1"]}
RC_FILES = [b"", b"-dim 3\n", b"garbage\n", b"\0\xff" * 40, b"-options_file .petscrc\n", b"-p2g tile\n", b"#" * 5000]


@dataclasses.dataclass
class Trial:
    """One start of the program, all that it needs. `lines` are the deck's; the rest of its files are bytes or special."""
    lines: list
    words: list = dataclasses.field(default_factory=list)          # of the command line
    files: dict = dataclasses.field(default_factory=dict)          # {name: bytes or one of deck_files.SPECIAL}
    environment: dict = dataclasses.field(default_factory=dict)
    ranks: int = 1
    by_pipe: bool = False                                          # the deck comes from standard input


def shape(random, name, low, size, cell, dim, rigid):
    """Lines of a shape within low .. low + size [m]."""
    mid = [a + b / 2 for a, b in zip(low, size)]
    high = [a + b for a, b in zip(low, size)]
    join = lambda values: ",".join(f"{v:.17g}" for v in values)
    kind = random.choice(["box", "box", "disc", "polygon", "half_plane" if rigid else "box"])
    lines = [f"-{name}_shape {kind}"]
    if kind == "box":
        lines += [f"-{name}_lower {join(low)}", f"-{name}_upper {join(high)}"]
        if random.random() < 0.2:
            lines.append(f"-{name}_fillet {random.choice([0, 1e-9, 0.1, 0.499999, 0.5]) * min(size):.17g}")
    elif kind == "disc":
        lines += [f"-{name}_centre {join(mid)}", f"-{name}_radius {0.499 * min(size):.17g}"]
    elif kind == "half_plane":
        lines += [f"-{name}_point {join(mid)}", f"-{name}_normal {join([random.uniform(-0.3, 0.3) for _ in size[1:]] + [1])}"]
    else:
        (x, z), (a, c) = (low[0], low[-1]), (size[0], size[-1])
        lines.append(f"-{name}_polygon {join([x, z, x + a, z, x + a * random.random(), z + c])}")
        if dim == 3:
            lines.append(f"-{name}_width {join([low[1], high[1]])}")
    return lines


def motion(random, name, scale, dim):
    vector = lambda size: ",".join(f"{random.uniform(-1, 1) * size:.9g}" for _ in range(dim))
    kind = random.choice(["fixed", "prescribed", "dynamic"])
    lines = [f"-{name}_motion {kind}"]
    if kind != "fixed":
        lines.append(f"-{name}_velocity {vector(scale)}")
    if kind == "dynamic":
        lines.append(f"-{name}_density {10 ** random.uniform(-3, 6):.6g}")
    return lines


def template(random):
    """A small valid deck: layers of soil and perhaps a rigid, at any scale and anywhere. Returns its lines and what it has."""
    dim, extreme = random.choice([2, 2, 3]), random.random() < 0.12
    power = lambda least, most: 10 ** random.uniform(least, most)
    cell = random.choice([1.0, 0.1, 0.5, power(-9, 9)]) if not extreme else random.choice([1.0, power(-100, 100)])
    cells = [random.randint(3, 9 if dim == 2 else 5) for _ in range(dim - 1)] + [random.randint(8, 14 if dim == 2 else 9)]
    far = random.choice([0, 0, 1, random.uniform(-100, 100), 10 ** random.uniform(0, 15)])
    low = [far * cell] * dim
    high = [a + n * cell for a, n in zip(low, cells)]
    join = lambda values: ",".join(f"{v:.17g}" for v in values)
    modulus, density = power(-3, 15), power(-250, 250) if extreme else power(-6, 9)
    speed = (modulus / density) ** 0.5
    lines = [f"-dim {dim}", f"-mesh_lower {join(low)}", f"-mesh_upper {join(high)}", f"-mesh_spacing {cell:.17g}",
             f"-time_end {random.choice([1, 5, 100, 1e4, 1e10]) * 0.2 * cell / speed:.9g}",
             f"-gravity {','.join(['0'] * (dim - 1) + [f'{-random.choice([0, 9.81, 1e-9, 1e-3 * speed ** 2 / cell]):.9g}'])}"]
    for side in ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"][:2 * dim]:
        if random.random() < 0.4:
            lines.append(f"-mesh_{side} {random.choice(['roller', 'fixed', 'free'])}")
    bodies, rigids = random.choice([["soil"], ["soil"], ["soil", "boulder"]]), random.choice([[], ["plate"]])
    lines += ["-materials clay", f"-clay_density {density:.9g}", f"-clay_young {modulus:.9g}",
              f"-clay_poisson {random.uniform(-0.5, 0.499):.6g}", f"-bodies {','.join(bodies)}"]
    strength = min(modulus * 10 ** random.uniform(-12, 0), 1e12)
    elastic = random.random() < 0.3
    lines += ["-clay_model linear_elastic"] if elastic else ["-clay_model von_mises", f"-clay_su {strength:.9g}"]
    layer = [n * cell for n in cells[:-1]] + [2 * cell]
    for k, name in enumerate(bodies + rigids):
        at = low[:-1] + [low[-1] + (3 * k if k < 3 else 6) * cell]
        lines += shape(random, name, at, layer, cell, dim, name in rigids)
        lines += [f"-{name}_material clay"] if name in bodies else motion(random, name, 0.01 * speed, dim)
    if rigids:
        lines.append("-rigid_bodies plate")
    if extreme:
        lines.append(f"-soil_velocity {','.join(f'{power(-200, 200):.9g}' for _ in range(dim))}")
    what = {"dim": dim, "bodies": bodies, "rigid_bodies": rigids, "materials": ["clay"], "low": low, "cell": cell}
    return lines, what


def mutations(random, what):
    """Lines of options drawn from the table, and whether one of them can make a run long."""
    lines, heavy = [], False
    for _ in range(random.choice([0, 1, 1, 2, 2, 3, 5, 8])):
        option, (section, takes) = random.choice(list(TABLE.items()))
        if (option in RARE or option.removeprefix("NAME_") in GEOMETRY) and random.random() < 0.9:
            continue
        owner = what["materials"] if "aterial" in section else what["rigid_bodies"] if "Each rigid" in section else what["bodies"] + (
            what["rigid_bodies"] if "or rigid" in section else [])
        if "NAME" in option and not owner:
            continue
        value = wrong_value(random) if random.random() < 0.08 else value_of(random, takes, what["dim"], what)
        lines.append(f"-{option.replace('NAME', random.choice(owner) if 'NAME' in option else '')} {value}")
        heavy = heavy or any(word in option for word in HEAVY) or not section.startswith(LIGHT)
    return lines, heavy


def add_particles(random, trial, what):
    """Lets the first body be the particles of a file."""
    name = what["bodies"][0]
    keep = (f"-{name}_material", f"-{name}_velocity", f"-{name}_particles")
    trial.lines = [line for line in trial.lines if not line.startswith(f"-{name}_") or line.startswith(keep)]
    trial.lines += [f"-{name}_shape particles", f"-{name}_file particles.h5"]
    trial.files["particles.h5"] = particle_file(random, name, what["low"], what["cell"], what["dim"])


def nest(random, trial):
    """Moves a part of the deck into another file, and does to the deck what people and editors do."""
    kind = random.randrange(12)
    if kind < 5 and len(trial.lines) > 2:
        first = random.randrange(len(trial.lines))
        part = trial.lines[first:]
        trial.lines = trial.lines[:first] + ["-options_file part.opts"]
        if kind == 0:
            part.append(random.choice(["-options_file part.opts", "-options_file deck.opts", "-options_file missing.opts"]))
        content = "".join(f"{line}\n" for line in part).encode(errors="surrogateescape")
        trial.files["part.opts"] = content if kind < 4 else random.choice([damage(random, content), odd_file(random)])
    elif kind == 5:
        for k in range(30):
            trial.files[f"chain{k}.opts"] = f"-options_file chain{k + 1}.opts\n".encode()
        trial.files["chain30.opts"] = b"-damping 0.1\n"
        trial.lines.append("-options_file chain0.opts")
    elif kind == 6:
        prefix = random.choice(["-prefix_push clay_", "-prefix_pop", "-prefix_push", "-prefix_push x_ -prefix_pop"])
        trial.lines.insert(random.randrange(len(trial.lines) + 1), prefix)
    elif kind == 7:
        blank, end = random.choice(["\t", "  ", " = ", "="]), random.choice(["", "  # note", "\r", " \\"])
        trial.lines = [line.replace(" ", blank) + end for line in trial.lines]
    elif kind == 8:
        trial.lines.insert(0, random.choice(["\ufeff# deck", "\0", "x" * 70000, "!", "%YAML", "---", "/* note", "\"unclosed", "'",
                                             "-options_file_yaml part.yaml"]))
        trial.files["part.yaml"] = random.choice([b"damping: 0.1\n", b"a: [\n", b"- - -\n", b"dim: {x: 2}\n", b""])
    elif kind == 9:
        trial.lines += [random.choice(trial.lines) for _ in range(3)]
    elif kind == 10:
        trial.lines = trial.lines[:random.randrange(len(trial.lines))]
    else:
        trial.words += random.sample(trial.lines, 2)[0].split(" ", 1)


def surround(random, trial):
    """Options of PETSc and Kokkos, the environment, files beside the deck, ranks."""
    if random.random() < 0.12:
        trial.words += random.choice(PETSC).split()
    if random.random() < 0.15:
        name = random.choice(list(ENVIRONMENTS))
        trial.environment[name] = random.choice(ENVIRONMENTS[name])
    if random.random() < 0.04:
        trial.files[".petscrc"] = random.choice(RC_FILES)
    if random.random() < 0.04:
        trial.files["restart.h5"] = odd_file(random)
        trial.words += ["-restart", random.choice(["restart.h5", "latest"])]
    if random.random() < 0.03:
        trial.files["out"] = random.choice([b"in the way", "loop", "fifo"])
    trial.by_pipe = random.random() < 0.03
    trial.ranks = 2 if random.random() < 0.02 else 1


def make_trial(seed, k):
    """The k-th trial of a seed, always the same."""
    random = generators.Random(f"{seed} {k}")
    lines, what = template(random)
    more, heavy = mutations(random, what)
    trial = Trial(lines + more)
    if random.random() < 0.15:
        add_particles(random, trial, what)
    if random.random() < 0.15:
        nest(random, trial)
    surround(random, trial)
    if heavy or random.random() < 0.55:
        trial.words.append("-dry_run")
    else:
        trial.words += ["-time_max_steps", str(random.choice([1, 1, 2, 5, 20]))]
    return trial
