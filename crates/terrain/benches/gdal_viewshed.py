"""GDAL's viewshed (in process, MEM driver) on maps written by `cargo bench -p wisdom-terrain --bench viewshed`.

    gdal_viewshed.py FOLDER SIDE CALLS

reads FOLDER/SIDE.f32 (heights) and FOLDER/SIDE.u8 (what is seen, exactly), little-endian and row by row, and prints the median
milliseconds of a call and the share of cells, in percent, that GDAL has wrong. The observer is the centre
cell, 40 units up.
"""

import sys
import time
from pathlib import Path

import numpy
from osgeo import gdal

gdal.UseExceptions()
folder, side, calls = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
heights = numpy.fromfile(folder / f"{side}.f32", "<f4").reshape(side, side)
exact = numpy.fromfile(folder / f"{side}.u8", "u1").reshape(side, side) > 0

dem = gdal.GetDriverByName("MEM").Create("", side, side, 1, gdal.GDT_Float32)
dem.SetGeoTransform([0, 1, 0, side, 0, -1])
dem.GetRasterBand(1).WriteArray(heights)
x, y = side // 2 + 0.5, side - (side // 2 + 0.5)


def viewshed():
    return gdal.ViewshedGenerate(
        dem.GetRasterBand(1), "MEM", "", [],
        observerX=x, observerY=y, observerHeight=40.0, targetHeight=0.0,
        visibleVal=1, invisibleVal=0, outOfRangeVal=0, noDataVal=-1,
        dfCurvCoeff=0.0, mode=gdal.GVM_Edge, maxDistance=0.0,
    )


times = []
for _ in range(calls):
    start = time.perf_counter()
    seen = viewshed()
    times.append(time.perf_counter() - start)
wrong = (seen.ReadAsArray() > 0) != exact
print(f"{sorted(times)[calls // 2] * 1e3:.3f} {100 * wrong.mean():.4f}")
