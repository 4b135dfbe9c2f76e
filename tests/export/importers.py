"""What importers other than FMPy make of a unit: python importers.py IMPORTER UNIT INPUT.csv RESULT.json [PARAMETER VALUE]

INPUT.csv has a column `time` and one for each input, at even times. The result has the outputs at these times, with inputs that
stay from one time to the next, and what the importer complained of.

`libcosim` and `ecos` are masters of co-simulation. `fmi_library`, which libcosim brings along, and `fmuloader` load units for
Model Exchange and leave the integration to others: here SciPy does it.
"""

import csv
import ctypes
import json
import sys
import tempfile
import zipfile
from ctypes import CFUNCTYPE, POINTER, Structure, byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.integrate import solve_ivp

importer, unit, source, result = sys.argv[1:5]
changed = {sys.argv[5]: float(sys.argv[6])} if len(sys.argv) > 5 else {}

with open(source) as file:
    rows = list(csv.reader(file))
inputs, table = rows[0][1:], np.array(rows[1:], dtype=float)
step = table[1, 0]

with zipfile.ZipFile(unit) as archive:
    description = ElementTree.fromstring(archive.read("modelDescription.xml"))
references = {v.get("name"): int(v.get("valueReference")) for v in description.find("ModelVariables")}
outputs = [v.get("name") for v in description.find("ModelVariables") if v.get("causality") == "output"]
to_set, to_get = [references[name] for name in inputs], [references[name] for name in outputs]
complaints = []


def libcosim():
    """Co-Simulation. Nothing is seen before the first step: the axle is at rest."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(step * 1e9))
    axle = execution.add_local_slave(CosimLocalSlave(unit, "axle"))
    assert axle >= 0, "libcosim does not load the unit"
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    assert execution.add_observer(observer) and execution.add_manipulator(manipulator)
    for name, value in changed.items():
        assert execution.real_initial_value(axle, references[name], value)
    rows = [[0.0] * len(outputs)]
    for row in table[:-1]:
        assert manipulator.slave_real_values(axle, to_set, row[1:].tolist())
        assert execution.step(), "a step fails"
        rows.append(observer.last_real_values(axle, to_get))
    return rows


def ecos():
    """Co-Simulation."""
    # Ecos is linked with a library that comes as a package of its own.
    ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    with EcosSimulationStructure() as structure:
        structure.add_model("axle", unit)
        structure.add_parameter_set("changed", {f"axle::{name}": value for name, value in changed.items()})
        with EcosSimulation(structure=structure, step_size=step) as simulation:
            simulation.init(parameter_set="changed" if changed else None)
            seen = lambda: [simulation.get_real(f"axle::{name}") for name in outputs]
            rows = [seen()]
            for row in table[:-1]:
                for name, value in zip(inputs, row[1:]):
                    simulation.set_real(f"axle::{name}", value)
                simulation.step()
                rows.append(seen())
            simulation.terminate()
    return rows


class Callbacks(Structure):
    """jm_callbacks of the FMI Library."""

    LOGGER = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p)
    _fields_ = [
        ("malloc", c_void_p), ("calloc", c_void_p), ("realloc", c_void_p), ("free", c_void_p),
        ("logger", LOGGER), ("level", c_int), ("context", c_void_p), ("message", c_char * 2000)]


class FmiLibrary:
    """A unit of FMI 2.0 in the FMI Library, for Model Exchange."""

    def __init__(self):
        import libcosimpy._internal

        self.library = libcosimpy._internal.libcosimc()
        default = self.call("jm_get_default_callbacks", restype=POINTER(Callbacks)).contents
        self.callbacks = Callbacks.from_buffer_copy(default)
        self.callbacks.logger = Callbacks.LOGGER(lambda _, module, level, message: complaints.append(message.decode()))
        self.callbacks.level = 3  # jm_log_level_warning
        self.folder = tempfile.TemporaryDirectory()
        folder = self.folder.name.encode()
        context = self.call("fmi_import_allocate_context", byref(self.callbacks), restype=c_void_p)
        version = self.call("fmi_import_get_fmi_version", c_void_p(context), unit.encode(), folder)
        assert version == 2, f"fmi_version_enu_t is {version}"
        fmu = self.call("fmi2_import_parse_xml", c_void_p(context), folder, None, restype=c_void_p)
        assert fmu, f"the description is not read: {complaints}"
        self.fmu = c_void_p(fmu)
        self.do("create_dllfmu", 1, None)  # fmi2_fmu_kind_me
        self.do("instantiate", b"axle", 0, None, 0)  # fmi2_model_exchange
        self.do("setup_experiment", 0, c_double(0.0), c_double(0.0), 0, c_double(0.0))
        self.do("enter_initialization_mode")
        self.count = self.call("fmi2_import_get_number_of_continuous_states", self.fmu, restype=c_size_t)
        for name in [*changed, *inputs, *outputs]:
            variable = self.call("fmi2_import_get_variable_by_name", self.fmu, name.encode(), restype=c_void_p)
            assert self.call("fmi2_import_get_variable_vr", c_void_p(variable), restype=c_uint32) == references[name]

    def call(self, name, *arguments, restype=c_int):
        function = self.library[name]
        function.restype = restype
        return function(*arguments)

    def do(self, name, *arguments):
        status = self.call(f"fmi2_import_{name}", self.fmu, *arguments)
        assert status == 0, f"{name} gives {status}: {complaints}"

    def set(self, references, values):
        self.do("set_real", (c_uint32 * len(references))(*references), c_size_t(len(references)), (c_double * len(values))(*values))

    def get(self, references):
        values = (c_double * len(references))()
        self.do("get_real", (c_uint32 * len(references))(*references), c_size_t(len(references)), values)
        return list(values)

    def start(self):
        self.do("exit_initialization_mode")
        self.do("enter_continuous_time_mode")
        return self.vector("get_continuous_states")

    def vector(self, name):
        values = (c_double * self.count)()
        self.do(name, values, c_size_t(self.count))
        return np.array(values)

    def rate(self, time, state):
        self.do("set_time", c_double(time))
        self.do("set_continuous_states", (c_double * self.count)(*state), c_size_t(self.count))
        return self.vector("get_derivatives")

    def end(self):
        self.do("terminate")
        self.call("fmi2_import_free_instance", self.fmu, restype=None)


class FmuLoader:
    """A unit of FMI 3.0 in fmuloader, for Model Exchange."""

    def __init__(self):
        from fmuloader.fmi3 import Fmi3Slave

        self.unit = Fmi3Slave(unit, model_identifier=description.find("ModelExchange").get("modelIdentifier"))
        self.unit.instantiate_model_exchange("axle", instantiation_token=description.get("instantiationToken"))
        self.unit.enter_initialization_mode()
        self.count = self.unit.get_number_of_continuous_states()
        self.set, self.get = self.unit.set_float64, self.unit.get_float64

    def start(self):
        self.unit.exit_initialization_mode()
        self.unit.update_discrete_states()
        self.unit.enter_continuous_time_mode()
        return np.array(self.unit.get_continuous_states(self.count))

    def rate(self, time, state):
        self.unit.set_time(time)
        self.unit.set_continuous_states(list(state))
        return np.array(self.unit.get_continuous_state_derivatives(self.count))

    def end(self):
        self.unit.terminate()
        self.unit.free_instance()


def model_exchange(loaded):
    """From time to time, by an integrator of SciPy."""
    for name, value in changed.items():
        loaded.set([references[name]], [value])
    state, rows = loaded.start(), []
    for row in table:
        loaded.rate(row[0], state)
        loaded.set(to_set, row[1:].tolist())
        rows.append(loaded.get(to_get))
        span = (row[0], row[0] + step)
        solved = solve_ivp(loaded.rate, span, state, method="DOP853", rtol=1e-11, atol=1e-13)
        assert solved.success, solved.message
        state = solved.y[:, -1]
    loaded.end()
    return rows


rows = {
    "libcosim": libcosim,
    "ecos": ecos,
    "fmi_library": lambda: model_exchange(FmiLibrary()),
    "fmuloader": lambda: model_exchange(FmuLoader()),
}[importer]()
with open(result, "w") as file:
    json.dump({"complaints": complaints, "outputs": dict(zip(outputs, zip(*rows)))}, file)
