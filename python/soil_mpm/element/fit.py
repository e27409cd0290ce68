"""Fits parameters of a material to measured tests by least squares. Needs numpy and scipy."""

from dataclasses import dataclass

import numpy as np

from soil_mpm.element.tests import MEASURED, WrongTest, at_measured

PENALTY = 10.0  # residual where the law cannot do a test with the parameters tried, in ranges of what was measured


@dataclass
class Parameter:
    """One that is fitted: its option key without the material's name, its bounds and where the search starts."""
    key: str
    low: float
    high: float
    start: float


def parse_parameter(text, deck_value):
    """A Parameter of KEY=LOW:HIGH[:START]. deck_value: that of a key in the deck, None where it has none."""
    key, equals, bounds = text.partition("=")
    try:
        values = [float(piece) for piece in bounds.split(":")]
        if not equals or len(values) not in (2, 3) or not np.isfinite(values).all() or not values[0] < values[1]:
            raise ValueError
    except ValueError:
        raise WrongTest(f'--fit: given "{text}", takes KEY=LOW:HIGH or KEY=LOW:HIGH:START with LOW below HIGH') from None
    low, high = values[:2]
    start = values[2] if len(values) == 3 else deck_value(key)
    if len(values) == 3 and not low <= start <= high:
        raise WrongTest(f'--fit: given "{text}", takes a START between LOW and HIGH')
    if start is None or not low < start < high:
        start = np.sqrt(low * high) if low > 0 else (low + high) / 2
    return Parameter(key, low, high, float(start))


def residuals_of(test, found, measured):
    """Differences of the model and what was measured, each column over its range. Points beyond the model's course are
    left out."""
    parts = []
    for name in MEASURED[test.kind]:
        if name in measured:
            extent = np.ptp(measured[name]) or max(abs(measured[name]).max(), 1e-300)
            if found is None:
                parts.append(np.full(len(measured[name]), PENALTY))
                continue
            difference = (at_measured(test, found, measured, name) - measured[name]) / extent
            if name == "void_ratio" and np.isnan(found["void_ratio"]).all():
                raise WrongTest(f"{test.name}: takes e0=VOID_RATIO, since void ratios were measured and the law has none")
            parts.append(np.where(np.isfinite(difference), difference, 0.0))
    return np.concatenate(parts)


@dataclass
class Fit:
    parameters: list
    values: np.ndarray
    errors: np.ndarray  # standard errors; NaN where the data do not determine them
    at_bound: list
    root_mean_square: float  # of the residuals, which are parts of the ranges measured
    points: int
    runs: int


def standard_errors(jacobian, residuals):
    """Standard errors of the parameters: sqrt of the diagonal of s^2 (J^T J)^-1 with s^2 the variance of the residuals (Seber & Wild
    1989, ch. 2.1); NaN where J^T J is singular."""
    freedom = len(residuals) - jacobian.shape[1]
    _, singular, rotation = np.linalg.svd(jacobian, full_matrices=False)
    if freedom <= 0 or singular.min() <= 1e-10 * singular.max():
        return np.full(jacobian.shape[1], np.nan)
    covariance = (rotation.T / singular**2) @ rotation * (residuals @ residuals / freedom)
    return np.sqrt(np.diag(covariance))


def fit(parameters, tests, measured, run):
    """Least squares over all tests that were measured. run(values) gives the results of each test, or None where the law
    cannot do it, in the order of `tests`."""
    from scipy.optimize import least_squares
    low, high = (np.array([getattr(p, side) for p in parameters]) for side in ("low", "high"))
    start = np.array([p.start for p in parameters])
    if len(set(p.key for p in parameters)) < len(parameters):
        raise WrongTest("--fit: takes each parameter once")
    runs = 0

    def residuals(unit):
        nonlocal runs
        runs += 1
        every = run(low + unit * (high - low))
        return np.concatenate([residuals_of(test, found, data) for test, found, data in zip(tests, every, measured)
                               if data is not None])

    def jacobian(unit):
        """By central differences within the bounds: the response has corners where soil begins to yield."""
        columns = []
        for k in range(len(unit)):
            below, above = unit.copy(), unit.copy()
            below[k], above[k] = max(unit[k] - 1e-3, 0.0), min(unit[k] + 1e-3, 1.0)
            columns.append((residuals(above) - residuals(below)) / (above[k] - below[k]))
        return np.stack(columns, axis=1)

    found = least_squares(residuals, (start - low) / (high - low), jac=jacobian, bounds=(0.0, 1.0), x_scale=1.0, ftol=1e-8,
                          xtol=1e-6, gtol=1e-10, max_nfev=60)
    values = low + found.x * (high - low)
    at_bound = [bool(x < 1e-4 or x > 1 - 1e-4) for x in found.x]
    return Fit(parameters, values, standard_errors(found.jac, found.fun) * (high - low), at_bound,
               float(np.sqrt(np.mean(found.fun**2))), len(found.fun), runs)
