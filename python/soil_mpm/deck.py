"""A deck: the options of a run, as Python values that are checked as they are set."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any, Iterator, Mapping, TYPE_CHECKING

from soil_mpm import launch, shipped
from soil_mpm.deck_text import DeckText, Given, table_of, table_options
from soil_mpm.problems import UnknownOption, WrongDeck
from soil_mpm.schema import Condition, Option, Schema

if TYPE_CHECKING:
    from soil_mpm.results import Run

LISTS = ("materials", "bodies", "rigid_bodies", "loads", "water_regions", "joints", "probes", "contact_pairs", "stages")
MOST_FAULTS = 20  # lines of a report


class Deck:
    """The options of a run. An option is an attribute and an item: deck.mesh_spacing = 0.05, deck["clay_su"] = 3000; SI units, those
    of docs/options.md. A value that the option does not take, and a name that is none, raise at once. An option that is not given
    reads as its default.

        deck = Deck.read("inputs/footing.opts")
        deck = Deck(dim=2, mesh_lower=(0, 0), mesh_upper=(4, 4), mesh_spacing=0.1, time_end=1)

    The options of a material, a body and so on can be set once its name is in the list, materials before clay_su, and go with the name.
    In the arguments of Deck and of update the order does not matter. Names that begin with an underscore are not options.
    """

    def __init__(self, options: Mapping[str, Any] | None = None, *, program: Path | str | None = None, **more: Any):
        object.__setattr__(self, "_schema", Schema.of_program(program))
        object.__setattr__(self, "_program", program)
        object.__setattr__(self, "_text", DeckText())
        object.__setattr__(self, "_path", None)
        object.__setattr__(self, "_known", {})
        self.update({**(options or {}), **more})

    @staticmethod
    def read(path: Path | str, program: Path | str | None = None) -> Deck:
        """The deck of a file (.opts), or of the name of a deck that comes with the program (soil_mpm.shipped) where there is no such
        file. Comments stay where they are when it is written again."""
        deck = Deck(program=program)
        named = None if Path(path).is_file() else shipped.path_of(str(path))
        if named is None and shipped.may_be_name(str(path)) and not Path(path).exists():
            raise shipped.no_deck(str(path))
        object.__setattr__(deck, "_text", DeckText.of(shipped.text_of(named), str(named)) if named else DeckText.read(path))
        path = named or path
        deck._known.clear()
        object.__setattr__(deck, "_path", Path(path))
        return deck

    def write(self, path: Path | str) -> Path:
        """Writes the deck to a file, and returns its path."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(str(self), encoding="utf-8")
        return path

    def copy(self, **changes: Any) -> Deck:
        """Another deck with the same options, and some changes."""
        other = object.__new__(Deck)
        other.__dict__.update(self.__dict__, _text=copy.deepcopy(self._text), _known={})
        other.update(changes)
        return other

    def __copy__(self) -> Deck:
        return self.copy()

    # ------------------------------------------------------------------------------------------ options

    @property
    def schema(self) -> Schema:
        return self._schema

    def given(self) -> dict[str, str]:
        """{option: text} of all that is given, by names of today in lower case; the last of an option given twice. Cells of
        -rigid_bodies_file count where no line gives the option."""
        if "given" not in self._known:
            own = {self._schema.present_name(each.name): each.text or "" for each in self._text.options()}
            self._known["given"] = {**table_options(self._text), **own}
        return dict(self._known["given"])

    def names(self) -> dict[str, list[str]]:
        """{list: names}: what materials, bodies and so on there are. Parts of rigid bodies and rows of -rigid_bodies_file count as rigid
        bodies, and the pair a:b has the name a_b."""
        if "names" not in self._known:
            self._known["names"] = self.listed_names()
        return self._known["names"]

    def listed_names(self) -> dict[str, list[str]]:
        given = self.given()
        names = {each: [word.strip().replace(":", "_") for word in given.get(each, "").split(",") if word.strip()] for each in LISTS}
        if names["rigid_bodies"] == ["none"]:
            names["rigid_bodies"] = []
        names["rigid_bodies"] += [name for name in table_of(given.get("rigid_bodies_file", "")) if name not in names["rigid_bodies"]]
        for rigid in list(names["rigid_bodies"]):
            names["rigid_bodies"] += [word for word in given.get(f"{rigid.lower()}_parts", "").split(",") if word]
        return names

    def option(self, name: str) -> Option:
        """What an option is: unit, range, default, meaning. Where several have the name, the one that has a place in this deck."""
        found = self.found(name)
        fitting = [option for option in found if self.unmet(option) is None]
        return (fitting or found)[0]

    def found(self, name: str) -> list[Option]:
        """The options of a name."""
        if "table" not in self._known:
            self._known["table"] = self._schema.table(self.names())
        return self._schema.find(name, self.names(), self._known["table"])

    def why_no_place(self, name: str) -> str:
        """Where an option that has no place in this deck would have one, in words; empty where it has a place."""
        found = self.found(name)
        unmet = [self.unmet(option) for option in found]
        if None in unmet:
            return ""
        by_option: dict[tuple[str, bool], list[str]] = {}
        for each in filter(None, unmet):
            by_option.setdefault((each.option, each.given), []).extend(each.words)
        return " or ".join(Condition(option, tuple(dict.fromkeys(words)), given).text() for (option, given), words in by_option.items())

    def unmet(self, option: Option) -> Condition | None:
        """The first condition of an option that the deck does not fulfil; None where it has a place."""
        stages = [option.stage] if option.stage else ["", *self.names()["stages"]]
        unmet = [next((each for each in option.where if self.holds(each, stage) is False), None) for stage in stages]
        return None if None in unmet else unmet[0]

    def holds(self, condition: Condition, stage: str = "") -> bool | None:
        """Whether a condition holds, in a stage; None where that depends on a default which others decide."""
        given = self._known.get("given") or self.given()
        key = condition.option.lower()
        if f"{stage.lower()}_{key}" in given:
            key = f"{stage.lower()}_{key}"
        if not condition.words:
            return (key in given and given[key] != "none") == condition.given
        if key in given:
            return given[key].split(",")[-1] in condition.words
        try:
            option = self.found(key)[0]
        except UnknownOption:
            return None
        return option.default in condition.words if option.default in option.choices else None

    def __getitem__(self, name: str) -> Any:
        option, given = self.option(name), self.given()
        text = given.get(self._schema.present_name(name))
        if text is None:
            text = option.default
        return None if text is None else option.value(text)

    def __setitem__(self, name: str, value: Any) -> None:
        if value is None:
            self.__delitem__(name)
            return
        key, option = self._schema.present_name(name), self.option(name)
        text = option.text(value, self.dim)
        before = self.names()
        own = self._text.own(key) or self._text.own(name.lower().lstrip("-"))
        if own is not None:
            own.name, own.text = key if own.name.lower() != key else own.name, text
        self._known.clear()
        if own is None or self.given().get(key) != text:  # a deck that is included further on may give another value
            self._text.append(Given(key, text or None))
        self._known.clear()
        if key in LISTS:
            self.forget(before)

    def forget(self, before: dict[str, list[str]]) -> None:
        """Takes out the options of names that were in a list before and are in none any more."""
        now = {name.lower() for names in self.names().values() for name in names}
        gone = {name.lower() for names in before.values() for name in names} - now
        for key in [key for key in self.given() if any(key.startswith(name + "_") for name in gone)]:
            try:
                self.found(key)
            except UnknownOption:
                self._text.remove(key)
        self._known.clear()

    def __delitem__(self, name: str) -> None:
        key = self._schema.present_name(name)
        self._text.remove(key)
        self._known.clear()
        if key in self.given():
            raise WrongDeck(f"-{key}: an included deck gives it; give it another value")

    def __contains__(self, name: str) -> bool:
        return self._schema.present_name(name) in self.given()

    def __iter__(self) -> Iterator[str]:
        return iter(self.given())

    def __len__(self) -> int:
        return len(self.given())

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return self[name]

    def __setattr__(self, name: str, value: Any) -> None:
        if name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            self[name] = value

    def __delattr__(self, name: str) -> None:
        del self[name]

    def __dir__(self) -> list[str]:
        options = {option.name for option in self._schema.instances(self.names()) if self.unmet(option) is None}
        return sorted({*object.__dir__(self), *options})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Deck) and self.given() == other.given()

    def __str__(self) -> str:
        return str(self._text)

    def __repr__(self) -> str:
        where = f" of {self._path}" if self._path else ""
        return f"<Deck{where}: {len(self)} options>"

    def update(self, options: Mapping[str, Any] | None = None, **more: Any) -> None:
        """Sets options, lists of names first, then those on whose value others depend."""
        wanted = {self._schema.present_name(name): value for name, value in {**(options or {}), **more}.items()}
        first = ("dim", *LISTS, "rigid_bodies_file")
        def rank(name: str) -> tuple[int, int]:
            place = first.index(name) if name in first else len(first)
            return place, 0 if name.endswith(("_parts", "_model", "_shape", "_motion", "_kind")) else 1
        for name in sorted(wanted, key=rank):
            self[name] = wanted[name]

    @property
    def dim(self) -> int:
        """2 or 3."""
        return 3 if self.given().get("dim") == "3" else 2

    @dim.setter
    def dim(self, value: int) -> None:
        self["dim"] = value

    # ------------------------------------------------------------------------------------------ checks and runs

    def faults(self) -> list[str]:
        """Mistakes that the options' own table shows, without the program: names that are none, values that are not taken, options that
        have no place, and those that are missing. The program checks more: check()."""
        lines = []
        for name, text in self.given().items():
            try:
                option = self.option(name)
                option.text(text, self.dim)
                lines += self.strangers(option, name, text)
                where = self.why_no_place(name)
                if where:
                    lines.append(f'-{name}: given "{text}", has a place only where {where}')
            except ValueError as error:
                lines.append(str(error))
            except UnknownOption as error:
                if name not in self._schema.petsc:
                    lines.append(str(error))
        given = self.given()
        stages = ["", *(stage.lower() + "_" for stage in self.names()["stages"])]
        for option in self._schema.instances(self.names()):
            missing = option.required and "element_path" not in given and not any(stage + option.name.lower() in given for stage in stages)
            if missing and all(self.holds(each) for each in option.where):
                lines.append(f"-{option.name}: not given, takes {option.takes}")
        return list(dict.fromkeys(lines))[:MOST_FAULTS]

    def strangers(self, option: Option, name: str, text: str) -> list[str]:
        """A line where a value that is to be a name of a list is none."""
        listed = [word.lower() for word in self.names().get(option.names_of, [])]
        if not option.names_of or all(word.lower() in listed for word in text.split(",")):
            return []
        return [f'-{name}: given "{text}", takes names of -{option.names_of}: {", ".join(listed)}']

    def check(self) -> list[str]:
        """All mistakes of the deck, a line each; empty where the program takes it. What the table shows comes first; where it shows
        nothing, the program itself checks the deck, its files and its geometry, and writes nothing."""
        return self.faults() or launch.check(self)

    def dry_run(self) -> str:
        """What the run would take: particles, memory, time step, steps, output and about how long, as the program prints it."""
        return launch.dry_run(self)

    def run(self, out: Path | str | None = None, **how: Any) -> Run:
        """Runs the deck and returns its results: see launch.run for ranks, threads, progress and the rest."""
        return launch.run(self, out, **how)

    def submit(self, script: Path | str, out: Path | str | None = None, **how: Any) -> launch.Job:
        """Hands the deck to Slurm: see launch.submit."""
        return launch.submit(self, script, out, **how)
