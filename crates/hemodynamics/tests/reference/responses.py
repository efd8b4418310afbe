"""Responses to a step of load from t = 0 to 2 s, seen until 4 s, from the rest equilibrium: sampled, with their crossings and contacts."""

from gmpy2 import mpfr

from collocation import Collocation, NotSettled, Plan
from equilibria import equilibria
from model import CONTACT_FROM, Parameters, external

# Two runs that share neither nodes nor steps.
PLANS = (Plan(24, "0.6", "0.03"), Plan(30, "0.5", "0.02"))
AFTER = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0)
RELEASE = 2
# The times are these doubles exactly, not the decimals that they print as.
TIMES = tuple([0.0] + list(AFTER) + [2.0 + t for t in AFTER])
CLOSE = mpfr("1e-45")


def rest(parameters):
    found = equilibria(parameters, 0, 0)
    assert len(found) == 1
    return found[0], [mpfr(0)] * 3


def since(time):
    """Seconds since the last change of load, exactly."""
    return mpfr(time) if time <= RELEASE else mpfr(time) - RELEASE


def sampled(pf1, pf2, plan):
    """[u, w] at each of TIMES, and the smallest lumen of all stages. The load's change at 2 s acts after the sample there."""
    p = Parameters()
    radau = Collocation(p, plan)
    u, w = rest(p)
    out, smallest = [(u, w)], min(u)
    for before, time in zip(TIMES, TIMES[1:]):
        outside = external(pf1, pf2) if time <= RELEASE else external(0, 0)
        start = mpfr(0) if before == RELEASE else since(before)
        u, w, low = radau.advance(u, w, start, since(time), outside)
        smallest = min(smallest, low)
        out.append((u, w))
    return out, smallest, radau.steps


def located(radau, u, w, h, outside, contact, wall, level):
    """The length of the step, shorter than h, that ends with the wall's lumen at the level: by Illinois' rule."""
    value = lambda length: radau.step(u, w, length, outside, contact)[0][wall] - level  # noqa: E731
    a, b, fa, fb = mpfr(0), h, u[wall] - level, value(h)
    if fa == 0:
        raise RuntimeError("starts on the level")
    side = 0
    for _ in range(80):
        c = b - fb * (b - a) / (fb - fa)
        fc = value(c)
        if abs(fc) < CLOSE:
            return c
        if (fc > 0) == (fb > 0):
            b, fb = c, fc
            fa = fa / 2 if side == 1 else fa
            side = 1
        else:
            a, fa = c, fc
            fb = fb / 2 if side == 2 else fb
            side = 2
    raise RuntimeError("no crossing found")


def crossing(pf1, pf2, wall, plan):
    """The time at which a wall's lumen is zero, the network's equations continued unchanged."""
    p = Parameters()
    radau = Collocation(p, plan)
    u, w = rest(p)
    outside, at = external(pf1, pf2), mpfr(0)
    while at < RELEASE:
        h = plan.length(at, RELEASE - at)
        try:
            after = radau.step(u, w, h, outside)
        except NotSettled:  # beyond the crossing the equations run away
            after = None
        if after is None or (after[0][wall] < 0 and h > at / 100):
            # Approach with shorter steps, so that the crossing's own step is well resolved.
            h = at / 200
            after = radau.step(u, w, h, outside)
        if after[0][wall] < 0:
            return at + located(radau, u, w, h, outside, (), wall, mpfr(0))
        u, w, _ = after
        at += h
    return None


def with_contact(pf1, pf2, plan):
    """As `sampled`, with the contact law; also the events [time, wall, on or off]. Steps end where a wall's cube sets in or stops."""
    p = Parameters()
    radau = Collocation(p, plan)
    level = mpfr(CONTACT_FROM.numerator) / CONTACT_FROM.denominator
    u, w = rest(p)
    out, events, contact, changed = [(u, w)], [], set(), mpfr(0)
    for before, time in zip(TIMES, TIMES[1:]):
        outside = external(pf1, pf2) if time <= RELEASE else external(0, 0)
        at, until = mpfr(before), mpfr(time)
        if before == RELEASE:
            changed = at
        while at < until:
            h = plan.length(at - changed, until - at)
            h, (u_end, w_end, _) = radau.step_or_less(u, w, h, outside, tuple(sorted(contact)))
            for wall in range(3):
                if abs(u_end[wall] - level) > CLOSE * 10 and (u_end[wall] < level) != (wall in contact):
                    if at == changed and abs(u[wall] - level) < CLOSE * 10:
                        raise RuntimeError("turns on the contact's border")
                    h = located(radau, u, w, h, outside, tuple(sorted(contact)), wall, level)
                    u, w, _ = radau.step(u, w, h, outside, tuple(sorted(contact)))
                    at = changed = at + h
                    contact ^= {wall}
                    events.append((at, wall, wall in contact))
                    break
            else:
                u, w = u_end, w_end
                at = until if h == until - at else at + h
        out.append((u, w))
    return out, events
