"""Half-spaces of a box in which a dilution of precision surely keeps a limit, or surely breaks it.

Rows ``a_k = (e_k, 1)``, ``N = sum a a'``, ``DOP^2 = tr C' N^-1 C`` with orthonormal columns C:
the first three for PDOP, all for GDOP, (0, 1) for TDOP, (n, 0) for VDOP and its complement for
HDOP, with P = C C' (the local vertical n stands still in the rows' frame). Over a box of u in
[-1, 1]^3 the rows are ``a(u) = a + sum a_d u_d + x, |x| <= D2/2``, and stray by D1 at most.
M is the inverse at the centre, ``g = tr P M``, ``Q = M P M``, ``l_d = 2 sum_k (Q a_k).a_d``.

Weighed rows ``a_k = (e_k, 1)/sigma_k`` make the square that of an error: then all four numbers of a
row move, and norms marked _3 are those of all four; without weights the last stands still.

**Broken.** For any Y, by Cauchy-Schwarz, ``tr C' N^-1 C >= (tr Y'C)^2 / tr Y' N Y``; more
satellites only make the right side smaller. With Y = M C the lower side is quadratic in rows::

    tr Y' N(u) Y <= sum a'Q a + l.u + r2,  r2 = sum_k D2 |Q a|_3 + D1^2 ||Q_33||

broken where this is below g^2/limit^2. M need not be an inverse for that.

**Kept.** With ``K = M^1/2 (N(u) - N) M^1/2 = K1(u) + K2`` and ``||K|| <= kappa < 1/2``,
``(1+K)^-1 = 1 - K + K (1+K)^-1 K`` gives

    DOP^2 <= g - l.u + r1 + u'B u + E3,      r1 = sum_k D2 |Q a|_3  (the term in D1^2 helps)
    B_de = tr Q dN_d X_e,   X_d = M dN_d,    k1^2 = sum |tr X_d X_e|
    k2 = sum_k ||M_33|| D1^2 + sqrt(a'M a ||M_33||) D2,      kappa = k1 + k2
    E3 = (sqrt beta + k2 sqrt g)^2/(1 - kappa) - beta,       beta >= u'B u

E3 bounds ``z -> (sqrt z + k2 sqrt g)^2/(1 - kappa) - z`` at z = u'Bu, which grows with z. As
``(l.u)^2 <= g u'Bu`` (Cauchy-Schwarz again) the form B - l l'/g is not negative; beta' bounds it.
With y = l.u: kept where ``g - y + y^2/g + beta' + E3 + r1 <= limit^2``, that is
``y >= 2 c0/(1 + sqrt(1 - 4 c0/g))``, ``c0 = g + beta' + E3 + r1 - limit^2``; as |y| <= k1 g < g/2
the other root does not matter.

**Rounding.** Doubles, sums in the order written, multiply-adds fused where the machine can: that
rounds once where twice is counted here. Broken holds for the matrix Y as it is stored, so
only the sums err: the entries of Q by 1e-15 (tr M)^2 and the form by as much a term, 1e-13 times
``sum |a|^2 (tr M)^2`` in all (over 40 operations of 1.1e-16 on 16 entries, and the rows' own
1e-15). Kept is used only where ``tr M sum |a|^2 <= 1e9``, which bounds the condition number; the
error of the inverse, to first order some 20 roundoffs times that of itself, is then below 2e-6 of
it and below 1e-12 ``sum |a|^2 (tr M)^2``, added. beta, beta' and kappa are raised by 1e-6 and 1e-13
times that product, thresholds moved by 1e-9 of themselves.
"""

import math

from compass.core.certified.sights import DOP, FIRST, LAST, ORBIT, SECOND, sights
from compass.core.jit import fused_kernel, inline_kernel

#: Offsets in the scratch array of `cuts`: N, M, P, Q, three slopes of N, three X, three Q dN, and
#: how many numbers of a row move less 3.
N_, M_, P_, Q_, DN, X_, W_, MOVING, SCRATCH = 0, 16, 32, 48, 64, 112, 160, 208, 209

#: Offsets in a cut: threshold and direction, of what is kept and of what is broken.
KEPT, BROKEN, CUT = 0, 4, 8

#: Offsets in an expansion: g, l, ``g + beta' + E3 + r1`` (inf where kappa is too large),
#: ``sum a'Q a + r2``, and what rounding may add to either.
CENTRE, TILT, MOST, LEAST, SMALL, EXPANSION = 0, 1, 4, 5, 6, 7


@fused_kernel
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


@inline_kernel
def gather(box, room, problem):
    """Fill lines of sight from a box and P of the dilution asked for; return `sights`'s number."""
    dop = int(problem.numbers[DOP])
    projector(dop, room.user, room.scratch)
    level = dop == 2 or dop == 3
    room.scratch[MOVING] = 1.0 if problem.orbits.shape[1] > ORBIT else 0.0
    # taken apart here: a group in a function with this many ways out is counted at each
    return sights(
        box, room.user, problem.orbits, room.q, room.dq, problem.numbers, level, problem.mask,
        room.rows, room.kinds,
    )  # fmt: skip


@inline_kernel
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


@inline_kernel
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


@inline_kernel
def trace_of_product(s, a, b):
    """Trace of the product of two 4 x 4 matrices in the scratch array."""
    total = 0.0
    for i in range(4):
        for j in range(4):
            total += s[a + 4 * i + j] * s[b + 4 * j + i]
    return total


@inline_kernel
def moments(rows, kinds, count, sure, s):
    """Fill N and its three slopes from the sure rows, or all; return their number."""
    s[N_ : N_ + 16] = 0.0
    s[DN : DN + 48] = 0.0
    used = 0
    for k in range(count):
        if sure and kinds[k] != 1:
            continue
        used += 1
        last = rows[k, LAST]
        s[N_ + 15] += last * last
        for d in range(3):
            s[DN + 16 * d + 15] += 2.0 * last * rows[k, LAST + 1 + d]
        for i in range(3):
            ei = rows[k, i]
            for j in range(i + 1):
                s[N_ + 4 * i + j] += ei * rows[k, j]
            s[N_ + 12 + i] += last * ei
            for d in range(3):
                fi = rows[k, 3 + 3 * d + i]
                for j in range(i + 1):
                    s[DN + 16 * d + 4 * i + j] += ei * rows[k, 3 + 3 * d + j] + fi * rows[k, j]
                s[DN + 16 * d + 12 + i] += last * fi + rows[k, LAST + 1 + d] * ei
    for i in range(4):
        for j in range(i):
            for m in (N_, DN, DN + 16, DN + 32):
                s[m + 4 * j + i] = s[m + 4 * i + j]
    return used


@inline_kernel
def block_norm(s, m):
    """Frobenius norm of the part of a matrix that numbers of rows that move meet."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += s[m + 4 * i + j] * s[m + 4 * i + j]
        total += 2.0 * s[MOVING] * s[m + 12 + i] * s[m + 12 + i]
    return math.sqrt(total + s[MOVING] * s[m + 15] * s[m + 15])


@inline_kernel
def residues(rows, kinds, count, sure, s):
    """Sums over the rows: a'Q a, D2 |Q a|, ||Q_33|| D1^2, and k2."""
    q33, m33 = block_norm(s, Q_), block_norm(s, M_)
    value = bent = spread = k2 = 0.0
    for k in range(count):
        if sure and kinds[k] != 1:
            continue
        x, y, z = rows[k, 0], rows[k, 1], rows[k, 2]
        last, first, second = rows[k, LAST], rows[k, FIRST], rows[k, SECOND]
        value += last * last * s[Q_ + 15]
        size = last * last * s[M_ + 15]
        long = last * s[Q_ + 15] + s[Q_ + 12] * x + s[Q_ + 13] * y + s[Q_ + 14] * z
        long *= s[MOVING] * long
        for i in range(3):
            ai = rows[k, i]
            qa = s[Q_ + 4 * i] * x + s[Q_ + 4 * i + 1] * y + s[Q_ + 4 * i + 2] * z
            ma = s[M_ + 4 * i] * x + s[M_ + 4 * i + 1] * y + s[M_ + 4 * i + 2] * z
            value += ai * (qa + 2.0 * last * s[Q_ + 4 * i + 3])
            size += ai * (ma + 2.0 * last * s[M_ + 4 * i + 3])
            qa += last * s[Q_ + 4 * i + 3]
            long += qa * qa
        bent += second * math.sqrt(long)
        k2 += m33 * first * first + math.sqrt(max(size, 0.0) * m33) * second
        spread += first * first
    return value, bent, q33 * spread, k2


@fused_kernel
def expansion(rows, kinds, count, sure, above, s, out):
    """Expand the square of a dilution over a box, with bounds of what is left out.

    Parameters
    ----------
    rows, kinds, count
        From `sights`.
    sure
        Only satellites surely in sight (a bound from above) or all (from below).
    above
        Whether a bound from above is wanted at all.
    s
        Scratch with P filled in.
    out
        Filled, shape (7,): see `CENTRE`, `TILT`, `MOST`, `LEAST`, `SMALL`.

    Returns
    -------
    used
        Number of satellites; below four nothing is filled, the dilution is infinite.
    """
    used = moments(rows, kinds, count, sure, s)
    if used < 4:
        return used
    regular = invert(s, 0.0)
    trace = s[M_] + s[M_ + 5] + s[M_ + 10] + s[M_ + 15]
    if not regular or not trace * 2.0 * used <= 1e9:
        regular = False
        if not invert(s, 1e-5):
            out[CENTRE], out[MOST], out[LEAST], out[SMALL] = 1.0, math.inf, math.inf, 0.0
            return used
        trace = s[M_] + s[M_ + 5] + s[M_ + 10] + s[M_ + 15]
    multiply(s, M_, P_, W_)
    multiply(s, W_, M_, Q_)
    g = trace_of_product(s, P_, M_)
    for d in range(3):
        multiply(s, Q_, DN + 16 * d, W_ + 16 * d)
        w = W_ + 16 * d
        out[TILT + d] = s[w] + s[w + 5] + s[w + 10] + s[w + 15]
    value, bent, spread, k2 = residues(rows, kinds, count, sure, s)
    weight = 2.0 * used * trace * trace
    small = 1e-12 * weight
    out[CENTRE], out[MOST], out[SMALL] = g, math.inf, small
    out[LEAST] = (value + bent + spread) * (1.0 + 1e-9) + 1e-13 * weight
    if not regular or not above:
        return used
    for d in range(3):
        multiply(s, M_, DN + 16 * d, X_ + 16 * d)
    k1 = beta = less = 0.0
    for d in range(3):
        for e in range(d + 1):
            times = 1.0 if d == e else 2.0  # both forms are symmetric
            k1 += times * abs(trace_of_product(s, X_ + 16 * d, X_ + 16 * e))
            b = trace_of_product(s, W_ + 16 * d, X_ + 16 * e)
            beta += times * abs(b)
            less += times * abs(b - out[TILT + d] * out[TILT + e] / g)
    raised = 1.0 + 1e-6 + 2e-13 * used * trace
    kappa = (math.sqrt(k1) + k2) * raised + 1e-9
    if not kappa < 0.49:
        return used
    less = less * raised + (raised - 1.0) * beta + small
    beta = beta * raised + small
    root = math.sqrt(beta) + k2 * raised * math.sqrt(g)
    third = root * root / (1.0 - kappa) - beta
    out[MOST] = (g + less + third + bent) * (1.0 + 1e-9) + small
    return used


@fused_kernel
def cuts(rows, kinds, count, sure, above, square, s, cut):
    """Fill the half-spaces ``direction . u >= threshold`` where the limit is kept and broken.

    Parameters
    ----------
    rows, kinds, count, sure, above, s
        As of `expansion`; without `above` nothing is said to be kept.
    square
        The limit squared.
    cut
        Filled, shape (CUT,); a threshold of inf means nowhere.
    """
    half_spaces(cut[CUT:], expansion(rows, kinds, count, sure, above, s, cut[CUT:]), square, cut)


@fused_kernel
def half_spaces(out, used, square, cut):
    """Fill the half-spaces of a limit, as `cuts`, from an expansion and how many it is of."""
    cut[KEPT] = cut[BROKEN] = math.inf
    if used < 4:
        cut[BROKEN] = -math.inf
        return
    g, l0, l1, l2 = out[CENTRE], out[TILT], out[TILT + 1], out[TILT + 2]
    room = g * g / square * (1.0 - 1e-9) - out[LEAST]
    cut[BROKEN], cut[BROKEN + 1], cut[BROKEN + 2], cut[BROKEN + 3] = -room, -l0, -l1, -l2
    c0 = out[MOST] - square * (1.0 - 1e-9)
    inner = 1.0 - 4.0 * c0 / g
    if inner >= 0.0:
        y = 2.0 * c0 / (1.0 + math.sqrt(inner))
        cut[KEPT] = y + 1e-9 * abs(y) + out[SMALL]
        cut[KEPT + 1], cut[KEPT + 2], cut[KEPT + 3] = l0, l1, l2


@fused_kernel
def most(out):
    """Bound from above of the square of a dilution over a box, from its `expansion`.

    ``g - y + y^2/g`` plus what is left out is largest at an end of the range of y.
    """
    tilt = abs(out[TILT]) + abs(out[TILT + 1]) + abs(out[TILT + 2])
    return (out[MOST] + tilt + tilt * tilt / out[CENTRE]) * (1.0 + 1e-9) + out[SMALL]


@fused_kernel
def least(out):
    """Bound from below of the square of a dilution at the centre of a box without width."""
    return out[CENTRE] * out[CENTRE] / out[LEAST] * (1.0 - 1e-9)
