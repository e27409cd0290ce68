"""Tests of a soil laboratory as paths of a single material point, and their results as a laboratory reports them. Needs numpy.

A path is what `mpm -element_path` reads: logarithmic strains, tension positive. Results are in the laboratory's terms:
effective stresses in Pa and engineering strains (change over first length), compression positive. y is the axis of the
sample, x and z are its sides; a shear box shears xy, plane strain holds z.
"""
import csv
from dataclasses import dataclass, field

import numpy as np

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")
ROUND_OFF = 1e-5  # of a stress or strain that a path was to reach, in single precision
MEAN, EVEN = "dsxx+dsyy+dszz", "dsxx-dszz"  # sums of a path: of the mean stress, and of the two lateral stresses
KINDS = ("triaxial", "biaxial", "oedometer", "isotropic", "shear")
# Plots of a laboratory: the abscissa of each kind, and the values that may be measured over it.
ABSCISSA = {"triaxial": "axial_strain", "biaxial": "axial_strain", "oedometer": "vertical_stress", "isotropic": "p",
            "shear": "shear_strain"}
MEASURED = {"triaxial": ("q", "volume_strain", "pore_pressure"), "biaxial": ("q", "volume_strain", "pore_pressure"),
            "oedometer": ("axial_strain", "void_ratio"), "isotropic": ("volume_strain", "void_ratio"),
            "shear": ("shear_stress", "axial_strain", "vertical_stress")}


class WrongTest(ValueError):
    """A test that cannot be meant; the text ends "given ..., takes ..."."""


@dataclass
class Stage:
    """One monotone part of a path. `drive`: for xx, yy, zz, xy how it is driven, "e" by strain or "s" by stress, and by how
    much in all (logarithmic tensor strain, Pa; tension positive), or "free" where sums of stresses that are kept decide it."""
    drive: dict
    rows: int
    duration: float  # s
    ratio: float = 1.0  # last over first stress, for rows that are equal steps of the logarithm of the stress
    sheared: bool = True  # part of the test itself, not of the consolidation
    kept: tuple = ()  # names of sums of stresses that do not change


@dataclass
class Test:
    """A test of the laboratory. Stresses in Pa, strains engineering, both compression positive."""
    kind: str
    name: str
    drained: bool = True
    constant_mean: bool = False  # drained: the mean stress stays, not the lateral stress
    sign: int = 1  # 1 compression, -1 extension
    cell: float = 0.0  # lateral stress at the start of shearing
    vertical: float = 0.0  # axial stress then
    start: float = 0.0  # isotropic stress at which the consolidation starts; 0: the path starts consolidated
    k0_path: bool = False  # the consolidation is confined
    strains: list = field(default_factory=list)  # turning points
    stresses: list = field(default_factory=list)
    rate: float = 1e-5  # 1/s
    duration: float = 86400.0  # s, of a stage that is driven by stress
    rows: int = 100
    void_ratio: float = float("nan")  # at the start of the path
    data: str = ""  # CSV file of what was measured

    def label(self):
        """The group of tests that share a picture."""
        if self.kind in ("triaxial", "biaxial"):
            return f"{self.kind}_{'drained' if self.drained else 'undrained'}"
        return self.kind if self.kind != "shear" or self.drained else "shear_constant_volume"


# ---------------------------------------------------------------------------------------------- the words of --test


def number(key, text, lowest=0.0, open_lowest=True):
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not np.isfinite(value) or value < lowest or open_lowest and value == lowest:
        raise WrongTest(f'{key}: given "{text}", takes a number {"greater than" if open_lowest else "of at least"} {lowest:g}')
    return value


def turning_points(key, text, lowest, highest):
    points = []
    for piece in text.split(":"):
        try:
            points.append(float(piece))
        except ValueError:
            raise WrongTest(f'{key}: given "{text}", takes numbers, as 0.05:0.03:0.15') from None
    if not all(lowest < value < highest for value in points) or any(a == b for a, b in zip(points, points[1:])):
        raise WrongTest(f'{key}: given "{text}", takes numbers between {lowest:g} and {highest:g}, each other than the one before')
    return points


START, COURSE = "vertical k0 from consolidation", "strain amplitude cycles rate duration rows e0 data name"
KEYS = {
    "triaxial": f"cell {START} drainage constant direction {COURSE}",
    "biaxial": f"cell {START} drainage constant direction {COURSE}",
    "oedometer": "vertical k0 stress strain rate duration rows e0 data name",
    "isotropic": "cell stress duration rows e0 data name",
    "shear": f"{START} hold {COURSE}",
}


def words_of(text):
    kind, *pairs = text.split(",")
    if kind not in KINDS:
        raise WrongTest(f'--test: given "{text}", takes a kind first: {", ".join(KINDS)}')
    words = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or not value or key not in KEYS[kind].split():
            raise WrongTest(f'--test: given "{text}", takes KEY=VALUE of {", ".join(KEYS[kind].split())}; "{pair}" is none')
        if key in words:
            raise WrongTest(f'--test: given "{text}", takes each key once; {key} is there twice')
        words[key] = value
    return kind, words


def choice(words, key, values):
    given = words.get(key, values[0])
    if given not in values:
        raise WrongTest(f'{key}: given "{given}", takes {" or ".join(values)}')
    return given


def read_loads(test, words):
    """The stresses at the start of the test proper."""
    upright = test.kind in ("oedometer", "shear")
    k0 = number("k0", words.get("k0", "1"))
    test.k0_path = choice(words, "consolidation", ("isotropic", "k0")) == "k0"
    if "from" in words:
        test.start = number("from", words["from"])
    elif test.k0_path:
        raise WrongTest("consolidation: given \"k0\", takes from=STRESS too, the isotropic stress at which it starts")
    if test.k0_path and "k0" in words:
        raise WrongTest(f'k0: given "{words["k0"]}", takes nothing with consolidation=k0, of which it is a result')
    needed = "vertical" if upright or test.k0_path else "cell"
    if needed not in words:
        raise WrongTest(f"{test.kind}: {needed} is not given, takes {needed}=STRESS in Pa")
    other = "cell" if needed == "vertical" else "vertical"
    if other in words:
        raise WrongTest(f'{other}: given "{words[other]}", takes nothing beside {needed} and k0')
    value = number(needed, words[needed])
    test.vertical = value if needed == "vertical" else value / k0
    test.cell = value if needed == "cell" else value * k0


def read_course(test, words, measured):
    """The turning points of strain or stress."""
    if "stress" in words:
        if "strain" in words:
            raise WrongTest(f'strain: given "{words["strain"]}", takes nothing beside stress')
        test.stresses = turning_points("stress", words["stress"], 0, 1e12)
    elif "amplitude" in words:
        if "strain" in words:
            raise WrongTest(f'strain: given "{words["strain"]}", takes nothing beside amplitude')
        size, cycles = number("amplitude", words["amplitude"]), number("cycles", words.get("cycles", "1"))
        test.strains = [size, -size] * int(cycles) + [size]
    elif "strain" in words:
        test.strains = turning_points("strain", words["strain"], -10, 10)
    elif measured is not None and ABSCISSA[test.kind] in measured:
        reach = np.asarray(measured[ABSCISSA[test.kind]])
        far = reach[np.argmax(np.abs(reach))]
        if test.kind in ("oedometer", "isotropic"):
            test.stresses = [float(far)]
        else:
            test.strains, test.sign = [float(abs(far))], 1 if far > 0 or test.kind == "shear" else -1
    elif test.kind in ("oedometer", "isotropic"):
        raise WrongTest(f"{test.kind}: stress is not given, takes stress=STRESS:STRESS... in Pa")
    else:
        test.strains = [0.2]
    if test.kind in ("triaxial", "biaxial", "oedometer") and any(test.sign * value >= 1 for value in test.strains):
        raise WrongTest("strain: takes engineering strains less than 1 in compression")


def parse_test(text, number_of_test=1):
    """A Test of the words of --test: KIND,KEY=VALUE,..."""
    kind, words = words_of(text)
    test = Test(kind, words.get("name", f"{kind}_{number_of_test}"), data=words.get("data", ""))
    measured = read_measured(test) if test.data else None
    test.drained = choice(words, "drainage", ("drained", "undrained")) == "drained"
    if kind == "shear":
        test.drained = choice(words, "hold", ("stress", "volume")) == "stress"
    test.constant_mean = choice(words, "constant", ("cell", "p")) == "p"
    if "constant" in words and not test.drained:
        raise WrongTest(f'constant: given "{words["constant"]}", takes nothing with drainage=undrained')
    test.sign = 1 if choice(words, "direction", ("compression", "extension")) == "compression" else -1
    test.rate = number("rate", words.get("rate", "1e-5"))
    test.duration = number("duration", words.get("duration", "86400"))
    test.rows = int(number("rows", words.get("rows", "100"), 1, False))
    test.void_ratio = number("e0", words["e0"]) if "e0" in words else float("nan")
    read_loads(test, words)
    read_course(test, words, measured)
    return test


# ---------------------------------------------------------------------------------------------- what was measured


def read_measured(test):
    """{column: array} of the file of a test's data: the abscissa of its kind and at least one of what is measured over it.
    Lines of # and other columns are passed over."""
    try:
        with open(test.data, newline="") as file:
            header, *rows = csv.reader(line for line in file if line.strip() and not line.startswith("#"))
        values = np.array(rows, dtype=float)
    except (OSError, ValueError) as error:
        raise WrongTest(f'data: given "{test.data}", takes a CSV file with a header and rows of numbers ({error})') from None
    table = {name.strip(): values[:, k] for k, name in enumerate(header)} if values.ndim == 2 else {}
    needed, any_of = ABSCISSA[test.kind], MEASURED[test.kind]
    if needed not in table or not any(name in table for name in any_of) or not np.isfinite(values).all():
        raise WrongTest(f'data: given "{test.data}", takes finite numbers in columns {needed} and '
                        f'{" or ".join(any_of)} for {test.kind}; it has {", ".join(table) or "none"}')
    return table


# ---------------------------------------------------------------------------------------------- paths


def logarithmic(strain):
    """A change of logarithmic strain, tension positive, of an engineering strain, compression positive."""
    return np.log1p(-strain)


def consolidation(test):
    """The stage before the test proper, if the path starts at an isotropic stress."""
    if not test.start:
        return []
    vertical = ("s", -(test.vertical - test.start))
    side = ("e", 0.0) if test.k0_path else ("s", -(test.cell - test.start))
    return [Stage({"xx": side, "yy": vertical, "zz": side, "xy": ("e", 0.0)}, test.rows, test.duration, sheared=False)]


def strained_stage(test, change):
    """One stage by the strain of the axis, or by engineering shear strain (twice the tensor's)."""
    drive = {"xx": ("e", 0.0), "yy": ("e", change), "zz": ("e", 0.0), "xy": ("e", 0.0)}
    kept = ()
    if test.constant_mean:
        drive["xx"], kept = ("free", 0.0), (MEAN,)
        if test.kind == "triaxial":
            drive["zz"], kept = ("free", 0.0), (MEAN, EVEN)
    elif test.kind == "triaxial":
        drive["xx"] = drive["zz"] = ("s", 0.0) if test.drained else ("e", -change / 2)
    elif test.kind == "biaxial":
        drive["xx"] = ("s", 0.0) if test.drained else ("e", -change)
    elif test.kind == "shear":
        drive.update(yy=("s", 0.0) if test.drained else ("e", 0.0), xy=("e", change / 2))
    return Stage(drive, test.rows, abs(change) / test.rate, kept=kept)


def stressed_stage(test, first, last):
    """One stage by the axial or the isotropic stress."""
    change = ("s", -(last - first))
    side = change if test.kind == "isotropic" else ("e", 0.0)
    return Stage({"xx": side, "yy": change, "zz": side, "xy": ("e", 0.0)}, test.rows, test.duration, last / first)


def stages_of(test):
    stages, before = consolidation(test), 0.0
    for strain in test.strains:
        place = strain if test.kind == "shear" else logarithmic(test.sign * strain)
        stages.append(strained_stage(test, place - before))
        before = place
    before = test.vertical
    for stress in test.stresses:
        stages.append(stressed_stage(test, before, stress))
        before = stress
    return stages


def shares(stage):
    """Share of a stage's change that is done at the end of each row."""
    n = np.arange(1, stage.rows + 1) / stage.rows
    return n if stage.ratio == 1 else (stage.ratio**n - 1) / (stage.ratio - 1)


def write_path(test, path):
    """Writes the path of a test as `mpm -element_path` reads it; numbers of the stage of each row of the result."""
    driven, stages = ("xx", "yy", "zz", "xy"), stages_of(test)
    sums = sorted({name for stage in stages for name in stage.kept})
    columns = ["dt"] + [f"{kind}{c}" for c in driven for kind in ("de", "ds")] + sums + ["s" + c for c in COMPONENTS]
    side, axis = (test.start, test.start) if test.start else (test.cell, test.vertical)
    rows, stage_of_row = [[""] * (9 + len(sums)) + [-side, -axis, -side, 0, 0, 0]], [0]
    for k, stage in enumerate(stages):
        steps = np.diff(shares(stage), prepend=0.0)
        for step in steps:
            row = [stage.duration / stage.rows]
            for c in driven:
                kind, change = stage.drive[c]
                row += [change * step if kind == "e" else "", change * step if kind == "s" else ""]
            rows.append(row + [0.0 if name in stage.kept else "" for name in sums] + [""] * 6)
            stage_of_row.append(k)
    text = [f"# {test.kind}, made by scripts/element", ",".join(columns)]
    text += [",".join(cell if isinstance(cell, str) else repr(float(cell)) for cell in row) for row in rows]
    path.write_text("\n".join(text) + "\n")
    return np.array(stage_of_row)


# ---------------------------------------------------------------------------------------------- results


def results(test, table, stage_of_row):
    """Values that a laboratory reports of a test: arrays by name, from the start of the test proper, and `stage`, its turning."""
    skipped = len(consolidation(test))
    begin = int(np.searchsorted(stage_of_row, skipped)) - 1 if skipped else 0
    stress = {c: -np.array(table["s" + c]) for c in COMPONENTS}
    change = {c: np.array(table["e" + c]) - table["e" + c][begin] for c in COMPONENTS}
    whole = sum(np.array(table["e" + c]) for c in ("xx", "yy", "zz"))
    p = (stress["xx"] + stress["yy"] + stress["zz"]) / 3
    volume = 1 - np.exp(change["xx"] + change["yy"] + change["zz"])
    held = "yy" if test.kind == "shear" else "xx"
    lost = np.zeros_like(p) if test.drained else stress[held][begin] - stress[held]
    if "specific_volume" in table:
        void_ratio = np.array(table["specific_volume"]) - 1
    else:
        void_ratio = (1 + test.void_ratio) * np.exp(whole) - 1
    found = {"time": np.array(table["time"]), "axial_strain": 1 - np.exp(change["yy"]), "volume_strain": volume,
             "shear_strain": 2 * change["xy"], "q": stress["yy"] - stress["xx"], "p": p, "pore_pressure": lost,
             "void_ratio": void_ratio, "vertical_stress": stress["yy"], "lateral_stress": stress["xx"],
             "shear_stress": -stress["xy"], "stage": stage_of_row - skipped}
    return {name: values[begin:] for name, values in found.items()}


def write_results(path, found):
    names = [name for name in found if name != "stage"]
    lines = [",".join(names)] + [",".join(f"{found[name][k]:.9g}" for name in names) for k in range(len(found["time"]))]
    path.write_text("\n".join(lines) + "\n")


def stage_of_measured(test, x):
    """The stage to which each measured point belongs, by the order of the file: a stage ends where the abscissa is nearest
    to its turning point."""
    points = test.strains or test.stresses
    if len(points) == 1:
        return np.zeros(len(x), dtype=int)
    stage, begin = np.full(len(x), len(points) - 1), 0
    before = 0.0 if test.strains else test.vertical
    for k, point in enumerate(points[:-1]):
        rising, ahead = points[k] > before, x[begin:] * (test.sign if test.strains else 1)
        beyond = points[k + 1]
        turned = np.flatnonzero((ahead < (point + beyond) / 2) if rising else (ahead > (point + beyond) / 2))
        reached = np.flatnonzero((ahead > (before + point) / 2) if rising else (ahead < (before + point) / 2))
        after = turned[turned > reached[0]] if len(reached) else []
        last = begin + (after[0] if len(after) else len(ahead))
        part = x[begin:last] * (test.sign if test.strains else 1)
        end = begin + (int(np.argmax(part) if rising else np.argmin(part)) + 1 if len(part) else 0)
        stage[begin:end], begin, before = k, end, point
    return stage


def at_measured(test, found, measured, name):
    """Values of the model for `name` where it was measured, by the abscissa along each stage; NaN beyond its course."""
    x, stage = measured[ABSCISSA[test.kind]], stage_of_measured(test, measured[ABSCISSA[test.kind]])
    along, values = found[ABSCISSA[test.kind]], np.full(len(x), np.nan)
    for k in np.unique(stage):
        rows = np.flatnonzero(found["stage"] == k)
        if not len(rows):
            continue
        rows = np.concatenate([[max(rows[0] - 1, 0)], rows])
        order = np.argsort(along[rows], kind="stable")
        here = stage == k
        # A point at the very end of a stage belongs to it whichever way the last digit of the model's end goes.
        low, high = along[rows].min(), along[rows].max()
        inside = np.clip(x[here], low, high)
        beyond = np.abs(inside - x[here]) > ROUND_OFF * max(abs(low), abs(high))
        values[here] = np.where(beyond, np.nan, np.interp(inside, along[rows][order], found[name][rows][order]))
    return values
