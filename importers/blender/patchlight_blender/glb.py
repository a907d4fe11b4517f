"""Reads the JSON of a binary glTF file, and writes it back changed."""
import json
import struct

MAGIC, JSON_CHUNK = 0x46546C67, 0x4E4F534A


def read(path):
    """The JSON as a dictionary, and the bytes of the chunks after it."""
    data = path.read_bytes()
    magic, _, _ = struct.unpack_from("<3I", data, 0)
    size, kind = struct.unpack_from("<2I", data, 12)
    assert magic == MAGIC and kind == JSON_CHUNK
    return json.loads(data[20:20 + size]), data[20 + size:]


def write(path, document, rest):
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<3I", MAGIC, 2, 20 + len(text) + len(rest)) +
                     struct.pack("<2I", len(text), JSON_CHUNK) + text + rest)


def take_private(item, prefix):
    """Removes the extras whose names start with `prefix`, and returns them without it."""
    extras = item.get("extras", {})
    found = {key[len(prefix):]: extras.pop(key) for key in list(extras) if key.startswith(prefix)}
    if not extras:
        item.pop("extras", None)
    return found


def set_extensions(item, values, names):
    """Gives a material the extensions `values`, and takes those of `names` away that it has otherwise."""
    kept = {name: value for name, value in item.pop("extensions", {}).items() if name not in names}
    if kept or values:
        item["extensions"] = kept | values


def list_extensions(document, names):
    """Lists the extensions of `names` that materials use, and no others of them."""
    found = {name for item in document.get("materials", []) for name in item.get("extensions", {})}
    used = [name for name in document.pop("extensionsUsed", []) if name not in names]
    used += [name for name in names if name in found]
    if used:
        document["extensionsUsed"] = used


def set_coordinates(material, texture, index):
    """Lets a texture of a material read the texture coordinates `index`."""
    for holder in (material, material.get("pbrMetallicRoughness", {})):
        if texture in holder:
            holder[texture]["texCoord"] = index
