"""Volume of a half-space in a cube, rounded down."""

from compass.core.jit import fused_kernel


@fused_kernel
def volume(threshold, a, b, c):
    """Share of the cube [-1, 1]^3 where ``a x + b y + c z >= threshold``, never too large.

    Inclusion and exclusion of corners; a coefficient below a thousandth of the largest is dropped
    and the plane moved by it; 1e-9 for rounding.
    """
    a, b, c = abs(a), abs(b), abs(c)
    if not threshold < a + b + c:
        return 0.0
    if threshold <= -(a + b + c):
        return 1.0
    if a < b:
        a, b = b, a
    if b < c:
        b, c = c, b
    if a < b:
        a, b = b, a
    t = -threshold
    if c < 1e-3 * a:
        t, c = t - c, 0.0
    if b < 1e-3 * a:
        t, b = t - b, 0.0
    # share where a x + b y + c z <= t, by symmetry; from the smaller side
    share = corner(a + b + c + t, a, b, c) if t <= 0.0 else 1.0 - corner(a + b + c - t, a, b, c)
    return min(1.0, max(0.0, share - 1e-9))


@fused_kernel
def corner(w, a, b, c):
    """Share of the cube of side 2 at the origin where ``a x + b y + c z <= w``, a >= b >= c >= 0.

    For w up to half of what the far corner has; b and c may be 0.
    """
    if w <= 0.0:
        return 0.0
    w *= 0.5
    if b == 0.0:
        return w / a
    if c == 0.0:
        total = w * w
        for x in (a, b):
            if w > x:
                total -= (w - x) * (w - x)
        return total / (2.0 * a * b)
    total = w * w * w
    for x in (a, b, c):
        if w > x:
            total -= (w - x) * (w - x) * (w - x)
    for x in (a + b, a + c, b + c):
        if w > x:
            total += (w - x) * (w - x) * (w - x)
    return total / (6.0 * a * b * c)
