"""What the operating system tells of this process and this machine."""

import resource
import sys


def peak_memory() -> int:
    """Most memory that this process has held so far [byte]."""
    # Linux counts in KiB, macOS in bytes
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
