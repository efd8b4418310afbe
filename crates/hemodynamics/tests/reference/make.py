"""Writes the reference tables beside this file.

usage: make.py [trajectories] [equilibria] [special] [check]      (without a name: all)

Needs mpmath, gmpy2 and numpy. See README.md for the tables and for how far they can be trusted.
"""

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from fractions import Fraction
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[variable] = "1"

import gmpy2  # noqa: E402
import mpmath  # noqa: E402
from gmpy2 import mpfr  # noqa: E402

import check  # noqa: E402
from equilibria import equilibria, leading  # noqa: E402
from model import Parameters  # noqa: E402
from responses import PLANS, TIMES, crossing, sampled, with_contact  # noqa: E402

HERE = Path(__file__).parent
PROCESSES = 2
STEPS_PA = range(1000, 10001, 1000)
FAMILIES = {
    "proximal": ("Fig. 76: P_F1 alone", lambda load: (load, 0)),
    "both": ("Fig. 77: P_F1 = P_F2", lambda load: (load, load)),
    "distal": ("P_F2 alone", lambda load: (0, load)),
}
WALLS = ("C1", "C2", "V")
COMMON = [
    "The network of Fig. 70 with the thesis' table taken literally (exact powers of ten, mu = 3e-3 Pa s, P_H = 1e4 Pa, P_L = 0).",
    "Made by make.py beside this file; README.md says how.",
]
STATES = "xC1_per_D,xC2_per_D,xV_per_D,vC1_mps,vC2_mps,vV_mps"
RESPONSE = [
    "The load acts from t = 0 to 2 s; the start is the rest equilibrium of no load. x / D is the wall's displacement by its own nominal diameter.",
    "Times are the doubles nearest to what is printed, exactly. The rows of 2 s belong to both loads (states are continuous).",
]


def decimals(x, digits):
    """x rounded to so many decimals."""
    whole = int(gmpy2.rint(x * mpfr(10) ** digits))
    text = str(abs(whole)).rjust(digits + 1, "0")
    return ("-" if whole < 0 else "") + text[:-digits] + "." + text[-digits:]


def figures(x, digits):
    """x rounded to so many significant digits."""
    return mpmath.nstr(mpmath.mpf(str(x)), digits, strip_zeros=False, min_fixed=0, max_fixed=0) if x else "0"


def states(u, w, p):
    """The six columns of STATES."""
    return [decimals(x - 1, 25) for x in u] + [figures(x * mpfr(d), 18) for x, d in zip(w, p.D)]


def write(name, head, columns, rows):
    lines = ["# " + line for line in COMMON + head] + [columns] + [",".join(str(v) for v in row) for row in rows]
    (HERE / name).write_text("\n".join(lines) + "\n")
    print(f"{name}: {len(rows)} rows", flush=True)


def gap(first, second):
    """The greatest difference of two runs: of x / D, and of dx/dt in D / s."""
    pairs = [(a, b) for one, other in zip(first, second) for a, b in zip(one, other)]
    return [max(abs(x - y) for a, b in pairs[k::2] for x, y in zip(a, b)) for k in (0, 1)]


def agreement(gaps, smallest):
    return (
        f"Radau IIA of {PLANS[0].stages} and {PLANS[1].stages} stages on other steps differ by at most {float(max(g[0] for g in gaps)):.1e} D, and "
        f"{float(max(g[1] for g in gaps)):.1e} D/s in velocities; smallest lumen {float(smallest):.6f} D."
    )


def trajectory(job):
    pf1, pf2 = job
    runs = [sampled(pf1, pf2, plan) for plan in PLANS]
    return runs[0][0], gap(runs[0][0], runs[1][0]), runs[0][1]


def trajectories(pool):
    p = Parameters()
    for family, (title, loads) in FAMILIES.items():
        results = list(pool.map(trajectory, [loads(load) for load in STEPS_PA]))
        head = [title + ".", *RESPONSE, agreement([r[1] for r in results], min(r[2] for r in results)), "No case of these collapses."]
        rows = [[load, repr(t), *states(u, w, p)] for load, r in zip(STEPS_PA, results) for t, (u, w) in zip(TIMES, r[0])]
        write(family + ".csv", head, "load_Pa,time_s," + STATES, rows)


def crossings(job):
    pf1, plan = job
    return crossing(pf1, 0, 2, PLANS[plan])


def contact(plan):
    return with_contact(20000, 0, PLANS[plan])


def special(pool):
    p = Parameters()
    near = mpfr("10858.037")
    runs = [pool.submit(sampled, 0, near, plan) for plan in PLANS]
    contacts = [pool.submit(contact, k) for k in (0, 1)]
    loads = (12000, 20000, 100000)
    times = list(pool.map(crossings, [(load, plan) for load in loads for plan in (0, 1)]))
    runs = [r.result() for r in runs]
    head = ["P_F2 = 10858.037 Pa alone: just before the distal capillary closes.", *RESPONSE, agreement([gap(runs[0][0], runs[1][0])], runs[0][1])]
    write("near_collapse.csv", head, "load_Pa,time_s," + STATES, [["10858.037", repr(t), *states(u, w, p)] for t, (u, w) in zip(TIMES, runs[0][0])])
    first, second = [c.result() for c in contacts]
    apart = max(abs(a[0] - b[0]) for a, b in zip(first[1], second[1]))
    head = [
        "P_F1 = 2e4 Pa with the contact law: each wall's force is raised by k D (0.05 D / d - 1)^3 where d < 0.05 D.",
        *RESPONSE,
        agreement([gap(first[0], second[0])], min(x for u, _ in first[0] for x in u)),
        f"Where the law sets in and stops (the runs differ by at most {float(apart):.1e} s):",
        *[f"  {WALLS[wall]} {'on' if on else 'off'} at {decimals(at, 25)} s" for at, wall, on in first[1]],
    ]
    write("contact.csv", head, "load_Pa,time_s," + STATES, [["20000", repr(t), *states(u, w, p)] for t, (u, w) in zip(TIMES, first[0])])
    pairs = list(zip(times[::2], times[1::2]))
    head = [
        "When the vein's lumen reaches zero after a step to P_F1 at t = 0 from the rest equilibrium, the network's equations unchanged.",
        f"Two runs differ by at most {float(max(abs(a - b) for a, b in pairs)):.1e} s.",
    ]
    write("crossings.csv", head, "pf1_Pa,time_s", [[load, decimals(a, 25)] for load, (a, _) in zip(loads, pairs)])


def at_rest(job):
    name, factors, pf1, pf2 = job
    p = Parameters(**factors)
    found = equilibria(p, Fraction(pf1), Fraction(pf2))
    rows = [[name, pf1, pf2, len(found), i, *[figures(x, 30) for x in u], f"{leading(p, u, pf1, pf2):.5e}"] for i, u in enumerate(found)]
    return rows or [[name, pf1, pf2, 0, "", "", "", "", ""]]


COLUMNS = "pf1_Pa,pf2_Pa,count,index,dC1_per_D,dC2_per_D,dV_per_D,leading_per_s"
REST = [
    "All equilibria with open lumens (d = D + x > 0), `count` of them, by the first lumen; none missed, none spurious: zeros of one polynomial, isolated",
    "in exact integers, as equilibria.py shows. Loads without one have a row of empty cells. 30 digits. `leading_per_s` is the rightmost eigenvalue's",
    "real part, in doubles: negative is stable.",
]


def at_loads(pool):
    jobs = [("", {}, *loads(load)) for _, loads in FAMILIES.values() for load in range(0, 10901, 100)]
    rows = [row for rows in pool.map(at_rest, jobs, chunksize=5) for row in rows]
    write("equilibria.csv", REST, COLUMNS, [row[1:] for row in rows])
    jobs = [("k_C / 2", {"k_C": Fraction(1, 2)}, 0, load) for load in range(0, 6001, 200)]
    jobs += [("R_Vi x 10", {"R": 10}, 0, load) for load in range(0, 11001, 250)]
    rows = [row for rows in pool.map(at_rest, jobs, chunksize=5) for row in rows]
    head = ["One entry of the table changed: capillary stiffnesses k_C1, k_C2 halved, or venule resistances R_V1, R_V2 ten times as large."]
    write("bistable.csv", head + REST, "set," + COLUMNS, rows)


if __name__ == "__main__":
    wanted = sys.argv[1:] or ["trajectories", "equilibria", "special", "check"]
    jobs = {"trajectories": trajectories, "equilibria": at_loads, "special": special, "check": lambda pool: check.main()}
    with ProcessPoolExecutor(PROCESSES) as pool:
        for name in wanted:
            jobs[name](pool)
