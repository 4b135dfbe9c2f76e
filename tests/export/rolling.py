"""What FMPy makes of a unit whose tyre rolls: python rolling.py UNIT RESULT.json SAMPLES RATE [PARAMETER=VALUE ...]

The result has the problems that validation finds and, by both kinds of simulation, the signals at even times.
"""

import json
import re
import sys
import zipfile

from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

unit, result, samples, rate = sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
changed = {name: float(value) for name, value in (text.split("=") for text in sys.argv[5:])}
description = read_model_description(unit)
signals = [v.name for v in description.modelVariables if v.causality == "output" or v.derivative is not None]


def simulate(kind, **options):
    found = simulate_fmu(
        unit, fmi_type=kind, start_time=0.0, stop_time=(samples - 1) / rate, output_interval=1.0 / rate, output=signals,
        record_events=False, start_values=changed, **options)
    assert len(found) == samples, f"{kind}: {len(found)} samples"
    return {name: found[name].tolist() for name in signals}


def promises():
    """What the description says of directional derivatives; FMPy does not read this of FMI 3.0."""
    with zipfile.ZipFile(unit) as archive:
        text = archive.read("modelDescription.xml").decode()
    return re.findall(r'providesDirectionalDerivatives?="(\w+)"', text)


answer = {
    "promises": promises(),
    "problems": [str(problem) for problem in validate_fmu(unit)],
    "model_exchange": simulate("ModelExchange", solver="CVode", relative_tolerance=1e-11),
    "co_simulation": simulate("CoSimulation"),
}
with open(result, "w") as file:
    json.dump(answer, file)
