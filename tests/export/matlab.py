"""What SciPy reads in a MAT-file: python matlab.py FILE.mat RESULT.json"""

import json
import sys

from scipy.io import loadmat

file, result = sys.argv[1:3]
data = loadmat(file, squeeze_me=False, struct_as_record=False, chars_as_strings=True)
names = data["names"][0, 0]
texts = {field: [str(cell[0]) for cell in getattr(names, field).ravel()] for field in names._fieldnames}
values = data["p"][0, 0]
answer = {
    **{name: data[name].tolist() for name in "ABCD"},
    "shapes": {name: list(data[name].shape) for name in "ABCD"},
    "names": texts,
    "p": {field: float(getattr(values, field)[0, 0]) for field in values._fieldnames},
}
with open(result, "w") as out:
    json.dump(answer, out)
