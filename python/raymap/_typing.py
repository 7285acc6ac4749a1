"""Names of typing that CPython 3.10 lacks, or has with fewer features."""

import sys

if sys.version_info >= (3, 11):
    from typing import NamedTuple, Unpack
else:
    from typing_extensions import NamedTuple, Unpack

__all__ = ["NamedTuple", "Unpack"]
