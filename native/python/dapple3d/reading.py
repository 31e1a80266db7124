# SPDX-License-Identifier: GPL-3.0-or-later
"""What libraries raise for a file that is broken."""

import struct
import tokenize
import zipfile
import zlib
from typing import Final

__all__ = ["BROKEN", "WRONG_ENTRY"]

WRONG_ENTRY: Final = (LookupError, TypeError, AttributeError, OverflowError, RecursionError)
"""Of a tree of JSON with an entry that is missing, of another kind, or within itself."""

BROKEN: Final = (
    *(ValueError, EOFError, RuntimeError, SyntaxError, *WRONG_ENTRY),
    *(struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error),
)
"""By numpy, which reads headers as Python, zipfile and struct."""
