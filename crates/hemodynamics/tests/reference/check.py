"""Two windows of one trajectory by methods that share nothing with the collocation but the equations."""

import gmpy2
import numpy as np
from gmpy2 import mpfr

from collocation import Collocation
from model import Model, Parameters, external
from responses import PLANS, rest

LOAD = 5000
ORDER, TAYLOR_STEP, TAYLOR_END = 40, 1e-7, 1e-5
LEVELS, BASIC, EULER_START, EULER_STEPS = 18, "5e-4", "0.1", 4


class Series:
    """A power series in time, cut off: enough arithmetic for the network."""

    def __init__(self, terms):
        self.terms = terms

    def _other(self, other):
        return other.terms if isinstance(other, Series) else [mpfr(other)] + [mpfr(0)] * (len(self.terms) - 1)

    def __add__(self, other):
        return Series([a + b for a, b in zip(self.terms, self._other(other))])

    def __sub__(self, other):
        return Series([a - b for a, b in zip(self.terms, self._other(other))])

    def __rsub__(self, other):
        return Series([b - a for a, b in zip(self.terms, self._other(other))])

    def __mul__(self, other):
        if not isinstance(other, Series):
            return Series([a * other for a in self.terms])
        a, b = self.terms, other.terms
        return Series([gmpy2.fsum([a[k] * b[n - k] for k in range(n + 1)]) for n in range(len(a))])

    def __truediv__(self, other):
        b, out = other.terms, []
        for n, a in enumerate(self.terms):
            out.append((a - gmpy2.fsum([out[k] * b[n - k] for k in range(n)])) / b[0])
        return Series(out)

    __radd__, __rmul__ = __add__, __mul__


def taylor(p, u, w, outside):
    """From t = 0 to TAYLOR_END by Taylor series of order ORDER: inside the walls' layer, where 1e-7 s is the time scale."""
    model = Model(p)
    outside = [mpfr(x) for x in outside]
    h, end = mpfr(TAYLOR_STEP) / 4, mpfr(TAYLOR_END)
    steps = int(gmpy2.ceil(end / h))
    h = end / steps
    for _ in range(steps):
        us, ws = [[x] for x in u], [[x] for x in w]
        for n in range(ORDER):
            acceleration = model.acceleration([Series(x) for x in us], [Series(x) for x in ws], outside)
            for j in range(3):
                us[j].append(ws[j][n] / (n + 1))
                ws[j].append(acceleration[j].terms[n] / (n + 1))
        power = [h**n for n in range(ORDER + 1)]
        u = [gmpy2.fsum([a * b for a, b in zip(x, power)]) for x in us]
        w = [gmpy2.fsum([a * b for a, b in zip(x, power)]) for x in ws]
    return u, w


def euler(model, double, u, w, h, steps, outside):
    """Implicit Euler, each step by Newton to 1e-50."""
    start = [float(x) for x in outside]
    for _ in range(steps):
        new = list(w)
        for _ in range(40):
            position = [a + h * b for a, b in zip(u, new)]
            rest = [a + h * f - b for a, b, f in zip(w, new, model.acceleration(position, new, outside))]
            size = max(abs(x) for x in rest)
            if size < mpfr("1e-52"):
                break
            matrix = np.eye(3)
            for j in range(3):
                shifted = [complex(x) for x in new]
                shifted[j] += 1e-100j
                moved = [complex(a) + float(h) * b for a, b in zip(u, shifted)]
                matrix[:, j] -= float(h) * np.array(double.acceleration(moved, shifted, start)).imag / 1e-100
            change = np.linalg.solve(matrix, [float(x / size) for x in rest])
            new = [a + mpfr(float(c)) * size for a, c in zip(new, change)]
        u, w = [a + h * b for a, b in zip(u, new)], new
    return u, w


def extrapolated(p, u, w, outside):
    """EULER_STEPS basic steps on the slow part by implicit Euler, extrapolated over 1, 2, 3 .. LEVELS parts."""
    model, double = Model(p), Model(p, number=float)
    outside, h = [mpfr(x) for x in outside], mpfr(BASIC)
    for _ in range(EULER_STEPS):
        table = []
        for n in range(1, LEVELS + 1):
            row = [sum(euler(model, double, u, w, h / n, n, outside), [])]
            for k, above in enumerate(table[-1] if table else []):
                ratio = mpfr(n) / (n - k - 1) - 1
                row.append([a + (a - b) / ratio for a, b in zip(row[k], above)])
            table.append(row)
        u, w = table[-1][-1][:3], table[-1][-1][3:]
    return u, w


def main():
    p = Parameters()
    outside = external(LOAD, 0)
    u, w = rest(p)
    radau = Collocation(p, PLANS[0])
    layer = radau.advance(u, w, 0, mpfr(TAYLOR_END), outside)
    gaps = [max(abs(a - b) for a, b in zip(x, y)) for x, y in zip(layer, taylor(p, u, w, outside))]
    print(f"P_F1 = {LOAD} Pa, 0 to {TAYLOR_END} s, Taylor series of order {ORDER}: {float(gaps[0]):.1e} D, {float(gaps[1]):.1e} D/s")
    start = radau.advance(u, w, 0, mpfr(EULER_START), outside)[:2]
    end = mpfr(EULER_START) + EULER_STEPS * mpfr(BASIC)
    slow = radau.advance(*start, mpfr(EULER_START), end, outside)
    gaps = [max(abs(a - b) for a, b in zip(x, y)) for x, y in zip(slow, extrapolated(p, *start, outside))]
    print(f"P_F1 = {LOAD} Pa, {EULER_START} to {float(end)} s, implicit Euler extrapolated: {float(gaps[0]):.1e} D, {float(gaps[1]):.1e} D/s")
