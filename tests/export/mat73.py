"""What h5py reads in a MAT-file of version 7.3: python mat73.py FILE.mat RESULT.json"""

import json
import sys

import h5py
import numpy

file, result = sys.argv[1:3]


def kind(item):
    return item.attrs["MATLAB_class"].decode()


def text(item):
    assert kind(item) == "char", item
    return "" if "MATLAB_empty" in item.attrs else item[()].astype("<u2").tobytes().decode("utf-16-le")


def matrix(item):
    """HDF5 counts its rows first where MATLAB counts its columns; an empty array holds its size."""
    assert kind(item) == "double", item
    if "MATLAB_empty" in item.attrs:
        return numpy.zeros([int(size) for size in item[()]])
    return item[()].T


with open(file, "rb") as start:
    head = start.read(128)
assert head.startswith(b"MATLAB 7.3 MAT-file") and head[124:128] == b"\x00\x02IM", head

with h5py.File(file) as data:
    matrices = {name: matrix(data[name]) for name in "ABCD"}
    names, values = data["names"], data["p"]
    assert kind(names) == kind(values) == "struct"

    def texts(item):
        assert kind(item) == "cell", item
        return [] if "MATLAB_empty" in item.attrs else [text(data[cell]) for cell in item[()].T.ravel()]

    fields = {name: [letters.tobytes().decode() for letters in item.attrs["MATLAB_fields"]] for name, item in [("names", names), ("p", values)]}
    assert fields["names"][0] == "states" and sorted(fields["p"]) == sorted(values), fields
    answer = {
        **{name: own.tolist() for name, own in matrices.items()},
        "shapes": {name: list(own.shape) for name, own in matrices.items()},
        "names": {name: texts(names[name]) for name in names},
        "p": {name: float(matrix(values[name])[0, 0]) for name in values},
    }
with open(result, "w") as out:
    json.dump(answer, out)
