"""Rides of designs: alone, and on a cluster that loses a worker."""

import os
import signal

import numpy as np
import pytest

import qcar

VEHICLE = {"r_tire": 0.32, "static_tire_def": 0.02, "static_tire_load": 4400.0}
ROWS = 300


@pytest.fixture(scope="module")
def design():
    random = np.random.default_rng(17)
    return {
        "k_tire": random.uniform(1.5e5, 3e5, ROWS),
        "c_wheel_z": random.uniform(800.0, 2500.0, ROWS),
        "speed": random.uniform(5.0, 12.0, ROWS),
        "height": 0.02,
    }


@pytest.fixture(scope="module")
def alone(quarter_car, design):
    return qcar.ride_metrics(quarter_car, design, vehicle=VEHICLE)


def same(first, second):
    assert list(first) == list(second)
    for name in first:
        np.testing.assert_array_equal(first[name], second[name], err_msg=name)


def test_rows_are_rides(quarter_car, design, alone):
    assert all(column.shape == (ROWS,) for column in alone.values())
    for row in (0, 255, 256, ROWS - 1):
        params = {name: design[name][row] for name in ("k_tire", "c_wheel_z")}
        ride = qcar.ride(quarter_car, params, vehicle=VEHICLE, speed=design["speed"][row], height=0.02)
        assert alone["peak_z_body_acceleration"][row] == ride.peak["z_body_acceleration"]
        assert alone["after_shake_z_wheel_acceleration"][row] == ride.after_shake["z_wheel_acceleration"]
        assert alone["lift_offs"][row] == len(ride.lift_offs[0])


def test_what_is_no_design(quarter_car):
    for wrong in ({}, {"k_tire": 2e5}, {"k_tire": [2e5, 3e5], "speed": [1.0, 2.0, 3.0]}):
        with pytest.raises(qcar.ParameterError, match="design"):
            qcar.ride_metrics(quarter_car, wrong, vehicle=VEHICLE, speed=8.0, height=0.02)
    with pytest.raises(qcar.ParameterError, match="k_tyre"):
        qcar.ride_metrics(quarter_car, {"k_tyre": [2e5]}, vehicle=VEHICLE, speed=8.0, height=0.02)


@pytest.fixture(scope="module")
def client():
    distributed = pytest.importorskip("distributed", reason="dask.distributed is not installed: clusters are passed over")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_a_cluster_that_loses_a_worker_gives_the_rows_of_one_machine(client, quarter_car, design, alone):
    import distributed

    import qcar.dask

    workers = set(client.run(os.getpid).values())
    assert len(workers) == 2
    futures = qcar.dask.submit(client, quarter_car, design, vehicle=VEHICLE, rows=5)
    next(distributed.as_completed(futures))
    os.kill(min(workers), signal.SIGKILL)
    parts = client.gather(futures)
    same({name: np.concatenate([part[name] for part in parts]) for name in parts[0]}, alone)
    client.wait_for_workers(2)
    assert min(workers) not in set(client.run(os.getpid).values())


def test_parts_are_written_once_and_whole(client, quarter_car, design, alone, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed: Parquet is passed over")
    import qcar.dask

    again = lambda: qcar.dask.ride_metrics(client, quarter_car, design, vehicle=VEHICLE, rows=70, out=tmp_path / "rides")  # noqa: E731
    files = again()
    assert [file.name for file in files] == [f"part-{number:06}.parquet" for number in range(5)]
    assert sorted(files) == sorted((tmp_path / "rides").iterdir())
    tables = [parquet.read_table(file) for file in files]
    same({name: np.concatenate([table[name].to_numpy() for table in tables]) for name in tables[0].column_names}, alone)
    files[2].unlink()
    written = {file: file.stat().st_mtime_ns for file in files if file.exists()}
    assert again() == files and parquet.read_table(files[2]).equals(tables[2])
    assert all(file.stat().st_mtime_ns == time for file, time in written.items())
