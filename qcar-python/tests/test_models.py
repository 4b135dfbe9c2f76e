"""Where models come from, and what they say of themselves."""

import pickle

import numpy as np
import pytest

import qcar


def test_shipped_models_are_those_of_the_folder(repository):
    files = sorted(file.stem for file in (repository / "models" / "axles").glob("*.axle"))
    assert qcar.models() == files


def test_the_same_model_by_name_from_its_file_and_from_its_text(repository, axle_d, axle_d_values):
    file = repository / "models" / "axles" / "axle_d.axle"
    from_text = qcar.Model.from_text(file.read_text(), name=str(file))
    for other in (qcar.Model.from_file(file), from_text, pickle.loads(pickle.dumps(from_text))):
        assert other.parameters == axle_d.parameters and other.states == axle_d.states
        for own, shipped in zip(other.matrices(axle_d_values), axle_d.matrices(axle_d_values)):
            np.testing.assert_array_equal(own, shipped)


def test_a_file_is_found_in_the_working_folder(repository, tmp_path, monkeypatch):
    (tmp_path / "mine").write_text((repository / "models" / "axles" / "quarter_car.axle").read_text())
    monkeypatch.chdir(tmp_path)
    model = qcar.Model.from_file("mine")
    monkeypatch.chdir(repository)
    assert pickle.loads(pickle.dumps(model)).name == "quarter_car"


def test_names_units_defaults_and_descriptions(quarter_car, axle_d):
    k_tire = next(own for own in quarter_car.parameters if own.name == "k_tire")
    assert k_tire == ("k_tire", "N/m", "Stiffness of the tyre", 220e3, None, (50e3, 1e6), False)
    assert [own.name for own in quarter_car.inputs][:2] == ["z_pad", "vz_pad"]
    assert quarter_car.inputs[0].excitation == "pad" and quarter_car.inputs[0].kind == "road"
    assert {own.location for own in axle_d.states} >= {"body", "wheel"}
    assert quarter_car.excitations[0] == ("pad", "m", "z", "road")
    assert "pad_to_body" in quarter_car.channels


def test_a_notebook_shows_a_model(quarter_car):
    html = quarter_car._repr_html_()
    assert "k_tire" in html and "Stiffness of the tyre" in html and "220000" in html.replace("2.2e+05", "220000")
    assert "4 states" in repr(quarter_car)


def test_text_in_html_is_text():
    text = 'axle one { "A < B & C" direction z { road pad; mass body = m; link l: body - pad { spring k; } } param m: kg = 1 "Mass"; param k: N/m = 1 "K"; }'
    assert "A &lt; B &amp; C" in qcar.Model.from_text(text)._repr_html_()




def test_stages_of_a_model(repository, quarter_car):
    text = (repository / "models" / "axles" / "quarter_car.axle").read_text()
    for model in (quarter_car, qcar.Model.from_text(text)):
        assert "k_tire" in model.show() and "\\documentclass" in model.show("latex")
        assert qcar.Model.from_text(model.show("model")).parameters == quarter_car.parameters
    with pytest.raises(qcar.ParameterError, match="equations"):
        quarter_car.show("equation")
