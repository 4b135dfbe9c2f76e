"""Writes axle_d in z as C by CasADi (`casadi_model.c`, `.h`) into the folder that is given: matrices with their Jacobians, and a line of the
response with its Jacobian, as CasADi derives them from the equations of motion."""

import os
import sys

import casadi as ca

NAMES = """m_corner m_wheel m_tm m_sf m_pwt mr_spring mr_damper k_wheel_z k_tm k_sf_z k_pwt_z k_tire
c_wheel_z c_tm c_sf_z c_pwt_z c_tire""".split()
p = ca.SX.sym("p", len(NAMES))
of = dict(zip(NAMES, ca.vertsplit(p)))


def accelerations(z, v, u):
    """Of body, wheel, tm, sf and pwt; `u` is the pad, its speed, a force on the wheel and gravity."""
    mr, md = of["mr_spring"], of["mr_damper"]
    spring = of["k_wheel_z"] / mr**2 * (z[0] - (1 - mr) * z[3] - mr * z[1])
    damper = of["c_wheel_z"] / md**2 * (v[2] - (1 - md) * v[3] - md * v[1])
    tm = of["k_tm"] * (z[0] - z[2]) + of["c_tm"] * (v[0] - v[2])
    sf = of["k_sf_z"] * (z[0] - z[3]) + of["c_sf_z"] * (v[0] - v[3])
    pwt = of["k_pwt_z"] * (z[4] - z[3]) + of["c_pwt_z"] * (v[4] - v[3])
    tire = of["k_tire"] * (z[1] - u[0]) + of["c_tire"] * (v[1] - u[1])
    body = of["m_corner"] - of["m_wheel"] - of["m_tm"] - of["m_sf"] - of["m_pwt"]
    return ca.vertcat(
        (-spring - tm - sf) / body - u[3],
        (-tire + mr * spring + md * damper + u[2]) / of["m_wheel"] - u[3],
        (-damper + tm) / of["m_tm"] - u[3],
        ((1 - mr) * spring + (1 - md) * damper + sf + pwt) / of["m_sf"] - u[3],
        -pwt / of["m_pwt"] - u[3],
    )


def matrices():
    """A, B, C and D by their nonzeros with those of their Jacobians, and what each is: row, column, parameter."""
    x, u = ca.SX.sym("x", 10), ca.SX.sym("u", 4)
    y = accelerations(x[:5], x[5:], u)
    rates = ca.vertcat(x[5:], y)
    values, places = [], []
    for result, by, shift in [(rates, x, 0), (rates, u, 10), (y, x, 0), (y, u, 10)]:
        entries = ca.jacobian(result, by)
        for row, column in zip(*entries.sparsity().get_triplet()):
            values.append(entries[row, column])
            accelerates = result is rates and row >= 5
            places.append((row - 5, column + shift, -1) if accelerates else (0, 0, 99))
    values = ca.vertcat(*values)
    slopes = ca.jacobian(values, p)
    for entry, parameter in zip(*slopes.sparsity().get_triplet()):
        row, column, kind = places[entry]
        places.append((row, column, parameter if kind < 0 else 99))
    slopes = ca.vertcat(*[slopes[entry, n] for entry, n in zip(*slopes.sparsity().get_triplet())])
    return ca.Function("axle_matrices", [p], [values, slopes]), values.numel(), places


def times(a, b):
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1]


def over(a, b):
    size = b[0] ** 2 + b[1] ** 2
    return (a[0] * b[0] + a[1] * b[1]) / size, (a[1] * b[0] - a[0] * b[1]) / size


def solved(matrix, right):
    """By elimination; complex numbers are pairs, which CasADi has none of."""
    count = len(right)
    for n in range(count):
        for row in range(n + 1, count):
            factor = over(matrix[row][n], matrix[n][n])
            matrix[row] = [minus(a, times(factor, b)) for a, b in zip(matrix[row], matrix[n])]
            right[row] = minus(right[row], times(factor, right[n]))
    x = [None] * count
    for n in reversed(range(count)):
        rest = right[n]
        for column in range(n + 1, count):
            rest = minus(rest, times(matrix[n][column], x[column]))
        x[n] = over(rest, matrix[n][n])
    return x


def response():
    """Real and imaginary parts of the accelerations per metre of pad, and their Jacobian, at one circular frequency."""
    w = ca.SX.sym("w")
    z, v, u = ca.SX.sym("z", 5), ca.SX.sym("v", 5), ca.SX.sym("u", 4)
    y = accelerations(z, v, u)
    real = -ca.jacobian(y, z) - w**2 * ca.SX.eye(5)
    imaginary = -w * ca.jacobian(y, v)
    matrix = [[(real[i, j], imaginary[i, j]) for j in range(5)] for i in range(5)]
    pad, speed = ca.jacobian(y, u[0]), ca.jacobian(y, u[1])
    x = solved(matrix, [(pad[i], w * speed[i]) for i in range(5)])
    moved = -(w**2) * ca.vertcat(*[re for re, _ in x], *[im for _, im in x])
    return ca.Function("axle_response", [p, w], [ca.densify(moved), ca.densify(ca.jacobian(moved, p))])


if __name__ == "__main__":
    os.chdir(sys.argv[1])
    linear, count, places = matrices()
    written = ca.CodeGenerator("casadi_model.c", {"with_header": True})
    written.add(linear)
    written.add(response())
    written.generate()
    with open("casadi_model.h", "a") as header:
        rows = ",".join("{%d,%d,%d}" % place for place in places)
        header.write(f"#define CASADI_VALUES {count}\n#define CASADI_RESULTS {len(places)}\n")
        header.write(f"static const int casadi_place[CASADI_RESULTS][3] = {{{rows}}};\n")
