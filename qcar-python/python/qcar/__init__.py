"""Quarter-car axle models: matrices, responses, fits and rides as NumPy arrays, in SI units.

>>> import qcar
>>> model = qcar.Model("quarter_car")
>>> A, B, C, D = model.matrices({"k_tire": 2e5})
"""

from ._discover import Verdict, discover
from ._ensemble import ride_metrics
from ._fit import Fit, Ratio, fit
from ._html import Figure
from ._model import Model
from ._named import (
    Excitation,
    Input,
    Jacobians,
    Mode,
    Output,
    Parameter,
    State,
    StateSpace,
)
from ._native import CampaignError, Error, ModelError, ParameterError, SimulationError, __version__, models
from ._ride import History, Ride, Simulation, read_parameters, read_vehicle, ride, simulate

__all__ = [
    "CampaignError",
    "Error",
    "Excitation",
    "Figure",
    "Fit",
    "History",
    "Input",
    "Jacobians",
    "Mode",
    "Model",
    "ModelError",
    "Output",
    "Parameter",
    "ParameterError",
    "Ratio",
    "Ride",
    "Simulation",
    "SimulationError",
    "State",
    "StateSpace",
    "Verdict",
    "__version__",
    "discover",
    "fit",
    "models",
    "read_parameters",
    "read_vehicle",
    "ride",
    "ride_metrics",
    "simulate",
]
