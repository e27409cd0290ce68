"""Random fields on a grid by circulant embedding, and their files. Needs numpy, scipy and h5py."""

import h5py
import numpy as np
from scipy.special import gamma, kv

LARGEST = 2e8  # values of an embedding
NEGATIVE = 1e-6  # of the variance: what negative eigenvalues may hold


class WrongField(Exception):
    """One line that says what a field should have been."""


def correlation(kind, r, nu=1.5):
    """Correlation at a distance r over the correlation lengths: exp(-r), exp(-r^2), or Matern's of smoothness nu
    (Rasmussen & Williams 2006, Eq. 4.14), which is exp(-r) with 1/2 and goes to exp(-r^2/2) as nu grows."""
    r = np.asarray(r, dtype=float)
    if kind == "exponential":
        return np.exp(-r)
    if kind == "gaussian":
        return np.exp(-r ** 2)
    scaled = np.sqrt(2 * nu) * np.where(r > 0, r, 1)
    return np.where(r > 0, 2 ** (1 - nu) / gamma(nu) * scaled ** nu * kv(nu, scaled), 1.0)


def embedding(shape, spacing, lengths, kind, nu):
    """Square roots of the eigenvalues of a circulant matrix whose part is the covariance matrix of the grid (Dietrich & Newsam
    1997), on the smallest of a row of larger and larger grids where none of them is negative."""
    size = [max(2 * (n - 1), 1) for n in shape]
    while np.prod(size, dtype=float) <= LARGEST:
        distances = [np.minimum(np.arange(n), n - np.arange(n)) * h / length
                     for n, h, length in zip(size, spacing, lengths)]
        r = np.sqrt(sum(d ** 2 for d in np.meshgrid(*distances, indexing="ij", sparse=True)))
        values = np.fft.fftn(correlation(kind, r, nu)).real
        if -values[values < 0].sum() <= NEGATIVE * values.sum():
            return np.sqrt(np.maximum(values, 0))
        size = [n if n == 1 else int(np.ceil(1.5 * n / 2) * 2) for n in size]
    raise WrongField("--length: takes lengths of fewer grids, or a larger --spacing: the embedding has more than "
                     f"{LARGEST:g} values")


class Field:
    """Makes fields of one kind. shape and spacing, lengths by axis x, y, z."""

    def __init__(self, shape, spacing, lengths, mean, deviation, kind="exponential", nu=1.5, lognormal=False):
        self.shape = tuple(shape)
        self.root = embedding(shape, spacing, lengths, kind, nu)
        # a lognormal field is exp of a Gaussian one, which has the correlation asked for
        self.lognormal = lognormal
        self.deviation = np.sqrt(np.log1p((deviation / mean) ** 2)) if lognormal else deviation
        self.mean = np.log(mean) - self.deviation ** 2 / 2 if lognormal else mean

    def make(self, seed):
        """values[i, j, k] at x, y, z of the grid; the same for the same seed and grid."""
        random = np.random.Generator(np.random.PCG64(seed))
        noise = random.standard_normal(self.root.shape) + 1j * random.standard_normal(self.root.shape)
        whole = np.fft.fftn(self.root * noise).real / np.sqrt(self.root.size)
        values = self.mean + self.deviation * whole[tuple(slice(n) for n in self.shape)]
        return np.exp(values) if self.lognormal else values


def write_field(path, name, values, lower, spacing, notes=()):
    """A dataset `name` with the vertical axis first and x last, the place of its first value in the attribute `lower` and the
    distance of its values in `spacing` [m], by axis x, y, z. Other datasets of the file stay."""
    with h5py.File(path, "a") as file:
        if name in file:
            del file[name]
        data = file.create_dataset(name, data=np.ascontiguousarray(values.T, dtype=np.float64))
        data.attrs["lower"], data.attrs["spacing"] = np.asarray(lower, float), np.asarray(spacing, float)
        for key, value in dict(notes).items():
            data.attrs[key] = value


def read_field(path, name):
    """values[i, j, k], lower and spacing by axis."""
    with h5py.File(path) as file:
        data = file[name]
        return data[()].T, np.asarray(data.attrs["lower"]), np.asarray(data.attrs["spacing"])
