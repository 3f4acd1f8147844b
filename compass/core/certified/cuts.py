"""Half-spaces of a box in which a dilution of precision surely keeps a limit, or surely breaks it.

Rows ``a_k = (e_k, 1)``, ``N = sum a a'``, ``DOP^2 = tr C' N^-1 C`` with orthonormal columns C:
the first three for PDOP, all for GDOP, (0, 1) for TDOP, (n, 0) for VDOP and its complement for
HDOP, with P = C C' (the local vertical n stands still in the rows' frame). Over a box of u in
[-1, 1]^3 the rows are ``e(u) = e + sum e_d u_d + x, |x| <= D2/2``, and stray by D1 at most.
M is the inverse at the centre, ``g = tr P M``, ``Q = M P M``, ``l_d = 2 sum_k (Q a_k).e_d``.

**Broken.** For any Y, by Cauchy-Schwarz, ``tr C' N^-1 C >= (tr Y'C)^2 / tr Y' N Y``; more
satellites only make the right side smaller. With Y = M C the lower side is quadratic in rows::

    tr Y' N(u) Y <= sum a'Q a + l.u + r2,  r2 = sum_k D2 |Q a|_3 + D1^2 ||Q_33||

broken where this is below g^2/limit^2. M need not be an inverse for that.

**Kept.** With ``K = M^1/2 (N(u) - N) M^1/2 = K1(u) + K2`` and ``||K|| <= kappa < 1/2``,
``(1+K)^-1 = 1 - K + K (1+K)^-1 K`` gives

    DOP^2 <= g - l.u + r1 + u'B u + E3,      r1 = sum_k D2 |Q a|_3  (the term in D1^2 helps)
    B_de = tr P X_d X_e M,  X_d = M dN_d,    k1^2 = sum |tr X_d X_e|
    k2 = sum_k ||M_33|| D1^2 + sqrt(a'M a ||M_33||) D2,      kappa = k1 + k2
    E3 = (sqrt beta + k2 sqrt g)^2/(1 - kappa) - beta,       beta >= u'B u

E3 bounds ``z -> (sqrt z + k2 sqrt g)^2/(1 - kappa) - z`` at z = u'Bu, which grows with z. As
``(l.u)^2 <= g u'Bu`` (Cauchy-Schwarz again) the form B - l l'/g is not negative; beta' bounds it.
With y = l.u: kept where ``g - y + y^2/g + beta' + E3 + r1 <= limit^2``, that is
``y >= 2 c0/(1 + sqrt(1 - 4 c0/g))``, ``c0 = g + beta' + E3 + r1 - limit^2``; as |y| <= k1 g < g/2
the other root does not matter.

**Rounding.** Doubles, sums in the order written. Broken holds for the matrix Y as it is stored, so
only the sums err: the entries of Q by 1e-15 (tr M)^2 and the form by as much a term, 1e-13 times
``sum |a|^2 (tr M)^2`` in all (over 40 operations of 1.1e-16 on 16 entries, and the rows' own
1e-15). Kept is used only where ``tr M sum |a|^2 <= 1e6``, which bounds the condition number;
the error of the inverse is then below 1e-12 ``sum |a|^2 (tr M)^2``, added. beta, beta' and kappa
are raised by 1e-6, thresholds moved by 1e-9 of themselves.
"""

import math

from compass.core.certified.sights import FIRST, SECOND
from compass.core.jit import kernel

#: Offsets in the scratch array of `cuts`: N, M, P, Q, three slopes of N, three X, three X M P.
N_, M_, P_, Q_, DN, X_, XMP, SCRATCH = 0, 16, 32, 48, 64, 112, 160, 208

#: Offsets in a cut: threshold and direction, of what is kept and of what is broken.
KEPT, BROKEN, CUT = 0, 4, 8


@kernel
def projector(dop, user, s):
    """Fill P: 0 GDOP, 1 PDOP, 2 HDOP, 3 VDOP, 4 TDOP, in the order of `compass.core.dop`."""
    for i in range(4):
        for j in range(4):
            same = 1.0 if i == j else 0.0
            up = user[i] * user[j] if i < 3 and j < 3 else 0.0
            if dop == 4:
                p = same if i == 3 else 0.0
            elif dop == 3:
                p = up
            elif dop == 2:
                p = (same if i < 3 else 0.0) - up
            elif dop == 1:
                p = same if i < 3 else 0.0
            else:
                p = same
            s[P_ + 4 * i + j] = p


@kernel
def invert(s, ridge):
    """Invert ``N + ridge`` into M by Cholesky; False where it is not positive."""
    c = s[Q_ : Q_ + 16]  # the factor's inverse; Q is made afterwards
    for i in range(4):
        for j in range(i + 1):
            total = s[N_ + 4 * i + j] + (ridge if i == j else 0.0)
            for k in range(j):
                total -= s[X_ + 4 * i + k] * s[X_ + 4 * j + k]
            if i == j:
                if total <= 1e-14:
                    return False
                s[X_ + 5 * i] = math.sqrt(total)
            else:
                s[X_ + 4 * i + j] = total / s[X_ + 5 * j]
    for j in range(4):
        for i in range(4):
            total = 1.0 if i == j else 0.0
            for k in range(j, i):
                total -= s[X_ + 4 * i + k] * c[4 * k + j]
            c[4 * i + j] = total / s[X_ + 5 * i] if i >= j else 0.0
    for i in range(4):
        for j in range(i + 1):
            total = 0.0
            for k in range(i, 4):
                total += c[4 * k + i] * c[4 * k + j]
            s[M_ + 4 * i + j] = total
            s[M_ + 4 * j + i] = total
    return True


@kernel
def multiply(s, a, b, out):
    """Product of two 4 x 4 matrices in the scratch array."""
    for i in range(4):
        for j in range(4):
            s[out + 4 * i + j] = (
                s[a + 4 * i] * s[b + j]
                + s[a + 4 * i + 1] * s[b + 4 + j]
                + s[a + 4 * i + 2] * s[b + 8 + j]
                + s[a + 4 * i + 3] * s[b + 12 + j]
            )


@kernel
def trace_of_product(s, a, b):
    """Trace of the product of two 4 x 4 matrices in the scratch array."""
    total = 0.0
    for i in range(4):
        for j in range(4):
            total += s[a + 4 * i + j] * s[b + 4 * j + i]
    return total


@kernel
def moments(rows, kinds, count, sure, s):
    """Fill N and its three slopes from the sure rows, or all; return their number."""
    s[N_ : N_ + 16] = 0.0
    s[DN : DN + 48] = 0.0
    used = 0
    for k in range(count):
        if sure and kinds[k] != 1:
            continue
        used += 1
        for i in range(3):
            ei = rows[k, i]
            for j in range(i + 1):
                s[N_ + 4 * i + j] += ei * rows[k, j]
            s[N_ + 12 + i] += ei
            for d in range(3):
                fi = rows[k, 3 + 3 * d + i]
                for j in range(i + 1):
                    s[DN + 16 * d + 4 * i + j] += ei * rows[k, 3 + 3 * d + j] + fi * rows[k, j]
                s[DN + 16 * d + 12 + i] += fi
    s[N_ + 15] = float(used)
    for i in range(4):
        for j in range(i):
            for m in (N_, DN, DN + 16, DN + 32):
                s[m + 4 * j + i] = s[m + 4 * i + j]
    return used


@kernel
def block_norm(s, m):
    """Frobenius norm of the upper left 3 x 3 block."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += s[m + 4 * i + j] * s[m + 4 * i + j]
    return math.sqrt(total)


@kernel
def residues(rows, kinds, count, sure, s):
    """Sums over the rows: a'Q a, D2 |Q a|, ||Q_33|| D1^2, and k2."""
    q33, m33 = block_norm(s, Q_), block_norm(s, M_)
    value = bent = spread = k2 = 0.0
    for k in range(count):
        if sure and kinds[k] != 1:
            continue
        x, y, z = rows[k, 0], rows[k, 1], rows[k, 2]
        first, second = rows[k, FIRST], rows[k, SECOND]
        value += s[Q_ + 15]
        size = s[M_ + 15]
        long = 0.0
        for i in range(3):
            ai = rows[k, i]
            qa = s[Q_ + 4 * i] * x + s[Q_ + 4 * i + 1] * y + s[Q_ + 4 * i + 2] * z
            ma = s[M_ + 4 * i] * x + s[M_ + 4 * i + 1] * y + s[M_ + 4 * i + 2] * z
            value += ai * (qa + 2.0 * s[Q_ + 4 * i + 3])
            size += ai * (ma + 2.0 * s[M_ + 4 * i + 3])
            qa += s[Q_ + 4 * i + 3]
            long += qa * qa
        bent += second * math.sqrt(long)
        k2 += m33 * first * first + math.sqrt(max(size, 0.0) * m33) * second
        spread += first * first
    return value, bent, q33 * spread, k2


@kernel
def cuts(rows, kinds, count, sure, square, s, cut):
    """Fill the half-spaces ``direction . u >= threshold`` where the limit is kept and broken.

    Parameters
    ----------
    rows, kinds, count
        From `sights`.
    sure
        Only satellites surely in sight (a bound for what is kept) or all (for what is broken).
    square
        The limit squared.
    s
        Scratch with P filled in.
    cut
        Filled, shape (8,); a threshold of inf means nowhere.
    """
    cut[KEPT] = cut[BROKEN] = math.inf
    used = moments(rows, kinds, count, sure, s)
    if used < 4:
        cut[BROKEN] = -math.inf
        return
    regular = invert(s, 0.0)
    trace = s[M_] + s[M_ + 5] + s[M_ + 10] + s[M_ + 15]
    if not regular or not trace * 2.0 * used <= 1e6:
        regular = False
        if not invert(s, 1e-5):
            return
        trace = s[M_] + s[M_ + 5] + s[M_ + 10] + s[M_ + 15]
    multiply(s, M_, P_, XMP)
    multiply(s, XMP, M_, Q_)
    g = trace_of_product(s, P_, M_)
    l0 = trace_of_product(s, Q_, DN)
    l1 = trace_of_product(s, Q_, DN + 16)
    l2 = trace_of_product(s, Q_, DN + 32)
    value, bent, spread, k2 = residues(rows, kinds, count, sure, s)
    weight = 2.0 * used * trace * trace
    room = g * g / square * (1.0 - 1e-9) - (value + bent + spread) * (1.0 + 1e-9) - 1e-13 * weight
    cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3] = -room, -l0, -l1, -l2
    if not regular:
        return
    for d in range(3):
        multiply(s, M_, DN + 16 * d, X_ + 16 * d)
    k1 = 0.0
    for d in range(3):
        for e in range(3):
            k1 += abs(trace_of_product(s, X_ + 16 * d, X_ + 16 * e))
    kappa = (math.sqrt(k1) + k2) * (1.0 + 1e-6) + 1e-9
    if not kappa < 0.49:
        return
    multiply(s, M_, P_, N_)
    for d in range(3):
        multiply(s, X_ + 16 * d, N_, XMP + 16 * d)
    beta = less = 0.0
    for d in range(3):
        ld = l0 if d == 0 else (l1 if d == 1 else l2)
        for e in range(3):
            le = l0 if e == 0 else (l1 if e == 1 else l2)
            b = 0.5 * (
                trace_of_product(s, XMP + 16 * e, X_ + 16 * d)
                + trace_of_product(s, XMP + 16 * d, X_ + 16 * e)
            )
            beta += abs(b)
            less += abs(b - ld * le / g)
    small = 1e-12 * weight
    beta, less = beta * (1.0 + 1e-6) + small, less * (1.0 + 1e-6) + 1e-6 * beta + small
    root = math.sqrt(beta) + k2 * (1.0 + 1e-6) * math.sqrt(g)
    third = root * root / (1.0 - kappa) - beta
    c0 = (g + less + third + bent) * (1.0 + 1e-9) + small - square * (1.0 - 1e-9)
    inner = 1.0 - 4.0 * c0 / g
    if inner < 0.0:
        return
    y = 2.0 * c0 / (1.0 + math.sqrt(inner))
    cut[KEPT], cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3] = y + 1e-9 * abs(y) + small, l0, l1, l2


@kernel
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


@kernel
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
