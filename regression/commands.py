#!/usr/bin/env python3
"""Every command that the pages show works as far as it can be tried here.

usage: commands.py PATH_TO_mpm [--list]

A command is a line of a page that begins with soil-mpm, mpm, mpirun or scripts/, indented by four blanks or in a ```sh block. What starts the program
(mpm, mpirun, scripts/run, scripts/sweep, soil-mpm run, certify and check) is done as a dry run of its deck with its options. Of any other script or
subcommand, --help must work and must have each option that the command gives. `soil-mpm decks` runs. LEFT_OUT has the commands that cannot be tried, each with its
reason; a row that fits no command is a fault. The tutorials are run whole by tutorials.py.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
BEGINS = ("soil-mpm ", "mpm ", "mpirun ", "scripts/", "mpm/bin/soil-mpm ")
# Files that a page names as an example, and a file of the repository that stands for each.
STANDS_FOR = {"footing.opts": "inputs/footing.opts", "sand.opts": "inputs/element/sand.opts", "umat.opts": "inputs/element/sand.opts",
              "deck.opts": "inputs/footing.opts", "slope.opts": "inputs/staged_excavation.opts", "table.csv": None, "DECK": "inputs/footing_coarse.opts",
              "../../../inputs/footing.opts": "inputs/footing.opts", "../../../inputs/landslide.opts": "inputs/landslide.opts",
              "inputs/NAME.opts": "inputs/footing_coarse.opts"}
LEFT_OUT = (
    (r"-restart latest", "continues a run that is not there"),
    (r"-element_path path\.csv", "the path is the one that the page writes: element.replays and element.tests run such paths"),
    (r"-NAME_contact", "NAME stands for a body"),
    (r"\$quiet", "the page sets a variable of the shell before"),
    (r"mpm_unit", "unit tests: the tests unit.* and on ranks"),
    (r"inputs/terrain_slide\.opts", "its rasters are made first: the tutorial terrain runs it"),
    (r" && eval ", "sets up, and changes the shell that reads it"),
)
VALUELESS = {"-dry_run"}


def commands_of(text):
    """Commands of a page, with their continued lines joined and without comments."""
    found, in_shell, lines = [], False, iter(text.splitlines())
    for line in lines:
        if line.startswith("```"):
            in_shell = line.strip() == "```sh"
        indented = line.startswith("    ")
        words = line.strip()
        if not (in_shell or indented) or not words.startswith(BEGINS):
            continue
        while words.endswith("\\"):
            words = words[:-1] + next(lines).strip()
        found.append(re.split(r"\s+#\s|\s{3,}(?=\S)", words)[0].strip())
    return found


def all_commands():
    """{command: the first page that has it}"""
    found = {}
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        for command in commands_of(page.read_text()):
            found.setdefault(command, page.relative_to(ROOT).as_posix())
    return found


class Tries:
    """Ways to try a command without its work."""

    def __init__(self, program, folder):
        self.program, self.folder, self.helps = program, folder, {}
        self.environment = {**os.environ, "MPM_PROGRAM": program, "MPM_PYTHON": sys.executable, "PYTHONDONTWRITEBYTECODE": "1",
                            "OMPI_MCA_ess_singleton_isolated": "1"}

    def run(self, *words):
        return subprocess.run([str(word) for word in words], cwd=self.folder, env=self.environment, capture_output=True, text=True)

    def dry_run(self, options):
        """The fault of a run with some options of the program."""
        options = on_processor([STANDS_FOR.get(word, word) for word in options])
        done = self.run(self.program, *[word for word in options if word not in VALUELESS], "-dry_run")
        return done.stderr.strip() if done.returncode else ""

    def help(self, words):
        """Text of the help of a script or of a subcommand."""
        key = tuple(words)
        if key not in self.helps:
            done = self.run(*words, "--help")
            self.helps[key] = done.stdout + done.stderr if done.returncode == 0 else None
        return self.helps[key]

    def has_options(self, begin, rest):
        """The fault where a help fails, or lacks an option that begins with two dashes."""
        text = self.help(begin)
        if text is None:
            return f"{' '.join(map(str, begin))} --help fails"
        lacking = [word for word in rest if re.match(r"--[a-z]", word) and not re.search(re.escape(word.partition('=')[0]) + r"\b", text)]
        return f"the help has no {', '.join(lacking)}" if lacking else ""

    def soil_mpm(self, words):
        command, rest = words[0], words[1:]
        begin = (ROOT / "scripts" / "soil-mpm", command)
        if command == "decks":
            done = self.run(*begin, *(["footing_coarse"] * ("NAME" in rest)))
            return done.stderr.strip() if done.returncode else ""
        fault = self.has_options(begin, rest)
        if fault or command not in ("run", "check", "certify"):
            return fault
        options = options_of(rest[1:])
        if command == "certify":  # it lets a mesh grow to whole cells
            options = [word for before, word in zip(["", *options], options) if "-mesh_spacing" not in (before, word)]
        done = self.run(ROOT / "scripts" / "soil-mpm", "check", STANDS_FOR.get(rest[0], rest[0]), *on_processor(options))
        return done.stderr.strip() if done.returncode else ""

    def script(self, words):
        path = self.folder / words[0]
        if not path.exists():
            return f"there is no {words[0]}"
        if words[0] == "scripts/soil-mpm":
            return self.soil_mpm(words[1:])
        if words[0] == "scripts/run":
            return self.dry_run(["-options_file", words[1], *words[2:]])
        fault = self.has_options((path,), words[1:])
        if not fault and words[0] == "scripts/sweep":
            return self.dry_run(options_of(words[1:]))
        return fault

    def fault_of(self, command):
        words = shlex.split(re.sub(r"\[.*?\]( \.\.\.)?", "", command.replace("mpm/bin/", "")))
        if words[0] == "mpirun":
            words = words[next(k for k, word in enumerate(words) if pathlib.Path(word).name == "mpm"):]
            words[0] = "mpm"
        if words[0] == "soil-mpm":
            return self.soil_mpm(words[1:])
        return self.dry_run(words[1:]) if words[0] == "mpm" else self.script(words)


def on_processor(options):
    """Options with a back end that every machine has."""
    return ["serial" if before == "-backend" and word == "cuda" else word for before, word in zip(["", *options], options)]


def options_of(words):
    """Options of the program among the words of a command: those with one dash, each with its value."""
    kept = []
    for before, word in zip(["", *words], words):
        if re.match(r"-[a-z]", word) or (re.match(r"-[a-z]", before) and not word.startswith("--")):
            kept.append(word)
    return kept


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    commands, faults, unused, tried = all_commands(), [], {pattern for pattern, _ in LEFT_OUT}, 0
    with tempfile.TemporaryDirectory() as folder:
        for part in ("scripts", "python", "docs", "regression", "lib", "build"):
            (pathlib.Path(folder) / part).symlink_to(ROOT / part)
        (pathlib.Path(folder) / "inputs").mkdir()
        for path in (ROOT / "inputs").iterdir():
            (pathlib.Path(folder) / "inputs" / path.name).symlink_to(path)
        tries = Tries(str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(folder))
        for command, page in commands.items():
            why = next(((pattern, reason) for pattern, reason in LEFT_OUT if re.search(pattern, command)), None)
            if why:
                unused.discard(why[0])
                fault = ""
            else:
                tried += 1
                fault = tries.fault_of(command)
            if "--list" in sys.argv or fault:
                print(f"{page}: {command}\n    {fault or (why[1] if why else 'works')}", flush=True)
            faults += [command] * bool(fault)
    faults += [f"LEFT_OUT: {pattern}: fits no command" for pattern in sorted(unused)]
    print("\n".join(faults) or f"{tried} commands work, {len(commands) - tried} are left out")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
