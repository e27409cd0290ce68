"""Rows of the cases with absorbing sides."""

import numpy as np

from mpm_regression.row import Row


def reflection_rows(history, body, axis, factor, what, tolerance=0.01):
    """The reflected share R = (1 - a)/(1 + a) of a pulse that moved along an axis to a side whose dashpots have the factor a: by the
    momentum of the body, and by the largest velocity of a node. what: the beginning and the end of the rows' names."""
    begin, end = what
    exact, momentum, speed = (1 - factor) / (1 + factor), history[f"{body}_momentum_{axis}"], history[f"{body}_grid_velocity"]
    yield Row(f"{begin}R by the momentum, a = {end}", momentum[-1] / momentum[0], exact, tolerance, "linear wave equation")
    yield Row(f"{begin}R by the largest velocity, a = {end}", speed[-1] / speed[0], abs(exact), tolerance, "linear wave equation")


def rest_row(history, body, name, allowed):
    """How far the centre of the body moves [m]; in a run of stages, within the second one."""
    late = history["stage"] == 2 if "stage" in history else slice(0, None)
    place = np.column_stack([history[f"{body}_centre_x"], history[f"{body}_centre_y"]])[late]
    return Row(f"{name}: movement of the centre in 4 s (m)", np.abs(place - place[0]).max(), 0, allowed, "at rest")
