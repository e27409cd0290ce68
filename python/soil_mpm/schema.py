"""Every option of the program, as `mpm -schema` prints them: the program's own tables, so that they cannot differ from it."""

from __future__ import annotations

import difflib
import functools
import json
import math
import subprocess
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Iterable, Iterator

from soil_mpm.problems import NoProgram, UnknownOption, WrongValue
from soil_mpm.tree import default_program

OWNED = ("NAME_", "STAGE_")  # beginnings of names of the table that stand for a name of a list


@dataclass(frozen=True)
class Condition:
    """Another option whose value, or the last of its list, is one of some words; without words, that is given or is not."""
    option: str
    words: tuple[str, ...]
    given: bool

    def text(self) -> str:
        if self.words:
            return f"-{self.option} is {either(self.words)}"
        return f"-{self.option} is {'given' if self.given else 'not given'}"


@dataclass(frozen=True)
class Option:
    """An option. Its name is that of the table (NAME_su) or, of a deck, with the name of its owner (clay_su).

    kind: number, integer, numbers, text, flag, word or list. unit: SI, "-" for a pure number, empty for words. lowest and highest:
    None where there is no bound; open_lowest and open_highest say whether the bound itself is not taken. choices: words that it
    takes. names_of: the option that lists its values. forms: how numbers are written in 2D and 3D, as ("x,y", "x,y,z"). default: as a
    deck would hold it, or in words; None where there is none. changes: where it may change (restart, restart_change, stage). stage: in which it holds;
    empty: in the whole run."""
    name: str
    group: str
    kind: str
    unit: str
    required: bool
    default: str | None
    meaning: str
    takes: str
    owners: tuple[str, ...] = ()
    lowest: float | None = None
    highest: float | None = None
    open_lowest: bool = False
    open_highest: bool = False
    choices: tuple[str, ...] = ()
    names_of: str = ""
    forms: tuple[str, str] = ("", "")
    where: tuple[Condition, ...] = ()
    changes: tuple[str, ...] = ()
    restrictions: tuple[str, ...] = ()
    stage: str = ""

    @property
    def owned(self) -> bool:
        return self.name.startswith(OWNED)

    @property
    def key(self) -> str:
        """The name without that of its owner."""
        return self.name.partition("_")[2] if self.owned else self.name

    def of(self, owner: str) -> Option:
        """The option of an owner, with its conditions: NAME_su of clay is clay_su."""
        def named(text: str) -> str:
            return f"{owner}_{text.partition('_')[2]}" if text.startswith(OWNED) else text
        where = tuple(Condition(named(each.option), each.words, each.given) for each in self.where)
        return replace(self, name=named(self.name), where=where)

    def value(self, text: str) -> Any:
        """The value that a text of a deck stands for: float, int, bool, tuple or str; the text itself where it is none of these."""
        try:
            if self.kind == "number":
                return float(text)
            if self.kind == "integer":
                return int(text)
            if self.kind == "numbers":
                return tuple(float(word) for word in text.split(","))
        except ValueError:
            return text
        if self.kind == "flag" or set(self.choices) == {"on", "off"}:
            return text != "off" if text in ("on", "off", "") else text
        if self.kind == "list":
            return tuple(text.split(",")) if text else ()
        return text

    def text(self, value: Any, dim: int) -> str:
        """A value as a deck holds it; WrongValue where the option does not take it."""
        text = written(value)
        if any(character in text for character in "#\n\t\r") or '"' in text:
            raise self.wrong(text, "a text without #, quotes, tabulators and line ends", dim)
        if self.kind in ("number", "integer") and text not in self.choices:
            self.check_number(text, text, dim)
        elif self.kind == "numbers" and text not in self.choices:
            words, form = text.split(","), self.forms[dim == 3]
            if len(words) != len(form.split(",")) and not self.short(words):
                raise self.wrong(text, self.takes, dim)
            for word in words:
                self.check_number(word, text, dim)
        elif self.kind == "flag" and text not in ("on", "off", ""):
            raise self.wrong(text, self.takes, dim)
        elif self.kind == "word" and self.choices and text not in self.choices:
            near = difflib.get_close_matches(text, self.choices, 1)
            raise self.wrong(text, self.takes + (f"; the nearest is {near[0]}" if near else ""), dim)
        elif self.kind == "text" and not text:
            raise self.wrong(text, self.takes, dim)
        return text

    def short(self, words: list[str]) -> bool:
        """Numbers of which other options of the deck decide how many there are."""
        return self.name == "rayleigh_frequencies" or (self.name.endswith("_at") and len(words) < 3)

    def check_number(self, word: str, text: str, dim: int) -> None:
        try:
            number = float(word) if self.kind != "integer" else int(word)
        except ValueError:
            raise self.wrong(text, self.takes, dim) from None
        low = self.lowest is None or (number > self.lowest if self.open_lowest else number >= self.lowest)
        high = self.highest is None or (number < self.highest if self.open_highest else number <= self.highest)
        if not (low and high and math.isfinite(number)):
            raise self.wrong(text, self.takes, dim)

    def wrong(self, text: str, takes: str, dim: int) -> WrongValue:
        return WrongValue(f'-{self.name}: given "{text}", takes {takes}')

    def __str__(self) -> str:
        default = "required" if self.required else f"default {self.default if self.default is not None else 'none'}"
        only = f"; only where {' and '.join(each.text() for each in self.where)}" if self.where else ""
        return f"-{self.name}: {self.meaning}. Takes {self.takes}; {default}{only}"


def either(words: Iterable[str]) -> str:
    """ "a, b or c"."""
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last


def written(value: Any) -> str:
    """A value as a deck holds it: numbers by the fewest digits that give the same number, lists with commas, on and off."""
    if isinstance(value, str):
        return value
    if value is True or value is False:
        return "on" if value else "off"
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):  # numpy
        return written(value.tolist())
    if isinstance(value, (int, float)):
        return repr(value) if not (isinstance(value, float) and value.is_integer() and abs(value) < 1e15) else str(int(value))
    if isinstance(value, Iterable):
        return ",".join(written(each) for each in value)
    return str(value)


@dataclass(frozen=True)
class Schema:
    """All options of a program. petsc: options of PETSc that a run passes on. former: present names by former ones,
    of options or of the part after an owner's name."""
    version: str
    options: tuple[Option, ...]
    petsc: tuple[str, ...] = ()
    former: dict[str, str] = field(hash=False, default_factory=dict)

    @staticmethod
    def of_program(program: Path | str | None = None) -> Schema:
        """The schema of a program, by default the one that is run where none is named (tree.default_program)."""
        path = Path(program or default_program())
        try:
            return read_schema(str(path), path.stat().st_mtime_ns)
        except OSError as error:
            raise NoProgram(f"{path}: {error.strerror}; build the program, or set MPM_PROGRAM to it") from None

    @staticmethod
    def of_text(text: str) -> Schema:
        """The schema that a JSON text holds."""
        data = json.loads(text)
        return Schema(data["version"], tuple(option_of(each) for each in data["options"]), tuple(data["petsc"]), dict(data["former"]))

    def present_name(self, name: str) -> str:
        """A name in lower case, without dash, and by its present word."""
        key = name.lstrip("-").lower()
        for former, present in self.former.items():
            if key == former or key.endswith("_" + former):
                return key[:len(key) - len(former)] + present
        return key

    def table(self, names: dict[str, list[str]]) -> dict[str, list[Option]]:
        """{name in lower case: options} of every option that a deck of some names {list: [names]} may give."""
        made: dict[str, list[Option]] = {}
        for option in self.instances(names):
            made.setdefault(option.name.lower(), []).append(option)
        return made

    def find(self, name: str, names: dict[str, list[str]], table: dict[str, list[Option]] | None = None) -> list[Option]:
        """The options of a name, in the deck of some names: several where other options decide which of them it is. UnknownOption
        where there is none. table: that of these names, where it is there already."""
        key = self.present_name(name)
        table = self.table(names) if table is None else table
        found = table.get(key, [])
        if not found:
            for stage in names.get("stages", []):
                if key.startswith(stage.lower() + "_"):
                    found = [replace(option, name=f"{stage}_{option.name}", stage=stage)
                             for option in self.find(key[len(stage) + 1:], names, table) if "stage" in option.changes]
        if not found:
            raise UnknownOption(self.why_unknown(key, names))
        return found

    def instances(self, names: dict[str, list[str]]) -> Iterator[Option]:
        """Every option that a deck of some names may give."""
        for option in self.options:
            if not option.owned:
                yield option
            for owner in option.owners if option.owned else ():
                yield from (option.of(name) for name in names.get(owner, []))

    def why_unknown(self, key: str, names: dict[str, list[str]]) -> str:
        known = dict.fromkeys(option.name for option in self.instances(names))
        near = difflib.get_close_matches(key, known, 1, 0)
        owner = next((option for option in self.options if option.owned and key.endswith("_" + option.key)), None)
        fits = difflib.SequenceMatcher(None, key, near[0]).ratio() if near else 0
        if owner and fits < 0.9:
            name = key[:-len(owner.key) - 1]
            return f"-{key}: no such option: {name} is in none of {either('-' + each for each in self.lists_of(owner.key))}"
        return f"-{key}: no such option" + (f", the nearest is -{near[0]}" if near else "")

    def lists_of(self, key: str) -> list[str]:
        """The options that list the owners of a key."""
        return list(dict.fromkeys(each for option in self.options if option.owned and option.key == key for each in option.owners))


def option_of(data: dict[str, Any]) -> Option:
    """An option of the JSON text."""
    bounds = data.get("range", {})
    form = data.get("form", "")
    return Option(data["name"], data["group"], data["type"], data.get("unit", ""), data["required"], data["default"], data["meaning"],
                  data["takes"], tuple(data.get("owners", ())), bounds.get("lowest"), bounds.get("highest"),
                  bounds.get("open_lowest", False), bounds.get("open_highest", False), tuple(data.get("choices", ())),
                  data.get("names_of", ""), (form, data.get("form_3d", form)),
                  tuple(Condition(each["option"], tuple(each["is"]), each["given"]) for each in data.get("where", ())),
                  tuple(data.get("changes", ())), tuple(data.get("restrictions", ())))


@functools.lru_cache(maxsize=8)
def read_schema(program: str, changed: int) -> Schema:
    """The schema of a program that was changed at a time [ns]."""
    done = subprocess.run([program, "-schema"], capture_output=True, text=True, check=False)
    if done.returncode != 0 or not done.stdout.startswith("{"):
        raise NoProgram(f"{program}: prints no schema (mpm -schema): {(done.stderr or done.stdout).strip()[:200]}")
    return Schema.of_text(done.stdout)
