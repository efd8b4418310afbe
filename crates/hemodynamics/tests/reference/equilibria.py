"""All equilibria with open vessels for a load, none missed and none spurious: zeros of one polynomial, isolated in exact integers.

At rest no wall takes up blood, and the flows through C1, C2 and V balance. With u = d_C1 / D_C1, everything is a polynomial in u:
P_C1 = K_1 (u - 1) from the wall (K = k D / A), g = R_V1 G_A1 = rho_1 u^4, P_V = P_C1 (1 + g) - g P_H from the unit, d_V / D_V = z = 1 + (P_V - P_F1) / K_V
from the vein's wall, the second unit's flow N = G_V (P_V - P_L) - G_A1 (P_H - P_C1), P_C2 = P_V + R_V2 N, d_C2 / D_C2 = y = 1 + (P_C2 - P_F2) / K_2, and
at last its own flow: F(u) = G_A2(y) (P_H - P_C2) - N = 0, of degree 125. Pressures lie between P_L and P_H, so 0 < u <= 1 + P_H / K_1. Its zeros there are
isolated by Descartes' rule in Bernstein's basis (exact; pi to 80 digits), narrowed by bisection in 800 bits, and kept when y > 0 and z > 0.
"""

from math import comb

import gmpy2
import numpy as np
from gmpy2 import mpfr, mpq

from model import Model, external

DEPTH = 160
NARROW_BITS = 800
HALVINGS = 220


def add(a, b, factor=1):
    out = [mpq(0)] * max(len(a), len(b))
    for i, v in enumerate(a):
        out[i] += v
    for i, v in enumerate(b):
        out[i] += factor * v
    return out


def times(a, b):
    out = [mpq(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        if x:
            for j, y in enumerate(b):
                out[i + j] += x * y
    return out


def chain(p, pf1, pf2, u, plus, multiply, number):
    """y, z and F of the module's head, by the given operations on polynomials or numbers."""
    four = lambda v: multiply(multiply(v, v), multiply(v, v))  # noqa: E731
    scale = lambda v, f: multiply(v, number(f))  # noqa: E731
    p1 = scale(plus(u, number(-1)), p.wall_Pa[0])
    left = plus(number(p.P_H), scale(p1, mpq(-1)))  # P_H - P_C1
    g1 = scale(four(u), p.conductance[0])
    p_v = plus(p1, scale(multiply(g1, left), -p.R[0]))
    z = plus(number(1), scale(plus(p_v, number(-pf1)), 1 / p.wall_Pa[2]))
    n = plus(scale(multiply(four(z), plus(p_v, number(-p.P_L))), p.conductance[2]), scale(multiply(g1, left), mpq(-1)))
    p2 = plus(p_v, scale(n, p.R[1]))
    y = plus(number(1), scale(plus(p2, number(-pf2)), 1 / p.wall_Pa[1]))
    own = scale(multiply(four(y), plus(number(p.P_H), scale(p2, mpq(-1)))), p.conductance[1])
    return y, z, plus(own, scale(n, mpq(-1)))


def isolate(coefficients):
    """Disjoint open intervals (a, b) of (0, 1), as rationals, each with exactly one zero of the polynomial; a zero hit exactly is (a, a)."""
    n = len(coefficients) - 1
    bernstein = [sum(comb(j, i) * coefficients[i] / comb(n, i) for i in range(j + 1)) for j in range(n + 1)]
    common = mpq(1)
    for v in bernstein:
        common = gmpy2.lcm(int(common), v.denominator)
    work = [(0, 0, [int(v * common) for v in bernstein])]
    work = [(k, depth, [gmpy2.mpz(v) for v in b]) for k, depth, b in work]
    found = []
    while work:
        k, depth, b = work.pop()
        signs = [v > 0 for v in b if v]
        changes = sum(x != y for x, y in zip(signs, signs[1:]))
        if changes == 0:
            continue
        if changes == 1:
            found.append((mpq(k, 1 << depth), mpq(k + 1, 1 << depth)))
            continue
        if depth == DEPTH:
            raise RuntimeError("two zeros closer than 1e-48: a fold, or an exact double zero")
        # de Casteljau at the middle, without the halvings: all multiplied by 2^n.
        row, left, right = b, [b[0] << n], [b[-1] << n]
        for level in range(1, n + 1):
            row = [x + y for x, y in zip(row, row[1:])]
            left.append(row[0] << (n - level))
            right.append(row[-1] << (n - level))
        if left[-1] == 0:
            middle = mpq(2 * k + 1, 1 << (depth + 1))
            found.append((middle, middle))
        work += [(2 * k, depth + 1, left), (2 * k + 1, depth + 1, right[::-1])]
    return sorted(found)


def narrow(f, a, b):
    with gmpy2.context(precision=NARROW_BITS):
        a, b = mpfr(a), mpfr(b)
        low = f(a) > 0
        if a == b or f(a) == 0:
            return a
        for _ in range(HALVINGS):
            middle = (a + b) / 2
            if (f(middle) > 0) == low:
                a = middle
            else:
                b = middle
        return (a + b) / 2


def equilibria(p, pf1, pf2):
    """All open ones as [u_C1, u_C2, u_V] (mpfr), by the first lumen."""
    pf1, pf2 = mpq(pf1), mpq(pf2)
    top = 1 + p.P_H / p.wall_Pa[0]
    polynomial = chain(p, pf1, pf2, [mpq(0), top], add, times, lambda v: [mpq(v)])[2]
    value = lambda x: chain(p, pf1, pf2, x * top, lambda a, b: a + b, lambda a, b: a * b, lambda v: mpq(v))  # noqa: E731
    out = []
    for a, b in isolate(polynomial):
        with gmpy2.context(precision=NARROW_BITS):
            root = narrow(lambda x: value(x)[2], a, b)
            y, z, _ = value(root)
            u = root * top
        if u > 0 and y > 0 and z > 0:
            out.append([mpfr(u), mpfr(y), mpfr(z)])
    return out


def leading(p, u, pf1, pf2):
    """The real part of the rightmost eigenvalue (1/s), in doubles: below zero is stable."""
    model = Model(p, number=float)
    u = np.array([float(x) for x in u], dtype=complex)
    jacobian = np.zeros((6, 6))
    jacobian[:3, 3:] = np.eye(3)
    for j in range(3):
        for column, (du, dw) in ((j, (1e-100j, 0)), (3 + j, (0, 1e-100j))):
            position, velocity = u.copy(), np.zeros(3, dtype=complex)
            position[j] += du
            velocity[j] += dw
            jacobian[3:, column] = np.array(model.acceleration(position, velocity, external(pf1, pf2))).imag / 1e-100
    return max(np.linalg.eigvals(jacobian).real)
