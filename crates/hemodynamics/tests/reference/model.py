"""The hemodynamic network of Fig. 70 in conductances, in any arithmetic, with the thesis' table taken literally.

Walls j = C1, C2, V; u = d / D is the lumen by the nominal diameter, w = du/dt (1/s). Equations 1 and 2 of section 4.3.2, written so that nothing
cancels when a lumen closes: G = d^4 / c, t_i = 1 + G_Ai R_Vi, s_i = G_Ai / t_i, q = A v, G_t = s_1 + s_2 + G_V,
P_V = ((s_1 + s_2) P_H + G_V P_L - q_1 / t_1 - q_2 / t_2 - q_V) / G_t, P_Ci = (R_Vi (G_Ai P_H - q_i) + P_V) / t_i.
"""

from fractions import Fraction

import gmpy2
from gmpy2 import mpfr, mpq

BITS = 200  # 60 digits
gmpy2.get_context().precision = BITS
PI_DIGITS = 80

# The thesis' table (section 4.3.2); three values are those of C1, C2, V.
TABLE = {
    "k": ("1e5", "1e5", "1e3"),  # N/m
    "m": ("1e-3", "1e-3", "1e-3"),  # kg
    "b": ("1e4", "1e4", "1e2"),  # N s/m
    "A": ("1e-4", "1e-4", "1e-4"),  # m^2
    "D": ("1e-5", "1e-5", "1e-4"),  # m
    "L": ("1e-3", "1e-3", "1e-2"),  # m
    "N": ("1e5", "1e5", "1e2"),
    "R": ("1e11", "1e11"),  # Pa s/m^3, R_V1 and R_V2
    "mu": "3e-3",  # Pa s
    "P_H": "1e4",  # Pa
    "P_L": "0",
}
CONTACT_FROM = Fraction(1, 20)  # d_c / D of the contact law; its eta is 1


def pi_rational():
    """Pi to PI_DIGITS digits."""
    with gmpy2.context(precision=4 * PI_DIGITS + 40):
        return mpq(int(gmpy2.floor(gmpy2.const_pi() * mpfr(10) ** PI_DIGITS)), 10**PI_DIGITS)


class Parameters:
    """Derived constants as exact rationals (pi to 80 digits), with factors on entries of the table: `Parameters(k_C=Fraction(1, 2))`."""

    def __init__(self, k_C=1, R=1):
        exact = {n: [mpq(Fraction(v)) for v in (values if isinstance(values, tuple) else (values,))] for n, values in TABLE.items()}
        exact["k"][:2] = [k * mpq(Fraction(k_C)) for k in exact["k"][:2]]
        exact["R"] = [r * mpq(Fraction(R)) for r in exact["R"]]
        for name, values in exact.items():
            setattr(self, name, values if len(values) > 1 else values[0])
        pi = pi_rational()
        # G = conductance[j] u^4
        self.conductance = [d**4 * n * pi / (128 * length * self.mu) for d, n, length in zip(self.D, self.N, self.L)]
        self.wall_Pa = [k * d / a for k, d, a in zip(self.k, self.D, self.A)]  # k D / A


class Model:
    """Accelerations d2u/dt2 in the arithmetic of `number`: mpfr, float or an array of complex."""

    def __init__(self, parameters, number=lambda v: mpfr(v)):
        p = parameters
        self.gamma = [number(v) for v in p.conductance]
        self.R = [number(v) for v in p.R]
        self.flow = [number(a * d) for a, d in zip(p.A, p.D)]  # q = flow w
        self.push = [number(a / (m * d)) for a, m, d in zip(p.A, p.m, p.D)]
        self.spring = [number(k / m) for k, m in zip(p.k, p.m)]
        self.damper = [number(b / m) for b, m in zip(p.b, p.m)]
        self.P_H, self.P_L = number(p.P_H), number(p.P_L)
        self.contact_from = number(mpq(CONTACT_FROM))
        self.one = number(mpq(1))

    def pressures(self, u, w):
        g = [gamma * (x * x) * (x * x) for gamma, x in zip(self.gamma, u)]
        q = [flow * x for flow, x in zip(self.flow, w)]
        t = [self.one + g[i] * self.R[i] for i in (0, 1)]
        s = g[0] / t[0] + g[1] / t[1]
        p_v = (s * self.P_H + g[2] * self.P_L - q[0] / t[0] - q[1] / t[1] - q[2]) / (s + g[2])
        return [(self.R[i] * (g[i] * self.P_H - q[i]) + p_v) / t[i] for i in (0, 1)] + [p_v]

    def acceleration(self, u, w, external, contact=()):
        """`external`: pressures on the three walls; `contact`: the walls on which the contact law's cube acts."""
        p = self.pressures(u, w)
        out = []
        for j in range(3):
            a = self.push[j] * (p[j] - external[j]) - self.spring[j] * (u[j] - self.one) - self.damper[j] * w[j]
            if j in contact:
                excess = self.contact_from / u[j] - self.one
                a = a + self.spring[j] * excess * excess * excess
            out.append(a)
        return out


def external(pf1, pf2):
    """Pressures outside of C1, C2, V (Fig. 70): the first capillary is under the bone."""
    return [0, pf2, pf1]
