"""Names of typing that CPython 3.10 has not, or with less."""

import sys

if sys.version_info >= (3, 11):
    from typing import NamedTuple, Unpack
else:
    from typing_extensions import NamedTuple, Unpack

__all__ = ["NamedTuple", "Unpack"]
