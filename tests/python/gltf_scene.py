# SPDX-License-Identifier: GPL-3.0-or-later
"""glTF files as other programs write them."""

import base64
import json
import struct

import numpy as np

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
HALVES = [[0, 1, 2], [0, 2, 3]]
TYPES = {"i1": 5120, "u1": 5121, "<i2": 5122, "<u2": 5123, "<u4": 5125, "<f4": 5126}


class Scene:
    """A glTF file that grows."""

    def __init__(self):
        self.tree = {"asset": {"version": "2.0"}}
        self.blob = b""

    def add(self, kind, **entry):
        self.tree.setdefault(kind, []).append(entry)
        return len(self.tree[kind]) - 1

    def view(self, values):
        self.blob += bytes(-len(self.blob) % 4)
        start, content = len(self.blob), np.ascontiguousarray(values).tobytes()
        self.blob += content
        return self.add("bufferViews", buffer=0, byteOffset=start, byteLength=len(content))

    def array(self, values, dtype="<f4", **more):
        values = np.asarray(values, dtype)
        shape = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4", (16,): "MAT4"}
        return self.add(
            "accessors", bufferView=self.view(values), componentType=TYPES[dtype],
            count=len(values), type=shape[values.shape[1:]], **more,
        )  # fmt: skip

    def mesh(self, vertices, faces=None, **more):
        attributes = {"POSITION": self.array(vertices)} | more.pop("attributes", {})
        indices = {} if faces is None else {"indices": self.array(np.ravel(faces), "<u2")}
        return self.add("meshes", primitives=[{"attributes": attributes, **indices, **more}])

    def save(self, path, roots=(0,), buffer=None):
        self.tree |= {"scene": 0, "scenes": [{"nodes": list(roots)}]}
        self.tree["buffers"] = [{"byteLength": len(self.blob), **(buffer or {})}]
        if path.suffix == ".gltf":
            if not buffer:
                coded = base64.b64encode(self.blob).decode()
                self.tree["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{coded}"
            path.write_text(json.dumps(self.tree))
            return path
        text = json.dumps(self.tree).encode()
        text += b" " * (-len(text) % 4)
        blob = self.blob + bytes(-len(self.blob) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text
        body += struct.pack("<II", len(blob), 0x004E4942) + blob
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path
