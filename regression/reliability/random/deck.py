"""The base of all random decks: how one is drawn, run, cut by a checkpoint, and repeated on ranks and by other strategies."""
import collections
import dataclasses

import numpy as np

from mpm_regression.differences import largest
from mpm_regression.folders import checkpoints, differences, frames, fresh, launcher, rows, run
from soil_mpm.results import Run


def vector(values):
    return ",".join(repr(float(x)) for x in values)


def rounded(values):
    return vector(round(float(x), 6) for x in values)


def flat_table(value):
    """A table of one value, in the place of the constant `value`, a text."""
    return ",".join(":".join([t, *value.split(",")]) for t in ("-1", "0.0031", "9"))


@dataclasses.dataclass(frozen=True)
class Machine:
    """Back end, strategy, ranks and threads of a run."""
    backend: str
    strategy: str
    ranks: int = 1
    threads: int = 1
    partition: str = "box"

    def words(self):
        return ["-backend", self.backend, "-p2g", self.strategy, *(["-partition", self.partition] if self.ranks > 1 else [])]

    def gives_same_bits(self):
        """Whether a run that is repeated gives the same bits. Parts by metis and the choice of a strategy follow the clock."""
        return self.strategy not in ("atomic", "auto") and (self.ranks == 1 or self.partition == "box")

    def __str__(self):
        return f"{self.backend} {self.strategy}, {self.ranks} ranks of {self.threads} threads"


class Deck:
    """A random deck. `make` draws its options, `check` tests what holds for each of its runs, `compare` makes runs of its own.

    The attributes say what the runner may draw: the machine of the first run; the shares of the decks that are cut by a checkpoint
    (`restarts`), run again on other numbers of ranks (`several`) and by another strategy and back end (`others`)."""
    more = {}  # further options of the command, and their defaults
    dims = (2, 3)
    precisions = ("double", "single")
    backends = ("serial", "openmp")
    strategies = ("sequential", "atomic", "mosaic", "gather", "tile")
    ranks = (1,)
    threads = (1,)
    partitions = ("box",)
    restarts, several, others = 1.0, 0.4, 0.2
    counts = (2, 3)  # of ranks of the runs that `several` draws
    sums = ()  # beginnings of columns that several ranks sum anew after a restart
    apart = {"double": 1e-9, "single": 0.05}  # ranks and strategies from the first run, of a field's largest value, as compare.py has it
    time_limit = 600  # s a run
    is_random = True  # False: all decks have names

    def __init__(self, given, key, draw, folder):
        self.given, self.key, self.draw, self.folder = given, key, draw, folder
        self.noted, self.options = collections.defaultdict(list), []
        self.dim = int(draw.choice([d for d in self.dims if str(d) in given.dims] or self.dims))
        self.precision = draw.choice([word for word in self.precisions if word in given.precisions] or given.precisions)
        self.exact = self.precision == "double"
        self.up, self.axes = "xyz"[self.dim - 1], "xyz"[:self.dim]
        self.machine = self.draw_machine(self.ranks)
        self.make()

    @classmethod
    def names(cls, given):
        """Decks that are not random: each has a name in the place of a number."""
        return []

    @classmethod
    def fault_of_all(cls, noted, count):
        """The fault of all decks together, from what they noted; empty if none."""
        return ""

    def __str__(self):
        return f"{self.dim}D {self.precision}, {self.machine}"

    def draw_machine(self, ranks):
        draw, backends = self.draw, [word for word in self.backends if word in self.given.backends] or self.given.backends
        backend, count = draw.choice(backends), draw.choice(ranks)
        strategy, threads = draw.choice(self.strategies), draw.choice(self.threads)
        return Machine(backend, strategy, count, threads if backend == "openmp" else 1, draw.choice(self.partitions))

    def bound(self, double, single):
        return double if self.exact else single

    def note(self, what, value):
        """Notes a number; the runner prints the median and the largest of all decks."""
        self.noted[what].append(float(value))

    # ------------------------------------------------------------------------------------------ runs

    def go(self, name, *more, options=None, machine=None, status=0):
        """Runs into a folder of this name, which it returns. more: further options; a restart goes on in the folder."""
        return self.launch(name, *more, options=options, machine=machine, status=status)[0]

    def launch(self, name, *more, options=None, machine=None, status=0):
        """The folder of a run, and what it printed."""
        machine, folder = machine or self.machine, self.folder / name
        if "-restart" not in more:
            fresh(folder)
        words = [*(self.options if options is None else options), *machine.words(), "-precision", self.precision, *more]
        environment = {"OMP_NUM_THREADS": str(machine.threads), "OMP_WAIT_POLICY": "passive",
                       "OMPI_MCA_orte_tmpdir_base": str(self.folder)}  # runs at once clear each other's
        return folder, run(self.given.binary, None, folder, *words, status=status, environment=environment,
                           prefix=launcher(machine.ranks), timeout=self.time_limit)

    def examine(self):
        """All runs of the deck, and their checks."""
        whole = self.first_run()
        if whole is None:
            return
        self.check(whole)
        if self.machine.gives_same_bits() and self.draw.random() < self.restarts:
            self.check_cut(whole, self.machine)
        if self.draw.random() < self.several:
            self.on_several_ranks(whole)
        if self.draw.random() < self.others:
            other = self.draw_machine((1,))
            self.check_other(self.go("other", machine=other), whole, str(other))
        self.compare(whole)

    def first_run(self):
        """The folder, or None where the deck came to an end that counts as good."""
        return self.go("whole")

    def on_several_ranks(self, whole):
        ranks = self.draw.choice([n for n in self.counts if n != self.machine.ranks])
        machine = dataclasses.replace(self.machine, ranks=ranks)
        self.check_other(self.go("several", machine=machine), whole, f"{ranks} ranks")

    # ------------------------------------------------------------------------------------------ checks

    def check(self, folder):
        """Demands of the physics, of each run."""

    def check_other(self, folder, whole, what):
        """A run on other ranks or by another strategy, against the first."""
        self.check(folder)
        apart, where = largest(Run(folder), Run(whole))
        self.note(f"difference of ranks and strategies, {self.precision}", apart)
        assert apart <= self.apart[self.precision], f"{what}: {apart:.3g} apart from the first run at {where}"

    def compare(self, whole):
        """Further runs against the first."""

    def cut_step(self, whole):
        """The step before which a checkpoint cuts the run."""
        return self.draw.randint(1, max(int(rows(whole)[-1][0]) - 1, 1))

    def check_cut(self, whole, machine, options=None):
        """A run that a checkpoint cuts in two at any step gives the same bits."""
        at = self.cut_step(whole)
        cut = self.go("cut", "-time_max_steps", at, "-checkpoint_interval", 1e3, options=options, machine=machine)
        self.go("cut", "-restart", checkpoints(cut)[-1], options=options, machine=machine)
        self.check_same_bits(cut, whole, f"cut at step {at} of {rows(whole)[-1][0]}", machine)

    def check_same_bits(self, folder, whole, what, machine=None):
        """Rows, frames and rasters of both folders have the same bits, except for rows where the run was cut."""
        sums = self.sums if machine and machine.ranks > 1 else ()
        mine, theirs = columns_but(folder, sums), columns_but(whole, sums)
        held = {tuple(line) for line in mine}
        missing = sum(tuple(line) not in held for line in theirs)
        assert missing == 0, f"{what}: {missing} rows of {len(theirs)} differ"
        if frames(whole):
            found = [each for each in differences(folder, whole) if "history" not in each]
            assert not found, f"{what}: {found[:5]}"
        for path in whole.glob("raster*"):
            assert path.read_bytes() == (folder / path.name).read_bytes(), f"{what}: {path.name} differs"


def changer(words):
    """A function that changes an option of `words` by f, from the numbers that it has to those of an image; absent options stay so."""
    def change(option, f):
        if option in words:
            at = words.index(option) + 1
            words[at] = vector(f([float(x) for x in words[at].split(",")]))
    return change


def columns_but(folder, beginnings):
    """Rows of the history without columns that begin so."""
    head, *lines = rows(folder)
    kept = [k for k, name in enumerate(head) if not name.startswith(tuple(beginnings))]
    return [[line[k] for k in kept] for line in (head, *lines)]


def check_impulse(momentum, gained, scale, bound, axis):
    """The momentum at each row is that of the first and what has been gained since."""
    error = np.abs(momentum[1:] - momentum[0] - gained).max() / scale
    assert error < bound, f"the momentum along {axis} is {error:.3g} off, more than {bound:.3g}"
    return error
