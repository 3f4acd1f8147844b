"""How kernels are compiled: one decorator, one floating-point contract."""

from numba import njit

# Everything of fastmath but `nnan` and `ninf`: kernels test for nan and inf.
FASTMATH = {"contract", "reassoc", "nsz", "arcp", "afn"}

#: Compile for exact floating-point semantics; cached on disk, releases the GIL.
kernel = njit(cache=True, nogil=True, error_model="numpy")

#: Compile with sums reordered and multiply-adds fused; never where rounding is accounted for.
fast_kernel = njit(cache=True, nogil=True, error_model="numpy", fastmath=FASTMATH)
