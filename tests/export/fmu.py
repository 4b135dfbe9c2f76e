"""What FMPy makes of a unit: python fmu.py UNIT INPUT.csv RESULT.json [PARAMETER VALUE]

INPUT.csv has a column `time` and one for each input, at even times. The result has the problems that validation finds, the
outputs at these times, and the Jacobian by each state, input and parameter at a state that is not rest.

`straight` is with inputs that are joined by straight lines, call by call, since FMPy's integrator asks for derivatives at times
for which it has not set the inputs, and its input derivatives are for units of nine inputs: Model Exchange by an integrator of
SciPy, and Co-Simulation of FMI 2.0. `held` is by FMPy's simulation, with inputs that stay from one time to the next.
"""

import csv
import json
import shutil
import sys
from ctypes import c_double, c_int, c_uint32

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu
from scipy.integrate import solve_ivp

unit, inputs, result = sys.argv[1:4]
changed = {sys.argv[4]: float(sys.argv[5])} if len(sys.argv) > 4 else {}

with open(inputs) as file:
    rows = list(csv.reader(file))
names, table = rows[0], np.array(rows[1:], dtype=float)
times = table[:, 0]
# At each time what was before it, then what is from it on.
stairs = [(time, *row) for time, before, after in zip(times, [table[0], *table], table) for row in (before[1:], after[1:])]
signals = np.array(stairs[1:], dtype=[(name, float) for name in names])

description = read_model_description(unit)
is_fmi3 = description.fmiVersion.startswith("3.")
outputs = [v.name for v in description.modelVariables if v.causality == "output"]


def simulate(kind, **options):
    found = simulate_fmu(
        unit, fmi_type=kind, start_time=0.0, stop_time=times[-1], output_interval=times[1] - times[0],
        input=signals, output=outputs, record_events=False, start_values=changed, **options)
    assert np.allclose(found["time"], times, rtol=0, atol=1e-9), f"{kind}: other times than asked for"
    return {name: found[name].tolist() for name in outputs}


def instance(kind, folder):
    """A unit that is initialised, the references of its inputs, and how to set and get reals."""
    of = description.modelExchange if kind.endswith("Model") else description.coSimulation
    model = {"FMU2Model": FMU2Model, "FMU2Slave": FMU2Slave, "FMU3Model": FMU3Model, "FMU3Slave": FMU3Slave}[kind](
        guid=description.guid, unzipDirectory=folder, instanceName=kind, modelIdentifier=of.modelIdentifier)
    model.instantiate()
    if is_fmi3:
        model.enterInitializationMode(startTime=0.0)
        put, get = model.setFloat64, model.getFloat64
    else:
        model.setupExperiment(startTime=0.0)
        model.enterInitializationMode()
        put, get = model.setReal, model.getReal
    for name, value in changed.items():
        put([references[name]], [value])
    return model, put, get


references = {v.name: v.valueReference for v in description.modelVariables}
inputs = [references[name] for name in names[1:]]
wanted = [references[name] for name in outputs]
derivatives = [v for v in description.modelVariables if v.derivative is not None]


def columns(rows):
    return {name: list(column) for name, column in zip(outputs, zip(*rows))}


def model_exchange(folder):
    """Model Exchange by an integrator of SciPy, from time to time."""
    model, put, get = instance("FMU3Model" if is_fmi3 else "FMU2Model", folder)
    model.exitInitializationMode()
    model.enterContinuousTimeMode()
    count = len(derivatives)
    x, dx = (c_double * count)(), (c_double * count)()
    model.getContinuousStates(x, count)
    state, rows = np.array(x), []

    def move(time, state, u):
        model.setTime(time)
        put(inputs, u.tolist())
        x[:] = state
        model.setContinuousStates(x, count)

    for now, after in zip(table, [*table[1:], None]):
        move(now[0], state, now[1:])
        rows.append(get(wanted))
        if after is None:
            break
        slope = (after - now)[1:] / (after[0] - now[0])

        def rate(time, state):
            move(time, state, now[1:] + slope * (time - now[0]))
            (model.getContinuousStateDerivatives if is_fmi3 else model.getDerivatives)(dx, count)
            return np.array(dx)

        solved = solve_ivp(rate, (now[0], after[0]), state, method="DOP853", rtol=1e-11, atol=1e-13)
        assert solved.success, solved.message
        state = solved.y[:, -1]
    model.terminate()
    model.freeInstance()
    return columns(rows)


def co_simulation(folder):
    """Co-Simulation of FMI 2.0 whose inputs grow along each step."""
    model, put, get = instance("FMU2Slave", folder)
    put(inputs, table[0, 1:].tolist())
    model.exitInitializationMode()
    first = (c_uint32 * len(inputs))(*inputs), len(inputs), (c_int * len(inputs))(*[1] * len(inputs))
    rows = [get(wanted)]
    for now, after in zip(table, table[1:]):
        step = after[0] - now[0]
        put(inputs, now[1:].tolist())
        rates = (c_double * len(inputs))(*((after - now)[1:] / step))
        model.fmi2SetRealInputDerivatives(model.component, *first, rates)
        model.doStep(now[0], step)
        rows.append(get(wanted))
    model.terminate()
    model.freeInstance()
    return columns(rows)


def returns(folder):
    """Whether a unit goes on alike from a state that was saved, and from one that was serialised too."""
    model, put, get = instance("FMU3Slave" if is_fmi3 else "FMU2Slave", folder)
    model.exitInitializationMode()
    step = times[1] - times[0]
    put(inputs, table[10, 1:].tolist())
    model.doStep(0.0, step)
    save, restore = ((model.getFMUState, model.setFMUState) if is_fmi3 else (model.getFMUstate, model.setFMUstate))
    saved = save()
    bytes_of = (model.serializeFMUState if is_fmi3 else model.serializeFMUstate)(saved)
    seen = []
    for state in [None, saved, (model.deserializeFMUState if is_fmi3 else model.deSerializeFMUstate)(bytes_of)]:
        if state is not None:
            restore(state)
        put(inputs, table[20, 1:].tolist())
        model.doStep(step, step)
        seen.append(list(get(wanted)))
    model.terminate()
    model.freeInstance()
    return seen[0] == seen[1] == seen[2] and any(seen[0])


def refuses(folder):
    """Whether a unit refuses what cannot be set, with a status that FMPy takes for a failure."""
    model, put, _ = instance("FMU3Model" if is_fmi3 else "FMU2Model", folder)
    refused = 0
    for reference, value in [(wanted[0], 1.0), (10 ** 6, 1.0), (inputs[0], float("nan"))]:
        try:
            put([reference], [value])
        except FMICallException:
            refused += 1
    model.freeInstance()
    return refused == 3


def jacobian(folder):
    """The directional derivative by each variable that is known, at a point."""
    model, put, _ = instance("FMU3Model" if is_fmi3 else "FMU2Model", folder)
    moving = [v.derivative.valueReference for v in derivatives] + inputs
    for place, reference in enumerate(moving):
        put([reference], [1e-3 * (place + 1) * (-1) ** place])
    model.exitInitializationMode()
    unknown = [v.valueReference for v in derivatives] + wanted
    known = moving + [v.valueReference for v in description.modelVariables if v.causality == "parameter"]
    name_of = {reference: name for name, reference in references.items()}
    found = {name_of[at]: list(model.getDirectionalDerivative(unknown, [at], [1.0])) for at in known}
    model.terminate()
    model.freeInstance()
    return found


folder = extract(unit)
answer = {
    "problems": [str(problem) for problem in validate_fmu(unit)],
    "variables": {v.name: [v.causality, v.unit, v.start] for v in description.modelVariables},
    "held": {
        "model_exchange": simulate("ModelExchange", solver="CVode", relative_tolerance=2e-11),
        "co_simulation": simulate("CoSimulation"),
    },
    "straight": {
        "model_exchange": model_exchange(folder),
        "co_simulation": None if is_fmi3 else co_simulation(folder),
    },
    "jacobian": jacobian(folder),
    "returns": returns(folder),
    "refuses": refuses(folder),
}
shutil.rmtree(folder)
with open(result, "w") as file:
    json.dump(answer, file)
