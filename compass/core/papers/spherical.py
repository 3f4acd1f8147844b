"""Flight through the atmosphere: rates, their exact Jacobian, and one Runge-Kutta step.

State ``x = [r, lon, lat, V, gamma, psi, ln_rho0, kappa]``, SI and radians: radius, east
longitude, latitude, speed relative to the rotating planet, flight-path angle (positive up),
azimuth of the velocity clockwise from **north**, logarithm of the density at ``r0`` and
lift-to-drag ratio. The last two are constants carried as states.

Parameters ``p = [mu, r0, h, B, bank, omega, rotation, ...]``: gravitational parameter, reference
radius and scale height of the atmosphere, ``B = C_D S / m`` (m^2/kg), bank angle (positive turns
the velocity clockwise), rotation rate, and which terms of the rotation are kept, as in
`compass.core.entry.rates` (``omega = 0`` is the planet at rest). Anything after that is a tabulated
atmosphere: n radii, increasing, then n values of ``ln(rho/rho(r0))``.
"""

import math

import numpy as np

from compass.core.entry.rates import CENTRIFUGAL, SWAPPED, layered
from compass.core.jit import fast_kernel

STATES = 8
MU, R0, SCALE_HEIGHT, DRAG, BANK, OMEGA, ROTATION, TABLE = range(8)


@fast_kernel
def log_density_ratio(r, p):
    """``ln(rho(r)/rho(r0))`` and its derivative in r, 1/m.

    ``(r0 - r)/h``, or of a table (`compass.core.entry.rates.layered`).
    """
    n = (p.size - TABLE) // 2
    if n == 0:
        return (p[R0] - r) / p[SCALE_HEIGHT], -1.0 / p[SCALE_HEIGHT]
    return layered(r, p, TABLE, n)


@fast_kernel
def entry_rates(x, p, out):
    """Write the eight rates of the state into `out`.

    ``r' = V sin g``, ``lon' = V cos g sin psi / (r cos lat)``, ``lat' = V cos g cos psi / r``,
    ``V' = -D - (mu/r^2) sin g``,
    ``g' = (V/r - mu/(r^2 V)) cos g + L cos(bank)/V + 2 w sin psi cos lat``,
    ``psi' = (V/r) sin psi cos g tan lat + L sin(bank)/(V cos g)
    + 2 w (sin lat - tan g cos psi cos lat)``, with ``D = rho B V^2 / 2`` and ``L = kappa D``;
    plus the centrifugal terms if asked for.
    """
    r, lat, v, gamma, psi = x[0], x[2], x[3], x[4], x[5]
    sg, cg = math.sin(gamma), math.cos(gamma)
    sp, cp = math.sin(psi), math.cos(psi)
    sl, cl = math.sin(lat), math.cos(lat)
    ratio, _ = log_density_ratio(r, p)
    drag = 0.5 * math.exp(x[6] + ratio) * p[DRAG] * v * v
    lift = x[7] * drag
    g = p[MU] / (r * r)
    w = p[OMEGA]
    coriolis_gamma = 2.0 * w * sp * cl
    coriolis_psi = 2.0 * w * (sl - sg / cg * cp * cl)
    if p[ROTATION] == SWAPPED:
        coriolis_gamma, coriolis_psi = -coriolis_psi, -coriolis_gamma
    out[0] = v * sg
    out[1] = v * cg * sp / (r * cl)
    out[2] = v * cg * cp / r
    out[3] = -drag - g * sg
    out[4] = (v / r - g / v) * cg + lift * math.cos(p[BANK]) / v + coriolis_gamma
    out[5] = v / r * sp * cg * sl / cl + lift * math.sin(p[BANK]) / (v * cg) + coriolis_psi
    out[6] = 0.0
    out[7] = 0.0
    if p[ROTATION] == CENTRIFUGAL:
        c = w * w * r
        out[3] += c * cl * (sg * cl - cg * sl * cp)
        out[4] += c * cl * (cg * cl + sg * sl * cp) / v
        out[5] += c * sl * cl * sp / (v * cg)


@fast_kernel
def entry_jacobian(x, p, out):
    """Write the 8 by 8 derivative of `entry_rates` with respect to the state into `out`."""
    r, lat, v, gamma, psi = x[0], x[2], x[3], x[4], x[5]
    sg, cg = math.sin(gamma), math.cos(gamma)
    sp, cp = math.sin(psi), math.cos(psi)
    sl, cl = math.sin(lat), math.cos(lat)
    tg, tl = sg / cg, sl / cl
    ratio, slope = log_density_ratio(r, p)
    drag = 0.5 * math.exp(x[6] + ratio) * p[DRAG] * v * v
    kappa = x[7]
    lift = kappa * drag
    g = p[MU] / (r * r)
    cb, sb = math.cos(p[BANK]), math.sin(p[BANK])
    out[:, :] = 0.0

    out[0, 3] = sg
    out[0, 4] = v * cg

    east = v * cg * sp / (r * cl)
    out[1, 0] = -east / r
    out[1, 2] = east * tl
    out[1, 3] = cg * sp / (r * cl)
    out[1, 4] = -v * sg * sp / (r * cl)
    out[1, 5] = v * cg * cp / (r * cl)

    north = v * cg * cp / r
    out[2, 0] = -north / r
    out[2, 3] = cg * cp / r
    out[2, 4] = -v * sg * cp / r
    out[2, 5] = -v * cg * sp / r

    out[3, 0] = -drag * slope + 2.0 * g / r * sg
    out[3, 3] = -2.0 * drag / v
    out[3, 4] = -g * cg
    out[3, 6] = -drag

    out[4, 0] = (-v / r + 2.0 * g / v) / r * cg + lift * slope * cb / v
    out[4, 3] = (1.0 / r + g / (v * v)) * cg + lift * cb / (v * v)
    out[4, 4] = -(v / r - g / v) * sg
    out[4, 6] = lift * cb / v
    out[4, 7] = drag * cb / v

    turn = v / r * sp * cg * tl
    out[5, 0] = -turn / r + lift * slope * sb / (v * cg)
    out[5, 2] = v / r * sp * cg / (cl * cl)
    out[5, 3] = turn / v + lift * sb / (v * v * cg)
    out[5, 4] = -v / r * sp * sg * tl + lift * sb * sg / (v * cg * cg)
    out[5, 5] = v / r * cp * cg * tl
    out[5, 6] = lift * sb / (v * cg)
    out[5, 7] = drag * sb / (v * cg)

    two_w = 2.0 * p[OMEGA]
    gamma_lat, gamma_psi = -two_w * sp * sl, two_w * cp * cl
    psi_lat, psi_psi = two_w * (cl + tg * cp * sl), two_w * tg * sp * cl
    psi_gamma = -two_w * cp * cl / (cg * cg)
    if p[ROTATION] == SWAPPED:
        out[4, 2] -= psi_lat
        out[4, 4] -= psi_gamma
        out[4, 5] -= psi_psi
        out[5, 2] -= gamma_lat
        out[5, 5] -= gamma_psi
    else:
        out[4, 2] += gamma_lat
        out[4, 5] += gamma_psi
        out[5, 2] += psi_lat
        out[5, 4] += psi_gamma
        out[5, 5] += psi_psi
    if p[ROTATION] == CENTRIFUGAL:
        w2 = p[OMEGA] * p[OMEGA]
        c = w2 * r
        c2l = cl * cl - sl * sl
        up = cl * (sg * cl - cg * sl * cp)
        across = cl * (cg * cl + sg * sl * cp)
        out[3, 0] += w2 * up
        out[3, 2] += c * (-2.0 * sg * sl * cl - cg * cp * c2l)
        out[3, 4] += c * across
        out[3, 5] += c * cl * cg * sl * sp
        out[4, 0] += w2 * across / v
        out[4, 2] += c * (-2.0 * cg * sl * cl + sg * cp * c2l) / v
        out[4, 3] -= c * across / (v * v)
        out[4, 4] -= c * up / v
        out[4, 5] -= c * cl * sg * sl * sp / v
        side = sl * cl * sp / cg
        out[5, 0] += w2 * side / v
        out[5, 2] += c * c2l * sp / (v * cg)
        out[5, 3] -= c * side / (v * v)
        out[5, 4] += c * side * tg / v
        out[5, 5] += c * sl * cl * cp / (v * cg)


@fast_kernel
def rk4_step(x, p, dt, out):
    """Advance the state by one classical fourth-order Runge-Kutta step of `dt` seconds."""
    k, total, stage = np.empty(STATES), np.empty(STATES), np.empty(STATES)
    entry_rates(x, p, k)
    for i in range(STATES):
        total[i] = k[i]
        stage[i] = x[i] + 0.5 * dt * k[i]
    entry_rates(stage, p, k)
    for i in range(STATES):
        total[i] += 2.0 * k[i]
        stage[i] = x[i] + 0.5 * dt * k[i]
    entry_rates(stage, p, k)
    for i in range(STATES):
        total[i] += 2.0 * k[i]
        stage[i] = x[i] + dt * k[i]
    entry_rates(stage, p, k)
    for i in range(STATES):
        out[i] = x[i] + dt / 6.0 * (total[i] + k[i])


@fast_kernel
def _stage_jacobian(stage, p, previous, weight, jacobian, out):
    """``out = J(stage) (I + weight * previous)``; rows 6 and 7 of J are zero."""
    entry_jacobian(stage, p, jacobian)
    out[6:, :] = 0.0
    for i in range(6):
        for j in range(STATES):
            out[i, j] = jacobian[i, j]
        if weight != 0.0:
            for k in range(6):
                factor = weight * jacobian[i, k]
                if factor != 0.0:
                    for j in range(STATES):
                        out[i, j] += factor * previous[k, j]


@fast_kernel
def rk4_step_transition(x, p, dt, out_x, out_phi):
    """One Runge-Kutta step and the derivative of the step itself, 8 by 8.

    The Runge-Kutta map is differentiated stage by stage (not the flow), so a filter's
    covariance moves exactly as its mean does: ``K_1' = J(x)``, ``K_2' = J(x_2)(I + dt/2 K_1')``,
    ``K_3' = J(x_3)(I + dt/2 K_2')``, ``K_4' = J(x_4)(I + dt K_3')``,
    ``Phi = I + dt/6 (K_1' + 2 K_2' + 2 K_3' + K_4')``.
    """
    k, total, stage = np.empty(STATES), np.empty(STATES), np.empty(STATES)
    jacobian = np.empty((STATES, STATES))
    slope, before = np.empty((STATES, STATES)), np.empty((STATES, STATES))

    entry_rates(x, p, k)
    _stage_jacobian(x, p, before, 0.0, jacobian, slope)
    for i in range(STATES):
        total[i] = k[i]
        stage[i] = x[i] + 0.5 * dt * k[i]
        for j in range(STATES):
            out_phi[i, j] = slope[i, j]
    for part in range(3):
        back = 0.5 * dt if part < 2 else dt
        weight = 2.0 if part < 2 else 1.0
        ahead = 0.5 * dt if part == 0 else dt
        slope, before = before, slope
        entry_rates(stage, p, k)
        _stage_jacobian(stage, p, before, back, jacobian, slope)
        for i in range(STATES):
            total[i] += weight * k[i]
            stage[i] = x[i] + ahead * k[i]
            for j in range(STATES):
                out_phi[i, j] += weight * slope[i, j]
    for i in range(STATES):
        out_x[i] = x[i] + dt / 6.0 * total[i]
        for j in range(STATES):
            out_phi[i, j] *= dt / 6.0
        out_phi[i, i] += 1.0
