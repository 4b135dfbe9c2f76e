"""Parts and results of a model as named tuples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


class Parameter(NamedTuple):
    """A parameter of a model."""

    name: str
    #: Unit, such as ``N s/m``.
    unit: str
    doc: str
    #: Default value; ``None`` if the value must be given, or follows another parameter.
    default: float | None
    #: The parameter whose value it takes unless it is given.
    same_as: str | None
    #: Plausible range.
    range: tuple[float, float] | None
    #: Whether it is estimated only if a campaign asks for it.
    known: bool


class State(NamedTuple):
    """A state: a row and column of A."""

    name: str
    unit: str
    #: The mass or node that moves, or the link of an inner state.
    location: str
    axis: str
    #: ``position``, ``velocity`` or ``inner``.
    kind: str


class Input(NamedTuple):
    """An input: a column of B and D."""

    name: str
    unit: str
    #: The road, motion or force that it belongs to.
    excitation: str
    axis: str
    #: ``road``, ``road_rate``, ``road_acceleration``, the same of ``motion``, ``force`` or ``gravity``.
    kind: str


class Output(NamedTuple):
    """An output: a row of C and D."""

    name: str
    unit: str
    #: The mass, node or link that is measured.
    location: str
    axis: str
    #: ``position``, ``velocity``, ``acceleration``, ``force`` or ``stretch``.
    kind: str


class Excitation(NamedTuple):
    """The excitation of a frequency response: a motion with its derivatives, or a force."""

    name: str
    #: ``m`` or ``N``: the response is per unit of it.
    unit: str
    axis: str
    #: ``road``, ``motion`` or ``force``.
    kind: str


class StateSpace(NamedTuple):
    """``dx/dt = A x + B u``, ``y = C x + D u``; the axes of a batch of parameter sets come first.

    SciPy accepts it in place of ``A, B, C, D``: ``scipy.signal.StateSpace(*model.matrices())``.
    """

    #: (..., states, states)
    A: Array
    #: (..., states, inputs)
    B: Array
    #: (..., outputs, states)
    C: Array
    #: (..., outputs, inputs)
    D: Array


class Jacobians(NamedTuple):
    """Derivatives of A, B, C and D by each parameter: ``dA["k_tire"]`` has the shape of A.

    A derivative includes the effect of parameters that take their value from this one; those have no entry.
    """

    dA: dict[str, Array]
    dB: dict[str, Array]
    dC: dict[str, Array]
    dD: dict[str, Array]


class Mode(NamedTuple):
    """A mode of vibration."""

    #: Undamped natural frequency, Hz.
    frequency: float
    #: Damping ratio, below 1.
    damping: float
    #: Amplitudes of the positions that move, by the name of the state; the largest is 1.
    shape: dict[str, complex]
