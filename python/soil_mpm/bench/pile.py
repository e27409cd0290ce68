"""A pile in soil in 3D: the problem that shows what contact of a pair of deformable bodies costs."""

SPACING, DEPTH, PILE = 0.125, 6.0, 1.0  # m

DECK = """-dim 3 -mesh_lower 0,0,0 -mesh_upper {width},{width},{top} -mesh_spacing {spacing} -gravity 0,0,-9.81
-mesh_xmin roller -mesh_xmax roller -mesh_ymin roller -mesh_ymax roller -mesh_zmin fixed -mesh_zmax free
-materials clay,steel -clay_model von_mises -clay_density 1800 -clay_young 1e7 -clay_poisson 0.49 -clay_su 2e4
-steel_model linear_elastic -steel_density 2500 -steel_young 1e8 -steel_poisson 0.3
-bodies soil,pile -soil_material clay -soil_shape box -soil_lower 0,0,0 -soil_upper {width},{width},{depth} -soil_cut_out pile
-pile_material steel -pile_shape box -pile_lower {low},{low},{toe} -pile_upper {high},{high},{top_of_pile}
-time_end 100 -time_step 1.5e-4 -output_frames off -progress off"""
PAIR = "-contact_pairs soil:pile -soil_pile_shear_fraction 0.5"


def options_of(width, pairs):
    """Options of a run. width: of the soil [m], in which the pile of 1 m x 1 m reaches two thirds of the depth; pairs: whether the
    pile slides, with half the soil's strength, or sticks to the soil."""
    middle = round(width / 2 / SPACING) * SPACING
    deck = DECK.format(width=width, spacing=SPACING, depth=DEPTH, top=DEPTH + 2, low=middle - PILE / 2, high=middle + PILE / 2,
                       toe=DEPTH / 3, top_of_pile=DEPTH + 1)
    return f"{deck} {PAIR}" if pairs else deck
