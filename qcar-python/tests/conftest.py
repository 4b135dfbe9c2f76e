"""What the tests share."""

from pathlib import Path

import pytest

import qcar

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def repository() -> Path:
    """The folder of the clone."""
    return REPOSITORY


@pytest.fixture(scope="session")
def campaigns() -> Path:
    """The shipped campaigns."""
    return REPOSITORY / "models" / "campaigns"


@pytest.fixture(scope="session")
def quarter_car() -> qcar.Model:
    """The smallest axle: all of its parameters have defaults."""
    return qcar.Model("quarter_car")


@pytest.fixture(scope="session")
def axle_d() -> qcar.Model:
    """Five masses, nineteen parameters."""
    return qcar.Model("axle_d")


@pytest.fixture(scope="session")
def axle_d_values(axle_d: qcar.Model) -> dict[str, float]:
    """Some value for every parameter of it: the geometric mean of its range."""
    values = {own.name: (own.range[0] * own.range[1]) ** 0.5 for own in axle_d.parameters if own.range}
    return {**values, "static_tire_load": 4400.0, "static_tire_def": 0.02}
