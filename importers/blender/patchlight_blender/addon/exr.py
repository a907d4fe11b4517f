"""Frames that the program writes: OpenEXR files of scan lines, compressed as `zip`.

Blender gives scripts no pixels of files with layers.
"""
import dataclasses
import pathlib
import struct
import zlib

import numpy as np

MAGIC = struct.pack("<II", 20000630, 2)
LINES = 16
"""Scan lines of a block."""
ZIP = b"\x03"
TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


@dataclasses.dataclass
class Exr:
    """The header of a file: `channels` has the types of the channels by name, in the order of the file."""
    data: bytes
    start: int
    channels: dict
    width: int
    height: int

    def pixels(self, names):
        """Values of channels as an array (height, width, channel), rows from below."""
        line = sum(kind.itemsize for kind in self.channels.values()) * self.width
        result = np.empty((self.height, self.width, len(names)), np.float32)
        blocks = -(-self.height // LINES)
        for offset in struct.unpack_from(f"<{blocks}Q", self.data, self.start):
            first, size = struct.unpack_from("<ii", self.data, offset)
            count = min(LINES, self.height - first)
            block = _unpacked(self.data[offset + 8:offset + 8 + size], line * count).reshape(count, line)
            column = 0
            for name, kind in self.channels.items():
                end = column + kind.itemsize * self.width
                if name in names:
                    values = np.ascontiguousarray(block[:, column:end]).view(kind)
                    result[first:first + count, :, names.index(name)] = values
                column = end
        return result[::-1]


def read(path):
    """The header of the frame `path`."""
    data = pathlib.Path(path).read_bytes()
    attributes, position = {}, len(MAGIC)
    if data[:position] != MAGIC:
        raise ValueError(f"'{path}' is no frame of Patchlight")
    while data[position]:
        name, position = _text(data, position)
        _, position = _text(data, position)
        size, = struct.unpack_from("<i", data, position)
        attributes[name] = data[position + 4:position + 4 + size]
        position += 4 + size
    if attributes["compression"] != ZIP:
        raise ValueError(f"'{path}' is not compressed as zip")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    return Exr(data, position + 1, _channels(attributes["channels"]), right - left + 1, bottom - top + 1)


def _channels(value):
    channels, position = {}, 0
    while value[position]:
        name, position = _text(value, position)
        channels[name] = TYPES[struct.unpack_from("<i", value, position)[0]]
        position += 16
    return channels


def _text(data, start):
    """The text that ends with a zero, and the place after it."""
    end = data.index(0, start)
    return data[start:end].decode(errors="replace"), end + 1


def _unpacked(data, size):
    """The bytes of a block: differences of bytes, those of even places before those of odd ones."""
    if len(data) == size:
        return np.frombuffer(data, np.uint8)
    steps = np.frombuffer(zlib.decompress(data), np.uint8).astype(np.int64)
    steps[1:] -= 128
    values = np.cumsum(steps).astype(np.uint8)
    result, half = np.empty(size, np.uint8), (size + 1) // 2
    result[::2], result[1::2] = values[:half], values[half:]
    return result
