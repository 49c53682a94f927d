"""Observers: of calls and assignments (:mod:`observable`), of models (:mod:`observer`), of collections (:mod:`wrappers`)."""

from rafcon._lazy import submodules

__getattr__ = submodules(__name__)
