"""What the FMU Manipulation Toolbox says of units: python conformity.py RESULT.json UNIT ...

Of each unit what its checks of the schema and of the rules of the standard find, and the same of the last unit with two variables
of one reference.
"""

import json
import subprocess
import sys
import zipfile
from pathlib import Path

tool = Path(sys.executable).parent / "fmutool"
result, units = sys.argv[1], sys.argv[2:]


def check(unit):
    ran = subprocess.run([tool, "-input", unit, "-check"], capture_output=True, text=True)
    return {"status": ran.returncode, "said": ran.stdout + ran.stderr}


def broken(unit):
    """A copy whose second variable has the reference of the first."""
    copy = unit + ".broken.fmu"
    with zipfile.ZipFile(unit) as own, zipfile.ZipFile(copy, "w") as other:
        for name in own.namelist():
            content = own.read(name)
            if name == "modelDescription.xml":
                content = content.replace(b'valueReference="1"', b'valueReference="0"', 1)
            other.writestr(name, content)
    return copy


with open(result, "w") as file:
    json.dump({"units": [check(unit) for unit in units], "broken": check(broken(units[-1]))}, file)
