"""Values of options: which the table of docs/options.md says are taken, their extremes, and such that are not.

The table is read, so that a new option is drawn as soon as its line of help is there.
"""
import pathlib
import re

OPTIONS_PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "options.md"
EXTREMES = ["0", "-0", "1e-308", "5e-324", "1e-30", "1e-12", "1e-6", "1", "1e6", "1e12", "1e30", "1e154", "1e300", "1.7e308"]
NO_NUMBERS = ["", "nan", "inf", "-inf", "1e309", "-1e400", "0x10", "1e", "1,", ",", "1 2", "one", "1.0.0", "+-1", "1e5000", "--",
              "1;2", "９", "\t", "1e-400", "999999999999999999999", "-1", "-1e300", "%s%n", "$(id)", "'", '"']
ODD_NAMES = ["nodes", "mesh", "time", "output", "SOIL", "soil,soil", "soil,,", ",", "a b", "1a", "x" * 300, "é", "-", "soil-1",
             "none", "all", "soil,boulder,soil", "p2g", "dim", "NAME"]
ODD_TEXTS = ["", " ", "/", ".", "..", "/dev/null", "/dev/full", "/dev/zero", "/proc/self/mem", "missing/x", "a\nb", "a\tb",
             "x" * 300, "x/" * 150, "~", "$HOME", "*", "é", "\udcff", "latest", "deck.opts", "-dim", "con", "out/../out", "out//x/"]


def read_table():
    """{option without its dash, with NAME in it where it belongs to one: (section, what it takes)}."""
    table, section = {}, ""
    for line in OPTIONS_PAGE.read_text().splitlines():
        if line.startswith("## "):
            section = line[3:]
        elif line.startswith("| `-"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if len(cells) > 3:  # the table of former names has fewer
                table[cells[0].strip("`-")] = (section, cells[2])
    return table


def bounds_of(takes):
    """Least and most that a number may be, as the table says it; None where there is none."""
    number = r"(-?[0-9][0-9.e+-]*)"
    within = re.search(f"from {number} to {number}", takes)
    if within:
        return float(within[1]), float(within[2])
    least = re.search(f"(?:greater than|of) {number}(?: or more)?", takes)
    most = re.search(f"(?:at most|less than) {number}", takes)
    return (float(least[1]) if least else None), (float(most[1]) if most else None)


def a_number(random, takes, whole=False):
    """A number that is taken: mild, at a bound, just inside of it, or as large or small as numbers are."""
    least, most = bounds_of(takes)
    low, high = -1.8e308 if least is None else least, 1.8e308 if most is None else most
    if whole:
        top = 20 if most is None else int(most)
        bounds = [str(int(least or 0)), str(top)] if most is not None else ["1", "3", "1000000", "2147483647"]
        return random.choice([str(random.randint(int(least or 0), max(top, int(least or 0)))) for _ in range(6)] + bounds)
    choices = [f"{10 ** random.uniform(-3, 3):.6g}" for _ in range(3)] + EXTREMES
    for bound, inward in ((least, 1), (most, -1)):
        if bound is not None:
            choices += [f"{bound + inward * step * (abs(bound) or 1):.17g}" for step in (0, 0, 0, 1e-15, 1e-9)]
    if least is not None and most is not None:
        choices += [f"{random.uniform(least, most):.17g}" for _ in range(6)]
    closed = "greater than" not in takes
    taken = [text for text in choices if low < float(text) <= high or (closed and float(text) == low)]
    return random.choice(taken or choices)


def numbers(random, count, takes):
    if random.random() < 0.5:
        return ",".join(f"{random.uniform(-10, 10):.6g}" for _ in range(count))
    return ",".join(random.choice(["", "-"]) + a_number(random, takes).strip("-") for _ in range(count))


def a_polygon(random):
    """Vertices that may cross, touch, coincide, lie on a line or be very many."""
    kind = random.randrange(6)
    count = random.choice([3, 4, 5, 8, 30, 300]) if kind else 3000
    points = [(random.uniform(0, 8), random.uniform(0, 6)) for _ in range(count)]
    if kind == 1:
        points = [(x, 1.0) for x, _ in points]
    elif kind == 2:
        points += points[:2]
    elif kind == 3:
        points = [(4 + 1e-9 * x, 3 + 1e-9 * y) for x, y in points]
    elif kind == 4:
        points = [(round(x), round(y)) for x, y in points]
    return ",".join(f"{x:.9g},{y:.9g}" for x, y in points)


def wrong_value(random):
    return random.choice(NO_NUMBERS + ODD_NAMES + ODD_TEXTS)


def words_of(takes):
    """The words of "a, b or c", empty where it is no such list."""
    return re.split(r", | or ", takes) if re.fullmatch(r"[a-z_]+(, [a-z_]+)* or ([a-z_]+|no value)", takes) else []


def value_of(random, takes, dim, names):
    """A value for what an option takes. `names`: {"materials": [...], "rigid_bodies": [...]} of the deck."""
    if words_of(takes):
        return random.choice(words_of(takes)).replace("no value", "")
    vector = re.match(r"([2346]) numbers", takes)
    if vector:
        in_space = re.search(r"\(([2346]) in 3D", takes)
        count = int((in_space if in_space and dim == 3 else vector)[1])
        return numbers(random, count, takes)
    if takes.startswith("x0,y0"):
        return a_polygon(random)
    if takes.startswith("names of fields"):
        fields = takes.partition(": ")[2].split(", ")
        return ",".join(random.sample(fields, random.randint(1, len(fields))))
    if "of -materials" in takes or "of -rigid_bodies" in takes:
        known = names["rigid_bodies" if "rigid_bodies" in takes else "materials"] or ["none"]
        return random.choice(known)
    if takes.startswith("names"):
        return random.choice(ODD_NAMES)
    if takes.startswith("a text"):
        return random.choice(ODD_TEXTS)
    return a_number(random, takes, "whole" in takes)
