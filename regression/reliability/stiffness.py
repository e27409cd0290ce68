#!/usr/bin/env python3
"""Random ground whose Young's modulus comes from a field.

    stiffness.py MPM [--count 50] [--seed 1] [--folder FOLDER] [--dims 2,3] [--precisions double,single]

A deck has a box of soil of a random law, whose modulus is linear in depth, between random sides, under gravity and with a
random velocity. The modulus is given three times: as young_gradient, as a field on a grid, and by a file of particles, the first frame of
the run with the field. The three runs must agree to round-off; a field of one value must agree with that value as young. The particles of
the frames must have the modulus of their height, and the time step must be that of the largest. A run that is cut in two by a checkpoint
must give the same bits as the whole one, and a run on several ranks the same to round-off. A field in which the modulus also varies along x must
give its particles moduli that differ. Wrong fields are refused in one line.
"""
import pathlib
import sys

import h5py
import numpy as np

from folders import fresh, frames, rows, run
from random_decks import draws_of, read_arguments
from sides import check_repeats, vector

HERE = pathlib.Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2] / "scripts"), str(HERE.parents[1])]

from differences import largest  # noqa: E402
from fields import write_field  # noqa: E402
from results import Run  # noqa: E402

H = 0.5  # m, edge of a cell
LAWS = ["linear_elastic", "von_mises -soil_su {su}", "tresca -soil_su {su}",
        "softening_clay -soil_su {su} -soil_remoulded_ratio 0.4 -soil_xi95 20",
        "softening_clay -soil_su {su} -soil_remoulded_ratio 0.4 -soil_xi95 20 -soil_rate_factor 0.1 -soil_rate_reference 0.01 -soil_rate_time 0.1",
        "mohr_coulomb -soil_cohesion {su} -soil_friction_deg 30", "j2_hardening -soil_yield_stress {su} -soil_hardening_modulus 1e5",
        "drucker_prager -soil_cohesion {su} -soil_friction_deg 25 -soil_match compression"]
ROUND = {"double": 1e-9, "single": 0.05}  # of two ways to give one modulus, as compare.py has strategies


def side_options(draw, dim, wide):
    """Sides of a mesh of `wide` cells along x."""
    up = "xyz"[dim - 1]
    kind = draw.choice(["roller", "absorbing", "free_field", "free", *(["periodic"] if wide % 8 == 0 else [])])
    base = draw.choice(["fixed", "absorbing"]) if kind == "free_field" else draw.choice(["fixed", "roller", "absorbing"])
    if kind == "periodic" and base == "absorbing":
        base = "fixed"
    options = [f"-mesh_{up}min", base, f"-mesh_{up}max", "free"]
    for axis in "xyz"[:dim - 1]:
        for end in ("min", "max"):
            options += [f"-mesh_{axis}{end}", kind if axis == "x" else "roller"]
    return options


def make_deck(draw, dim):
    """Options without those of the modulus; the box, m; the modulus at its top, Pa, and its growth, Pa/m."""
    wide, high = (draw.choice([11, 16, 16, 20]), draw.randint(9, 14)) if dim == 2 else (draw.choice([6, 8, 8]), draw.randint(5, 8))
    size = [H * wide, *([H * 2] if dim == 3 else []), H * high]
    upper = [*size[:-1], size[-1] + 3 * H]
    law = draw.choice(LAWS).format(su=f"{10 ** draw.uniform(3.5, 4.5):.5g}")
    young, growth = 10 ** draw.uniform(6.3, 7), 10 ** draw.uniform(5.5, 7)
    options = (f"-dim {dim} -mesh_lower {vector([0] * dim)} -mesh_upper {vector(upper)} -mesh_spacing {H} -materials soil -soil_model {law} "
               f"-soil_density {draw.uniform(1500, 2200):.5g} -soil_poisson {draw.choice([0, 0.2, 0.3, 0.45])} -bodies ground -ground_material soil "
               f"-gravity {vector([0] * (dim - 1) + [-9.81])} -ground_velocity {vector([draw.uniform(-0.2, 0.2) for _ in range(dim)])} "
               f"-velocity_update {draw.choice(['flip', 'apic', 'xpic'])} -f_bar_fraction {draw.choice(['0', '0.98'])} -damping {draw.choice(['0', '0.05'])} "
               f"-particle_domain {draw.choice(['fixed', 'fixed', 'stretch'])} -rebuild_margin {draw.choice(['0.5', '0.05'])} "
               f"-time_end 0.06 -output_interval 0.03 -history_interval 0.01").split()
    if draw.random() < 0.3:
        options += ["-soil_pore_stiffness", "2e7"]
    return options + side_options(draw, dim, wide), size, young, growth


def box(size, per_cell):
    return ["-ground_shape", "box", "-ground_lower", vector([0] * len(size)), "-ground_upper", vector(size), "-ground_particles_per_cell", str(per_cell)]


def make_field(path, draw, size, modulus):
    """modulus(x, depth), Pa, on a grid that covers the box."""
    path.unlink(missing_ok=True)
    counts = [draw.randint(2, 5) for _ in size]
    axes = [np.linspace(0, length, n) for length, n in zip(size, counts)]
    points = np.meshgrid(*axes, indexing="ij")
    write_field(path, "young", modulus(points[0], size[-1] - points[-1]), [0] * len(size), [length / (n - 1) for length, n in zip(size, counts)])


def frame(path):
    with h5py.File(path) as file:
        return {name: item[()].astype(float) for name, item in file["ground"].items()}


def agree(one, other, what, precision):
    apart, where = largest(Run(one), Run(other))
    assert apart <= ROUND[precision], f"{what}: {apart:.3g} apart at {where}"
    return apart


def first_step(folder):
    """s, the time of the first step."""
    lines = rows(folder)
    step, time = (lines[0].index(name) for name in ("step", "time"))
    later = next(line for line in lines[1:] if int(line[step]) > 0)
    return float(later[time]) / int(later[step])


def refuse(binary, empty, base, options, words):
    """The run is refused in one line."""
    result = run(binary, empty, fresh(base / "refused"), *options, status=2)
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1 and words in lines[0], f"not refused by a line with \"{words}\":\n{result.stderr}"


def check_deck(binary, empty, base, draw, dim, options, precision, size, young, growth):
    field, one_value, uneven = base / "field.h5", base / "one.h5", base / "uneven.h5"
    shape = box(size, draw.choice([1, 2, 2, 3] if dim == 2 else [1, 2]))
    up = dim - 1
    bound = 1e-12 if precision == "double" else 1e-6

    def go(name, *more, **how):
        folder = fresh(base / name)
        run(binary, empty, folder, *options, *more, **how)
        return folder

    make_field(field, draw, size, lambda x, depth: young + growth * depth)
    of_field = [*shape, "-soil_young", "field", "-ground_field", field]
    whole = go("whole", *of_field)
    first = frame(frames(whole)[0])
    exact = young + growth * (size[up] - first["reference_height"])
    assert np.allclose(first["young"], exact, rtol=max(bound, 1e-9)), "the moduli of the particles are not those of the field"
    last = frame(frames(whole)[-1])
    assert np.array_equal(np.sort(first["young"]), np.sort(last["young"])), "the particles have lost their moduli"
    gradient = go("gradient", *shape, "-soil_young", repr(young), "-soil_young_gradient", repr(growth), "-soil_young_datum", repr(size[up]))
    off = agree(whole, gradient, "the field against growth with depth", precision)

    refuse(binary, empty, base, [*options, *shape, "-soil_young", repr(young), "-ground_field", field], "-soil_young")
    refuse(binary, empty, base, [*options, *shape, "-soil_young", "field"], "where body ground has no -ground_field")

    make_field(one_value, draw, size, lambda x, depth: young - 2 * young * (depth == 0))
    refuse(binary, empty, base, [*options, *shape, "-soil_young", "field", "-ground_field", one_value], "whose young is a number in Pa from 0.001")
    make_field(one_value, draw, size, lambda x, depth: young + 0 * depth)
    same = go("one", *shape, "-soil_young", "field", "-ground_field", one_value)
    plain = go("plain", *shape, "-soil_young", repr(young))
    off = max(off, agree(same, plain, "a field of one value against that value", precision))
    if "stretch" not in options:
        assert abs(first_step(plain) / first_step(same) - 1) < 1e-6, "a field of one value has another time step"
        ratio = first_step(same) / first_step(whole)
        pore = 2e7 if "-soil_pore_stiffness" in options else 0
        nu = float(options[options.index("-soil_poisson") + 1])
        wave = [e * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) + pore for e in (young, young + growth * size[up])]
        assert abs(ratio / np.sqrt(wave[1] / wave[0]) - 1) < 0.05, f"the time step is {ratio:.4g} times that of the largest modulus"

    make_field(uneven, draw, size, lambda x, depth: (young + growth * depth) * (1 + x / size[0]))
    grown = frame(frames(go("uneven", *shape, "-soil_young", "field", "-ground_field", uneven))[0])
    assert grown["young"].max() > 1.5 * grown["young"].min(), "the field does not vary"

    start = base / "start.h5"
    with h5py.File(frames(whole)[0]) as source, h5py.File(start, "w") as to:
        source.copy("ground", to)
        del to["ground"].attrs["own_parameter"]
    listed = ["-ground_shape", "particles", "-ground_file", start, "-ground_particles_per_cell", shape[-1], "-soil_young", "field"]
    begin = frame(frames(go("listed", *listed, "-time_max_steps", "2"))[0])
    assert np.allclose(begin["young"], first["young"], rtol=1e-6), "the file of particles has given other moduli"
    again = [*listed]
    again[again.index(start)] = frames(whole)[-1]
    resumed = frame(frames(go("resumed", *again, "-time_max_steps", "2"))[0])
    assert np.allclose(np.sort(resumed["young"]), np.sort(last["young"]), rtol=1e-6), "a start from a frame has lost the moduli"
    return whole, of_field, off


def main():
    given, base = read_arguments(__doc__, "stiffness")
    binary = given.binary
    empty = base / "empty.opts"
    empty.write_text("\n")
    listing = base / "failed.txt"
    off, ranks = {"double": 0.0, "single": 0.0}, {"double": 0.0, "single": 0.0}
    for number in range(given.count):
        draw = draws_of(given, number)
        dim = int(draw.choice(given.dims.split(",")))
        precision = draw.choice(given.precisions.split(","))
        options, *ground = make_deck(draw, dim)
        options += ["-precision", precision, "-p2g", draw.choice(["sequential", "atomic", "mosaic", "gather", "tile"])]
        try:
            whole, of_field, apart = check_deck(binary, empty, base, draw, dim, options, precision, *ground)
            off[precision] = max(off[precision], apart)
            ranks[precision] = max(ranks[precision], check_repeats(binary, empty, base, options + of_field, whole, draw, precision))
        except AssertionError as error:
            listing.write_text(f"{error}\n\n{' '.join(map(str, options))}\n")
            sys.exit(f"deck {number} of seed {given.seed}: {str(error)[-1500:]}\nits options are in {listing}")
    print(f"{given.count} decks: ways to give one modulus are {off['double']:.2g} apart (single {off['single']:.2g}); cut runs give the same bits; "
          f"several ranks are {ranks['double']:.2g} apart from one (single {ranks['single']:.2g})")


if __name__ == "__main__":
    main()
