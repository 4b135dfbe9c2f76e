"""What other programs read in files of simulated runs: python histories.py FILE.mf4 FILE.mat FILE73.mat RESULT.json"""

import json
import sys

import h5py
from asammdf import MDF
from scipy.io import loadmat

mdf, mat, mat73, result = sys.argv[1:5]

with MDF(mdf) as file:
    groups = len(file.groups)
    signals = [signal for signal in file.iter_channels()]
    answer = {
        "version": file.version,
        "groups": groups,
        "mdf": {s.name: [s.unit, s.timestamps.tolist(), s.samples.tolist()] for s in signals},
    }

data = loadmat(mat, struct_as_record=False)
(name,) = [name for name in data if not name.startswith("__")]
capture = data[name][0, 0]
times = capture.X[0, 0].Data.ravel().tolist()
text = lambda array: str(array[0]) if array.size else ""
answer["name"] = name
answer["mat"] = {text(y.Name): [text(y.Unit), times, y.Data.ravel().tolist()] for y in capture.Y.ravel()}

with h5py.File(mat73) as file:
    (name,) = [name for name in file if not name.startswith("#")]
    assert name == answer["name"]
    letters = lambda array: "".join(map(chr, array[()].ravel())) if "MATLAB_empty" not in array.attrs else ""
    times = file[name]["X"]["Data"][()].ravel().tolist()
    channels = [file[own] for own in file[name]["Y"][()].ravel()]
    answer["mat73"] = {letters(y["Name"]): [letters(y["Unit"]), times, y["Data"][()].ravel().tolist()] for y in channels}

with open(result, "w") as out:
    json.dump(answer, out)
