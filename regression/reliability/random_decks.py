"""What scripts that run random decks share: their arguments, and the draws of one deck."""
import argparse
import pathlib
import random
import tempfile


def read_arguments(description, name, **more):
    """Arguments of a script, and the folder of its runs. more: further options and their defaults."""
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("binary", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder")
    parser.add_argument("--dims", default="2,3")
    parser.add_argument("--precisions", default="double,single")
    for option, default in more.items():
        parser.add_argument(f"--{option}", default=default)
    given = parser.parse_args()
    base = pathlib.Path(given.folder or tempfile.mkdtemp(prefix=f"mpm_{name}_")).resolve()
    base.mkdir(parents=True, exist_ok=True)
    return given, base


def draws_of(given, number):
    """Random numbers of a deck, the same for the same seed and number."""
    return random.Random(1000 * given.seed + number)
