"""What pymoca and CasADi make of a flat model: python modelica.py FOLDER MODEL POINT.json RESULT.json

POINT.json has a value for each state and input; the result has the derivatives of the states, and the outputs, there.
"""

import json
import sys

import casadi
import numpy as np

# pymoca asks CasADi for the division of Python 2.
casadi.MX.__div__ = casadi.MX.__truediv__

from pymoca.backends.casadi.api import transfer_model  # noqa: E402

folder, name, point, result = sys.argv[1:5]
model = transfer_model(folder, name, {"cache": False})
with open(point) as file:
    given = json.load(file)


def names(variables):
    return [variable.symbol.name() for variable in variables]


def of(variables):
    return np.array([given[name] for name in names(variables)])


# Parameters that are computed from others have their values after as many rounds as they are deep.
symbols = casadi.vertcat(*[p.symbol for p in model.parameters])
bindings = casadi.Function("bindings", [symbols], [casadi.vertcat(*[p.value for p in model.parameters])])
parameters = np.zeros(len(model.parameters))
for _ in model.parameters:
    parameters = np.array(bindings(parameters)).ravel()

# What is asked for are the derivatives and all that equations compute; each equation has one of them alone on its left.
count = len(model.der_states)
unknown = casadi.MX.sym("unknown", count + len(model.alg_states))
residual = model.dae_residual_function(
    0.0, of(model.states), unknown[:count], unknown[count:], of(model.inputs), [], parameters)
evaluate = casadi.Function("evaluate", [unknown], [residual, casadi.jacobian(residual, unknown)])
found = np.zeros(unknown.numel())
for _ in range(unknown.numel()):
    errors, slopes = (np.array(value) for value in evaluate(found))
    step = np.linalg.solve(slopes, errors.ravel())
    found = found - step
    if np.all(np.abs(step) <= 1e-14 * np.abs(found)):
        break

rates = dict(zip(names(model.states), found[:count]))
algebraic = dict(zip(names(model.alg_states), found[count:]))
with open(result, "w") as out:
    json.dump({
        "parameters": {name: float(value) for name, value in zip(names(model.parameters), parameters)},
        "derivatives": {name: float(value) for name, value in rates.items()},
        "outputs": {name: float(algebraic[name]) for name in model.outputs},
    }, out)
