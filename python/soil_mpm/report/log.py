"""The log of a run (mpm.log): machine, options in force, warnings and notices."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

OPTION = re.compile(r"^  -(\S+) +(.*\S) +(given|default)$")
NOTICE = re.compile(r"^(warning: |mpm: note: |step \d+, time \S+ s: )")
STEP = re.compile(r"^time step (\S+) s, Courant number (\S+), of at most (\S+);")


@dataclass
class Log:
    """begun: version and date. facts: machine, device, libraries. given: (option, value and unit) that the deck or the command line gave.
    warnings: lines about the input and about what happened in the run. courant: number and largest stable one, None where the log has
    none."""
    begun: str = ""
    facts: dict[str, str] = field(default_factory=dict)
    given: list[tuple[str, str]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    courant: tuple[float, float] | None = None

    @staticmethod
    def read(path: Path) -> Log:
        """The log of a file; an empty one where there is no such file. A run that went on has the options of its last start."""
        log = Log()
        if path.exists():
            for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
                log.add(line.rstrip())
        return log

    def add(self, line: str) -> None:
        option, step = OPTION.match(line), STEP.match(line)
        if line.startswith("mpm ") and line[4:5].isdigit():
            self.begun, self.facts, self.given = line, {}, []
        elif option:
            if option[3] == "given":
                self.given.append((option[1], re.sub(r" {2,}", " ", option[2])))
        elif step:
            self.courant = float(step[2]), float(step[3])
        elif NOTICE.match(line) and line not in self.warnings:
            self.warnings.append(line)
        elif re.match(r"^  (machine|device|libraries) ", line):
            name, _, text = line.strip().partition(" ")
            self.facts[name] = text.strip()
