"""Models: shipped ones, and those from files or texts."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Union, overload

import numpy as np
import numpy.typing as npt

from . import _html, _native
from ._named import (
    Array,
    ComplexArray,
    Excitation,
    Input,
    Jacobians,
    Mode,
    Output,
    Parameter,
    State,
    StateSpace,
)

#: Values by name, numbers or arrays that broadcast against each other; or an array whose last axis is ``Model.parameters``;
#: or ``None`` if every parameter has a default.
Parameters = Union[Mapping[str, npt.ArrayLike], npt.ArrayLike, None]

#: A function that evaluates parameter sets at frequencies: values, and derivatives with parameters along the second axis.
_OverLines = Callable[[Array, Sequence[int], Array, bool], tuple[ComplexArray, Union[ComplexArray, None]]]


class Model:
    """A quarter-car axle model.

    ``qcar.Model("axle_d")`` is a shipped model (``qcar.models()`` lists them) or, by its path, a model file.
    All quantities are in SI units. Wherever a method takes `params`, parameters that are not given have their defaults,
    and arrays of values are evaluated set by set: the batch axes come first in the result, and each set gives the same
    bits as on its own.

    Raises
    ------
    qcar.ModelError
        The compiler refuses the model; the message is its whole report.
    """

    def __init__(self, model: str | os.PathLike[str]) -> None:
        name = os.fspath(model)
        is_path = any(sign in name for sign in "/\\.")
        # An absolute path, because an unpickled model may be in a process with another working directory.
        self._begin(_native.Model.load(name), ("load", os.path.abspath(name) if is_path else name))

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Model:
        """The model in a file of any name."""
        path = os.fspath(path)
        return cls(path if os.path.dirname(path) else os.path.join(os.curdir, path))

    @classmethod
    def from_text(cls, text: str, name: str = "text.axle") -> Model:
        """The model in a text.

        A family that it refers to (``from "corner.axle"``) is searched in the folder of `name`.
        """
        model = cls.__new__(cls)
        model._begin(_native.Model.text(text, name), ("text", text, name))
        return model

    def _begin(self, native: _native.Model, source: tuple[str, ...]) -> None:
        about = json.loads(native.about())
        self._native = native
        self._source = source
        self.name: str = about["name"]
        #: The sentence that describes it.
        self.doc: str = about["doc"]
        #: Whether A, B, C and D hold for any state; otherwise they are a linearisation.
        self.linear: bool = about["linear"]
        self.parameters: tuple[Parameter, ...] = tuple(_parameter(own) for own in about["parameters"])
        self.states: tuple[State, ...] = tuple(_state(own) for own in about["states"])
        self.inputs: tuple[Input, ...] = tuple(_input(own) for own in about["inputs"])
        self.outputs: tuple[Output, ...] = tuple(Output(**own) for own in about["outputs"])
        self.excitations: tuple[Excitation, ...] = tuple(Excitation(**own) for own in about["excitations"])
        #: Names of the ratios that the model declares.
        self.channels: tuple[str, ...] = tuple(about["channels"])

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, self._source

    def __repr__(self) -> str:
        return (
            f"<qcar.Model {self.name}: {len(self.parameters)} parameters, {len(self.states)} states, "
            f"{len(self.inputs)} inputs, {len(self.outputs)} outputs>"
        )

    def _repr_html_(self) -> str:
        return _html.model(self)

    def show(self, stage: str = "equations") -> str:
        """A stage of the model as text.

        Parameters
        ----------
        stage
            ``"model"``: its text with options resolved; ``"equations"`` of motion; ``"matrices"``: their nonzeros as formulas;
            ``"latex"``: both as a document; ``"rust"``: the generated module; ``"dot"``: masses and links as a graph for Graphviz.
        """
        how, *source = self._source
        name, text = (source[0], None) if how == "load" else (source[1], source[0])
        return _native.Model.shown(stage, name, text)

    def values(self, params: Parameters = None) -> Array:
        """The value of every parameter, in the order of `parameters`: (..., parameters), SI.

        Raises
        ------
        qcar.ParameterError
            A name that the model does not have, a parameter without value and default, a value that is not finite, or masses that
            are not above zero.
        """
        p, _, batch = self._resolve(params)
        return p.reshape(*batch, len(self.parameters))

    def derivative(self, x: npt.ArrayLike, u: npt.ArrayLike | None = None, params: Parameters = None) -> Array:
        """The rates of the states, ``dx/dt = f(x, u)``, for ``scipy.integrate.solve_ivp`` and others: (..., states).

        Parameters
        ----------
        x, u
            States (..., states) and inputs (..., inputs), displacements from the design position. Inputs that are
            left out are zero.
        params
            Parameter values; they, `x` and `u` broadcast against each other.
        """
        at, _, batch = self._at(params, x, u)
        return self._native.derivatives(at).reshape(*batch, len(self.states))

    def output(self, x: npt.ArrayLike, u: npt.ArrayLike | None = None, params: Parameters = None) -> Array:
        """The outputs ``y = h(x, u)``: (..., outputs), with the arguments of `derivative`."""
        at, _, batch = self._at(params, x, u)
        return self._native.outputs(at).reshape(*batch, len(self.outputs))

    def matrices(
        self, params: Parameters = None, x: npt.ArrayLike | None = None, u: npt.ArrayLike | None = None
    ) -> StateSpace:
        """A, B, C and D as dense arrays, for each parameter set.

        Parameters
        ----------
        params
            Parameter values.
        x, u
            States (..., states) and inputs (..., inputs) about which a nonlinear model is linearised; by default at rest.
            A linear model has the same matrices everywhere.
        """
        at, _, batch = self._at(params, x, u)
        return StateSpace(*(own.reshape(*batch, *own.shape[1:]) for own in self._native.matrices(at)))

    def jacobians(
        self, params: Parameters = None, x: npt.ArrayLike | None = None, u: npt.ArrayLike | None = None
    ) -> Jacobians:
        """The exact derivatives of A, B, C and D by every parameter, with the arguments of `matrices`."""
        at, leader, batch = self._at(params, x, u)
        return Jacobians(*(self._by_name(own, leader, batch) for own in self._native.jacobians(at, leader)))

    @overload
    def frf(
        self, frequencies: npt.ArrayLike, params: Parameters = None, jacobian: Literal[False] = False
    ) -> ComplexArray: ...

    @overload
    def frf(
        self, frequencies: npt.ArrayLike, params: Parameters = None, *, jacobian: Literal[True]
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]: ...

    def frf(
        self, frequencies: npt.ArrayLike, params: Parameters = None, jacobian: bool = False
    ) -> ComplexArray | tuple[ComplexArray, dict[str, ComplexArray]]:
        """The frequency response of every output to every excitation.

        Parameters
        ----------
        frequencies
            Hz, above zero: (lines,).
        params
            Parameter values.
        jacobian
            Whether to return the derivatives as well.

        Returns
        -------
        response
            (..., lines, outputs, excitations), in units of the output per m of a motion or per N of a force. An excitation is a
            motion with those of its rate and acceleration that are inputs. Nonlinear models are linearised at rest.
        derivatives
            With `jacobian`: for each parameter by name an array of the shape of the response.
        """
        return self._over_lines(self._native.responses, frequencies, params, jacobian)

    @overload
    def ratios(
        self, frequencies: npt.ArrayLike, params: Parameters = None, jacobian: Literal[False] = False
    ) -> ComplexArray: ...

    @overload
    def ratios(
        self, frequencies: npt.ArrayLike, params: Parameters = None, *, jacobian: Literal[True]
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]: ...

    def ratios(
        self, frequencies: npt.ArrayLike, params: Parameters = None, jacobian: bool = False
    ) -> ComplexArray | tuple[ComplexArray, dict[str, ComplexArray]]:
        """The named ratios of the model, such as the transmissibility ``pad_to_body``: (..., lines, channels).

        Channels are in the order of `channels`; the arguments are those of `frf`. The excitation of a ratio is its denominator if that
        can be prescribed, otherwise the road. A ratio of two accelerations equals that of the displacements.
        """
        return self._over_lines(self._native.ratios, frequencies, params, jacobian)

    def _over_lines(
        self, evaluate: _OverLines, frequencies: npt.ArrayLike, params: Parameters, jacobian: bool
    ) -> ComplexArray | tuple[ComplexArray, dict[str, ComplexArray]]:
        p, leader, batch = self._resolve(params)
        lines = np.atleast_1d(np.asarray(frequencies, dtype=float))
        if lines.ndim != 1 or not np.all(np.isfinite(lines)) or not np.all(lines > 0):
            raise _native.ParameterError(f"frequencies are one row of numbers above 0 Hz, found {frequencies!r}")
        value, slopes = evaluate(p, leader, np.ascontiguousarray(lines), bool(jacobian))
        value = value.reshape(*batch, *value.shape[1:])
        if slopes is None:
            return value
        return value, self._by_name(slopes, leader, batch)

    def modes(self, params: Parameters = None) -> list[Mode]:
        """The modes of the model linearised at rest, lowest frequency first, for one parameter set."""
        p, _, batch = self._resolve(params)
        if batch:
            raise _native.ParameterError(f"modes are those of one parameter set, found sets of the shape {batch}")
        names = {(own.location, own.axis): own.name for own in self.states if own.kind == "position"}
        found = self._native.modes(p[0])
        return [
            Mode(frequency, damping, {names[at, axis]: amplitude for at, axis, amplitude in shape})
            for frequency, damping, shape in found
        ]

    def _by_name(self, slopes: Any, leader: Sequence[int], batch: tuple[int, ...]) -> dict[str, Any]:
        """Views into derivatives (sets, parameters, ...), for each parameter that follows no other."""
        of_batch = np.moveaxis(slopes.reshape(*batch, *slopes.shape[1:]), len(batch), 0)
        own = ((place, parameter.name) for place, parameter in enumerate(self.parameters) if leader[place] == place)
        return {name: of_batch[place] for place, name in own}

    def _resolve(self, params: Parameters) -> tuple[Array, list[int], tuple[int, ...]]:
        """All parameters (sets, parameters), the index of the parameter that each one follows, and the shape of the batch."""
        names, columns, batch = self._columns(params)
        given = np.empty((int(np.prod(batch, dtype=int)), len(names)))
        for place, column in enumerate(columns):
            given[:, place] = column if column.ndim == 0 else np.broadcast_to(column, batch).reshape(-1)
        p, leader = self._native.resolve(names, given)
        return p, leader, batch

    def _columns(self, params: Parameters) -> tuple[list[str], list[Array], tuple[int, ...]]:
        if params is None:
            return [], [], ()
        if isinstance(params, Mapping):
            names = list(params)
            try:
                columns = [np.asarray(params[name], dtype=float) for name in names]
                return names, columns, np.broadcast_shapes(*(column.shape for column in columns))
            except (TypeError, ValueError) as error:
                shapes = ", ".join(f"{name} {np.shape(params[name])}" for name in names)
                raise _native.ParameterError(f"values are numbers or arrays of one shape, found {shapes}: {error}") from None
        array = np.asarray(params, dtype=float)
        if array.ndim == 0 or array.shape[-1] != len(self.parameters):
            raise _native.ParameterError(
                f"an array of parameters of `{self.name}` has the shape (..., {len(self.parameters)}), found {array.shape}; "
                "give a dict to name some of them"
            )
        names = [parameter.name for parameter in self.parameters]
        return names, [array[..., place] for place in range(len(names))], array.shape[:-1]

    def _at(
        self, params: Parameters, x: npt.ArrayLike | None, u: npt.ArrayLike | None
    ) -> tuple[tuple[Array, Array, Array], list[int], tuple[int, ...]]:
        """Parameters, states and inputs (sets, ...), the index of the parameter that each one follows, and the shape of the batch."""
        p, leader, batch = self._resolve(params)
        points = [p.reshape(*batch, p.shape[-1]), _rows("x", x, len(self.states)), _rows("u", u, len(self.inputs))]
        try:
            batch = np.broadcast_shapes(*(own.shape[:-1] for own in points))
        except ValueError as error:
            raise _native.ParameterError(f"parameters, x and u do not broadcast against each other: {error}") from None
        every = (np.array(np.broadcast_to(own, (*batch, own.shape[-1]))).reshape(-1, own.shape[-1]) for own in points)
        return (next(every), next(every), next(every)), leader, batch


def _rows(what: str, given: npt.ArrayLike | None, count: int) -> Array:
    value = np.zeros(count) if given is None else np.asarray(given, dtype=float)
    if value.ndim == 0 or value.shape[-1] != count:
        raise _native.ParameterError(f"{what} has the shape (..., {count}), found {value.shape}")
    return value


def _again(how: str, *source: str) -> Model:
    """Restores a pickled model from its name or path, or from its text."""
    return Model(source[0]) if how == "load" else Model.from_text(*source)


def _parameter(of: dict[str, Any]) -> Parameter:
    return Parameter(**{**of, "range": of["range"] and tuple(of["range"])})


def _state(of: dict[str, Any]) -> State:
    location = of.get("mass") or of["link"]
    return State(of["name"], of["unit"], location, of["axis"], of["kind"])


def _input(of: dict[str, Any]) -> Input:
    return Input(of["variable"], of["unit"], of["name"], of["axis"], of["kind"])
