"""Acceleration by a field of fully normalised spherical harmonics.

Cunningham's recursion, as in Montenbruck and Gill 2000, Satellite Orbits, eqs. 3.27 to 3.33, with
the normalisation carried in the numbers of the recursion, so that no factorial overflows. With

    V + i W (n, m) = (R/r)^(n+1) P_nm(sin latitude) exp(i m longitude), normalised,

every component of the acceleration is a plain sum over these with weights that depend on the
coefficients alone. `compass.orbits.gravity` works weights and recursion numbers out once; the
kernel walks up the degrees of one order after another, forgetting what it has used.
"""

from compass.core.jit import fast_kernel

#: Columns of the table of terms: two numbers of the recursion, and the weights of V and W in the
#: three components.
COLUMNS = 8


@fast_kernel
def field_acceleration(x, y, z, terms, highest, radius, scale):
    """Acceleration, without the central term, at a Mars-fixed place; m/s^2.

    Parameters
    ----------
    x, y, z
        Mars-fixed position, m.
    terms
        One row for each order m from 0 and degree n from m up to `highest`, shape (k, `COLUMNS`).
    highest
        One more than the degree of the field.
    radius, scale
        Reference radius R, m, and ``GM / R^2``, m/s^2.

    Returns
    -------
    tuple
        Mars-fixed components.
    """
    squared = x * x + y * y + z * z
    rho = radius / squared
    px, py, pz, fall = x * rho, y * rho, z * rho, radius * rho
    ax, ay, az = 0.0, 0.0, 0.0
    diagonal_v, diagonal_w = fall**0.5, 0.0
    row = 0
    for m in range(highest + 1):
        if m > 0:
            a = terms[row, 0]
            old = diagonal_v
            diagonal_v = a * (px * old - py * diagonal_w)
            diagonal_w = a * (px * diagonal_w + py * old)
        v, w, before_v, before_w = diagonal_v, diagonal_w, 0.0, 0.0
        for n in range(m, highest + 1):
            if n > m:
                up, down = terms[row, 0] * pz, terms[row, 1] * fall
                v, before_v = up * v - down * before_v, v
                w, before_w = up * w - down * before_w, w
            ax += terms[row, 2] * v + terms[row, 3] * w
            ay += terms[row, 4] * v + terms[row, 5] * w
            az += terms[row, 6] * v + terms[row, 7] * w
            row += 1
    return scale * ax, scale * ay, scale * az
