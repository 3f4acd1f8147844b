"""Sorting in place, in kernels.

Numba's own sort and what gathers by an order are more code than what sorts here, and are compiled
once more into each kernel that reaches them.
"""

from compass.core.jit import kernel

#: Up to as many, each is put in its place among those before it; more are sorted as a heap.
FEW = 48


@kernel
def sort_together(keys, along, count):
    """Sort the first `count` of `keys`, least first, and what goes with each along with it."""
    if count > FEW:
        _sort_as_heap(keys, along, count)
        return
    for k in range(1, count):
        key, other = keys[k], along[k]
        m = k
        while m > 0 and keys[m - 1] > key:
            keys[m], along[m] = keys[m - 1], along[m - 1]
            m -= 1
        keys[m], along[m] = key, other


@kernel
def keep_greatest(kept, value):
    """Put a value among the greatest so far, in falling order, if it is one."""
    place = kept.size - 1
    if value <= kept[place]:
        return
    while place > 0 and kept[place - 1] < value:
        kept[place] = kept[place - 1]
        place -= 1
    kept[place] = value


@kernel
def _sort_as_heap(keys, along, count):
    """Make a heap, greatest on top, and take the top to the end until none is left."""
    for top in range(count // 2 - 1, -1, -1):
        _sift(keys, along, top, count)
    for end in range(count - 1, 0, -1):
        keys[0], keys[end] = keys[end], keys[0]
        along[0], along[end] = along[end], along[0]
        _sift(keys, along, 0, end)


@kernel
def _sift(keys, along, top, count):
    """Let what stands at `top` sink below all that are greater."""
    key, other = keys[top], along[top]
    while 2 * top + 1 < count:
        child = 2 * top + 1
        if child + 1 < count and keys[child + 1] > keys[child]:
            child += 1
        if keys[child] <= key:
            break
        keys[top], along[top] = keys[child], along[child]
        top = child
    keys[top], along[top] = key, other
