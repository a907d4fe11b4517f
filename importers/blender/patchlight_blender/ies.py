"""Photometric files (IESNA LM-63) on lamps. The file itself is exported; here only its mean is needed."""
import dataclasses
import pathlib
import re

import bpy
import numpy as np

from . import nodes

LUMENS_PER_WATT = 177.83
"""Cycles' lamp of 1 W with a photometric file has candela / 177.83 W/sr."""


@dataclasses.dataclass
class Profile:
    """`factor`: W/sr for each candela and W of the lamp. `mean`: candela, over all directions."""
    name: str
    data: bytes
    factor: float
    mean: float


def profile(node, warn):
    """The file of an IES Texture node; None, with a warning, if it cannot be read."""
    if nodes.source(node.inputs["Vector"]):
        warn(f"the vector of its node '{node.name}' is left out: turn the lamp instead")
    if node.mode == "INTERNAL":
        text = node.ies
        if text is None:
            warn(f"its node '{node.name}' has no text")
            return None
        name, data = text.name, text.as_string().encode("latin-1", "replace")
    else:
        path = pathlib.Path(bpy.path.abspath(node.filepath))
        if not path.is_file():
            warn(f"the photometric file '{path}' is missing: the lamp shines alike in all directions")
            return None
        name, data = path.name, path.read_bytes()
    name = pathlib.Path(name).name
    name = name if name.lower().endswith(".ies") else name + ".ies"
    strength = nodes.source(node.inputs["Strength"])
    if strength:
        warn(f"the strength of its node '{node.name}' is read as 1")
    scale = 1.0 if strength else node.inputs["Strength"].default_value
    try:
        return Profile(name, data, scale / LUMENS_PER_WATT, mean_candela(data.decode("latin-1")))
    except (ValueError, IndexError, ZeroDivisionError):
        warn(f"the photometric file '{name}' is not valid LM-63")
        return None


def mean_candela(text):
    """Mean of the candela values of an LM-63 file over all directions, times its multipliers."""
    rest = re.split(r"TILT\s*=\s*", text, 1)[1]
    tilt, rest = rest.split("\n", 1)
    numbers = [float(word) for word in rest.replace(",", " ").split()]
    if tilt.strip() == "INCLUDE":
        numbers = numbers[2 + 2 * int(numbers[1]):]
    vertical, horizontal = int(numbers[3]), int(numbers[4])
    factor = numbers[2] * numbers[10] * numbers[11]
    angles = np.radians(numbers[13:13 + vertical])
    values = np.array(numbers[13 + vertical + horizontal:][:vertical * horizontal]).reshape(horizontal, vertical)
    turn = np.array(numbers[13 + vertical:][:horizontal])
    rows = values[0] if horizontal == 1 else np.trapz(values, turn, axis=0) / (turn[-1] - turn[0])
    fine = np.linspace(angles[0], angles[-1], 2000)
    return float(np.trapz(np.interp(fine, angles, rows) * np.sin(fine), fine) / 2 * factor)
