"""How far an answer of a deck depends on its mesh: three meshes, the observed order, an error bar, balances, and a verdict.

The bar follows Roache's grid convergence index (Roache 1994, J. Fluids Eng. 116, 405) with the factors of safety of Oberkampf & Roy
(2010, Verification and Validation in Scientific Computing, sec. 8.6.3). No order above one or below a half is relied on, and the
ripple of the history is added. The bar is of the mesh and of the time step that follows it: the law, the size of the domain and the
speed of loading are not refined.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from soil_mpm import launch
from soil_mpm.answer import Answer
from soil_mpm.closure import balances
from soil_mpm.problems import NoSuchResult, RunFailed, WrongDeck
from soil_mpm.results import Run

if TYPE_CHECKING:
    from soil_mpm.deck import Deck

FACTORS = (1, 2, 4)
SAFETY, DOUBT = 1.25, 3.0     # factors of safety: where the observed order is as expected, and elsewhere
EXPECTED, NEAR = (1, 2), 0.1  # orders, and how near to one of them the observed order is to be
FLOOR = 1e-3           # of the answer: what no mesh shows, as finite displacements, the time step, and vibrations that are left
LEAST, MOST = 0.5, 1.0 # orders that are relied on
MOST_GAP = {"mass": 1e-6, "momentum": 0.1, "energy": 0.1}
TOLERANCE = 0.05
CONVERGED, NOT_CONVERGED, CANNOT_SAY = "converged", "not converged", "cannot say"


@dataclass
class Certificate:
    """answer: as text. spacings [m], values: of the three meshes, the finest first. ripple: of the finest. order: observed, None where the
    values do not go one way. extrapolated: to spacing 0, None likewise and below an order of a half. bar: of the value of the finest
    mesh, None where a run has no value.
    balances: {mass, momentum, energy} of the finest run. verdict, why: in words."""
    answer: str
    spacings: list[float]
    values: list[float]
    ripple: float
    order: float | None
    extrapolated: float | None
    bar: float | None
    balances: dict[str, Any]
    verdict: str
    why: str
    notes: list[str] = field(default_factory=list)

    @property
    def value(self) -> float:
        return self.values[0]

    def holds(self, exact: float) -> bool:
        """Whether a value is within the bar."""
        return self.bar is not None and abs(exact - self.value) <= self.bar

    def __str__(self) -> str:
        lines = [self.answer, *(f"  spacing {h:.6g} m: {value:.6g}" for h, value in zip(self.spacings, self.values))]
        order = "none: the values do not go one way" if self.order is None else f"{self.order:.2f}"
        lines.append(f"  observed order {order}; ripple of the history {self.ripple:.2g}")
        if self.extrapolated is not None:
            lines.append(f"  extrapolated to spacing 0: {self.extrapolated:.6g}")
        lines.append(f"  answer {self.value:.6g} " + ("without a bar" if self.bar is None else f"+- {self.bar:.2g}"))
        told = [f"{name} {gap:.2g}" if isinstance(gap, float) else f"{name}: {gap}" for name, gap in self.balances.items()]
        lines.append("  missing in the balances: " + ", ".join(told))
        lines += [f"  note: {note}" for note in self.notes]
        return "\n".join([*lines, f"  {self.verdict}: {self.why}"])


# ---------------------------------------------------------------------------------------------- three meshes


def why_not(deck: Deck) -> str:
    """Why the mesh of a deck cannot be refined by its spacing alone; empty where it can."""
    given = deck.given()
    if "element_path" in given:
        return "-element_path: a single point has no mesh"
    if "restart" in given:
        return "-restart: a run goes on with the mesh of its checkpoint"
    if not isinstance(deck.mesh_spacing, float):
        return "-mesh_spacing: not given"
    for body in deck.names()["bodies"]:
        if given.get(f"{body.lower()}_shape") == "particles":
            return f"-{body}_shape: particles of a file keep their size on another mesh; give the body a shape"
    for material in deck.names()["materials"]:
        name = material.lower()
        softens = given.get(f"{name}_model") == "softening_clay" and float(given.get(f"{name}_remoulded_ratio", 1)) < 1
        if softens and given.get(f"{name}_xi95_cell", "none") == "none":
            return f"-{material}_xi95_cell: not given: a clay that softens has no limit as cells become smaller, without it"
    return ""


def fitted(deck: Deck, coarse: float) -> dict[str, tuple[float, ...]]:
    """Corners of a mesh of whole cells of the coarse spacing [m]: as they are, or moved outwards at free sides. WrongDeck where a side
    that is not free would move."""
    corners = {end: list(deck[f"mesh_{end}"]) for end in ("lower", "upper")}
    for k, axis in enumerate("xyz"[:deck.dim]):
        cells = (corners["upper"][k] - corners["lower"][k]) / coarse
        if abs(cells - round(cells)) < 1e-6:
            continue
        missing = math.ceil(cells) * coarse - (corners["upper"][k] - corners["lower"][k])
        for end, sign in (("upper", 1), ("lower", -1)):
            if deck[f"mesh_{axis}{'max' if end == 'upper' else 'min'}"] == "free":
                corners[end][k] = round(corners[end][k] + sign * missing, 12)
                break
        else:
            raise WrongDeck(f"-mesh_spacing: the mesh has {cells:.6g} cells of {coarse:g} m along {axis}, and no free side there that may "
                            f"move; takes an extent of whole cells of four times the spacing")
    return {f"mesh_{end}": tuple(place) for end, place in corners.items()}


def meshes(deck: Deck) -> list[Deck]:
    """The deck on its own mesh, and on those of two and four times the spacing; what would follow the spacing by default is fixed."""
    why = why_not(deck)
    if why:
        raise WrongDeck(why)
    fine, made = deck.mesh_spacing, []
    common: dict[str, Any] = {**fitted(deck, FACTORS[-1] * fine)}
    for probe in deck.names()["probes"]:
        if deck[f"{probe}_kind"] == "gauge" and f"{probe}_width" not in deck:
            common[f"{probe}_width"] = fine
    if "device_memory_limit" not in deck and "output_energy" not in deck:
        common["output_energy"] = True
    for factor in FACTORS:
        coarser = deck.copy(**common, mesh_spacing=factor * fine)
        coarser.output_frames = False
        for name in ("output_fields", "output_compression", "output_nodes"):
            coarser[name] = None
        made.append(coarser)
    return made


def run_of(deck: Deck, folder: Path, **how: Any) -> Run:
    """The run of a deck in a folder, where that does not hold it already."""
    path = folder.parent / f"{folder.name}.opts"
    if not (launch.is_finished(folder) and path.exists() and path.read_text(encoding="utf-8") == str(deck)):
        deck.write(path)
        launch.run(deck, folder, progress=False, **how)
    return Run(folder)


# ---------------------------------------------------------------------------------------------- what they say


def bar_of(values: list[float], ripple: float) -> tuple[float | None, float | None, float | None]:
    """Observed order, value extrapolated to spacing 0, and bar of the first of three values on meshes of 1, 2 and 4 times a spacing."""
    near, far = values[1] - values[0], values[2] - values[1]
    most, rounding = max(abs(near), abs(far)), 1e-12 * max(map(abs, values))
    if most <= rounding:
        return None, values[0], most + 2 * ripple
    if near * far <= 0 or abs(near) <= rounding:  # the values do not go one way
        return None, None, 1.5 * most + 2 * ripple
    order = math.log2(abs(far) / abs(near))
    relied, safety = min(max(order, LEAST), MOST), SAFETY if any(abs(order / each - 1) <= NEAR for each in EXPECTED) else DOUBT
    extrapolated = values[0] - near / (2 ** min(order, 2.0) - 1) if order >= LEAST else None
    size = max(abs(near), abs(far) / 4)  # an order above two is chance
    return order, extrapolated, safety * size / (2 ** relied - 1) + 2 * ripple


def judge(order: float | None, values: list[float], bar: float | None, size: float, gaps: dict[str, Any], tolerance: float) -> tuple[str, str]:
    """The verdict, and why. size: what the bar is compared with."""
    for name, most in MOST_GAP.items():
        if isinstance(gaps.get(name), float) and gaps[name] > most:
            return CANNOT_SAY, f"{gaps[name]:.2g} of the {name} is missing, more than {most:g}: the run itself is not sound"
    if bar is None:
        return CANNOT_SAY, "there are no values to compare"
    share = bar / size if size > 0 else 0.0 if bar == 0 else math.inf
    if share <= tolerance:
        return CONVERGED, f"the bar is {share:.2%} of the answer, at most {tolerance:.2%}"
    if order is None:
        return CANNOT_SAY, f"the values do not go one way, and the bar is {share:.2%} of the answer, more than {tolerance:.2%}; takes a finer mesh"
    slow = "" if order >= LEAST else ("; the values differ more and more, or hardly less, as the cells become smaller: an order of "
                                      f"{LEAST:g} is assumed")
    return NOT_CONVERGED, f"the bar is {share:.2%} of the answer, more than {tolerance:.2%}{slow}; takes a finer mesh"


def masses_differ(runs: list[Run]) -> str:
    """A note where the meshes represent bodies of different masses."""
    for body in runs[0].words("bodies"):
        first = [run[f"{body}_mass"][0] for run in runs if f"{body}_mass" in run.history]
        if first and max(first) > 0 and (max(first) - min(first)) / max(first) > 1e-3:
            return (f"{body} has {', '.join(f'{mass:.6g}' for mass in first)} kg on the three meshes: its shape does not end on their cells, "
                    "which counts as an error of the mesh")
    return ""


def certify(deck: Deck, answer: Answer | str, out: Path | str | None = None, *, tolerance: float = TOLERANCE, **how: Any) -> Certificate:
    """Runs a deck on its mesh and on those of two and four times the spacing, and judges an answer ("plate_force_y at plate_y=-0.05").
    WrongDeck where the deck has no such meshes, NoSuchResult where the history has no such column. out: folder of the runs, by default
    out/certify and the deck's name; it gets certificate.json. tolerance: largest bar over the answer that counts as converged. how: of
    launch.run."""
    answer = Answer.of(answer) if isinstance(answer, str) else answer
    decks = meshes(deck)
    folder = Path(out) if out is not None else Path("out/certify") / launch.output_folder(deck, None).name
    for each in decks:
        faults = each.check()
        if faults:
            raise WrongDeck("\n".join(f"on cells of {each.mesh_spacing:g} m: {line}" for line in faults))
    runs: list[Run] = []
    try:
        for factor, each in reversed(list(zip(FACTORS, decks))):  # the coarsest first: what is wrong shows soon
            runs.insert(0, run_of(each, folder / f"cells_{factor}h", **how))
            answer.curve(runs[0])
    except RunFailed as failed:
        raise RunFailed(f"a run of the certificate failed, so there is none: {failed}", failed.status) from None
    found = judged(answer, runs, tolerance)
    told = {**asdict(found), "values": [None if math.isnan(value) else value for value in found.values],
            "ripple": None if math.isnan(found.ripple) else found.ripple}
    (folder / "certificate.json").write_text(json.dumps(told, indent=1) + "\n")
    return found


def judged(answer: Answer, runs: list[Run], tolerance: float) -> Certificate:
    """The certificate of three runs, the finest first."""
    spacings, gaps = [run.number("mesh_spacing") for run in runs], balances(runs[0])
    notes = list(filter(None, [masses_differ(runs)]))
    if "time_step" in runs[0].options:
        notes.append("-time_step is the same on all meshes, so the bar has nothing of the time step")
    try:
        pairs = [answer.value(run) for run in runs]
    except NoSuchResult as missing:
        return Certificate(str(answer), spacings, [math.nan] * 3, math.nan, None, None, None, gaps, CANNOT_SAY, str(missing), notes)
    values, ripple = [value for value, _ in pairs], pairs[0][1]
    order, extrapolated, bar = bar_of(values, ripple)
    size = max(map(abs, values)) if abs(values[0]) > 1e-3 * abs(runs[0][answer.column]).max() else float(abs(runs[0][answer.column]).max())
    bar = None if bar is None else max(bar, FLOOR * abs(values[0]))
    verdict, why = judge(order, values, bar, size, gaps, tolerance)
    return Certificate(str(answer), spacings, values, ripple, order, extrapolated, bar, gaps, verdict, why, notes)
