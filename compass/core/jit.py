"""How kernels are compiled: one floating-point contract, and a cache that cannot be stale."""

from collections.abc import Callable
from typing import Any

from numba import config, njit, typeof, types
from numba.core import event

from compass.core.compiling import compiling, listeners
from compass.core.kernel_cache import KernelCache

# Everything of fastmath but `nnan` and `ninf`: kernels test for nan and inf.
FASTMATH = {"contract", "reassoc", "nsz", "arcp", "afn"}


class _Teller(event.Listener):
    """Tells who wants to know that a kernel is about to be compiled."""

    def on_start(self, event: object) -> None:
        for tell in tuple(listeners):
            tell()

    def on_end(self, event: object) -> None:
        """Nothing is said when it is done."""


event.register("numba:compile", _Teller())


def compile_for_types_alone(compiled: Any) -> None:
    """Let a kernel that another calls be compiled for the types of its arguments and no more.

    Numba compiles it again for each constant that a caller writes, and for each default that one
    leaves out; where the constant matters, the compiler behind it puts it in all the same.
    """
    find = compiled.get_call_template

    def general(kind: Any) -> Any:
        omitted = isinstance(kind, types.Omitted)
        return typeof(kind.value) if omitted else types.unliteral(kind)

    def get_call_template(args: Any, kws: Any) -> Any:
        _, args = compiled._compiler.fold_argument_types(args, kws)
        return find(tuple(map(general, args)), {})

    compiled.get_call_template = get_call_template


def compile_once_among_processes(compiled: Any) -> None:
    """Let a process wait for another that compiles the same kernel, and take what it keeps."""
    compile_here = compiled.compile

    def compile(sig: Any) -> Any:
        with compiling():
            try:
                return compile_here(sig)
            finally:
                compiled._cache.let_others_compile()

    compiled.compile = compile


def _compiler(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    def compile_cached(function: Callable[..., Any]) -> Any:
        compiled = njit(nogil=True, error_model="numpy", **options)(function)
        if not config.DISABLE_JIT:
            compiled._cache = KernelCache(function)
            compile_for_types_alone(compiled)
            compile_once_among_processes(compiled)
        return compiled

    return compile_cached


#: Compile for exact floating-point semantics; cached on disk, releases the GIL.
kernel = _compiler()

#: Compile with multiply-adds fused and nothing else: what is fused rounds once instead of twice,
#: so every bound on rounding holds. Loops over elements are worked several at once all the same.
fused_kernel = _compiler(fastmath={"contract"})

#: As `fused_kernel`, and part of every loop that calls it: one that is only called keeps the loop
#: from working on several elements at once.
inline_kernel = _compiler(fastmath={"contract"}, forceinline=True)

#: Compile with sums reordered, divisions turned into products and the like; never where rounding
#: is accounted for.
fast_kernel = _compiler(fastmath=FASTMATH)

#: Compile into whoever calls it, not by itself: for what one caller alone calls. Each library that
#: a kernel is made of is optimised again at every floor above it, so a floor less is a part of the
#: time of compilation less.
flat_kernel = _compiler(inline="always")
