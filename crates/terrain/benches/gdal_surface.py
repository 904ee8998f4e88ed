"""The peers of the bench `surface`: GDAL in process and numpy, on the same sizes.

Prints one line a peer and size: the median time of a call in ms and ns a cell. GDAL makes a fresh raster in memory
at each call, as `fresh` does; `numpy slices` writes into arrays that are there, as `into` does. All on one thread.
Usage: gdal_surface.py [SIDE ...]
"""

import statistics
import sys
import time

import numpy as np

try:
    from osgeo import gdal, gdal_array

    gdal.UseExceptions()
    gdal.SetConfigOption("GDAL_NUM_THREADS", "1")
except ImportError:
    gdal = None

CALLS = 15


def heights(side):
    """Smooth hills under a decimetre of noise, 1 m cells."""
    row, col = np.mgrid[:side, :side]
    noise = np.random.default_rng(1).random((side, side))
    hills = np.sin(col / 97.0) + np.cos(row / 61.0)
    return (-4500.0 + 20.0 * hills + 0.1 * noise).astype(np.float32)


def in_memory(z):
    """A GDAL dataset that views the array, 1 m cells, north up."""
    dataset = gdal_array.OpenArray(z)
    dataset.SetGeoTransform((0.0, 1.0, 0.0, float(len(z)), 0.0, -1.0))
    return dataset


def with_gdal(z):
    dataset = in_memory(z)

    def dem(kind, **options):
        return lambda: gdal.DEMProcessing("", dataset, kind, format="MEM", **options)

    return {
        "GDAL slope, Horn": dem("slope", alg="Horn"),
        "GDAL slope, Zevenbergen-Thorne": dem("slope", alg="ZevenbergenThorne"),
        "GDAL roughness (range in 3 x 3)": dem("roughness"),
        "GDAL hillshade": dem("hillshade", alg="Horn"),
    }


def with_numpy(z):
    along_row, along_col, out = (np.zeros_like(z[1:-1, 1:-1]) for _ in range(3))

    def slices():
        np.subtract(z[1:-1, 2:], z[1:-1, :-2], out=along_row)
        np.subtract(z[2:, 1:-1], z[:-2, 1:-1], out=along_col)
        np.multiply(along_row, along_row, out=along_row)
        np.multiply(along_col, along_col, out=along_col)
        np.add(along_row, along_col, out=out)
        np.sqrt(out, out=out)
        np.multiply(out, np.float32(0.5), out=out)

    return {
        "numpy.gradient + hypot": lambda: np.hypot(*np.gradient(z)),
        "numpy slices, in place": slices,
    }


def median_s(call):
    call()
    times = []
    for _ in range(CALLS):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def main():
    sides = [int(side) for side in sys.argv[1:]] or [512, 2048]
    if gdal is None:
        print("GDAL's Python bindings are not installed; numpy only")
    for side in sides:
        z = heights(side)
        peers = {**(with_gdal(z) if gdal else {}), **with_numpy(z)}
        for name, call in peers.items():
            seconds = median_s(call)
            print(f"{name:34} {side:5}  {seconds * 1e3:9.3f} ms  {seconds * 1e9 / side**2:7.3f} ns/cell")


if __name__ == "__main__":
    main()
