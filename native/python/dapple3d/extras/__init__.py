# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes beyond samples on a surface: scene files and work on many machines.

- `dapple3d.extras.gltf`: meshes from glTF files, and points as instances in them.
- `dapple3d.extras.usd`: points as a PointInstancer of USD; needs `dapple3d[usd]`.
- `dapple3d.extras.distributed`: surfaces larger than memory, and many shots.

Work by several processes of Dask needs `dapple3d[farm]`.
"""
