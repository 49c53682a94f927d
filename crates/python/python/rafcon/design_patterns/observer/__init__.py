"""Observers of calls and assignments, of models, and of collections.

See :mod:`observable`, :mod:`observer` and :mod:`wrappers`.
"""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
