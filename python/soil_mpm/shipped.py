"""Decks that come with the program, by their names: footing_coarse is inputs/footing_coarse.opts."""

from __future__ import annotations

import difflib
import re
import shutil
from pathlib import Path

from soil_mpm.problems import WrongDeck
from soil_mpm.tree import decks_folder

PLACE = re.compile(r"(?<=[\s,])inputs/([\w./-]+)")  # of a file of the folder, as a deck names it


def names() -> list[str]:
    """Names of the decks, sorted."""
    return sorted(path.stem for path in decks_folder().glob("*.opts"))


def may_be_name(word: str) -> bool:
    """Whether a word could be the name of a deck, and not a path."""
    return re.fullmatch(r"[\w-]+", word) is not None


def path_of(name: str) -> Path | None:
    """The file of a deck that is named so; None where there is none."""
    if not may_be_name(name):
        return None
    path = decks_folder() / f"{name}.opts"
    return path if path.is_file() else None


def no_deck(name: str) -> WrongDeck:
    """The fault of a word that is neither a file nor the name of a deck; it has the nearest name."""
    near = difflib.get_close_matches(name, names(), 1)
    return WrongDeck(f"{name}: no deck of this name comes with the program" + (f", the nearest is {near[0]}" if near else "")
                     + "; soil-mpm decks lists them")


def title(name: str) -> str:
    """The first sentence of a deck's comments."""
    words = []
    for line in (decks_folder() / f"{name}.opts").read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        words.append(line.strip("# "))
    return re.split(r"(?<=[^.][.:;]) ", " ".join(words), maxsplit=1)[0].rstrip(".:;")


def text_of(path: Path) -> str:
    """The text of a deck of the folder, with whole paths of the files that it names there."""
    folder = decks_folder()

    def whole(found: re.Match[str]) -> str:
        path = str(folder / found[1])
        return found[0] if not (folder / found[1]).is_file() else f'"{path}"' if re.search(r"\s", path) else path
    lines = []
    for line in path.read_text(encoding="utf-8").splitlines(keepends=True):
        body, mark, comment = line.partition("#")
        lines.append(PLACE.sub(whole, body) + mark + comment)
    return "".join(lines)


def files_of(name: str) -> list[Path]:
    """A deck, the decks that it includes, and the files of the folder that they name."""
    folder, found = decks_folder(), []
    wanted = [folder / f"{name}.opts"]
    while wanted:
        path = wanted.pop()
        if path in found or not path.is_file():
            continue
        found.append(path)
        if path.suffix == ".opts":
            body = "\n".join(line.partition("#")[0] for line in path.read_text(encoding="utf-8").splitlines())
            wanted += [folder / place for place in PLACE.findall(body)]
    return found


def copy(name: str, to: Path | str = "inputs") -> Path:
    """Copies a deck, with the files that it names, into a folder, and returns the deck's path. The decks name their files as inputs/NAME,
    so that a folder of that name keeps them whole. WrongDeck where there is no such deck, or the folder has another file of a name."""
    if path_of(name) is None:
        raise no_deck(name)
    folder, to = decks_folder(), Path(to)
    pairs = [(path, to / path.relative_to(folder)) for path in files_of(name)]
    for path, place in pairs:
        if place.exists() and place.read_bytes() != path.read_bytes():
            raise WrongDeck(f"{place}: is there and differs; it is not written over")
    for path, place in pairs:
        place.parent.mkdir(parents=True, exist_ok=True)
        if not place.exists():
            shutil.copyfile(path, place)
    return to / f"{name}.opts"
