"""Translations by the built-in function ``_``, which programs use for their texts."""

import builtins
import gettext
import locale
import os

from rafcon.utils.log import get_logger
from rafcon.utils.resources import share_folder_paths

_DOMAIN = "rafcon"


def setup_l10n(logger=None):
    """Make ``_`` a built-in function that translates texts to the user's locale.

    Texts without a translation are returned unchanged.
    """
    logger = logger or get_logger(__name__)
    try:
        locale.setlocale(locale.LC_ALL, "")
    except locale.Error as error:
        logger.warning("The locale %s cannot be set: %s", os.environ.get("LC_ALL") or os.environ.get("LANG"), error)
    folders = (os.path.join(folder, "locale") for folder in share_folder_paths)
    found = (folder for folder in folders if gettext.find(_DOMAIN, folder))
    builtins.__dict__["_"] = gettext.translation(_DOMAIN, next(found, None), fallback=True).gettext


def create_mo_files(logger):
    """Do nothing: this package has no texts to translate."""
