"""Coefficients of the Radau IIA methods, written to src/radau/tables.rs: python scripts/radau_tables.py > src/radau/tables.rs

Nodes: zeros of the derivative d^(S-1)/dx^(S-1) of x^(S-1) (x - 1)^S. A: integrals of the Lagrange polynomials through them. The inverse of
A has one real eigenvalue and pairs of complex ones: A^-1 = V diag(mu) V^-1. A vector over the stages goes to its coordinates by rows of
V^-1, real part and imaginary part of one of each pair, kept as [real parts.., imaginary parts.., real]. Matrices are written by columns.
"""

from mpmath import mp, mpf, mpc, matrix, lu_solve, eye, eig, polyroots, fabs, re, im

mp.dps = 60


def multiply(p, q):
    out = [mpf(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            out[i + j] += a * b
    return out  # coefficients from the lowest power on


def derivative(p):
    return [k * a for k, a in enumerate(p)][1:]


def integral(p):
    return [mpf(0)] + [a / (k + 1) for k, a in enumerate(p)]


def at(p, x):
    y = mpf(0)
    for a in reversed(p):
        y = y * x + a
    return y


def nodes(stages):
    p = [mpf(0)] * (stages - 1) + [mpf(1)]
    for _ in range(stages):
        p = multiply(p, [mpf(-1), mpf(1)])
    for _ in range(stages - 1):
        p = derivative(p)
    roots = sorted(re(x) for x in polyroots(list(reversed(p)), maxsteps=500, extraprec=400))
    roots[-1] = mpf(1)
    return roots


def lagrange(points, i):
    p = [mpf(1)]
    for j, x in enumerate(points):
        if j != i:
            scale = points[i] - x
            p = multiply(p, [-x / scale, mpf(1) / scale])
    return p


def number(x):
    return repr(float(x))


def rows(name, values, indent=4):
    pad = " " * indent
    return f"{pad}{name}: [{', '.join(number(x) for x in values)}],"


def block(name, columns):
    body = "\n".join(f"        [{', '.join(number(x) for x in column)}]," for column in columns)
    return f"    {name}: [\n{body}\n    ],"


def table(stages):
    c = nodes(stages)
    a = matrix(stages, stages)
    for j in range(stages):
        q = integral(lagrange(c, j))
        for i in range(stages):
            a[i, j] = at(q, c[i])
    inverse = lu_solve_all(a)
    values, vectors = eig(inverse)
    order = sorted(range(stages), key=lambda k: (fabs(im(values[k])), im(values[k])))
    real = order[0]
    pairs = sorted((k for k in order[1:] if im(values[k]) > 0), key=lambda k: im(values[k]))
    for k in range(stages):
        largest = max(range(stages), key=lambda i: fabs(vectors[i, k]))
        scale = vectors[largest, k]
        for i in range(stages):
            vectors[i, k] /= scale
    left = lu_solve_all(vectors)
    n = len(pairs)
    mu = [re(values[k]) for k in pairs] + [im(values[k]) for k in pairs] + [re(values[real])]
    inv = [1 / values[k] for k in pairs]
    reciprocal = [re(x) for x in inv] + [im(x) for x in inv] + [re(1 / values[real])]
    to = [[re(left[k, i]) for k in pairs] + [im(left[k, i]) for k in pairs] + [re(left[real, i])] for i in range(stages)]
    back = [[2 * re(vectors[i, k]) for i in range(stages)] for k in pairs]
    back += [[-2 * im(vectors[i, k]) for i in range(stages)] for k in pairs]
    back += [[re(vectors[i, real]) for i in range(stages)]]
    with_start = [mpf(0)] + c
    slopes = [at(derivative(lagrange(with_start, i + 1)), mpf(0)) for i in range(stages)]
    weights = []
    for i, x in enumerate(c):
        w = x
        for j, y in enumerate(c):
            if j != i:
                w *= x - y
        weights.append(1 / w)
    bump = [mpf(1)]
    for x in c:
        bump = multiply(bump, [mpf(1), -1 / x])
    bump = integral(bump)[1:]
    height = max(fabs(at([mpf(0)] + bump, x)) for x in c)
    full = multiply([mpf(0), mpf(1)], [mpf(1)])
    for x in c:
        full = multiply(full, [-x, mpf(1)])
    # The probe: where the error of the rates is greatest, among its flat places between the nodes.
    flat = [re(x) for x in polyroots(list(reversed(derivative(full))), maxsteps=500, extraprec=400)]
    probe = max(flat, key=lambda x: fabs(at(full, x)))
    drift = integral(full)
    reach = max(fabs(at(drift, x)) for x in c) / fabs(at(full, probe))
    probe_slopes = [at(derivative(lagrange(with_start, i + 1)), probe) for i in range(stages)]
    lines = [
        f"/// {stages} stages, order {2 * stages - 1}.",
        f"pub(crate) static RADAU{2 * stages - 1}: Table<{stages}> = Table {{",
        rows("nodes", c),
        block("weights_by_column", [[a[i, j] for i in range(stages)] for j in range(stages)]),
        rows("eigenvalues", mu),
        rows("reciprocals", reciprocal),
        block("to_eigen", to),
        block("from_eigen", back),
        rows("start_slopes", slopes),
        rows("barycentric", weights),
        f"    bump: [{', '.join(number(x) for x in bump[:stages])}],",
        f"    bump_last: {number(bump[stages])},",
        f"    bump_height: {number(height)},",
        f"    probe: {number(probe)},",
        rows("probe_slopes", probe_slopes),
        f"    probe_reach: {number(reach)},",
        "};",
    ]
    return "\n".join(lines)


def lu_solve_all(m):
    out = matrix(m.rows, m.rows)
    for j in range(m.rows):
        column = lu_solve(m, eye(m.rows)[:, j])
        for i in range(m.rows):
            out[i, j] = column[i]
    return out


print("//! Coefficients of the Radau IIA methods. Written by scripts/radau_tables.py; not to be edited by hand.")
print()
print("use super::table::Table;")
for stages in (3, 5, 7):
    print()
    print("#[rustfmt::skip]")
    print(table(stages))
