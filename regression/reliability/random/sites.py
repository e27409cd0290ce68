"""Rigid bodies that touch the soil at sites: the decks of bodies that turn, in which some or all bodies have -NAME_contact sites.

What a body gains of momentum is the impulse that the history has; a run goes on from a checkpoint with the same bits, other strategies
and several ranks agree, and the mirror image moves as a mirror.
"""
from turning import Turning


class Sites(Turning):
    def make(self):
        super().make()
        names = [*self.bodies]
        for name in names if self.draw.random() < 0.7 else [self.draw.choice(names)]:
            self.options += [f"-{name}_contact", "sites"]
        if self.draw.random() < 0.2:
            self.options += [f"-{names[0]}_separation", "none"]
