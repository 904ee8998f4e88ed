"""scikit-image's MCP_Geometric on the costs of the field bench.

By hand, where scikit-image is installed, beside `cargo bench -p wisdom-planner --bench paired`:

    python3 crates/planner/benches/skimage_mcp.py [SIDE ...]

Prints nanoseconds a cell (median of five runs, time on the processor, as `paired` does) and the distance of the first
cell, in floors of hazard times metres, to show that both work on the same map.
"""

import statistics
import sys
import time

import numpy as np
from skimage.graph import MCP_Geometric


def random_costs(side):
    """The hash of `peers::random_costs`: 1 to 100."""
    i = np.arange(1, side * side + 1, dtype=np.uint64) - np.uint64(1)
    i = (i + np.uint64(1)) * np.uint64(0x9E37_79B9_7F4A_7C15)
    mixed = (i ^ (i >> np.uint64(29))) * np.uint64(0xBF58_476D_1CE4_E5B9)
    return (1 + (mixed >> np.uint64(32)) % np.uint64(100)).astype(np.float64).reshape(side, side)


def main():
    for side in [int(arg) for arg in sys.argv[1:]] or [512, 2048]:
        costs = random_costs(side)
        taken = []
        for _ in range(5):
            search = MCP_Geometric(costs, fully_connected=True)
            before = time.thread_time_ns()
            found, _ = search.find_costs([(side // 2, side // 2)])
            taken.append((time.thread_time_ns() - before) / costs.size)
        print(f"{side}²  MCP_Geometric {statistics.median(taken):8.1f} ns a cell   first cell {found[0, 0]:.3f}")


if __name__ == "__main__":
    main()
