"""Sizes of a case: the same problem on finer or coarser cells."""

import inspect
import types


class Size:
    """A size is a class in case.py, `class Fine(Size)` of the case `circle`, and runs as `circle_fine`. Its docstring and members
    are those of a case.py, in place of the case's own; functions take no self. Only `draw` is not taken over from the case."""


def with_size(module, size):
    """Definitions of a case.py, as the size of this name changes them."""
    changes = vars(getattr(module, size.capitalize()))
    kept = {name: value for name, value in vars(module).items() if name != "draw"}
    return types.SimpleNamespace(**{**kept, **changes, "__doc__": inspect.cleandoc(changes["__doc__"])})
