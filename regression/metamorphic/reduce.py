"""Takes options away from a deck as long as it and its image disagree."""
from dimensions import names_of

ROUND_OFF = 1e-11
LISTS = ("rigid_bodies", "loads", "probes", "water_regions", "bodies", "materials")
DIMENSIONED = ("pressure_min", "water_density")  # have defaults with units
NEEDED = ("dim", "mesh_lower", "mesh_upper", "mesh_spacing", "time_end", "backend", "p2g", "materials", "bodies", "history_interval", "output_interval")


def without(deck, what, name):
    """The deck without a body, a rigid body, a load or a probe."""
    left = [other for other in names_of(deck, what) if other != name]
    if what in ("bodies", "materials") and not left:
        return None
    out = {key: value for key, value in deck.items() if not key.startswith(f"{name}_")}
    out = {key: value for key, value in out.items() if not (key.endswith("_cut_out") and value == name)}
    for key, value in list(out.items()):
        if key.endswith("_material") and value == name:
            out[key] = left[0]
        if key.endswith("_body") and value == name:
            out[key] = left[0]
    out[what] = ",".join(left)
    if not left:
        del out[what]
    return out


def smaller(deck):
    """Decks with less in them."""
    for what in LISTS:
        for name in names_of(deck, what):
            yield without(deck, what, name)
    for material in names_of(deck, "materials"):
        if deck[f"{material}_model"] != "linear_elastic":
            out = {key: value for key, value in deck.items() if not key.startswith(f"{material}_")}
            yield {**out, f"{material}_model": "linear_elastic", f"{material}_density": 1800.0, f"{material}_young": 5e5, f"{material}_poisson": 0.3}
    for name in list(deck):
        if name not in NEEDED and not name.endswith(DIMENSIONED):
            yield {key: value for key, value in deck.items() if key != name and not key.startswith(f"{name}_")}
    for name, value in deck.items():
        if isinstance(value, tuple) and sum(x != 0 for x in value) > 1 and name.endswith(("gravity", "velocity")):
            for k, x in enumerate(value):
                if x != 0:
                    yield {**deck, name: tuple(0.0 if j == k else y for j, y in enumerate(value))}
    for by in (0.1, 0.3, 0.6):
        yield {**deck, **{name: deck[name] * by for name in ("time_end", "history_interval", "output_interval")}}


def reduced(deck, pair, tries=150):
    """The smallest deck that was found with which the pair disagrees, by round-off where it does, else by more."""
    least, most = (0, ROUND_OFF) if pair.disagreement(deck)[0][0] < ROUND_OFF else (ROUND_OFF, float("inf"))
    progress = True
    while progress:
        progress = False
        for out in smaller(deck):
            if out is None or out == deck:
                continue
            tries -= 1
            if tries < 0:
                return deck
            if disagrees(out, pair, least, most):
                deck, progress = out, True
                break
    return deck


def disagrees(deck, pair, least, most):
    try:
        found = pair.disagreement(deck)
        return bool(found) and least < found[0][0] <= most
    except (KeyError, ValueError, TypeError, IndexError):  # an image that needs what was taken away
        return False
