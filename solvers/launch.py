"""Launches of one kernel on one run's arrays, again and again, without handling sixty arguments each time.

Taichi looks at every argument of every launch, and asks each array for its address: some 0.3 ms, many times what a few
steps of a bar take. The arrays of a run stay where they are, so a launch on the processor keeps what Taichi has made of
them, and only the whole numbers change. Of Taichi 1.7.4 (``Kernel.launch_kernel``), which this project is bound to.
"""

from typing import Any

from taichi.lang import impl
from taichi.types import ndarray_type, primitive_types

from solvers import runtime


class Launch:
    """A kernel whose arguments are whole numbers, then a ``pack`` of numbers and arrays, then templates. The first call
    compiles it; arrays must not be replaced after that, only written to."""

    def __init__(self, kernel: Any, pack: Any, *templates: Any):
        self._kernel, self._arguments = kernel, (pack, *templates)
        self._kept: tuple[Any, Any, Any] | None = None  # Taichi's program, the compiled kernel and its context
        runtime.holders.add(self)

    def __call__(self, *numbers: int) -> None:
        if self._kept is None:
            self._kernel(*numbers, *self._arguments)
            self._kept = self._made(impl.get_runtime().prog, numbers) if runtime.on_processor() else None
            return
        program, compiled, context = self._kept
        for k, number in enumerate(numbers):
            context.set_arg_int((k,), number)
        program.launch_kernel(compiled, context)

    def forget(self) -> None:
        """Keep nothing that Taichi has made: it is about to end."""
        self._kept = None

    def _made(self, program: Any, numbers: tuple[int, ...]) -> tuple[Any, Any, Any]:
        """The program, the compiled kernel, and a context that holds the pack."""
        primal, pack, at = self._kernel._primal, self._arguments[0], len(numbers)
        own = primal.compiled_kernels[primal.ensure_compiled(*numbers, *self._arguments)]
        context = own.make_launch_context()
        context.set_arg_argpack((at,), pack._ArgPack__argpack)
        arrays = [(pack[name], kind) for name, kind in primal.arguments[at].annotation.members.items()
                  if isinstance(kind, ndarray_type.NdarrayType)]
        for k, (array, kind) in enumerate(arrays):  # they come after all other arguments
            scalar = kind.dtype is None or id(kind.dtype) in primitive_types.type_ids
            shape = array.shape if scalar else array.shape[:-kind.dtype.ndim]
            context.set_arg_external_array_with_shape((at + 1 + k,), array.ctypes.data, array.nbytes, shape, 0)
        return program, program.compile_kernel(program.config(), program.get_device_caps(), own), context
