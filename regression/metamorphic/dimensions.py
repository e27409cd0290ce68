"""Kinds of the options of a deck and of the columns and fields of its results: units, and how they turn with the axes.

Units are exponents of length, time and mass. In plane strain what belongs to the whole body is per metre of width: `per_width`.
"""
import re

NONE, LENGTH, TIME, MASS = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
SPEED, ACCELERATION, DENSITY, STRESS = (1, -1, 0), (1, -2, 0), (-3, 0, 1), (-1, -2, 1)
GRADIENT, VISCOSITY, RATE = (-2, -2, 1), (-1, -1, 1), (0, -1, 0)
FORCE, ENERGY, MOMENTUM, AREA, VOLUME = (1, -2, 1), (2, -2, 1), (1, -1, 1), (2, 0, 0), (3, 0, 0)
WHOLE = {FORCE, ENERGY, MOMENTUM, AREA, VOLUME, MASS}  # of columns and fields

# Kinds of options: word; number; numbers; level (height along the last axis); levels (a level, or an outline); place; vector; outline (points of
# the first and the last axis); width (lower and upper y); stress; table (time and vector, or time and factor); axis.
WORDS = ("dim geometry materials bodies rigid_bodies loads probes stages backend precision p2g velocity_update particle_domain "
         "position_correction output_energy model material shape fill cut_out motion separation contact_normal contact_gap_scaling body "
         "bodies_of_probe kind match surface tension_word progress file tip end place remove analysis water_regions rayleigh_parts "
         "acceleration_correction velocity_table_interpolation acceleration_table_interpolation contact_pairs contact water permeability_law "
         "on_pores")
NUMBERS = ("damping flip_fraction xpic_order position_correction_rate f_bar_fraction time_courant time_max_steps particles_per_cell poisson "
           "k0 friction_deg dilation_deg mu_static mu_dynamic inertial_number exponent critical_state_ratio lambda kappa specific_volume ocr "
           "rigidity remoulded_ratio xi95 rate_factor friction dashpot_factor shear_fraction contact_gap_reach contact_gap_exponent "
           "tip_angle_deg p2g_rebuild_interval rebuild_margin rayleigh_ratio strength_factor su_ratio porosity permeability_scale")
OPTIONS = {
    **{name: ("word", NONE) for name in WORDS.split()}, **{name: ("number", NONE) for name in NUMBERS.split()},
    **{name: ("place", LENGTH) for name in "lower upper centre point mesh_lower mesh_upper".split()},
    **{name: ("number", LENGTH) for name in "mesh_spacing radius height fillet xi95_cell grain_diameter spring_length".split()},
    **{name: ("number", STRESS) for name in ("young su cohesion tension bulk_modulus shear_modulus yield_stress pressure_reference "
                                             "pressure_offset pressure_min hardening_modulus preconsolidation pore_stiffness "
                                             "shear_limit adhesion pressure water_bulk_modulus water_tension pore_pressure").split()},
    **{name: ("number", GRADIENT) for name in "su_gradient young_gradient cohesion_gradient".split()},
    **{name: ("number", DENSITY) for name in "density grain_density water_density".split()},
    **{name: ("number", TIME) for name in "time_end time_step output_interval history_interval checkpoint_interval rate_time".split()},
    **{name: ("level", LENGTH) for name in "su_datum young_datum cohesion_datum water_level".split()},
    **{name: ("levels", LENGTH) for name in "top base".split()},
    "rate_reference": ("number", RATE), "rayleigh_frequencies": ("numbers", RATE), "viscosity": ("number", VISCOSITY), "consistency": ("number", None), "gauge_width": ("number", LENGTH),
    "permeability": ("number", SPEED), "water_gravity": ("number", ACCELERATION), "gravity": ("vector", ACCELERATION), "velocity": ("vector", SPEED), "traction": ("vector", STRESS), "force": ("vector", FORCE),
    "facing": ("vector", NONE), "normal": ("vector", NONE), "velocity_table": ("table", SPEED),
    "acceleration_table": ("table", ACCELERATION), "acceleration": ("vector", ACCELERATION),
    "stress": ("stress", STRESS),
    "polygon": ("outline", LENGTH), "width": ("width", LENGTH), "at": ("at", LENGTH), "axis": ("axis", NONE),
}
SIDE = re.compile(r"^mesh_([xyz])(min|max)(?:_(\w+))?$")

# Columns of the history: pattern, units, kind. {n} is a name, {a} an axis.
COLUMNS = [(re.compile(pattern.replace("{n}", r"(?P<name>[a-z0-9]+)").replace("{a}", "(?P<axis>[xyz])") + "$"), units, kind) for pattern, units, kind in [
    ("step|stage", NONE, "number"), ("time|dt", TIME, "number"), ("empty_cells", NONE, "number"), ("energy_.*|work_.*", ENERGY, "number"),
    ("wall_(?P<side>[xyz])(?P<end>min|max)_force_{a}", FORCE, "wall"),
    ("{n}_{a}(?P<end>min|max)", LENGTH, "extent"), ("{n}_{a}q999", LENGTH, "quantile"), ("{n}_centre_{a}", LENGTH, "place"),
    ("{n}_(?:lost_momentum|momentum)_{a}", MOMENTUM, "vector"), ("{n}_momentum_flux_{a}", FORCE, "flux"), ("{n}_(?:mean_)?velocity_{a}", SPEED, "vector"),
    ("(?P<name>[a-z0-9]+(?:_[a-z0-9]+)?)_force_{a}", FORCE, "vector"), ("(?P<name>[a-z0-9]+_[a-z0-9]+)_area", AREA, "number"),
    ("(?P<name>[a-z0-9]+_[a-z0-9]+)_friction_work", ENERGY, "number"), ("{n}_(?:displacement_)?{a}", LENGTH, "displacement"), ("{n}_stress_(?P<pair>[xyz]{2})", STRESS, "stress"),
    ("{n}_(?:kinetic|lost|merged|corrected|raised)_energy", ENERGY, "number"), ("{n}_(?:mass|lost_mass)", MASS, "number"),
    ("{n}_(?:grid_velocity|speed)", SPEED, "number"), ("{n}_area", AREA, "number"), ("{n}_(?:pore_pressure|pressure|excess_pore_pressure)", STRESS, "number"),
    ("{n}_(?:strays|limited|put_back|stretched|particles|merged)", NONE, "count"), ("{n}_depth", LENGTH, "number"), ("{n}_(?:surface|base)", LENGTH, "level"),
    ("{n}_(?:water|outflow)", VOLUME, "number"), ("{n}_mass_flux", (0, -1, 1), "flux"), ("{n}_volume_flux", (3, -1, 0), "flux"), ("{n}_volume", VOLUME, "number"),
]]

# Fields of frames: units and kind.
FIELDS = {
    "position": (LENGTH, "place"), "velocity": (SPEED, "vector"), "grid_velocity": (SPEED, "vector"), "stress": (STRESS, "stress"),
    "volume": (VOLUME, "number"), "mass": (MASS, "number"), "reference_height": (LENGTH, "level"), "half_length": (LENGTH, "axes"),
    "load_area": (AREA, "vector"), "darcy_flux": (SPEED, "vector"), "solid_volume": (VOLUME, "number"), "porosity": (NONE, "number"), "periods": (NONE, "periods"),
    **{name: (STRESS, "number") for name in "pore_pressure excess_pore_pressure preconsolidation young su cohesion wave_modulus yield_stress pressure".split()},
    **{name: (NONE, "number") for name in "plastic_strain specific_volume parted_volume".split()}, "shear_rate": (RATE, "number"),
}


def names_of(deck, what):
    """The names that -materials, -bodies, ... list."""
    return [name for name in str(deck.get(what, "")).split(",") if name]


def pairs_of(deck):
    """The names of the pairs of -contact_pairs, with which their options and columns begin."""
    return [pair.replace(":", "_") for pair in names_of(deck, "contact_pairs")]


def kind_of(option, deck):
    """Kind and units of an option of a deck."""
    key, value = option, deck[option]
    name, _, rest = option.partition("_")
    if name in names_of(deck, "stages"):
        key = rest
    side = SIDE.match(key)
    if side:
        if side[3] is None:
            return "word", NONE
        key = side[3]
    elif key not in OPTIONS:
        pair = next((name for name in pairs_of(deck) if key.startswith(f"{name}_")), "")
        name, key = (pair, key[len(pair) + 1:]) if pair else key.split("_", 1)
        if name in names_of(deck, "probes"):
            key = {"width": "gauge_width", "bodies": "bodies_of_probe"}.get(key, key)
    if isinstance(value, str) and key in OPTIONS and key not in ("velocity_table", "acceleration_table", "axis"):
        return "word", NONE
    kind, units = OPTIONS[key]
    if key == "consistency":  # Pa s^n
        units = (-1, -2 + deck[option.replace("consistency", "exponent")], 1)
    if key == "force" and is_plane(deck):
        units = per_width(units)
    return kind, units


def domain_of(deck):
    """Kind of the particles' domains: the option, or the one that -analysis sets."""
    flows = deck.get("analysis") == "flow" and deck.get("geometry") is None
    return deck.get("particle_domain", "split" if flows else "fixed")


def is_plane(deck):
    return deck["dim"] == 2 and deck.get("geometry") != "axisymmetric"


def per_width(units):
    return (units[0] - 1, *units[1:])


def column_kind(column, deck):
    """Units, kind and match of a column of the history."""
    for pattern, units, kind in COLUMNS:
        match = pattern.match(column)
        if match:
            flux = kind == "flux" or units == VOLUME
            return (per_width(units) if is_plane(deck) and (units in WHOLE or flux) else units), kind, match
    raise KeyError(f"column {column} has no row in COLUMNS of dimensions.py")


def field_kind(field, deck):
    """Units and kind of a field of the frames."""
    name = re.sub("_[xyz]$", "", field)
    if name not in FIELDS:
        raise KeyError(f"field {field} has no row in FIELDS of dimensions.py")
    units, kind = FIELDS[name]
    return (per_width(units) if is_plane(deck) and units in WHOLE else units), kind


def factor(units, scales):
    """Factor of a quantity of these units where the units of length, time and mass become smaller by `scales`."""
    out = 1.0
    for exponent, scale in zip(units, scales):
        out *= scale ** exponent
    return out
