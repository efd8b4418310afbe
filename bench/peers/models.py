"""Models of force as users of numpy and scikit-learn fit them: the peers on the curves of `lunula tradeoff predictor`. One thread.

usage: models.py FOLDER INPUTS TARGETS REPEATS

FOLDER holds raw little-endian doubles, row by row: train_x.f64 and test_x.f64 (volts), train_y.f64 (newtons), and problems with an exact
solution, exact_NAME_x.f64 and exact_NAME_y.f64. A line of JSON each:

    {"name", "fit_s": [..], "row_s": [..], "predicted": FILE}       FILE: raw doubles, a row for each of test_x
    {"name", "problem": NAME, "fit_s": [..], "coefficients": FILE}  FILE: raw doubles, TARGETS x INPUTS, then the offsets

fit_s: seconds of a fit. row_s: of a prediction of one row, on average.
"""

import json
import os
import sys
import time
import warnings
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402
from sklearn.linear_model import LinearRegression  # noqa: E402
from sklearn.neural_network import MLPRegressor  # noqa: E402
from sklearn.pipeline import make_pipeline  # noqa: E402
from sklearn.preprocessing import PolynomialFeatures, StandardScaler  # noqa: E402

warnings.filterwarnings("ignore")  # a fit that has not converged after all its iterations; its error counts
FOLDER = Path(sys.argv[1])
INPUTS, TARGETS, REPEATS = (int(word) for word in sys.argv[2:5])
ONE_BY_ONE = 500  # rows that are predicted singly
SLOW_S = 5.0  # a fit that takes so long is done once


def read(name, columns):
    return np.fromfile(FOLDER / f"{name}.f64").reshape(-1, columns)


def design(x):
    return np.column_stack([x, np.ones(len(x))])


def lstsq(x, y):
    beta = np.linalg.lstsq(design(x), y, rcond=None)[0]
    slopes, offset = np.ascontiguousarray(beta[:-1]), beta[-1]
    return lambda rows: rows @ slopes + offset


def network(nodes):
    """Scaled as its users scale it, by the optimizer that suits least squares of this size best."""
    inner = MLPRegressor(hidden_layer_sizes=(nodes,), activation="tanh", solver="lbfgs", alpha=0.0, max_iter=1000, random_state=1)
    return make_pipeline(StandardScaler(), inner)


def timed(work):
    """Seconds of each repeat, and what came out."""
    times = []
    while len(times) <= REPEATS and (not times or times[0] < SLOW_S):
        start = time.perf_counter()
        out = work()
        times.append(time.perf_counter() - start)
    # The first warms up.
    return times[1:] or times, out


def tell(**facts):
    print(json.dumps(facts), flush=True)


MODELS = {
    "numpy lstsq, linear": lstsq,
    "scikit-learn, linear": lambda x, y: LinearRegression().fit(x, y).predict,
    "scikit-learn, quadratic": lambda x, y: make_pipeline(PolynomialFeatures(2, include_bias=False), LinearRegression()).fit(x, y).predict,
    "scikit-learn, network of 8": lambda x, y: network(8).fit(x, y).predict,
}
train_x, train_y, test_x = read("train_x", INPUTS), read("train_y", TARGETS), read("test_x", INPUTS)
for k, (name, fit) in enumerate(MODELS.items()):
    fit_s, predict = timed(lambda: fit(train_x, train_y))
    rows = [test_x[at : at + 1] for at in range(min(ONE_BY_ONE, len(test_x)))]
    row_s, _ = timed(lambda: [predict(row) for row in rows])
    file = f"predicted_{k}.f64"
    np.ascontiguousarray(predict(test_x)).tofile(FOLDER / file)
    tell(name=name, fit_s=fit_s, row_s=[t / len(rows) for t in row_s], predicted=file)


def normal(x, y):
    """Equation 11 as it stands."""
    a = design(x)
    return np.linalg.solve(a.T @ a, a.T @ y)


def of_sklearn(x, y):
    fitted = LinearRegression().fit(x, y)
    return np.vstack([fitted.coef_.T, fitted.intercept_])


SOLVERS = {
    "numpy lstsq": lambda x, y: np.linalg.lstsq(design(x), y, rcond=None)[0],
    "numpy solve, normal equations (11)": normal,
    "scikit-learn": of_sklearn,
}
for path in sorted(FOLDER.glob("exact_*_x.f64")):
    problem = path.name[len("exact_") : -len("_x.f64")]
    x, y = read(f"exact_{problem}_x", INPUTS), read(f"exact_{problem}_y", TARGETS)
    for k, (name, solve) in enumerate(SOLVERS.items()):
        try:
            fit_s, beta = timed(lambda: solve(x, y))
        except np.linalg.LinAlgError as why:
            print(f"{name}, {problem}: {why}", file=sys.stderr)
            continue
        file = f"solved_{problem}_{k}.f64"
        np.concatenate([beta[:-1].T.ravel(), beta[-1]]).tofile(FOLDER / file)
        tell(name=name, problem=problem, fit_s=fit_s, coefficients=file)
