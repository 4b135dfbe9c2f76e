"""Fills the template `vehicle.xlsx` with the values and curves of `original/`, in units of engineers, and leaves of its
campaign.toml what the workbook does not say, in `campaign/`."""

import csv
import gzip
import pathlib
import re
import tomllib

import openpyxl

UNITS = {"N/m": ("N/mm", 1000.0), "N s/m": ("N s/mm", 1000.0)}
LENGTHS = {"displacement": ("mm", 1000.0), "force": ("kN", 0.001), "x": ("mm", 1000.0), "z": ("mm", 1000.0)}

original = pathlib.Path("original")
text = (original / "campaign.toml").read_text()
campaign = tomllib.loads(text)
book = openpyxl.load_workbook("vehicle.xlsx")


def cell(name):
    sheet, at = book.defined_names[name].attr_text.split("!")
    return book[sheet.strip("'")][at.replace("$", "")]


def column(sheet, name, values):
    heads = {head.value: head.column for head in book[sheet][1]}
    unit, factor = LENGTHS[name.split()[-1]]
    book[sheet].cell(2, heads[name]).value = unit
    for row, value in enumerate(values, 3):
        book[sheet].cell(row, heads[name]).value = float(value) * factor


def table(file):
    with gzip.open(original / file, "rt") as lines:
        rows = list(csv.DictReader(lines))
    return {name: [row[name] for row in rows] for name in rows[0]}


def corners(samples):
    """A sample, and the foot of a step where the slope misses the next sample."""
    x, z, slope = ([float(value) for value in samples[name]] for name in ("x", "z", "slope"))
    yield x[0], z[0]
    for at in range(1, len(x)):
        foot = z[at - 1] + slope[at - 1] * (x[at] - x[at - 1])
        if abs(z[at] - foot) > 1e-4:
            yield x[at], foot
        yield x[at], z[at]


cell("axle").value = "rear"
cell("rear.model").value = campaign["model"]
for name, value in campaign["vehicle"].items():
    cell(f"rear.{name}").value = value
    cell(f"rear.{name}.unit").value = {"r_tire": "m", "static_tire_def": "m", "static_tire_load": "N", "gravity": "m/s^2"}.get(name, "kg")
for name, own in campaign["parameters"].items():
    unit, size = UNITS.get(own["unit"], (own["unit"], 1.0))
    cell(f"rear.{name}").value = own["value"] / size
    cell(f"rear.{name}.unit").value = unit
    cell(f"rear.{name}.lower").value = own["range"][0] / size
    cell(f"rear.{name}.upper").value = own["range"][1] / size
    cell(f"rear.{name}.fit").value = "yes" if own["fit"] else "no"
    cell(f"comment.{name}").value = own["comment"]
for kind in ("bounce", "longitudinal"):
    for name, values in table(f"kc/{kind}.csv.gz").items():
        column("K&C curves", f"rear {kind} {name}", values)
for road in campaign["road"]:
    for name, values in zip("xz", zip(*corners(table(road["file"])))):
        column("Cleats", f"{road['name']} {name}", values)
book.save("campaign/vehicle.xlsx")

sections = re.split(r"\n(?=\[)", text)
said = re.compile(r'\[(vehicle|parameters\.|\[road)|\[\[run\]\]\nkind = "(bounce|longitudinal)"')
left = [section for section in sections if not said.match(section)]
left[0] = left[0].replace(f'model = "{campaign["model"]}"', 'workbook = "vehicle.xlsx"')
pathlib.Path("campaign/campaign.toml").write_text("\n".join(left))
