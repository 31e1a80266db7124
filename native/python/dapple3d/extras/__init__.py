# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene files, surfaces larger than memory and work on several machines.

- `dapple3d.extras.gltf`: meshes from glTF files, and points as instances in them; those that
  Draco compressed need `dapple3d[draco]`.
- `dapple3d.extras.godot`: points as instances in scenes of Godot.
- `dapple3d.extras.usd`: points as a PointInstancer of USD; needs `dapple3d[usd]`.
- `dapple3d.extras.distributed`: surfaces larger than memory, and many shots.

Work by several processes of Dask needs `dapple3d[farm]`.
"""
