"""The text of a deck: its options in the order of the lines, with comments and blanks as they were."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Iterator

from soil_mpm.problems import WrongDeck

WORD = re.compile(r'"[^"\n]*"?|[^\s"#][^\s#]*')
NAME = re.compile(r"-[A-Za-z]\w*$")
REMOVED = "\0"  # in the place of an option until the rest of its line is seen


class Given:
    """An option as a line gives it: its name without dash, and its text, None where it has none."""

    def __init__(self, name: str, text: str | None, where: str = ""):
        self.name, self.text, self.where = name, text, where

    def __str__(self) -> str:
        if self.text is None:
            return f"-{self.name}"
        return f"-{self.name} " + (f'"{self.text}"' if re.search(r"\s", self.text) or not self.text else self.text)


class DeckText:
    """Pieces of text and options in turn. The line of an included deck (-options_file) stays; `included` has these decks in turn, whose
    options count at the place of the line."""

    def __init__(self) -> None:
        self.pieces: list[str | Given] = []
        self.included: list[DeckText] = []

    @staticmethod
    def read(path: Path | str) -> DeckText:
        """The deck of a file; WrongDeck where it cannot be read, or has a word that belongs to no option."""
        path = Path(path)
        try:
            return DeckText.of(path.read_text(encoding="utf-8"), str(path))
        except (OSError, UnicodeDecodeError) as error:
            raise WrongDeck(f"{path}: cannot be read as a deck: {error}") from None

    @staticmethod
    def of(text: str, where: str = "deck", depth: int = 0) -> DeckText:
        deck = DeckText()
        for number, line in enumerate(text.splitlines(keepends=True), 1):
            deck.add_line(line, f"{where}:{number}", depth)
        return deck

    def add_line(self, line: str, where: str, depth: int) -> None:
        body, mark, comment = line.partition("#")
        words = list(WORD.finditer(body))
        if not words:
            self.pieces.append(line)
            return
        if not NAME.match(words[0][0]) or len(words) > 2:
            raise WrongDeck(f'{where}: given "{body.strip()}", takes -NAME VALUE, and lists without spaces')
        given = Given(words[0][0][1:], words[1][0].strip('"') if len(words) == 2 else None, where)
        self.pieces += [body[:words[0].start()], given, body[words[-1].end():] + mark + comment]
        if given.name.lower() == "options_file":
            self.include(given, where, depth)
        elif given.name.lower() in ("prefix_push", "prefix_pop"):
            raise WrongDeck(f"{where}: -{given.name} is not read from Python; give the options their whole names")

    def include(self, given: Given, where: str, depth: int) -> None:
        if depth > 20:
            raise WrongDeck(f"{where}: decks include one another more than 20 times")
        path = Path(given.text or "")
        try:
            self.included.append(DeckText.of(path.read_text(encoding="utf-8"), str(path), depth + 1))
        except (OSError, UnicodeDecodeError) as error:
            raise WrongDeck(f"{where}: -options_file {path}: cannot be read: {error}") from None

    def options(self) -> Iterator[Given]:
        """Options in the order in which they take precedence, the last one most."""
        included = iter(self.included)
        for piece in self.pieces:
            if isinstance(piece, Given) and piece.name.lower() == "options_file":
                yield from next(included).options()
            elif isinstance(piece, Given):
                yield piece

    def own(self, name: str) -> Given | None:
        """The last option of a name in lower case that this text itself gives."""
        found = [piece for piece in self.pieces if isinstance(piece, Given) and piece.name.lower() == name]
        return found[-1] if found else None

    def append(self, given: Given) -> None:
        if self.pieces and not str(self.pieces[-1]).endswith("\n"):
            self.pieces.append("\n")
        self.pieces += [given, "\n"]

    def remove(self, name: str) -> None:
        """Takes an option of a name in lower case out, with its line unless that has a comment."""
        kept: list[str | Given] = []
        for piece in self.pieces:
            if isinstance(piece, Given) and piece.name.lower() == name:
                kept.append(REMOVED)
            elif kept and kept[-1] is REMOVED:
                kept.pop()
                if str(piece).strip() or (kept and str(kept[-1]).strip(" \t") not in ("", "\n") and not str(kept[-1]).endswith("\n")):
                    kept.append(str(piece).lstrip(" \t"))
            else:
                kept.append(piece)
        self.pieces = kept

    def __str__(self) -> str:
        return "".join(map(str, self.pieces))


def table_of(path: str) -> dict[str, dict[str, str]]:
    """{name: {key: cell}} of a CSV file of rigid bodies (-rigid_bodies_file), with commas for the blanks in a cell; empty where it cannot
    be read, which the program reports."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            header, *rows = [[cell.strip() for cell in row] for row in csv.reader(file) if row and not row[0].startswith("#")]
    except (OSError, ValueError):
        return {}
    return {row[0]: {key: ",".join(cell.split()) for key, cell in zip(header[1:], row[1:]) if cell} for row in rows}


def table_options(text: DeckText) -> dict[str, str]:
    """Options that the table of rigid bodies of a deck gives."""
    path = next((each.text or "" for each in reversed(list(text.options())) if each.name.lower() == "rigid_bodies_file"), "")
    return {f"{name}_{key}".lower(): cell for name, cells in table_of(path).items() for key, cell in cells.items()}
