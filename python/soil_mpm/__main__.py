"""The command soil-mpm, or python -m soil_mpm: lists, runs, checks, draws, reports and certifies decks."""

from __future__ import annotations

import argparse
import sys
from typing import Any, Sequence

from soil_mpm.python_modules import need
from soil_mpm.problems import Problem, RunFailed, UnknownOption, WrongDeck, WrongValue

BAD_INPUT = 2
NOT_CERTIFIED, UNDECIDED = 1, 4  # exit statuses of certify


def options_of(words: Sequence[str]) -> dict[str, str]:
    """Options of the program among the words of a command line: -NAME VALUE, or -NAME alone."""
    found: dict[str, str] = {}
    rest = list(words)
    while rest:
        name = rest.pop(0)
        if not name.startswith("-") or len(name) < 2 or not name[1].isalpha():
            raise WrongDeck(f"{name}: belongs to no option; takes -NAME VALUE, and lists without spaces")
        takes = bool(rest) and not (rest[0].startswith("-") and rest[0][1:2].isalpha())
        found[name[1:]] = rest.pop(0) if takes else ""
    return found


def deck_of(arguments: argparse.Namespace, words: Sequence[str]) -> Any:
    from soil_mpm.deck import Deck
    deck = Deck.read(arguments.deck, arguments.program)
    deck.update(options_of(words))
    return deck


def run(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    deck = deck_of(arguments, words)
    done = deck.run(arguments.out, ranks=arguments.ranks, threads=arguments.threads, restart=arguments.restart)
    print(done.folder)
    if arguments.pictures:
        draw_pictures(done)
    return 0


def draw_pictures(done: Any) -> None:
    """Draws the pictures of a run, and prints their paths. The results are whole without them, so that their lack is no failure."""
    from soil_mpm.plot.pictures import Wishes, draw_all, draw_element, is_element
    paths, missing = (draw_element(done.folder), []) if is_element(done.folder) else draw_all(done, [], Wishes())
    for path in paths:
        print(path)
    for line in missing:
        print(f"soil-mpm: {line}", file=sys.stderr)


def decks(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    from soil_mpm import shipped
    if words:
        raise WrongDeck(f"{words[0]}: is no option of soil-mpm decks")
    for name in arguments.names:
        print(shipped.copy(name))
    if not arguments.names:
        for name in shipped.names():
            print(f"{name:24} {shipped.title(name)}")
    return 0


def check(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    deck = deck_of(arguments, words)
    faults = deck.check()
    for line in faults:
        print(line, file=sys.stderr)
    if not faults:
        print(deck.dry_run(), end="")
    return BAD_INPUT if faults else 0


def plot(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    if words:
        raise WrongDeck(f"{words[0]}: is no option of soil-mpm plot")
    from soil_mpm.plot.command import draw
    return draw(arguments)


def report(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    if words:
        raise WrongDeck(f"{words[0]}: is no option of soil-mpm report")
    from soil_mpm.report import write
    print(write(arguments.folder, arguments.out, arguments.pictures))
    return 0


def export(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    if words:
        raise WrongDeck(f"{words[0]}: is no option of soil-mpm export")
    from soil_mpm.export import write
    from soil_mpm.results import Run
    with Run(arguments.folder).frame_at(arguments.time) as frame:
        print(write(frame, arguments.file, arguments.body))
    return 0


def certify(arguments: argparse.Namespace, words: Sequence[str]) -> int:
    from soil_mpm.certificate import CONVERGED, NOT_CONVERGED, certify as certificate_of
    found = certificate_of(deck_of(arguments, words), arguments.answer, arguments.out, tolerance=arguments.tolerance, ranks=arguments.ranks,
                           threads=arguments.threads)
    print(found)
    return {CONVERGED: 0, NOT_CONVERGED: NOT_CERTIFIED}.get(found.verdict, UNDECIDED)


def parser_of(with_plot: bool) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="soil-mpm", description=__doc__)
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    def add(name: str, does: Any, help: str, deck: bool = True) -> argparse.ArgumentParser:
        of = commands.add_parser(name, help=help, description=help)
        of.set_defaults(does=does)
        if deck:
            of.add_argument("deck", metavar="DECK", help="a file, or the name of a deck that comes with the program (soil-mpm decks)")
            of.add_argument("--program", metavar="MPM", help="the program, by default that of the checkout or installation")
        return of
    of_run = add("run", run, "run a deck; options of mpm may follow, as -mesh_spacing 0.1")
    of_run.add_argument("--out", metavar="FOLDER", help="of the results")
    of_run.add_argument("--ranks", type=int, default=1, metavar="N", help="processes, by mpirun")
    of_run.add_argument("--threads", type=int, metavar="N", help="of each process")
    of_run.add_argument("--restart", action="store_true", help="go on from the last checkpoint, where there is one")
    of_run.add_argument("--no-pictures", dest="pictures", action="store_false", help="leave out the pictures at the end")
    add("check", check, "report all mistakes of a deck, or what its run would take; nothing is written")
    of_decks = add("decks", decks, "list the decks that come with the program, or copy some, with their files, into inputs/", deck=False)
    of_decks.add_argument("names", nargs="*", metavar="NAME", help="of the decks to copy")
    of_certify = add("certify", certify, "run a deck on its mesh and on two coarser ones, and say what an answer is worth; exit status 0: "
                     "converged, 1: not converged, 4: cannot say")
    of_certify.add_argument("--answer", required=True, metavar="TEXT", help="COLUMN at OTHER=VALUE, COLUMN over OTHER=FROM:TO (its mean), "
                            "COLUMN at end, max or min, of the history")
    of_certify.add_argument("--tolerance", type=float, default=0.05, metavar="FRACTION", help="of the answer that the bar may be")
    of_certify.add_argument("--out", metavar="FOLDER", help="of the runs")
    of_certify.add_argument("--ranks", type=int, default=1, metavar="N")
    of_certify.add_argument("--threads", type=int, metavar="N")
    of_export = add("export", export, "write a frame as VTKHDF, or as VTU, XDMF or what else meshio writes", deck=False)
    of_export.add_argument("folder", metavar="OUTPUT_DIR")
    of_export.add_argument("file", metavar="FILE", help="its ending chooses the format")
    of_export.add_argument("--time", type=float, metavar="SECONDS", help="of the frame, by default the last one")
    of_export.add_argument("--body", action="append", metavar="NAME", help="a body to write; may be given again; by default all")
    of_report = add("report", report, "write one HTML file of a run: what was run, checks of trust, warnings, pictures, curves", deck=False)
    of_report.add_argument("folder", metavar="OUTPUT_DIR", help="of a run, or of a certificate")
    of_report.add_argument("--out", metavar="FILE", help="the file, by default report.html in the folder")
    of_report.add_argument("--no-pictures", dest="pictures", action="store_false", help="take the pictures that are there, and draw none")
    of_plot = add("plot", plot, "draw the results of a run", deck=False)
    if with_plot:
        from soil_mpm.plot.command import add_arguments
        add_arguments(of_plot)
    return parser


def main(words: Sequence[str] | None = None) -> int:
    words = list(sys.argv[1:] if words is None else words)
    with_plot = words[:1] == ["plot"]
    arguments, rest = parser_of(with_plot).parse_known_args(words)
    try:
        return arguments.does(arguments, rest)
    except (RunFailed, UnknownOption, WrongDeck, WrongValue, Problem) as problem:
        print(problem if str(problem).startswith("mpm: ") else f"soil-mpm: {problem}", file=sys.stderr)
        return problem.status if isinstance(problem, RunFailed) else BAD_INPUT


if __name__ == "__main__":
    need("h5py", "matplotlib", "numpy")
    sys.exit(main())
