# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors that end an operator with a message for the artist."""


class ScatterError(RuntimeError):
    """A rule was broken; the message names the input, the rule and the first offender."""


class MissingPackageError(ScatterError):
    """The native package is not installed."""


class ChangedError(ScatterError):
    """The data has changed since it was read."""


class StoppedError(RuntimeError):
    """The artist canceled the work."""
