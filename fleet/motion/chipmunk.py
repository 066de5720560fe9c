"""The bridge from compiled loops to Chipmunk, the C library inside pymunk.

pymunk's public interface costs about 12 µs for each robot and step. The functions here are
called from compiled code by their addresses; bodies are read and written through the functions
that pymunk itself uses for batches, so nothing is assumed about how Chipmunk lays out its
structures. Both are reached through pymunk's private cffi module: if that is not as expected,
:func:`connect` says so, and the engine falls back on the public interface.

Importing this module loads numba, but not pymunk.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from llvmlite import ir
from numba import config, types
from numba.extending import intrinsic

from fleet.motion.kernels.records import Wires
from protocols.compiled import kernel

if TYPE_CHECKING:
    import pymunk

SIGNATURES = {
    "cpSpaceStep": "void(*)(struct cpSpace *, double)",
    "pmSpaceBodyGetIteratorFuncBatched": "void(*)(struct cpBody *, void *)",
    "pmSpaceBodySetIteratorFuncBatched": "void(*)(struct cpBody *, void *)",
    "cpBodySetType": "void(*)(struct cpBody *, enum cpBodyType)",
    "cpBodySetMoment": "void(*)(struct cpBody *, double)",
}
"""What is called, in the order of the first places in ``Wires.calls``."""

STEP, READ, WRITE, SET_TYPE, SET_MOMENT, SPACE, HEARD, TOLD = range(8)
"""Places in ``Wires.calls``."""

DYNAMIC, STATIC = 0, 2  # cpBodyType of a body that moves, and of a parked one
ROOM = 8  # numbers in a buffer


class NoBridge(RuntimeError):
    """pymunk is not built the way the bridge knows."""


def _caller(numba_type: Any, llvm_type: Any) -> Any:
    """An intrinsic f(address, pointer, last) that calls the C function at ``address`` with a
    pointer and ``last``, which is of these types, and returns nothing.
    """
    function_type = ir.FunctionType(ir.VoidType(), [ir.IntType(64), llvm_type])

    def generate(context: Any, builder: Any, _signature: Any, values: Sequence[Any]) -> Any:
        function = builder.inttoptr(values[0], function_type.as_pointer())
        builder.call(function, values[1:])
        return context.get_dummy_value()

    @intrinsic  # type: ignore[untyped-decorator]  # numba is not typed
    def call(_typing: Any, _address: Any, _pointer: Any, _last: Any) -> Any:
        return types.void(types.int64, types.int64, numba_type), generate

    return call


_call_with_number = _caller(types.float64, ir.DoubleType())  # f(cpSpace * or cpBody *, double)
_call_on_body = _caller(types.int64, ir.IntType(64))  # f(cpBody *, void *)
_call_set_type = _caller(types.int32, ir.IntType(32))  # f(cpBody *, enum)


@kernel
def step_space(calls: Any, dt: Any) -> None:
    """Let the space step by ``dt`` [s]."""
    _call_with_number(calls[STEP], calls[SPACE], dt)


@kernel
def wake_body(calls: Any, body: Any, inertia: Any) -> None:
    """Make a parked body one that moves; parking has made it forget its ``inertia`` [kg·m²]."""
    _call_set_type(calls[SET_TYPE], body, np.int32(DYNAMIC))
    _call_with_number(calls[SET_MOMENT], body, inertia)


@kernel
def park_body(calls: Any, body: Any) -> None:
    """Make a body that moves a parked one, at rest."""
    _call_set_type(calls[SET_TYPE], body, np.int32(STATIC))


@kernel
def write_body(
    calls: Any, body: Any, numbers: Any, counts: Any, fx: Any, fy: Any, torque: Any
) -> None:
    """Push a body in the next step with a force [N] and a torque [N·m]."""
    numbers[0], numbers[1], numbers[2] = fx, fy, torque
    counts[0] = 0
    _call_on_body(calls[WRITE], body, calls[TOLD])


@kernel
def read_body(calls: Any, body: Any, counts: Any) -> None:
    """Read into ``numbers`` a body's x, y [m], heading [rad], velocity in x and y [m/s] and turn
    rate [rad/s].
    """
    counts[0] = 0
    _call_on_body(calls[READ], body, calls[HEARD])


@kernel
def _drive_alone(wires: Any, inertia: Any, fx: Any, fy: Any, torque: Any, dt: Any) -> None:
    wake_body(wires.calls, wires.bodies[0], inertia)
    for _ in range(2):
        write_body(wires.calls, wires.bodies[0], wires.numbers, wires.counts, fx, fy, torque)
        step_space(wires.calls, dt)
        read_body(wires.calls, wires.bodies[0], wires.counts)
    park_body(wires.calls, wires.bodies[0])


def disconnected() -> Wires:
    """The wires of a world without an engine."""
    return Wires(
        np.zeros(8, np.int64), np.zeros(1, np.int64), np.zeros(ROOM), np.zeros(1, np.int32)
    )


def connect(space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> tuple[Wires, object]:
    """The wires to a space and its bodies, and an object to keep for as long as they are used.

    Raises:
        NoBridge: pymunk lacks something that is needed, or has it otherwise.
    """
    ffi, lib = _private_module()
    try:
        _check_signatures(ffi, lib)
        numbers = np.zeros(ROOM)
        floats, ints = ffi.new("pmFloatArray *"), ffi.new("pmIntArray *")
        array = ffi.from_buffer("double[]", numbers)
        floats.num, floats.max, floats.arr = 0, ROOM, array
        heard, told = ffi.new("pmBatchedData *"), ffi.new("pmBatchedData *")
        heard.fields = lib.POSITION | lib.ANGLE | lib.VELOCITY | lib.ANGULAR_VELOCITY
        told.fields = lib.FORCE | lib.TORQUE
        heard.floatArray = told.floatArray = floats
        heard.intArray = told.intArray = ints
        calls = [_address(ffi, ffi.addressof(lib, name)) for name in SIGNATURES]
        calls += [_address(ffi, part) for part in (space._space, heard, told)]
        pointers = [_address(ffi, body._body) for body in bodies]
    except (AttributeError, TypeError, ffi.error) as error:
        raise NoBridge(f"pymunk has changed inside: {error}") from error
    counts = np.frombuffer(ffi.buffer(floats, ffi.sizeof("int")), np.int32)
    wires = Wires(np.array(calls, np.int64), np.array(pointers, np.int64), numbers, counts)
    return wires, (space, bodies, floats, ints, array, heard, told)


def _private_module() -> tuple[Any, Any]:
    try:
        from pymunk._chipmunk_cffi import ffi, lib
    except ImportError as error:
        raise NoBridge(f"pymunk has no cffi module: {error}") from error
    return ffi, lib


def _check_signatures(ffi: Any, lib: Any) -> None:
    for name, signature in SIGNATURES.items():
        found = ffi.typeof(ffi.addressof(lib, name)).cname
        if found != signature:
            raise NoBridge(f"pymunk's {name} is {found}; expected {signature}")
    types = (lib.CP_BODY_TYPE_DYNAMIC, lib.CP_BODY_TYPE_STATIC, ffi.sizeof("enum cpBodyType"))
    if types != (DYNAMIC, STATIC, 4):
        raise NoBridge("pymunk numbers its body types in another way")


def _address(ffi: Any, of: Any) -> int:
    return int(ffi.cast("uintptr_t", of))


@cache
def trusted() -> bool:
    """Whether a step over the bridge does, bit for bit, what the public interface does.

    Only compiled code can cross it.
    """
    if config.DISABLE_JIT:
        return False
    import pymunk

    def world() -> tuple[pymunk.Space, pymunk.Body]:
        space = pymunk.Space()
        body = pymunk.Body(body_type=pymunk.Body.STATIC)
        body.position, body.angle = (1.25, -0.5), 0.75
        circle = pymunk.Circle(body, 0.1)
        circle.mass = 9.0
        space.add(body, circle)
        return space, body

    force, torque, inertia, dt = (30.0, 70.0), 0.3, 0.05, 1.0 / 60.0
    space, body = world()
    body.body_type = pymunk.Body.DYNAMIC
    body.moment = inertia
    for _ in range(2):
        body.force, body.torque = force, torque
        space.step(dt)
    expected = (*body.position, body.angle, *body.velocity, body.angular_velocity)
    space, body = world()
    try:
        wires, _kept = connect(space, [body])
    except NoBridge:
        return False
    _drive_alone(wires, inertia, *force, torque, dt)
    parked = body.body_type == pymunk.Body.STATIC
    return parked and tuple(wires.numbers[: len(expected)].tolist()) == expected
