"""The type hints hold, as far as mypy can tell."""

import pytest


def test_the_package_is_typed(repository):
    api = pytest.importorskip("mypy.api", reason="mypy is not installed: type hints are passed over")
    said, complaints, status = api.run(["--strict", "--cache-dir=/dev/null", str(repository / "qcar-python/python/qcar")])
    assert status == 0, said + complaints
