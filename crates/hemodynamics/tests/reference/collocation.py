"""Radau IIA collocation of any number of stages in 200 bits for the network's six states.

A step solves for the velocities w of all stages at once; positions follow linearly (u' = w). Newton's matrix is formed and solved in doubles
(its derivatives by complex steps), residuals are formed in 200 bits: each pass gains about ten digits, until corrections fall below 1e-52 of the
largest velocity that the step has seen.
"""

import gmpy2
import mpmath
import numpy as np
from gmpy2 import mpfr

from model import Model

WORK_DIGITS = 180  # for the constants: interpolation on many nodes loses digits
SMALLEST = mpfr(10) ** -52
PASSES = 30


def constants(stages):
    """Nodes c and matrix a of Radau IIA: nodes are the zeros of P_s - P_(s-1), a_ij the integral of Lagrange's j from 0 to c_i."""
    with mpmath.workdps(WORK_DIGITS):

        def legendre(n, x):
            before, now = mpmath.mpf(1), x
            for k in range(1, n):
                before, now = now, ((2 * k + 1) * x * now - k * before) / (k + 1)
            return before, now

        def difference(x):
            before, now = legendre(stages, x)
            return now - before

        grid = [mpmath.cos(mpmath.pi * k / (40 * stages)) for k in range(1, 40 * stages + 1)]
        signs = [difference(x) for x in grid]
        zeros = [
            mpmath.findroot(difference, (a, b), solver="anderson", tol=mpmath.mpf(10) ** (-2 * WORK_DIGITS + 40))
            for a, b, fa, fb in zip(grid, grid[1:], signs, signs[1:])
            if fa * fb < 0
        ]
        c = sorted((z + 1) / 2 for z in zeros) + [mpmath.mpf(1)]
        assert len(c) == stages
        a = mpmath.zeros(stages)
        for j in range(stages):
            poly, scale = [mpmath.mpf(1)], mpmath.mpf(1)
            for k in range(stages):
                if k != j:
                    poly = [x - c[k] * y for x, y in zip([mpmath.mpf(0)] + poly, poly + [mpmath.mpf(0)])]
                    scale *= c[j] - c[k]
            for i in range(stages):
                a[i, j] = sum(p * c[i] ** (n + 1) / (n + 1) for n, p in enumerate(poly)) / scale
        text = lambda v: mpfr(mpmath.nstr(v, 75))  # noqa: E731
        return [text(v) for v in c], [[text(a[i, j]) for j in range(stages)] for i in range(stages)]


class NotSettled(Exception):
    """Newton's iteration needs a shorter step."""


class Plan:
    """How steps grow: `first` seconds after a change of load, then `part` of the time since, at most `longest`."""

    def __init__(self, stages, part, longest, first="1e-7"):
        self.stages, self.part, self.longest, self.first = stages, mpfr(part), mpfr(longest), mpfr(first)

    def length(self, since, left):
        h = min(self.first if since == 0 else since * self.part, self.longest)
        # The last two before an output share what is left: no slivers.
        return left if left <= h else min(h, left / 2)


class Collocation:
    def __init__(self, parameters, plan):
        self.plan = plan
        stages = plan.stages
        self.exact = Model(parameters)
        self.double = Model(parameters, number=float)
        self.stages = stages
        self.c, self.a = constants(stages)
        self.a_double = np.array([[float(v) for v in row] for row in self.a])
        self.steps = 0

    def matrix(self, u, w, h, outside, contact):
        """I - h a (df/dw) - h a (df/du) h a, in doubles."""
        s = self.stages
        u = np.array([[float(x) for x in row] for row in u]).T.astype(complex)
        w = np.array([[float(x) for x in row] for row in w]).T.astype(complex)
        out = np.eye(3 * s).reshape(s, 3, s, 3)
        a = h * self.a_double
        tiny = 1e-100
        for j in range(3):
            shifted = w.copy()
            shifted[j] += 1j * tiny * 1e4
            by_w = np.array(self.double.acceleration(u, shifted, outside, contact)).imag / (tiny * 1e4)
            shifted = u.copy()
            shifted[j] += 1j * tiny
            by_u = np.array(self.double.acceleration(shifted, w, outside, contact)).imag / tiny
            for i in range(3):
                out[:, i, :, j] -= a * by_w[i][None, :] + (a * by_u[i][None, :]) @ a
        return out.reshape(3 * s, 3 * s)

    def step(self, u0, w0, h, outside, contact=()):
        """From (u0, w0) over h (mpfr): the state at its end and the smallest lumen that a stage saw."""
        s, a = self.stages, self.a
        h = mpfr(h)
        w = [list(w0) for _ in range(s)]
        outside_double = [float(p) for p in outside]
        outside = [mpfr(p) for p in outside]
        last = None
        for _ in range(PASSES):
            u = [[u0[j] + h * gmpy2.fsum([a[i][k] * w[k][j] for k in range(s)]) for j in range(3)] for i in range(s)]
            f = [self.exact.acceleration(u[i], w[i], outside, contact) for i in range(s)]
            rest = [[w0[j] + h * gmpy2.fsum([a[i][k] * f[k][j] for k in range(s)]) - w[i][j] for j in range(3)] for i in range(s)]
            size = max(abs(x) for row in rest for x in row)
            if size == 0:
                break
            scaled = np.array([[float(x / size) for x in row] for row in rest]).reshape(-1)
            change = np.linalg.solve(self.matrix(u, w, float(h), outside_double, contact), scaled).reshape(s, 3)
            for i in range(s):
                for j in range(3):
                    w[i][j] += mpfr(change[i, j]) * size
            largest = max(abs(x) for row in w for x in row) + abs(max(w0, key=abs))
            move = mpfr(float(np.abs(change).max())) * size
            if move <= SMALLEST * max(largest, mpfr("1e-3")):
                break
            last = move
        else:
            raise NotSettled(f"Newton does not settle: last correction {last}")
        self.steps += 1
        u = [[u0[j] + h * gmpy2.fsum([a[i][k] * w[k][j] for k in range(s)]) for j in range(3)] for i in range(s)]
        return u[-1], w[-1], min(x for row in u for x in row)

    def step_or_less(self, u, w, h, outside, contact):
        """A step of h, or of the first of h / 2, h / 4 .. that settles with all lumens open: its length and what `step` gives."""
        for _ in range(20):
            try:
                end = self.step(u, w, h, outside, contact)
                if not contact or end[2] > 0:
                    return h, end
            except NotSettled:
                pass
            h = h / 2
        raise RuntimeError("no step settles")

    def advance(self, u, w, since, until, outside, contact=()):
        """From `since` to `until` seconds after the last change of load. Also gives the smallest lumen met."""
        smallest, at, until = min(u), mpfr(since), mpfr(until)
        while at < until:
            wanted = self.plan.length(at, until - at)
            h, (u, w, low) = self.step_or_less(u, w, wanted, outside, contact)
            smallest = min(smallest, low)
            at = until if h == until - at else at + h
        return u, w, smallest
