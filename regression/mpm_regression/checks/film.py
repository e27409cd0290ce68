"""Shared by the cases of a film on a slope: laws, exact profiles, the film at the start, and what is measured.

The mesh lies along the slope, and gravity is turned. x points downhill, y is the height above the base.
"""

import numpy as np

from mpm_regression import particles
from mpm_regression.curves import last_frame
from mpm_regression.row import Row

G = 9.81
RELAXATIONS = 2.0  # times that a run takes: what the film lacks of its velocity falls to e^-2 of it
START = 0.95  # share of the exact velocity at the start


class Film:
    """A film of the height H, m, on a slope. Subclasses have its steady flow, `surface` and `flow`, m/s and m2/s, the time in
    which it comes to it, `relaxation`, s, and the options of its law, `law`."""

    def __init__(self, slope_deg, height, density, cells):
        self.slope, self.height, self.density = np.radians(slope_deg), height, density
        self.pull, self.push = (density * G * part for part in (np.sin(self.slope), np.cos(self.slope)))  # N/m3
        self.cells, self.spacing = cells, height / cells

    def margins(self):
        """How far what happens at the tail and at the front comes into the film, m: with the flow and the gravity wave, and
        for the tail a third more, because the wave grows wider."""
        time = RELAXATIONS * self.relaxation()
        wave = np.sqrt(G * self.height) * time
        return 1.3 * (self.surface() * time + max(self.surface() * time, wave)), wave

    def middle(self):
        """Where the ends have not reached the film, m: the ends of four heights of it."""
        return self.margins()[0], self.margins()[0] + 4 * self.height

    def length(self):
        """Length of the film, m, in whole cells: four heights are left of it that the ends do not reach."""
        return np.ceil((sum(self.margins()) + 4 * self.height) / self.spacing) * self.spacing

    def wave_modulus(self):
        """That of a wave ten times as fast as the flow and as a wave on the film, Pa."""
        return self.density * 100 * max(self.surface() ** 2, G * self.height)

    def options(self):
        """Options of a run from START of the steady velocity."""
        end = RELAXATIONS * self.relaxation()
        return f"{self.mesh(self.length())} {self.law()} -time_end {end:.6g} -output_interval {end:.6g}"

    def mesh(self, length):
        top, d = self.height + 2 * self.spacing, self.spacing
        return (f"-mesh_spacing {d:.12g} -mesh_upper {length:.12g},{top:.12g} -layer_file {{start}} "
                f"-gravity {G * np.sin(self.slope):.8g},{-G * np.cos(self.slope):.8g} -fluid_density {self.density:g}")

    def write(self, path, length=None, share=START):
        """The film at the start: the stress of equilibrium, and a share of the exact velocity."""
        place = particles.lattice((0, 0), (length or self.length(), self.height), self.spacing / 2)
        above = self.height - place[:, 1]
        stress = np.zeros((len(place), 6))
        stress[:, :3] = (-self.push * above)[:, None]
        stress[:, 3] = self.pull * above
        velocity = np.column_stack([share * self.velocity(place[:, 1]), np.zeros(len(place))])
        particles.write(path, "layer", place, self.spacing / 2, stress=stress, velocity=velocity)


class FluidFilm(Film):
    """A film of fluid with the shear stress tau = strength + k rate^n."""

    def __init__(self, slope_deg, height, density, strength, k, n, cells):
        super().__init__(slope_deg, height, density, cells)
        self.strength, self.k, self.n = strength, k, n
        self.sheared = max(height - strength / self.pull, 0.0)  # m, below the plug

    def velocity(self, y):
        """Exact velocity at heights y, m/s: the flow curve integrated from the base."""
        m = 1 + 1 / self.n
        return (self.pull / self.k) ** (1 / self.n) / m * (self.sheared**m - np.clip(self.sheared - y, 0, None) ** m)

    def surface(self):
        return float(self.velocity(self.height))

    def flow(self):
        return self.surface() * (self.height - self.n / (2 * self.n + 1) * self.sheared)

    def relaxation(self):
        """That of a Newtonian film as thick as what is sheared, with the viscosity at the base."""
        viscosity = self.k * (self.pull * self.sheared / self.k) ** (1 - 1 / self.n)
        return 4 * self.density * self.sheared**2 / (np.pi**2 * viscosity)

    def law(self):
        bulk = f"-fluid_bulk_modulus {self.wave_modulus():.5g}"
        if self.strength == 0 and self.n == 1:
            return f"-fluid_model newtonian -fluid_viscosity {self.k:g} {bulk}"
        shear = self.wave_modulus() / 3
        if self.sheared > 0:  # elastic waves come to rest in a sixtieth of the relaxation
            needed = 60 * self.k * (self.surface() / self.sheared) ** (self.n - 1) / self.relaxation()
            shear = min(max(10 * self.strength, needed), shear)
        return (f"-fluid_model yield_stress_fluid -fluid_shear_modulus {shear:.4g} -fluid_yield_stress {self.strength:g} "
                f"-fluid_consistency {self.k:g} -fluid_exponent {self.n:g} -fluid_tension on {bulk}")

    def from_rest(self, length, end):
        """Options of a layer of this length, m, that is at rest at the start. Damping takes the waves that come from its ends,
        where it is not in balance."""
        return f"{self.mesh(length)} {self.law()} -time_end {end:g} -output_interval {end:g} -damping 0.3"


class GrainFilm(Film):
    """A film of grains (Jop, Forterre & Pouliquen 2006), whose inertial number is the same at every height. It lies between
    periodic sides, because it takes long to come to its steady flow."""

    ALONG = 8  # cells

    MU_S, MU_2, I_0 = 0.38, 0.64, 0.279  # tan 20.9 deg, tan 32.76 deg, rounded
    DIAMETER, GRAIN_DENSITY, FRACTION = 5e-4, 2450.0, 0.6  # m, kg/m3, of the volume

    def __init__(self, slope_deg, height, cells):
        super().__init__(slope_deg, height, self.FRACTION * self.GRAIN_DENSITY, cells)
        slope = np.tan(self.slope)
        self.inertial_number = self.I_0 * (slope - self.MU_S) / (self.MU_2 - slope)

    def velocity(self, y):
        """Exact velocity at heights y, m/s (Bagnold's profile)."""
        scale = 2 / 3 * self.inertial_number / self.DIAMETER * np.sqrt(self.FRACTION * G * np.cos(self.slope))
        return scale * (self.height**1.5 - (self.height - y) ** 1.5)

    def surface(self):
        return float(self.velocity(self.height))

    def flow(self):
        return 0.6 * self.surface() * self.height

    def length(self):
        return self.ALONG * self.spacing

    def middle(self):
        return 0.0, self.length()

    def options(self):
        return f"{super().options()} -mesh_xmin periodic -mesh_xmax periodic -velocity_update apic"

    def relaxation(self):
        """That of a Newtonian film with d tau / d rate at half the height as its viscosity."""
        slope = (self.MU_2 - self.MU_S) * self.I_0 / (self.I_0 + self.inertial_number) ** 2  # of mu(I)
        viscosity = slope * self.DIAMETER * np.sqrt(self.GRAIN_DENSITY * self.push * self.height / 2)
        return 4 * self.density * self.height**2 / (np.pi**2 * viscosity)

    def law(self):
        return (f"-fluid_model mu_i -fluid_young {self.wave_modulus() * 1.3 * 0.4 / 0.7:.5g} -fluid_poisson 0.3 "
                f"-fluid_mu_static {self.MU_S} -fluid_mu_dynamic {self.MU_2} -fluid_inertial_number {self.I_0} "
                f"-fluid_grain_diameter {self.DIAMETER} -fluid_grain_density {self.GRAIN_DENSITY}")


def profile(run, film):
    """Heights, m, and velocity of the nodes along the slope, m/s: means of the rows of particles where the ends have not
    reached the film."""
    frame = last_frame(run, "layer")
    x, y = frame["position"][:, 0], frame["position"][:, 1]
    rows = np.floor(y / (film.spacing / 2)).astype(int)
    middle = (x > film.middle()[0]) & (x < film.middle()[1])
    inside = [middle & (rows == row) for row in np.unique(rows[middle]) if (middle & (rows == row)).sum() > 3]
    return (np.array([field[row].mean() for row in inside]) for field in (y, frame["grid_velocity"][:, 0]))


def flow_rows(law, run, film, tolerance):
    y, velocity = profile(run, film)
    y, velocity = np.r_[0, y, film.height], np.r_[0, velocity, velocity[-1]]
    through = np.sum((velocity[1:] + velocity[:-1]) / 2 * np.diff(y))
    yield Row(f"velocity of the surface, {law} (m/s)", velocity[-1], film.surface(), tolerance, "steady flow", relative=True)
    yield Row(f"rate of flow, {law} (m2/s)", through, film.flow(), tolerance, "steady flow", relative=True)


def draw(axes, runs, films):
    for law, film in films.items():
        y, velocity = profile(runs[law], film)
        heights = np.linspace(0, film.height, 100)
        axes.plot(velocity / film.surface(), y / film.height, ".", ms=5, label=law)
        axes.plot(film.velocity(heights) / film.surface(), heights / film.height, "k--", lw=0.8)
    axes.set(xlabel="velocity over the exact velocity of the surface (dashed: exact)", ylabel="height over the film's", xlim=(0, None))
    axes.legend()
