"""Tables of what scripts/benchmark measured, as Markdown, with the paper's figures beside ours.

The paper: Dong, Wang & Randolph (2015), Computers and Geotechnics 66, Tables 1 to 3: ms a step on an i7-2600 (sequential,
double precision) and on a GTX 780M (node gather).
"""

# particles: (CPU double, GPU single, GPU double), ms a step
PAPER = {
    "footing": {76800: (62, 3.11, 3.77), 115200: (88, 4.14, 4.98), 245760: (187, 8.11, 9.39), 737280: (563, 20.07, 24.91),
                1474560: (1203, 41.32, 50.07), 2949120: (2625, 87.63, 110.16), 5898240: (5578, 180.85, 232.00)},
    "landslide": {69120: (47, 2.31, 3.46), 138240: (110, 4.85, 6.59), 276480: (219, 9.56, 12.32), 552960: (432, 18.86, 24.15),
                  1105920: (922, 39.97, 49.88), 2211840: (1891, 77.72, 99.77), 3317760: (2984, 119.53, 150.24),
                  4423680: (4032, 162.04, 201.38)}}
# Table 2: speed-ups of the GPU in single precision, of the footing's sizes in order; and the names of our functions
SPEEDUPS = {"interpolation, soil to nodes": ("soil particles to nodes", (7.9, 9.1, 11.9, 13.4, 13.0, 12.6, 13.7)),
            "stress update and movement": ("stress update, movement", (76.0, 83.6, 80.7, 80.5, 82.3, 92.9, 85.7)),
            "nodal velocities": ("nodal velocities, contact", (23.5, 17.1, 10.3, 32.8, 50.4, 53.6, 86.9)),
            "overall": (None, (19.9, 21.3, 23.1, 28.1, 29.1, 30.0, 30.8))}
# Functions that are empty where `tile` sums ahead in the stress update of the step before; their time is that of reading a clock.
AHEAD = ("initialise nodal variables", "soil particles to nodes")
MOSAIC_SPEEDUP = 5.4  # at 5,898,240 particles, single precision


class Measured:
    """Runs that were measured, by what they were."""

    def __init__(self, runs):
        self.runs = runs

    def get(self, problem, particles, backend, precision, strategy):
        for each in self.runs:
            if (each["problem"], each["particles"], each["backend"], each["precision"],
                    each["strategy"]) == (problem, particles, backend, precision, strategy):
                return each
        return None

    def us(self, *setting):
        found = self.get(*setting)
        return found["us"] if found else None

    def values(self, name):
        return list(dict.fromkeys(each[name] for each in self.runs))

    def source(self):
        """Machines, date and commit of the runs, in lines."""
        about = {}
        for each in self.runs:
            hardware = each["device"] if each["backend"] == "cuda" else f"{each['machine']}, {each['device']}"
            about.setdefault((each["backend"], hardware), set()).add(
                f"{each['date']}, commit {each['commit']}, median of {len(each['all_us'])}")
        return "\n".join(f"- `{backend}`: {hardware}; {'; '.join(sorted(when))}" for (backend, hardware), when in about.items())


def number(value):
    """Four digits, without exponent."""
    return f"{value:,.0f}" if value >= 1000 else f"{value:.4g}"


def digits(value):
    """Three digits, without exponent."""
    return f"{float(f'{value:.3g}'):g}"


def ms(us):
    return number(us / 1e3) if us is not None else "-"


def ratio(us, other):
    return digits(us / other) if us is not None and other else "-"


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def runtimes(measured, problem):
    """Table 1 or 3: ms a step."""
    rows = []
    for particles, (cpu, single, double) in PAPER[problem].items():
        def ours(backend, precision, strategy):
            return ms(measured.us(problem, particles, backend, precision, strategy))

        best = measured.us(problem, particles, "cuda", "single", "auto")
        rows.append([f"{particles:,}", f"{cpu} / {single:.2f} / {double:.2f}", ours("serial", "double", "auto"),
                     f"{ours('cuda', 'single', 'gather')} / {ours('cuda', 'double', 'gather')}",
                     f"{ours('cuda', 'single', 'auto')} / {ours('cuda', 'double', 'auto')}",
                     digits(particles / best / 1e3) if best else "-",
                     ratio(measured.us(problem, particles, "serial", "double", "auto"), best)])
    return table(["particles", "paper: CPU / GPU single / double", "our CPU", "our GPU, gather: single / double",
                  "our GPU, default: single / double", "G updates/s, single", "speed-up, single"], rows)


def part(run, function):
    """us of a function in a step, of the step without one; None where a launch of another function does its work."""
    if not run or not function:
        return run and run["us"]
    if run["ran"] == "tile" and run["backend"] != "serial" and function in AHEAD:
        return None
    return run["functions"].get(function) or None


def speedups(measured):
    """Table 2: the CPU's time over the GPU's in single precision, by function, for the default strategy and for gather."""
    rows = []
    for name, (function, paper) in SPEEDUPS.items():
        for strategy, label in ((None, "paper"), ("gather", "ours, gather"), ("auto", "ours, default")):
            cells = []
            for k, particles in enumerate(PAPER["footing"]):
                cpu, gpu = (measured.get("footing", particles, *each) for each in
                            (("serial", "double", "auto"), ("cuda", "single", strategy)))
                if strategy is None:
                    cells.append(paper[k])
                else:
                    parts = [part(each, function) for each in (cpu, gpu)]
                    cells.append("-" if None in parts else ratio(*parts))
            rows.append([name, label, *cells])
    return table(["function", "", *(f"{particles:,}" for particles in PAPER["footing"])], rows)


def strategies(measured):
    """One table of all strategies: us a step (M particle updates/s), a column each back end and precision."""
    columns = sorted({(each["backend"], each["precision"]) for each in measured.runs},
                     key=lambda each: (each[0], each[1] == "double"))
    rows = []
    for particles in sorted(measured.values("particles")):
        for strategy in measured.values("strategy"):
            found = [measured.us("footing", particles, *column, strategy) for column in columns]
            if any(us is not None for us in found):
                rows.append([f"{particles:,}", f"`{strategy}`",
                             *(f"{number(us)} ({digits(particles / us)})" if us is not None else "-" for us in found)])
    return table(["particles", "strategy", *(f"{backend}, {precision}" for backend, precision in columns)], rows)
