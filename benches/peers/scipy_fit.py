"""The response with its Jacobian in NumPy, all lines at once, and the fit by SciPy; asked on standard input as `peers.cpp` is."""

import sys
import time

import numpy as np
from scipy.optimize import least_squares

NAMES = """m_corner m_wheel m_tm m_sf m_pwt mr_spring mr_damper k_wheel_z k_tm k_sf_z k_pwt_z k_tire
c_wheel_z c_tm c_sf_z c_pwt_z c_tire""".split()
FREE = [NAMES.index(name) for name in """m_wheel m_pwt k_wheel_z k_tm k_sf_z k_pwt_z k_tire c_wheel_z c_tm c_sf_z c_pwt_z c_tire""".split()]
LAMBDA = 0.099
NEPERS, RADIANS = LAMBDA * 20 / np.log(10) / 3, (1 - LAMBDA) / np.pi
W = 2 * np.pi * 0.5 * 60 ** (np.arange(300) / 299)


def respond(p):
    """Accelerations per metre of pad, 300 by 5, and their Jacobian, 300 by 5 by 17."""
    mass = np.array([p[0] - p[1:5].sum(), *p[1:5]])
    mr, md = p[5], p[6]
    spring, damper = np.array([1, -mr, 0, mr - 1, 0]), np.array([0, -md, 1, md - 1, 0])
    by_mr, by_md = np.array([0, -1.0, 0, 1, 0]), np.array([0, -1.0, 0, 1, 0])
    e = np.eye(5)
    tm, sf, pwt, tire = e[0] - e[2], e[0] - e[3], e[4] - e[3], e[1]
    k, c = p[7] / mr**2, p[12] / md**2
    stiff = k * np.outer(spring, spring) + sum(a * np.outer(g, g) for a, g in zip(p[8:12], (tm, sf, pwt, tire)))
    damped = c * np.outer(damper, damper) + sum(a * np.outer(g, g) for a, g in zip(p[13:17], (tm, sf, pwt, tire)))
    z = stiff + 1j * W[:, None, None] * damped - W[:, None, None] ** 2 * np.diag(mass)
    v = np.linalg.inv(z)
    x = v[:, :, 1] * (p[11] + 1j * W * p[16])[:, None]
    s, square = 1j * W[:, None], -(W**2)[:, None]

    def along(g, pull):
        return -(v @ g) * pull[:, None]

    slopes = np.empty((len(W), 5, 17), complex)
    body = -square * v[:, :, 0] * x[:, :1]
    slopes[:, :, 0] = body
    for n in range(1, 5):
        slopes[:, :, n] = -square * v[:, :, n] * x[:, n : n + 1] - body
    turn = -2 * k / mr
    slopes[:, :, 5] = along(turn * spring + k * by_mr, x @ spring) + along(k * spring, x @ by_mr)
    turn = -2 * c / md
    slopes[:, :, 6] = s * (along(turn * damper + c * by_md, x @ damper) + along(c * damper, x @ by_md))
    slopes[:, :, 7] = along(spring, x @ spring) / mr**2
    slopes[:, :, 12] = s * along(damper, x @ damper) / md**2
    for n, g in enumerate((tm, sf, pwt)):
        slopes[:, :, 8 + n] = along(g, x @ g)
        slopes[:, :, 13 + n] = s * slopes[:, :, 8 + n]
    slopes[:, :, 11] = along(tire, x[:, 1] - 1)
    slopes[:, :, 16] = s * slopes[:, :, 11]
    return square * x, square[:, :, None] * slopes


class Fit:
    """Twelve parameters from 1.2 times their values; residual and Jacobian come from one response."""

    def __init__(self, p):
        self.p, self.last = p, None
        h, _ = respond(p)
        self.measured = h / -(W**2)[:, None]

    def at(self, x):
        if self.last is None or not np.array_equal(self.last[0], x):
            p = self.p.copy()
            p[FREE] = x
            h, slopes = respond(p)
            error = np.log(h / -(W**2)[:, None] / self.measured)
            slopes = slopes[:, :, FREE] / h[:, :, None]
            residual = np.concatenate([NEPERS * error.real.ravel(), RADIANS * error.imag.ravel()])
            rows = slopes.reshape(-1, len(FREE))
            self.last = x.copy(), residual, np.concatenate([NEPERS * rows.real, RADIANS * rows.imag])
        return self.last

    def solve(self):
        true = self.p[FREE]
        return least_squares(
            lambda x: self.at(x)[1], 1.2 * true, lambda x: self.at(x)[2], bounds=(0.5 * true, 2 * true), x_scale="jac",
            ftol=1e-9, gtol=1e-8, xtol=1e-7,
        ).x


def show(task, p, fit):
    if task == "response":
        h, slopes = respond(p)
        for i in range(5):
            for n in range(-1, 17):
                for line in (0, 137, 299):
                    value = h[line, i] if n < 0 else slopes[line, i, n]
                    print(i, line, "-" if n < 0 else NAMES[n], repr(float(value.real)), repr(float(value.imag)))
    if task == "fit":
        for n, value in zip(FREE, fit.solve()):
            print(NAMES[n], repr(float(value)))
    print("end", flush=True)


def main():
    p, fit = np.zeros(17), None
    for line in sys.stdin:
        order, *rest = line.split()
        if order == "set":
            if rest[0] in NAMES:
                p[NAMES.index(rest[0])] = float(rest[1])
            continue
        fit = fit or Fit(p)
        if order == "show":
            show(rest[0], p, fit)
            continue
        start = time.thread_time()
        for _ in range(int(rest[1])):
            fit.last = None
            respond(p) if rest[0] == "response" else fit.solve()
        print(repr(time.thread_time() - start), flush=True)


main()
