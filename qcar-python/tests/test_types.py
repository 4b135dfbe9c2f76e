"""The type hints hold, as far as mypy can tell."""

import pytest


def test_the_package_is_typed(repository):
    api = pytest.importorskip("mypy.api", reason="mypy is not installed: type hints are passed over")
    folder = repository / "qcar-python"
    arguments = ["--config-file", str(folder / "pyproject.toml"), "--cache-dir=/dev/null", str(folder / "python/qcar")]
    said, complaints, status = api.run(arguments)
    assert status == 0, said + complaints
