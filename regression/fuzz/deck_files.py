"""Files that a deck names: particle files, checkpoints and options files, sound ones and odd ones. Each is bytes, or one of
the words of `k_special`, which says what is there in lieu of a file."""
import io

import h5py
import numpy as np

SPECIAL = ("folder", "fifo", "loop", "missing", "null", "zero", "socket")
FIELDS = ("position", "volume", "velocity", "stress", "plastic_strain")


def particle_arrays(lower, cell, dim, per_cell=2, cells=3):
    """The datasets of a sound file: a cube of some cells at the lower corner of a mesh."""
    edge = (np.arange(cells * per_cell) + 0.5) * cell / per_cell
    grid = np.stack(np.meshgrid(*[edge] * dim, indexing="ij"), -1).reshape(-1, dim) + np.array(lower[:dim])
    position = np.zeros((len(grid), 3))
    position[:, :dim] = grid
    return {"position": position, "volume": np.full(len(grid), (cell / per_cell) ** dim), "velocity": np.zeros((len(grid), 3)),
            "stress": np.zeros((len(grid), 6)), "plastic_strain": np.zeros(len(grid))}


def spoil(random, arrays):
    """Changes one thing of the datasets, if not nothing: numbers, sizes, types."""
    name = random.choice(FIELDS)
    values = arrays[name]
    kind = random.randrange(14)
    if kind == 0:
        values[random.randrange(len(values))] = random.choice([np.nan, np.inf, -np.inf, 1e300, -1e300, 5e-324, 0, -1])
    elif kind == 1:
        arrays[name] = values[:-1]
    elif kind == 2:
        del arrays[name]
    elif kind == 3:
        arrays[name] = values.astype(random.choice(["f4", "i4", "i1", "f2", "u8", "S4"]), casting="unsafe")
    elif kind == 4:
        arrays[name] = values.reshape(-1)
    elif kind == 5:
        arrays[name] = values[..., None]
    elif kind == 6:
        values *= random.choice([0, 1e-300, 1e300, -1, 1e-30, 1e30])
    elif kind == 7:
        values[:] = random.choice([np.nan, 1e308, 1e-308])
    elif kind == 8:
        arrays.update({key: each[:0] for key, each in arrays.items()})
    elif kind == 9:
        arrays["position"][:] = arrays["position"][0]
    elif kind == 10:
        arrays[name] = np.array(b"text")
    elif kind == 11:
        arrays["volume"] = arrays["volume"] * (1 + random.choice([1e-9, 0.003, 0.5]) * np.arange(len(arrays["volume"])))
    return arrays


def particle_file(random, group, lower, cell, dim):
    """A file of particles, sound or spoiled; or no such file at all."""
    if random.random() < 0.2:
        return odd_file(random)
    arrays = particle_arrays(lower, cell, dim, random.choice([1, 2, 2, 3]))
    if random.random() < 0.8:
        arrays = spoil(random, arrays)
    memory = io.BytesIO()
    with h5py.File(memory, "w") as file:
        file.attrs["time"] = 0.0
        for name, values in arrays.items():
            compressed = random.random() < 0.2 and getattr(values, "ndim", 0) > 0 and len(values) > 0
            file.create_dataset(f"{group if random.random() < 0.99 else 'other'}/{name}", data=values,
                                **({"compression": "gzip"} if compressed else {}))
        if random.random() < 0.03:
            file[f"{group}/huge"] = np.zeros(1)
            file.create_dataset(f"{group}/endless", (2 ** 40, 3), "f8", chunks=(1024, 3))
    return damage(random, memory.getvalue()) if random.random() < 0.15 else memory.getvalue()


def damage(random, data):
    """Bytes changed, cut off or added."""
    data = bytearray(data)
    kind = random.randrange(3)
    if kind == 0:
        return bytes(data[:random.randrange(len(data) + 1)])
    if kind == 1:
        return bytes(data) + random.randbytes(100)
    for _ in range(random.choice([1, 3, 50])):
        if data:
            data[random.randrange(len(data))] = random.randrange(256)
    return bytes(data)


def odd_file(random):
    """A file that is none of ours, or no file."""
    return random.choice([b"", b"\0", random.randbytes(1000), b"\x89HDF\r\n\x1a\n", b"\x89HDF\r\n\x1a\n" + random.randbytes(500),
                          b"-dim 2\n", b"a: [1, 2\n", b"\xff\xfe" * 50, b"#" * 200000, *SPECIAL])
