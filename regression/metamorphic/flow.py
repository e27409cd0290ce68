"""Water that flows in the pores of random decks."""


def add_flow(maker, sides, young):
    """Lets water flow in the pores of all soil of a deck; leaves out what excludes it. young: Pa, what soils are near to."""
    d, draw = maker.deck, maker.draw
    d.update(water_bulk_modulus=0.3 * young, water_density=1000.0, water_gravity=9.81, water_tension=1e5)
    for name in maker.laws:
        for key in ("density", "pore_stiffness"):
            d.pop(f"{name}_{key}", None)
        d.update({f"{name}_water": "saturated", f"{name}_porosity": draw.choice([0.3, 0.45, 0.6]), f"{name}_grain_density": 2650.0,
                  f"{name}_permeability": draw.choice([1e-6, 1e-3, 1e-2]), f"{name}_permeability_law": draw.choice(["constant", "kozeny"])})
    for name in ("position_correction", "output_energy", "tool_friction"):
        d.pop(name, None)
    if d.get("particle_domain") == "split":
        d["particle_domain"] = "stretch"
    for side in [name for name in d if name in sides]:
        if d[side] == "absorbing":
            d[side] = "roller"
        for key in ("friction", "shear_limit", "dashpot_factor", "spring_length"):
            d.pop(f"{side}_{key}", None)
        if d[side] == "friction":
            d[side] = "smooth"
        if d[side] not in ("free", "periodic") and maker.some(0.4):
            d[f"{side}_water"] = "open"
    for body in d["bodies"].split(","):
        if maker.some(0.4):
            d[f"{body}_pore_pressure"] = round(draw.uniform(-2e3, 1e4), 1)
    if "loads" in d and maker.some(0.5):
        d["push_on_pores"] = "on"
