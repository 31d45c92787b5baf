"""Launches of one kernel on one run's arrays, again and again, without handling sixty arguments each time.

Taichi looks at every argument of every launch, and asks each array for its address: some 0.3 ms, many times what a few
steps of a bar take. The arrays of a run stay where they are, so a launch on the processor keeps what Taichi has made of
them, and only the whole numbers change. On a GPU the kernel is kept, but what it is launched with is used up by the
launch (CUDA's puts addresses of its own there) and made anew each time, without asking what each argument is.
Of Taichi 1.7.4 (``Kernel.launch_kernel``), which this project is bound to.
"""

from typing import Any, cast

from taichi.lang import impl
from taichi.types import ndarray_type, primitive_types

from solvers.kernels import runtime


class Launch:
    """Kernel bound to arguments, called with whole numbers: its arguments are these, then a ``pack`` of numbers and
    arrays, then ``templates``. The first call compiles it; then the pack's arrays may be written to, not replaced."""

    def __init__(self, kernel: Any, pack: Any, *templates: Any):
        self._kernel, self._arguments = kernel, (pack, *templates)
        self._kept: tuple[Any, Any, Any] | None = None  # Taichi's program, the compiled kernel and its context
        runtime.holders.add(self)

    def __call__(self, *numbers: int) -> None:
        if not runtime.runs_on_cpu():
            self._queue_launch_on_gpu(numbers)
            return
        if self._kept is None:
            self._kernel(*numbers, *self._arguments)
            self._kept = self._compile_kernel(impl.get_runtime().prog, numbers)
            return
        program, compiled, context = self._kept
        for k, number in enumerate(numbers):
            context.set_arg_int((k,), number)
        program.launch_kernel(compiled, context)

    @property
    def is_kept(self) -> bool:
        """Whether it has been compiled, and Taichi has not restarted since."""
        return self._kept is not None

    def compile(self, *numbers: int) -> None:
        """Compiles the kernel for a GPU, for any whole numbers as its first arguments, without launching it."""
        primal, program = self._kernel._primal, impl.get_runtime().prog
        own = primal.compiled_kernels[primal.ensure_compiled(*numbers, *self._arguments)]
        self._kept = program, program.compile_kernel(program.config(), program.get_device_caps(), own), own

    def free(self) -> None:
        """Releases all objects of Taichi, before it ends; on a GPU the kernel cannot be called afterwards."""
        self._kept = None
        if not runtime.runs_on_cpu():
            self._arguments = ()  # its arrays too

    def _queue_launch_on_gpu(self, numbers: tuple[int, ...]) -> None:
        """Queues the launch with these whole numbers on a GPU, compiled if necessary; returns before it is done."""
        if self._kept is None:
            self.compile(*numbers)
        program, compiled, own = cast(tuple, self._kept)
        context, pack, at = own.make_launch_context(), self._arguments[0], len(numbers)
        for k, number in enumerate(numbers):
            context.set_arg_int((k,), number)
        context.set_arg_argpack((at,), pack._ArgPack__argpack)
        for k, (array, _) in enumerate(self._arrays()):
            context.set_arg_ndarray((at + 1 + k,), array.arr)
        program.launch_kernel(compiled, context)

    def _arrays(self) -> list[tuple[Any, Any]]:
        """Returns the pack's arrays and their Taichi types, in the order in which they follow all other arguments."""
        pack = self._arguments[0]
        return [(pack[name], kind) for name, kind in pack._ArgPack__annotations.items()
                if isinstance(kind, ndarray_type.NdarrayType)]

    def _compile_kernel(self, program: Any, numbers: tuple[int, ...]) -> tuple[Any, Any, Any]:
        """Returns Taichi's program, the kernel compiled for a CPU, and a launch context that contains the pack."""
        primal, pack, at = self._kernel._primal, self._arguments[0], len(numbers)
        own = primal.compiled_kernels[primal.ensure_compiled(*numbers, *self._arguments)]
        context = own.make_launch_context()
        context.set_arg_argpack((at,), pack._ArgPack__argpack)
        for k, (array, kind) in enumerate(self._arrays()):
            scalar = kind.dtype is None or id(kind.dtype) in primitive_types.type_ids
            shape = array.shape if scalar else array.shape[:-kind.dtype.ndim]
            context.set_arg_external_array_with_shape((at + 1 + k,), array.ctypes.data, array.nbytes, shape, 0)
        return program, program.compile_kernel(program.config(), program.get_device_caps(), own), context
