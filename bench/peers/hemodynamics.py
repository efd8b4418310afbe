"""The step responses of Fig. 76 and 77 by the solvers that others use: the peers of lunula-hemodynamics. One thread.

usage: hemodynamics.py [--quick] [--out FILE] [--reference FOLDER] [SOLVER ...]

Twenty responses (P_F1 alone and P_F1 = P_F2, ten loads each) of 4 s with 400 outputs, from the rest equilibrium, the load acting until 2 s, where
every solver is restarted. All get the same equations (in conductances, states scaled by nominal diameters), the analytic Jacobian and the same
tolerances: rtol on every state, absolutely rtol D on lumens and 10 rtol D/s on rates (as large as rates get) or, "loose rates", 1e4 rtol D/s: whoever
wants lumens only gets them up to twice as fast. A row of CSV for each solver and rtol:

    solver,rtol,error,microseconds,evaluations

error: the greatest |x - x_ref| / D over the reference's times, all walls and responses. microseconds: a response, the fastest of several rounds over
all of them. evaluations: of the right-hand side, a response.

FOLDER holds other responses to be compared with: `proximal.csv`, `distal.csv`, `both.csv` or some of them, a row
load_Pa,time_s,C1,C2,V of displacements over nominal diameters for each load and time, 0 and 2 s among them.

Native solvers, where the machine has them (a C compiler for all): CVODE of Debian's libsundials-dev; RADAU5 and LSODA of r-cran-desolve. The others
call back into Python. A solver is left out at tolerances at which it would take too long, with a word on standard error.
"""

import argparse
import ctypes
import os
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402
from scipy.integrate import odeint, solve_ivp  # noqa: E402

warnings.filterwarnings("ignore")  # a solver's complaints; its errors count
HERE = Path(__file__).resolve().parent
PATHS = {"proximal": lambda load: (load, 0.0), "distal": lambda load: (0.0, load), "both": lambda load: (load, load)}
DESOLVE = [Path("/usr/lib/R/site-library/deSolve/libs/deSolve.so"), Path("/usr/local/lib/R/site-library/deSolve/libs/deSolve.so")]
HALF_S = 2.0
OUTPUTS = np.arange(1, 201) / 100.0  # of each half
QUICK = [1e-4, 1e-6, 1e-9, 1e-12]
TOLERANCES = [float(f"1e-{k}") for k in range(3, 13)]
RATES = {"": 10.0, " loose rates": 1e4}  # absolute tolerances by rtol, D/s
BUDGET_S = 10.0  # for all responses of a solver at one rtol

# The thesis' table: C1, C2, V.
k, m, b = np.array([1e5, 1e5, 1e3]), np.full(3, 1e-3), np.array([1e4, 1e4, 1e2])
A, D, L, count = np.full(3, 1e-4), np.array([1e-5, 1e-5, 1e-4]), np.array([1e-3, 1e-3, 1e-2]), np.array([1e5, 1e5, 1e2])
venule, mu, upstream, downstream = np.full(2, 1e11), 3e-3, 1e4, 0.0
push, spring, damper, swept = A / (m * D), k / m, b / m, A * D
conductance = count * np.pi * D**4 / (128 * L * mu)


# ---- the model for callbacks: plain floats are faster than arrays of three ----
P1, P2, P3 = push.tolist()
S1, S2, S3 = spring.tolist()
B1, B2, B3 = damper.tolist()
W1, W2, W3 = swept.tolist()
C1, C2, C3 = conductance.tolist()
R1, R2 = venule.tolist()


def right(y, pf1, pf2):
    d1, d2, d3, w1, w2, w3 = y
    g1, g2, g3 = C1 * (d1 * d1) * (d1 * d1), C2 * (d2 * d2) * (d2 * d2), C3 * (d3 * d3) * (d3 * d3)
    t1, t2 = 1 / (1 + g1 * R1), 1 / (1 + g2 * R2)
    f1, f2 = (g1 * upstream - W1 * w1) * t1, (g2 * upstream - W2 * w2) * t2
    p = (f1 + f2 + g3 * downstream - W3 * w3) / (g1 * t1 + g2 * t2 + g3)
    return (
        w1,
        w2,
        w3,
        P1 * (R1 * f1 + p * t1) - S1 * (d1 - 1) - B1 * w1,
        P2 * (R2 * f2 + p * t2 - pf2) - S2 * (d2 - 1) - B2 * w2,
        P3 * (p - pf1) - S3 * (d3 - 1) - B3 * w3,
    )


def jacobian(y):
    d1, d2, d3, w1, w2, w3 = (float(v) for v in y)
    g1, g2, g3 = C1 * (d1 * d1) * (d1 * d1), C2 * (d2 * d2) * (d2 * d2), C3 * (d3 * d3) * (d3 * d3)
    t1, t2 = 1 / (1 + g1 * R1), 1 / (1 + g2 * R2)
    total = g1 * t1 + g2 * t2 + g3
    p = ((g1 * upstream - W1 * w1) * t1 + (g2 * upstream - W2 * w2) * t2 + g3 * downstream - W3 * w3) / total
    e1, e2 = (upstream - p + R1 * W1 * w1) * t1 * 4 * g1 / d1, (upstream - p + R2 * W2 * w2) * t2 * 4 * g2 / d2
    l1, l2, l3 = e1 * t1 / total, e2 * t2 / total, -4 * g3 / d3 * (p - downstream) / total
    r1, r2, r3 = -W1 * t1 / total, -W2 * t2 / total, -W3 / total
    x1, x2 = P1 * t1, P2 * t2
    return [
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        [x1 * l1 + P1 * R1 * e1 * t1 - S1, x1 * l2, x1 * l3, x1 * r1 - P1 * R1 * W1 * t1 - B1, x1 * r2, x1 * r3],
        [x2 * l1, x2 * l2 + P2 * R2 * e2 * t2 - S2, x2 * l3, x2 * r1, x2 * r2 - P2 * R2 * W2 * t2 - B2, x2 * r3],
        [P3 * l1, P3 * l2, P3 * l3 - S3, P3 * r1, P3 * r2, P3 * r3 - B3],
    ]


# ---- options, and the reference ----
parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("solvers", nargs="*", help="only those whose names begin with one of these")
parser.add_argument("--quick", action="store_true", help="four tolerances, few rounds, a second a solver")
parser.add_argument("--budget", type=float, help="seconds for all responses of a solver at one tolerance; slower: no tighter ones")
parser.add_argument("--out", type=Path, help="a CSV file; else standard output")
parser.add_argument("--reference", type=Path, help="a folder of other responses")
OPTIONS = parser.parse_args()
REFERENCE = OPTIONS.reference or HERE.parents[1] / "crates" / "hemodynamics" / "tests" / "reference"


def reference():
    """Loads (P_F1, P_F2), times, lumens [case, time, wall] of all responses."""
    loads, lumens, times = [], [], None
    for name in PATHS if OPTIONS.reference else ("proximal", "both"):
        if not (REFERENCE / f"{name}.csv").exists():
            continue
        of = PATHS[name]
        rows = [line.split(",") for line in (REFERENCE / f"{name}.csv").read_text().splitlines() if line[0].isdigit()]
        values = np.array(rows, dtype=float)
        for load in np.unique(values[:, 0]):
            part = values[values[:, 0] == load]
            loads.append(of(load))
            lumens.append(1 + part[:, 2:5])
            times = part[:, 1]
    return np.array(loads), times, np.array(lumens)


LOADS, TIMES, LUMENS = reference()
REST = np.concatenate([LUMENS[0, 0], np.zeros(3)])
FIRST = TIMES[(TIMES > 0) & (TIMES <= HALF_S)]
SECOND = TIMES[TIMES > HALF_S] - HALF_S


# ---- solvers through Python: one interval, states at `times` (the last is its end) ----
class Calls:
    count = 0


def absolute(rtol, rates):
    return rtol * np.array([1.0, 1.0, 1.0, rates, rates, rates])


def of_scipy(method):
    def interval(y, pf1, pf2, times, rtol, atol):
        def fun(t, y):
            Calls.count += 1
            return right(y.tolist(), pf1, pf2)

        found = solve_ivp(fun, (0, HALF_S), y, method=method, t_eval=times, rtol=rtol, atol=atol, jac=lambda t, y: np.array(jacobian(y)))
        if not found.success:
            raise RuntimeError(found.message)
        return found.y.T

    return interval


def by_odeint(y, pf1, pf2, times, rtol, atol):
    def fun(y, t):
        Calls.count += 1
        return right(y.tolist(), pf1, pf2)

    grid = np.concatenate([[0.0], times])
    found, info = odeint(
        fun, y, grid, Dfun=lambda y, t: jacobian(y), rtol=rtol, atol=atol, tcrit=[HALF_S], mxstep=1000000, full_output=True
    )
    if info["message"] != "Integration successful.":
        raise RuntimeError(info["message"])
    return found[1:]


def by_sundae():
    from sksundae.cvode import CVODE

    def interval(y, pf1, pf2, times, rtol, atol):
        def fun(t, y, f):
            Calls.count += 1
            f[:] = right(y.tolist(), pf1, pf2)

        def jac(t, y, f, j):
            j[:, :] = jacobian(y)

        solver = CVODE(fun, rtol=rtol, atol=atol, method="BDF", jacfn=jac, max_num_steps=1000000)
        found = solver.solve(np.concatenate([[0.0], times]), y)
        if not found.success:
            raise RuntimeError(found.message)
        return found.y[1:]

    return interval


class Python:
    def __init__(self, interval):
        self.interval = interval

    def run(self, rtol, rates, first, second):
        """Of all responses, with the calls of the right-hand side: [case, time, 6]."""
        Calls.count, out, atol = 0, [], absolute(rtol, rates)
        for pf1, pf2 in LOADS:
            a = self.interval(REST, pf1, pf2, first, rtol, atol)
            out.append(np.concatenate([a, self.interval(a[-1], 0.0, 0.0, second, rtol, atol)]))
        return np.array(out), Calls.count


# ---- native solvers ----
def build(folder):
    """The C program as a library, with CVODE where it is installed: (library, has CVODE), or None without a compiler."""
    compiler = next((c for c in (os.environ.get("CC"), "cc", "gcc", "clang") if c and shutil.which(c)), None)
    if compiler is None:
        return None
    target = Path(folder) / "hemodynamics.so"
    base = [compiler, "-O3", "-march=native", "-shared", "-fPIC", "-w", "-o", str(target), str(HERE / "hemodynamics.c")]
    libraries = ["-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunmatrixdense", "-lsundials_sunlinsoldense", "-lm"]
    for has_cvode, options in ((True, libraries), (False, ["-DNO_CVODE", "-lm"])):
        done = subprocess.run(base + options, capture_output=True, text=True)
        if done.returncode == 0:
            return ctypes.CDLL(str(target)), has_cvode
    print(done.stderr, file=sys.stderr)
    return None


class Native:
    def __init__(self, library, solver):
        self.native, self.solver = library, solver

    def run(self, rtol, rates, first, second):
        out = np.empty((len(LOADS), len(first) + len(second), 6))
        pointer = lambda v: np.ascontiguousarray(v, dtype=float).ctypes.data_as(ctypes.POINTER(ctypes.c_double))  # noqa: E731
        loads = [np.ascontiguousarray(LOADS[:, 0]), np.ascontiguousarray(LOADS[:, 1])]
        atol = absolute(rtol, rates)
        fault = self.native.responses(
            self.solver, len(LOADS), pointer(loads[0]), pointer(loads[1]), pointer(REST), ctypes.c_double(HALF_S), ctypes.c_double(rtol),
            pointer(atol), len(first), pointer(first), len(second), pointer(second), pointer(out),
        )  # fmt: skip
        if fault:
            raise RuntimeError(f"stopped with {fault}")
        return out, self.native.evaluations()


def native(folder):
    """Of what the machine has, by name."""
    built = build(folder)
    if built is None:
        print("no C compiler: no native solvers", file=sys.stderr)
        return {}
    library, has_cvode = built
    library.evaluations.restype = ctypes.c_long
    p = np.concatenate([push, spring, damper, swept, conductance, venule, [upstream, downstream]])
    library.parameters(p.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
    check(library)
    found = {}
    desolve = next((path for path in DESOLVE if path.exists()), None)
    if desolve is None:
        print("no r-cran-desolve: no native RADAU5 and LSODA", file=sys.stderr)
    else:
        fortran = ctypes.CDLL(str(desolve), mode=ctypes.RTLD_GLOBAL)
        library.solvers(*[ctypes.cast(getattr(fortran, n), ctypes.c_void_p) for n in ("dlsoda_", "radau5_", "contr5_")])
        found["RADAU5 (Fortran)"], found["LSODA (Fortran)"] = Native(library, 1), Native(library, 0)
    if has_cvode:
        found["CVODE (C)"] = Native(library, 2)
    else:
        print("no libsundials-dev (or another version than 6 or 7): no native CVODE", file=sys.stderr)
    return found


def check(library):
    """The models are one: a wrong peer is no peer."""
    y = [1.9, 0.3, 0.8, 3.0, -8.0, 1.5]
    f, pd, state = np.empty(6), np.empty(36), np.array(y)
    double = ctypes.POINTER(ctypes.c_double)
    library.at(state.ctypes.data_as(double), ctypes.c_double(3e3), ctypes.c_double(5e3), f.ctypes.data_as(double), pd.ctypes.data_as(double))
    of_python = np.array(jacobian(y))
    assert np.allclose(f, right(y, 3e3, 5e3), rtol=1e-12)
    assert np.allclose(pd.reshape(6, 6).T, of_python, rtol=1e-12)
    for j in range(6):
        step = 1e-6 * y[j]
        up, down = list(y), list(y)
        up[j], down[j] = y[j] + step, y[j] - step
        slope = (np.array(right(up, 3e3, 5e3)) - np.array(right(down, 3e3, 5e3))) / (2 * step)
        assert np.allclose(slope, of_python[:, j], rtol=1e-6, atol=1e-6 * abs(of_python[:, j]).max())


# ---- measuring ----
def measure(solver, rtol, rates, rounds):
    states, _ = solver.run(rtol, rates, FIRST, SECOND)
    wanted = LUMENS[:, 1:]
    error = np.abs(states[:, :, :3] - wanted).max()
    times = []
    while len(times) < rounds and (not times or sum(times) < 1.0):
        start = time.perf_counter()
        _, calls = solver.run(rtol, rates, OUTPUTS, OUTPUTS)
        times.append(time.perf_counter() - start)
    return error, min(times), calls


def course(name, solver, rates, quick):
    """A solver at all tolerances; through Python, until one takes longer than its share of the time."""
    rows = []
    for rtol in QUICK if quick else TOLERANCES:
        start = time.perf_counter()
        try:
            error, seconds, calls = measure(solver, rtol, rates, 5 if quick else 15)
        except RuntimeError as fault:
            print(f"{name} at {rtol:.0e}: {fault}", file=sys.stderr)
            continue
        rows.append(f"{name},{rtol:.0e},{error:.3e},{1e6 * seconds / len(LOADS):.1f},{calls / len(LOADS):.0f}")
        print(rows[-1], flush=True)
        used = time.perf_counter() - start
        if isinstance(solver, Python) and used > (OPTIONS.budget or (2.0 if quick else BUDGET_S)):
            print(f"{name} beyond {rtol:.0e}: left out, this took {used:.0f} s", file=sys.stderr)
            break
    return rows


def main():
    rows = ["solver,rtol,error,microseconds,evaluations"]
    print(rows[0], flush=True)
    with tempfile.TemporaryDirectory() as folder:
        solvers = native(folder)
        try:
            solvers["CVODE (scikit-sundae)"] = Python(by_sundae())
        except ImportError:
            print("no scikit-sundae: left out", file=sys.stderr)
        solvers["LSODA (SciPy odeint)"] = Python(by_odeint)
        for method in ("LSODA", "BDF", "Radau"):
            solvers[f"{method} (SciPy)"] = Python(of_scipy(method))
        for name, solver in solvers.items():
            if OPTIONS.solvers and not any(name.startswith(s) for s in OPTIONS.solvers):
                continue
            for kind, rates in RATES.items():
                rows += course(name + kind, solver, rates, OPTIONS.quick)
    if OPTIONS.out:
        OPTIONS.out.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
