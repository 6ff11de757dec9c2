# %% [markdown]
# # From a scan to a solid, in Python
#
# This file is a notebook of cells (`# %%`), for editors that show it so, and a program:
#
#     python3 examples/python/tutorial.py [FOLDER]
#
# which writes its pictures to FOLDER (here by default). It needs numpy and the package `pointskin`, no display and no GPU.

# %%
import pathlib
import sys

import numpy as np

import pointskin as ps

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
out.mkdir(parents=True, exist_ok=True)

# %% [markdown]
# ## A scan
#
# Nothing is loaded here: the points lie on a bumpy ball, as a scanner would have measured it, with noise, colours and normals.

# %%
rng = np.random.default_rng(0)
count = 60_000
direction = rng.normal(size=(count, 3))
direction /= np.linalg.norm(direction, axis=1, keepdims=True)


def radius(d):
    """The bumpy ball's radius in a direction."""
    return 1 + 0.12 * np.sin(6 * d[:, 0]) * np.sin(6 * d[:, 1]) * np.sin(6 * d[:, 2])


points = direction * radius(direction)[:, None] + rng.normal(scale=0.003, size=(count, 3))
height = (radius(direction) - 0.88) / 0.24
rgb = np.stack([80 + 150 * height, 120 + 60 * height, 190 - 90 * height], axis=1).astype(np.uint8)

# %% [markdown]
# ## Normals
#
# Scanners seldom give normals. They are estimated from the neighbours of every point, and turned outward.

# %%
cloud = ps.orient(ps.Cloud(points, attributes={"rgb": rgb}))
print(cloud)
print(f"{cloud.report['doubtful']} of {len(cloud)} normals are doubtful")
ps.render(cloud, width=900, height=700).save(out / "python_scan.png")

# %% [markdown]
# ## The surface
#
# `depth="auto"` chooses as fine an octree as the points support. The mesh is closed and takes the points' colours.

# %%
mesh = ps.reconstruct(cloud, depth="auto", attributes=True)
print(mesh, f"at depth {mesh.report['depth']}, in {sum(mesh.report['ms'].values()):.0f} ms")
assert mesh.is_watertight
mesh.render(width=900, height=700).save(out / "python_surface.png")

# %% [markdown]
# ## How good is it?
#
# We know what the points lie on, so the distance of every vertex from it can be told; here it is, as colours. It becomes an
# attribute of a mesh made of the same arrays.

# %%
vertices = np.asarray(mesh.vertices, dtype=np.float64)
length = np.linalg.norm(vertices, axis=1)
error = length - radius(vertices / length[:, None])
print(f"mean distance {np.abs(error).mean():.5f}, noise of the points 0.003")
assert np.abs(error).mean() < 0.003
judged = ps.Mesh(mesh.vertices, mesh.faces, mesh.normals, {"error": error.astype(np.float32)})
judged.render(width=900, height=700, colour_by="error").save(out / "python_error.png")

# %% [markdown]
# ## A solid among solids
#
# Meshes and clouds are solids. A hole is drilled through the ball, with sharp edges where the surfaces cross.

# %%
turn = 2 * np.pi * rng.random(20_000)
along = rng.uniform(-1.5, 1.5, 20_000)
wall = np.stack([0.35 * np.cos(turn), 0.35 * np.sin(turn), along], axis=1)
out_of_wall = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
disc = 0.35 * np.sqrt(rng.random(4_000))
spin = 2 * np.pi * rng.random(4_000)
lids = [np.stack([disc * np.cos(spin), disc * np.sin(spin), np.full(4_000, end)], axis=1) for end in (-1.5, 1.5)]
rod = ps.Cloud(np.vstack([wall, *lids]),
               np.vstack([out_of_wall, np.tile([0, 0, -1.0], (4_000, 1)), np.tile([0, 0, 1.0], (4_000, 1))]))
drilled = ps.boolean(cloud, rod, "subtract", depth=7)
print(f"volume {mesh.measure()['volume']:.3f} before, {drilled.measure()['volume']:.3f} after")
drilled.render(width=900, height=700, up="z", azimuth_degrees=25, elevation_degrees=50).save(out / "python_drilled.png")
drilled.save(out / "python_drilled.ply")

# %% [markdown]
# ## The field itself
#
# What is solved for is a function of space, and the mesh one of its level sets. It can be asked anywhere.

# %%
field = ps.solve(cloud, depth=7)
side = np.linspace(-1.4, 1.4, 141)
grid = np.stack(np.meshgrid(side, side, [0.0], indexing="ij"), axis=-1).reshape(-1, 3)
inside = field(grid) > field.isovalue
print(f"{inside.sum()} of {len(grid)} places of the plane z = 0 are inside")
