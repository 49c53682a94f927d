"""Translations: the built-in function ``_`` that programs use for their texts."""

import builtins
import gettext
import locale
import os

from rafcon.utils.log import get_logger
from rafcon.utils.resources import share_folder_paths

_DOMAIN = "rafcon"


def setup_l10n(logger=None):
    """Makes ``_`` a built-in function that translates by the user's locale; what has no translation stays as it is."""
    logger = logger or get_logger(__name__)
    try:
        locale.setlocale(locale.LC_ALL, "")
    except locale.Error as error:
        logger.warning("The locale %s cannot be set: %s", os.environ.get("LC_ALL") or os.environ.get("LANG"), error)
    folders = (os.path.join(folder, "locale") for folder in share_folder_paths)
    found = (folder for folder in folders if gettext.find(_DOMAIN, folder))
    builtins.__dict__["_"] = gettext.translation(_DOMAIN, next(found, None), fallback=True).gettext


def create_mo_files(logger):
    """Nothing to do: this package ships no texts to be translated."""
