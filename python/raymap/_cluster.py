"""Work on a cluster of Dask."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import CancelledError
from typing import Any

from ._errors import Error, UsageError

#: Result of a task that Dask gave up, because four workers died with it.
KILLED = object()


def dask_results(
    client: Any, function: Callable[..., Any], items: Iterable[Any], keys: list[str], **same: Any
) -> Generator[tuple[str, Any]]:
    """Calls a function for each item on the cluster of a ``dask.distributed.Client``. Yields the key and the result of
    each call as it ends, `KILLED` among them.

    Args:
        client: The client.
        function: What is called, with an item and the keyword arguments ``same``.
        items: The items.
        keys: Dask's name of each call.
        **same: Arguments of all calls. A future becomes its result.

    Raises:
        Error: The scheduler was lost, or the function raised it.
        UsageError: The scheduler or a worker lacks raymap.
    """
    distributed = importlib.import_module("distributed")  # The type checker must not need it.
    # Nothing else refers to the futures. So Dask forgets each as soon as it is taken, and the rest if this is closed.
    for future in distributed.as_completed(client.map(function, items, key=keys, pure=False, **same)):
        try:
            yield future.key, future.result()
        except distributed.KilledWorker:
            yield future.key, KILLED
        except (CancelledError, OSError) as error:
            if isinstance(error, Error):  # of the function
                raise
            raise Error("the scheduler of Dask was lost; run again with a new one: what is finished stays") from error
        except (ModuleNotFoundError, RuntimeError) as error:
            if isinstance(error, RuntimeError) and "deserialization" not in str(error):
                raise
            text = f"the scheduler or a worker of Dask lacks raymap or a package ({str(error).splitlines()[0]})"
            raise UsageError(f"{text}; install the same version of raymap on all machines") from error
