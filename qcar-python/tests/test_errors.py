"""What is wrong raises, in the words of the compiler and the workbench."""

import pickle
import shutil

import numpy as np
import pytest

import qcar


def test_a_model_that_the_compiler_refuses_carries_its_whole_report():
    text = 'axle wrong { "One mass" direction z { road pad; mass body = m; link l: body - pad { spring kk; } } param m: kg = 1 "Mass"; }'
    with pytest.raises(qcar.ModelError) as raised:
        qcar.Model.from_text(text, name="wrong.axle")
    report = str(raised.value)
    assert "wrong.axle" in report and "`kk`" in report and "help" in report, report


def test_a_shipped_name_that_is_none_is_told_the_others():
    with pytest.raises(qcar.ModelError, match="quarter_car"):
        qcar.Model("quarter_carr")


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(qcar.ModelError, match="nowhere.axle"):
        qcar.Model.from_file(tmp_path / "nowhere.axle")


def test_names_and_values_of_parameters(quarter_car):
    with pytest.raises(qcar.ParameterError, match="did you mean `k_tire`"):
        quarter_car.matrices({"k_tyre": 2e5})
    with pytest.raises(qcar.ParameterError, match="set 1 of 2, counted from 0.*k_tire.*finite"):
        quarter_car.matrices({"k_tire": [2e5, np.nan]})
    with pytest.raises(qcar.ParameterError, match="above zero"):
        quarter_car.matrices({"m_wheel": 500.0})
    with pytest.raises(qcar.ParameterError, match="one shape"):
        quarter_car.matrices({"k_tire": [1e5, 2e5], "m_wheel": [1.0, 2.0, 3.0]})
    with pytest.raises(qcar.ParameterError, match="needs `"):
        qcar.Model("axle_d").matrices()
    with pytest.raises(qcar.ParameterError, match="shape"):
        quarter_car.matrices(np.zeros(3))


def test_frequencies_are_above_zero(quarter_car):
    for wrong in (0.0, [-1.0], [np.inf], [[1.0]]):
        with pytest.raises(qcar.ParameterError, match="0 Hz"):
            quarter_car.frf(wrong)


def test_a_campaign_names_its_file_and_line(tmp_path, campaigns):
    with pytest.raises(qcar.CampaignError, match="campaign.toml"):
        qcar.fit(tmp_path)
    folder = shutil.copytree(campaigns / "axle_a_rig", tmp_path / "wrong")
    manifest = folder / "campaign.toml"
    manifest.write_text(manifest.read_text().replace("[vehicle]", "[vehicle]\nm_korner = 3.0", 1))
    with pytest.raises(qcar.CampaignError, match=r"campaign.toml.*m_korner.*expected"):
        qcar.fit(folder)
    with pytest.raises(qcar.CampaignError, match="free"):
        qcar.fit(campaigns / "axle_a_rig", free=["nothing"])


def test_a_nonlinear_model_is_not_fitted_as_if_it_were_linear(tmp_path, campaigns):
    linear = qcar.Model("quarter_car").show("model")
    bent = linear.replace("spring k_tire;", "force = k_tire*s + 1e9*s*s*s;")
    assert bent != linear
    (tmp_path / "bent.axle").write_text(bent)
    with pytest.raises(qcar.CampaignError, match="nonlinear"):
        qcar.fit(campaigns / "axle_a_rig", model=str(tmp_path / "bent.axle"))


def test_rides_that_cannot_be(quarter_car):
    vehicle = {"r_tire": 0.32, "static_tire_def": 0.02, "static_tire_load": 4400.0}
    with pytest.raises(qcar.SimulationError, match="ride 1 of 2, counted from 0.*speed"):
        qcar.ride(quarter_car, vehicle=vehicle, height=0.02, speed=[8.0, -8.0])
    with pytest.raises(qcar.ParameterError, match="static_tire_load"):
        qcar.ride(quarter_car, vehicle={"r_tire": 0.32, "static_tire_def": 0.02}, height=0.02, speed=8.0)
    with pytest.raises(qcar.ParameterError, match="one of them"):
        qcar.ride(quarter_car, vehicle=vehicle, speed=8.0)
    with pytest.raises(qcar.ParameterError, match="tolerance"):
        qcar.ride(quarter_car, vehicle=vehicle, height=0.02, speed=8.0, tolerance=np.nan)
    with pytest.raises(qcar.ParameterError, match="variant"):
        qcar.ride(quarter_car, vehicle=vehicle, height=0.02, speed=8.0, variant="whole")
    with pytest.raises(qcar.ParameterError, match="broadcast"):
        qcar.ride(quarter_car, vehicle=vehicle, height=[0.01, 0.02], speed=[8.0, 9.0, 10.0])


def test_all_of_them_are_value_errors():
    for error in (qcar.ModelError, qcar.ParameterError, qcar.CampaignError, qcar.SimulationError):
        assert issubclass(error, qcar.Error) and issubclass(error, ValueError)


def test_errors_come_back_from_other_processes(quarter_car):
    with pytest.raises(qcar.ParameterError) as raised:
        quarter_car.matrices({"k_tyre": 2e5})
    again = pickle.loads(pickle.dumps(raised.value))
    assert type(again) is qcar.ParameterError and str(again) == str(raised.value)
