"""The predictors as users of numpy and scikit-learn write them: the peers of lunula-predictor. One thread.

usage: predictor.py FOLDER [NAME ...]

FOLDER holds x.f64 (rows x 8 volts) and y.f64 (rows x 3 newtons), raw little-endian doubles, row by row. Each NAME is timed and printed as a
line of JSON: {"name", "median_ns", "min_ns", "times"}. Without names they are read from standard input, a line each, and answered one by one;
`all` stands for all. The unit of `batch ..` is a sample, of all others a call.
"""

import json
import os
import sys
import time
import warnings

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402
from sklearn.linear_model import LinearRegression  # noqa: E402
from sklearn.neural_network import MLPRegressor  # noqa: E402
from sklearn.preprocessing import PolynomialFeatures  # noqa: E402

warnings.filterwarnings("ignore")  # one iteration does not converge, and need not
INPUTS, TARGETS, NODES = 8, 3, 8
folder = sys.argv[1]
x = np.fromfile(os.path.join(folder, "x.f64")).reshape(-1, INPUTS)
y = np.fromfile(os.path.join(folder, "y.f64")).reshape(-1, TARGETS)
rows = len(x)
one = x[rows // 2].copy()
random = np.random.default_rng(1)

# What is fitted once, to predict with.
pairs_i, pairs_j = np.triu_indices(INPUTS)
centre, scale = x.mean(0), x.std(0)
y_centre, y_scale = y.mean(0), y.std(0)


# Memory that is kept, its last column ones.
design_1, design_2 = np.ones((rows, INPUTS + 1)), np.ones((rows, INPUTS + len(pairs_i) + 1))


def linear_design(x):
    design_1[:, :INPUTS] = x
    return design_1


def quadratic_design(x):
    design_2[:, :INPUTS] = x
    first = INPUTS
    for i in range(INPUTS):
        np.multiply(x[:, i : i + 1], x[:, i:], out=design_2[:, first : first + INPUTS - i])
        first += INPUTS - i
    return design_2


linear_design(x), quadratic_design(x)
beta_1 = np.linalg.lstsq(design_1, y, rcond=None)[0]
beta_2 = np.linalg.lstsq(design_2, y, rcond=None)[0]
jacobian, offset = np.ascontiguousarray(beta_1[:-1]), beta_1[-1]
linear_sk = LinearRegression().fit(x, y)
features_sk = PolynomialFeatures(2, include_bias=False)
quadratic_sk = LinearRegression().fit(features_sk.fit_transform(x), y)
# The quadratic form of each target: [8, 3 x 8], upper triangles.
forms = np.zeros((INPUTS, TARGETS, INPUTS))
forms[pairs_i, :, pairs_j] = beta_2[INPUTS:-1]
forms = forms.reshape(INPUTS, TARGETS * INPUTS)
slopes, constant = beta_2[:INPUTS].T.copy(), beta_2[-1]
w, b = random.normal(size=(INPUTS, NODES)) * 0.5, random.normal(size=NODES)
v, c = random.normal(size=(NODES, TARGETS)), random.normal(size=TARGETS)
# Scaling folded into the weights, as a user who wants speed does.
w_volts = w / scale[:, None]
b_volts = b - centre @ w_volts
network_sk = MLPRegressor(hidden_layer_sizes=(NODES,), activation="tanh", max_iter=1).fit((x - centre) / scale, y)
scaled, wanted = (x - centre) / scale, (y - y_centre) / y_scale
out = np.empty((rows, TARGETS))
hidden = np.empty((rows, NODES))


def linear_numpy():
    np.matmul(x, jacobian, out=out)
    np.add(out, offset, out=out)


def quadratic_form(x):
    """(x Q_k) . x + a_k . x: far fewer numbers to write than the 44 columns."""
    inner = (x @ forms).reshape(-1, TARGETS, INPUTS)
    inner += slopes
    return np.einsum("rki,ri->rk", inner, x) + constant


def network_numpy():
    np.matmul(x, w_volts, out=hidden)
    np.add(hidden, b_volts, out=hidden)
    np.tanh(hidden, out=hidden)
    np.matmul(hidden, v, out=out)
    np.add(out, c, out=out)


def errors(w, b, v, c):
    h = scaled @ w
    h += b
    np.tanh(h, out=h)
    return h, h @ v + c - wanted


size_1 = NODES * (INPUTS + 1)
size = size_1 + TARGETS * (NODES + 1)
bias_scaled = np.column_stack([np.ones(rows), scaled])


def step(normal, gradient):
    """One damped step and the errors it leads to."""
    p = np.linalg.solve(normal + 1e-3 * rows * np.eye(size), -gradient)
    hidden_step = p[:size_1].reshape(NODES, INPUTS + 1)
    output_step = p[size_1:].reshape(TARGETS, NODES + 1)
    e = errors(w + hidden_step[:, 1:].T, b + hidden_step[:, 0], v + output_step[:, 1:].T, c + output_step[:, 0])[1]
    return float(np.vdot(e, e))


def epoch_whole():
    """MATLAB's way: the Jacobian of all errors, J^T J, a step, the errors after it."""
    h, e = errors(w, b, v, c)
    g = 1.0 - h * h
    whole = np.zeros((TARGETS, rows, size))
    gu = g[:, :, None] * bias_scaled[:, None, :]
    for k in range(TARGETS):
        np.multiply(gu, v[:, k][None, :, None], out=whole[k, :, :size_1].reshape(rows, NODES, INPUTS + 1))
        first = size_1 + k * (NODES + 1)
        whole[k, :, first] = 1.0
        whole[k, :, first + 1 : first + NODES + 1] = h
    whole = whole.reshape(-1, size)
    return step(whole.T @ whole, whole.T @ e.T.reshape(-1))


def epoch_by_target():
    """Without the columns of zeros: a target's own Jacobian at a time, in memory that is kept."""
    h, e = errors(w, b, v, c)
    g = 1.0 - h * h
    gu = g[:, :, None] * bias_scaled[:, None, :]
    own = np.empty((rows, size_1 + NODES + 1))
    own[:, size_1] = 1.0
    own[:, size_1 + 1 :] = h
    normal, gradient = np.zeros((size, size)), np.zeros(size)
    for k in range(TARGETS):
        np.multiply(gu, v[:, k][None, :, None], out=own[:, :size_1].reshape(rows, NODES, INPUTS + 1))
        first = size_1 + k * (NODES + 1)
        places = np.r_[0:size_1, first : first + NODES + 1]
        normal[np.ix_(places, places)] += own.T @ own
        gradient[places] += own.T @ e[:, k]
    return step(normal, gradient)


def epoch_shared():
    """Only what targets do not share is formed for each: sums of g g' u u', of g h u and of h h'."""
    h, e = errors(w, b, v, c)
    g = 1.0 - h * h
    gu = (g[:, :, None] * bias_scaled[:, None, :]).reshape(rows, size_1)
    h1 = np.column_stack([np.ones(rows), h])
    curved, mixed, plain = gu.T @ gu, gu.T @ h1, h1.T @ h1
    back = e @ v.T
    normal, gradient = np.zeros((size, size)), np.zeros(size)
    normal[:size_1, :size_1] = curved * np.kron(v @ v.T, np.ones((INPUTS + 1, INPUTS + 1)))
    gradient[:size_1] = ((g * back).T @ bias_scaled).reshape(-1)
    outputs = e.T @ h1
    for k in range(TARGETS):
        first = size_1 + k * (NODES + 1)
        normal[:size_1, first : first + NODES + 1] = mixed * np.repeat(v[:, k], INPUTS + 1)[:, None]
        normal[first : first + NODES + 1, :size_1] = normal[:size_1, first : first + NODES + 1].T
        normal[first : first + NODES + 1, first : first + NODES + 1] = plain
        gradient[first : first + NODES + 1] = outputs[k]
    return step(normal, gradient)


row = one[None, :]
# name: (what is called, samples a call)
JOBS = {
    "fit linear: numpy lstsq": (lambda: np.linalg.lstsq(design_1, y, rcond=None), 1),
    "fit linear: numpy design + lstsq": (lambda: np.linalg.lstsq(linear_design(x), y, rcond=None), 1),
    "fit linear: scikit-learn": (lambda: LinearRegression().fit(x, y), 1),
    "fit quadratic: numpy lstsq": (lambda: np.linalg.lstsq(design_2, y, rcond=None), 1),
    "fit quadratic: numpy design + lstsq": (lambda: np.linalg.lstsq(quadratic_design(x), y, rcond=None), 1),
    "fit quadratic: scikit-learn": (lambda: LinearRegression().fit(features_sk.fit_transform(x), y), 1),
    "batch linear: numpy": (linear_numpy, rows),
    "batch linear: scikit-learn": (lambda: linear_sk.predict(x), rows),
    "batch quadratic: numpy, 44 columns": (lambda: quadratic_design(x) @ beta_2, rows),
    "batch quadratic: numpy, forms": (lambda: quadratic_form(x), rows),
    "batch quadratic: scikit-learn": (lambda: quadratic_sk.predict(features_sk.transform(x)), rows),
    "batch network: numpy": (network_numpy, rows),
    "batch network: scikit-learn": (lambda: network_sk.predict(x), rows),
    "row linear: numpy": (lambda: one @ jacobian + offset, 1),
    "row linear: scikit-learn": (lambda: linear_sk.predict(row), 1),
    "row quadratic: numpy, forms": (lambda: quadratic_form(row), 1),
    "row quadratic: scikit-learn": (lambda: quadratic_sk.predict(features_sk.transform(row)), 1),
    "row network: numpy": (lambda: np.tanh(one @ w_volts + b_volts) @ v + c, 1),
    "row network: scikit-learn": (lambda: network_sk.predict(row), 1),
    "epoch: numpy, whole Jacobian": (epoch_whole, 1),
    "epoch: numpy, target by target": (epoch_by_target, 1),
    "epoch: numpy, shared sums": (epoch_shared, 1),
    "train network: scikit-learn L-BFGS": (
        lambda: MLPRegressor(hidden_layer_sizes=(NODES,), activation="tanh", solver="lbfgs", alpha=0.0, max_iter=1000, random_state=1).fit(
            scaled, wanted
        ),
        1,
    ),
}


def measure(name, least_s=0.05, rounds=7):
    work, samples = JOBS[name]
    start = time.perf_counter()
    work()
    once = time.perf_counter() - start
    if once > 1.0:
        times = [once]
    else:
        repeats = max(1, int(least_s / rounds / max(once, 1e-7)))
        times = []
        for _ in range(rounds):
            start = time.perf_counter()
            for _ in range(repeats):
                work()
            times.append((time.perf_counter() - start) / repeats)
    times = [1e9 * t / samples for t in times]
    print(json.dumps({"name": name, "median_ns": float(np.median(times)), "min_ns": min(times), "times": times}), flush=True)


def check():
    """The peers agree with one another; a wrong peer is no peer."""
    linear_numpy()
    assert np.allclose(out, linear_sk.predict(x))
    assert np.allclose(quadratic_form(x), quadratic_design(x) @ beta_2)
    # scikit-learn's own coefficients differ: it drops directions beyond a condition of 1e6.
    assert np.allclose(quadratic_form(x), features_sk.transform(x) @ beta_2[:-1] + beta_2[-1])
    costs = [epoch_whole(), epoch_by_target(), epoch_shared()]
    assert np.allclose(costs, costs[0], rtol=1e-8), costs


check()
names = sys.argv[2:] or (line.strip() for line in sys.stdin)
for name in names:
    for each in JOBS if name == "all" else [name]:
        measure(each)
