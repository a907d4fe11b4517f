"""Photometric files (IESNA LM-63) on lamps: what Cycles makes of them, as files for Patchlight."""
import dataclasses
import pathlib
import re

import bpy
import numpy as np

from . import nodes

LUMENS_PER_WATT = 177.83
"""Cycles' lamp of 1 W with a photometric file has candela / 177.83 W/sr."""
EFFICACY = 683
"""lm/W: Patchlight's lamp with a photometric file has candela / 683 W/sr."""


@dataclasses.dataclass
class Profile:
    """`factor`: W/sr for each candela and W of the lamp. `vertical`: angles from the nadir, degrees. `planes`: candela
    by horizontal angle, degrees from 0 to 360 or 0 alone, and vertical angle."""
    name: str
    factor: float
    vertical: list
    planes: dict

    def text(self, power):
        """A file of type C with what a lamp of `power`, W, emits. Cycles' angle 0 lies along -Y of the lamp and grows
        towards -X, Patchlight's along +X and towards +Y."""
        turned = {0.0: self.planes[0.0]} if len(self.planes) == 1 else {}
        if not turned:
            turned = {(270 - angle) % 360: values for angle, values in self.planes.items()}
            turned = _closed(dict(sorted(turned.items())))
        scale = power * self.factor * EFFICACY
        rows = [self.vertical, list(turned), *[[value * scale for value in values] for values in turned.values()]]
        head = f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(self.vertical)} {len(turned)} 1 2 0 0 0\n1 1 0\n"
        return head + "".join(_lines(row) for row in rows)


def _lines(numbers):
    """Numbers in lines of ten, as the format has it."""
    words = [f"{number:.7g}" for number in numbers]
    return "".join(" ".join(words[k:k + 10]) + "\n" for k in range(0, len(words), 10))


def _closed(planes):
    """Planes of angles from 0 to below 360, with those at 0 and 360 interpolated between the nearest."""
    if 0 not in planes:
        (low, before), (high, after) = list(planes.items())[-1], next(iter(planes.items()))
        part = (360 - low) / (360 - low + high)
        planes = {0.0: [a + (b - a) * part for a, b in zip(before, after)], **planes}
    return {**planes, 360.0: planes[0.0]}


def profile(node, warn):
    """The file of an IES Texture node; None, with a warning, if it cannot be read."""
    if nodes.source(node.inputs["Vector"]):
        warn(f"the vector of its node '{node.name}' is left out: turn the lamp instead")
    if node.mode == "INTERNAL":
        text = node.ies
        if text is None:
            warn(f"its node '{node.name}' has no text")
            return None
        name, text = text.name, text.as_string()
    else:
        path = pathlib.Path(bpy.path.abspath(node.filepath))
        if not path.is_file():
            warn(f"the photometric file '{path}' is missing: the lamp shines alike in all directions")
            return None
        name, text = path.name, path.read_bytes().decode("latin-1")
    strength = nodes.source(node.inputs["Strength"])
    if strength:
        warn(f"the strength of its node '{node.name}' is read as 1")
    scale = 1.0 if strength else node.inputs["Strength"].default_value
    try:
        return Profile(pathlib.Path(name).stem, scale / LUMENS_PER_WATT, *distribution(text))
    except (ValueError, IndexError, ZeroDivisionError):
        warn(f"the photometric file '{name}' is not valid LM-63: the lamp shines alike in all directions")
        return None


def distribution(text):
    """The vertical angles and planes of an LM-63 file, see Profile, times its multipliers."""
    rest = re.split(r"TILT\s*=\s*", text, 1)[1]
    tilt, rest = rest.split("\n", 1)
    numbers = [float(word) for word in rest.replace(",", " ").split()]
    if tilt.strip() == "INCLUDE":
        numbers = numbers[2 + 2 * int(numbers[1]):]
    vertical, horizontal = int(numbers[3]), int(numbers[4])
    factor = numbers[2] * numbers[10] * numbers[11]
    angles, turns = numbers[13:13 + vertical], numbers[13 + vertical:13 + vertical + horizontal]
    values = [value * factor for value in numbers[13 + vertical + horizontal:]]
    planes = {turn: values[k * vertical:(k + 1) * vertical] for k, turn in enumerate(turns)}
    if not angles or len(planes) != horizontal or any(len(plane) != vertical for plane in planes.values()):
        raise ValueError
    if horizontal == 1:
        return angles, {0.0: planes[turns[0]]}
    for half in (90, 180):  # the other half is its mirror image
        if turns[-1] == half:
            planes.update({2 * half - turn: planes[turn] for turn in reversed(turns)})
            turns = sorted(planes)
    planes.pop(360, None)
    return angles, dict(sorted(planes.items()))
