"""Rigid bodies that touch the soil at sites: the decks of bodies that turn, in which some or all bodies have -NAME_contact sites.

What a body gains of momentum is the impulse that the history has; a run goes on from a checkpoint with the same bits, other strategies
agree, and the mirror image moves as a mirror. Several ranks are refused.
"""
from mpm_regression.folders import launcher, run
from turning import Turning


class Sites(Turning):
    several = 0.1

    def make(self):
        super().make()
        names = [*self.bodies]
        for name in names if self.draw.random() < 0.7 else [self.draw.choice(names)]:
            self.options += [f"-{name}_contact", "sites"]
        if self.draw.random() < 0.2:
            self.options += [f"-{names[0]}_separation", "none"]

    def on_several_ranks(self, whole):
        folder = self.folder / "several"
        done = run(self.given.binary, None, folder, *self.options, "-backend", "serial", "-precision", self.precision, status=2,
                   prefix=launcher(2), timeout=self.time_limit)
        assert "takes nodes on several ranks" in done.stderr and not folder.exists(), done.stderr
